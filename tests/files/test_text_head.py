"""What stands above a table of points in a text: headers, remarks, labels and units; and commas with two readings."""

import numpy as np
import pytest

from stair_inspector.errors import ReadError
from stair_inspector.files.text_scan import read_text

POINTS = np.array([[1.125, 2.25, -0.5], [1.5, 2.75, 0.25], [10.25, 3.0, 1.75], [4.125, 3.5, 2.0]])


def rows(*behind, separator=" ", before=""):
    return "".join(
        separator.join([*([before.format(k)] if before else []), *(f"{v:.3f}" for v in point), *behind]) + "\n"
        for k, point in enumerate(POINTS.tolist(), 1)
    )


HEADS = {
    "numbers are no names": ("# E: 500000.0 N: 5000000.0 H: 100.0\n" + rows("1", "2", "3"), None),
    "whole numbers are no names": ("# scanner X 12 Y 13 Z\n" + rows("1", "2", "3"), None),
    "numbers behind marks": ("# offset x: 0 y: 0 z: 0\n" + rows("1", "2", "3", "4"), None),
    "a label": ("# columns: x y z\n" + rows("7"), None),
    "a label before all": ("# data fields: intensity x y z\n" + rows(before="{}"), None),
    "a header before a remark": ("X Y Z Red Green Blue\n# E N H of the marks\n" + rows("1", "2", "3"), None),
    "unit after in": ("# units: in mm\n" + rows(), "mm"),
    "inches": ("# units: in\n" + rows(), "in"),
    "an angle": ("# angle unit: in degrees\n" + rows(), None),
    "an angle in a length": ("# intensity unit: in\n# unit: m\n" + rows(), "m"),
    "in a number": ("# units: in 10 mm\n" + rows(), None),
    "a velocity after in": ("# units: in m/s\n" + rows(), None),
    "a velocity": ("# unit: m/s\n" + rows(), None),
    "unit in brackets after in": ("x (in mm),y (in mm),z (in mm)\n" + rows(separator=","), "mm"),
    "axes said twice": ("X (East),Y (North),Z (Up)\n" + rows(separator=","), None),
    "letters behind names": ("Easting (E);Northing (N);Elevation (Z)\n" + rows(separator=";"), None),
    "numbers behind a mark": (rows(separator=",", before="Point #{}"), None),
}


@pytest.mark.parametrize("name", HEADS)
def test_what_stands_above_points_is_read_as_it_is_meant(name):
    content, unit = HEADS[name]
    cloud = read_text(content.encode())
    assert np.array_equal(cloud.points, POINTS)
    assert cloud.unit == unit


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("Latitude,Longitude,Height\n" + rows(separator=","), "names a latitude or longitude: degrees are not read"),
        ("X 12 Y 13 Z 14\n" + rows("1", "2", "3"), "not all of its columns are numbers"),
    ],
)
def test_heads_that_are_refused(content, words):
    with pytest.raises(ReadError, match=words):
        read_text(content.encode())


@pytest.mark.parametrize("form", ["{:.3f}", "{:.5e}", "{:.4g}"])
@pytest.mark.parametrize(("before", "behind"), [("", ("7",)), ("", ("7", "8", "255")), ("{}", ()), ("", ())])
def test_decimal_commas_between_commas_are_refused(form, before, behind):
    values = np.random.default_rng(2).uniform(-3.0, 3.0, (200, 3)).round(3) + 1e-3
    values = values[(values * 100 % 1 > 0.01).all(axis=1) & (abs(values) > 0.1).all(axis=1)] if "g" in form else values
    cells = [[form.format(v).replace(".", ",") for v in point] for point in values.tolist()]
    lines = [",".join([*([str(k)] if before else []), *point, *behind]) for k, point in enumerate(cells)]
    lines = [line for line in lines if line.count(",") == lines[0].count(",")]
    with pytest.raises(ReadError, match="decimal commas between commas"):
        read_text("\n".join(lines).encode())


def test_whole_numbers_between_commas_are_read():
    points = np.random.default_rng(3).integers(-1500, 1500, (50, 3))
    content = "".join(f"{x},{y},{z},{k},{k % 9},{9 * k % 256},7\n" for k, (x, y, z) in enumerate(points.tolist()))
    assert np.array_equal(read_text(content.encode()).points, points)
