"""The inspector's word against the program's: what a surface is, why, and how that is taken back."""

import dataclasses

import viser

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.model import Inspection
from stair_inspector.overrules import OverrulesParams
from stair_inspector.pictures.frames import step_of
from stair_inspector.viewer.bridge.controls import VERDICTS
from stair_inspector.viewer.parts.part import Context

TAKE_BACK = "as found"
"""The verdict that takes an overrule back."""


class Verdicts:
    """The form "Overrules" of the Steps tab: for the chosen step or surface by a button, for all others as text."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._keeper = context.keeper
        self._editor = context.editor
        widgets, controls = context.widgets, context.editor.controls
        form = widgets.form("Overrules", self.submit_texts)
        with form:
            self.reason = widgets.text("Reason", hint="Why, in one line; it is kept with the verdict.")
            widgets.buttons(
                "Mark as",
                (*VERDICTS, TAKE_BACK),
                self.mark,
                hint="What the chosen step or rejected surface is, whatever the program says. Undo takes it back.",
            )
            for name in ("overrules.force", "overrules.climb"):
                # Enter submits; until then the text may be half a word.
                controls.add_text(name)
            widgets.button("Apply overrules", form.submit, icon=viser.Icon.CHECK, hint="So does Enter in a field.")
            widgets.button(
                "Clear overrules",
                self.clear,
                icon=viser.Icon.ERASER,
                hint="All of them, and the region of interest; can be undone.",
                is_quiet=True,
            )

    def mark(self, option: str) -> None:
        """Decide what the chosen step or surface is, with the reason that is written; or take that back."""
        one_of(option, (*VERDICTS, TAKE_BACK), "mark as")
        kind = next((kind for kind in VERDICTS if kind == option), None)
        desk, controls = self._desk, self._editor.controls
        # The desk is kept all the while: the place belongs to the scan that is shown.
        with desk.lock:
            place_m = place_of(desk.inspection, desk.selected, desk.selected_patch)
            with self._keeper.lock:
                before = self._editor.work.params.overrules.force
                controls.overrule(place_m, kind, str(self.reason.value))
                if kind is None and controls.read().overrules.force == before:
                    raise ConfigError(
                        "mark as: there is no verdict at this very place; undo it, or edit the text below"
                    )
            # Its number may be another one's when the result is there.
            desk.selected = desk.selected_patch = None
            self.reason.value = ""
            self._editor.submit()

    def submit_texts(self) -> None:
        """Let the overrules that are written count."""
        self._editor.controls.submit_texts()
        self._editor.submit()

    def clear(self) -> None:
        """Empty the overrules, and the region with them."""
        self._editor.adjust(
            lambda params: dataclasses.replace(params, overrules=OverrulesParams()), "cleared overrules"
        )


def place_of(inspection: Inspection | None, step_id: int | None, patch_id: int | None) -> tuple[float, float, float]:
    """Return the centroid of the patch of a step or surface, metres in the scan frame.

    Raises
    ------
    ConfigError
        Neither is given or is there, or the paper's method was used, which takes no decisions.
    """
    step = step_of(inspection, step_id)
    if inspection is None or (step is None and patch_id is None):
        raise ConfigError("mark as: choose a step or a rejected surface first")
    if inspection.params.method == "paper":
        raise ConfigError("mark as: the paper's method takes no decisions; set the method to survey")
    own = [
        patch
        for patch in inspection.patches
        if patch.patch_id == patch_id or (step is not None and patch.step_id == step.step_id)
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
