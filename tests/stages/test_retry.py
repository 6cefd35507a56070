"""Where the settings find no staircase, those that are suggested are tried, and the answer says so."""

import dataclasses

import numpy as np

from stair_inspector.memo import Memo
from stair_inspector.model import Note
from stair_inspector.params import HorizontalParams, LevelsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.causes import IF_STEPS
from stair_inspector.stages.retry import Tried, say_tried
from tests.synthetic import Stair, make_scan

STAIR = Stair(n_steps=6, spacing=0.014, noise=0.004, risers=True)
STRICT = Params(up="z", unit="m", horizontal=HorizontalParams(theta_deg=2.0), levels=LevelsParams(min_points=4000))


def said(inspection, code):
    return [found for found in inspection.examination if found.code == code]


def why(inspection):
    return next(note.message for note in inspection.notes if note.code == "no_staircase")


def with_flags(params, flags):
    """Settings with flags of the command line, all of them numbers."""
    words = flags.split()
    for flag, value in zip(words[::2], words[1::2], strict=True):
        name = flag.removeprefix("--").replace("-", "_")
        params = params.replaced(name, int(value) if name.endswith("points") else float(value))
    return params


def test_what_the_suggestion_finds_is_said_and_its_flags_find_it():
    scan = STAIR.scan()
    inspection = inspect(scan, STRICT)
    # The settings stay the user's, and so does what they find.
    assert inspection.params == STRICT
    assert not inspection.steps
    (found,) = said(inspection, "settings_do_not_fit")
    assert found.level == "doubt"
    assert "6 risers" in found.message
    assert found.cure.startswith("--horizontal.theta-deg ")
    assert f"6 risers are found: use {found.cure}" in why(inspection)
    assert len(inspect(scan, with_flags(STRICT, found.cure)).steps) == 6


def test_what_finds_nothing_either_is_said_too():
    points = np.random.default_rng(4).uniform((0.0, 0.0, -0.001), (3.0, 3.0, 0.001), (20_000, 3))
    inspection = inspect(make_scan(points), Params(up="z", unit="m"))
    assert why(inspection).endswith("as suggested for this scan, were tried too and find none")
    assert not said(inspection, "settings_do_not_fit")


def test_nothing_is_tried_where_a_staircase_is_found_nor_by_the_papers_method():
    scan = STAIR.scan()
    found = inspect(scan, Params(up="z", unit="m"))
    assert found.steps
    assert "suggested" not in found.timings_s
    assert "suggested" not in inspect(scan, Params(up="z", unit="m", method="paper")).timings_s


def test_it_is_tried_once_for_the_same_settings():
    scan, memo = STAIR.scan(), Memo()
    assert "suggested" in inspect(scan, STRICT, memo).timings_s
    again = inspect(scan, STRICT, memo)
    assert again.timings_s == {}
    assert said(again, "settings_do_not_fit")


def test_where_other_settings_find_a_flight_nobody_is_sent_to_a_limit():
    cause = "7 horizontal surfaces, but 5 of them follow each other with rises of about 349 mm, above the limit"
    advice = f"{cause}; {IF_STEPS} --flights.max-rise-m 0.37"
    plain = inspect(STAIR.scan(), STRICT)
    blamed = dataclasses.replace(plain, notes=(Note("no_staircase", "verdict", advice),))
    tried = Tried((("horizontal.theta_deg", 20.0),), 12)
    (note,) = say_tried(blamed, tried, {}).notes
    told = "but with theta_th 20°, as suggested for this scan, 12 risers are found: use --horizontal.theta-deg 20"
    assert note.message == f"{cause}; {told}"
    (unheard,) = say_tried(blamed, dataclasses.replace(tried, n_risers=0), {}).notes
    assert unheard.message == advice
