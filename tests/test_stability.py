"""A value that hangs on a setting is marked; one that does not is not."""

import dataclasses

import pytest

from stair_inspector import stability
from stair_inspector.errors import CannotMeasure
from stair_inspector.memo import Memo
from stair_inspector.model import Measured
from stair_inspector.params import SETTINGS
from stair_inspector.pipeline import inspect
from stair_inspector.stability import CODE, mark_unsettled
from tests.synthetic import Stair, exact_params

SCAN = Stair(n_steps=4, risers=True, noise=0.001, seed=4).scan()
PARAMS = exact_params(up="z")
THETA, EPS_M = PARAMS.horizontal.theta_deg, PARAMS.levels.eps_m


@pytest.fixture(scope="module")
def plain():
    return inspect(SCAN, PARAMS)


def marks(inspection):
    return [(note.step, note.message) for note in inspection.notes if note.code == CODE]


def answering(monkeypatch, change):
    """Let a run with a larger theta_th give what ``change`` makes of it; return the settings of all runs."""
    seen = []

    def run(scan, params, memo):
        seen.append(tuple(params.value(name) for name in SETTINGS.tried()))
        found = inspect(scan, params, memo)
        return change(found) if params.horizontal.theta_deg > THETA else found

    monkeypatch.setattr(stability, "inspect", run)
    return seen


def with_going(inspection, step_id, moved_m):
    steps = [
        dataclasses.replace(step, going_m=Measured(step.going_m.value + moved_m, step.going_m.u))
        if step.step_id == step_id
        else step
        for step in inspection.steps
    ]
    return dataclasses.replace(inspection, steps=tuple(steps))


def test_on_a_plateau_nothing_is_marked_and_the_result_is_the_same(plain):
    assert mark_unsettled(SCAN, PARAMS, plain, Memo()) is plain


def test_a_value_that_moves_by_more_than_its_u_is_marked_with_its_step(plain, monkeypatch):
    u = plain.steps[1].going_m.u
    answering(monkeypatch, lambda found: with_going(found, 2, 0.9 * u))
    assert marks(mark_unsettled(SCAN, PARAMS, plain)) == []
    answering(monkeypatch, lambda found: with_going(found, 2, u + 0.0101))
    ((step_id, message),) = marks(mark_unsettled(SCAN, PARAMS, plain))
    assert step_id == 2
    assert message.startswith("the going of step 2 hangs on the settings: it moves by 10.")
    assert message.endswith(f"more than its u, where θ_th is {THETA + 0.5:g} °")


def test_what_is_lost_is_marked_too(plain, monkeypatch):
    def without_last(found):
        return dataclasses.replace(found, steps=found.steps[:-1])

    answering(monkeypatch, without_last)
    found = marks(mark_unsettled(SCAN, PARAMS, plain))
    assert {step_id for step_id, _ in found} == {4}
    assert any("the rise of step 4" in message and "not measured" in message for _, message in found)

    def nothing(found):
        raise CannotMeasure("no")

    answering(monkeypatch, nothing)
    assert {step_id for step_id, _ in marks(mark_unsettled(SCAN, PARAMS, plain))} == {1, 2, 3, 4}


def test_each_setting_is_moved_by_one_notch_to_each_side_and_never_beyond_its_range(plain, monkeypatch):
    seen = answering(monkeypatch, lambda found: found)
    mark_unsettled(SCAN, PARAMS, plain)
    m = PARAMS.levels.min_points
    assert seen == [
        (THETA - 0.5, EPS_M, m),
        (THETA + 0.5, EPS_M, m),
        (THETA, pytest.approx(EPS_M - 0.001), m),
        (THETA, pytest.approx(EPS_M + 0.001), m),
        (THETA, EPS_M, m - 1),
        (THETA, EPS_M, m + 1),
    ]
    seen.clear()
    mark_unsettled(SCAN, PARAMS.replaced("horizontal.theta_deg", 60.0), plain)
    assert max(theta for theta, _, _ in seen) == 60.0


def test_the_paper_s_method_is_not_marked(plain, monkeypatch):
    seen = answering(monkeypatch, lambda found: found)
    assert mark_unsettled(SCAN, PARAMS.replaced("method", "paper"), plain) is plain
    assert not seen
