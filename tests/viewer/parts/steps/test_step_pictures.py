"""A step's own pictures: the residual map is the points' own distances in their own places, read back from the PNG."""

import base64
import dataclasses
import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from stair_inspector.pictures.ramps import DIVERGING, signed_limit
from stair_inspector.pictures.residuals import residual_map
from stair_inspector.viewer.parts.steps.step_pictures import card_pictures, residual_html, step_section_svg
from tests.viewer.surveyed import PALETTE, bumped, surveyed


def pixels_of(source):
    data = re.search(r"data:image/png;base64,([A-Za-z0-9+/=]+)", source).group(1)
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))))


def test_the_picture_has_the_colours_of_the_map_and_nothing_where_there_are_no_points():
    scan, inspection, _ = bumped(np.eye(3))
    found = residual_map(scan, inspection, inspection.steps[1])
    pixels = pixels_of(residual_html(scan, inspection, inspection.steps[1]))
    assert pixels.shape[:2] == found.residuals_m.shape
    np.testing.assert_array_equal(pixels[..., 3] == 255, np.isfinite(found.residuals_m))
    limit = signed_limit(found.residuals_m)
    is_bump = found.residuals_m > 0.005
    assert 0.2 < is_bump.mean() < 0.3
    assert (pixels[is_bump, 0] > pixels[is_bump, 2] + 20).all()
    flat = np.abs(found.residuals_m) < 0.05 * limit
    assert np.abs(pixels[flat, :3].astype(int) - DIVERGING[4]).max() < 15


def test_the_nosing_lies_at_the_lower_edge_of_the_map():
    scan, inspection, _ = surveyed()
    source = residual_html(scan, inspection, inspection.steps[1])
    svg = ElementTree.fromstring(source[: source.index("</svg>") + 6] + "</div>")[0]
    image = next(node for node in svg.iter() if node.tag.endswith("image"))
    line = next(node for node in svg.iter() if node.tag.endswith("line"))
    bottom = float(image.get("y")) + float(image.get("height"))
    ends = [float(line.get(name)) for name in ("y1", "y2")]
    assert ends == pytest.approx([bottom, bottom], abs=0.06 * float(image.get("height")))
    # From the step's left to its right, which may end anywhere in the last cell.
    found = residual_map(scan, inspection, inspection.steps[1])
    cell = float(image.get("width")) / found.residuals_m.shape[1]
    assert float(line.get("x1")) == pytest.approx(float(image.get("x")), abs=cell)
    assert float(line.get("x2")) == pytest.approx(float(image.get("x")) + float(image.get("width")), abs=cell)


def test_the_card_says_the_limits_of_its_scale_in_millimetres_and_names_the_step():
    scan, inspection, _ = bumped(np.eye(3))
    source = card_pictures(scan, inspection, inspection.steps[1], PALETTE)
    assert "plane residuals of step 2" in source
    assert "+10" in source
    assert "of no step" not in source
    assert source.count("<svg") == 2


def test_the_cross_section_shows_the_step_with_its_dimensions_and_its_neighbours():
    scan, inspection, _ = surveyed()
    source = step_section_svg(scan, inspection, inspection.steps[1], PALETTE, "in")
    assert {int(number) for number in re.findall(r'data-step="(\d+)"', source)} == {1, 2, 3}
    assert "6 11/16 in (6.701 ± 0.016)" in source
    assert "11 in (11.024 ± 0.016)" in source


def test_a_landing_and_a_step_of_which_nothing_was_measured_have_pictures_too():
    scan, inspection, _ = surveyed()
    bare = dataclasses.replace(
        inspection.steps[4],
        **dict.fromkeys(("rise_m", "going_m", "nosing", "line_points", "climb", "flight")),
    )
    for step in (inspection.steps[4], bare):
        source = card_pictures(scan, inspection, step, PALETTE)
        assert source.count("<svg") == 2
        assert f'data-step="{step.step_id}"' in source


def test_without_a_step_or_a_plane_there_is_no_picture():
    scan, inspection, _ = surveyed()
    assert "<svg" not in card_pictures(scan, inspection, None, PALETTE)
    assert "<svg" not in card_pictures(scan, None, None, PALETTE)
    plane = dataclasses.replace(inspection.steps[0].plane, normal=None, rms_m=None)
    step = dataclasses.replace(inspection.steps[0], plane=plane)
    assert residual_map(scan, inspection, step) is None
    assert "No plane could be fitted" in residual_html(scan, inspection, step)
