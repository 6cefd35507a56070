"""The unit is decided by the stair that comes out, or asked for; where none comes out, the size says it."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.content.cures import cures_of
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from stair_inspector.model import Note
from stair_inspector.params import KNOWN_UNITS, NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.units import decide_unit
from stair_inspector.units import METRES_PER_UNIT
from tests.synthetic import Stair, make_scan, rotation

STAIR = Stair(n_steps=6, rise=0.175, going=0.28, risers=True, spacing=0.035, noise=0.001, floor_depth=1.2)
SMALL = dataclasses.replace(STAIR, rise=0.1, going=0.2, width=0.5, spacing=0.012)
"""In centimetres a stair for children, in inches one for giants."""
GUESSED = Note("unit_guessed", "read", "unit guessed: centimetres")


def in_unit(stair, unit, turn=None, shift=(0.0, 0.0, 0.0)):
    """The points of a stair in a unit."""
    points = stair.sample()[0] @ (np.eye(3) if turn is None else turn).T + shift
    return points / METRES_PER_UNIT[unit]


def codes(observations):
    return [found.code for found in observations]


@pytest.mark.parametrize("unit", KNOWN_UNITS)
@pytest.mark.parametrize(
    ("turn", "shift"),
    [(rotation("z", 25.0), (0.0, 0.0, 0.0)), (rotation("x", 90.0) @ rotation("z", 70.0), (3.0e5, 5.0e6, 40.0))],
    ids=["z up", "y up and far away"],
)
def test_the_unit_is_that_in_which_the_stair_is_one(unit, turn, shift):
    decided = decide_unit(in_unit(STAIR, unit, turn, shift))
    assert decided.unit == unit
    assert [found.level for found in decided.observations] == (["info"] if unit in ("in", "ft") else [])
    assert decided.note.code == "unit_guessed"


def test_what_the_stair_says_against_the_size_is_told_with_its_lengths_and_the_other_unit():
    decided = decide_unit(in_unit(STAIR, "in"))
    (said,) = decided.observations
    assert "in inches" in said.message
    assert "its size alone would say metres" in said.message
    assert [cure.changes for cure in cures_of(said)] == [(("unit", "m"),)]
    assert decided.note.message.startswith("unit guessed: inches, in which treads and risers come again after ")
    lengths = [float(word) for word in decided.note.message.split() if word.isdigit()]
    assert lengths == pytest.approx([175.0, 280.0], abs=10.0)


def test_a_stair_that_fits_two_units_is_asked_about_and_nothing_is_measured_before():
    points = in_unit(SMALL, "cm")
    decided = decide_unit(points)
    (question,) = decided.observations
    assert (question.code, question.level) == ("unit_unsure", "question")
    assert {cure.changes for cure in cures_of(question)} == {(("unit", "in"),), (("unit", "cm"),)}
    scan = dataclasses.replace(
        make_scan(points * METRES_PER_UNIT[decided.unit]), notes=(decided.note,), observations=decided.observations
    )
    inspection = inspect(scan, Params(up="z", normals=NormalsParams(k=15)))
    assert codes(inspection.questions) == ["unit_unsure"]
    assert [step.rise_m for step in inspection.steps] == [None] * len(inspection.steps)


def test_no_stair_no_unit_but_by_size():
    rng = np.random.default_rng(4)
    floor = np.column_stack([rng.uniform(0.0, 5.0, (4000, 2)), rng.normal(0.0, 0.002, 4000)])
    wall = floor[:, [0, 2, 1]]
    for per in (1.0, 0.01, 0.001):
        decided = decide_unit(np.concatenate([floor, wall]) / per)
        assert METRES_PER_UNIT[decided.unit] == per
        assert decided.observations == ()
        assert "makes the scan 8.3 m" in decided.note.message


def test_tiers_of_seats_in_metres_are_not_silently_a_stair_in_feet():
    tiers = Stair(n_steps=6, rise=0.45, going=0.85, width=6.0, risers=True, spacing=0.05, noise=0.002, floor_depth=3.0)
    decided = decide_unit(tiers.sample()[0])
    assert codes(decided.observations) == ["unit_unsure"]
    assert {cure.changes for cure in cures_of(decided.observations[0])} == {(("unit", "ft"),), (("unit", "m"),)}
    # A stair of usual width in feet would be no stand in metres.
    assert codes(decide_unit(in_unit(STAIR, "ft")).observations) == ["unit_by_stair"]


# --- a unit that the size alone gave, and what was measured in it ----------------------------------------------------


def measured_in_wrong_unit(stair, *notes):
    """What is measured where inches were taken for centimetres because no rhythm was seen when the file was read."""
    scan = make_scan(in_unit(stair, "in") * METRES_PER_UNIT["cm"])
    scan = dataclasses.replace(scan, unit="cm", notes=notes)
    return inspect(scan, Params(up="z", normals=NormalsParams(k=15)))


def test_rises_that_are_some_in_another_unit_are_asked_about_and_not_judged():
    inspection = measured_in_wrong_unit(STAIR, GUESSED)
    (question,) = inspection.questions
    assert question.code == "unit_unsure"
    assert question.cure == "--unit in or --unit cm"
    assert "175 and 280 mm" in question.message
    assert inspection.flights
    assert [step.rise_m for step in inspection.steps] == [None] * len(inspection.steps)


def test_a_stated_unit_is_obeyed(tmp_path):
    assert measured_in_wrong_unit(STAIR).questions == ()
    path = tmp_path / "inches.ply"
    path.write_bytes(ply_bytes(in_unit(STAIR, "in")))
    scan = read_scan(path, "cm")
    assert (scan.unit, scan.notes, scan.observations) == ("cm", (), ())


def test_a_scan_in_metres_is_asked_nothing():
    scan = dataclasses.replace(STAIR.scan(), notes=(GUESSED,))
    inspection = inspect(scan, Params(normals=NormalsParams(k=15)))
    assert codes(inspection.examination) == ["sparse"]


def test_every_door_reads_inches(tmp_path):
    path = tmp_path / "inches.ply"
    points = in_unit(STAIR, "in")
    path.write_bytes(ply_bytes(points))
    scan = read_scan(path)
    assert scan.unit == "in"
    np.testing.assert_allclose(scan.points + scan.origin_m, points * 0.0254, atol=1e-5)
    # The paper's method measures in the same unit.
    for method in ("survey", "paper"):
        assert inspect(scan, Params(method=method, up="z", normals=NormalsParams(k=15))).scan.unit == "in"
