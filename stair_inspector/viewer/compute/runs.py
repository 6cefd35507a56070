"""One inspector's runs: the newest wish is computed, progress is told by stage, and all of it can be cancelled."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from stair_inspector.errors import StairError
from stair_inspector.geometry.arrays import Floats
from stair_inspector.memo import Memo
from stair_inspector.model import HeightOrder, Inspection, Scan
from stair_inspector.params import FileReading, Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.compute.threads import Newest
from stair_inspector.viewer.compute.workshop import Workshop

_PATIENCE_S = 0.2
"""A run that takes no longer changes the page at once; a longer one is announced."""
_STAGES = {
    "read": ("reading the file", 5.0),
    "normals": ("estimating normals", 20.0),
    "up": ("looking for the floor", 60.0),
    "plumb": ("asking the treads for the vertical", 68.0),
    "heights": ("sorting by height", 72.0),
    "patches": ("telling surfaces apart", 80.0),
    "bars": ("putting bars together", 83.0),
    "flights": ("looking for flights", 85.0),
    "nosings": ("finding the nosings", 88.0),
    "survey": ("measuring the steps", 95.0),
}
"""What is said of a stage, and where the bar stands when it begins, percent."""
CANCELLED = "cancelled; what is shown is the last good result. Press Run again, move a control, or undo"
_INTERNAL = "an internal error stopped this run; the server's log has the details. Try other settings"


@dataclass(frozen=True, slots=True)
class Request:
    """What a run is asked for: a scan by its name in the list, and settings."""

    label: str
    params: Params


@dataclass(frozen=True, slots=True)
class Progress:
    """What is being computed: words and how far it is, percent."""

    words: str
    percent: float


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """What a run has found out on its way: the ``normals`` (n, 3) of the scan's points, and them by height."""

    normals: Floats
    heights: HeightOrder


@dataclass(frozen=True, slots=True)
class Listener:
    """Who is told of a run, each on the thread of the runs.

    ``find(request, read)`` returns the scan, from ``read(reading)``, and the request as it is to be run; ``done`` gets
    a result, ``failed`` a sentence, ``progress`` what is being computed.
    """

    find: Callable[[Request, Callable[[FileReading], Scan]], tuple[Request, Scan]]
    done: Callable[[Request, Scan, Inspection, Prepared], None]
    failed: Callable[[str], None]
    progress: Callable[[Progress], None]


class Runs:
    """The thread that computes for one page."""

    def __init__(self, workshop: Workshop, listener: Listener, notices: Notices, name: str) -> None:
        self._workshop = workshop
        self._listener = listener
        self._notices = notices
        self._memo = Memo(partial(workshop.heavy, is_wanted=self._is_wanted), self._enter_stage)
        self._stage: str | None = None
        self._n_points = 0
        self._is_announced = False
        self._is_closed = False
        # Runs are numbered as they are asked for: what is given up are all up to a number, begun or not.
        self._lock = threading.Lock()
        self._number = self._n_asked = self._n_cancelled = self._n_left = 0
        self._label = ""
        self._newest: Newest[tuple[int, Request, Path]] = Newest(self._run, name=name)

    def submit(self, request: Request, path: Path) -> None:
        """Ask for a run; one that waits is dropped, one in progress is finished, unless it is of another scan."""
        with self._lock:
            if request.label != self._label:
                self._n_left = self._n_asked
            self._label = request.label
            self._n_asked += 1
            self._newest.submit((self._n_asked, request, path))

    def cancel(self) -> None:
        """Stop the run in progress: between two stages, or by ending the process that works for nobody else.

        One that waits is not begun.
        """
        with self._lock:
            self._n_cancelled = self._n_asked

    def is_busy(self) -> bool:
        """Return whether a run is in progress or waiting."""
        return self._newest.is_busy()

    def has_waiting(self) -> bool:
        """Return whether another run waits."""
        return self._newest.has_waiting()

    def close(self) -> None:
        """End the thread, and what it is computing unless others want it."""
        self._is_closed = True
        self._newest.close()

    def _is_wanted(self) -> bool:
        return not (self._number <= max(self._n_cancelled, self._n_left) or self._is_closed)

    def _run(self, wanted: tuple[int, Request, Path]) -> None:
        """Compute and publish; the body of the thread. Never raises."""
        self._number, request, path = wanted
        announce = threading.Timer(_PATIENCE_S, self._announce)
        announce.daemon = True
        self._is_announced = False
        self._stage, self._n_points = "read", 0
        announce.start()
        try:
            if not self._is_wanted():
                raise Cancelled
            request, scan = self._listener.find(request, lambda how: self._workshop.read(path, how, self._is_wanted))
            self._n_points = len(scan.points)
            inspection = inspect(scan, request.params, self._memo)
            self._stage = None
            announce.cancel()
            prepared = Prepared(self._memo.result("normals").vectors, self._memo.result("heights"))
            self._listener.done(request, scan, inspection, prepared)
        except Cancelled:
            self._end(CANCELLED)
        except StairError as error:
            self._end(str(error))
        except Exception:  # noqa: BLE001 - the outermost frame of this thread: the page must go on
            self._notices.log("an inspector's run failed")
            self._end(_INTERNAL)
        finally:
            announce.cancel()

    def _end(self, words: str) -> None:
        self._stage = None
        if not self._is_closed and self._number > self._n_left:
            self._listener.failed(words)

    def _enter_stage(self, stage: str) -> None:
        if not self._is_wanted():
            raise Cancelled
        self._stage = stage
        if self._is_announced and stage in _STAGES:
            self._announce()

    def _announce(self) -> None:
        stage = self._stage
        if stage is None or self._is_closed:
            return
        self._is_announced = True
        size = f" of {self._n_points:,} points" if stage == "normals" and self._n_points else ""
        words, percent = _STAGES.get(stage, ("measuring", 90.0))
        self._listener.progress(Progress(f"{words}{size} …", percent))
