"""What an inspector has done on a scan: every change can be undone, and the whole is saved as a project."""

import dataclasses
import datetime
import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict, Unpack

from stair_inspector.content.fields import OF_THE_SURVEYOR, ReportBasis, basis_to_dict
from stair_inspector.content.project_basis import basis_of
from stair_inspector.errors import StairError, WriteError
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.files.project_files import save_project
from stair_inspector.files.projects import KeptRun, Measurement, Project, SavedView, check_entries, check_title
from stair_inspector.overrules import OverrulesParams
from stair_inspector.params import Params
from stair_inspector.viewer.compute.worker import Settle
from stair_inspector.viewer.state.history import History
from stair_inspector.viewer.state.library import Library, state_of

_KEPT_PER_BROWSER = 10
_KEPT_BROWSERS = 100
_LEAVING_S = 10.0
"""Longest wait for a page that is being closed to have saved its work."""
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
    rules: ChosenRules = field(default_factory=ChosenRules)
    basis: ReportBasis = field(default_factory=ReportBasis)

    def __post_init__(self) -> None:
        check_title(self.title)
        for name in ("measurements", "views", "runs"):
            check_entries(name, getattr(self, name))


def work_beside(work: Work, started: Work) -> Work:
    """Return the work that another scan begins with, after that on the scan that is left.

    Settings go on, the rule set with its overlays, decision rule and the user's own rule files, and of the report the
    surveyor, the firm, the instrument, the logo and the paper. All else belongs to the scan, as the unit, up and
    overrules, or to the stair, as a limit that was changed for a reason.
    """
    params = dataclasses.replace(
        work.params, unit=started.params.unit, up=started.params.up, overrules=OverrulesParams()
    )
    fields = {name: getattr(work.basis.fields, name) for name in OF_THE_SURVEYOR}
    basis = dataclasses.replace(
        started.basis,
        fields=dataclasses.replace(started.basis.fields, **fields),
        logo=work.basis.logo,
        paper=work.basis.paper,
    )
    return Work(params, rules=dataclasses.replace(work.rules, edits=(), left=()), basis=basis)


class Changes(TypedDict, total=False):
    """Fields of :class:`Work` that are to be other ones."""

    params: Params
    title: str
    measurements: tuple[Measurement, ...]
    views: tuple[SavedView, ...]
    runs: tuple[KeptRun, ...]
    rules: ChosenRules
    basis: ReportBasis


@dataclass(slots=True)
class Bench:
    """One scan's place in the workshop of a page.

    ``scan`` is its file and ``sha256`` that of the bytes which the work was done on, empty while unknown, and only what
    a saved project says while ``is_from_file``. ``path`` is where the project is saved, None for nowhere; ``state`` is
    what
    :func:`~stair_inspector.viewer.state.library.state_of` said of it when this page last read or wrote it. ``error`` is
    the sentence of a save that failed, until one succeeds.
    """

    scan: Path
    history: History[Work]
    path: Path | None = None
    state: str = ""
    sha256: str = ""
    is_from_file: bool = False
    is_changed: bool = False
    saved_at: datetime.datetime | None = None
    error: str = ""

    def copy(self) -> "Bench":
        """Return the same state, which goes on by itself from here."""
        return dataclasses.replace(self, history=self.history.copy())


@dataclass(frozen=True, slots=True)
class Wish:
    """What a page was last at: a scan by its name in the menu, the work on all that it had open, and its uploads."""

    label: str
    benches: Mapping[str, Bench] = field(default_factory=dict)
    uploads: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class OpenPage:
    """A page that is open as far as the server knows: whether it is being closed, answers, and how to close it."""

    is_leaving: Callable[[], bool]
    is_answering: Callable[[], bool]
    end: Callable[[], None]
    has_left: threading.Event = field(default_factory=threading.Event)


class KeptWishes:
    """What closed pages were last at, by browser: a reload or a dropped connection makes a browser a new client.

    Kept by the server and not by the browser, whose storage all its tabs share: each page that comes back takes up the
    work of one page that has gone, and never that of one that is still open. A browser may come back before the server
    has noticed that the old connection is dead: pages that do not answer are closed then.

    Parameters
    ----------
    forget_upload : callable
        Called with the name of an upload that no page has any more.
    """

    def __init__(self, forget_upload: Callable[[str], None]) -> None:
        self._forget_upload = forget_upload
        self._lock = threading.Lock()
        self._by_browser: OrderedDict[str, list[Wish]] = OrderedDict()
        self._open: dict[str, list[OpenPage]] = {}

    def arrive(self, browser_id: str, page: OpenPage) -> None:
        """Know a page that has been opened."""
        with self._lock:
            self._open.setdefault(browser_id, []).append(page)

    def leave(self, browser_id: str, page: OpenPage, wish: Wish) -> None:
        """Keep a closed page's work."""
        dropped: list[Wish] = []
        with self._lock:
            others = [other for other in self._open.pop(browser_id, []) if other is not page]
            if others:
                self._open[browser_id] = others
            kept = self._by_browser.setdefault(browser_id, [])
            self._by_browser.move_to_end(browser_id)
            kept.append(wish)
            dropped += kept[:-_KEPT_PER_BROWSER]
            del kept[:-_KEPT_PER_BROWSER]
            while len(self._by_browser) > _KEPT_BROWSERS:
                dropped += self._by_browser.popitem(last=False)[1]
        self._forget_uploads(dropped)
        page.has_left.set()

    def take_up(self, browser_id: str) -> Wish | None:
        """Return the newest work kept for a browser, and forget it; that of a page which does not answer counts."""
        with self._lock:
            pages = [*self._open.get(browser_id, [])]
        for page in pages:
            # Loaded again: what it was at is just being put away.
            if page.is_leaving():
                page.has_left.wait(_LEAVING_S)
        wish = self._pop(browser_id)
        if wish is None:
            silent = [page for page in pages if not page.has_left.is_set() and not page.is_answering()]
            for page in silent:
                page.end()
            for page in silent:
                page.has_left.wait(_LEAVING_S)
            wish = self._pop(browser_id)
        return wish

    def has_open(self, browser_id: str) -> bool:
        """Return whether a browser has a page open."""
        with self._lock:
            return browser_id in self._open

    def forget_oldest_uploads(self) -> bool:
        """Forget the uploads of the page that has been gone for longest; return whether there was one."""
        with self._lock:
            found = next(((kept, wish) for kept in self._by_browser.values() for wish in kept if wish.uploads), None)
            if found is None:
                return False
            kept, wish = found
            # Where an upload was open there is nothing to come back to.
            kept.remove(wish)
            if wish.label not in wish.uploads:
                benches = {label: bench for label, bench in wish.benches.items() if label not in wish.uploads}
                kept.insert(0, Wish(wish.label, benches))
        self._forget_uploads([wish])
        return True

    def _pop(self, browser_id: str) -> Wish | None:
        with self._lock:
            kept = self._by_browser.get(browser_id)
            return kept.pop() if kept else None

    def _forget_uploads(self, wishes: list[Wish]) -> None:
        for wish in wishes:
            for label in wish.uploads:
                self._forget_upload(label)


@dataclass(slots=True)
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
    """

    library: Library
    on_saved: Callable[[str, bool], None]
    label: str = ""
    _benches: dict[str, Bench] = field(default_factory=dict)
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

    @property
    def scan(self) -> Path:
        """The present scan's file."""
        return self._bench.scan

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

    def begin(self, label: str, scan: Path, work: Work, path: Path | None, sha256: str = "") -> None:
        """Open a scan: its work begins here, or goes on where it was done on bytes of that SHA-256."""
        state = state_of(path) if path is not None else ""
        self._benches[label] = Bench(scan, History(work), path, state, sha256, is_from_file=bool(sha256))
        self.label = label

    def take_up(self, wish: Wish) -> None:
        """Go on with the work of a page that has gone, each scan in its own project file or in a new one."""
        with self.lock:
            self._benches = {label: bench.copy() for label, bench in wish.benches.items()}
            self.label = wish.label
            for bench in self._benches.values():
                if bench.path is None:
                    continue
                path = self.library.retake_project(bench.scan, bench.path, bench.state)
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
            self.library.release_project(bench.path)
            bench.path, bench.state = path, state_of(path) if path is not None else ""
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
        if self._settle is not None:
            self._settle.close()
        self.save()
        for bench in self._benches.values():
            self.library.release_project(bench.path)

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
                path = before = bench.path
            if state_of(path) not in ("", bench.state):
                other = self.library.new_project(bench.scan, path.parent)
                if other is None:
                    raise WriteError(f"{path}: was changed by somebody else; move files of this scan's projects away")
                news = f"{path.name} was changed by somebody else and is left as it is; this work is in {other.name}"
                self.library.release_project(path)
                path = other
            state = hashlib.sha256(save_project(path, project)).hexdigest()
            with self.lock:
                bench.error, bench.saved_at = "", datetime.datetime.now()
                if bench.path == before:
                    bench.path, bench.state = path, state
        except StairError as error:
            # Tried again with the next change, and when the page closes.
            bench.is_changed, bench.error = True, str(error)
            self.on_saved(str(error), True)
        else:
            self.on_saved(news, False)

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
    """Return the work that a project holds.

    Raises
    ------
    ConfigError
        What it keeps for the report is not possible.
    """
    return Work(
        project.params,
        project.title,
        project.measurements,
        project.views,
        project.runs,
        project.rules,
        basis_of(project),
    )
