"""What is made for a page: told when it takes long, given up at once, one thing at a time."""

import threading
import time

import pytest

from stair_inspector.errors import ConfigError, ReadError
from stair_inspector.viewer.compute.jobs import Making

LONG_S = 20.0


class Page:
    def __init__(self):
        self.told, self.is_closed = [], False

    def show(self, words, percent):
        self.told.append(words)


@pytest.fixture
def page():
    return Page()


@pytest.fixture
def making(page):
    return Making(page.show, lambda: page.is_closed)


def await_true(condition):
    ends = time.monotonic() + LONG_S
    while not condition():
        assert time.monotonic() < ends
        time.sleep(0.005)


def start(making, function, words="a.ply"):
    """Ask on a thread of its own, as a page does; return it with what came of it."""
    came = []

    def ask():
        try:
            came.append(making.make(words, function))
        except (ConfigError, ReadError) as error:
            came.append(error)

    thread = threading.Thread(target=ask, daemon=True)
    thread.start()
    return thread, came


def test_what_is_made_at_once_is_handed_over_and_nothing_is_told(making, page):
    assert making.make("a.csv", lambda tell: b"1,2") == b"1,2"
    assert page.told == [None]


def test_what_takes_long_is_told_and_given_up_at_once(making, page):
    gate = threading.Event()
    thread, came = start(making, lambda tell: gate.wait(LONG_S))
    await_true(lambda: page.told)
    assert page.told == ["making a.ply …"]
    making.cancel()
    thread.join(LONG_S)
    assert str(came[0]) == "a.ply: cancelled"
    assert page.told == ["making a.ply …", None]
    # It can not be stopped in the middle; until it ends nothing else is made.
    with pytest.raises(ConfigError, match=r"b\.csv: a\.ply is still being made; wait for it, or press Cancel"):
        making.make("b.csv", lambda tell: b"")
    gate.set()
    await_true(lambda: start_free(making))
    assert page.told[:2] == ["making a.ply …", None]


def start_free(making):
    try:
        return making.make("b.csv", lambda tell: True)
    except ConfigError:
        return False


def test_what_tells_its_progress_is_stopped_where_it_stands(making, page):
    gate, steps = threading.Event(), []

    def pictures(tell):
        for number in range(5):
            tell(f"picture {number}", 20.0 * number)
            steps.append(number)
            gate.wait(LONG_S)

    thread, came = start(making, pictures)
    await_true(lambda: steps)
    making.cancel()
    gate.set()
    thread.join(LONG_S)
    assert "cancelled" in str(came[0])
    await_true(lambda: start_free(making))
    assert steps == [0]


def test_a_second_wish_is_refused_at_once_and_waits_for_nothing(making):
    gate = threading.Event()
    thread, came = start(making, lambda tell: gate.wait(LONG_S) and b"picture")
    time.sleep(0.05)
    began = time.monotonic()
    for _ in range(40):
        with pytest.raises(ConfigError, match="still being made"):
            making.make("a.ply", lambda tell: b"")
    assert time.monotonic() - began < 1.0
    gate.set()
    thread.join(LONG_S)
    assert came == [b"picture"]


def test_a_failure_is_that_of_what_was_made_and_the_next_works(making, page):
    def fail(tell):
        raise ReadError("a.ply: is damaged; export it again")

    with pytest.raises(ReadError, match="is damaged"):
        making.make("a.ply", fail)
    assert page.told == [None]
    assert making.make("b", lambda tell: 3) == 3


def test_a_page_that_has_gone_waits_no_longer(making, page):
    gate = threading.Event()
    thread, came = start(making, lambda tell: gate.wait(LONG_S))
    page.is_closed = True
    thread.join(LONG_S)
    assert not thread.is_alive()
    assert "cancelled" in str(came[0])
    gate.set()
