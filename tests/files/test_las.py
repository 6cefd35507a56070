"""LAS and LAZ: exact coordinates, classes, flags and colours of every point format; the finding of a coarse scale."""

import io
import sys
import tracemalloc

import laspy
import numpy as np
import pytest

from stair_inspector.errors import ReadError
from stair_inspector.files.las_scan import read_las
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import FOLDER_SUFFIXES, read_scan
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.examine import examine
from tests.files.damage import N_DAMAGED, check_form, n_read_of_damaged
from tests.synthetic import Stair

GRID_ORIGIN = np.array([500_000.0, 5_400_000.0, 100.0])
POINTS = np.array([[0.5, 1.25, -2.0], [1.5, 1.0, 3.0], [0.25, 4.0, 5.0], [8.0, 1.0, 6.5]])
WITH_COLORS = (2, 3, 5, 7, 8, 10)
PACKED = (0, 1, 2, 3, 6, 7, 8)
"""Those that lazrs packs: the others hold waveforms."""


def las_file(points, *, form=6, packed=False, scale=0.0001, offset=(0.0, 0.0, 0.0), version=None, **fields):
    """The bytes of a LAS or LAZ file of points, in the least version that has the point format."""
    least = "1.2" if form < 4 else "1.3" if form < 6 else "1.4"
    header = laspy.LasHeader(point_format=form, version=version or least)
    header.scales, header.offsets = [scale] * 3, list(offset)
    made = laspy.LasData(header)
    made.x, made.y, made.z = np.asarray(points).T
    for name, values in fields.items():
        setattr(made, name, values)
    stream = io.BytesIO()
    made.write(stream, do_compress=packed)
    return stream.getvalue()


def read(tmp_path, content, name="a.las", unit="m"):
    (tmp_path / name).write_bytes(content)
    return read_scan(tmp_path / name, unit)


# --- truth ---


@pytest.mark.parametrize(("form", "packed"), [(k, False) for k in range(11)] + [(k, True) for k in PACKED])
def test_every_point_format_is_read_exactly(tmp_path, form, packed):
    rng = np.random.default_rng(form)
    whole = rng.integers(-40_000, 40_000, (500, 3))
    scan = read(tmp_path, las_file(whole * 0.0001 + GRID_ORIGIN, form=form, packed=packed, offset=GRID_ORIGIN))
    # The same double numbers as LAS prescribes: whole numbers times the scale plus the offset.
    assert np.array_equal(scan.points + scan.origin_m, whole * 0.0001 + GRID_ORIGIN)
    assert np.array_equal(scan.stated_steps_m, [0.0001] * 3)
    assert scan.colors is None
    assert not scan.notes


def test_more_points_than_a_block_and_a_chunk(tmp_path):
    rng = np.random.default_rng(1)
    points = np.round(rng.random((600_000, 3)), 4)
    points = np.unique(points, axis=0)
    scan = read(tmp_path, las_file(points, packed=True))
    assert np.abs(scan.points - points).max() < 1e-9


def sizes_of(scan):
    """Rise, going and width of each step with their u, (n, 3, 2); NaN where there is none."""
    sizes = [(step.rise_m, step.going_m, step.width_m) for step in inspect(scan, Params()).steps]
    return np.array([[(each.value, each.u) if each else (np.nan, np.nan) for each in of_step] for of_step in sizes])


@pytest.mark.slow
def test_a_stair_is_measured_as_from_ply(tmp_path):
    points, _ = Stair(noise=0.002, risers=True).sample()
    plain = tmp_path / "a.ply"
    plain.write_bytes(ply_bytes(points))
    expected = sizes_of(read_scan(plain))
    found = sizes_of(read(tmp_path, las_file(points, scale=0.00001), unit="auto"))
    assert expected.shape == (5, 3, 2)
    off = np.abs(found - expected)[..., 0] / expected[..., 1]
    assert np.nanmax(off) < 1.0 / 3.0
    assert np.array_equal(np.isnan(found), np.isnan(expected))
    # Packed or not, and at any scale, the values are those of the same numbers in PLY.
    plain.write_bytes(ply_bytes(np.round(points, 4)))
    assert sizes_of(read(tmp_path, las_file(points, packed=True))) == pytest.approx(
        sizes_of(read_scan(plain)), abs=1e-7, nan_ok=True
    )


def test_a_scale_of_a_centimetre_is_found_and_has_a_cure(tmp_path):
    points, _ = Stair(noise=0.002, risers=True).sample()
    found = examine(read(tmp_path, las_file(points, scale=0.01)))
    (said,) = [each for each in found.observations if each.code == "coordinates_rounded"]
    assert said.message.startswith("the coordinates are rounded to 10 mm")
    assert "LAS or LAZ with a scale of 0.0001 m" in said.cure
    assert np.allclose(found.steps_m, 0.01)


def test_the_scale_counts_where_points_are_too_few_to_show_it(tmp_path):
    found = examine(read(tmp_path, las_file(POINTS, scale=0.005)))
    assert np.allclose(found.steps_m, 0.005)
    assert not examine(read(tmp_path, las_file(POINTS, scale=0.00001))).steps_m.any()


def test_numbers_coarser_than_the_scale_count_as_they_are(tmp_path):
    points, _ = Stair(noise=0.002, risers=True).sample()
    found = examine(read(tmp_path, las_file(np.round(points, 2), scale=0.001)))
    assert np.allclose(found.steps_m, 0.01)


# --- colours, classes, flags ---


@pytest.mark.parametrize("form", WITH_COLORS)
@pytest.mark.parametrize("factor", [1, 257])
def test_colours_of_8_and_of_16_bits(tmp_path, form, factor):
    colors = np.array([[255, 0, 1], [2, 128, 254], [7, 8, 9], [0, 0, 0]])
    red, green, blue = (colors * factor).astype(np.uint16).T
    scan = read(tmp_path, las_file(POINTS, form=form, red=red, green=green, blue=blue))
    assert np.array_equal(scan.colors, colors)


@pytest.mark.parametrize("form", [0, 3, 6, 7])
@pytest.mark.parametrize("packed", [False, True])
def test_noise_and_withheld_points_are_dropped_and_counted(tmp_path, form, packed):
    points = np.arange(30.0).reshape(10, 3)
    classes = np.array([1, 2, 6, 7, 18, 7, 0, 12, 9, 5], dtype=np.uint8)
    withheld = np.array([0, 0, 0, 1, 0, 0, 0, 0, 1, 0], dtype=np.uint8)
    synthetic = np.array([1, 0, 0, 0, 0, 0, 1, 0, 1, 0], dtype=np.uint8)
    flags = {"classification": classes, "withheld": withheld, "synthetic": synthetic}
    scan = read(tmp_path, las_file(points, form=form, packed=packed, **flags))
    assert np.array_equal(scan.points, points[[0, 1, 2, 6, 7, 9]])
    assert [(note.code, note.message) for note in scan.notes] == [
        ("noise_dropped", "3 of 10 points dropped: the file classes them as noise (7 or 18)"),
        ("withheld_dropped", "1 of 10 points dropped: the file withholds them"),
        ("synthetic_points", "2 of 10 points are marked as synthetic, not measured; they are kept"),
    ]


def test_folders_and_uploads_offer_both_suffixes():
    assert {".las", ".laz"} <= set(FOLDER_SUFFIXES)


# --- what is wrong with a file ---

LAS, LAZ = las_file(POINTS, form=3), las_file(POINTS, form=3, packed=True)
LAYERED = las_file(POINTS, form=7, packed=True)
BEGIN = int.from_bytes(LAZ[96:100], "little")
BEGIN_LAYERED = int.from_bytes(LAYERED[96:100], "little")


def with_bytes(content, at, new):
    return content[:at] + new + content[at + len(new) :]


BAD = {
    "magic.las": (b"LASF", "header ends after 4 of 227 bytes"),
    "short.las": (LAS[:-1], "truncated"),
    "long.las": (LAS + b"\1" * 40, "40 bytes more than the 4 points"),
    "lying.las": (with_bytes(LAS, 107, b"\xff\xff\xff\x7f"), "states 2147483647 points of 34 bytes"),
    "none.las": (with_bytes(LAS, 107, bytes(4)), "states 0 points"),
    "version.las": (with_bytes(LAS, 25, b"\x07"), "is LAS version 1.7"),
    "format.las": (with_bytes(LAS, 104, b"\x0b"), "points of format 11"),
    "length.las": (with_bytes(LAS, 105, b"\x05\0"), "points of format 3 with 5 bytes"),
    "scale.las": (with_bytes(LAS, 131, bytes(8)), "are no lengths"),
    "nanscale.las": (with_bytes(LAS, 131, b"\xff" * 8), "are no lengths"),
    "begin.las": (with_bytes(LAS, 96, b"\xff\xff\xff\xff"), "points begin at byte 4294967295"),
    "noise.las": (las_file(POINTS, classification=np.full(4, 7, np.uint8)), "all its 4 points are classed as noise"),
    "short.laz": (LAZ[: BEGIN + 20], "truncated"),
    "lying.laz": (with_bytes(LAZ, 107, b"\xff\xff\xff\x7f"), "states 2147483647 LAZ points"),
    "more.laz": (with_bytes(LAZ, 107, b"\x20\0\0\0"), "its LAZ points are damaged"),
    "table.laz": (with_bytes(LAZ, BEGIN, b"\xff" * 7 + b"\x7f"), "chunk table lies at"),
    "record.laz": (with_bytes(LAZ, BEGIN - 6, b"\x63"), "in a way that is not known"),
    "norecord.laz": (LAZ.replace(b"laszip encoded", b"laszap encoded"), "without the record"),
    "layers.laz": (with_bytes(LAYERED, BEGIN_LAYERED + 8 + 36 + 4, b"\xff\xff\xff\x7f"), "ends beyond the points"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_las(tmp_path, name):
    content, words = BAD[name]
    tracemalloc.start()
    with pytest.raises(ReadError) as caught:
        read(tmp_path, content, name)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    check_form(tmp_path / name, str(caught.value))
    assert words in str(caught.value)
    assert peak < 5e6


def test_without_lazrs_laz_is_a_sentence_and_las_is_read(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "lazrs", None)
    with pytest.raises(
        ReadError, match=r"is LAZ, which needs the package lazrs .*; pip install lazrs, or export it as"
    ):
        read(tmp_path, LAZ, "a.laz")
    assert len(read(tmp_path, LAS).points) == 4


@pytest.mark.parametrize("name", ["a.las", "a.laz", "layered.laz"])
def test_two_hundred_damaged_files_give_a_sentence_or_a_scan(name):
    assert n_read_of_damaged(name, {"a.las": LAS, "a.laz": LAZ, "layered.laz": LAYERED}[name], seed=3) < N_DAMAGED
    # Damage that strikes the numbers alone is read.
    at = len(LAS) - 34 * 4
    assert len(read_las(with_bytes(LAS, at, b"\1\2\3")).points) == 4


def test_truncation_at_every_byte_is_a_sentence():
    for content in (LAS, LAZ, LAYERED):
        begin = int.from_bytes(content[96:100], "little")
        for cut in range(4, begin + 40):
            with pytest.raises(ReadError):
                read_las(content[:cut])
