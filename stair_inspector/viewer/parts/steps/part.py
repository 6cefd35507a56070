"""The Steps tab: the chosen step's card, the inspector's verdicts, and the surfaces that were rejected."""

import viser

from stair_inspector.model import Step
from stair_inspector.pictures.coloring import rejected_of
from stair_inspector.pictures.frames import step_of
from stair_inspector.pictures.segmentation import MOST_REJECTED, SURFACE, ground_of, lift_of, points_of
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.bridge.widgets import offer
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.steps.card_html import card_html
from stair_inspector.viewer.parts.steps.rejected_html import rejected_html
from stair_inspector.viewer.parts.steps.settling import Settling
from stair_inspector.viewer.parts.steps.step_pictures import card_pictures
from stair_inspector.viewer.parts.steps.verdicts import Verdicts
from stair_inspector.viewer.parts.table import NO_STEP, TABLE_CHANGES, pick_row, read_choice
from stair_inspector.viewer.scene.dimensions import dimensions_of
from stair_inspector.viewer.scene.stage import HIGHLIGHT
from stair_inspector.viewer.state.change import PageChange

_WITH_PICTURES = frozenset(
    {PageChange.SELECTION, PageChange.COLORS, PageChange.CLOUD, PageChange.UNIT, PageChange.THEME}
)
"""Changes after which the pictures on the card are made anew at once; after a result, only when it is at rest."""


class StepsPart(PagePart):
    """Table, scene and card show one selection, wherever it was made."""

    title = "Steps"
    icon = viser.Icon.STAIRS
    depends_on = TABLE_CHANGES | {PageChange.CLOUD, PageChange.REST}

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._look = context.look
        widgets = context.widgets
        self.selected = widgets.dropdown(
            "Selected step",
            (NO_STEP,),
            hint="Highlights the step; so does a click on its row or tread, and the arrow keys.",
            on_change=lambda option: desk.select(*read_choice(option)),
        )
        self.card = widgets.html()
        self.pictures = widgets.html()
        self.verdicts = Verdicts(context)
        self._show_rejected = widgets.checkbox(
            "Show rejected surfaces",
            hint="Colours the surfaces that are no part of the staircase and lists them with the reason.",
            is_visible=False,
            on_change=self.set_rejected,
        )
        self.rejected = widgets.html()
        self._picked = widgets.orders("Picked surface", lambda message: pick_row(desk, message))
        self.settling = Settling(context)

    def show(self, what: frozenset[PageChange]) -> None:
        """Show everything about the chosen step or surface."""
        if what == {PageChange.REST}:
            self.show_pictures()
            return
        if PageChange.RESULT in what:
            self.settling.renew()
        shown = self._desk.shown
        if shown is None:
            self._show_nothing()
            return
        self._show_chosen(shown)
        if what & _WITH_PICTURES:
            self.show_pictures()

    def put_away(self) -> bool:
        """Choose nothing."""
        self._desk.select(None)
        return False

    def close(self) -> None:
        """End the threads."""
        self.settling.close()

    def commands(self) -> tuple[Command, ...]:
        """Return how steps are chosen by keys."""
        return (
            Command("Next step up", lambda: self._desk.move(1), "arrowup"),
            Command("Next step down", lambda: self._desk.move(-1), "arrowdown"),
        )

    def set_rejected(self, is_shown: bool) -> None:
        """Show or hide the rejected surfaces."""
        desk = self._desk
        with desk.lock:
            desk.with_rejected = bool(is_shown)
            if not is_shown:
                desk.selected_patch = None
            desk.changed(PageChange.COLORS)

    def show_pictures(self) -> None:
        """Show the map of the chosen step's residuals and its section, which are made from all points of the scan."""
        desk, shown = self._desk, self._desk.shown
        if shown is None:
            return
        inspection = shown.inspection
        has_values = bool(inspection.flights) and not inspection.is_withheld
        step = step_of(inspection, desk.selected) if has_values else None
        self.pictures.content = card_pictures(shown.scan, inspection, step, desk.palette, desk.unit)

    def _show_nothing(self) -> None:
        """Show nothing of the results of a scan that is no longer open."""
        offer(self.selected, (NO_STEP,))
        self.card.content = card_html(None, None, self._desk.palette, self._desk.unit)
        self.pictures.content = self.rejected.content = ""

    def _show_chosen(self, shown: Shown) -> None:
        desk, inspection = self._desk, shown.inspection
        is_survey = inspection.params.method == "survey"
        self._show_rejected.visible = is_survey
        self.card.content = card_html(desk.marked, desk.selected, desk.palette, desk.unit)
        self.rejected.content = rejected_html(
            inspection,
            desk.palette.rejected,
            desk.selected_patch,
            self._picked,
            is_shown=desk.with_rejected and is_survey,
        )
        steps = (str(step.step_id) for step in inspection.steps)
        rejected = rejected_of(inspection)[:MOST_REJECTED] if desk.with_rejected else []
        chosen = NO_STEP if desk.selected is None else str(desk.selected)
        offer(
            self.selected,
            (NO_STEP, *steps, *(f"{SURFACE} {patch.patch_id}" for patch in rejected)),
            chosen if desk.selected_patch is None else f"{SURFACE} {desk.selected_patch}",
        )
        self._draw(shown, step_of(inspection, desk.selected))

    def _draw(self, shown: Shown, step: Step | None) -> None:
        """Draw the chosen step with its dimensions, or the chosen surface, or nothing, over the segmentation."""
        desk, inspection = self._desk, shown.inspection
        corners, dimensions = None, None
        if step is not None:
            # The chosen step's points are drawn larger, and the lines over them must lie higher.
            lift_m = 2.0 * lift_of(shown.display.spacing_m, step.plane.rms_m)
            corners = step.corners + lift_m * inspection.up.vector
            dimensions = dimensions_of(inspection, step, lift_m, desk.unit)
        points = points_of(inspection, shown.display, desk.selected, desk.selected_patch)
        if self._look.color_mode == "Change":
            # The colours of the chosen tread are what one looks for; its outline tells it.
            points = points[:0]
        has_lines = dimensions is not None and len(dimensions.arrows) + len(dimensions.measuring) > 0
        desk.stage.highlight(
            points,
            corners,
            ground_of(desk.palette) if has_lines else HIGHLIGHT,
        )
        desk.stage.show_dimensions(desk.selected, dimensions, desk.palette)
