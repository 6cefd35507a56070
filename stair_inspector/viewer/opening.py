"""Opening scans on one page: from the folder, from an upload, with the work that was saved, and after a reload."""

import dataclasses
import uuid
from typing import Any

import viser

from stair_inspector.params import OverrulesParams, Params
from stair_inspector.viewer.library import Library
from stair_inspector.viewer.notices import Notices
from stair_inspector.viewer.panel import Panel
from stair_inspector.viewer.work import Keeper, KeptWishes, Wish, Work, work_of

_STORAGE_KEY = "stair_inspector.browser"


class Opening:
    """Which scan is open, and the work that it begins with. Callers hold the keeper's lock where they change both."""

    def __init__(
        self,
        client: viser.ClientHandle,
        library: Library,
        keeper: Keeper,
        panel: Panel,
        notices: Notices,
        started: Params,
        kept: KeptWishes,
    ) -> None:
        self._client = client
        self._library = library
        self._keeper = keeper
        self._panel = panel
        self._notices = notices
        self._started = started
        self._kept = kept
        self._browser_id: str | None = None
        self._uploads: tuple[str, ...] = ()
        self._expected_sha: dict[str, str] = {}

    def restore(self) -> None:
        """Take up what a page of this browser, now closed, was at; or open the first scan."""
        wish = self._kept_wish()
        if wish is not None and self._library.is_known(wish.label):
            self._uploads = wish.uploads
            path, _, _ = self._library.claim_project(wish.label, wish.project)
            self._keeper.begin(wish.label, wish.work, path, is_changed=True)
            self._panel.controls.load(wish.work.params)
        else:
            self._open(self._library.labels()[0], Work(self._started))
        self.show()

    def leave(self) -> None:
        """Keep the work for the page that this browser opens next."""
        if self._browser_id is not None:
            keeper = self._keeper
            self._kept.leave(self._browser_id, Wish(keeper.label, keeper.work, self._uploads, keeper.path))

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
        self._library.path(label)
        if keeper.has(label):
            self._panel.controls.load(keeper.turn_to(label).params)
        else:
            # Overrules are places of the scan that is left.
            self._open(label, Work(dataclasses.replace(keeper.work.params, overrules=OverrulesParams())))
        return True

    def look_for_scans(self) -> None:
        """Look into the folders again."""
        before = self._library.labels(self._uploads)
        self._library.refresh()
        self.show()
        now = self._library.labels(self._uploads)
        self._notices.tell("Scans", f"{len(set(now) - set(before))} new, {len(now)} in the menu")

    def keep_upload(self, file: Any) -> str:
        """Keep an uploaded scan and return its name in the menu."""
        label = self._library.add_upload(str(file.name), file.content)
        self._uploads = (*self._uploads, label)
        return label

    def show(self) -> None:
        """List the scans and show which is open."""
        self._panel.scan.offer(self._library.labels(self._uploads), self._keeper.label)

    def is_of(self, label: str, sha256: str) -> bool:
        """Return whether the work that was taken up is that of these bytes; if not, begin anew and leave it alone."""
        keeper = self._keeper
        with keeper.lock:
            expected = self._expected_sha.pop(label, None)
            if expected is None or expected == sha256 or keeper.label != label:
                return True
            path = keeper.path
            other = self._library.next_project(label, path) if path is not None else None
            keeper.begin(label, Work(self._started), other)
            self._panel.controls.load(self._started)
        name = path.name if path is not None else "the project"
        self._notices.tell(
            "Saved work not taken up",
            f"{name} was made on another state of this file; it is left as it is, and this work begins anew",
        )
        return False

    def _open(self, label: str, otherwise: Work) -> None:
        """Begin the work on a scan: what was saved of it, or else fresh work."""
        path, project, words = self._library.claim_project(label)
        work = otherwise
        if project is not None and path is not None:
            work = work_of(project)
            self._expected_sha[label] = project.scan_sha256
            words = (
                f"{path.name}: settings, overrules, measurements and views as they were left. "
                "Shift+R, or Reset to preset under Tune, takes the settings that the server was started with"
            )
        if words:
            self._notices.tell("Your work is back" if project is not None else "Saving", words)
        self._keeper.begin(label, work, path)
        self._panel.controls.load(work.params)

    def _kept_wish(self) -> Wish | None:
        storage = self._client.local_storage
        try:
            known = storage.get_item(_STORAGE_KEY, timeout=5.0)
        except (TimeoutError, RuntimeError):
            return None
        self._browser_id = known if known and len(known) <= 64 else uuid.uuid4().hex
        storage.set_item(_STORAGE_KEY, self._browser_id)
        return self._kept.take_up(self._browser_id)
