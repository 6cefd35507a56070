"""Plan and section as geometry and as SVG: every value of the inspection is a dimension, nothing unseen is a number."""

import dataclasses
import itertools
import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from stair_inspector.drawings.model import Arrow, Dimension, Drawing, Path, Words, readable_deg
from stair_inspector.drawings.plan import plan
from stair_inspector.drawings.section import section
from stair_inspector.drawings.sheet import sheet_svg
from stair_inspector.drawings.sheets import MOST_STEPS, plan_svgs, section_svgs
from stair_inspector.model import Flight
from stair_inspector.pictures import svg
from tests.content.staircases import TURNS, staircase
from tests.synthetic import rotation

SVG = "{http://www.w3.org/2000/svg}"
TEXT_MM = 45.0
SHAPES = {
    "one step": staircase((1,)),
    "straight": staircase((7,)),
    "two in line": staircase((5, 6), TURNS["none"]),
    "left": staircase((5, 6), TURNS["left"]),
    "right": staircase((5, 6), TURNS["right"]),
    "back": staircase((6, 6), TURNS["back"]),
    "three flights": staircase((4, 4, 4), (0.0, 90.0, 180.0)),
    "sixty": staircase((60,)),
    "lying": staircase((5, 6), TURNS["left"], rotation=rotation("x", 75.0) @ rotation("y", -40.0)),
}
EACH_SHAPE = pytest.mark.parametrize("inspection", SHAPES.values(), ids=SHAPES)


def values(inspection, name):
    found = [(step, getattr(step, f"{name}_m")) for step in inspection.steps]
    return sorted(value.value * 1000.0 for _, value in found if value is not None)


def on_layer(drawing, layer):
    return sorted(part.value_mm for part in drawing.dimensions() if part.layer == layer)


def words_of(drawing):
    return [part.text for part in drawing.parts if isinstance(part, Words)]


@EACH_SHAPE
def test_the_plan_dimensions_every_going_and_every_width_as_measured(inspection):
    drawing = plan(inspection, TEXT_MM)
    np.testing.assert_allclose(on_layer(drawing, "STAIR-DIM-GOING"), values(inspection, "going"), atol=1e-6)
    np.testing.assert_allclose(on_layer(drawing, "STAIR-DIM-WIDTH"), values(inspection, "width"), atol=1e-6)
    landings = [step for step in inspection.steps if step.kind == "landing"]
    depths = sorted(step.tread_depth_m.value * 1000.0 for step in landings)
    np.testing.assert_allclose(on_layer(drawing, "STAIR-DIM-DEPTH"), depths, atol=1e-6)


@EACH_SHAPE
def test_the_section_dimensions_every_rise_and_every_going_as_measured(inspection):
    drawing = section(inspection, TEXT_MM)
    np.testing.assert_allclose(on_layer(drawing, "STAIR-DIM-RISE"), values(inspection, "rise"), atol=1e-6)
    np.testing.assert_allclose(on_layer(drawing, "STAIR-DIM-GOING"), values(inspection, "going"), atol=1e-6)


@EACH_SHAPE
def test_heights_are_cumulated_from_the_foot_of_the_first_riser(inspection):
    drawing = section(inspection, TEXT_MM)
    found = [part.text for part in drawing.parts if isinstance(part, Words) and part.layer == "STAIR-HEIGHT"]
    rises = [step.rise_m.value * 1000.0 for step in inspection.steps]
    assert found == [f"+{height:.1f}" for height in itertools.accumulate(rises)]


@EACH_SHAPE
def test_every_step_has_its_number_once_in_either_drawing(inspection):
    for drawing in (plan(inspection, TEXT_MM), section(inspection, TEXT_MM)):
        numbers = [
            part.text
            for part in drawing.parts
            if isinstance(part, Words) and part.layer == "STAIR-NUMBER" and part.text.isdigit()
        ]
        assert sorted(map(int, numbers)) == [step.step_id for step in inspection.steps]


def test_the_plan_is_that_of_the_stair_itself():
    inspection = SHAPES["lying"]
    drawing = plan(inspection, TEXT_MM)
    nosings = [part.places for part in drawing.parts if isinstance(part, Path) and part.layer == "STAIR-NOSING"]
    assert len(nosings) == len(inspection.steps)
    climb, up = inspection.steps[0].climb, inspection.up.vector
    axes = np.stack([climb, np.cross(up, climb)])
    centre = inspection.steps[0].line_points[1]
    for step, places in zip(inspection.steps, nosings, strict=True):
        np.testing.assert_allclose(np.array(places), (step.nosing - centre) @ axes.T * 1000.0, atol=1e-6)


@pytest.mark.parametrize("name", ["back", "right", "left", "three flights"])
def test_no_chain_of_goings_crosses_a_tread(name):
    inspection = SHAPES[name]
    drawing = plan(inspection, TEXT_MM)
    climb, up = inspection.steps[0].climb, inspection.up.vector
    axes = np.stack([climb, np.cross(up, climb)])
    plates = [(step.corners - inspection.steps[0].line_points[1]) @ axes.T * 1000.0 for step in inspection.steps]
    for part in drawing.dimensions():
        if part.layer != "STAIR-DIM-GOING":
            continue
        middle = np.mean(part.feet, axis=0)
        for plate in plates:
            assert not _is_inside(middle, plate)


def _is_inside(place, plate):
    around = np.roll(plate, -1, axis=0)
    side = (around[:, 0] - plate[:, 0]) * (place[1] - plate[:, 1]) - (around[:, 1] - plate[:, 1]) * (
        place[0] - plate[:, 0]
    )
    return bool((side > 1.0).all() or (side < -1.0).all())


@pytest.mark.parametrize("name", ["straight", "left", "back"])
def test_the_walking_line_runs_up_the_stair_and_its_arrow_points_on(name):
    inspection = SHAPES[name]
    drawing = plan(inspection, TEXT_MM)
    paths = [part for part in drawing.parts if isinstance(part, Path) and part.layer == "STAIR-WALKING-LINE"]
    arrows = [part for part in drawing.parts if isinstance(part, Arrow)]
    climb, up = inspection.steps[0].climb, inspection.up.vector
    axes = np.stack([climb, np.cross(up, climb)])
    assert (len(paths), len(arrows), words_of(drawing).count("UP")) == (1, 1, 1)
    centres = [
        (step.line_points[1] - inspection.steps[0].line_points[1]) @ axes.T * 1000.0 for step in inspection.steps
    ]
    places = [place for place in paths[0].places if any(np.allclose(place, centre) for centre in centres)]
    np.testing.assert_allclose(places, centres, atol=1e-6)
    way = np.subtract(arrows[0].end, arrows[0].start)
    np.testing.assert_allclose(way / np.hypot(*way), axes @ inspection.steps[-1].climb, atol=1e-9)


def test_stairs_apart_have_lines_of_their_own():
    inspection = staircase((4, 4), TURNS["none"])
    above = [
        dataclasses.replace(step, line_points=step.line_points + np.array([0.0, 3.0, 0.7]), kind="tread")
        for step in inspection.steps[4:]
    ]
    apart = dataclasses.replace(inspection, steps=(*inspection.steps[:4], *above))
    assert words_of(plan(apart, TEXT_MM)).count("UP") == 2
    drawing = section(apart, TEXT_MM)
    np.testing.assert_allclose(on_layer(drawing, "STAIR-DIM-RISE"), values(apart, "rise"), atol=1e-6)


@pytest.mark.parametrize("draw", [plan, section])
def test_what_was_not_measured_is_said_and_never_a_number(draw):
    inspection = staircase((8,), missing_rise=(1, 5), missing_going=(4,))
    drawing = draw(inspection, TEXT_MM)
    said = [word for word in words_of(drawing) if "not measured" in word or word == "n. m."]
    assert len(said) == (1 if draw is plan else 3)
    assert len(drawing.dimensions()) == (7 - 1 + 8 + 1 if draw is plan else 6 + 6)
    assert all(part.value_mm > 100.0 for part in drawing.dimensions())
    no_width = [dataclasses.replace(step, width_m=None) for step in inspection.steps]
    drawing = draw(dataclasses.replace(inspection, steps=tuple(no_width)), TEXT_MM)
    if draw is plan:
        assert words_of(drawing).count("width not measured") == 8
        assert on_layer(drawing, "STAIR-DIM-WIDTH") == []


def test_the_last_step_of_a_flight_needs_no_going():
    assert not [word for word in words_of(plan(SHAPES["left"], TEXT_MM)) if "not measured" in word]
    assert not [word for word in words_of(section(SHAPES["left"], TEXT_MM)) if "not measured" in word]


def test_the_pitch_is_that_of_the_flight():
    inspection = SHAPES["left"]
    drawing = section(inspection, TEXT_MM)
    words = [part for part in drawing.parts if isinstance(part, Words) and part.layer == "STAIR-PITCH"]
    assert [word.text for word in words] == [f"flight {k}: pitch 31.2° ± 0.1°" for k in (1, 2)]
    lines = [part for part in drawing.parts if isinstance(part, Path) and part.layer == "STAIR-PITCH"]
    slopes = [math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])) for (a, b) in (line.places for line in lines)]
    assert slopes == pytest.approx([word.turn_deg for word in words])


@pytest.mark.parametrize("draw", [plan, section])
def test_without_nosings_there_is_no_drawing(draw):
    inspection = SHAPES["straight"]
    blind = [dataclasses.replace(step, line_points=None, nosing=None, climb=None) for step in inspection.steps]
    assert draw(dataclasses.replace(inspection, steps=tuple(blind)), TEXT_MM) is None
    bare = dataclasses.replace(inspection, steps=(), flights=())
    assert draw(bare, TEXT_MM) is None
    assert plan_svgs(bare) == section_svgs(bare) == ()


def test_the_plan_says_that_a_curved_flights_goings_follow_its_arc():
    inspection = SHAPES["straight"]
    curved = dataclasses.replace(inspection, flights=(dataclasses.replace(inspection.flights[0], shape="curved"),))
    said = ["of a flight that curves along its arc" in plan(each, TEXT_MM).notes[0] for each in (inspection, curved)]
    assert said == [False, True]


def test_a_flight_that_winds_has_its_goings_on_the_walking_line():
    inspection = SHAPES["straight"]
    winding: Flight = dataclasses.replace(inspection.flights[0], shape="spiral")
    drawing = plan(dataclasses.replace(inspection, flights=(winding,)), TEXT_MM)
    for part in drawing.dimensions():
        if part.layer == "STAIR-DIM-GOING":
            assert max(abs(place[1]) for place in part.feet) < 2.0 * TEXT_MM


def texts_in(drawn):
    return [node.text for node in ET.fromstring(drawn).iter(f"{SVG}text") if not node.get("aria-hidden")]


@EACH_SHAPE
def test_the_pictures_show_every_dimension_of_the_drawing(inspection):
    for draw, pictures in ((plan, plan_svgs(inspection)), (section, section_svgs(inspection))):
        wanted = sorted(part.text for part in draw(inspection, TEXT_MM).dimensions())
        shown = [word for _, drawn in pictures for word in texts_in(drawn)]
        found = sorted(word for word in shown if re.fullmatch(r"\d+\.\d", word))
        assert found == wanted


def test_a_long_stair_is_drawn_in_parts_that_can_be_read():
    pictures = section_svgs(SHAPES["sixty"])
    assert len(pictures) == 60 // MOST_STEPS
    assert [title for title, _ in pictures] == [
        f"Section along the walking line, steps {a} to {a + 19}" for a in (1, 21, 41)
    ]
    for _, drawn in pictures:
        root = ET.fromstring(drawn)
        sizes = [
            float(node.get("font-size"))
            for node in root.iter(f"{SVG}text")
            if re.fullmatch(r"\d+\.\d", node.text or "")
        ]
        assert min(sizes) >= 5.0
        width, height = map(float, root.get("viewBox").split()[2:])
        assert width == svg.PAGE
        assert height < 680.0


@EACH_SHAPE
def test_nothing_of_a_picture_lies_outside_of_it(inspection):
    for _, drawn in (*plan_svgs(inspection), *section_svgs(inspection)):
        root = ET.fromstring(drawn)
        width, height = map(float, root.get("viewBox").split()[2:])
        for node in root.iter(f"{SVG}line"):
            for x, y in (("x1", "y1"), ("x2", "y2")):
                assert -0.1 <= float(node.get(x)) <= width + 0.1
                assert -0.1 <= float(node.get(y)) <= height + 0.1


def test_the_scale_bar_is_true():
    _, drawn = plan_svgs(SHAPES["straight"])[0]
    root = ET.fromstring(drawn)
    going = SHAPES["straight"].steps[0].going_m.value
    quarters = [float(node.get("width")) for node in root.iter(f"{SVG}rect") if node.get("height") == "2.6"]
    words = [word for word in texts_in(drawn) if re.fullmatch(r"\d+ m?m", word)]
    length_m = float(words[0].split()[0]) / (1000.0 if words[0].endswith("mm") else 1.0)
    lines = [
        node
        for node in root.iter(f"{SVG}line")
        if node.get("stroke-width") == "0.45" and node.get("y1") == node.get("y2")
    ]
    lengths = [abs(float(node.get("x2")) - float(node.get("x1"))) for node in lines]
    assert any(length == pytest.approx(going * sum(quarters) / length_m, abs=0.06) for length in lengths)


@pytest.mark.parametrize(
    ("turn", "expected"), [(0, 0), (90, 90), (-90, 90), (180, 0), (135, -45), (-135, 45), (45, 45)]
)
def test_texts_are_read_from_below_or_from_the_right(turn, expected):
    assert readable_deg(turn) == pytest.approx(expected)


def test_hostile_words_in_a_drawing_stay_words():
    bad = '</text><script>x</script>"&'
    drawing = Drawing(
        "plan",
        bad,
        (bad,),
        (Words(bad, (0.0, 0.0), 10.0, "STAIR-TITLE"), Path(((0.0, 0.0), (500.0, 500.0)), "STAIR-OUTLINE")),
        10.0,
    )
    drawn = sheet_svg(drawing, 0.1)
    assert texts_in(drawn).count(bad) >= 1
    assert not list(ET.fromstring(drawn).iter(f"{SVG}script"))


def test_a_dimension_measures_along_its_direction_and_its_feet_are_as_far_apart():
    part = Dimension((0.0, 0.0), (300.0, 400.0), 0.0, (0.0, -50.0), "STAIR-DIM-GOING")
    assert part.value_mm == 300.0
    assert part.feet == ((0.0, -50.0), (300.0, -50.0))
    slant = dataclasses.replace(part, turn_deg=math.degrees(math.atan2(4.0, 3.0)))
    assert slant.value_mm == pytest.approx(500.0)
    assert math.dist(*slant.feet) == pytest.approx(500.0)


@pytest.mark.parametrize("factor", [0.001, 0.1, 1000.0])
def test_a_scan_of_a_wrong_unit_is_drawn_all_the_same(factor):
    inspection = scaled(SHAPES["left"], factor)
    for pictures in (plan_svgs(inspection), section_svgs(inspection)):
        ((_, drawn),) = pictures
        width, height = map(float, ET.fromstring(drawn).get("viewBox").split()[2:])
        assert width == svg.PAGE
        assert 20.0 < height < 700.0
        wanted = [f"{step.going_m.value * 1000.0:.1f}" for step in inspection.steps if step.going_m is not None]
        assert set(wanted) <= set(texts_in(drawn))


def scaled(inspection, factor):
    def measured(value):
        return None if value is None else dataclasses.replace(value, value=value.value * factor)

    steps = [
        dataclasses.replace(
            step,
            corners=step.corners * factor,
            nosing=step.nosing * factor,
            line_points=step.line_points * factor,
            **{name: measured(getattr(step, name)) for name in ("rise_m", "going_m", "tread_depth_m", "width_m")},
        )
        for step in inspection.steps
    ]
    return dataclasses.replace(inspection, steps=tuple(steps))
