"""The controls that hold settings: made from the settings' own declarations, read back and checked by their rules."""

import math
from collections.abc import Callable, Collection
from itertools import groupby
from typing import Any, Literal, cast, get_args, get_origin

import viser

from stair_inspector.declarations import Place
from stair_inspector.errors import ConfigError
from stair_inspector.overrules import NAMED_UP, ForcedKind, with_decision
from stair_inspector.params import GROUPS, SETTINGS, Params
from stair_inspector.viewer.bridge.handles import Setter, uuid_of
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.bridge.notices import from_page

CHOICES = tuple(name for name, declared in SETTINGS.items() if get_origin(declared.kind) is Literal)
"""Settings that are chosen from a menu."""
SLIDER_PLACES: tuple[Place, ...] = ("tune", "survey")
"""Where a number has a slider; elsewhere it is a field to write in."""
VERDICTS: tuple[ForcedKind, ...] = get_args(ForcedKind)
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
        self._controls: dict[str, Setter] = {}
        self._up_vector: Any = None
        # Half a text is no setting: a text counts from when it is submitted.
        self._submitted: dict[str, object] = {}

    # Making controls, within the container that is open.

    def add_place(self, place: Place) -> None:
        """Add the control of every setting that stands at a place, in the order of the page."""
        for name in SETTINGS.at(place):
            self.add(name)

    def add_by_stage(self, place: Place) -> None:
        """Add the controls of a place under a line for each stage, which says what it is about."""
        for stage, names in groupby(sorted(SETTINGS.at(place), key=list(SETTINGS).index), key=_stage_of):
            about = (GROUPS[stage].__doc__ or "").partition("\n")[0] if stage else ""
            self._gui.add_html(f'<div style="font-size:11px;color:{DIM};padding:6px 9px 0">{text(about)}</div>')
            for name in names:
                self.add(name)

    def add(self, name: str) -> None:
        """Add the control of one setting: a slider, a field for a number, a menu, or a field for a text."""
        if name == "up":
            self.add_up()
        elif name in CHOICES:
            self.add_choice(name)
        elif SETTINGS[name].knob is None:
            self.add_text(name)
        else:
            self._add_number(name)

    def _add_number(self, name: str) -> None:
        knob = SETTINGS.knob(name)
        kind: Any = SETTINGS[name].kind
        low, high, step = (kind(knob.shown(value)) for value in (knob.low, knob.high, knob.step))
        value = _shown(name, self._base)
        hint = f"{knob.hint} ({name})"
        if knob.place in SLIDER_PLACES:
            self._watch(name, self._gui.add_slider(knob.label, low, high, step, value, hint=hint))
        else:
            self._watch(name, self._gui.add_number(knob.label, value, min=low, max=high, step=step, hint=hint))

    def add_choice(self, name: str) -> None:
        """Add a menu for a setting."""
        declared, setting = SETTINGS[name], SETTINGS.setting(name)
        self._watch(
            name,
            self._gui.add_dropdown(
                setting.label, get_args(declared.kind), initial_value=self._base.value(name), hint=setting.hint
            ),
        )

    def add_up(self) -> None:
        """Add the menu of up directions and the three numbers of one's own."""
        options = ("auto", *NAMED_UP, OWN_UP)
        setting = SETTINGS.setting("up")
        up = self._gui.add_dropdown(setting.label, options, initial_value=_up_option(self._base.up), hint=setting.hint)
        self._watch("up", up)
        self._up_vector = self._gui.add_vector3(
            "Up vector",
            _up_vector(self._base.up),
            step=0.0001,
            hint=f"Used when {setting.label} is '{OWN_UP}'; any length.",
        )
        self._up_vector.on_update(from_page(self._on_settings))

    def add_text(self, name: str) -> None:
        """Add a text field; what is written there counts from :meth:`submit_texts`."""
        value, setting = self._base.value(name), SETTINGS.setting(name)
        self._controls[name] = cast(Setter, self._gui.add_text(setting.label, value, hint=setting.hint))
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
            if SETTINGS[name].knob is not None:
                value = _stored(name, value)
            elif name in self._submitted:
                value = _checked_text(name, self._submitted[name])
            elif name == "up":
                value = self._read_up(value)
            params = params.replaced(name, value)
        return params

    def load(self, params: Params) -> None:
        """Set every control; the server's own changes start no run."""
        self._base = params
        for name, control in self._controls.items():
            if SETTINGS[name].knob is not None:
                control.value = _shown(name, params)
            elif name == "up":
                control.value = _up_option(params.up)
                self._up_vector.value = _up_vector(params.up)
            elif name in self._submitted:
                control.value = self._submitted[name] = params.value(name)
            else:
                control.value = params.value(name)

    def dimmed(self, names: Collection[str]) -> str:
        """Return the style that dims the controls of these settings; they work as before."""
        rows = [
            f'.mantine-Flex-root:has(>*>*>label[for="{uuid_of(self._controls[name])}"])'
            for name in names
            if name in self._controls
        ]
        # Words stay as dark as all small letters must be.
        tracks = ",".join(f"{row} :is(.mantine-Slider-bar,.mantine-Slider-thumb)" for row in rows)
        words = ",".join(f"{row} :is(label,input)" for row in rows)
        return f"<style>{tracks}{{opacity:.4}}{words}{{font-style:italic;color:{DIM}}}</style>" if rows else ""

    def submit_texts(self, *names: str) -> None:
        """Let what is written in these text fields count; in all of them without a name."""
        for name in names or tuple(self._submitted):
            if name in self._submitted:
                self._submitted[name] = self._controls[name].value

    def overrule(self, place_m: tuple[float, float, float], kind: ForcedKind | None, reason: str = "") -> None:
        """Add a decision about the surface at a place, metres in the scan frame; None takes one back."""
        name = "overrules.force"
        self.write(name, with_decision(_checked_text(name, self._submitted[name]), place_m, kind, reason))

    def write(self, name: str, value: str) -> None:
        """Write a text field and let it count."""
        self._controls[name].value = self._submitted[name] = value

    def _watch(self, name: str, control: object) -> None:
        self._controls[name] = watched = cast(Setter, control)
        watched.on_update(from_page(self._on_settings))

    def _read_up(self, option: object) -> object:
        if option != OWN_UP:
            return option
        try:
            return ",".join(repr(float(component)) for component in self._up_vector.value)
        except (TypeError, ValueError) as error:
            raise ConfigError("Up vector: give three numbers") from error


def words_of_change(before: Params, after: Params) -> tuple[str, str]:
    """Return what has changed, for a person, and the names of the changed settings, for telling drags apart.

    Examples
    --------
    >>> words_of_change(Params(), Params().replaced("levels.eps_m", 0.03))
    ('ε_z 20 mm to 30 mm', 'levels.eps_m')
    """
    changes = [
        (name, before.value(name), after.value(name)) for name in SETTINGS if before.value(name) != after.value(name)
    ]
    names = ", ".join(name for name, _, _ in changes)
    if len(changes) != 1:
        return f"{len(changes)} settings", names
    name, old, new = changes[0]
    return f"{SETTINGS.setting(name).called} {value_words(name, old)} to {value_words(name, new)}", names


def value_words(name: str, value: object) -> str:
    """Return a setting's value as the page writes it: ``20 mm``."""
    knob = SETTINGS[name].knob
    if knob is not None:
        return knob.words(float(str(value)))
    written = str(value)
    return f"'{written[:24]}…'" if len(written) > 24 else written or "none"


def _checked_text(name: str, value: object) -> str:
    """Return what a page has written; how it must look is the settings' own affair."""
    if not isinstance(value, str):
        raise ConfigError(f"{name}: got {str(value)[:40]!r}; give a text")
    if len(value) > _LONGEST_TEXT:
        raise ConfigError(f"{name}: has {len(value):,} characters; give at most {_LONGEST_TEXT:,}")
    return value


def _stage_of(name: str) -> str:
    return name.rpartition(".")[0]


def _shown(name: str, params: Params) -> float:
    shown: float = SETTINGS[name].kind(SETTINGS.knob(name).shown(params.value(name)))
    return shown


def _stored(name: str, shown: object) -> float:
    """Return a control's value in the setting's unit; a page may send anything."""
    knob = SETTINGS.knob(name)
    # Only a float can be infinite; asking it of a whole number of 400 digits would overflow.
    is_infinite = isinstance(shown, float) and not math.isfinite(shown)
    if isinstance(shown, bool) or not isinstance(shown, (int, float)) or is_infinite:
        raise ConfigError(f"{knob.label}: got {str(shown)[:40]!r}; give a number")
    if not knob.shown(knob.low) <= shown <= knob.shown(knob.high):
        got = str(shown)[:40] if isinstance(shown, int) else f"{shown:g}"
        raise ConfigError(
            f"{knob.label}: got {got}; give a value from {knob.shown(knob.low):g} to {knob.shown(knob.high):g}"
        )
    return shown if SETTINGS[name].kind is int else knob.stored(float(shown))


def _up_option(up: str) -> str:
    return up if up == "auto" or up in NAMED_UP else OWN_UP


def _up_vector(up: str) -> tuple[float, float, float]:
    if _up_option(up) != OWN_UP:
        return (0.0, 0.0, 1.0)
    # Without the sign of a zero.
    x, y, z = (float(part) + 0.0 for part in up.split(","))
    return (x, y, z)
