"""What a session promises apart from its page: the newest wish wins, and pages come back to their own."""

import dataclasses
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.params import Params
from stair_inspector.viewer.session import KeptRequests, Request, Session, Shown, _read_choice
from tests.viewer.surveyed import surveyed


def bare_session(panel, submitted):
    """A session without page or server: what ``_submit`` touches, and nothing else."""
    session = object.__new__(Session)
    session._ask_lock = threading.Lock()
    session._wanted_label = "a"
    session._refusal = session._asked = None
    session._panel = panel
    session._worker = SimpleNamespace(submit=submitted.append)
    session._fail = submitted.append
    return session


def test_of_two_callbacks_the_one_with_the_newer_values_comes_last():
    state = {"value": 0}

    def read():
        value = state["value"]
        # Longer for older values: without the lock they would be handed over last.
        time.sleep(0.002 * (20 - value) / 20)
        return value

    submitted = []
    session = bare_session(SimpleNamespace(read=read), submitted)
    threads = []
    for value in range(1, 21):
        state["value"] = value
        threads.append(threading.Thread(target=session._submit))
        threads[-1].start()
    for thread in threads:
        thread.join()
    assert len(submitted) == 20
    assert submitted[-1] == Request("a", 20)


def test_a_refused_wish_is_said_and_forgotten_with_the_next_good_one():
    answers = [ConfigError("too large"), Params()]

    def read():
        answer = answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    submitted = []
    session = bare_session(SimpleNamespace(read=read), submitted)
    session._submit()
    assert submitted == ["too large"]
    assert session._refusal == "too large"
    session._submit("b")
    assert submitted[1:] == [Request("b", Params())]
    assert session._refusal is None


def test_a_browser_takes_up_each_of_its_closed_pages_once_and_nobody_elses():
    kept = KeptRequests()
    first, second, other = Request("a", Params()), Request("b", Params()), Request("c", Params())
    kept.leave("mine", first)
    kept.leave("theirs", other)
    kept.leave("mine", second)
    assert [kept.take_up("mine"), kept.take_up("mine"), kept.take_up("mine")] == [second, first, None]
    assert kept.take_up("theirs") == other


def test_what_is_kept_is_bounded():
    kept = KeptRequests()
    for k in range(200):
        kept.leave(f"browser {k}", Request("a", Params()))
        kept.leave("many", Request(str(k), Params()))
    assert kept.take_up("browser 0") is None
    assert kept.take_up("browser 199") is not None
    assert len([request for request in iter(lambda: kept.take_up("many"), None) if request]) == 10


@pytest.mark.parametrize(
    ("words", "chosen"),
    [("none", (None, None)), ("3", (3, None)), ("surface 12", (None, 12)), ("surface 0", (None, 0))],
)
def test_a_choice_is_a_step_a_surface_or_nothing(words, chosen):
    assert _read_choice(words) == chosen


@pytest.mark.parametrize("words", ["", "surface", "x", "<b>", None, [1], "surface x", "1.5"])
def test_what_names_neither_is_a_sentence(words):
    with pytest.raises(ConfigError, match=r"^step: got .*; give a number"):
        _read_choice(words)


def choosing(selected, patch, **changes):
    """A session that has a result and a choice, and nothing else."""
    scan, inspection, display = surveyed()
    session = object.__new__(Session)
    params = inspection.params.replaced("method", changes.get("method", "survey"))
    session._shown = Shown("a", scan, display, dataclasses.replace(inspection, params=params))
    session._selected, session._selected_patch = selected, patch
    return session, inspection


@pytest.mark.parametrize(("selected", "patch", "owner"), [(2, None, 2), (5, None, 5), (None, 7, 7), (None, 6, 6)])
def test_a_decision_is_about_the_centroid_of_what_is_chosen_in_the_scans_frame(selected, patch, owner):
    session, inspection = choosing(selected, patch)
    wanted = inspection.patches[owner].plane.centroid + np.array([100.0, 200.0, 300.0])
    assert session._chosen_place() == pytest.approx(tuple(wanted))


def test_a_step_without_a_surface_of_its_own_is_found_by_its_plane():
    session, inspection = choosing(2, None)
    session._shown = Shown(
        "a", session._shown.scan, session._shown.display, dataclasses.replace(inspection, patches=())
    )
    wanted = inspection.steps[1].plane.centroid + np.array([100.0, 200.0, 300.0])
    assert session._chosen_place() == pytest.approx(tuple(wanted))


def test_a_decision_about_nothing_or_about_the_papers_steps_is_a_sentence():
    with pytest.raises(ConfigError, match="choose a step or a rejected surface first"):
        choosing(None, None)[0]._chosen_place()
    with pytest.raises(ConfigError, match="paper's method takes no decisions"):
        choosing(2, None, method="paper")[0]._chosen_place()
    with pytest.raises(ConfigError, match="no longer there"):
        choosing(None, 99)[0]._chosen_place()
