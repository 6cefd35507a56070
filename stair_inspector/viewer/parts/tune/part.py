"""The Tune tab: presets, undo, the settings' sliders, the height histogram, and what to compare with."""

import viser

from stair_inspector.errors import ConfigError
from stair_inspector.params import SETTINGS
from stair_inspector.viewer.bridge.markup import DIM, aside, text
from stair_inspector.viewer.bridge.reach_drag import REACH
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.step_columns import shown_values
from stair_inspector.viewer.parts.tune.histogram import histogram_html
from stair_inspector.viewer.parts.tune.paper_edges import PAPER_ONLY, PaperEdges
from stair_inspector.viewer.parts.tune.presets import Presets
from stair_inspector.viewer.parts.tune.runs import RunComparison
from stair_inspector.viewer.parts.tune.sweeping import SweepTool
from stair_inspector.viewer.state.change import PageChange

_UNDO, _REDO = "Undo", "Redo"


class TunePart(PagePart):
    """Sets what a result is made with, and shows at once what that does."""

    title = "Tune"
    icon = viser.Icon.ADJUSTMENTS_HORIZONTAL
    depends_on = frozenset(
        {PageChange.WORK, PageChange.HISTORY, PageChange.RESULT, PageChange.UNIT, PageChange.THEME, PageChange.TABLE}
    )

    def __init__(self, context: Context) -> None:
        self._context = context
        self._desk = context.desk
        self._editor = context.editor
        widgets, controls = context.widgets, context.editor.controls
        self.presets = Presets(context)
        widgets.buttons(
            "Changes",
            (_UNDO, _REDO),
            lambda option: self._editor.redo() if option == _REDO else self._editor.undo(),
            hint="Ctrl+Z, Ctrl+Shift+Z.",
        )
        self.changes = widgets.html()
        controls.add_place("tune")
        self.acts_on = widgets.html()
        self.histogram = widgets.html()
        self._reach = widgets.orders("Reach", self.take_reach)
        controls.add_place("heights")
        with widgets.folder("Survey", is_open=False):
            controls.add_place("survey")
        with widgets.folder("More settings", is_open=False):
            controls.add_by_stage("more")
        self.presets.add_suggestion()
        self.comparison = RunComparison(context)
        self.sweeps = SweepTool(context)
        self.presets.add_files()
        self.paper_edges = PaperEdges(context)

    def show(self, what: frozenset[PageChange]) -> None:
        """Show what can be undone, and what the settings do."""
        if what & {PageChange.WORK, PageChange.HISTORY}:
            self.paper_edges.follow(is_slider=PageChange.WORK not in what)
            self._show_history()
        if what & {PageChange.RESULT, PageChange.TABLE}:
            self._show_what_acts()
        if what & {PageChange.RESULT, PageChange.THEME}:
            self.histogram.content = histogram_html(self._desk.inspection, self._desk.palette, self._reach)
        if PageChange.RESULT in what:
            # The result may be there before it is said that a slider was moved for it.
            self.paper_edges.follow(is_slider=True)
            self.paper_edges.draw()
            self.presets.know_heights()
        if what & {PageChange.RESULT, PageChange.WORK, PageChange.UNIT}:
            self.comparison.show()
            self.sweeps.show()

    def commands(self) -> tuple[Command, ...]:
        """Return what keys do with the settings."""
        return (
            Command("Undo", self._editor.undo, "Z", "cmd/ctrl"),
            Command("Redo", self._editor.redo, "Z", "cmd/ctrl+shift"),
            Command("Suggest settings", self.presets.suggest),
            Command("Reset the settings", self._editor.reset, "R", "shift"),
        )

    def cancel(self) -> None:
        """Stop comparisons and the sweep."""
        self.comparison.cancel()
        self.sweeps.cancel()

    def close(self) -> None:
        """End the threads."""
        self.comparison.close()
        self.sweeps.close()
        self.paper_edges.close()

    def take_reach(self, message: str) -> None:
        """Take the reach that a drag over the histogram asks for."""
        word, _, value = str(message).partition(":")[0].partition(" ")
        if word != REACH or not value.isdecimal() or len(value) > 6:
            raise ConfigError(f"ε_z: got {value[:40]!r}; give a whole number of millimetres")
        self._editor.adjust(lambda params: params.replaced("levels.eps_m", int(value) / 1000.0))

    def _show_what_acts(self) -> None:
        """Dim the sliders that change nothing in the table as it is shown, and say so."""
        view = shown_values(self._desk.inspection, self._desk.table.view)
        names, words = {
            "survey": (PAPER_ONLY, "Dimmed: acts on the paper's columns and edges alone."),
            "paper": (SETTINGS.at("survey"), "The sliders under Survey act on the survey's columns alone."),
        }[view]
        self.acts_on.content = aside("acts-on", words, "0 9px 2px") + self._editor.controls.dimmed(names)

    def _show_history(self) -> None:
        history = self._context.keeper.history
        words = [
            f"{word}: {label}" for word, label in (("undo", history.undo_label), ("redo", history.redo_label)) if label
        ]
        self.changes.content = (
            f'<div data-testid="changes" style="font-size:11px;color:{DIM};padding:0 9px 4px;overflow-wrap:anywhere">'
            f"{text(' · '.join(words)) or '&nbsp;'}</div>"
        )
        self.presets.show_preset()
