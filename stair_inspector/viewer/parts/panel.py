"""The panel of one inspector's page: what always shows, and the tabs that follow the work."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.files.palettes import Palette
from stair_inspector.params import Params
from stair_inspector.pictures.coloring import ColorMode
from stair_inspector.pictures.legends import Legend
from stair_inspector.units import UNITS
from stair_inspector.viewer.bridge.choices import Choice
from stair_inspector.viewer.bridge.controls import SettingControls
from stair_inspector.viewer.bridge.markup import title_html
from stair_inspector.viewer.bridge.notices import from_page, orders_from_page
from stair_inspector.viewer.bridge.overlay import overlay_html
from stair_inspector.viewer.bridge.shortcuts import keys_html
from stair_inspector.viewer.bridge.styles import CLEAR_OF_THE_SCROLLBAR
from stair_inspector.viewer.parts.checks.tab import ChecksActions, ChecksTab
from stair_inspector.viewer.parts.export.tab import ExportActions, ExportTab
from stair_inspector.viewer.parts.scan.tab import ScanActions, ScanTab
from stair_inspector.viewer.parts.steps import html
from stair_inspector.viewer.parts.steps.tab import StepsActions, StepsTab
from stair_inspector.viewer.parts.tune import histogram
from stair_inspector.viewer.parts.tune.tab import TuneActions, TuneTab
from stair_inspector.viewer.scene.legends import colour_legend_html
from stair_inspector.viewer.scene.step_marks import StepMark

WIDTH = 484
"""Of the panel, pixels."""


@dataclass(frozen=True)
class Actions:
    """What the panel calls."""

    scan: ScanActions
    tune: TuneActions
    steps: StepsActions
    checks: ChecksActions
    export: ExportActions
    on_settings: Callable[[], None]
    on_pick: Callable[[str], None]
    on_cancel: Callable[[], None]
    on_run: Callable[[], None]
    on_unit: Callable[[str], None]
    on_theme: Callable[[bool], None]
    on_help: Callable[[], None]


@dataclass(frozen=True)
class Offers:
    """What menus offer from the beginning: scans, presets, and the titles of settings that can be swept."""

    scans: tuple[str, ...]
    presets: tuple[str, ...]
    sweeps: tuple[str, ...]


class Panel:
    """The controls and displays of one page. Settings are read from ``controls``, whatever tab they stand on."""

    def __init__(self, client: viser.ClientHandle, offers: Offers, params: Params, actions: Actions) -> None:
        gui = client.gui
        gui.set_panel_label("stair_inspector")
        self.controls = SettingControls(gui, params, actions.on_settings)
        gui.add_html(keys_html() + CLEAR_OF_THE_SCROLLBAR)
        self._title = gui.add_html("")
        self.toolbar = gui.add_html("")
        self.legend = gui.add_html("")
        self.header = gui.add_html("")
        self.state = gui.add_html("")
        self.examination = gui.add_html("")
        # The button on the line of the state writes here.
        self.cancel: Any = gui.add_button("Cancel", visible=False)
        self.cancel.on_click(lambda _: actions.on_cancel())
        self.run: Any = gui.add_button("Run again", icon=viser.Icon.PLAYER_PLAY, color="gray", visible=False)
        self.run.on_click(lambda _: actions.on_run())
        tabs = gui.add_tab_group()
        with tabs.add_tab("Scan", viser.Icon.SCAN):
            self.scan = ScanTab(gui, offers.scans, self.controls, actions.scan)
        with tabs.add_tab("Tune", viser.Icon.ADJUSTMENTS_HORIZONTAL):
            self.tune = TuneTab(gui, offers.presets, offers.sweeps, self.controls, actions.tune, actions.steps)
        with tabs.add_tab("Steps", viser.Icon.STAIRS):
            self.steps = StepsTab(gui, self.controls, actions.steps)
        with tabs.add_tab("Checks", viser.Icon.CHECKLIST):
            self.checks = ChecksTab(gui, actions.checks)
        # Filled by the tools, which need the other tabs.
        self.look = tabs.add_tab("Look", viser.Icon.EYE)
        with tabs.add_tab("Export", viser.Icon.DOWNLOAD):
            self.export = ExportTab(gui, actions.export)
        self.details = gui.add_html("")
        self._add_page_settings(gui, actions)
        # Rows of the tables write here; see markup.pick_script.
        self.picked: Any = gui.add_text("Picked row", "", visible=False)
        self.picked.on_update(orders_from_page(actions.on_pick, lambda: self.picked.value))
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)

    def show_table(self, content: str, columns: html.Columns, *, is_survey: bool) -> None:
        """Show the steps, on both tabs that list them."""
        self.steps.table.show(content, columns, is_survey=is_survey)
        # Both may be on the page at the same time, and each has names of its own.
        self.tune.table.show(content.replace('data-testid="', 'data-testid="tune-'), columns, is_survey=is_survey)

    def show_survey_controls(self, is_survey: bool) -> None:
        """Show what only the survey has: its rejected surfaces."""
        self.steps.show_rejected.visible = is_survey

    def show_legend(
        self,
        palette: Palette,
        legend: Legend | None,
        mode: ColorMode,
        marks: Mapping[int, StepMark],
        *,
        with_paper: bool = False,
    ) -> None:
        """Show what colours, lines and marks mean."""
        tones = {mark.tone for mark in marks.values()}
        content = html.legend_html(palette, with_steps=mode == "Step", tones=tones, with_paper=with_paper)
        if mode != "Step" and legend is not None:
            content = colour_legend_html(legend) + content
        self.legend.content = overlay_html(content)

    def show_waiting(self, label: str, palette: Palette) -> None:
        """Show the empty page of a scan that is being opened."""
        self._title.content = title_html(f"{label} · stair_inspector")
        self.header.content = html.header_html(label, None, None)
        self.show_table(html.table_html(None, palette, None, None), "paper", is_survey=False)
        self.tune.histogram.content = histogram.histogram_html(None, palette)

    def _add_page_settings(self, gui: viser.GuiApi, actions: Actions) -> None:
        self.unit = Choice(
            gui, "Lengths in", UNITS, UNITS[0], "On this page only; files are in metres and millimetres. Key U."
        )
        self.unit.group.on_click(from_page(actions.on_unit, lambda: self.unit.group.value))
        self.dark: Any = gui.add_checkbox("Dark theme", False, hint="Key T.")
        self.dark.on_update(from_page(actions.on_theme, lambda: self.dark.value))
        self.help: Any = gui.add_button(
            "Keys and help", icon=viser.Icon.KEYBOARD, color="gray", hint="Key H; Ctrl+K searches all commands."
        )
        self.help.on_click(lambda _: actions.on_help())
