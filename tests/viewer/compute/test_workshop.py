"""Requests are dropped but never a run; what is heavy runs elsewhere, once, and may die without harm."""

import operator
import os
import signal
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest

from stair_inspector.errors import CannotMeasure, ReadError
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from stair_inspector.params import FileReading, NormalsParams
from stair_inspector.stages.orient import find_normals
from stair_inspector.viewer.compute.heavy_process import Cancelled, HeavyProcess
from stair_inspector.viewer.compute.threads import Newest, Settle
from stair_inspector.viewer.compute.workshop import _SCANS_KEPT, Workshop
from tests.synthetic import Stair, make_scan

LONG_S = 30.0


def await_true(condition, timeout_s=LONG_S):
    ending = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < ending, "waited in vain"
        time.sleep(0.005)


class SlowJob:
    """A job that says when it has begun and ends when it is let go."""

    def __init__(self):
        self.begun, self.ended = [], []
        self.gate = threading.Semaphore(0)

    def __call__(self, request):
        self.begun.append(request)
        assert self.gate.acquire(timeout=LONG_S)
        self.ended.append(request)


@pytest.fixture
def newest():
    made = []

    def make(function):
        made.append(Newest(function, name="test-newest"))
        return made[-1]

    yield make
    for each in made:
        each.close()


def test_a_run_in_progress_is_finished_and_of_sixty_waiting_requests_the_last_is_run(newest):
    job = SlowJob()
    runs = newest(job)
    runs.submit(0)
    await_true(lambda: job.begun == [0])
    for request in range(1, 61):
        runs.submit(request)
    assert job.begun == [0]
    assert runs.is_busy()
    job.gate.release(2)
    await_true(lambda: not runs.is_busy())
    assert job.ended == [0, 60]


def test_a_drag_gets_results_on_its_way_and_the_last_one(newest):
    done = []

    def job(request):
        time.sleep(0.02)
        done.append(request)

    runs = newest(job)
    for request in range(60):
        runs.submit(request)
        time.sleep(0.004)
    await_true(lambda: not runs.is_busy())
    assert done[-1] == 59
    assert done == sorted(set(done))
    assert 3 <= len(done) < 60


def test_closing_ends_the_thread_after_the_run_in_progress_and_drops_what_waits():
    job = SlowJob()
    runs = Newest(job, name="test-closing")
    (thread,) = [thread for thread in threading.enumerate() if thread.name == "test-closing"]
    runs.submit(1)
    await_true(lambda: job.begun == [1])
    runs.submit(2)
    runs.close()
    job.gate.release(2)
    thread.join(LONG_S)
    assert not thread.is_alive()
    assert job.ended == [1]


def test_closing_an_idle_one_ends_its_thread():
    runs = Newest(print, name="test-idle")
    (thread,) = [thread for thread in threading.enumerate() if thread.name == "test-idle"]
    runs.close()
    thread.join(LONG_S)
    assert not thread.is_alive()


@pytest.fixture(scope="module")
def heavy():
    process = HeavyProcess()
    yield process
    process.close()


def test_the_process_returns_what_the_function_returns(heavy):
    assert heavy.run(operator.add, 2, 3) == 5
    assert heavy.run(os.getpid) != os.getpid()


def test_the_process_runs_no_module_of_the_working_folder(tmp_path, monkeypatch):
    for name in ("pickle", "socket"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'was_run')!r}, 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    process = HeavyProcess()
    try:
        assert process.run(os.getenv, "PYTHONSAFEPATH") == "1"
        assert "PYTHONSAFEPATH" not in os.environ
    finally:
        process.close()
    assert not (tmp_path / "was_run").exists()


def test_the_process_computes_what_this_one_would_and_its_arrays_are_read_only(heavy):
    scan = Stair(noise=0.001).scan()
    normals = heavy.run(find_normals, scan, NormalsParams())
    np.testing.assert_array_equal(normals.vectors, find_normals(scan, NormalsParams()).vectors)
    assert not normals.vectors.flags.writeable


def test_an_error_that_is_told_to_the_user_passes_through(heavy, tmp_path):
    with pytest.raises(ReadError) as there:
        heavy.run(read_scan, tmp_path / "none.ply", "auto", "")
    with pytest.raises(ReadError) as here:
        read_scan(tmp_path / "none.ply", "auto")
    assert str(there.value) == str(here.value)


def test_any_other_error_becomes_a_sentence_and_the_process_lives_on(heavy):
    before = heavy.run(os.getpid)
    with pytest.raises(CannotMeasure, match=r"internal error in truediv.*ZeroDivisionError.*report"):
        heavy.run(operator.truediv, 1, 0)
    assert heavy.run(os.getpid) == before


@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
def test_a_process_killed_at_work_is_a_sentence_and_the_next_call_works(heavy):
    killed = heavy.run(os.getpid)
    failures = []

    def work():
        try:
            heavy.run(time.sleep, LONG_S)
        except CannotMeasure as error:
            failures.append(str(error))

    thread = threading.Thread(target=work)
    thread.start()
    await_true(lambda: heavy._lock.locked())
    os.kill(killed, signal.SIGKILL)
    thread.join(LONG_S)
    assert [message for message in failures if "ended unexpectedly" in message and "thinned" in message] == failures
    assert len(failures) == 1
    assert heavy.run(os.getpid) != killed


def test_a_result_that_cannot_be_sent_is_a_sentence_and_the_next_call_works(heavy):
    with pytest.raises(CannotMeasure):
        heavy.run(threading.Lock)
    assert heavy.run(operator.add, 1, 1) == 2


def test_closing_at_work_ends_the_call_and_starts_no_other_process():
    process = HeavyProcess()
    failures = []

    def work():
        try:
            process.run(time.sleep, LONG_S)
        except CannotMeasure as error:
            failures.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    await_true(lambda: process._lock.locked())
    process.close()
    thread.join(LONG_S)
    assert len(failures) == 1
    assert not process._process.is_alive()


def test_the_server_goes_on_while_the_process_works(heavy):
    points = np.random.default_rng(3).uniform(0.0, 3.0, (300_000, 3))
    scan = make_scan(points)
    beats = [time.perf_counter()]
    ended = threading.Event()

    def beat():
        while not ended.wait(0.005):
            beats.append(time.perf_counter())

    heart = threading.Thread(target=beat)
    heart.start()
    try:
        heavy.run(find_normals, scan, NormalsParams())
    finally:
        ended.set()
        heart.join()
    # A page is answered within half a second; in this process the call would stop the heart for all its time, which
    # is seconds. Half of the half second is left for the computing itself.
    assert max(np.diff(beats)) < 0.25


class CountingProcess:
    """In the place of the heavy process: counts its runs, each of which waits until it is let go."""

    def __init__(self):
        self.runs = []
        self.gate = threading.Event()
        self.gate.set()
        self.failures = []
        self.stopped = threading.Event()

    def run(self, function, *inputs, is_wanted):
        self.runs.append((function, *inputs))
        while not self.gate.wait(0.01):
            if not is_wanted():
                self.stopped.set()
                raise Cancelled
        if self.failures:
            raise self.failures.pop()
        return SimpleNamespace(made_for=inputs)

    def close(self):
        pass


@pytest.fixture
def process(monkeypatch):
    process = CountingProcess()
    monkeypatch.setattr("stair_inspector.viewer.compute.workshop.HeavyProcess", lambda: process)
    return process


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.ply"
    path.write_bytes(b"one")
    return path


def ask_twice(ask):
    """Ask from two threads at once and return both answers."""
    answers = []
    threads = [threading.Thread(target=lambda: answers.append(ask())) for _ in range(2)]
    for thread in threads:
        thread.start()
    return threads, answers


@pytest.mark.parametrize("what", ["read", "heavy"])
def test_two_who_ask_for_the_same_wait_for_one_computation(process, path, what):
    workshop = Workshop()
    scan = object()
    ask = {
        "read": lambda: workshop.read(path, FileReading("auto")),
        "heavy": lambda: workshop.heavy(find_normals, scan, 30),
    }[what]
    process.gate.clear()
    threads, answers = ask_twice(ask)
    await_true(lambda: len(process.runs) == 1)
    assert answers == []
    process.gate.set()
    for thread in threads:
        thread.join(LONG_S)
    assert len(process.runs) == 1
    assert answers[0] is answers[1]
    assert ask() is answers[0]


def test_who_no_longer_wants_a_result_leaves_and_the_other_still_gets_it(process, path):
    workshop = Workshop()
    process.gate.clear()
    leaving = threading.Event()
    answers, left = [], []

    def ask_and_leave():
        try:
            workshop.read(path, FileReading("auto"), lambda: not leaving.is_set())
        except Cancelled:
            left.append(True)

    threads = [
        threading.Thread(target=ask_and_leave),
        threading.Thread(target=lambda: answers.append(workshop.read(path, FileReading("auto")))),
    ]
    threads[0].start()
    await_true(lambda: len(process.runs) == 1)
    threads[1].start()
    time.sleep(0.1)
    leaving.set()
    threads[0].join(LONG_S)
    assert left == [True]
    process.gate.set()
    threads[1].join(LONG_S)
    assert len(answers) == len(process.runs) == 1


def test_what_nobody_wants_any_longer_is_stopped_and_made_anew_when_asked_for_again(process, path):
    workshop = Workshop()
    process.gate.clear()
    leaving = threading.Event()
    threading.Timer(0.1, leaving.set).start()
    with pytest.raises(Cancelled):
        workshop.read(path, FileReading("auto"), lambda: not leaving.is_set())
    assert process.stopped.wait(LONG_S)
    process.gate.set()
    assert workshop.read(path, FileReading("auto")) is workshop.read(path, FileReading("auto"))
    assert len(process.runs) == 2


def test_two_who_ask_for_different_things_get_different_things(process, path):
    workshop = Workshop()
    assert workshop.read(path, FileReading("m")) is not workshop.read(path, FileReading("mm"))
    scan = object()
    assert workshop.heavy(find_normals, scan, 30) is not workshop.heavy(find_normals, scan, 31)
    assert len(process.runs) == 4


def test_a_file_that_has_changed_is_read_again(process, path):
    workshop = Workshop()
    first = workshop.read(path, FileReading("auto"))
    path.write_bytes(b"longer")
    second = workshop.read(path, FileReading("auto"))
    assert second is not first
    status = path.stat()
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns + 1_000_000))
    assert workshop.read(path, FileReading("auto")) is not second
    assert len(process.runs) == 3


def test_a_failure_is_not_kept(process, path):
    workshop = Workshop()
    process.failures = [ReadError("damaged")]
    with pytest.raises(ReadError, match="damaged"):
        workshop.read(path, FileReading("auto"))
    assert workshop.read(path, FileReading("auto")) is workshop.read(path, FileReading("auto"))
    assert len(process.runs) == 2


def test_a_missing_file_is_asked_of_the_reader(process, tmp_path):
    Workshop().read(tmp_path / "none.ply", FileReading("auto"))
    assert process.runs == [(read_scan, tmp_path / "none.ply", *FileReading("auto"))]


def test_the_least_recent_scans_are_let_go(process, tmp_path):
    workshop = Workshop()
    paths = [tmp_path / f"{n}.ply" for n in range(_SCANS_KEPT + 1)]
    kept = workshop.read(paths[0], FileReading("auto"))
    for path in paths[1:]:
        workshop.read(path, FileReading("auto"))
        assert (workshop.read(paths[0], FileReading("auto")) is kept) is True
    n_runs = len(process.runs)
    workshop.read(paths[1], FileReading("auto"))
    assert len(process.runs) == n_runs + 1


def test_a_scan_whose_file_has_gone_can_still_be_measured(tmp_path):
    path = tmp_path / "stair.ply"
    path.write_bytes(ply_bytes(np.random.default_rng(0).uniform(0.0, 2.0, (200, 3))))
    workshop = Workshop()
    try:
        scan = workshop.read(path, FileReading("m"))
        path.unlink()
        assert workshop.read(path, FileReading("m")) is scan
        with pytest.raises(ReadError):
            workshop.read(path, FileReading("mm"))
    finally:
        workshop.close()


@pytest.mark.slow
def test_a_call_that_is_no_longer_wanted_ends_at_once_and_the_next_one_works(heavy):
    began = time.monotonic()
    stop_at = began + 0.3
    with pytest.raises(Cancelled):
        heavy.run(time.sleep, LONG_S, is_wanted=lambda: time.monotonic() < stop_at)
    assert time.monotonic() - began < LONG_S / 2
    assert heavy.run(len, [1, 2]) == 2


def test_a_function_is_called_once_things_have_been_quiet():
    calls = []
    settle = Settle(lambda: calls.append(time.monotonic()), 0.15, "test")
    for _ in range(5):
        settle.touch()
        time.sleep(0.03)
    last = time.monotonic()
    await_true(lambda: len(calls) == 1)
    assert calls[0] >= last + 0.1
    settle.touch()
    await_true(lambda: len(calls) == 2)
    asked = time.monotonic()
    settle.call_in(0.2)
    await_true(lambda: len(calls) == 3)
    assert calls[2] >= asked + 0.2
    settle.touch()
    settle.close()
    time.sleep(0.3)
    assert len(calls) == 3


def test_an_idle_process_that_has_died_is_replaced_without_a_word():
    process = HeavyProcess()
    try:
        process._process.kill()
        process._process.join(timeout=10)
        assert process.run(len, [1, 2, 3]) == 3
    finally:
        process.close()
