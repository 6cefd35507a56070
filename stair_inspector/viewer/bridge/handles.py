"""viser's handles of controls, and the identity by which scripts of a page write to them."""

from typing import Protocol


class _State(Protocol):
    @property
    def uuid(self) -> str: ...


class Handle(Protocol):
    """Anything of a page that scripts can write to."""

    @property
    def _impl(self) -> _State: ...


def uuid_of(handle: Handle) -> str:
    """Return the identity of a control; the name is private to viser, hence the exact version it is pinned to."""
    return str(handle._impl.uuid)
