"""What one declaration of a setting says of it; flags, help, controls, files and checks all follow from that.

A setting is declared once, as a field of its group with a :class:`Setting` or, for a number, a :class:`Knob`::

    @dataclass(frozen=True)
    class LevelsParams(Group):
        eps_m: Annotated[
            float,
            Knob("vertical reach", 0.001, 0.1, 0.001, MM, symbol="ε_z", place="tune").says(
                "eps_z: vertical reach of DBSCAN, {range}. Larger than the noise."
            ),
        ] = 0.02

Imports nothing heavy, so that ``stair-inspector --help`` answers at once.
"""

import dataclasses
import math
import numbers
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, NamedTuple, Self, get_args, get_origin, get_type_hints

from typing_extensions import Doc

from stair_inspector.errors import ConfigError, brief

Place = Literal["scan", "tune", "heights", "survey", "more", "overrules", "scene"]
"""Where the page has the control of a setting.

The Scan tab; the Tune tab above its histogram of heights, below it, in its folder Survey, and in its folder More
settings; the overrules on the Steps tab; or the scene, where a tool of its own sets it. A number has a slider on the
Tune tab and in Survey, and is a field to write in elsewhere.
"""


@dataclass(frozen=True, slots=True)
class DisplayUnit:
    """How a number's unit is written.

    ``words`` name the unit of the setting itself; ``symbol`` that in which people see it, ``per_own`` times as large a
    number: 0.02 metres are shown as 20 mm.
    """

    words: str = ""
    symbol: str = ""
    per_own: float = 1.0


COUNT = DisplayUnit()
MM = DisplayUnit("metres", "mm", 1000.0)
METRES = DisplayUnit("metres", "m")
SQUARE_METRES = DisplayUnit("square metres", "m²")
DEGREES = DisplayUnit("degrees", "°")
PERCENT = DisplayUnit("percent", "%")
PERCENTILE = DisplayUnit("", "%")

_RANGE = "{range}"


@dataclass(frozen=True)
class Setting(Doc):
    """What is said of a setting that is chosen or written: its title on the page, its place there, its help.

    Settings of one place stand in the order of ``rank``, then as they are declared. ``documentation`` is the help as
    the command line prints it, ``hint`` as the page does.
    """

    title: str
    _: dataclasses.KW_ONLY
    place: Place = "more"
    rank: int = 0
    text: str = ""
    documentation: str = field(default="", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "documentation", self.text)

    def says(self, text: str) -> Self:
        """Return this with a sentence of help; ``{range}`` in it stands for the unit and range of a number."""
        return dataclasses.replace(self, text=text)

    @property
    def hint(self) -> str:
        """The help for who sees the setting in its display unit."""
        return self.documentation

    @property
    def called(self) -> str:
        """What the page calls the setting."""
        return self.title

    @property
    def label(self) -> str:
        """What stands beside its control."""
        return self.called


@dataclass(frozen=True)
class Knob(Setting):
    """What is said of a number: range, notch and unit too.

    ``low`` and ``high`` are inclusive and, like the notch ``step``, in the setting's own unit. ``swept`` is its place
    in the menu of settings that can be swept, 1 among the first, 0 for none. ``is_tried`` tells that a notch to either
    side is tried to find the values that hang on it.
    """

    low: float
    high: float
    step: float
    unit: DisplayUnit = COUNT
    _: dataclasses.KW_ONLY
    symbol: str = ""
    swept: int = 0
    is_tried: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "documentation", self.text.replace(_RANGE, self._range_words()))

    @property
    def hint(self) -> str:
        """The help for who sees the number in its display unit."""
        return self.text.replace(_RANGE, self._range_words(is_shown=True))

    @property
    def called(self) -> str:
        """The symbol, or the title where there is none."""
        return self.symbol or self.title

    @property
    def label(self) -> str:
        """What stands beside its control: what it is called, and the unit."""
        return self.called + (f" [{self.unit.symbol}]" if self.unit.symbol else "")

    def words(self, value: float) -> str:
        """Return a value as people see it: ``20 mm``."""
        return f"{self.shown(value):g} {self.unit.symbol}".rstrip()

    def shown(self, value: float) -> float:
        """Return ``value`` in the display unit."""
        return round(value * self.unit.per_own, 9)

    def stored(self, shown: float) -> float:
        """Return a displayed value in the setting's own unit."""
        return round(shown / self.unit.per_own, 12)

    def _range_words(self, *, is_shown: bool = False) -> str:
        is_converted = is_shown and self.unit.per_own != 1.0
        words = self.unit.symbol if is_converted else self.unit.words
        low, high = (self.shown(value) if is_converted else value for value in (self.low, self.high))
        return f"{words} ({low:.10g} to {high:.10g})".lstrip()


class Field(NamedTuple):
    """A field of a group: its type, and what is said of it; nothing of a field that is no more than its type."""

    kind: Any
    setting: Setting | None

    @property
    def knob(self) -> Knob | None:
        """What is said of a number."""
        return self.setting if isinstance(self.setting, Knob) else None


@dataclass(frozen=True)
class Group:
    """A group of settings that checks its own types and ranges when it is made."""

    def __post_init__(self) -> None:
        check_fields(self, f"{group_name(type(self))}.")


def check_fields(settings: Any, prefix: str = "") -> None:
    """Check each field of a settings object that is being made, and let it hold plain numbers in place of numpy's.

    Raises
    ------
    ConfigError
        As :func:`check_value`; ``prefix`` stands before the names.
    """
    for name, declared in fields_of(type(settings)).items():
        given = getattr(settings, name)
        value = _plain(given)
        check_value(f"{prefix}{name}", value, declared.kind, declared.knob)
        if value is not given:
            object.__setattr__(settings, name, value)


def _plain(value: Any) -> Any:
    """Return a number of numpy as one of Python: of single precision 0.01, not 0.009999999776; all else as it is."""
    if not isinstance(value, numbers.Real) or not hasattr(value, "dtype"):
        return value
    return int(value) if isinstance(value, numbers.Integral) else float(str(value))


def check_value(name: str, value: object, kind: Any, knob: Knob | None) -> None:
    """Check one setting against its declared type and range.

    Raises
    ------
    ConfigError
        With the name, what is allowed and what was given.
    """
    if get_origin(kind) is Literal:
        if not isinstance(value, str) or value not in get_args(kind):
            raise ConfigError(f"{name}: got {brief(value)}; give one of {', '.join(get_args(kind))}")
    elif kind in (int, float):
        value = _plain(value)
        is_number = isinstance(value, int if kind is int else (int, float)) and not isinstance(value, bool)
        # Only a float can be infinite; asking it of a whole number of 400 digits would overflow.
        if not is_number or (isinstance(value, float) and not math.isfinite(value)):
            raise ConfigError(f"{name}: got {brief(value)}; give a {'whole ' if kind is int else ''}number")
        if knob is not None and not knob.low <= typing.cast(float, value) <= knob.high:
            raise ConfigError(f"{name}: got {brief(value)}; give a value from {knob.low:g} to {knob.high:g}")
    elif not isinstance(value, kind):
        raise ConfigError(f"{name}: got {brief(value)}; give a text")


_FIELDS: dict[type, dict[str, Field]] = {}


def fields_of(group: type) -> dict[str, Field]:
    """Return what is declared of each field of a settings class, in order of declaration."""
    if group in _FIELDS:
        return _FIELDS[group]
    hints = get_type_hints(group, include_extras=True)
    result: dict[str, Field] = {}
    for item in dataclasses.fields(group):
        annotation = hints[item.name]
        kind, *extras = get_args(annotation) if get_origin(annotation) is Annotated else (annotation,)
        result[item.name] = Field(kind, next((extra for extra in extras if isinstance(extra, Setting)), None))
    # Read once per class: a slider makes new settings at every event.
    _FIELDS[group] = result
    return result


def group_name(group: type) -> str:
    """Return the name of a settings group in flags, TOML and JSON: ``LevelsParams`` is ``levels``."""
    return group.__name__.removesuffix("Params").lower()


class Catalogue(Mapping[str, Field]):
    """Every setting of a class of settings by its dotted name: its own fields first, then those of its groups.

    Parameters
    ----------
    root : type
        A dataclass whose fields are settings and groups of settings.
    """

    def __init__(self, root: type) -> None:
        declared = fields_of(root)
        self.groups: dict[str, type[Group]] = {name: each.kind for name, each in declared.items() if not each.setting}
        """The groups by their name in flags, TOML and JSON."""
        self._fields = {name: each for name, each in declared.items() if each.setting}
        for group, kind in self.groups.items():
            self._fields |= {f"{group}.{name}": each for name, each in fields_of(kind).items()}

    def __getitem__(self, name: str) -> Field:
        return self._fields[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def setting(self, name: str) -> Setting:
        """Return what is said of a setting.

        Raises
        ------
        ConfigError
            There is no such setting.
        """
        setting = self._fields[name].setting if name in self else None
        if setting is None:
            raise ConfigError(f"{name}: unknown setting")
        return setting

    def knob(self, name: str) -> Knob:
        """Return what is said of a numeric setting.

        Raises
        ------
        ConfigError
            There is no such setting, or it is not a number.
        """
        knob = self._fields[name].knob if name in self else None
        if knob is None:
            raise ConfigError(f"{name}: not a numeric setting")
        return knob

    def at(self, place: Place) -> tuple[str, ...]:
        """Return the names of the settings whose control stands at a place of the page, numbers first."""
        names = (name for name in self if self.setting(name).place == place)
        return tuple(sorted(names, key=lambda name: (self[name].knob is None, self.setting(name).rank)))

    def swept(self) -> tuple[str, ...]:
        """Return the names of the settings whose range can be swept, the most asked for first."""
        names = (name for name, each in self.items() if each.knob is not None and each.knob.swept > 0)
        return tuple(sorted(names, key=lambda name: self.knob(name).swept))

    def tried(self) -> tuple[str, ...]:
        """Return the names of the settings whose notches are tried, as they are declared."""
        return tuple(name for name, each in self.items() if each.knob is not None and each.knob.is_tried)


Box = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Lowest and highest corner."""


def parse_box(text: str, name: str, unit: str) -> Box | None:
    """Return the box that six numbers name, xmin,ymin,zmin,xmax,ymax,zmax; None of a text without any.

    Raises
    ------
    ConfigError
        Not six finite numbers, or a side without length. It names the setting ``name`` and the ``unit`` that is meant.
    """
    if not text.strip():
        return None
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if (
        len(numbers) != 6
        or not all(math.isfinite(number) for number in numbers)
        or not all(low < high for low, high in zip(numbers[:3], numbers[3:], strict=True))
    ):
        raise ConfigError(
            f"{name}: got {text[:80]!r}; give xmin,ymin,zmin,xmax,ymax,zmax in {unit}, each minimum below "
            "its maximum, or nothing"
        )
    return (numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5])
