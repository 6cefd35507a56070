"""What an inspector has done on a scan: every change can be undone, and the whole is saved as a project."""

import dataclasses
import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict, Unpack

from stair_inspector.errors import StairError
from stair_inspector.files.projects import KeptRun, Measurement, Project, SavedView, check_length, save_project
from stair_inspector.params import Params
from stair_inspector.viewer.history import History
from stair_inspector.viewer.library import Library
from stair_inspector.viewer.worker import Settle

_KEPT_PER_BROWSER = 10
_KEPT_BROWSERS = 100
_QUIET_S = 0.6
"""A change is saved once nothing has changed for so long; a drag of a slider is one change."""


@dataclass(frozen=True, slots=True)
class Work:
    """What can be undone: everything of a :class:`Project` but the scan it belongs to."""

    params: Params
    title: str = ""
    measurements: tuple[Measurement, ...] = ()
    views: tuple[SavedView, ...] = ()
    runs: tuple[KeptRun, ...] = ()

    def __post_init__(self) -> None:
        for name in ("measurements", "views", "runs"):
            check_length(name, getattr(self, name))


class Changes(TypedDict, total=False):
    """Fields of :class:`Work` that are to be other ones."""

    params: Params
    title: str
    measurements: tuple[Measurement, ...]
    views: tuple[SavedView, ...]
    runs: tuple[KeptRun, ...]


@dataclass(frozen=True, slots=True)
class Wish:
    """What a page was last at: a scan by its name in the menu, the work on it, its uploads, and its project file."""

    label: str
    work: Work
    uploads: tuple[str, ...] = ()
    project: Path | None = None


class KeptWishes:
    """What closed pages were last at, by browser: a reload or a dropped connection makes a browser a new client.

    Kept by the server and not by the browser, whose storage all its tabs share: each page that comes back takes up the
    work of one page that has gone, and never that of one that is still open.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._by_browser: OrderedDict[str, list[Wish]] = OrderedDict()

    def leave(self, browser_id: str, wish: Wish) -> None:
        """Keep a closed page's work."""
        with self._lock:
            kept = self._by_browser.setdefault(browser_id, [])
            self._by_browser.move_to_end(browser_id)
            kept.append(wish)
            del kept[:-_KEPT_PER_BROWSER]
            while len(self._by_browser) > _KEPT_BROWSERS:
                self._by_browser.popitem(last=False)

    def take_up(self, browser_id: str) -> Wish | None:
        """Return the newest work kept for a browser, and forget it."""
        with self._lock:
            kept = self._by_browser.get(browser_id)
            return kept.pop() if kept else None


@dataclass(slots=True)
class _Bench:
    """One scan's place in the workshop of a page."""

    history: History[Work]
    path: Path | None = None
    sha256: str = ""
    is_changed: bool = False


@dataclass(slots=True)
class Keeper:
    """The work on every scan that one page has opened, and its project files.

    ``lock`` is held around every change; who reads, decides and then changes holds it all the while.

    Parameters
    ----------
    library : Library
        Says where projects are saved.
    on_saved : callable
        Called with the path of a project that was saved, or None, and the sentence of an error, or an empty one.
    """

    library: Library
    on_saved: Callable[[Path | None, str], None]
    label: str = ""
    _benches: dict[str, _Bench] = field(default_factory=dict)
    _settle: Settle | None = None
    lock: threading.RLock = field(default_factory=threading.RLock)
    _save_lock: threading.Lock = field(default_factory=threading.Lock)

    def __post_init__(self) -> None:
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

    def has(self, label: str) -> bool:
        """Return whether a scan has been opened on this page."""
        return label in self._benches

    def begin(self, label: str, work: Work, path: Path | None, *, is_changed: bool = False) -> None:
        """Open a scan: its work begins here."""
        self._benches[label] = _Bench(History(work), path, is_changed=is_changed)
        self.label = label

    def turn_to(self, label: str) -> Work:
        """Go back to a scan that has been opened, and return the work on it."""
        self.label = label
        return self.work

    def know_scan(self, label: str, sha256: str) -> None:
        """Tell which bytes a scan has; only then can its work be saved."""
        bench = self._benches.get(label)
        if bench is not None:
            bench.sha256 = sha256
            if bench.is_changed and self._settle is not None:
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
            history.push(after, words, merge_key)
            if after != before:
                self._touch()
            return after

    def undo(self) -> Work:
        """Take the last change back and return the work before it."""
        with self.lock:
            work = self._bench.history.undo()
            self._touch()
            return work

    def redo(self) -> Work:
        """Do again what was undone."""
        with self.lock:
            work = self._bench.history.redo()
            self._touch()
            return work

    def project(self, label: str | None = None) -> Project | None:
        """Return the work on a scan as a project; None while its scan has not been read."""
        label = label or self.label
        bench = self._benches.get(label)
        if bench is None or not bench.sha256:
            return None
        work = bench.history.value
        return Project(
            scan_file=self.library.path(label).name,
            scan_sha256=bench.sha256,
            params=work.params,
            title=work.title,
            measurements=work.measurements,
            views=work.views,
            runs=work.runs,
        )

    def save(self) -> None:
        """Save what has changed, of every scan of this page."""
        with self._save_lock:
            for label, bench in list(self._benches.items()):
                if not bench.is_changed or bench.path is None:
                    continue
                try:
                    project = self.project(label)
                    if project is None:
                        continue
                    bench.is_changed = False
                    save_project(bench.path, project)
                except StairError as error:
                    # Tried again with the next change, and when the page closes.
                    bench.is_changed = True
                    self.on_saved(None, str(error))
                else:
                    self.on_saved(bench.path, "")

    def move(self, path: Path | None) -> None:
        """Save the present scan's work elsewhere from now on."""
        self._bench.path = path

    def close(self) -> None:
        """Save, and give the project files back."""
        if self._settle is not None:
            self._settle.close()
        self.save()
        for bench in self._benches.values():
            self.library.release_project(bench.path)

    @property
    def _bench(self) -> _Bench:
        return self._benches[self.label]

    def _touch(self) -> None:
        self._bench.is_changed = True
        if self._settle is not None:
            self._settle.touch()

    def _settled(self) -> None:
        with self.lock:
            if self._benches:
                self._bench.history.settle()
        self.save()


def work_of(project: Project) -> Work:
    """Return the work that a project holds."""
    return Work(project.params, project.title, project.measurements, project.views, project.runs)
