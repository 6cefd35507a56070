"""What pages that have gone were last at, by browser: a reload or a dropped connection makes a browser a new client."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from stair_inspector.viewer.state.work import Bench

_KEPT_PER_BROWSER = 10


_KEPT_BROWSERS = 100


_LEAVING_S = 10.0
"""Longest wait for a page that is being closed to have saved its work."""


@dataclass(frozen=True, slots=True)
class Wish:
    """What a page was last at: a scan by its name in the list, the work on all that it had open, and its uploads."""

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
