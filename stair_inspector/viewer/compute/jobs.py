"""What is made for a page besides its results: files, pictures, suggestions. One at a time, told, and cancellable."""

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.compute.heavy_process import LOOK_S, Cancelled

T = TypeVar("T")

Tell = Callable[[str, float], None]
"""Takes what is being made and how far it is, percent; raises Cancelled when it is no longer wanted."""

_PATIENCE_S = 0.5
"""What takes no longer changes nothing on the page; what takes longer says so and can be cancelled."""
_BEGUN_PERCENT = 10.0


class Making:
    """Make things on a thread of their own while whoever asked waits, so that they can be given up at any moment.

    Parameters
    ----------
    show : callable
        Takes what is being made and how far it is, percent; None when it is over.
    is_closed : callable
        Whether the page has gone.
    """

    def __init__(self, show: Callable[[str | None, float], None], is_closed: Callable[[], bool]) -> None:
        self._show = show
        self._is_closed = is_closed
        self._one_at_a_time = threading.Lock()
        self._job: _Job | None = None
        self._words = ""

    def cancel(self) -> None:
        """Give up what is being made."""
        if self._job is not None:
            self._job.stop.set()

    def make(self, words: str, function: Callable[[Tell], T]) -> T:
        """Return what a function makes.

        Parameters
        ----------
        words : str
            What is being made: ``the suggestion``, or a file's name.
        function : callable
            Called on a thread of its own with what it may tell its progress to. One that does not is not stopped when
            it is cancelled: it runs to its end and its result is dropped. Until then nothing else is made.

        Raises
        ------
        ConfigError
            Something else is being made, or it was cancelled.
        Exception
            What the function raised.
        """
        if not self._one_at_a_time.acquire(blocking=False):
            raise ConfigError(f"{words}: {self._words} is still being made; wait for it, or press Cancel")
        self._words = words
        self._job = job = _Job(self._show, self._is_closed)
        outcome: Future[T] = Future()

        def run() -> None:
            try:
                outcome.set_result(function(job.tell))
            except BaseException as error:  # noqa: BLE001 - handed on to the thread that waits
                outcome.set_exception(error)
            finally:
                try:
                    job.end()
                finally:
                    self._one_at_a_time.release()

        worker = threading.Thread(target=run, name="stair-making", daemon=True)
        worker.start()
        says_at = time.monotonic() + _PATIENCE_S
        while worker.is_alive() and not job.is_given_up():
            worker.join(LOOK_S)
            if worker.is_alive() and time.monotonic() > says_at:
                says_at = math.inf
                job.show(f"making {words} …", _BEGUN_PERCENT)
        job.end()
        try:
            if worker.is_alive():
                raise Cancelled
            return outcome.result()
        except Cancelled as error:
            raise ConfigError(f"{words}: cancelled") from error


class _Job:
    """One thing that is made; what it says after its end is not heard."""

    def __init__(self, show: Callable[[str | None, float], None], is_closed: Callable[[], bool]) -> None:
        self._show = show
        self._is_closed = is_closed
        self._lock = threading.Lock()
        self._is_over = False
        self.stop = threading.Event()

    def is_given_up(self) -> bool:
        return self.stop.is_set() or self._is_closed()

    def tell(self, words: str, percent: float) -> None:
        if self.is_given_up():
            raise Cancelled
        self.show(words, percent)

    def show(self, words: str, percent: float) -> None:
        with self._lock:
            if not self._is_over:
                self._show(words, percent)

    def end(self) -> None:
        with self._lock:
            if not self._is_over:
                self._is_over = True
                self._show(None, 0.0)
