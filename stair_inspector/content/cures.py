"""What a cure of the command line means for someone who has no command line: settings, and words for them."""

import re
from dataclasses import dataclass

from stair_inspector.declarations import Knob
from stair_inspector.errors import ConfigError
from stair_inspector.model import Observation
from stair_inspector.params import SETTINGS, Params
from stair_inspector.units import UNIT_NAMES

_FLAG = r"--([a-z][a-z0-9-]*(?:\.[a-z][a-z0-9-]*)?)(?:=|\s+)([^\s;,]+(?:,[^\s;,]+)*)"
_FLAGS = re.compile(rf"{_FLAG}(?:\s+{_FLAG})*")
"""Flags one behind the other belong together; others are alternatives, as in ``--up=z or --up=-y``."""


@dataclass(frozen=True, slots=True)
class Cure:
    """Settings that answer a question or mend a doubt, by dotted name, and the words for them."""

    words: str
    changes: tuple[tuple[str, object], ...]

    def applied(self, params: Params) -> Params:
        """Return the settings with these among them."""
        for name, value in self.changes:
            params = params.replaced(name, value)
        return params


def cures_of(found: Observation) -> tuple[Cure, ...]:
    """Return the alternatives among settings that a cure names; none where it is a sentence without flags.

    Examples
    --------
    >>> [cure.words for cure in cures_of(Observation("a", "question", "", cure="--unit in or --unit cm"))]
    ['the file is in inches', 'the file is in centimetres']
    """
    cures = (_cure_of(match.group(0)) for match in _FLAGS.finditer(found.cure))
    return tuple(dict.fromkeys(cure for cure in cures if cure is not None))


def cure_words(found: Observation) -> str:
    """Return a cure for someone who reads: flags in words, a sentence as it is."""
    words = found.cure
    for match in reversed(list(_FLAGS.finditer(words))):
        cure = _cure_of(match.group(0))
        if cure is not None:
            words = words[: match.start()] + cure.words + words[match.end() :]
    return words


def advice_in_words(text: str) -> str:
    """Return a text with the words of settings for the flags that it advises.

    Examples
    --------
    >>> advice_in_words("if they are steps, give --flights.max-rise-m 0.37")
    'if they are steps, set largest rise to 370 mm'
    """
    text = re.sub(rf"(?:(?:give|use|set)\s+)?({_FLAGS.pattern})", _advised, text)
    return re.sub(r"--([a-z][a-z-]*\.[a-z][a-z0-9-]*)", lambda found: _called(found.group(1).replace("-", "_")), text)


def _advised(found: re.Match[str]) -> str:
    cure = _cure_of(found.group(1))
    return found.group(0) if cure is None else cure.words


def _called(name: str) -> str:
    """Return what a setting is called in a sentence; a name that is none stays as it is."""
    if name not in SETTINGS:
        return name
    setting = SETTINGS.setting(name)
    if not isinstance(setting, Knob):
        return f"the {setting.title.lower()}"
    return f"{setting.symbol} ({setting.title})" if setting.symbol else setting.title


def _cure_of(flags: str) -> Cure | None:
    """Return what some flags mean; None where one of them is no setting, or has a value that it cannot have."""
    try:
        changes = tuple(_change_of(flag, value) for flag, value in re.findall(_FLAG, flags))
        Cure("", changes).applied(Params())
    except (ConfigError, ValueError):
        return None
    return Cure(" and ".join(_setting_words(*change) for change in changes), changes)


def _change_of(flag: str, value: str) -> tuple[str, object]:
    """Return the name and the value of a setting, of the setting's own type.

    Raises
    ------
    ConfigError, ValueError
        There is no such setting, or its value is none.
    """
    name = flag.replace("-", "_")
    if name not in SETTINGS:
        raise ConfigError(f"{name}: unknown setting")
    kind = SETTINGS[name].kind
    return name, kind(value) if kind in (int, float) else value


def _setting_words(name: str, value: object) -> str:
    if name == "up":
        return f"up is {value}"
    if name == "unit":
        return f"the file is in {UNIT_NAMES.get(str(value), str(value))}"
    try:
        words = SETTINGS.knob(name).words(float(str(value)))
    except ConfigError:
        words = str(value)
    return f"set {_called(name)} to {words}"
