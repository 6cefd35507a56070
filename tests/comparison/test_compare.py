"""What changed between two scans of one stair is found, what did not is not, whichever way they lie."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.comparison import alignment
from stair_inspector.comparison.compare import chance_widening, compare_scans
from stair_inspector.errors import CannotMeasure, ConfigError
from stair_inspector.model import FLOOR_LABEL, NON_STAIR_LABEL, Observation
from stair_inspector.pipeline import inspect
from tests.comparison.epochs import LAST, MOVED, SETTLED, TURNED, WORN, compared, epoch, params


def values_of(step):
    return {value.quantity: value for value in (*step.values, step.height)}


def test_nothing_is_called_changed_where_nothing_changed():
    found = compared(False)
    assert [(step.before_id, step.after_id) for step in found.steps] == [(k, k) for k in range(1, LAST + 1)]
    assert not any(step.is_changed for step in found.steps)
    assert [note.code for note in found.notes] == ["no_change", "laid_on"]
    changes = [value.change for step in found.steps for value in values_of(step).values() if value.change is not None]
    # U holds 95 % of them.
    assert np.mean([abs(change.value) <= change.u for change in changes]) > 0.9
    for step in found.steps:
        assert step.deviations.coverage > 0.95


def test_a_worn_nosing_a_turned_tread_and_a_settled_flight_are_found_and_nothing_else():
    found = compared(True)
    said = {
        (step.before_id, name) for step in found.steps for name, value in values_of(step).items() if value.is_changed
    }
    lower = {(k, "height") for k in range(SETTLED, LAST + 1)}
    # The nosing is lower, so the rise to it is less, that from it more, and both pitches with them.
    rises = {(WORN, "rise"), (WORN + 1, "rise"), (SETTLED, "rise")}
    pitches = {(k - 1, "pitch") for k, _ in rises}
    assert said - pitches == lower | rises | {(TURNED, "cross_fall")}
    assert (SETTLED - 1, "pitch") in said
    steps = {step.before_id: step for step in found.steps}
    assert [k for k, step in steps.items() if step.deviations.worst_m is not None] == [WORN]

    true = {(WORN, "rise"): -0.003, (WORN + 1, "rise"): 0.003, (SETTLED, "rise"): -0.004, (TURNED, "cross_fall"): 1.0}
    true |= dict.fromkeys(lower, -0.004)
    for (k, name), value in true.items():
        change = values_of(steps[k])[name].change
        assert abs(change.value - value) <= change.u, (k, name)
    worst = steps[WORN].deviations.worst_m
    assert abs(worst.value + 0.003) <= worst.u
    assert found.alignment.steady_ids == tuple(k for k in range(1, SETTLED) if k != TURNED)
    assert found.alignment.is_floor_steady
    codes = [note.code for note in found.notes]
    assert codes[:3] == ["height_changed", "tilt_changed", "surface_changed"]
    assert found.notes[0].message.startswith(f"steps {SETTLED} to {LAST} lie 4.0 ± ")
    assert found.notes[0].message.endswith(" lower than before, as a whole")


def test_the_map_of_a_worn_tread_shows_the_strip_in_its_place():
    step = next(step for step in compared(True).steps if step.before_id == WORN)
    found = step.deviations
    rows = [np.median(row[np.isfinite(row)]) for row in found.deviation_m[: int(0.2 / found.cell_m)]]
    assert rows[0] == pytest.approx(-0.003, abs=0.0005)
    assert rows[2:] == pytest.approx([0.0] * len(rows[2:]), abs=0.0005)
    assert not found.is_local[2:].any()
    # The first row lies at the nosing: 5 mm behind it, along the climb of the earlier scan, which is x.
    assert found.corner[0] == pytest.approx((WORN - 1) * 0.28 + 0.005, abs=0.002)
    assert found.ahead[:2] == pytest.approx([found.cell_m, 0.0], abs=1e-4)
    assert found.aside[:2] == pytest.approx([0.0, found.cell_m], abs=1e-4)
    assert found.normal == pytest.approx([0.0, 0.0, 1.0], abs=0.003)
    assert np.array_equal(np.isfinite(found.u_m), np.isfinite(found.deviation_m))


def test_the_alignment_undoes_the_motion_within_its_uncertainty():
    found = compared(True)
    alignment, parts = found.alignment, dict(found.alignment.parts)
    assert alignment.turn @ MOVED[:3, :3] == pytest.approx(np.eye(3), abs=np.radians(parts["turn_deg"]) + 5e-4)
    # A place in the middle of the steady part comes back to where it was.
    place = np.array([0.5, 0.5, 0.4])
    moved = MOVED[:3, :3] @ place + MOVED[:3, 3]
    left = alignment.turn @ moved + alignment.shift_m - place
    assert abs(left[2]) <= parts["height_m"]
    assert abs(left[0]) <= 0.001
    assert 0.0 < parts["height_m"] <= alignment.u_m < 0.001


def test_swapping_the_scans_changes_the_signs():
    forth = compared(True)
    back = compare_scans(*epoch(51, True), *epoch(1, is_moved=False))
    for one, two in zip(forth.steps, back.steps, strict=True):
        for name, value in values_of(one).items():
            other = values_of(two)[name]
            if value.change is None:
                assert other.change is None
                continue
            # What is laid onto what, and in which cells, is another thing this way round.
            tolerance = 1e-12 if name != "height" else 0.3 * value.change.u
            assert other.change.value == pytest.approx(-value.change.value, abs=tolerance)
            assert other.is_changed == value.is_changed
    assert back.alignment.steady_ids == forth.alignment.steady_ids


def test_moving_a_scan_as_a_whole_changes_nothing_beyond_u():
    there = compare_scans(*epoch(1, is_moved=False), *epoch(51, True, is_moved=False))
    for one, two in zip(compared(True).steps, there.steps, strict=True):
        for name, value in values_of(one).items():
            other = values_of(two)[name]
            assert name == "pitch" or other.is_changed == value.is_changed
            if value.change is not None:
                assert abs(other.change.value - value.change.value) <= value.change.u


def test_a_scan_against_itself_shows_zero():
    found = compare_scans(*epoch(1, is_moved=False), *epoch(1, is_moved=False))
    for step in found.steps:
        for value in values_of(step).values():
            assert value.change is None or value.change.value == pytest.approx(0.0, abs=1e-9)
        assert np.nanmax(np.abs(step.deviations.deviation_m)) == pytest.approx(0.0, abs=1e-9)


def test_a_tread_too_little_seen_under_the_last_motion_leaves_the_others_as_they_are(monkeypatch):
    whole, passes, planes_of = compared(True), [], alignment._planes

    def planes(*args):
        passes.append(args)
        treads, floor = planes_of(*args)
        return ((None, *treads[1:]) if len(passes) == n_passes else treads), floor

    n_passes = alignment._PASSES + 2
    monkeypatch.setattr(alignment, "_planes", planes)
    found = compare_scans(*epoch(1, is_moved=False), *epoch(51, True))
    assert len(passes) == n_passes
    assert found.alignment.steady_ids == whole.alignment.steady_ids
    assert found.alignment.is_floor_steady == whole.alignment.is_floor_steady


def test_a_flight_of_even_steps_without_a_floor_is_refused_without_a_warning():
    scan, inspection = epoch(51)
    labels = np.where(inspection.labels == FLOOR_LABEL, NON_STAIR_LABEL, inspection.labels)
    bare = replace(inspection, labels=labels)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(CannotMeasure, match="fit each other in two ways, a step apart"):
            compare_scans(*epoch(1, is_moved=False), scan, bare)


def test_another_stair_is_refused():
    with pytest.raises(CannotMeasure, match=r"not the same stair, or too little in common: \d of 6 steps lie alike"):
        compare_scans(*epoch(1, is_moved=False), *epoch(51, rise=0.19, spacing=0.02))


def test_an_open_question_is_refused_and_named():
    scan, inspection = epoch(51)
    question = Observation("unit_unsure", "question", "inches or centimetres", None, "--unit in")
    asked = replace(inspection, examination=(question,))
    with pytest.raises(CannotMeasure) as caught:
        compare_scans(*epoch(1, is_moved=False), scan, asked)
    assert str(caught.value) == (
        "later.ply: cannot be compared before this is answered: inches or centimetres (--unit in)"
    )


def test_the_papers_method_and_another_scan_are_refused():
    scan, inspection = epoch(51)
    other, _ = epoch(1, is_moved=False)
    with pytest.raises(ConfigError, match=r"later.ply: measured by the paper's method"):
        compare_scans(other, epoch(1, is_moved=False)[1], scan, inspect(scan, replace(params(True), method="paper")))
    with pytest.raises(ConfigError, match=r"earlier.ply: the inspection was made of another scan"):
        compare_scans(other, inspection, scan, inspection)


def test_a_scan_without_steps_is_refused():
    scan, inspection = epoch(51)
    with pytest.raises(CannotMeasure, match=r"later.ply: has no staircase that could be compared"):
        compare_scans(*epoch(1, is_moved=False), scan, replace(inspection, steps=(), flights=()))


def test_u_is_widened_by_how_many_values_are_looked_at():
    # 1.96 standard uncertainties hold one value in 95 %, 3.5 all of a hundred.
    assert chance_widening(1) == 1.0
    assert 2.0 * chance_widening(100) == pytest.approx(3.48, abs=0.01)
