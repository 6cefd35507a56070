"""Who computes: a thread that keeps only the newest request, and a process for what would stop every page."""

import contextlib
import dataclasses
import multiprocessing
import signal
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Generic, TypeVar, cast

import numpy as np

from stair_inspector.errors import CannotMeasure, StairError
from stair_inspector.files.scans import read_scan
from stair_inspector.geometry.open3d import load_open3d
from stair_inspector.model import Scan
from stair_inspector.params import ScanUnit

R = TypeVar("R")
T = TypeVar("T")
_Order = tuple[Callable[..., object], tuple[object, ...]]
_Answer = tuple[str, object]

_LOOK_S = 0.05
"""How often a waiting inspector is asked whether the result is still wanted."""
_SCANS_KEPT = 4
_RESULTS_KEPT = 8
"""Normals and floors kept for all inspectors together; 24 bytes a point each."""


class Cancelled(Exception):
    """Nobody waits any longer for what was being computed; no error, since somebody asked for it."""


def _always() -> bool:
    return True


class Newest(Generic[R]):
    """Run requests one after the other on a thread of its own; of those that wait only the newest survives.

    A run in progress is finished, not cancelled: cancelling at every slider event would leave a drag without any
    result. ``function`` must not raise.
    """

    def __init__(self, function: Callable[[R], None], name: str) -> None:
        self._function = function
        self._condition = threading.Condition()
        self._waiting: list[R] = []
        self._is_running = False
        self._is_closed = False
        threading.Thread(target=self._loop, name=name, daemon=True).start()

    def submit(self, request: R) -> None:
        """Ask for a run; a request that still waits is dropped."""
        with self._condition:
            self._waiting = [request]
            self._condition.notify()

    def is_busy(self) -> bool:
        """Return whether a request is running or waiting."""
        with self._condition:
            return self._is_running or bool(self._waiting)

    def has_waiting(self) -> bool:
        """Return whether another request waits for the one in progress to end."""
        with self._condition:
            return bool(self._waiting)

    def close(self) -> None:
        """End the thread after the run in progress."""
        with self._condition:
            self._is_closed = True
            self._waiting = []
            self._condition.notify()

    def _loop(self) -> None:
        while True:
            with self._condition:
                self._is_running = False
                while not self._waiting and not self._is_closed:
                    self._condition.wait()
                if self._is_closed:
                    return
                request = self._waiting.pop()
                self._is_running = True
            self._function(request)


class Settle:
    """Call a function once nothing has been touched for a while; ``function`` must not raise."""

    def __init__(self, function: Callable[[], None], quiet_s: float, name: str) -> None:
        self._function = function
        self._quiet_s = quiet_s
        self._condition = threading.Condition()
        self._is_touched = self._is_closed = False
        threading.Thread(target=self._loop, name=name, daemon=True).start()

    def touch(self) -> None:
        """Tell that something has changed."""
        with self._condition:
            self._is_touched = True
            self._condition.notify()

    def close(self) -> None:
        """End the thread; what was touched last is not called for."""
        with self._condition:
            self._is_closed = True
            self._condition.notify()

    def _loop(self) -> None:
        while True:
            with self._condition:
                while not self._is_touched and not self._is_closed:
                    self._condition.wait()
                # Each touch begins the quiet anew.
                while self._is_touched and not self._is_closed:
                    self._is_touched = False
                    self._condition.wait(self._quiet_s)
                if self._is_closed:
                    return
            self._function()


class HeavyProcess:
    """One long-lived process that runs functions which hold the interpreter's lock for seconds.

    Open3D's normals on a million points would freeze the server, and with it every page, for their whole duration.
    The process is spawned, not forked: the server has threads. It ends with the server.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._context = multiprocessing.get_context("spawn")
        self._is_closed = False
        self._start()

    def run(self, function: Callable[..., T], *inputs: object, is_wanted: Callable[[], bool] = _always) -> T:
        """Return ``function(*inputs)``, run in the process; inputs and result are copied.

        Parameters
        ----------
        function, inputs
            As they can be sent to another process.
        is_wanted : callable
            Asked again and again. When it returns False the process is ended and a new one started: nothing else stops
            a library in the middle of a call.

        Raises
        ------
        StairError
            What the function raised.
        CannotMeasure
            The process died, most likely for want of memory. A new one is started.
        Cancelled
            It was no longer wanted.
        """
        with self._lock:
            if not is_wanted():
                raise Cancelled
            if not self._is_closed and not self._process.is_alive():
                # It died while idle, for whatever reason; nothing is lost.
                self._start()
            try:
                self._pipe.send((function, inputs))
                while not self._pipe.poll(_LOOK_S):
                    if not is_wanted():
                        self._restart()
                        raise Cancelled
                outcome, value = self._pipe.recv()
            except (EOFError, BrokenPipeError, ConnectionResetError, OSError) as error:
                self._restart()
                raise CannotMeasure(
                    "the computing process ended unexpectedly, most likely for want of memory; "
                    "try again, or use a thinned scan"
                ) from error
        if isinstance(value, BaseException) and outcome == "error":
            raise value
        return _read_only(cast(T, value))

    def close(self) -> None:
        """End the process, whatever it is doing."""
        self._is_closed = True
        self._end_process()
        # Who waits for an answer learns that the far end is gone; closed under their hands, the pipe's number could
        # be that of another file by then.
        with self._lock:
            self._pipe.close()

    def _restart(self) -> None:
        """End the process and start another; the lock is held."""
        if not self._is_closed:
            self._end_process()
            self._pipe.close()
            self._start()

    def _end_process(self) -> None:
        self._process.terminate()
        self._process.join(timeout=5.0)

    def _start(self) -> None:
        self._pipe, far_end = self._context.Pipe()
        self._process = self._context.Process(target=_serve, args=(far_end,), name="stair-heavy", daemon=True)
        self._process.start()
        far_end.close()


def _serve(pipe: "Connection[_Answer, _Order]") -> None:
    """Run what arrives until the server closes its end; the body of the heavy process."""
    # Ctrl+C in a terminal reaches this process too; the server decides when it ends.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Loaded while the first page is still being sent; a missing library is reported by the first call that needs it.
    with contextlib.suppress(StairError):
        load_open3d()
    while True:
        try:
            function, inputs = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            answer: _Answer = ("ok", function(*inputs))
        except StairError as error:
            answer = ("error", error)
        except Exception as error:  # noqa: BLE001 - whatever it is, the page must be told and the process live on
            answer = ("error", CannotMeasure(f"an internal error in {function.__name__}: {error!r}; please report it"))
        try:
            pipe.send(answer)
        except (BrokenPipeError, OSError):
            return


def _read_only(value: T) -> T:
    """Clear the writeable flag of the arrays in a result, which copying between processes has set again."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for item in dataclasses.fields(value):
            array = getattr(value, item.name)
            if isinstance(array, np.ndarray):
                array.flags.writeable = False
    return value


class Workshop:
    """What the inspectors of one server share: scans that have been read, and the results that took long.

    Two inspectors who ask for the same thing wait for one computation.
    """

    def __init__(self) -> None:
        self._process = HeavyProcess()
        self._scans = _Cache(_SCANS_KEPT)
        self._stamps: dict[tuple[Path, ScanUnit], tuple[int, ...]] = {}
        self._results = _Cache(_RESULTS_KEPT)

    def read(self, path: Path, unit: ScanUnit, is_wanted: Callable[[], bool] = _always) -> Scan:
        """Read a scan, or return it if it has been read and the file has not changed.

        Raises
        ------
        ReadError
            As :func:`stair_inspector.files.scans.read_scan`.
        Cancelled
            It is no longer wanted.
        """
        try:
            status = path.stat()
            stamp: tuple[int, ...] = (status.st_mtime_ns, status.st_size)
        except OSError:
            # The file is gone; what has been read of it can still be measured.
            stamp = self._stamps.get((path, unit), ())
        self._stamps[path, unit] = stamp
        make = partial(self._process.run, read_scan, path, unit)
        return cast(Scan, self._scans.get((path, unit, stamp), make, is_wanted))

    def heavy(self, function: Callable[..., T], *inputs: object, is_wanted: Callable[[], bool] = _always) -> T:
        """Run a pipeline stage in the heavy process, or return its earlier result; see ``pipeline.Memo``."""
        made = self._results.get((function, *inputs), partial(self._process.run, function, *inputs), is_wanted)
        return cast(T, made)

    def close(self) -> None:
        """End the heavy process."""
        self._process.close()


class _Cache:
    """The most recent results by key.

    Who asks for what is being made waits for it. It is made on a thread of its own, because whoever asked first may be
    the first to leave; when all have left, it is stopped.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._lock = threading.Lock()
        self._entries: OrderedDict[Hashable, _Entry] = OrderedDict()

    def get(self, key: Hashable, make: Callable[..., object], is_wanted: Callable[[], bool]) -> object:
        """Return ``make(is_wanted=...)``, kept.

        Raises
        ------
        Cancelled
            ``is_wanted`` returned False before it was there.
        """
        entry = self._join(key, make)
        try:
            while not entry.is_done.wait(_LOOK_S):
                if not is_wanted():
                    raise Cancelled
        finally:
            with self._lock:
                entry.n_waiting -= 1
        if entry.error is not None:
            raise entry.error
        return entry.value

    def _join(self, key: Hashable, make: Callable[..., object]) -> "_Entry":
        is_new = False
        with self._lock:
            entry = self._entries.get(key)
            # What the last of those who waited has just left is being stopped.
            if entry is None or (entry.n_waiting == 0 and not entry.is_done.is_set()):
                entry = self._entries[key] = _Entry()
                is_new = True
            entry.n_waiting += 1
            self._entries.move_to_end(key)
            while len(self._entries) > self._size:
                self._entries.popitem(last=False)
        if is_new:
            threading.Thread(target=self._make, args=(key, entry, make), name="stair-cache", daemon=True).start()
        return entry

    def _make(self, key: Hashable, entry: "_Entry", make: Callable[..., object]) -> None:
        try:
            entry.value = make(is_wanted=lambda: entry.n_waiting > 0)
        except Exception as error:  # noqa: BLE001 - handed on to everybody who waits
            entry.error = error
            with self._lock:
                # A failure is not kept: the file may be mended.
                if self._entries.get(key) is entry:
                    del self._entries[key]
        finally:
            entry.is_done.set()


class _Entry:
    def __init__(self) -> None:
        self.is_done = threading.Event()
        self.n_waiting = 0
        self.value: object = None
        self.error: BaseException | None = None
