"""Presets and suggestions: how an inspector comes to settings."""

import dataclasses
from typing import Any

from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.settings import Preset, list_presets, parse_preset, preset_bytes
from stair_inspector.model import HeightOrder
from stair_inspector.params import SETTINGS, Params
from stair_inspector.pictures.picture import safe_name
from stair_inspector.stages.suggest import Suggestion, suggest_settings
from stair_inspector.viewer.bridge.controls import value_words
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.compute.jobs import Making
from stair_inspector.viewer.parts.desk import Desk, Editor
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.parts.tune.tab import OWN_PRESET

STARTED_WITH = "as started"
"""In the preset menu, the settings that the server was started with, where they are those of no preset."""
_MOST_PRESETS = 20
_LARGEST_PRESET_BYTES = 200_000


class Tuning:
    """The Tune tab's presets and suggestions."""

    def __init__(self, desk: Desk, panel: Panel, editor: Editor, started: Params, making: Making) -> None:
        self._making = making
        self._desk = desk
        self._panel = panel
        self._editor = editor
        self._presets = known_presets(started)
        self._suggestion: Suggestion | None = None
        self._heights: HeightOrder | None = None

    # Presets.

    def take_preset(self, title: str) -> None:
        """Take the settings of a preset; overrules, region, unit and up stay: they belong to the scan."""
        preset = self._presets.get(title)
        if preset is None:
            if title == self._panel.tune.preset.value and title not in self._presets:
                return
            raise ConfigError(f"preset: got {str(title)[:40]!r}; choose one of the menu")
        self._editor.adjust(lambda params: _of_scan(params, preset), f"preset {title}")

    def save_preset(self) -> None:
        """Download the present settings as a preset file, without what belongs to this scan alone."""
        title = str(self._panel.tune.preset_title.value).strip()[:100] or "my settings"
        params = dataclasses.replace(self._editor.work.params, overrules=Params().overrules)
        data = preset_bytes(params, title, "Saved by stair_inspector.")
        self._desk.client.send_file_download(f"{safe_name(title)}.toml", data, save_immediately=True)

    def load_preset(self, file: Any) -> None:
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
        self._editor.adjust(lambda params: _of_scan(params, preset.params), f"preset {preset.title}")

    def show_preset(self) -> None:
        """Show which preset's settings are set."""
        params = self._editor.work.params
        chosen = next((title for title, preset in self._presets.items() if _of_scan(params, preset) == params), None)
        self._panel.tune.offer_presets(tuple(self._presets), chosen)

    # Suggestions.

    def know_heights(self, heights: HeightOrder) -> None:
        """Take what the last run prepared: suggestions are made from it."""
        if heights is not self._heights:
            self._heights = heights
            self._suggestion = None
            self._panel.tune.show_suggestion("", is_there=False)

    def suggest(self) -> None:
        """Propose settings and say why."""
        self._desk.result("suggest settings")
        heights = self._heights
        if heights is None:
            raise ConfigError("suggest settings: the scan is not prepared yet; wait for the first result")
        panel = self._panel.tune
        try:
            self._suggestion = self._making.make(
                "the suggestion", lambda _: suggest_settings(heights, self._editor.work.params)
            )
        except StairError as error:
            panel.show_suggestion(_suggestion_html(None, str(error)), is_there=False)
        else:
            panel.show_suggestion(_suggestion_html(self._suggestion, ""), is_there=True)

    def take_suggestion(self) -> None:
        """Use what was proposed."""
        if self._suggestion is None:
            raise ConfigError("suggest settings: there is no suggestion; ask for one first")
        suggestion = self._suggestion

        def take(params: Params) -> Params:
            for reason in suggestion.reasons:
                params = params.replaced(reason.name, suggestion.params.value(reason.name))
            return params

        self._editor.adjust(take, "suggested settings")


def known_presets(started: Params) -> dict[str, Params]:
    """Return the presets by title; the settings that the server was started with come first."""
    presets: list[Preset] = list_presets()
    by_title = {preset.title: preset.params for preset in presets}
    if started not in by_title.values():
        return {STARTED_WITH: started, **by_title}
    first = next(title for title, params in by_title.items() if params == started)
    return {first: started, **by_title}


def _of_scan(params: Params, preset: Params) -> Params:
    """Return a preset's settings with what belongs to the scan and not to a kind of scanner."""
    return dataclasses.replace(preset, overrules=params.overrules, unit=params.unit, up=params.up)


def _suggestion_html(suggestion: Suggestion | None, why_not: str) -> str:
    style = "font-size:12px;line-height:1.4;padding:2px 9px 6px"
    if suggestion is None:
        return f'<div data-testid="suggestion" style="{style};color:#e03131">{text(why_not)}</div>'
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
