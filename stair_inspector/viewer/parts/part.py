"""What a part of the page is: it owns its tab's widgets and what they do, and says on which changes it depends.

A new part is a folder with a ``part.py`` in it, and a line in :data:`stair_inspector.viewer.page.PARTS`. Parts never
reach into each other's widgets, nor import each other: what they share is here, beside the folders.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import viser

from stair_inspector.viewer.bridge.shortcuts import Command, HelpCard
from stair_inspector.viewer.bridge.widgets import Widgets
from stair_inspector.viewer.compute.jobs import Making
from stair_inspector.viewer.compute.runs import Runs
from stair_inspector.viewer.compute.workshop import Workshop
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.parts.judge import Judge
from stair_inspector.viewer.parts.scene_look import SceneLook
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.editor import Editor
from stair_inspector.viewer.state.keeper import Keeper
from stair_inspector.viewer.state.opening import Opening


@dataclass(frozen=True, slots=True)
class Context:
    """What the parts of one page share.

    ``cancel`` stops what is computed or made for the page;
    ``commands`` are those of all parts; ``put_away`` puts the selection or the tool in use away.
    """

    widgets: Widgets
    desk: Desk
    look: SceneLook
    judge: Judge
    editor: Editor
    keeper: Keeper
    opening: Opening
    workshop: Workshop
    making: Making
    runs: Runs
    help: HelpCard
    cancel: Callable[[], None]
    commands: Callable[[], tuple[Command, ...]]
    put_away: Callable[[], None]


class PagePart:
    """A part of the page: makes its widgets when it is made, in a tab of its own if it has a title.

    Attributes
    ----------
    title, icon
        Of its tab; without a title it stands above or below the tabs, by its place in the list.
    depends_on : frozenset of PageChange
        The changes after which :meth:`show` is called.
    """

    title: ClassVar[str] = ""
    icon: ClassVar[viser.IconName | None] = None
    depends_on: ClassVar[frozenset[PageChange]] = frozenset()

    def __init__(self, context: Context) -> None:
        """Make the widgets."""

    def show(self, what: frozenset[PageChange]) -> None:
        """Show what has changed; the desk is held, and all that the parts show comes to the page at once."""

    def commands(self) -> tuple[Command, ...]:
        """Return what keys and the palette can do with this part; each is guarded by the page."""
        return ()

    def put_away(self) -> bool:
        """Put a tool or the selection away, as Escape asks; return whether nothing else is to be put away with it."""
        return False

    def cancel(self) -> None:
        """Stop what this part computes by itself."""

    def close(self) -> None:
        """End the part's threads; the page is gone."""
