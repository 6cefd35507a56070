"""Opening scans on one page: from the folder, from an upload, with the work that was saved, and after a reload."""

import dataclasses
import uuid
from collections.abc import Callable, Mapping
from pathlib import Path

import viser

from stair_inspector.errors import ConfigError, ReadError
from stair_inspector.files.projects import SecondScan
from stair_inspector.files.settings import settings_beside
from stair_inspector.overrules import OverrulesParams
from stair_inspector.params import Params
from stair_inspector.viewer.bridge.controls import SettingControls
from stair_inspector.viewer.bridge.doors.words import VIEW_ONLY
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.bridge.widgets import File
from stair_inspector.viewer.state.keeper import Keeper, ViewOnlyError
from stair_inspector.viewer.state.library import Library
from stair_inspector.viewer.state.wishes import KeptWishes, OpenPage, Wish
from stair_inspector.viewer.state.work import Arrival, Work, work_beside, work_of

_BROWSER_KEY = "stair_inspector.browser"
_SCAN_KEY = "stair_inspector.scan"
"""In the browser's storage: who it is, and the scan it had open last, for when the server starts anew."""
_VIEWED_KEY = "stair_inspector.viewed"
"""The scan that a view-only page had open last; the other pages of that browser go on with their own."""
_STORAGE_S = 5.0
_LONGEST_STORED = 1000
_ANSWER_S = 2.0
"""Longest wait for a sign of life from a page."""


class Opening:
    """Which scan is open, and the work that it begins with. Callers hold the keeper's lock where they change both."""

    def __init__(
        self,
        client: viser.ClientHandle,
        library: Library,
        keeper: Keeper,
        controls: SettingControls,
        notices: Notices,
        started: Work,
        kept: KeptWishes,
        end: Callable[[], None],
    ) -> None:
        self._client = client
        self._library = library
        self._keeper = keeper
        self._controls = controls
        self._notices = notices
        self._started = started
        self._kept = kept
        self._page = OpenPage(lambda: notices.is_closed, self._is_answering, end)
        self._browser_id: str | None = None
        self._uploads: tuple[str, ...] = ()
        # Whether nobody has asked for the scan that is open, and why files could not be read when last tried.
        self._is_first = False
        self.unreadable: Mapping[str, ReadError] = {}
        # What came along to the scan that is open, until it is kept or changed.
        self.came_along: Arrival | None = None

    def restore(self) -> None:
        """Take up what a page of this browser, now closed, was at; or open the scan it had last, or the first."""
        wish, last = self._recall()
        if wish is not None:
            self._uploads = wish.uploads
            self._keeper.take_up(wish)
            self._controls.load(self._keeper.work.params)
        else:
            labels = self._library.labels()
            self._is_first = last not in labels
            self._open(labels[0] if self._is_first else str(last), self._started)
        if self._browser_id is not None:
            self._kept.arrive(self._browser_id, self._page)

    def leave(self) -> None:
        """Keep the work for the page that this browser opens next."""
        benches = self._keeper.benches()
        # Without any it has failed before it had opened a scan.
        if self._browser_id is not None and benches:
            wish = Wish(self._keeper.label, benches, self._uploads)
            self._kept.leave(self._browser_id, self._page, wish)
        else:
            for label in self._uploads:
                self._library.forget_upload(label)

    def choose(self, label: str) -> bool:
        """Turn to another scan, with the work on it; return False where it is open already.

        Raises
        ------
        ConfigError
            No scan has that name.
        """
        keeper = self._keeper
        if label == keeper.label:
            return False
        self._is_first, self.came_along = False, None
        if keeper.has(label):
            self._controls.load(keeper.turn_to(label).params)
        else:
            source = keeper.label
            self._open(label, work_beside(keeper.work, self._started))
            if keeper.last is None:
                self.came_along = Arrival(source, keeper.work.params, keeper.work.rules)
        if label not in self._uploads:
            self._client.local_storage.set_item(_VIEWED_KEY if keeper.is_view_only else _SCAN_KEY, label)
        return True

    def mark(self, label: str, error: ReadError | None) -> None:
        """Note that a scan could be read, or why not."""
        others = {known: why for known, why in self.unreadable.items() if known != label}
        self.unreadable = others if error is None else others | {label: error}

    def readable_instead(self) -> str | None:
        """Return the scan to open in place of a first one that nobody asked for and that cannot be read; else None."""
        if not self._is_first or self._keeper.label not in self.unreadable:
            return None
        return next((label for label in self.labels() if label not in self.unreadable), None)

    def open_instead(self, label: str) -> None:
        """Turn to a scan that nobody asked for either."""
        self.choose(label)
        self._is_first = True

    def look_for_scans(self) -> tuple[int, int]:
        """Look into the folders again; return how many scans are new, and how many there are."""
        before = self._library.labels(self._uploads)
        self._library.refresh()
        now = self._library.labels(self._uploads)
        return len(set(now) - set(before)), len(now)

    def keep_upload(self, file: File) -> str:
        """Keep an uploaded scan and return its name in the list."""
        if self._keeper.is_view_only:
            raise ViewOnlyError(VIEW_ONLY)
        while self._library.is_full() and self._kept.forget_oldest_uploads():
            continue
        label = self._library.add_upload(str(file.name), file.content)
        self._uploads = (*self._uploads, label)
        return label

    def labels(self) -> tuple[str, ...]:
        """Return the names of the scans that can be chosen; a file that is gone stays on a page that has it open."""
        labels, label = self._library.labels(self._uploads), self._keeper.label
        return labels if label in labels else (*labels, label)

    def path_of(self, label: str) -> Path:
        """Return the file that a name in the list stands for.

        Raises
        ------
        ConfigError
            No scan has that name.
        """
        return self._library.path(label, self._uploads)

    def label_of(self, second: SecondScan) -> str | None:
        """Return the scan of the list that was chosen as a second one: that file, or one of its name; None for none.

        Only what the server was started with, and uploads, can be opened: a project names its second scan by a path.
        """
        paths = {label: self.path_of(label) for label in self._library.labels(self._uploads)}
        same = [label for label, path in paths.items() if str(path.absolute()) == second.file]
        # Two scans of one stair often have one name, each in a folder of its own: it is not the one that is open.
        named = (label for label, path in paths.items() if path.name == second.name and label != self._keeper.label)
        return next(iter(same or named), None)

    def settings_of(self, label: str, params: Params) -> Params:
        """Return the settings of the scan that is open for another one, which keeps what was said of it by itself."""
        with self._keeper.lock:
            bench = self._keeper.bench(label)
            if bench is not None:
                return settings_beside(params, bench.history.value.params)
        return settings_beside(params, dataclasses.replace(self._started.params, overrules=OverrulesParams()))

    def changed_at(self, label: str) -> float | None:
        """Return when a scan's file was changed last, seconds since 1970; None where that cannot be told."""
        try:
            return self._library.path(label, self._uploads).stat().st_mtime
        except (ConfigError, OSError):
            return None

    def is_of(self, label: str, sha256: str) -> bool:
        """Return whether the work on a scan was done on these bytes; what was done on others is put aside."""
        keeper = self._keeper
        with keeper.lock:
            bench = keeper.bench(label)
            if bench is None or bench.sha256 in ("", sha256):
                keeper.know_scan(label, sha256)
                return True
            before, left, is_saved = bench.history.value, bench.path, bench.is_from_file
            path, project, _ = self._library.claim_project(bench.scan, sha256) if left else (None, None, "")
            if project is not None:
                after = work_of(project)
            elif is_saved:
                after = self._started
            else:
                # Settings go on; what is a place of the other cloud does not.
                params = dataclasses.replace(before.params, overrules=OverrulesParams())
                after = dataclasses.replace(before, params=params, measurements=(), views=())
            is_new = project is None and not is_saved
            keeper.put_aside(label, after, path, "begun anew: the file has changed", is_changed=is_new)
            keeper.know_scan(label, sha256)
            if label == keeper.label:
                self._controls.load(after.params)
        place = left.name if left is not None else "the work"
        if is_saved:
            words = f"{place} was made on another state of this file; it is left as it is, and " + (
                f"the work in {path.name} is back" if project is not None and path else "this work begins anew"
            )
            self._notices.tell("Saved work not taken up", words)
        else:
            words = f"{label} has changed and was read again. Overrules, measurements and views were places of the "
            words += "cloud before it and are put aside; undo brings them back"
            self._notices.tell("File changed", words)
        return after == before

    def _open(self, label: str, otherwise: Work) -> None:
        """Begin the work on a scan: what was saved of it, or else fresh work."""
        scan = self._library.path(label, self._uploads)
        is_view_only = self._keeper.is_view_only
        path, project, words = self._library.claim_project(scan, only_reads=is_view_only)
        work = otherwise
        if project is not None and path is not None:
            work = work_of(project)
            words = f"{path.name}, as it was last saved; load the page again for what is saved from now on"
        if project is not None and path is not None and not is_view_only:
            words = (
                f"{path.name}: settings, overrules, measurements and views as they were left. "
                "Shift+R, or Reset to preset under Tune, takes the settings that the server was started with"
            )
        if words:
            title = "Saving" if project is None else "The saved work" if is_view_only else "Your work is back"
            self._notices.tell(title, words)
        path = None if is_view_only else path
        self._keeper.begin(label, scan, work, path, project.scan_sha256 if project is not None else "")
        self._controls.load(work.params)

    def _recall(self) -> tuple[Wish | None, str | None]:
        """Return what a page of this browser that has gone was at, or else the name of the scan it had last."""
        try:
            if self._keeper.is_view_only:
                # What the other pages of this browser were at stays theirs.
                return None, self._read_storage(_VIEWED_KEY)
            known = self._read_storage(_BROWSER_KEY) or uuid.uuid4().hex
            self._client.local_storage.set_item(_BROWSER_KEY, known)
            wish = self._kept.take_up(known)
            # What another page of the browser has open is no reason to open it twice.
            is_first = wish is None and not self._kept.has_open(known)
            last = self._read_storage(_SCAN_KEY) if is_first else None
        except (TimeoutError, RuntimeError):
            return None, None
        self._browser_id = known
        return wish, last

    def _is_answering(self) -> bool:
        try:
            self._client.local_storage.get_item(_BROWSER_KEY, timeout=_ANSWER_S)
        except (TimeoutError, RuntimeError):
            return False
        return True

    def _read_storage(self, key: str) -> str | None:
        """Return what the browser keeps under a key, None for nothing and for nonsense.

        Raises
        ------
        TimeoutError, RuntimeError
            The browser does not answer, has gone, or keeps its storage closed.
        """
        known = self._client.local_storage.get_item(key, timeout=_STORAGE_S)
        return known if known and len(known) <= _LONGEST_STORED else None
