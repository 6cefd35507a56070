"""A flag as settings and words: what can be set is offered, anything else stays a sentence."""

import pytest

from stair_inspector.model import Observation
from stair_inspector.params import Params
from stair_inspector.report.cures import cure_words, cures_of


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
