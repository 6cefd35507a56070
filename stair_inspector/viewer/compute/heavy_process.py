"""A process of its own for what would stop every page."""

import dataclasses
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import TypeVar, cast

import numpy as np

from stair_inspector.errors import CannotMeasure, StairError
from stair_inspector.geometry.open3d import find_open3d

T = TypeVar("T")
_Order = tuple[Callable[..., object], tuple[object, ...]]
_Answer = tuple[str, object]

_SAFE_PATH = "PYTHONSAFEPATH"
LOOK_S = 0.05
"""How often a waiting inspector is asked whether the result is still wanted."""


class Cancelled(Exception):
    """Nobody waits any longer for what was being computed; no error, since somebody asked for it."""


def always() -> bool:
    """Return that something is still wanted."""
    return True


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

    def run(self, function: Callable[..., T], *inputs: object, is_wanted: Callable[[], bool] = always) -> T:
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
                while not self._pipe.poll(LOOK_S):
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
        with _without_working_folder():
            self._process.start()
        far_end.close()


@contextmanager
def _without_working_folder() -> Iterator[None]:
    """Let no process that is started meanwhile look for its modules in the working folder, beside somebody's scans."""
    before = os.environ.get(_SAFE_PATH)
    os.environ[_SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[_SAFE_PATH]
        else:
            os.environ[_SAFE_PATH] = before


def _serve(pipe: "Connection[_Answer, _Order]") -> None:
    """Run what arrives until the server closes its end; the body of the heavy process."""
    # Ctrl+C in a terminal reaches this process too; the server decides when it ends.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Loaded while the first page is still being sent; a note says it where it cannot be.
    find_open3d()
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
            held = getattr(value, item.name)
            if isinstance(held, np.ndarray):
                held.flags.writeable = False
            else:
                _read_only(held)
    return value
