"""PTX, and PTS with several counts: every station where its pose says, rays that hit nothing dropped, one sentence."""

import time
import tracemalloc

import numpy as np
import pytest

from stair_inspector.errors import ColumnsUnclear, ReadError
from stair_inspector.files.scans import FOLDER_SUFFIXES, read_scan
from tests.files.damage import check_form, n_read_of_damaged, points_or_none
from tests.files.station_files import ptx_bytes
from tests.synthetic import rotation

RNG = np.random.default_rng(3)
FIRST, SECOND = np.round(RNG.normal(0.0, 3.0, (12, 3)), 4), np.round(RNG.normal(0.0, 3.0, (8, 3)), 4)
QUARTER, SAME = np.round(rotation("z", 90.0)), np.eye(3)
GRID = np.array([500_000.25, 5_400_000.5, 100.125])
PTX = ptx_bytes((FIRST, QUARTER, GRID), (SECOND, SAME, GRID + 1.0), columns=2)
PTX_HEAD = "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"


def lines(points, rest=""):
    return "".join(f"{x} {y} {z}{rest}\n" for x, y, z in np.asarray(points).tolist())


PTS = f"12\n{lines(FIRST)}8\n{lines(SECOND)}".encode()


def read(tmp_path, content, name, **options):
    (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return read_scan(tmp_path / name, "m", **options)


# --- PTX ---


def test_stations_of_ptx_are_laid_where_their_poses_say(tmp_path):
    scan = read(tmp_path, PTX, "a.ptx")
    turned = np.stack([-FIRST[:, 1], FIRST[:, 0], FIRST[:, 2]], axis=1)
    assert np.abs(scan.points + scan.origin_m - np.concatenate([turned, SECOND + 1.0]) - GRID).max() < 2e-9
    assert scan.stations.names == ("scan 1", "scan 2")
    assert np.array_equal(scan.stations.of_point, [0] * 12 + [1] * 8)
    assert np.array_equal(scan.stations.places_m + scan.origin_m, [GRID, GRID + 1.0])
    assert [note.message for note in scan.notes] == [
        "the file holds 2 stations, taken together: 'scan 1' (12 points), 'scan 2' (8 points)"
    ]
    second = read(tmp_path, PTX, "a.ptx", station="2")
    assert np.abs(second.points + second.origin_m - SECOND - 1.0 - GRID).max() < 2e-9
    assert set(second.stations.of_point) == {1}
    assert second.notes[0].message == "station 2 of 2 was read: 'scan 2' (8 points)"


def test_one_station_of_ptx_with_windows_line_ends_and_a_byte_order_mark(tmp_path):
    content = b"\xef\xbb\xbf" + ptx_bytes((FIRST, SAME, np.zeros(3))).replace(b"\n", b"\r\n")
    scan = read(tmp_path, content, "a.ptx")
    assert np.array_equal(scan.points, FIRST)
    assert scan.notes[0].message == "the file holds one station: 'scan 1' (12 points)"


def test_rays_that_hit_nothing_are_dropped_and_counted(tmp_path):
    rays = FIRST.copy()
    rays[[0, 5, 7]] = 0.0
    scan = read(tmp_path, ptx_bytes((rays, SAME, GRID)), "a.ptx")
    assert np.abs(scan.points + scan.origin_m - FIRST[[1, 2, 3, 4, 6, 8, 9, 10, 11]] - GRID).max() < 2e-9
    assert scan.notes[1].message == "3 of 12 rays dropped: they hit nothing (0 0 0)"
    # The pose would take them to the scanner, among the points.
    with pytest.raises(ReadError, match="none of the 12 rays hit anything"):
        read(tmp_path, ptx_bytes((0.0 * rays, SAME, GRID)), "a.ptx")


@pytest.mark.parametrize(
    ("rest", "colors"),
    [("", None), (" 0.25", None), (" 10 20 255", (10, 20, 255)), (" 0.25 10 20 255", (10, 20, 255))],
)
def test_intensity_and_colours(tmp_path, rest, colors):
    scan = read(tmp_path, ptx_bytes((FIRST, SAME, GRID), rest=rest), "a.ptx")
    assert (scan.colors is None) if colors is None else (scan.colors == colors).all()
    assert len(scan.notes) == 1


def test_columns_that_are_not_known_are_ignored_with_a_note(tmp_path):
    scan = read(tmp_path, ptx_bytes((FIRST, SAME, GRID), rest=" 1.5 2 3"), "a.ptx")
    assert scan.colors is None
    assert scan.notes[1].code == "columns_ignored"


def with_head(place, axes, turn, shift):
    """A PTX of one station whose head is written as given: rows of the axes, rows of the matrix."""
    rows = [place, *axes, *(np.append(row, 0) for row in turn), np.append(shift, 1)]
    return f"1\n{len(FIRST)}\n" + "".join(" ".join(f"{v:.8g}" for v in row) + "\n" for row in rows) + lines(FIRST)


TILT = (rotation("z", 30.0) @ rotation("x", 10.0)).T
SHIFT = np.array([10.0, 20.0, 3.0])


@pytest.mark.parametrize(
    ("place", "axes", "turn", "shift"),
    [
        (SHIFT, TILT, TILT.T, SHIFT),
        (SHIFT, TILT.T, TILT, SHIFT),
        ((1.0, 1.0, 1.0), TILT, TILT, SHIFT),
        (SHIFT, TILT, np.eye(3), SHIFT),
        (SHIFT, TILT, TILT, 0.0 * SHIFT),
        ((np.nan, 0.0, 0.0), TILT, TILT, SHIFT),
    ],
)
def test_a_head_of_ptx_that_contradicts_itself_is_refused(tmp_path, place, axes, turn, shift):
    with pytest.raises(ReadError, match="the head of its station 1 contradicts itself: its lines 3 to 6") as caught:
        read(tmp_path, with_head(place, axes, turn, shift), "a.ptx")
    check_form(tmp_path / "a.ptx", str(caught.value))


@pytest.mark.parametrize(
    ("place", "axes", "turn", "shift", "code"),
    [
        (SHIFT, TILT, TILT, SHIFT, None),
        (np.round(SHIFT + 0.004, 2), np.round(TILT, 2), TILT, SHIFT, None),
        (0.0 * SHIFT, np.eye(3), TILT, SHIFT, "pose_in_matrix_only"),
        (SHIFT, np.eye(3), TILT, SHIFT, "pose_in_matrix_only"),
        (0.0 * SHIFT, 0.0 * TILT, TILT, SHIFT, "pose_in_matrix_only"),
        (SHIFT, TILT, np.eye(3), 0.0 * SHIFT, "pose_in_head_only"),
    ],
)
def test_of_a_pose_that_is_stated_once_the_matrix_is_believed_and_that_is_said(
    tmp_path, place, axes, turn, shift, code
):
    scan = read(tmp_path, with_head(place, axes, turn, shift), "a.ptx")
    assert np.abs(scan.points - (FIRST @ turn + shift)).max() < 1e-6
    assert [note.code for note in scan.notes[1:]] == [code] * (code is not None)
    # Where its points were seen from is not certain without a matrix.
    place_m = np.full(3, np.nan) if code == "pose_in_head_only" else shift
    assert np.array_equal(scan.stations.places_m[0], place_m, equal_nan=True)


@pytest.mark.parametrize("stretch", [0.9996, 1.0004])
def test_a_matrix_that_stretches_leaves_lengths_as_they_are(tmp_path, stretch):
    scan = read(tmp_path, with_head(SHIFT, TILT * stretch, TILT * stretch, SHIFT), "a.ptx")
    assert np.abs(scan.points - (FIRST @ TILT + SHIFT)).max() < 1e-6
    words = f"the matrix stretches, by up to {stretch:.5f}: it was made a turn, so that lengths stay"
    assert [note.message for note in scan.notes[1:]] == [f"in the head of station 1 {words}"]


@pytest.mark.parametrize(
    ("before", "after"),
    [("\n", "\r"), ("\n", "\r\n"), ("\n", "\n\n"), ("\n", "\n  "), ("\n", " \n"), (" ", "\t")],
)
def test_blanks_and_line_ends_of_ptx_and_pts_change_nothing(tmp_path, before, after):
    for content, name in ((PTX, "a.ptx"), (PTS, "a.pts")):
        plain = read(tmp_path, content, name)
        other = read(tmp_path, content.decode().replace(before, after), name)
        assert np.array_equal(plain.points, other.points)
        assert [note.message for note in plain.notes] == [note.message for note in other.notes]


def test_blank_lines_in_the_head_of_ptx_are_counted(tmp_path):
    content = (PTX_HEAD + POINTS.replace("0.5", "half", 1)).replace("\n", "\n\n")
    with pytest.raises(ReadError, match="line 21 holds 'half'"):
        read(tmp_path, content, "a.ptx")


def test_a_bad_station_of_ptx_stops_only_who_wants_it(tmp_path):
    content = PTX_HEAD.replace("1 0 0 0", "1.1 0 0 0", 1) + lines(SECOND[:4]) + PTX_HEAD + lines(SECOND[4:8])
    assert np.array_equal(read(tmp_path, content, "a.ptx", station="2").points, SECOND[4:8])
    for station in ("", "1"):
        with pytest.raises(ReadError, match="the matrix of its station 1"):
            read(tmp_path, content, "a.ptx", station=station)
    nothing = PTX_HEAD + "0 0 0\n" * 4 + PTX_HEAD + lines(SECOND[4:8])
    with pytest.raises(ReadError, match="none of the 4 rays of its station 1 hit anything"):
        read(tmp_path, nothing, "a.ptx", station="1")


# --- PTS ---


def test_blocks_of_pts_are_read_together_or_one_by_one(tmp_path):
    scan = read(tmp_path, PTS, "a.pts")
    assert np.array_equal(scan.points, np.concatenate([FIRST, SECOND]))
    assert np.array_equal(scan.stations.of_point, [0] * 12 + [1] * 8)
    assert np.isnan(scan.stations.places_m).all()
    assert np.array_equal(read(tmp_path, PTS, "a.pts", station="scan 2").points, SECOND)
    remarked = b"# from a scanner\n\n" + PTS.replace(b"\n", b"\r\n") + b"0\n"
    scan = read(tmp_path, remarked, "a.pts")
    assert np.array_equal(scan.points, np.concatenate([FIRST, SECOND]))
    assert scan.notes[0].message == (
        "the file holds 3 stations, taken together: 'scan 1' (12 points), 'scan 2' (8 points), 'scan 3' (0 points)"
    )


def test_pts_of_one_block_is_text_as_any(tmp_path):
    scan = read(tmp_path, f"12\n{lines(FIRST)}", "a.pts")
    assert np.array_equal(scan.points, FIRST)
    assert scan.stations is None
    assert np.array_equal(read(tmp_path, lines(FIRST), "b.pts").points, FIRST)


def test_colours_of_blocks(tmp_path):
    content = f"12\n{lines(FIRST, ' 7 1 2 3')}8\n{lines(SECOND, ' -900 4 5 255')}"
    assert np.array_equal(read(tmp_path, content, "a.pts").colors, [[1, 2, 3]] * 12 + [[4, 5, 255]] * 8)


def test_an_empty_first_block_of_pts_is_a_station_too(tmp_path):
    scan = read(tmp_path, b"0\n" + PTS, "a.pts")
    assert np.array_equal(scan.points, np.concatenate([FIRST, SECOND]))
    assert scan.stations.names == ("scan 1", "scan 2", "scan 3")
    assert np.array_equal(scan.stations.of_point, [1] * 12 + [2] * 8)


def test_what_the_columns_of_blocks_are_may_be_said_and_line_numbers_are_no_x(tmp_path):
    numbered = "".join(
        f"{len(rows)}\n" + "".join(f"{k} {z} {x} {y}\n" for k, (x, y, z) in enumerate(rows.tolist()))
        for rows in (FIRST, SECOND)
    )
    scan = read(tmp_path, numbered, "a.pts", columns="-,z,x,y")
    assert np.array_equal(scan.points, np.concatenate([FIRST, SECOND]))
    assert np.array_equal(scan.stations.of_point, [0] * 12 + [1] * 8)
    with pytest.raises(ColumnsUnclear, match=r"its first column numbers the lines .* give --columns x,y,z or"):
        read(tmp_path, numbered, "a.pts")
    with pytest.raises(ReadError, match="its lines have 4 columns but --columns names 5; name as many or fewer"):
        read(tmp_path, numbered, "a.pts", columns="-,z,x,y,i")
    tilted = f"2\n{lines(FIRST[:2], ' 0 0 1')}1\n{lines(SECOND[:1], ' 0 1 0')}"
    assert np.array_equal(
        read(tmp_path, tilted, "a.pts", columns="x,y,z,nx,ny,nz").normals, [[0, 0, 1], [0, 0, 1], [0, 1, 0]]
    )


# --- what is wrong with a file ---


def test_folders_and_uploads_offer_the_suffixes():
    assert {".ptx", ".pts"} <= set(FOLDER_SUFFIXES)


POINTS = lines(SECOND[:4], " 0.5")
BAD = {
    "short.ptx": (PTX_HEAD + lines(SECOND[:3], " 1"), "states 4 points but 3 follow"),
    "long.ptx": (PTX_HEAD + lines(SECOND[:5], " 1"), "station 1 states 4 points but 5 follow"),
    "huge.ptx": (PTX_HEAD.replace("2\n2", "999999999999\n999999999999", 1) + POINTS, "more than a file can hold"),
    "lying.ptx": (PTX_HEAD.replace("2\n2", "99999\n999999", 1) + POINTS, "states 99998900001 points but 4 follow"),
    "long_count.ptx": (PTX_HEAD.replace("2", "9" * 30, 1) + POINTS, "columns or rows, more than a file can hold"),
    "long_rows.ptx": (PTX_HEAD.replace("2\n2", "2\n" + "9" * 18, 1) + POINTS, "columns or rows, more than a file can"),
    "no_rays.ptx": (PTX_HEAD.replace("2\n2", "0\n0", 1), "holds no points; export the scan again"),
    "lone.ptx": (PTX_HEAD + POINTS + "3\n", "line 15 begins a PTX station that ends there"),
    "count.ptx": (PTX_HEAD + POINTS + "3\n1 2 3 4\n5\n", "line 15 ('3') is neither a point nor the head"),
    "cut.ptx": (PTX_HEAD + POINTS + "2\n2\n0 0 0\n", "the head of its station 2 is cut off"),
    "word.ptx": (PTX_HEAD + POINTS.replace("0.5", "half", 1), "line 11 holds 'half'"),
    "columns.ptx": (PTX_HEAD + POINTS + "7 8 9\n", "line 15 should have 4 columns, got 3"),
    "few.ptx": (PTX_HEAD + "1 2\n" * 4, "has 2 columns, a point needs x, y and z"),
    "place.ptx": (PTX_HEAD.replace("0 0 0\n", "0 x 0\n", 1) + POINTS, "holds 'x' instead of a number"),
    "matrix.ptx": (PTX_HEAD.replace("1 0 0 0", "1 y 0 0", 1) + POINTS, "holds 'y' instead of a number"),
    "nan.ptx": (PTX_HEAD.replace("0 0 0 1", "nan 0 0 1", 1) + POINTS, "is no turn and shift"),
    "scale.ptx": (
        PTX_HEAD.replace("1 0 0 0", "1.1 0 0 0", 1) + POINTS,
        "the matrix of its station 1 ('1.1 0 0 0' ...)",
    ),
    "mirror.ptx": (PTX_HEAD.replace("1 0 0 0", "-1 0 0 0", 1) + POINTS, "is no turn and shift"),
    "column.ptx": (PTX_HEAD.replace("1 0 0 0", "1 0 0 5", 1) + POINTS, "with the shift in its last row"),
    "other.ptx": (PTX_HEAD + POINTS + PTX_HEAD + lines(SECOND[:4]), "have 3 and 4 columns"),
    "headless.ptx": ("2\n2\n1 2\n", "does not begin with two counts"),
    "short.pts": (f"12\n{lines(FIRST)}9\n{lines(SECOND)}", "states 9 points but 8 follow"),
    "long.pts": (f"11\n{lines(FIRST)}8\n{lines(SECOND)}", "line 1 states 11 points but 12 follow"),
    "empty.pts": (f"12\n{lines(FIRST)}8\n0\n", "line 14 states 8 points but 0 follow"),
    "zero.pts": (f"12\n{lines(FIRST)}0\n{lines(SECOND)}", "line 14 states 0 points but 8 follow"),
    "word.pts": (f"12\n{lines(FIRST)}8\n{lines(SECOND)}".replace(".", "p", 30), "line 2 holds"),
    "columns.pts": (f"12\n{lines(FIRST)}8\n{lines(SECOND, ' 1')}", "its stations have 3 and 4 columns"),
    "many.pts": ("1\n1 2 3\n" * 1200, "holds more than 1000 counts"),
    "many.ptx": ((PTX_HEAD + POINTS) * 1200, "holds more than 1000 stations"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_stations(tmp_path, name):
    content, words = BAD[name]
    tracemalloc.start()
    with pytest.raises(ReadError) as caught:
        read(tmp_path, content, name)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    check_form(tmp_path / name, str(caught.value))
    assert words in str(caught.value)
    assert peak < 5e6 + 20 * len(content)


@pytest.mark.parametrize("name", ["a.ptx", "a.pts"])
def test_two_hundred_damaged_files_give_a_sentence_or_a_scan(name):
    assert n_read_of_damaged(name, {"a.ptx": PTX, "a.pts": PTS}[name], seed=11) > 0


@pytest.mark.parametrize("filling", [b"\n", b"1\n", b" \n", b"1 2\n", b"0 0 0\n", b"1" * 60_000 + b"\n"])
def test_no_filling_takes_long(filling):
    for head in (PTX_HEAD.encode(), b"5\n1 2 3\n"):
        content = head + filling * (200_000 // len(filling))
        began = time.process_time()
        points_or_none("a.pts", content)
        assert time.process_time() - began < 1.0
