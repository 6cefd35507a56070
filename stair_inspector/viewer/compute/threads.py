"""Threads of a page: one that runs only the newest request, and one that waits until nothing more is touched."""

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

R = TypeVar("R")


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
        self._due_at: float | None = None
        threading.Thread(target=self._loop, name=name, daemon=True).start()

    def call_in(self, wait_s: float) -> None:
        """Have the function called after so long at the latest, whether something is touched or not."""
        with self._condition:
            self._due_at = time.monotonic() + wait_s
            self._condition.notify()

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
                while not (self._is_touched or self._is_closed or self._is_due()):
                    self._condition.wait(None if self._due_at is None else self._due_at - time.monotonic())
                self._due_at = None
                # Each touch begins the quiet anew.
                while self._is_touched and not self._is_closed:
                    self._is_touched = False
                    self._condition.wait(self._quiet_s)
                if self._is_closed:
                    return
            self._function()

    def _is_due(self) -> bool:
        return self._due_at is not None and time.monotonic() >= self._due_at
