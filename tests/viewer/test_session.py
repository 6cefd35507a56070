"""What a session promises apart from its page: the newest wish wins, and pages come back to their own."""

import threading
import time
from types import SimpleNamespace

from stair_inspector.errors import ConfigError
from stair_inspector.params import Params
from stair_inspector.viewer.session import KeptRequests, Request, Session


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
