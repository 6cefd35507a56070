"""E57: every station where its pose says, without what the file marks; one sentence for what cannot be read."""

import math
import os
import sys
import time
import tracemalloc

import numpy as np
import pytest

from stair_inspector.errors import ReadError
from stair_inspector.files import e57_process
from stair_inspector.files.e57_process import E57Process
from stair_inspector.files.e57_scan import read_e57, read_stations
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.raw_stations import asked_as, find_station
from stair_inspector.files.scans import FOLDER_SUFFIXES, read_scan
from tests.files.damage import N_DAMAGED, check_form, damaged
from tests.oracles import HAS_NO_E57, needs_e57

pytestmark = needs_e57
if not HAS_NO_E57:
    from tests.files.e57_files import RGB, XYZ, doubles, e57_bytes, scaled, station, whole, with_checksums

RNG = np.random.default_rng(1)
FIRST, SECOND = RNG.normal(0.0, 3.0, (50, 3)), RNG.normal(0.0, 3.0, (70, 3))
HALF = math.sqrt(0.5)
ABOUT_Z = (HALF, 0.0, 0.0, HALF)
"""A quarter turn: x goes to y."""
GRID = (500_000.25, 5_400_000.5, 100.125)


def read(tmp_path, content, name="a.e57", **options):
    (tmp_path / name).write_bytes(content)
    return read_scan(tmp_path / name, **options)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("e57")


@pytest.fixture(scope="module")
def two(folder):
    """Two stations, one of them turned and far away, the other without a pose."""
    return e57_bytes(
        folder / "two.e57",
        station(doubles(XYZ, FIRST), "Hall", ABOUT_Z, GRID),
        station(doubles(XYZ, SECOND + GRID), "Landing"),
    )


@pytest.fixture(scope="module")
def process():
    with E57Process() as made:
        yield made


def turned(points):
    return np.stack([-points[:, 1], points[:, 0], points[:, 2]], axis=1)


# --- stations ---


def test_stations_are_laid_where_their_poses_say(tmp_path, two):
    scan = read(tmp_path, two)
    assert np.abs(scan.points + scan.origin_m - np.concatenate([turned(FIRST), SECOND]) - GRID).max() < 2e-9
    assert scan.stations.names == ("Hall", "Landing")
    assert np.array_equal(scan.stations.of_point, [0] * 50 + [1] * 70)
    assert np.array_equal(scan.stations.places_m[0] + scan.origin_m, GRID)
    # Without a pose, nothing tells where the scanner stood.
    assert np.isnan(scan.stations.places_m[1]).all()
    assert [(note.code, note.message) for note in scan.notes] == [
        ("stations_read", "the file holds 2 stations, taken together: 'Hall' (50 points), 'Landing' (70 points)")
    ]
    assert (scan.unit, scan.colors, scan.stated_steps_m) == ("m", None, None)


@pytest.mark.parametrize("wanted", ["Landing", "landing", "2", " 2 ", "#2"])
def test_one_station_is_chosen_by_name_or_number(tmp_path, two, wanted):
    scan = read(tmp_path, two, station=wanted)
    assert np.abs(scan.points + scan.origin_m - SECOND - GRID).max() < 2e-9
    assert scan.stations.names == ("Hall", "Landing")
    assert set(scan.stations.of_point) == {1}
    assert scan.notes[0].message == "station 2 of 2 was read: 'Landing' (70 points)"


def test_a_station_that_is_not_there_is_a_sentence(tmp_path, two):
    for wanted, words in (
        ("Roof", r"has no station 'Roof'; it has 'Hall', 'Landing': give a name, or a number as #1"),
        ("3", "has no station '3'"),
        ("0", "has no station '0'"),
        ("#0", "has no station '#0'"),
        ("9" * 5000, "has no station '9999999999999999999999999999999999999999...'"),
    ):
        with pytest.raises(ReadError, match=words) as caught:
            read(tmp_path, two, station=wanted)
        check_form(tmp_path / "a.e57", str(caught.value))
    with pytest.raises(ReadError, match=r"of a format that has no stations; measure it without --station"):
        read(tmp_path, ply_bytes(FIRST), "a.ply", station="1")


def test_stations_of_one_name_are_told_by_number(folder, process):
    points = doubles(XYZ, FIRST)
    content = e57_bytes(folder / "twins.e57", station(points, "A"), station(points, "A"), station(points, "2"))
    with pytest.raises(ReadError, match="several stations named 'A'; give the number of one, #1 and #2"):
        read_stations(process, content, "A")
    # A name counts before a number, unless that is written as one.
    assert set(read_stations(process, content, "2").stations.of_point) == {2}
    assert set(read_stations(process, content, "#2").stations.of_point) == {1}


@pytest.mark.parametrize(
    "names",
    [("2", "A", "A"), ("1", "2", "1", "2"), ("#2", "#1", "A"), ("Flur", "flur", "Fl\u00fcr", "Flu\u0308r"), ("2", "1")],
)
def test_every_station_is_found_by_what_the_menu_asks_for_and_by_its_number(names):
    assert [find_station(names, asked) for asked in asked_as(names)] == list(range(len(names)))
    assert [find_station(names, f"#{k + 1}") for k in range(len(names))] == list(range(len(names)))


def test_a_name_is_found_however_its_accents_are_encoded_and_however_long_it_is(folder, process):
    points, long = doubles(XYZ, FIRST), "Treppenhaus " + "x" * 60
    content = e57_bytes(folder / "a.e57", *(station(points, name) for name in (long + "1", long + "2", "S\u00fcd")))
    assert set(read_stations(process, content, long + "2").stations.of_point) == {1}
    assert set(read_stations(process, content, "Su\u0308d").stations.of_point) == {2}


def test_a_bad_station_stops_only_who_wants_it(folder, process):
    bad = station(doubles(XYZ, FIRST), "Hall", (0.0, 0.0, 0.0, 0.0), GRID)
    content = e57_bytes(folder / "a.e57", bad, station(doubles(XYZ, SECOND), "Landing"))
    raw = read_stations(process, content, "Landing")
    assert np.array_equal(raw.points, SECOND)
    assert raw.stations.names == ("Hall", "Landing")
    for wanted in ("", "Hall"):
        with pytest.raises(ReadError, match="the pose of its scan 1 is no turn and shift; export the scan again"):
            read_stations(process, content, wanted)


def test_more_points_than_a_block(folder, process):
    points = np.random.default_rng(2).random((450_001, 3))
    raw = read_stations(process, e57_bytes(folder / "many.e57", station(doubles(XYZ, points))))
    assert np.array_equal(raw.points, points)
    assert raw.stations.names == ("scan 1",)


# --- what points are ---


def test_invalid_points_are_dropped_and_counted(folder, process):
    state = whole(["cartesianInvalidState"], np.array([[0, 1, 2, 0, 0] * 10]).T, 0, 2)
    raw = read_stations(process, e57_bytes(folder / "a.e57", station(doubles(XYZ, FIRST) | state)))
    assert np.array_equal(raw.points, FIRST[state["cartesianInvalidState"][1] == 0])
    assert [note.message for note in raw.notes] == [
        "the file holds one station: 'scan 1' (30 points)",
        "20 of 50 points dropped: the file marks them as invalid",
    ]
    none = whole(["cartesianInvalidState"], np.full((50, 1), 2), 0, 2)
    with pytest.raises(ReadError, match="marks all 50 points of its stations as invalid"):
        read_stations(process, e57_bytes(folder / "a.e57", station(doubles(XYZ, FIRST) | none)))
    both = e57_bytes(folder / "a.e57", station(doubles(XYZ, FIRST)), station(doubles(XYZ, FIRST) | none, "Hall"))
    with pytest.raises(ReadError, match="marks all 50 points of its station 'Hall' as invalid"):
        read_stations(process, both, "Hall")


def test_spherical_coordinates(folder, process):
    x, y, z = FIRST.T
    ranges = np.linalg.norm(FIRST, axis=1)
    angles = np.stack([ranges, np.arctan2(y, x), np.arcsin(z / ranges)], axis=1)
    fields = doubles(("sphericalRange", "sphericalAzimuth", "sphericalElevation"), angles)
    state = whole(["sphericalInvalidState"], np.array([[0] * 40 + [1] * 10]).T, 0, 2)
    raw = read_stations(process, e57_bytes(folder / "a.e57", station(fields | state, "", ABOUT_Z, (1.0, 2.0, 3.0))))
    assert raw.points == pytest.approx(turned(FIRST[:40]) + np.array([1.0, 2.0, 3.0]), abs=1e-12)
    # Ranges begin at the scanner, also without a pose.
    assert not read_stations(process, e57_bytes(folder / "a.e57", station(fields))).stations.places.any()


@pytest.mark.parametrize(
    ("kind", "limits", "top"),
    [
        (("integer", 0, 255), None, 255),
        (("integer", 0, 65535), None, 65535),
        (("integer", 0, 65535), (0, 1023), 1023),
        (("integer", 0, 255), (0, 255), 255),
        ("single", (0.0, 1.0), 1.0),
        ("double", (100.0, 200.0), None),
    ],
)
def test_colours_are_scaled_by_their_limits(folder, process, kind, limits, top):
    shares = np.array([[0.0, 0.2, 1.0], [0.6, 0.4, 0.8]])
    values = 100.0 + 100.0 * shares if top is None else shares * top
    values = values if isinstance(kind, str) else np.rint(values)
    fields = doubles(XYZ, FIRST[:2]) | {name: (kind, column) for name, column in zip(RGB, values.T, strict=True)}
    raw = read_stations(process, e57_bytes(folder / "a.e57", station(fields, limits=limits)))
    assert np.array_equal(raw.colors, np.rint(255 * shares))


def test_colours_without_limits_are_dropped_with_a_note_and_stations_without_colours_are_black(folder, process):
    fields = doubles(XYZ, FIRST) | doubles(RGB, np.abs(FIRST))
    raw = read_stations(process, e57_bytes(folder / "a.e57", station(fields)))
    assert raw.colors is None
    assert raw.notes[1].message == "colours dropped: the file does not state between which limits they lie"
    red = doubles(XYZ, FIRST) | whole(RGB, np.tile([255, 7, 9], (50, 1)), 0, 255)
    unknown = whole(["isColorInvalid"], np.array([[1] * 5 + [0] * 45]).T, 0, 1)
    raw = read_stations(process, e57_bytes(folder / "a.e57", station(red | unknown), station(doubles(XYZ, SECOND))))
    assert np.array_equal(raw.colors, [[0, 0, 0]] * 5 + [[255, 7, 9]] * 45 + [[0, 0, 0]] * 70)


def test_whole_numbers_state_the_step_of_the_coordinates(tmp_path, folder, process):
    points = np.round(FIRST, 3)
    content = e57_bytes(folder / "a.e57", station(scaled(XYZ, points, 0.001)))
    scan = read(tmp_path, content)
    assert scan.points == pytest.approx(points, abs=1e-12)
    assert np.array_equal(scan.stated_steps_m, [0.001] * 3)
    # Turned by 45 degrees about z, the rounding of x and y scatters over both; the wider of two stations counts.
    half = (math.cos(math.pi / 8.0), 0.0, 0.0, math.sin(math.pi / 8.0))
    fields = scaled(XYZ[:1], points[:, :1], 0.001) | scaled(XYZ[1:], np.round(points[:, 1:], 2), 0.01)
    both = e57_bytes(folder / "a.e57", station(fields, "", half), station(scaled(XYZ, points, 0.001)))
    across = math.hypot(0.001, 0.01) / math.sqrt(2.0)
    assert read_stations(process, both).step == pytest.approx([across, across, 0.01])
    kilometres = whole(XYZ, np.array([[3_000_000_000, -5, 0], [3_000_000_001, 70_000, 9]]), -(2**33), 2**33)
    raw = read_stations(process, e57_bytes(folder / "a.e57", station(kilometres)))
    assert np.array_equal(raw.points, [[3e9, -5.0, 0.0], [3e9 + 1.0, 7e4, 9.0]])
    assert np.array_equal(raw.step, [1.0] * 3)


def test_other_fields_and_other_names_are_left_alone(folder, process):
    more = doubles(["intensity", "timeStamp"], FIRST[:, :2]) | whole(["rowIndex"], np.full((50, 1), 70_000), 0, 99_999)
    names = ("Aufnahme Süd\n", "x" * 300)
    content = e57_bytes(folder / "a.e57", *(station(doubles(XYZ, FIRST) | more, name) for name in names))
    raw = read_stations(process, content)
    assert np.array_equal(raw.points, np.concatenate([FIRST, FIRST]))
    assert raw.stations.names == ("Aufnahme Süd", "x" * 200)


# --- what is wrong with a file ---


def test_folders_and_uploads_offer_the_suffix():
    assert ".e57" in FOLDER_SUFFIXES


def edited(content, before, after):
    """The file with other words of the same length in its header, and the checksums of that."""
    assert content.count(before) == 1
    assert len(before) == len(after)
    return with_checksums(content.replace(before, after))


def lying(content, count):
    """The file with another count of its first points, of seven digits."""
    return edited(content, b'recordCount="50">\n        <', b'recordCount="%07d">\n   <' % count)


def test_bad_e57(tmp_path, folder, two):
    no_points = e57_bytes(folder / "a.e57", station(doubles(XYZ, np.zeros((0, 3)))))
    no_fields = e57_bytes(folder / "a.e57", station(doubles(["intensity"], FIRST[:, :1])))
    bad_pose = e57_bytes(folder / "a.e57", station(doubles(XYZ, FIRST), "", (0.0, 0.0, 0.0, 0.0), GRID))
    for name, content, words in (
        ("magic.e57", b"ASTM-E57", "its E57 header ends after 8 of 48 bytes"),
        ("short.e57", two[:-1024], f"its E57 header states {len(two)} bytes but it has {len(two) - 1024}"),
        ("flipped.e57", two[:500] + bytes([two[500] ^ 1]) + two[501:], "its E57 data are damaged (checksum mismatch"),
        (
            "more.e57",
            edited(two, b'recordCount="50"', b'recordCount="99"'),
            "its scan 1 states 99 points but 50 follow",
        ),
        ("lying.e57", lying(two, 5_000_000), "states 5000070 points in "),
        ("none.e57", no_points, "holds no points with coordinates"),
        ("fields.e57", no_fields, "holds no points with coordinates"),
        ("pose.e57", bad_pose, "the pose of its scan 1 is no turn and shift"),
        ("xml.e57", edited(two, b"</data3D>", b"</data3E>"), "E57 data are damaged"),
        ("data.e57", with_checksums(two.replace(b"data3D", b"data3E")), "is E57 without scans (data3D)"),
    ):
        with pytest.raises(ReadError) as caught:
            read(tmp_path, content, name)
        check_form(tmp_path / name, str(caught.value))
        assert words in str(caught.value)


@pytest.mark.parametrize("repaired", [False, True])
def test_two_hundred_damaged_files_give_a_sentence_or_a_scan(process, two, repaired):
    rng = np.random.default_rng(7)
    n_read, slowest_s, said = 0, 0.0, []
    for _ in range(N_DAMAGED):
        content = damaged(two, rng)
        content = with_checksums(content) if repaired else content
        began = time.monotonic()
        try:
            raw = read_stations(process, content)
        except ReadError as error:
            said.append(str(error))
        else:
            n_read += 1
            assert len(raw.points) <= 120
        slowest_s = max(slowest_s, time.monotonic() - began)
    assert all(words.isprintable() and "; " in words for words in said)
    assert n_read > 0 or not repaired
    # By the clock, since the work is another process's: a busy machine may hold it up, a hang would take its limit.
    assert slowest_s < 5.0


def test_an_end_of_the_library_is_a_sentence_and_the_next_file_is_read(monkeypatch, two):
    with E57Process() as own:
        for code in ("import os; os.abort()", "print('{')", "print('x' * 9_000_000)"):
            with monkeypatch.context() as patch:
                patch.setattr(e57_process, "COMMAND", [sys.executable, "-c", code])
                with pytest.raises(ReadError, match="the library that reads E57 broke off over it"):
                    own.open(two)
        assert len(read_stations(own, two).points) == 120


def test_no_module_of_the_working_folder_is_run(tmp_path, monkeypatch, two):
    for name in ("json", "numpy", "pye57"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'was_run')!r}, 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    with E57Process() as own:
        assert len(read_stations(own, two).points) == 120
    assert not (tmp_path / "was_run").exists()


def test_a_library_that_runs_on_is_ended(monkeypatch, two):
    monkeypatch.setattr(e57_process, "PATIENCE_S", 0.2)
    monkeypatch.setattr(e57_process, "COMMAND", [sys.executable, "-c", "import time; time.sleep(60)"])
    began = time.monotonic()
    with E57Process() as own, pytest.raises(ReadError, match="broke off over it"):
        own.open(two)
    assert time.monotonic() - began < 20.0


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory of a process")
@pytest.mark.parametrize(
    ("trick", "words"),
    [
        ("child._SPARE_BYTES = 2**26; child._File = lambda *_: list(iter(int, 1))", "takes more memory than an E57 of"),
        ("child._File = lambda *_: max(iter(int, 1))", "the library that reads E57 broke off over it"),
    ],
)
def test_a_file_that_fills_the_memory_or_takes_long_is_a_sentence(monkeypatch, two, trick, words):
    code = f"from stair_inspector.files import e57_child as child; {trick}; child.main()"
    monkeypatch.setattr(e57_process, "COMMAND", [sys.executable, "-c", code])
    began = time.monotonic()
    with E57Process() as own, pytest.raises(ReadError, match=words):
        own.open(two)
    assert time.monotonic() - began < 60.0


def test_no_copy_and_no_process_is_left(tmp_path, monkeypatch, two):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with E57Process() as own:
        own.open(two)
        child = own.process_id
        assert not any(tmp_path.iterdir())
    with pytest.raises(ProcessLookupError):
        os.kill(child, 0)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "none"))
    with E57Process() as own, pytest.raises(ReadError, match=r"cannot be copied to .*; make room there"):
        own.open(two)


def test_without_pye57_there_is_a_sentence(monkeypatch, two):
    monkeypatch.setitem(sys.modules, "pye57", None)
    with pytest.raises(ReadError, match=r"is E57, which needs the package pye57; pip install pye57 .*, or export"):
        read_e57(two)


def test_lying_counts_allocate_nothing(process, two):
    tracemalloc.start()
    for count in (90, len(two) - 70, len(two), 9_999_999):
        with pytest.raises(ReadError):
            read_stations(process, lying(two, count))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 5e6
