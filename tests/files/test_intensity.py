"""How strongly points reflect, as each format has it, and what becomes of it."""

import io
from dataclasses import replace

import laspy
import numpy as np
import pytest

from stair_inspector.files.scans import read_scan
from stair_inspector.pictures.coloring import color_points
from stair_inspector.pictures.display import choose_display, display_of
from stair_inspector.pipeline import inspect
from stair_inspector.writers.segmented import segmented_bytes
from tests.files.e57_files import XYZ, doubles, e57_bytes, station
from tests.files.station_files import ptx_bytes
from tests.synthetic import Stair, exact_params

POINTS = np.round(np.random.default_rng(5).uniform(0.1, 3.0, (300, 3)), 4)
VALUES = np.arange(300) * 7 % 251
SHARES = VALUES / 256.0


def las():
    made = laspy.LasData(laspy.LasHeader(point_format=6, version="1.4"))
    made.header.scales, made.header.offsets = np.full(3, 0.0001), np.zeros(3)
    made.x, made.y, made.z = POINTS.T
    made.intensity = VALUES
    stream = io.BytesIO()
    made.write(stream)
    return stream.getvalue()


def ply(name):
    rows = np.zeros(300, dtype=[("x", "<f8"), ("y", "<f8"), ("z", "<f8"), ("i", "<f4")])
    rows["x"], rows["y"], rows["z"], rows["i"] = *POINTS.T, VALUES
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex 300\n{{}}property float {name}\nend_header\n"
    return head.format("".join(f"property double {axis}\n" for axis in "xyz")).encode() + rows.tobytes()


def pcd():
    head = "VERSION .7\nFIELDS x y z intensity\nSIZE 8 8 8 4\nTYPE F F F F\nWIDTH 300\nHEIGHT 1\nDATA ascii\n"
    return (head + text(VALUES)).encode()


def text(values):
    return "".join(f"{x} {y} {z} {value}\n" for (x, y, z), value in zip(POINTS.tolist(), values, strict=True))


def ptx():
    rows = "".join(f"{x} {y} {z} {share}\n" for (x, y, z), share in zip(POINTS.tolist(), SHARES, strict=True))
    head = ptx_bytes((POINTS, np.eye(3), (0, 0, 0))).decode().splitlines()[:10]
    return ("\n".join(head) + "\n" + rows).encode()


FILES = {
    "a.las": (las, VALUES),
    "a.ply": (lambda: ply("intensity"), VALUES),
    "b.ply": (lambda: ply("scalar_Intensity"), VALUES),
    "a.pcd": (pcd, VALUES),
    "a.ptx": (ptx, SHARES),
    "a.pts": (lambda: (f"300\n{text(VALUES)}").encode(), VALUES),
    "a.xyz": (lambda: text(VALUES).encode(), VALUES),
    "a.csv": (lambda: ("x y z Intensity\n" + text(VALUES)).encode(), VALUES),
}


@pytest.mark.parametrize("name", FILES)
def test_intensity_of_every_format_is_kept(tmp_path, name):
    make, values = FILES[name]
    (tmp_path / name).write_bytes(make())
    scan = read_scan(tmp_path / name, unit="m")
    assert np.allclose(scan.intensities, values, rtol=1e-6)


def test_intensity_of_e57_is_kept_and_missing_where_a_station_has_none(tmp_path):
    shining, plain = doubles(XYZ, POINTS) | {"intensity": ("single", SHARES)}, doubles(XYZ, POINTS + 4.0)
    e57_bytes(tmp_path / "a.e57", station(shining), station(plain))
    scan = read_scan(tmp_path / "a.e57")
    assert np.allclose(scan.intensities[:300], SHARES, atol=1e-6)
    assert np.isnan(scan.intensities[300:]).all()


def test_one_intensity_for_all_points_is_none(tmp_path):
    (tmp_path / "a.xyz").write_text(text(np.full(300, 7)))
    assert read_scan(tmp_path / "a.xyz", unit="m").intensities is None


def shining(values):
    scan = Stair(spacing=0.04).scan()
    return replace(scan, intensities=np.resize(values, len(scan.points)).astype(np.float64))


def test_a_cloud_without_colours_is_grey_by_intensity_between_percentiles():
    values = np.r_[np.linspace(100.0, 200.0, 99), 60_000.0]
    display = choose_display(shining(values))
    assert (display.colors == display.greys).all()
    assert (display.greys[:, 0] == display.greys[:, 2]).all()
    grey = display.greys[:99, 0].astype(int)
    assert (np.diff(grey) >= 0).all()
    # One point that reflects far more than all others leaves these what they are.
    assert grey[0] < 40
    assert grey[97] > 200


def test_drawn_points_that_reflect_alike_have_one_grey():
    scan = shining([4e9])
    assert (display_of(scan, np.arange(50)).greys == choose_display(shining([7.0])).greys[0]).all()


def test_colouring_by_intensity_takes_the_greys_or_says_that_there_are_none():
    scan = shining(VALUES)
    display = choose_display(scan)
    inspection = inspect(scan, exact_params())
    assert (color_points("Intensity", inspection, display, None).colors == display.greys).all()
    without = choose_display(Stair(spacing=0.04).scan())
    assert without.greys is None
    coloring = color_points("Intensity", inspection, without, None)
    assert coloring.legend.title == "the scan does not say how strongly it reflects"
    assert (coloring.colors == coloring.colors[0]).all()


@pytest.mark.parametrize(
    ("values", "written"), [(VALUES, VALUES), (SHARES, np.rint(SHARES * 65535)), (VALUES - 100.0, None)]
)
def test_the_segmented_scan_carries_it_as_16_bits_in_laz_and_as_it_is_in_ply(tmp_path, values, written):
    scan = shining(values)
    inspection = inspect(scan, exact_params())
    laz = laspy.read(io.BytesIO(segmented_bytes(scan, inspection, "laz")))
    n = len(values)
    if written is None:
        assert (laz.intensity[:n].min(), laz.intensity[:n].max()) == (0, 65535)
    else:
        assert (laz.intensity[:n] == written).all()
    (tmp_path / "a.ply").write_bytes(segmented_bytes(scan, inspection, "ply"))
    again = read_scan(tmp_path / "a.ply", unit="m")
    assert np.array_equal(again.intensities, scan.intensities)
