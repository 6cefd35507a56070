"""The drawing of a section, read back from the SVG itself: to scale both ways, every step where it is, no script."""

import dataclasses
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from stair_inspector.model import Measured
from stair_inspector.pictures.frames import section_frame
from stair_inspector.viewer.scene.section_svg import MOST_DOTS, profile_svg, title_of
from stair_inspector.viewer.scene.sections import Profile, cut, profile_of
from tests.synthetic import rotation
from tests.viewer.surveyed import GOING, PALETTE, RISE, surveyed

SVG = "{http://www.w3.org/2000/svg}"


def profile(direction="along", place_m=0.0, step_id=None):
    scan, inspection, display = surveyed()
    frame = section_frame(inspection, display.points, step_id)
    return profile_of(scan, inspection, cut(frame, direction, place_m, 0.05, display.points))


def read(source):
    """The drawing as XML: what a browser would not forgive either is an error here."""
    title, drawn = ElementTree.fromstring(source)
    assert title.text == drawn.get("aria-label")
    return drawn


def scale_of(svg, axis):
    """Pixels per unit of a scale, from its words and their places: both scales, the longest runs of numbers."""
    ticks = []
    for words in svg.iter(f"{SVG}text"):
        if re.fullmatch(r"-?[\d.]+", words.text or "") and words.get("opacity") == "0.75":
            is_across = words.get("text-anchor") == "middle"
            if is_across == (axis == "x"):
                ticks.append((float(words.text), float(words.get(axis))))
    (v1, p1), (v2, p2) = ticks[0], ticks[-1]
    return (p2 - p1) / (v2 - v1)


def groups(svg):
    return {int(group.get("data-step")): group for group in svg.iter(f"{SVG}g") if group.get("data-step")}


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_the_scale_is_the_same_across_and_upwards_and_is_that_of_the_nosings(unit):
    drawn = read(profile_svg(profile(), PALETTE, unit))
    across, upwards = scale_of(drawn, "x"), scale_of(drawn, "y")
    # Ticks are placed to a tenth of a pixel.
    assert across == pytest.approx(-upwards, rel=0.01)
    nosings = [group.find(f"{SVG}circle") for _, group in sorted(groups(drawn).items())]
    places = np.array([[float(nosing.get("cx")), float(nosing.get("cy"))] for nosing in nosings])
    per_unit = 1.0 if unit == "mm" else 1.0 / 0.0254
    np.testing.assert_allclose(np.diff(places[:, 0]), GOING * per_unit * across, atol=0.15)
    np.testing.assert_allclose(np.diff(places[:, 1]), RISE * per_unit * upwards, atol=0.15)


def test_every_dot_lies_where_a_point_of_its_step_is():
    section = profile()
    drawn = read(profile_svg(section, PALETTE))
    nosing = groups(drawn)[1].find(f"{SVG}circle")
    x0, z0 = section.lines[0].nosing
    scale = scale_of(drawn, "x")
    n_dots = 0
    for path in drawn.iter(f"{SVG}path"):
        if path.get("data-label") is None:
            continue
        label = int(path.get("data-label"))
        expected = {-1: PALETTE.non_stair, 0: PALETTE.floor}.get(label, PALETTE.of_step(max(label, 1)))
        assert path.get("stroke") == f"rgb{expected}"
        own = section.places_m[section.labels == label]
        for x, y in re.findall(r"M(\S+) (\S+?)h0", path.get("d")):
            place = np.array(
                [
                    x0 + (float(x) - float(nosing.get("cx"))) / scale,
                    z0 - (float(y) - float(nosing.get("cy"))) / scale,
                ]
            )
            # A dot stands for the points within half a pixel of it.
            assert np.abs(own - place).max(axis=1).min() <= 0.5 / scale
            n_dots += 1
    assert n_dots > 100


def test_the_chosen_step_shows_its_rise_and_its_going_at_their_true_length():
    section = profile(step_id=3)
    around = np.array([[-0.6, 300.1], [0.4, 300.7]])
    drawn = read(profile_svg(section, PALETTE, "mm", 2, around=around))
    group = groups(drawn)[2]
    words = [text.text for text in group.iter(f"{SVG}text")]
    assert words == ["2", "170.2 ± 0.4 mm", "280.0 ± 0.4 mm"]
    scale = scale_of(drawn, "x")
    lengths = []
    for path in group.findall(f"{SVG}path"):
        x1, y1, x2, y2 = (float(number) for number in re.findall(r"-?[\d.]+", path.get("d"))[:4])
        lengths.append(np.hypot(x2 - x1, y2 - y1) / scale)
    assert lengths == pytest.approx([RISE + 0.0002, GOING], abs=0.002)
    others = [text.text for number, other in groups(drawn).items() if number != 2 for text in other.iter(f"{SVG}text")]
    assert all(re.fullmatch(r"\d+", other) for other in others)


@pytest.mark.parametrize(
    ("turn_deg", "is_shown"), [(4.0, True), (-4.0, True), (7.0, False), (90.0, False), (180.0, False)]
)
def test_a_step_that_climbs_another_way_has_no_dimensions_that_would_be_out_of_scale(turn_deg, is_shown):
    scan, inspection, display = surveyed()
    climb = rotation("z", turn_deg) @ inspection.steps[1].climb
    steps = tuple(dataclasses.replace(step, climb=climb) if step.step_id == 2 else step for step in inspection.steps)
    turning = dataclasses.replace(inspection, steps=steps)
    section = profile_of(scan, turning, cut(section_frame(turning, display.points), "along", 0.0, 0.05, display.points))
    words = [
        text.text for text in groups(read(profile_svg(section, PALETTE, "mm", 2, width=900)))[2].iter(f"{SVG}text")
    ]
    assert words == (["2", "170.2 ± 0.4 mm", "280.0 ± 0.4 mm"] if is_shown else ["2"])


def test_a_going_that_leaves_the_drawing_says_that_it_goes_on():
    section = profile(step_id=3)
    around = np.array([[-0.4, 300.2], [0.05, 300.8]])
    words = [text.text for text in groups(read(profile_svg(section, PALETTE, "mm", 3, around=around)))[3].iter()]
    assert not any(word and word.endswith("→") for word in words)
    long = dataclasses.replace(section.lines[2].step, going_m=Measured(1.3, 0.001))
    lines = tuple(dataclasses.replace(line, step=long) if line.step.step_id == 3 else line for line in section.lines)
    drawn = read(profile_svg(dataclasses.replace(section, lines=lines), PALETTE, "mm", 3, around=around))
    words = [text.text for text in groups(drawn)[3].iter(f"{SVG}text")]
    assert "1300.0 ± 1.0 mm →" in words


def test_where_the_steps_are_small_their_dimensions_are_left_out():
    words = [
        text.text for text in groups(read(profile_svg(profile(), PALETTE, "mm", 2, width=260)))[2].iter(f"{SVG}text")
    ]
    assert words == ["2"]


def test_resting_on_a_step_tells_its_values():
    told = groups(read(profile_svg(profile(), PALETTE, "in")))[1].find(f"{SVG}title").text
    assert told == "step 1, rise 6 11/16 in (6.697 ± 0.016), going 11 in (11.024 ± 0.016)"


@pytest.mark.parametrize(
    ("direction", "place_m", "title"),
    [
        ("along", 0.1, "section along the stair, 50 mm thick, 100 mm right of its middle"),
        ("along", -0.1, "section along the stair, 50 mm thick, 100 mm left of its middle"),
        ("across", 0.25, "section across the stair, 50 mm thick, 250 mm up from its middle"),
        ("across", -0.25, "section across the stair, 50 mm thick, 250 mm down from its middle"),
        ("along", 0.0001, "section along the stair, 50 mm thick, in its middle"),
    ],
)
def test_the_title_says_where_the_section_is(direction, place_m, title):
    section = profile(direction, place_m)
    assert title_of(section) == title
    assert read(profile_svg(section, PALETTE)).get("aria-label") == title
    of_step = title.replace("its middle", "the middle of step 2")
    assert read(profile_svg(section, PALETTE, "mm", 2)).get("aria-label") == of_step


@pytest.mark.parametrize(("direction", "width"), [("along", 130), ("across", 130), ("along", 340), ("across", 340)])
def test_both_scales_have_two_numbers_at_least(direction, width):
    drawn = read(profile_svg(profile(direction), PALETTE, width=width))
    words = [text for text in drawn.iter(f"{SVG}text") if re.fullmatch(r"-?[\d.]+", text.text or "")]
    for anchor in ("middle", "end"):
        ticks = [text for text in words if text.get("opacity") == "0.75" and text.get("text-anchor") == anchor]
        assert len(ticks) >= 2


def test_a_large_drawing_is_as_large_as_it_may_be_and_has_more_dots():
    small, large = (
        read(profile_svg(profile(), PALETTE, width=width, tallest=tallest, most_dots=most))
        for width, tallest, most in ((340, 460, MOST_DOTS), (1160, 520, 4 * MOST_DOTS))
    )
    assert scale_of(large, "x") > 2.0 * scale_of(small, "x")
    assert float(large.get("viewBox").split(" ")[3]) <= 520 + 60


def test_an_empty_section_says_what_to_do():
    source = profile_svg(profile(place_m=7.0), PALETTE)
    assert "No points lie in this section; move it or make it thicker." in source
    assert "<svg" not in source


@pytest.mark.slow
def test_a_section_full_of_points_stays_a_small_drawing():
    rng = np.random.default_rng(5)
    full = Profile("along", rng.uniform(0.0, 3.0, (200_000, 2)), np.full(200_000, -1, dtype=np.int16), (), 0.0, 0.5)
    source = profile_svg(full, PALETTE)
    assert 1000 < source.count("h0") <= MOST_DOTS
    assert len(source) < 150_000


def test_a_flat_section_is_still_tall_enough_for_its_numbers():
    flat = Profile(
        "across", np.column_stack([np.linspace(0, 2, 50), np.zeros(50)]), np.ones(50, dtype=np.int16), (), 0, 1
    )
    height = float(read(profile_svg(flat, PALETTE)).get("viewBox").split(" ")[3])
    assert 100.0 < height < 250.0
