"""The results on the page and what is chosen among them: tables, card, rejected surfaces, histogram and notes."""

from collections.abc import Callable, Mapping

from stair_inspector.errors import ConfigError
from stair_inspector.model import Step
from stair_inspector.pictures.coloring import rejected_of
from stair_inspector.pictures.display import REJECTED_COLOR
from stair_inspector.pictures.frames import step_of
from stair_inspector.pictures.segmentation import MOST_REJECTED, SURFACE, ground_of, lift_of, points_of
from stair_inspector.units import read_unit
from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.bridge.markup import FLIGHT
from stair_inspector.viewer.parts.desk import Desk, Shown
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.parts.steps import html
from stair_inspector.viewer.parts.steps.examination_html import examination_html, headline_html
from stair_inspector.viewer.parts.steps.step_pictures import card_pictures
from stair_inspector.viewer.parts.steps.survey_html import card_html, rejected_html
from stair_inspector.viewer.parts.steps.tab import NO_STEP
from stair_inspector.viewer.parts.tune import histogram
from stair_inspector.viewer.scene.dimensions import dimensions_of
from stair_inspector.viewer.scene.stage import HIGHLIGHT
from stair_inspector.viewer.scene.step_marks import StepMark


class Results:
    """Table, scene and card show one selection, wherever it was made.

    ``marks`` are those of the steps that are outside a limit; ``on_shown`` is called when a selection has been shown,
    and ``on_selected`` when another one was made.
    """

    def __init__(self, desk: Desk, panel: Panel) -> None:
        self._desk = desk
        self._panel = panel
        # None shows the survey's columns where there are any.
        self._columns: html.Columns | None = None
        self._folded: set[int] = set()
        self.with_rejected = False
        self.marks: Mapping[int, StepMark] = {}
        self.on_shown: Callable[[], None] = _nothing
        self.on_selected: Callable[[], None] = _nothing

    # What a person does.

    def choose(self, option: str) -> None:
        """Choose what the menu names."""
        self.select(*_read_choice(option))

    def pick(self, message: str) -> None:
        """Do what a click on a row asks for: choose its step or surface, or fold its flight."""
        words = str(message).partition(":")[0]
        if words.split(" ")[0] == FLIGHT:
            self._fold(words)
            return
        chosen = _read_choice(words)
        # A second click on the same row puts the selection away.
        desk = self._desk
        self.select(*((None, None) if chosen == (desk.selected, desk.selected_patch) else chosen))

    def select(self, step_id: int | None, patch_id: int | None = None) -> None:
        """Choose a step or a rejected surface, or nothing.

        Raises
        ------
        ConfigError
            There is no such step or surface.
        """
        desk = self._desk
        with desk.lock:
            inspection = desk.inspection
            if inspection is None:
                return
            if step_id is not None and step_of(inspection, step_id) is None:
                raise ConfigError(f"step {step_id} does not exist; there are {len(inspection.steps)}")
            if patch_id is not None and patch_id not in {patch.patch_id for patch in rejected_of(inspection)}:
                raise ConfigError(f"{SURFACE} {patch_id} is none of the rejected ones")
            desk.selected, desk.selected_patch = step_id, patch_id
            with desk.client.atomic():
                self.show_selection()
        self.on_selected()

    def move(self, by: int) -> None:
        """Choose the next step upwards (1) or downwards (-1); the first or the last where none is chosen."""
        desk = self._desk
        with desk.lock:
            numbers = [step.step_id for step in desk.inspection.steps] if desk.inspection is not None else []
            if not numbers:
                return
            if desk.selected not in numbers:
                chosen = numbers[0 if by > 0 else -1]
            else:
                chosen = numbers[min(max(numbers.index(desk.selected) + by, 0), len(numbers) - 1)]
            self.select(chosen)

    def set_columns(self, option: str) -> None:
        """Show the survey's or the paper's columns."""
        columns = next((columns for columns in html.COLUMNS if columns == str(option).lower()), None)
        if columns is None:
            raise ConfigError(f"table: got {str(option)[:40]!r}; give one of {', '.join(html.COLUMNS)}")
        with self._desk.lock, self._desk.client.atomic():
            self._columns = columns
            self.show_selection()

    def set_unit(self, option: str) -> None:
        """Write lengths in millimetres or in inches."""
        unit = read_unit(option)
        with self._desk.lock, self._desk.client.atomic():
            self._desk.unit = unit
            self._panel.unit.show(unit)
            self.show_selection()

    # What the page shows. All callers hold the lock.

    def renew(self) -> None:
        """Drop what a new result no longer has."""
        if step_of(self._desk.inspection, self._desk.selected) is None:
            self._desk.selected = None
        # Surfaces are numbered anew by every run.
        self._desk.selected_patch = None

    def show_histogram(self) -> None:
        """Show the heights with the clusters' bands."""
        self._panel.tune.histogram.content = histogram.histogram_html(
            self._desk.inspection, self._desk.palette, uuid_of(self._panel.picked)
        )

    def show_details(self) -> None:
        """Show what was found about the scan, the notes, the settings that were used and the times."""
        inspection, uuid = self._desk.marked, uuid_of(self._panel.picked)
        self._panel.examination.content = headline_html(inspection, uuid)
        self._panel.scan.examination.content = examination_html(inspection, uuid)
        self._panel.details.content = html.details_html(inspection)
        self._panel.scan.up_used.content = html.up_html(inspection.up) if inspection is not None else ""

    def show_pictures(self) -> None:
        """Show the map of the chosen step's residuals and its section, which are made from all points of the scan."""
        desk, shown = self._desk, self._desk.shown
        if shown is None:
            return
        inspection = shown.inspection
        has_values = bool(inspection.flights) and not inspection.is_withheld
        step = step_of(inspection, desk.selected) if has_values else None
        self._panel.steps.pictures.content = card_pictures(shown.scan, inspection, step, desk.palette, desk.unit)

    def show_selection(self, *, with_pictures: bool = True) -> None:
        """Show the tables and everything about the chosen step or surface; its pictures may follow later."""
        desk, panel = self._desk, self._panel
        shown = desk.shown
        if shown is None:
            return
        inspection = shown.inspection
        step = step_of(inspection, desk.selected)
        uuid = uuid_of(panel.picked)
        columns = html.columns_of(inspection, self._columns)
        is_survey = inspection.params.method == "survey"
        panel.show_survey_controls(is_survey)
        panel.show_table(
            html.table_html(
                desk.marked,
                desk.palette,
                desk.selected,
                uuid,
                columns,
                desk.unit,
                folded=frozenset(self._folded),
                marks=self.marks,
            ),
            columns,
            is_survey=is_survey,
        )
        panel.steps.card.content = card_html(desk.marked, desk.selected, desk.palette, desk.unit)
        if with_pictures:
            self.show_pictures()
        panel.steps.rejected.content = rejected_html(
            inspection, REJECTED_COLOR, desk.selected_patch, uuid, is_shown=self.with_rejected and is_survey
        )
        rejected = rejected_of(inspection)[:MOST_REJECTED] if self.with_rejected else []
        chosen = NO_STEP if desk.selected is None else str(desk.selected)
        panel.steps.offer_steps(
            (step.step_id for step in inspection.steps),
            (patch.patch_id for patch in rejected),
            chosen if desk.selected_patch is None else f"{SURFACE} {desk.selected_patch}",
        )
        self._show_chosen(shown, step)
        self.on_shown()

    def put_away(self) -> None:
        """Show nothing of the results of a scan that is no longer open."""
        desk, steps = self._desk, self._panel.steps
        self._folded.clear()
        self.show_details()
        steps.offer_steps((), (), NO_STEP)
        steps.card.content = card_html(None, None, desk.palette, desk.unit)
        steps.pictures.content = steps.rejected.content = ""

    def chosen_place(self) -> tuple[float, float, float]:
        """Return the centroid of the chosen step's or surface's patch, metres in the scan frame.

        Raises
        ------
        ConfigError
            Nothing is chosen, or the paper's method was used, which takes no decisions.
        """
        desk = self._desk
        inspection = desk.inspection
        step = step_of(inspection, desk.selected)
        if inspection is None or (step is None and desk.selected_patch is None):
            raise ConfigError("mark as: choose a step or a rejected surface first")
        if inspection.params.method == "paper":
            raise ConfigError("mark as: the paper's method takes no decisions; set the method to survey")
        own = [
            patch
            for patch in inspection.patches
            if patch.patch_id == desk.selected_patch or (step is not None and patch.step_id == step.step_id)
        ]
        plane = max(own, key=lambda patch: patch.area_m2).plane if own else None
        if plane is None and step is not None:
            plane = step.plane
        if plane is None:
            raise ConfigError("mark as: the chosen surface is no longer there")
        x, y, z = (
            float(coordinate) + float(origin)
            for coordinate, origin in zip(plane.centroid, inspection.scan.origin_m, strict=True)
        )
        return (x, y, z)

    def _fold(self, words: str) -> None:
        flight_id = _number(words)
        with self._desk.lock, self._desk.client.atomic():
            self._folded ^= {flight_id}
            self.show_selection()

    def _show_chosen(self, shown: Shown, step: Step | None) -> None:
        """Draw the chosen step with its dimensions, or the chosen surface, or nothing, over the segmentation."""
        desk, inspection = self._desk, shown.inspection
        corners, dimensions = None, None
        if step is not None:
            # The chosen step's points are drawn larger, and the lines over them must lie higher.
            lift_m = 2.0 * lift_of(shown.display.spacing_m, step.plane.rms_m)
            corners = step.corners + lift_m * inspection.up.vector
            dimensions = dimensions_of(inspection, step, lift_m, desk.unit)
        has_lines = dimensions is not None and len(dimensions.arrows) + len(dimensions.measuring) > 0
        desk.stage.highlight(
            points_of(inspection, shown.display, desk.selected, desk.selected_patch),
            corners,
            ground_of(desk.palette) if has_lines else HIGHLIGHT,
        )
        desk.stage.show_dimensions(desk.selected, dimensions, desk.palette)


def _nothing() -> None:
    """Do nothing."""


def _read_choice(value: object) -> tuple[int | None, int | None]:
    """Return the step or the surface that an option of the menu or a row names; neither for none."""
    words = str(value).split(" ")
    if words == [NO_STEP]:
        return None, None
    number = _number(value)
    return (None, number) if words[0] == SURFACE else (number, None)


def _number(value: object) -> int:
    try:
        return int(str(value).split(" ")[-1])
    except ValueError as error:
        raise ConfigError(f"step: got {str(value)[:40]!r}; give a number") from error
