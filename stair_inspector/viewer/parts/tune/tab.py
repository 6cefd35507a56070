"""The Tune tab: presets, undo, the settings' sliders, the height histogram, the table, and what to compare with."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.viewer.bridge.controls import SettingControls
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.bridge.notices import from_page
from stair_inspector.viewer.compute.sensitivity import SWEPT_QUANTITIES
from stair_inspector.viewer.parts.steps.tab import StepsActions, StepsTable

OWN_PRESET = "(changed)"
"""What the preset menu says when the settings are those of no preset."""
NO_RUN = "none"
AS_SHOWN = "what is shown"
"""What menus say for no result, and for the one that the page shows."""


@dataclass(frozen=True)
class TuneActions:
    """What the Tune tab calls."""

    on_preset: Callable[[str], None]
    on_reset: Callable[[], None]
    on_save_preset: Callable[[], None]
    on_load_preset: Callable[[Any], None]
    on_undo: Callable[[], None]
    on_redo: Callable[[], None]
    on_suggest: Callable[[], None]
    on_take_suggestion: Callable[[], None]
    on_keep_run: Callable[[str], None]
    on_compare: Callable[[str], None]
    on_compare_to: Callable[[str], None]
    on_take_run: Callable[[], None]
    on_delete_run: Callable[[], None]
    on_sweep: Callable[[], None]
    on_stop_sweep: Callable[[], None]
    on_quantity: Callable[[], None]


class TuneTab:
    """The controls of the tab; the settings among them belong to ``controls``."""

    def __init__(
        self,
        gui: viser.GuiApi,
        presets: tuple[str, ...],
        sweeps: tuple[str, ...],
        controls: SettingControls,
        actions: TuneActions,
        steps: StepsActions,
    ) -> None:
        self.preset: Any = gui.add_dropdown(
            "Preset", presets, initial_value=presets[0], hint="Settings for a kind of scanner. Overrules stay."
        )
        self.preset.on_update(from_page(actions.on_preset, lambda: self.preset.value))
        self.steps_back: Any = gui.add_button_group("Changes", ("Undo", "Redo"), hint="Ctrl+Z, Ctrl+Shift+Z.")
        self.steps_back.on_click(
            from_page(
                lambda option: actions.on_redo() if option == "Redo" else actions.on_undo(),
                lambda: self.steps_back.value,
            )
        )
        self.changes = gui.add_html("")
        controls.add_place("tune")
        self.histogram = gui.add_html("")
        controls.add_place("heights")
        # What a slider does must be seen beside it.
        self.table = StepsTable(gui, steps)
        with gui.add_folder("Survey", expand_by_default=False):
            controls.add_place("survey")
        with gui.add_folder("More settings", expand_by_default=False):
            controls.add_by_stage("more")
        self._add_suggestion(gui, actions)
        self._add_runs(gui, actions)
        self._add_sweep(gui, sweeps, actions)
        self._add_files(gui, actions)

    def show_changes(self, undo: str, redo: str) -> None:
        """Say what can be undone and redone; empty words for nothing."""
        words = ([f"undo: {undo}"] if undo else []) + ([f"redo: {redo}"] if redo else [])
        self.changes.content = (
            f'<div data-testid="changes" style="font-size:11px;color:{DIM};padding:0 9px 4px;overflow-wrap:anywhere">'
            f"{text(' · '.join(words)) or '&nbsp;'}</div>"
        )

    def offer_presets(self, names: tuple[str, ...], chosen: str | None) -> None:
        """List the presets and show the one whose settings are set, or that they are those of none."""
        options = names if chosen is not None else (*names, OWN_PRESET)
        if tuple(self.preset.options) != options:
            self.preset.options = options
        self.preset.value = OWN_PRESET if chosen is None else chosen

    def offer_runs(self, titles: tuple[str, ...], a: str, b: str) -> None:
        """List the results that can be compared, and show the chosen ones."""
        for menu, nothing, chosen in ((self.compare, NO_RUN, a), (self.compare_to, AS_SHOWN, b)):
            options = (nothing, *titles)
            if tuple(menu.options) != options:
                menu.options = options
            menu.value = chosen
        self._run_tools.visible = self.compare_to.visible = a != NO_RUN

    def show_suggestion(self, html: str, *, is_there: bool) -> None:
        """Show a suggestion with its reasons, or why there is none."""
        self.suggestion.content = html
        self._take.visible = is_there

    def _add_suggestion(self, gui: viser.GuiApi, actions: TuneActions) -> None:
        with gui.add_folder("Suggest settings", expand_by_default=False):
            ask = gui.add_button(
                "Suggest from the scan",
                icon=viser.Icon.BULB,
                hint="Proposes θ_th, ε_z and m from the scan's spacing, noise and height gaps, and says why.",
            )
            ask.on_click(lambda _: actions.on_suggest())
            self.suggestion = gui.add_html("")
            self._take: Any = gui.add_button("Use these settings", icon=viser.Icon.CHECK, visible=False)
            self._take.on_click(lambda _: actions.on_take_suggestion())

    def _add_runs(self, gui: viser.GuiApi, actions: TuneActions) -> None:
        with gui.add_folder("Compare A / B", expand_by_default=False):
            self.run_name: Any = gui.add_text("Name", "run 1", hint="What these settings are kept under.")
            keep = gui.add_button("Keep this result", icon=viser.Icon.PIN, hint="To compare others with it.")
            keep.on_click(lambda _: actions.on_keep_run(self.run_name.value))
            self.compare: Any = gui.add_dropdown(
                "Result A",
                (NO_RUN,),
                initial_value=NO_RUN,
                hint="A kept run, or one of the last results by what was changed for it.",
            )
            self.compare.on_update(from_page(actions.on_compare, lambda: self.compare.value))
            self.compare_to: Any = gui.add_dropdown(
                "Result B",
                (AS_SHOWN,),
                initial_value=AS_SHOWN,
                hint="Its numbers beside those of A, and the differences, step by step.",
                visible=False,
            )
            self.compare_to.on_update(from_page(actions.on_compare_to, lambda: self.compare_to.value))
            self._run_tools: Any = gui.add_button_group(
                "With A", ("Use its settings", "Forget it"), visible=False, hint="Of a kept run, both can be undone."
            )
            self._run_tools.on_click(
                from_page(
                    lambda option: actions.on_delete_run() if option == "Forget it" else actions.on_take_run(),
                    lambda: self._run_tools.value,
                )
            )
            self.comparison = gui.add_html("")

    def _add_sweep(self, gui: viser.GuiApi, settings: tuple[str, ...], actions: TuneActions) -> None:
        quantities = tuple(SWEPT_QUANTITIES.values())
        with gui.add_folder("Sensitivity", expand_by_default=False):
            self.sweep_setting: Any = gui.add_dropdown("Setting", settings, initial_value=settings[0])
            self.sweep_quantity: Any = gui.add_dropdown("Quantity", quantities, initial_value=quantities[0])
            self.sweep_quantity.on_update(from_page(actions.on_quantity))
            self._sweep: Any = gui.add_button(
                "Sweep over its range",
                icon=viser.Icon.CHART_LINE,
                hint="Measures at values over the whole range: a good setting lies on a plateau.",
            )
            self._sweep.on_click(lambda _: actions.on_sweep())
            self._stop: Any = gui.add_button("Stop the sweep", icon=viser.Icon.PLAYER_STOP, color="gray", visible=False)
            self._stop.on_click(lambda _: actions.on_stop_sweep())
            self.sweep = gui.add_html("")

    def show_sweeping(self, is_sweeping: bool) -> None:
        """Offer to stop the sweep while it runs, and to start one otherwise."""
        self._sweep.visible, self._stop.visible = not is_sweeping, is_sweeping

    def _add_files(self, gui: viser.GuiApi, actions: TuneActions) -> None:
        with gui.add_folder("Preset files", expand_by_default=False):
            self.preset_title: Any = gui.add_text("Preset name", "my settings", hint="Title of the preset to be saved.")
            save = gui.add_button("Save preset", icon=viser.Icon.DEVICE_FLOPPY, hint="A TOML file, without overrules.")
            save.on_click(lambda _: actions.on_save_preset())
            self.load_preset: Any = gui.add_upload_button(
                "Load preset", icon=viser.Icon.FOLDER_OPEN, mime_type=".toml", hint="A TOML file of settings."
            )
            self.load_preset.on_upload(lambda _: actions.on_load_preset(self.load_preset.value))
            reset = gui.add_button(
                "Reset to preset", icon=viser.Icon.RESTORE, color="gray", hint="What the server was started with."
            )
            reset.on_click(lambda _: actions.on_reset())
