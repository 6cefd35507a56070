"""Presets and suggestions: how an inspector comes to settings."""

import dataclasses

import viser

from stair_inspector.errors import ConfigError, StairError, one_of
from stair_inspector.files.settings import Preset, list_presets, parse_preset, preset_bytes
from stair_inspector.model import HeightOrder
from stair_inspector.params import SETTINGS, Params
from stair_inspector.pictures.picture import safe_name
from stair_inspector.stages.suggest import Suggestion
from stair_inspector.viewer.bridge.controls import value_words
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.bridge.widgets import File, offer
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.scan_settings import ScanSettings, of_scan
from stair_inspector.viewer.scene.step_marks import tone_css

OWN_PRESET = "(changed)"
"""What the preset menu says when the settings are those of no preset."""
STARTED_WITH = "as started"
"""In the preset menu, the settings that the server was started with, where they are those of no preset."""
_LAST, _SUGGESTED = _OWN = ("As last time", "As suggested")
_MOST_PRESETS = 20
_LARGEST_PRESET_BYTES = 200_000


class Presets:
    """The Tune tab's presets and suggestions: the menu, and the folders that :meth:`add_suggestion` and others add."""

    def __init__(self, context: Context) -> None:
        self._widgets = context.widgets
        self._desk = context.desk
        self._editor = context.editor
        self._settings = ScanSettings(context)
        self._presets = known_presets(context.editor.started)
        self._suggestion: Suggestion | None = None
        self._heights: HeightOrder | None = None
        self.menu = context.widgets.dropdown(
            "Preset",
            tuple(self._presets),
            hint="Settings for a kind of scanner. Overrules stay.",
            on_change=self.take_preset,
        )
        context.widgets.buttons(
            "Settings",
            _OWN,
            self.take_settings,
            hint="What the last session left this scan with, or what Suggest settings proposes for it.",
        )

    def add_suggestion(self) -> None:
        """Add the folder in which settings are proposed."""
        with self._widgets.folder("Suggest settings", is_open=False):
            self._widgets.button(
                "Suggest from the scan",
                self.suggest,
                icon=viser.Icon.BULB,
                hint="Proposes θ_th, ε_z and m from the scan's spacing, noise and height gaps, and says why.",
            )
            self.suggestion = self._widgets.html()
            self._take = self._widgets.button(
                "Use these settings",
                self.take_suggestion,
                icon=viser.Icon.CHECK,
                hint="In one change, which can be undone.",
                is_visible=False,
            )

    def add_files(self) -> None:
        """Add the folder in which presets are saved and loaded."""
        with self._widgets.folder("Preset files", is_open=False):
            self._title = self._widgets.text("Preset name", "my settings", hint="Title of the preset to be saved.")
            self._widgets.button(
                "Save preset",
                self.save_preset,
                icon=viser.Icon.DEVICE_FLOPPY,
                hint="A TOML file, without overrules.",
            )
            self.load = self._widgets.upload(
                "Load preset",
                ".toml",
                self.load_preset,
                icon=viser.Icon.FOLDER_OPEN,
                hint="A TOML file of settings.",
            )
            self._widgets.button(
                "Reset to preset",
                self._editor.reset,
                icon=viser.Icon.RESTORE,
                is_quiet=True,
                hint="What the server was started with.",
            )

    # Presets.

    def take_preset(self, title: str) -> None:
        """Take the settings of a preset; overrules, region, unit and up stay: they belong to the scan."""
        preset = self._presets.get(title)
        if preset is None:
            if title == self.menu.value and title not in self._presets:
                return
            raise ConfigError(f"preset: got {str(title)[:40]!r}; choose one of the menu")
        self._editor.adjust(lambda params: of_scan(params, preset), f"preset {title}")

    def save_preset(self) -> None:
        """Download the present settings as a preset file, without what belongs to this scan alone."""
        title = str(self._title.value).strip()[:100] or "my settings"
        params = dataclasses.replace(self._editor.work.params, overrules=Params().overrules)
        data = preset_bytes(params, title, "Saved by stair_inspector.")
        self._desk.client.send_file_download(f"{safe_name(title)}.toml", data, save_immediately=True)

    def load_preset(self, file: File) -> None:
        """Take the settings of an uploaded preset file, and keep it in the menu of this page."""
        if len(file.content) > _LARGEST_PRESET_BYTES:
            raise ConfigError(f"{file.name[:60]}: is too large for a preset; give a TOML file of settings")
        preset = parse_preset(file.content, file.name[:80])
        if preset.title in (OWN_PRESET, STARTED_WITH):
            raise ConfigError(f"preset: {preset.title!r} is a word of the menu; give the preset another title")
        if len(self._presets) >= _MOST_PRESETS and preset.title not in self._presets:
            raise ConfigError(f"preset: this page has {_MOST_PRESETS}, which is the most; load the page again")
        self._presets[preset.title] = preset.params
        self.show_preset()
        self._editor.adjust(lambda params: of_scan(params, preset.params), f"preset {preset.title}")

    def show_preset(self) -> None:
        """Show which preset's settings are set."""
        params = self._editor.work.params
        chosen = next((title for title, preset in self._presets.items() if of_scan(params, preset) == params), None)
        offered = tuple(self._presets) if chosen is not None else (*self._presets, OWN_PRESET)
        offer(self.menu, offered, chosen or OWN_PRESET)

    # Suggestions.

    def _show(self, content: str, *, is_there: bool) -> None:
        self.suggestion.content = content
        self._take.visible = is_there

    def know_heights(self) -> None:
        """Take what the last run prepared: suggestions are made from it."""
        heights = self._desk.heights
        if heights is not self._heights:
            self._heights = heights
            self._suggestion = None
            self._show("", is_there=False)

    def suggest(self) -> None:
        """Propose settings and say why."""
        try:
            self._suggestion = self._settings.suggest()
        except StairError as error:
            self._show(_suggestion_html(None, str(error)), is_there=False)
        else:
            self._show(_suggestion_html(self._suggestion, ""), is_there=True)

    def take_suggestion(self) -> None:
        """Use what was proposed."""
        if self._suggestion is None:
            raise ConfigError("suggest settings: there is no suggestion; ask for one first")
        self._settings.take_suggested(self._suggestion)

    def take_settings(self, option: str) -> None:
        """Use the settings of the scan's last session, or those that are suggested for it."""
        one_of(option, _OWN, "settings")
        if option == _LAST:
            self._settings.take_last()
            return
        self.suggest()
        if self._suggestion is None:
            raise ConfigError("as suggested: nothing can be suggested; Suggest settings, below, says why")
        self.take_suggestion()


def known_presets(started: Params) -> dict[str, Params]:
    """Return the presets by title; the settings that the server was started with come first."""
    presets: list[Preset] = list_presets()
    by_title = {preset.title: preset.params for preset in presets}
    if started not in by_title.values():
        return {STARTED_WITH: started, **by_title}
    first = next(title for title, params in by_title.items() if params == started)
    return {first: started, **by_title}


def _suggestion_html(suggestion: Suggestion | None, why_not: str) -> str:
    style = "font-size:12px;line-height:1.4;padding:2px 9px 6px"
    if suggestion is None:
        return f'<div data-testid="suggestion" style="{style};color:{tone_css("bad")}">{text(why_not)}</div>'
    rows = "".join(
        f'<li data-setting="{text(reason.name)}" style="padding:1px 0"><b>{text(SETTINGS.setting(reason.name).called)} '
        f"{text(value_words(reason.name, reason.value))}</b>: {text(reason.why)}</li>"
        for reason in suggestion.reasons
    )
    seen = (
        f"Seen: {suggestion.n_levels} levels, points {suggestion.spacing_m * 1000.0:.1f} mm apart, heights within a "
        f"level scatter by {suggestion.thickness_m * 1000.0:.1f} mm, normals by {suggestion.normal_deg:.1f}°."
    )
    return (
        f'<div data-testid="suggestion" style="{style}"><ul style="margin:0 0 4px;padding-left:16px">{rows}</ul>'
        f'<div style="color:{DIM}">{text(seen)}</div></div>'
    )
