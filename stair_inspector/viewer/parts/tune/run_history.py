"""The last results of a page, by their settings: each can be compared with any other, kept by hand or not."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from stair_inspector.model import Inspection
from stair_inspector.params import Params
from stair_inspector.viewer.bridge.controls import words_of_change

MOST_RUNS = 12
"""Results of one scan that are remembered."""
_MOST_IN_ALL = 60
_DRAG_S = 1.5
"""Results of one setting that follow each other faster are one drag of a slider: the last of them is kept."""


@dataclass(frozen=True, slots=True)
class PastRun:
    """A result that was shown: its number on this page, what was changed for it, its settings, and its steps."""

    number: int
    words: str
    params: Params
    n_steps: int

    @property
    def title(self) -> str:
        """What menus call it: ``#3 ε_z 20 mm to 21 mm, 15 steps``."""
        return f"#{self.number} {self.words}, {self.n_steps} step{'' if self.n_steps == 1 else 's'}"


@dataclass(slots=True)
class _Entry:
    run: PastRun
    sha256: str
    names: str
    before: Params | None
    told_at: float


class RunHistory:
    """The settings of the last results, not the results: those hold a number for each point of the scan.

    Parameters
    ----------
    clock : callable
        Returns seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._entries: list[_Entry] = []
        self._last: dict[str, Params] = {}
        self._n_told = 0

    def record(self, inspection: Inspection) -> None:
        """Remember a result; one with settings that are remembered already, as after an undo, changes nothing."""
        sha256, params, now = inspection.scan.sha256, inspection.params, self._clock()
        before = self._last.get(sha256)
        self._last[sha256] = params
        own = [entry for entry in self._entries if entry.sha256 == sha256]
        if any(entry.run.params == params for entry in own):
            return
        words, names = ("first result", "") if before is None else words_of_change(before, params)
        last = own[-1] if own else None
        if last is not None and last.names and last.names == names and now - last.told_at < _DRAG_S:
            before = last.before
            words = words_of_change(before, params)[0] if before is not None else words
            number = last.run.number
            self._entries.remove(last)
        else:
            self._n_told += 1
            number = self._n_told
        run = PastRun(number, words, params, len(inspection.steps))
        self._entries.append(_Entry(run, sha256, names, before, now))
        self._drop_oldest(sha256)

    def of(self, sha256: str) -> tuple[PastRun, ...]:
        """Return what is remembered of a scan, the newest first."""
        return tuple(entry.run for entry in reversed(self._entries) if entry.sha256 == sha256)

    def forget(self, number: int) -> None:
        """Forget a result."""
        self._entries = [entry for entry in self._entries if entry.run.number != number]

    def _drop_oldest(self, sha256: str) -> None:
        own = [entry for entry in self._entries if entry.sha256 == sha256]
        dropped = [*own[:-MOST_RUNS], *self._entries[:-_MOST_IN_ALL]]
        self._entries = [entry for entry in self._entries if not any(entry is each for each in dropped)]
