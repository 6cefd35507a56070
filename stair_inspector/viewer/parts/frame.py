"""What stands above the tabs and over the scene: the scan, the state of its result, what was found, toolbar, legend."""

import viser

from stair_inspector.errors import ConfigError
from stair_inspector.pictures.cameras import VIEWS
from stair_inspector.units import UNITS
from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.bridge.markup import title_html
from stair_inspector.viewer.bridge.names import names_html
from stair_inspector.viewer.bridge.overlay import Tool, overlay_html, toolbar_html
from stair_inspector.viewer.bridge.shortcuts import keys_html
from stair_inspector.viewer.bridge.styles import CLEAR_OF_THE_SCROLLBAR, FOLDERS, PHONE, READABLE
from stair_inspector.viewer.bridge.tour import tour_html
from stair_inspector.viewer.bridge.two_views import Arrangement, two_views_html
from stair_inspector.viewer.parts.came_along import CameAlong
from stair_inspector.viewer.parts.cures import Cures
from stair_inspector.viewer.parts.examination_html import headline_html
from stair_inspector.viewer.parts.glossary_html import glossary_html
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.status_html import header_html, state_html, view_only_html
from stair_inspector.viewer.scene.legends import colour_legend_html, legend_html
from stair_inspector.viewer.scene.stage import MODES, RAW, SEGMENTS, Mode
from stair_inspector.viewer.state.change import PageChange

WIDTH = 484
"""Of the panel, pixels."""
_ARRANGEMENTS: dict[Mode, Arrangement] = {"Side by side": "halves", "Swipe": "swipe"}
_BRANDS = ((13, 60, 88), (24, 110, 160))
"""Of the light and of the dark theme: viser paints its buttons in a paler shade of the first, which must still be 4.5
times as dark as their words."""


class Frame(PagePart):
    """The head of the panel, and what lies over the scene."""

    depends_on = frozenset(PageChange) - {PageChange.HISTORY, PageChange.TABLE, PageChange.SELECTION, PageChange.REST}

    def __init__(self, context: Context) -> None:
        self._context = context
        self._desk = context.desk
        widgets = context.widgets
        gui = widgets.gui
        gui.set_panel_label("stair_inspector")
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        widgets.html(keys_html() + names_html() + tour_html() + CLEAR_OF_THE_SCROLLBAR + READABLE + FOLDERS + PHONE)
        if context.keeper.is_view_only:
            widgets.html(view_only_html())
        self._title = widgets.html()
        self.toolbar = widgets.html()
        self.legend = widgets.html()
        self._two_views = widgets.html()
        self.header = widgets.html()
        self.state = widgets.html()
        self.examination = widgets.html()
        self._came_along = CameAlong(context)
        # The button on the line of the state writes here.
        self._cancel = widgets.button(
            "Cancel", context.cancel, hint="Stops what is computed or made.", is_visible=False
        )
        self._run = widgets.button(
            "Run again",
            context.editor.submit,
            icon=viser.Icon.PLAYER_PLAY,
            hint="Measures once more with the settings as they are. Key R.",
            is_quiet=True,
            is_visible=False,
        )
        self._cures = Cures(context)
        self._orders = widgets.orders("Toolbar", self.obey)

    def show(self, what: frozenset[PageChange]) -> None:
        """Show what belongs to the present result and to how it is looked at."""
        desk = self._desk
        if PageChange.THEME in what:
            desk.client.gui.configure_theme(
                dark_mode=desk.is_dark, show_logo=False, show_share_button=False, brand_color=_BRANDS[desk.is_dark]
            )
        if what & {PageChange.SCAN, PageChange.CLOUD}:
            self._show_scan()
        if what & {PageChange.RESULT, PageChange.SETTLED}:
            self.examination.content = headline_html(desk.marked, self._cures.uuid)
        if what & {PageChange.RESULT, PageChange.SETTLED, PageChange.STATUS}:
            self._show_state()
        if what & {PageChange.RESULT, PageChange.WORK, PageChange.SCAN}:
            self._came_along.show()
        if what - {PageChange.STATUS, PageChange.SETTLED}:
            self._show_legend()
            self._show_toolbar()
            self._show_views()

    def obey(self, message: str) -> None:
        """Do what a button of the toolbar asks for."""
        word, _, value = str(message).rpartition(":")[0].partition(" ")
        desk, look = self._desk, self._context.look
        if word == "mode":
            look.choose_mode(value)
        elif word == "view":
            look.set_view(value)
        elif word == "step":
            look.look_at_step()
        elif word == "unit":
            desk.set_unit(value)
        elif word == "theme":
            desk.set_theme(not desk.is_dark)
        elif word == "help":
            self._context.help.switch(self._context.commands(), glossary_html())
        else:
            raise ConfigError(f"toolbar: got {str(message)[:40]!r}; press one of its buttons")

    def _show_scan(self) -> None:
        shown, label = self._desk.shown, self._context.keeper.label
        title = title_html(f"{label} · stair_inspector")
        if self._title.content != title:
            self._title.content = title
        if shown is None:
            self.header.content = header_html(label, None, None)
        else:
            self.header.content = header_html(shown.label, len(shown.scan.points), len(shown.display.points))

    def _show_state(self) -> None:
        desk, status = self._desk, self._desk.status
        going_on = status.going_on
        busy = going_on.words if going_on is not None else status.waiting
        error = status.error if busy is None else None
        self._run.visible = error is not None and self._context.editor.refusal is None
        self.state.content = state_html(
            desk.marked,
            busy=busy,
            error=error,
            is_stale=status.is_behind and desk.shown is not None,
            percent=going_on.percent if going_on is not None else None,
            cancel_uuid=uuid_of(self._cancel),
        )

    def _show_legend(self) -> None:
        """Show what colours, lines and marks mean."""
        desk, look = self._desk, self._context.look
        with_steps = look.color_mode == "Step"
        tones = {mark.tone for mark in desk.marks.values()}
        content = legend_html(desk.palette, with_steps=with_steps, tones=tones, with_paper=desk.with_paper)
        if not with_steps and look.legend is not None:
            content = colour_legend_html(look.legend) + content
        content = overlay_html(content)
        # Sent only where it differs: it takes its place over the scene anew.
        if self.legend.content != content:
            self.legend.content = content

    def _show_views(self) -> None:
        """Draw the scene once, or the raw cloud and the segmentation in parts of their own."""
        arrangement = _ARRANGEMENTS.get(self._desk.stage.mode, "one")
        content = two_views_html(arrangement, RAW, SEGMENTS, ("Raw", "Segmented"))
        if self._two_views.content != content:
            self._two_views.content = content

    def _show_toolbar(self) -> None:
        """Show the buttons over the scene, and which of them are on."""
        desk = self._desk
        content = toolbar_html(
            self._orders,
            (
                tuple(
                    Tool(mode, f"Show: {mode} (key {key % 10})", f"mode {mode}", mode == desk.stage.mode)
                    for key, mode in enumerate(MODES, start=7)
                ),
                tuple(Tool(view, f"View: {view} (key {key})", f"view {view}") for key, view in enumerate(VIEWS, 1)),
                (Tool("Step", "Look at the chosen step (key F)", "step"),),
                tuple(Tool(unit, f"Lengths in {unit} (key U)", f"unit {unit}", unit == desk.unit) for unit in UNITS),
                (
                    Tool("Light" if desk.is_dark else "Dark", "Light or dark theme (key T)", "theme"),
                    Tool("Help", "Tour, drawing of a step, glossary, keys (key H)", "help"),
                ),
            ),
        )
        if self.toolbar.content != content:
            self.toolbar.content = content
