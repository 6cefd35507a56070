"""The controls of one inspector's page, made from the settings' own declarations."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any, get_args

import viser

from stair_inspector.errors import ConfigError
from stair_inspector.params import (
    GROUPS,
    NAMED_UP,
    AxesRule,
    EdgeSource,
    Knob,
    Method,
    NormalsSource,
    Params,
    Unit,
    Verdict,
    fields_of,
    help_of,
    knob_of,
)
from stair_inspector.viewer.cameras import VIEWS
from stair_inspector.viewer.html import COLUMNS
from stair_inspector.viewer.markup import SURFACE
from stair_inspector.viewer.scene import MODES

_MAIN_SLIDERS = (
    "horizontal.theta_deg",
    "levels.eps_m",
    "levels.min_points",
    "edges.front_percentile",
    "edges.back_percentile",
    "edges.side_percentile",
    "normals.k",
)
_SURVEY_SLIDERS = (
    "patches.cell_m",
    "flights.max_gap_m",
    "flights.turn_deg",
    "survey.line_percent",
    "survey.band_m",
    "uncertainty.registration_m",
    "uncertainty.up_deg",
    "uncertainty.scale_percent",
)
SLIDERS = _MAIN_SLIDERS + _SURVEY_SLIDERS
"""Settings that have a slider, in the order of the page."""
TEXTS = {"overrules.force": "Surfaces", "overrules.climb": "Climb", "overrules.region": "Region"}
"""Settings that are written as text, with their labels."""
_LONGEST_TEXT = 20_000
_CHOICES: dict[str, tuple[str, tuple[str, ...]]] = {
    "method": ("Method", get_args(Method)),
    "axes.rule": ("Axes rule", get_args(AxesRule)),
    "survey.edge_source": ("Edges from", get_args(EdgeSource)),
    "normals.source": ("Normals", get_args(NormalsSource)),
    "unit": ("Unit of the file", get_args(Unit)),
}
_OWN_UP = "vector"
NO_STEP = "none"
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)


@dataclass(frozen=True)
class Actions:
    """What the controls call."""

    on_settings: Callable[[], None]
    on_reset: Callable[[], None]
    on_scan: Callable[[str], None]
    on_mode: Callable[[str], None]
    on_view: Callable[[str], None]
    on_theme: Callable[[bool], None]
    on_point_size: Callable[[float], None]
    on_select: Callable[[str], None]
    on_pick: Callable[[str], None]
    on_download: Callable[[str], None]
    on_columns: Callable[[str], None]
    on_rejected: Callable[[bool], None]
    on_mark: Callable[[str], None]
    on_clear_overrules: Callable[[], None]


class Panel:
    """The controls and displays of one page.

    Values are read from the controls when a run starts, not from events, because viser runs callbacks on many
    threads at once. What a page sends is checked by the settings' own rules; see :meth:`read`.
    """

    def __init__(self, client: viser.ClientHandle, scans: tuple[str, ...], params: Params, actions: Actions) -> None:
        gui = client.gui
        gui.set_panel_label("stair_inspector")
        self._controls: dict[str, Any] = {}
        self._base = params
        # Half a text is no setting: a text counts from when it is submitted.
        self._submitted: dict[str, Any] = {}
        self.header = gui.add_html("")
        self.state = gui.add_html("")
        self.progress: Any = gui.add_progress_bar(0.0, animated=True, visible=False)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Tune", viser.Icon.ADJUSTMENTS_HORIZONTAL):
            self._add_tuning(gui, params, actions)
        with tabs.add_tab("Scan", viser.Icon.SCAN):
            self._add_scan(gui, scans, params, actions)
        with tabs.add_tab("Export", viser.Icon.DOWNLOAD):
            self._add_exports(gui, actions)
        self.histogram = gui.add_html("")
        self._columns: Any = gui.add_button_group(
            "Table",
            tuple(columns.capitalize() for columns in COLUMNS),
            hint="The survey's values with their uncertainties, or the paper's.",
            visible=False,
        )
        self._columns.on_click(lambda event: self._from_page(event, actions.on_columns, self._columns.value))
        self.table = gui.add_html("")
        self.selected: Any = gui.add_dropdown(
            "Selected step",
            (NO_STEP,),
            initial_value=NO_STEP,
            hint="Highlights the step; so does a click on its row or tread.",
        )
        self.selected.on_update(lambda event: self._from_page(event, actions.on_select, self.selected.value))
        self.card = gui.add_html("")
        self._show_rejected: Any = gui.add_checkbox(
            "Show rejected surfaces",
            False,
            hint="Colours the surfaces that are no part of the staircase and lists them with the reason.",
            visible=False,
        )
        self._show_rejected.on_update(
            lambda event: self._from_page(event, actions.on_rejected, self._show_rejected.value)
        )
        self.rejected = gui.add_html("")
        self.details = gui.add_html("")
        self.legend = gui.add_html("")
        # Rows of the table write here; see html.pick_script.
        self.picked = gui.add_text("Picked row", "", visible=False)
        self.picked.on_update(lambda event: self._from_page(event, actions.on_pick, self.picked.value))
        self._add_view_panel(gui, actions)

    def read(self) -> Params:
        """Return the settings that the controls show.

        Raises
        ------
        ConfigError
            A value is out of range or of the wrong type, whatever the page sent.
        """
        params = self._base
        for name, control in self._controls.items():
            value = control.value
            if name in SLIDERS:
                value = _stored(name, value)
            elif name in TEXTS:
                value = _checked_text(name, self._submitted[name])
            elif name == "up":
                value = self._read_up(value)
            if name == "scan":
                continue
            params = params.replaced(name, value)
        return params

    def load(self, params: Params) -> None:
        """Set every control; the server's own changes start no run, see :meth:`_from_page`."""
        self._base = params
        for name, control in self._controls.items():
            if name in SLIDERS:
                control.value = _shown(name, params)
            elif name == "up":
                control.value = _up_option(params.up)
                self._up_vector.value = _up_vector(params.up)
            elif name in TEXTS:
                control.value = self._submitted[name] = _value(params, name)
            elif name != "scan":
                control.value = _value(params, name)

    def submit_texts(self) -> None:
        """Let what is written in the text fields count."""
        for name in TEXTS:
            self._submitted[name] = self._controls[name].value

    def overrule(self, place_m: tuple[float, float, float], kind: Verdict) -> None:
        """Add a decision about the surface at a place, metres in the scan frame."""
        name = "overrules.force"
        force = with_decision(_checked_text(name, self._submitted[name]), place_m, kind)
        self._controls[name].value = self._submitted[name] = force

    def clear_overrules(self) -> None:
        """Empty the text fields."""
        for name in TEXTS:
            group, _, field = name.rpartition(".")
            empty = getattr(GROUPS[group](), field)
            self._controls[name].value = self._submitted[name] = empty

    def offer_steps(self, step_ids: Iterable[int], surface_ids: Iterable[int], chosen: str) -> None:
        """List the steps and surfaces in the menu and set the chosen one."""
        surfaces = (f"{SURFACE} {patch_id}" for patch_id in surface_ids)
        options = (NO_STEP, *map(str, step_ids), *surfaces)
        if tuple(self.selected.options) != options:
            self.selected.options = options
        self.selected.value = chosen

    def show_survey_controls(self, is_survey: bool) -> None:
        """Show what only the survey has: its columns and its rejected surfaces."""
        self._columns.visible = is_survey
        self._show_rejected.visible = is_survey

    def show_scan_name(self, label: str) -> None:
        """Set the scan menu."""
        self._controls["scan"].value = label

    def show_point_size(self, size_m: float) -> None:
        """Set the point size slider, as near as its range allows."""
        self._point_size.value = min(self._point_size.max, max(self._point_size.min, round(size_m * 1000.0, 1)))

    def _add_tuning(self, gui: viser.GuiApi, params: Params, actions: Actions) -> None:
        self._add_sliders(gui, _MAIN_SLIDERS, params, actions)
        self._add_choice(gui, "axes.rule", params, actions)
        with gui.add_folder("Survey", expand_by_default=False):
            self._add_sliders(gui, _SURVEY_SLIDERS, params, actions)
            self._add_choice(gui, "survey.edge_source", params, actions)
        self._add_overrules(gui, params, actions)
        reset = gui.add_button("Reset to preset", icon=viser.Icon.RESTORE, color="gray")
        reset.on_click(lambda _: actions.on_reset())

    def _add_sliders(self, gui: viser.GuiApi, names: tuple[str, ...], params: Params, actions: Actions) -> None:
        for name in names:
            knob = knob_of(name)
            low, high, step = knob.shown(knob.low), knob.shown(knob.high), knob.shown(knob.step)
            kind: Any = int if _is_whole(name) else float
            slider = gui.add_slider(
                label_of(knob), kind(low), kind(high), kind(step), kind(_shown(name, params)), hint=help_of(name)
            )
            self._watch(name, slider, actions.on_settings)

    def _add_overrules(self, gui: viser.GuiApi, params: Params, actions: Actions) -> None:
        """Add the decisions of the inspector: for the chosen step or surface by a button, for all others as text."""
        form: Any = gui.add_form("Overrules", expand_by_default=False)
        with form:
            mark = gui.add_button_group(
                "Mark as", VERDICTS, hint="What the chosen step or rejected surface is, whatever the program says."
            )
            for name, label in TEXTS.items():
                # Enter submits; until then the text may be half a word.
                self._controls[name] = gui.add_text(label, _value(params, name), hint=help_of(name))
                self._submitted[name] = _value(params, name)
            apply = gui.add_button("Apply overrules", icon=viser.Icon.CHECK, hint="So does Enter in a field.")
            clear = gui.add_button("Clear overrules", icon=viser.Icon.ERASER, color="gray")
        mark.on_click(lambda event: self._from_page(event, actions.on_mark, mark.value))
        apply.on_click(lambda _: form.submit())
        form.on_submit(lambda _: self._submit_texts(actions))
        clear.on_click(lambda _: actions.on_clear_overrules())

    def _submit_texts(self, actions: Actions) -> None:
        self.submit_texts()
        actions.on_settings()

    def _add_scan(self, gui: viser.GuiApi, scans: tuple[str, ...], params: Params, actions: Actions) -> None:
        chooser = gui.add_dropdown(
            "Scan", scans, initial_value=scans[0], hint="Files that the inspector was started with."
        )
        chooser.on_update(lambda event: self._from_page(event, actions.on_scan, chooser.value))
        self._controls["scan"] = chooser
        self._add_choice(gui, "method", params, actions)
        self._add_choice(gui, "unit", params, actions)
        up = gui.add_dropdown(
            "Up", ("auto", *NAMED_UP, _OWN_UP), initial_value=_up_option(params.up), hint=help_of("up")
        )
        self._watch("up", up, actions.on_settings)
        self._up_vector: Any = gui.add_vector3(
            "Up vector", _up_vector(params.up), step=0.01, hint=f"Used when Up is '{_OWN_UP}'; any length."
        )
        self._up_vector.on_update(lambda event: self._from_page(event, actions.on_settings))
        self._add_choice(gui, "normals.source", params, actions)
        self._point_size: Any = gui.add_slider(
            "Point size [mm]",
            0.5,
            50.0,
            0.5,
            5.0,
            hint="Diameter of the drawn points; the measurement is not affected.",
        )
        self._point_size.on_update(lambda event: self._from_page(event, actions.on_point_size, self._point_size.value))

    def _add_exports(self, gui: viser.GuiApi, actions: Actions) -> None:
        gui.add_html(
            '<div style="font-size:12px;padding:2px">Files hold the numbers and settings of the result shown, '
            "not of a slider that is still moving.</div>"
        )
        for kind, icon, hint in (
            ("CSV", viser.Icon.TABLE, "One row for each step, millimetres and degrees."),
            ("JSON", viser.Icon.BRACES, "Everything: settings, levels, steps, notes; metres and degrees."),
            ("Debug PLY", viser.Icon.CUBE, "The scan in the paper's colours with its edges."),
            ("Screenshot PNG", viser.Icon.CAMERA, "The scene from where you look now, on white."),
        ):
            button = gui.add_button(kind, icon=icon, hint=hint)
            button.on_click(partial(_download, actions, kind))

    def _add_view_panel(self, gui: viser.GuiApi, actions: Actions) -> None:
        self._view_panel = gui.add_panel()
        with self._view_panel.add_tab("View", viser.Icon.EYE):
            mode = gui.add_button_group("Show", MODES, hint="Raw cloud, coloured steps, or both side by side.")
            mode.on_click(lambda event: self._from_page(event, actions.on_mode, mode.value))
            view = gui.add_button_group("Camera", VIEWS, hint="Stand back from that side of the staircase.")
            view.on_click(lambda event: self._from_page(event, actions.on_view, view.value))
            dark = gui.add_checkbox("Dark theme", False)
            dark.on_update(lambda event: self._from_page(event, actions.on_theme, dark.value))
        self._view_panel.float(x=12, y=12, width=350)
        gui.main_panel.dock_right()
        gui.main_panel.set_width(460)

    def _add_choice(self, gui: viser.GuiApi, name: str, params: Params, actions: Actions) -> None:
        label, options = _CHOICES[name]
        choice = gui.add_dropdown(label, options, initial_value=_value(params, name), hint=help_of(name))
        self._watch(name, choice, actions.on_settings)

    def _watch(self, name: str, control: Any, on_settings: Callable[[], None]) -> None:
        self._controls[name] = control
        control.on_update(lambda event: self._from_page(event, on_settings))

    def _from_page(self, event: Any, action: Callable[..., None], *values: Any) -> None:
        """Call an action for what a person did, not for what the server itself has set."""
        if event.client is not None:
            action(*values)

    def _read_up(self, option: object) -> object:
        if option != _OWN_UP:
            return option
        try:
            return ",".join(repr(float(component)) for component in self._up_vector.value)
        except (TypeError, ValueError) as error:
            raise ConfigError("Up vector: give three numbers") from error


def _download(actions: Actions, kind: str, _: Any) -> None:
    actions.on_download(kind)


def label_of(knob: Knob) -> str:
    """Return a slider's label: the symbol, or the words where there is none, and the unit."""
    unit = f" [{knob.display_unit}]" if knob.display_unit else ""
    return (knob.symbol or knob.label) + unit


def with_decision(force: str, place_m: tuple[float, float, float], kind: Verdict) -> str:
    """Return ``overrules.force`` with a decision about the surface at a place in the scan frame, metres.

    An earlier decision about the very same place is dropped.

    Examples
    --------
    >>> with_decision("level:3=rejected; at:1.000,0.000,0.170=tread", (1.0, 0.0, 0.17), "landing")
    'level:3=rejected; at:1.000,0.000,0.170=landing'
    """
    # Adding zero makes a rounded -0.0 a plain zero.
    place = "at:" + ",".join(f"{round(float(coordinate), 3) + 0.0:.3f}" for coordinate in place_m)
    entries = [entry.strip() for entry in force.split(";") if entry.strip()]
    kept = [entry for entry in entries if entry.partition("=")[0].strip() != place]
    return "; ".join([*kept, f"{place}={kind}"])


def _checked_text(name: str, value: object) -> str:
    """Return what a page has written; how it must look is the settings' own affair."""
    if not isinstance(value, str):
        raise ConfigError(f"{name}: got {str(value)[:40]!r}; give a text")
    if len(value) > _LONGEST_TEXT:
        raise ConfigError(f"{name}: has {len(value):,} characters; give at most {_LONGEST_TEXT:,}")
    return value


def _is_whole(name: str) -> bool:
    group, _, field = name.rpartition(".")
    return fields_of(GROUPS[group])[field][0] is int


def _value(params: Params, name: str) -> Any:
    owner: Any = params
    for part in name.split("."):
        owner = getattr(owner, part)
    return owner


def _shown(name: str, params: Params) -> Any:
    shown = knob_of(name).shown(_value(params, name))
    return int(shown) if _is_whole(name) else float(shown)


def _stored(name: str, shown: object) -> Any:
    """Return a slider's value in the setting's unit; a page may send anything."""
    knob = knob_of(name)
    # Only a float can be infinite; asking it of a whole number of 400 digits would overflow.
    is_infinite = isinstance(shown, float) and not math.isfinite(shown)
    if isinstance(shown, bool) or not isinstance(shown, (int, float)) or is_infinite:
        raise ConfigError(f"{label_of(knob)}: got {str(shown)[:40]!r}; give a number")
    if not knob.shown(knob.low) <= shown <= knob.shown(knob.high):
        got = str(shown)[:40] if isinstance(shown, int) else f"{shown:g}"
        raise ConfigError(
            f"{label_of(knob)}: got {got}; give a value from {knob.shown(knob.low):g} to {knob.shown(knob.high):g}"
        )
    return shown if _is_whole(name) else knob.stored(float(shown))


def _up_option(up: str) -> str:
    return up if up == "auto" or up in NAMED_UP else _OWN_UP


def _up_vector(up: str) -> tuple[float, float, float]:
    if _up_option(up) != _OWN_UP:
        return (0.0, 0.0, 1.0)
    x, y, z = (float(part) for part in up.split(","))
    return (x, y, z)
