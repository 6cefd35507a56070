"""Notes on the page: in the page's words, and those that may mean a wrong result stand out."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import stair_inspector
from stair_inspector.content.remarks import n_to_look_at, needs_look, on_page
from stair_inspector.files.scans import read_scan
from stair_inspector.model import Note
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.parts.details_html import notes_html
from stair_inspector.viewer.parts.status_html import state_html
from tests.viewer.surveyed import surveyed

SAMPLES = Path(stair_inspector.__file__).parent.parent / "sample_scans"


def test_no_note_and_no_error_of_the_stages_speaks_of_the_command_line_on_the_page():
    package = Path(stair_inspector.__file__).parent
    sources = [*(package / "stages").glob("*.py"), package / "files" / "cleaning.py"]
    # The words as they stand in the source: whatever is said there of an option must have its words on the page.
    spoken = [
        line.strip()
        for path in sources
        for line in path.read_text(encoding="utf-8").splitlines()
        # A cure is a flag; the page makes a button of it.
        if '"' in line
        and "cure=" not in line
        and not line.strip().startswith('"""')
        and ("--up" in line or "--unit" in line or "uncertainty.*" in line)
    ]
    assert len(spoken) >= 6
    assert on_page("has no stations; measure it without --station").endswith(
        "choose 'all together' under Which station on the Scan tab"
    )
    for line in spoken:
        words = on_page(line)
        assert "--" not in words
        assert "uncertainty.*" not in words
        assert "tab" in words


@pytest.mark.parametrize("code", ["region_cuts", "treads_lean", "up_disagree", "no_staircase", "never_seen_before"])
def test_what_may_change_the_result_is_to_be_looked_at(code):
    assert needs_look(Note(code, "any", "words"))


@pytest.mark.parametrize("code", ["unit_guessed", "axes_rule", "back_hidden", "uncertainty_unstated"])
def test_what_says_only_how_a_value_came_about_is_not(code):
    assert not needs_look(Note(code, "any", "words"))


def status(inspection, busy=None):
    return state_html(inspection, busy=busy, error=None, is_stale=False, cancel_uuid="stop")


def test_the_status_tells_that_notes_need_a_look():
    _, inspection, _ = surveyed()
    quiet = dataclasses.replace(inspection, notes=(Note("axes_rule", "treads", "a"), Note("unit_guessed", "read", "b")))
    assert ">2 notes</button>" in status(quiet)
    assert "▲" not in status(quiet)
    loud = dataclasses.replace(quiet, notes=(*quiet.notes, Note("region_cuts", "verdict", "c", 1)))
    assert "▲ 1 note to look at" in status(loud)
    assert notes_html(loud).count("▲") == 1
    assert "note" not in status(dataclasses.replace(quiet, notes=())).partition("<button")[2]
    # While something is computed the notes are those of an earlier result.
    assert "▲" not in status(loud, busy="measuring")


@pytest.mark.slow
def test_a_region_that_cuts_the_treads_is_told_where_the_status_is():
    scan = read_scan(SAMPLES / "straight.ply", "auto")
    whole = inspect(scan, Params())
    assert n_to_look_at(whole.notes) == 0
    points = scan.points + scan.origin_m
    low, high = points.min(axis=0), points.max(axis=0)
    # A third of the width is left outside.
    across = int(abs(np.cross(whole.up.vector, whole.flights[0].climb)).argmax())
    high[across] = whole.steps[0].plane.centroid[across] + scan.origin_m[across] + whole.steps[0].width_m.value / 6.0
    region = ",".join(f"{value:.3f}" for value in (*low, *high))
    cut = inspect(scan, Params().replaced("overrules.region", region))
    assert len(cut.steps) == len(whole.steps)
    assert {note.step for note in cut.notes if note.code == "region_cuts"} == {step.step_id for step in cut.steps}
    assert "▲" in status(cut)
