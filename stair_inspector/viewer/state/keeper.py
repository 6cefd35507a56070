"""The work on every scan that a page has opened: every change can be undone, and the whole is saved as a project."""

import dataclasses
import datetime
import hashlib
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Unpack

from stair_inspector.content.basis_files import basis_to_dict
from stair_inspector.content.pin_values import pinned_to_dict
from stair_inspector.errors import ConfigError, StairError, WriteError
from stair_inspector.files.project_files import save_project
from stair_inspector.files.projects import Project
from stair_inspector.params import Params
from stair_inspector.viewer.bridge.doors.words import VIEW_ONLY
from stair_inspector.viewer.compute.threads import Settle
from stair_inspector.viewer.state.history import History
from stair_inspector.viewer.state.library import Library, state_of
from stair_inspector.viewer.state.wishes import Wish
from stair_inspector.viewer.state.work import Bench, Changes, Work

_QUIET_S = 0.6
"""A change is saved once nothing has changed for so long; a drag of a slider is one change."""
_AGAIN_S = 2.0
"""What could not be saved is tried again after so long, until it is saved."""


class ViewOnlyError(ConfigError):
    """Somebody tried to change the work on a page that only shows it."""


class Keeper:
    """The work on every scan that one page has opened, and its project files.

    ``lock`` is held around every change; who reads, decides and then changes holds it all the while.

    Parameters
    ----------
    library : Library
        Says where projects are saved.
    on_saved : callable
        Called when a project was saved, or could not be, with what is to be told of it, empty for nothing, and whether
        it could not.
    is_view_only : bool
        Whether every change of the work is refused by a :class:`ViewOnlyError`.
    """

    def __init__(self, library: Library, on_saved: Callable[[str, bool], None], *, is_view_only: bool = False) -> None:
        self.is_view_only = is_view_only
        self._library = library
        self._on_saved = on_saved
        self.label = ""
        self.lock = threading.RLock()
        self._save_lock = threading.Lock()
        self._benches: dict[str, Bench] = {}
        self._settle = Settle(self._settled, _QUIET_S, "stair-autosave")

    @property
    def work(self) -> Work:
        """The work on the present scan."""
        return self._bench.history.value

    @property
    def history(self) -> History[Work]:
        """The changes of the present scan."""
        return self._bench.history

    @property
    def path(self) -> Path | None:
        """Where the present scan's project is saved, None where nothing is."""
        return self._bench.path

    @property
    def scan(self) -> Path:
        """The present scan's file."""
        return self._bench.scan

    @property
    def last(self) -> Params | None:
        """The settings that the present scan's saved work had when it was taken up; None where there was none."""
        return self._bench.last

    @property
    def error(self) -> str:
        """Why the present scan's project could not be saved when that was last tried; empty if it could."""
        return self._bench.error

    @property
    def saved_at(self) -> datetime.datetime | None:
        """When all of the present scan's work was saved on this page; None if it was not, or has changed since."""
        bench = self._bench
        return None if bench.is_changed else bench.saved_at

    def has(self, label: str) -> bool:
        """Return whether a scan has been opened on this page."""
        return label in self._benches

    def is_saved(self, label: str) -> bool:
        """Return whether all of the work on a scan is in a project file."""
        bench = self._benches.get(label)
        return bench is not None and not bench.is_changed and (bench.saved_at is not None or bench.is_from_file)

    def begin(self, label: str, scan: Path, work: Work, path: Path | None, sha256: str = "") -> None:
        """Open a scan: its work begins here, or goes on where it was done on bytes of that SHA-256."""
        state = state_of(path) if path is not None else ""
        is_saved = bool(sha256)
        last = work.params if is_saved else None
        self._benches[label] = Bench(scan, History(work), path, state, sha256, is_from_file=is_saved, last=last)
        self.label = label

    def take_up(self, wish: Wish) -> None:
        """Go on with the work of a page that has gone, each scan in its own project file or in a new one."""
        with self.lock:
            self._benches = {label: bench.copy() for label, bench in wish.benches.items()}
            self.label = wish.label
            for bench in self._benches.values():
                if bench.path is None:
                    continue
                path = self._library.retake_project(bench.scan, bench.path, bench.state)
                if path != bench.path:
                    bench.is_changed = bench.is_changed or bench.state != ""
                    bench.path, bench.state = path, ""

    def benches(self) -> dict[str, Bench]:
        """Return the work on every scan, as it stands."""
        with self.lock:
            return {label: bench.copy() for label, bench in self._benches.items()}

    def bench(self, label: str) -> Bench | None:
        """Return the place of a scan, None where it is not open; the lock is held while it is used."""
        return self._benches.get(label)

    def put_aside(self, label: str, work: Work, path: Path | None, words: str, *, is_changed: bool) -> None:
        """Leave a scan's project file as it is and go on in another one with other work; undo brings the first back.

        ``is_changed`` is whether the work has still to be saved.
        """
        with self.lock:
            bench = self._benches[label]
            self._library.release_project(bench.path)
            bench.path, bench.state = path, state_of(path) if path is not None else ""
            # Work that is there already was saved by an earlier session.
            bench.last = work.params if path is not None and not is_changed else None
            bench.history.push(work, words)
            bench.is_changed = is_changed

    def turn_to(self, label: str) -> Work:
        """Go back to a scan that has been opened, and return the work on it."""
        self.label = label
        return self.work

    def know_scan(self, label: str, sha256: str) -> None:
        """Tell which bytes a scan has; only then can its work be saved."""
        with self.lock:
            bench = self._benches.get(label)
            if bench is not None:
                bench.sha256, bench.is_from_file = sha256, False
                if bench.is_changed:
                    self._settle.touch()

    def change(self, words: str, merge_key: str = "", **fields: Unpack[Changes]) -> Work:
        """Change some of the work, so that it can be undone, and save it soon."""
        with self.lock:
            return self.replace(dataclasses.replace(self.work, **fields), words, merge_key)

    def replace(self, after: Work, words: str, merge_key: str = "") -> Work:
        """Put other work in the place of the present, so that it can be undone, and save it soon."""
        with self.lock:
            history = self._bench.history
            before = history.value
            if after != before:
                self._check_may_change()
            history.push(after, words, merge_key)
            if after != before:
                self._touch()
            return after

    def undo(self) -> Work:
        """Take the last change back and return the work before it."""
        return self._step(History.undo)

    def redo(self) -> Work:
        """Do again what was undone."""
        return self._step(History.redo)

    def project(self, label: str | None = None) -> Project | None:
        """Return the work on a scan as a project; None while its scan has not been read."""
        label = label or self.label
        bench = self._benches.get(label)
        if bench is None or not bench.sha256 or bench.is_from_file:
            return None
        work = bench.history.value
        return Project(
            scan_file=bench.scan.name,
            scan_sha256=bench.sha256,
            params=work.params,
            title=work.title,
            measurements=work.measurements,
            views=work.views,
            runs=work.runs,
            rules=work.rules,
            report=basis_to_dict(work.basis),
            findings=pinned_to_dict(work.findings),
            second=work.second,
        )

    def save(self) -> None:
        """Save what has changed, of every scan of this page."""
        with self._save_lock:
            with self.lock:
                benches = list(self._benches.items())
            for label, bench in benches:
                self._save(label, bench)

    def close(self) -> None:
        """Save, and give the project files back."""
        self._settle.close()
        self.save()
        for bench in self._benches.values():
            self._library.release_project(bench.path)

    @property
    def _bench(self) -> Bench:
        return self._benches[self.label]

    def _save(self, label: str, bench: Bench) -> None:
        news = ""
        try:
            with self.lock:
                project = self.project(label)
                if project is None or not bench.is_changed or bench.path is None:
                    return
                # Before it is written: what changes meanwhile is saved the next time.
                bench.is_changed = False
                path = bench.path
            if state_of(path) not in ("", bench.state):
                other = self._library.new_project(bench.scan, path.parent)
                if other is None:
                    raise WriteError(f"{path}: was changed by somebody else; move files of this scan's projects away")
                news = f"{path.name} was changed by somebody else and is left as it is; this work is in {other.name}"
                self._library.release_project(path)
                with self.lock:
                    # From now on, also where this save fails: no other name is taken the next time.
                    if bench.path == path:
                        bench.path, bench.state = other, ""
                path = other
            state = hashlib.sha256(save_project(path, project)).hexdigest()
            with self.lock:
                bench.error, bench.saved_at = "", datetime.datetime.now()
                if bench.path == path:
                    bench.state = state
        except StairError as error:
            # Tried again soon, with the next change, and when the page closes; said in a notice once.
            is_known = str(error) == bench.error
            bench.is_changed, bench.error = True, str(error)
            self._settle.call_in(_AGAIN_S)
            self._on_saved(news if is_known else str(error), True)
        else:
            self._on_saved(news, False)

    def _step(self, step: Callable[[History[Work]], Work]) -> Work:
        with self.lock:
            self._check_may_change()
            self._touch()
            return step(self.history)

    def _check_may_change(self) -> None:
        if self.is_view_only:
            raise ViewOnlyError(VIEW_ONLY)

    def _touch(self) -> None:
        self._bench.is_changed = True
        self._settle.touch()

    def _settled(self) -> None:
        with self.lock:
            if self._benches:
                self._bench.history.settle()
        self.save()
