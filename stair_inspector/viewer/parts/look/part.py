"""The Look tab: from where and how the scene is seen, sections through it, and what is measured in it by hand."""

from functools import partial

import viser

from stair_inspector.pictures.cameras import VIEWS
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.parts.look.measure import MeasureTool
from stair_inspector.viewer.parts.look.section import SectionTool
from stair_inspector.viewer.parts.look.views import ViewTool
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.scene.stage import MODES
from stair_inspector.viewer.state.change import PageChange

_DRAWN_ANEW = frozenset({PageChange.SCAN, PageChange.CLOUD, PageChange.COLORS, PageChange.THEME, PageChange.UNIT})
_VIEW_WORDS = {**{view: f"{view} view" for view in VIEWS}, "Along": "View along the stair"}
_MODE_WORDS = dict(
    zip(
        MODES, ("Raw cloud", "Coloured steps", "Raw and steps side by side", "Swipe between raw and steps"), strict=True
    )
)


class LookPart(PagePart):
    """Three tools for looking and measuring."""

    title = "Look"
    icon = viser.Icon.EYE
    depends_on = _DRAWN_ANEW | {PageChange.WORK, PageChange.RESULT, PageChange.SELECTION, PageChange.MODE}

    def __init__(self, context: Context) -> None:
        self._look = context.look
        widgets = context.widgets
        self.views = ViewTool(context)
        with widgets.folder("Section"):
            self.section = SectionTool(context)
        with widgets.folder("Measure"):
            self.measure = MeasureTool(context, lambda: self.section.display)

    def show(self, what: frozenset[PageChange]) -> None:
        """Show what belongs to the present work and result."""
        if what & (_DRAWN_ANEW | {PageChange.WORK, PageChange.MODE}):
            self.views.show()
        if what & (_DRAWN_ANEW | {PageChange.RESULT}):
            self.section.show()
        elif PageChange.SELECTION in what:
            self.section.follow()
        if what & (_DRAWN_ANEW | {PageChange.WORK}):
            self.measure.show()

    def put_away(self) -> bool:
        """Close the large section, or else forget a point that waits for its second."""
        return self.section.put_card_away() or self.measure.step_back()

    def close(self) -> None:
        """End the threads."""
        self.section.close()

    def commands(self) -> tuple[Command, ...]:
        """Return the keys for looking and measuring."""
        views, look = self.views, self._look
        return (
            Command("Look at the chosen step", look.look_at_step, "F"),
            *(
                Command(_VIEW_WORDS[view], partial(look.set_view, view), str(key))
                for key, view in enumerate(VIEWS, start=1)
            ),
            Command("Orthographic look", views.switch_ortho, "O"),
            *(
                Command(words, partial(look.choose_mode, mode), str(key % 10))
                for key, (mode, words) in enumerate(_MODE_WORDS.items(), start=7)
            ),
            Command("Section on or off", self.section.switch, "X"),
            Command("Measure: off, point, distance", self.measure.next_mode, "M"),
            Command("Keep this view", views.keep, "V"),
        )
