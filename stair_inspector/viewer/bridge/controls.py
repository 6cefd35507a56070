"""The controls that hold settings: made from the settings' own declarations, read back and checked by their rules."""

import math
from collections.abc import Callable
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
    with_decision,
)
from stair_inspector.viewer.bridge.notices import from_page

MAIN_SLIDERS = (
    "horizontal.theta_deg",
    "levels.eps_m",
    "levels.min_points",
    "edges.front_percentile",
    "edges.back_percentile",
    "edges.side_percentile",
    "normals.k",
)
SURVEY_SLIDERS = (
    "patches.cell_m",
    "flights.max_gap_m",
    "flights.turn_deg",
    "survey.line_percent",
    "survey.band_m",
    "uncertainty.registration_m",
    "uncertainty.up_deg",
    "uncertainty.scale_percent",
)
SLIDERS = MAIN_SLIDERS + SURVEY_SLIDERS
"""Settings that have a slider, in the order of the page."""
TEXTS = {"overrules.force": "Surfaces", "overrules.climb": "Climb"}
"""Settings that are written as text, with their labels."""
CHOICES: dict[str, tuple[str, tuple[str, ...]]] = {
    "method": ("Method", get_args(Method)),
    "axes.rule": ("Axes rule", get_args(AxesRule)),
    "survey.edge_source": ("Edges from", get_args(EdgeSource)),
    "normals.source": ("Normals", get_args(NormalsSource)),
    "unit": ("Unit of the file", get_args(Unit)),
}
"""Settings that are chosen from a menu: label and options."""
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
OWN_UP = "vector"
_LONGEST_TEXT = 20_000


class SettingControls:
    """Every control that holds a setting, wherever on the page it stands.

    Values are read from the controls when a run starts, not from events, because viser runs callbacks on many
    threads at once. What a page sends is checked by the settings' own rules; see :meth:`read`. Settings without a
    control keep the value that was loaded last.

    Parameters
    ----------
    gui : viser.GuiApi
        Of one page.
    params : Params
        What the controls show at first.
    on_settings : callable
        Called without arguments when a person has changed a setting.
    """

    def __init__(self, gui: viser.GuiApi, params: Params, on_settings: Callable[[], None]) -> None:
        self._gui = gui
        self._base = params
        self._on_settings = on_settings
        self._controls: dict[str, Any] = {}
        self._up_vector: Any = None
        # Half a text is no setting: a text counts from when it is submitted.
        self._submitted: dict[str, Any] = {}

    # Making controls, within the container that is open.

    def add_sliders(self, names: tuple[str, ...]) -> None:
        """Add a slider for each setting."""
        for name in names:
            knob = knob_of(name)
            low, high, step = knob.shown(knob.low), knob.shown(knob.high), knob.shown(knob.step)
            kind: Any = int if _is_whole(name) else float
            slider = self._gui.add_slider(
                label_of(knob),
                kind(low),
                kind(high),
                kind(step),
                kind(_shown(name, self._base)),
                hint=f"{help_of(name)} ({name})",
            )
            self._watch(name, slider)

    def add_choice(self, name: str) -> None:
        """Add a menu for a setting."""
        label, options = CHOICES[name]
        self._watch(
            name, self._gui.add_dropdown(label, options, initial_value=self._base.value(name), hint=help_of(name))
        )

    def add_up(self) -> None:
        """Add the menu of up directions and the three numbers of one's own."""
        options = ("auto", *NAMED_UP, OWN_UP)
        up = self._gui.add_dropdown("Up", options, initial_value=_up_option(self._base.up), hint=help_of("up"))
        self._watch("up", up)
        self._up_vector = self._gui.add_vector3(
            "Up vector", _up_vector(self._base.up), step=0.0001, hint=f"Used when Up is '{OWN_UP}'; any length."
        )
        self._up_vector.on_update(from_page(self._on_settings))

    def add_text(self, name: str) -> None:
        """Add a text field; what is written there counts from :meth:`submit_texts`."""
        value = self._base.value(name)
        self._controls[name] = self._gui.add_text(TEXTS[name], value, hint=help_of(name))
        self._submitted[name] = value

    # Reading and setting.

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
            params = params.replaced(name, value)
        return params

    def load(self, params: Params) -> None:
        """Set every control; the server's own changes start no run."""
        self._base = params
        for name, control in self._controls.items():
            if name in SLIDERS:
                control.value = _shown(name, params)
            elif name == "up":
                control.value = _up_option(params.up)
                self._up_vector.value = _up_vector(params.up)
            elif name in TEXTS:
                control.value = self._submitted[name] = params.value(name)
            else:
                control.value = params.value(name)

    def submit_texts(self, *names: str) -> None:
        """Let what is written in these text fields count; in all of them without a name."""
        for name in names or TEXTS:
            if name in self._controls:
                self._submitted[name] = self._controls[name].value

    def overrule(self, place_m: tuple[float, float, float], kind: Verdict | None, reason: str = "") -> None:
        """Add a decision about the surface at a place, metres in the scan frame; None takes one back."""
        name = "overrules.force"
        self.write(name, with_decision(_checked_text(name, self._submitted[name]), place_m, kind, reason))

    def write(self, name: str, value: str) -> None:
        """Write a text field and let it count."""
        self._controls[name].value = self._submitted[name] = value

    def _watch(self, name: str, control: Any) -> None:
        self._controls[name] = control
        control.on_update(from_page(self._on_settings))

    def _read_up(self, option: object) -> object:
        if option != OWN_UP:
            return option
        try:
            return ",".join(repr(float(component)) for component in self._up_vector.value)
        except (TypeError, ValueError) as error:
            raise ConfigError("Up vector: give three numbers") from error


def label_of(knob: Knob) -> str:
    """Return a slider's label: the symbol, or the words where there is none, and the unit."""
    unit = f" [{knob.display_unit}]" if knob.display_unit else ""
    return (knob.symbol or knob.label) + unit


def words_of_change(before: Params, after: Params) -> tuple[str, str]:
    """Return what has changed, for a person, and the names of the changed settings, for telling drags apart.

    Examples
    --------
    >>> words_of_change(Params(), Params().replaced("levels.eps_m", 0.03))
    ('ε_z 20 mm to 30 mm', 'levels.eps_m')
    """
    changes = [
        (name, before.value(name), after.value(name))
        for name in setting_names()
        if before.value(name) != after.value(name)
    ]
    names = ", ".join(name for name, _, _ in changes)
    if len(changes) != 1:
        return f"{len(changes)} settings", names
    name, old, new = changes[0]
    return f"{title_of_setting(name)} {value_words(name, old)} to {value_words(name, new)}", names


def setting_names() -> list[str]:
    """Return the dotted name of every setting."""
    names = list(fields_of(Params))
    names = [name for name in names if name not in GROUPS]
    return names + [f"{group}.{field}" for group, kind in GROUPS.items() for field in fields_of(kind)]


def title_of_setting(name: str) -> str:
    """Return what a setting is called on the page."""
    if name in CHOICES:
        return CHOICES[name][0]
    if name in TEXTS:
        return TEXTS[name]
    if name == "overrules.region":
        return "Region"
    try:
        knob = knob_of(name)
    except ConfigError:
        return name
    return knob.symbol or knob.label


def value_words(name: str, value: object) -> str:
    """Return a setting's value as the page writes it: ``20 mm``."""
    try:
        knob = knob_of(name)
    except ConfigError:
        text = str(value)
        return f"'{text[:24]}…'" if len(text) > 24 else text or "none"
    unit = f" {knob.display_unit}" if knob.display_unit else ""
    return f"{knob.shown(float(str(value))):g}{unit}"


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


def _shown(name: str, params: Params) -> Any:
    shown = knob_of(name).shown(params.value(name))
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
    return up if up == "auto" or up in NAMED_UP else OWN_UP


def _up_vector(up: str) -> tuple[float, float, float]:
    if _up_option(up) != OWN_UP:
        return (0.0, 0.0, 1.0)
    # Without the sign of a zero.
    x, y, z = (float(part) + 0.0 for part in up.split(","))
    return (x, y, z)
