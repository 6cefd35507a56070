"""The inspector's word against the program's: what a surface is, why, and how that is taken back."""

import dataclasses

from stair_inspector.errors import ConfigError
from stair_inspector.overrules import OverrulesParams
from stair_inspector.viewer.bridge.controls import VERDICTS
from stair_inspector.viewer.bridge.markup import read_order
from stair_inspector.viewer.parts.desk import Desk, Editor
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.parts.steps.examination_html import CURE, offered_cures
from stair_inspector.viewer.parts.steps.results import Results
from stair_inspector.viewer.parts.steps.tab import TAKE_BACK
from stair_inspector.viewer.state.work import Keeper


class Deciding:
    """The form "Overrules" of the Steps tab, and the answers to what was asked about the scan."""

    def __init__(self, desk: Desk, panel: Panel, results: Results, keeper: Keeper, editor: Editor) -> None:
        self._desk = desk
        self._panel = panel
        self._results = results
        self._keeper = keeper
        self._editor = editor

    def mark(self, option: str) -> None:
        """Decide what the chosen step or surface is, with the reason that is written; or take that back."""
        kind = next((kind for kind in VERDICTS if kind == option), None)
        if kind is None and option != TAKE_BACK:
            raise ConfigError(f"mark as: got {str(option)[:40]!r}; give one of {', '.join((*VERDICTS, TAKE_BACK))}")
        reason, controls = self._panel.steps.reason, self._panel.controls
        # The desk is kept all the while: the place belongs to the scan that is shown.
        with self._desk.lock:
            place_m = self._results.chosen_place()
            with self._keeper.lock:
                before = self._editor.work.params.overrules.force
                controls.overrule(place_m, kind, str(reason.value))
                if kind is None and controls.read().overrules.force == before:
                    raise ConfigError(
                        "mark as: there is no verdict at this very place; undo it, or edit the text below"
                    )
            # Its number may be another one's when the result is there.
            self._desk.selected = self._desk.selected_patch = None
            reason.value = ""
            self._editor.submit()

    def take_cure(self, message: str) -> None:
        """Take the settings that a button of the examination offers: they answer a question, or mend a doubt."""
        with self._desk.lock:
            offered = offered_cures(self._desk.inspection)
            cure = offered[read_order(message, (CURE,)).index_in(offered, "examination")]
        self._editor.adjust(cure.applied, cure.words)

    def submit_texts(self) -> None:
        """Let the overrules that are written count."""
        self._panel.controls.submit_texts()
        self._editor.submit()

    def clear(self) -> None:
        """Empty the overrules, and the region with them."""
        self._editor.adjust(
            lambda params: dataclasses.replace(params, overrules=OverrulesParams()), "cleared overrules"
        )
