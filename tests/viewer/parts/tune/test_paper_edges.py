"""The paper's edges are seen while their sliders move, and at no other time."""

import dataclasses

import numpy as np
import pytest

from stair_inspector.params import SETTINGS, AxesParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.parts.tune.paper_edges import PAPER_ONLY, paper_edges_of
from tests.synthetic import Stair, exact_params
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import await_that

NODE = "/stair/segments/paper_edges"
FRONT, EPS = "edges.front_percentile", "levels.eps_m"


@pytest.fixture(scope="module")
def inspection():
    return inspect(Stair(n_steps=4, noise=0.001).scan(), exact_params(method="survey"))


def lines_in(session):
    with session.desk.lock:
        nodes = session.desk.stage._nodes
        return np.array(nodes[NODE].points) if NODE in nodes else None


def slide(page, name, value):
    """Move a slider as a person does."""
    control = page.session.editor.controls._controls[name]
    page._send({"type": "GuiUpdateMessage", "uuid": control._impl.uuid, "updates": {"value": value}})
    await_that(
        lambda: page.session.editor.work.params.value(name) == SETTINGS.knob(name).stored(value), "nothing was set"
    )
    return page.await_result()


def test_the_edges_are_those_of_the_papers_method_on_the_levels_of_the_steps(inspection):
    rule = AxesParams(inspection.axes.rule)
    by_paper = inspect(Stair(n_steps=4, noise=0.001).scan(), exact_params(method="paper", axes=rule))
    assert [each.tolist() for each in inspection.paper_corners] == [each.corners.tolist() for each in by_paper.steps]
    lines = paper_edges_of(inspection, 0.0)
    assert lines.shape == (16, 2, 3)
    lift = 2.0 * max(step.plane.rms_m for step in inspection.steps) * inspection.up.vector
    assert np.allclose(lines[:, 0].reshape(4, 4, 3) - lift, [step.corners for step in by_paper.steps])


def test_with_the_papers_method_its_edges_are_drawn_anyway(inspection):
    by_paper = inspect(Stair(n_steps=4, noise=0.001).scan(), exact_params(method="paper"))
    assert len(paper_edges_of(by_paper, 0.01)) == 0
    without_steps = dataclasses.replace(inspection, patches=(), steps=(), flights=())
    assert len(paper_edges_of(without_steps, 0.01)) == 0


def test_what_acts_on_the_papers_columns_alone_says_so_in_name_and_help(inspection):
    scan = Stair(n_steps=4, noise=0.001).scan()
    for name in PAPER_ONLY:
        assert "paper's " in SETTINGS.knob(name).label
        assert SETTINGS.setting(name).documentation.endswith("Paper's columns only.")
        moved = inspect(scan, inspection.params.replaced(name, Params().value(name) - 3.0))
        for step, before in zip(moved.steps, inspection.steps, strict=True):
            assert step.paper != before.paper
            assert (step.rise_m, step.going_m, step.width_m) == (before.rise_m, before.going_m, before.width_m)


def test_they_are_shown_while_their_slider_moves_and_go_with_the_next_control(page):
    session = page.session
    assert lines_in(session) is None
    assert "paper's columns" not in part_of(session, "frame").legend.content
    slide(page, FRONT, 90.0)
    moved = lines_in(session)
    assert moved is not None
    assert "edges of the paper's columns" in part_of(session, "frame").legend.content
    slide(page, FRONT, 80.0)
    assert not np.array_equal(lines_in(session), moved)
    slide(page, EPS, 21.0)
    assert lines_in(session) is None
    assert "paper's columns" not in part_of(session, "frame").legend.content


def test_they_go_by_themselves(page, monkeypatch):
    session = page.session
    monkeypatch.setattr(part_of(session, "tune").paper_edges._settle, "_quiet_s", 0.2)
    slide(page, FRONT, 70.0)
    await_that(lambda: lines_in(session) is None, "they stay")
    assert "paper's columns" not in part_of(session, "frame").legend.content
