"""A flag as settings and words: what can be set is offered, anything else stays a sentence."""

import pytest

from stair_inspector.content.cures import advice_in_words, cure_words, cures_of
from stair_inspector.content.note_words import note_words
from stair_inspector.model import Observation
from stair_inspector.params import Params


def found(cure):
    return Observation("code", "doubt", "message", None, cure)


@pytest.mark.parametrize(
    ("cure", "changes", "words"),
    [
        ("--unit in", {"unit": "in"}, "the file is in inches"),
        ("--up=-z", {"up": "-z"}, "up is -z"),
        ("--up -z", {"up": "-z"}, "up is -z"),
        ("--up=0,0.1,1", {"up": "0,0.1,1"}, "up is 0,0.1,1"),
        ("--levels.min-points 20", {"levels.min_points": 20}, "set m (points in reach) to 20"),
        ("--levels.eps-m=0.03", {"levels.eps_m": 0.03}, "set ε_z (vertical reach) to 30 mm"),
        (
            "--levels.min-points 20 --patches.cell-m 0.09",
            {"levels.min_points": 20, "patches.cell_m": 0.09},
            "set m (points in reach) to 20 and set plan cell to 90 mm",
        ),
    ],
)
def test_flags_are_settings(cure, changes, words):
    (offered,) = cures_of(found(cure))
    assert dict(offered.changes) == changes
    assert offered.words == cure_words(found(cure)) == words
    params = offered.applied(Params())
    assert {name: params.value(name) for name in changes} == changes


def test_alternatives_are_offered_each_for_itself():
    assert [each.changes for each in cures_of(found("--up=z or --up=-y"))] == [(("up", "z"),), (("up", "-y"),)]
    assert [each.changes for each in cures_of(found("--unit in, --unit cm"))] == [(("unit", "in"),), (("unit", "cm"),)]


def test_a_flag_in_a_sentence_is_offered_and_said_in_words():
    said = found("scan from nearer, or measure with --levels.min-points 20; thin nothing")
    assert [each.changes for each in cures_of(said)] == [(("levels.min_points", 20),)]
    assert cure_words(said) == "scan from nearer, or measure with set m (points in reach) to 20; thin nothing"


@pytest.mark.parametrize(
    "cure",
    [
        "",
        "export once more",
        "--unit furlong",
        "--levels.min-points many",
        "--levels.min-points -3",
        "--no.thing 1",
        "--up",
    ],
)
def test_what_is_no_setting_is_no_button(cure):
    assert cures_of(found(cure)) == ()
    assert cure_words(found(cure)) == cure


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("use --horizontal.theta-deg 26", "set θ_th (normal tolerance) to 26 °"),
        ("4 steps; raise --flights.max-gap-m", "4 steps; raise largest gap"),
        ("if so, give --unit ft", "if so, the file is in feet"),
        ("set --flights.min-risers 2", "set fewest risers to 2"),
        ("use --method paper", "set the method to paper"),
        ("give --normals.source given", "set the normals to given"),
    ],
)
def test_advice_in_a_sentence_is_in_the_words_of_the_page(text, words):
    assert advice_in_words(text) == words


def test_a_report_gives_no_advice_about_settings():
    cause = "7 horizontal surfaces, but 5 of them follow each other"
    for advice in (
        "; if they are steps, give --flights.max-rise-m 0.37",
        "; raise --flights.max-gap-m",
        ": use --axes.rule x",
    ):
        assert note_words(cause + advice) == cause
