"""What the pages of one server share: scans that have been read, and results that took long, each made once."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import partial
from pathlib import Path
from typing import TypeVar, cast

from stair_inspector.files.scans import read_scan
from stair_inspector.model import Scan
from stair_inspector.params import FileReading
from stair_inspector.viewer.compute.heavy_process import LOOK_S, Cancelled, HeavyProcess, always

T = TypeVar("T")

_SCANS_KEPT = 4
_RESULTS_KEPT = 8
"""Normals and floors kept for all inspectors together; 24 bytes a point each."""


class Workshop:
    """What the inspectors of one server share: scans that have been read, and the results that took long.

    Two inspectors who ask for the same thing wait for one computation.
    """

    def __init__(self) -> None:
        self._process = HeavyProcess()
        self._scans = _Cache(_SCANS_KEPT)
        self._stamps: dict[tuple[Path, FileReading], tuple[int, ...]] = {}
        self._results = _Cache(_RESULTS_KEPT)

    def read(self, path: Path, reading: FileReading, is_wanted: Callable[[], bool] = always) -> Scan:
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
            stamp = self._stamps.get((path, reading), ())
        self._stamps[path, reading] = stamp
        make = partial(self._process.run, read_scan, path, *reading)
        return cast(Scan, self._scans.get((path, reading, stamp), make, is_wanted))

    def heavy(self, function: Callable[..., T], *inputs: object, is_wanted: Callable[[], bool] = always) -> T:
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
            while not entry.is_done.wait(LOOK_S):
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
