"""Undo and redo: a line of values, each with the words for what led to it. Values must be immutable."""

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")

_LIMIT = 200


@dataclass(frozen=True, slots=True)
class Change(Generic[T]):
    """A value and what led to it, as shown beside "Undo": ``label`` is "eps_z 20 mm to 25 mm"."""

    value: T
    label: str
    merge_key: str


class History(Generic[T]):
    """A line of values with a place in it.

    Not locked: a caller with several threads holds its own lock around each call.

    Examples
    --------
    >>> history = History("a")
    >>> history.push("b", "to b")
    >>> history.undo_label, history.undo(), history.redo_label, history.redo()
    ('to b', 'a', 'to b', 'b')
    """

    def __init__(self, start: T, limit: int = _LIMIT) -> None:
        """Begin at a value.

        Parameters
        ----------
        start : T
            What undo comes back to at last.
        limit : int
            Most changes that can be undone; the oldest are forgotten.
        """
        self._limit = max(1, limit)
        self._changes = [Change(start, "", "")]
        self._at = 0

    @property
    def value(self) -> T:
        """The value at this place."""
        return self._changes[self._at].value

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier value."""
        return self._at > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was undone and nothing changed since."""
        return self._at + 1 < len(self._changes)

    @property
    def undo_label(self) -> str:
        """What :meth:`undo` takes back, empty for nothing."""
        return self._changes[self._at].label if self.can_undo else ""

    @property
    def redo_label(self) -> str:
        """What :meth:`redo` does again, empty for nothing."""
        return self._changes[self._at + 1].label if self.can_redo else ""

    def push(self, value: T, label: str, merge_key: str = "") -> None:
        """Go on to a new value; what had been undone is forgotten.

        Parameters
        ----------
        value : T
            One that equals the present value is no change and is not kept.
        label : str
            Words for the change.
        merge_key : str
            Changes that follow each other with the same key, such as the events of one drag of a slider, are undone
            together; empty for a change of its own. :meth:`settle` ends such a row.
        """
        if value == self.value:
            return
        here = self._changes[self._at]
        is_drag = merge_key != "" and merge_key == here.merge_key and self.can_undo
        kept = self._changes[: self._at if is_drag else self._at + 1]
        # A drag that ends where it began has changed nothing.
        is_back = is_drag and value == kept[-1].value
        self._changes = (kept if is_back else [*kept, Change(value, label, merge_key)])[-self._limit - 1 :]
        self._at = len(self._changes) - 1

    def copy(self) -> "History[T]":
        """Return the same line of values, which goes on by itself from here."""
        other = History(self._changes[0].value, self._limit)
        other._changes, other._at = list(self._changes), self._at
        return other

    def settle(self) -> None:
        """End a drag: the next change is undone by itself, even with the same key."""
        here = self._changes[self._at]
        self._changes[self._at] = Change(here.value, here.label, "")

    def undo(self) -> T:
        """Go back by one change and return the value there; the same value where there is none."""
        self._at = max(0, self._at - 1)
        self.settle()
        return self.value

    def redo(self) -> T:
        """Go forward by one change and return the value there; the same value where there is none."""
        self._at = min(len(self._changes) - 1, self._at + 1)
        self.settle()
        return self.value
