"""What an inspector finds on a stair, and what is said of the findings of the program: values, checked when made."""

import dataclasses
import re
from collections import Counter
from dataclasses import dataclass
from datetime import datetime
from typing import Literal, get_args

from stair_inspector.codes.texts import is_plain_line
from stair_inspector.content.images import Photo, read_photo
from stair_inspector.content.texts import require_text
from stair_inspector.errors import ConfigError, brief, one_of
from stair_inspector.files.projects import point_from
from stair_inspector.geometry.arrays import Point

PinSeverity = Literal["info", "minor", "major", "critical"]
PIN_SEVERITIES: tuple[PinSeverity, ...] = get_args(PinSeverity)
"""From the least to the gravest; the program itself calls nothing critical."""
MOST_PINS = 200
MOST_DECISIONS = 1000
MOST_PIN_PHOTOS = 60
MOST_PIN_PHOTO_BYTES = 8_000_000
"""Of the photographs of all pins together: with those of the report they fit into a project file."""
LONGEST_PIN_TEXT = 1000
_LONGEST_NAME, _LONGEST_KEY = 100, 250
"""A key holds the ids of a rule set and of a rule, 80 characters each, and a place."""
_PHOTO_PIXELS = (1000, 1000)
"""A pin's photograph stands small in a report."""
_GUID = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")


@dataclass(frozen=True, slots=True)
class Pin:
    """What an inspector found at a step or a point.

    ``guid`` is its identity in other programs; ``place_m`` lies in the scan's own frame, metres: the middle of the
    tread where ``step`` is given, whose number may change with the settings. ``made_at`` is ISO 8601 with its offset.

    Raises
    ------
    ConfigError
        A value is not possible: one sentence.
    """

    guid: str
    text: str
    severity: PinSeverity
    place_m: Point
    step: int | None = None
    is_done: bool = False
    who: str = ""
    made_at: str = ""
    photo: Photo | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.guid, str) or not _GUID.fullmatch(self.guid):
            raise ConfigError(f"pin: guid: got {brief(self.guid)}; give 32 digits 0-9, a-f in the form of a UUID")
        _set(self, "text", _text_of(self.text, "a pin's text", may_be_empty=False))
        one_of(self.severity, PIN_SEVERITIES, "pin: severity")
        _set(self, "place_m", point_from(self.place_m, "pin: place_m"))
        if self.step is not None and (type(self.step) is not int or not 1 <= self.step <= 10_000):
            raise ConfigError(f"pin: step: got {brief(self.step)}; give a whole number from 1")
        _check_common(self, "pin", self.made_at)
        if self.photo is not None and not isinstance(self.photo, Photo):
            raise ConfigError("pin: photo: give a photograph")


@dataclass(frozen=True, slots=True)
class FindingDecision:
    """What an inspector says of a finding of the program, kept by its ``key``: it outlasts the next run.

    ``where`` and ``text`` are what the finding said when this was decided; ``severity`` None leaves the program's own.
    ``decided_at`` is ISO 8601 with its offset.

    Raises
    ------
    ConfigError
        A value is not possible: one sentence.
    """

    key: str
    where: str = ""
    text: str = ""
    severity: PinSeverity | None = None
    is_done: bool = False
    remark: str = ""
    who: str = ""
    decided_at: str = ""

    def __post_init__(self) -> None:
        for name, most in (("key", _LONGEST_KEY), ("where", _LONGEST_NAME)):
            _set(self, name, _line_of(getattr(self, name), f"finding: {name}", most))
        if not self.key:
            raise ConfigError("finding: key: is empty; give the key of a finding")
        for name in ("text", "remark"):
            _set(self, name, _text_of(getattr(self, name), f"finding: {name}"))
        if self.severity is not None:
            one_of(self.severity, PIN_SEVERITIES, "finding: severity")
        _check_common(self, "finding", self.decided_at)

    @property
    def says_nothing(self) -> bool:
        """Whether the finding is as the program made it."""
        return not (self.is_done or self.remark or self.severity)


@dataclass(frozen=True, slots=True)
class PinnedFindings:
    """Everything that an inspector set or said among the findings of one scan.

    Raises
    ------
    ConfigError
        There are too many, two have the same identity, or the photographs are too large together.
    """

    pins: tuple[Pin, ...] = ()
    decisions: tuple[FindingDecision, ...] = ()

    def __post_init__(self) -> None:
        for name, most, entries in (
            ("pins", MOST_PINS, self.pins),
            ("findings with a remark", MOST_DECISIONS, self.decisions),
        ):
            if len(entries) > most:
                raise ConfigError(f"findings: {len(entries)} {name}; keep at most {most}, delete some")
        names = Counter([*(pin.guid for pin in self.pins), *(each.key for each in self.decisions)])
        twice = next((name for name, count in names.items() if count > 1), None)
        if twice is not None:
            raise ConfigError(f"findings: {twice!r} stands twice; keep one of them")
        photos = [pin.photo.data for pin in self.pins if pin.photo is not None]
        if len(photos) > MOST_PIN_PHOTOS:
            raise ConfigError(f"photograph: {len(photos)} of pins; keep at most {MOST_PIN_PHOTOS}, delete one first")
        n_bytes = sum(map(len, photos))
        if n_bytes > MOST_PIN_PHOTO_BYTES:
            raise ConfigError(
                f"photograph: those of all pins have {n_bytes / 1e6:.1f} MB together; keep at most "
                f"{MOST_PIN_PHOTO_BYTES / 1e6:.0f} MB, delete one first"
            )

    def with_pin(self, pin: Pin) -> "PinnedFindings":
        """Return these with a pin in the place of the one of the same identity, or behind all."""
        known = [each.guid for each in self.pins]
        if pin.guid not in known:
            return dataclasses.replace(self, pins=(*self.pins, pin))
        at = known.index(pin.guid)
        return dataclasses.replace(self, pins=(*self.pins[:at], pin, *self.pins[at + 1 :]))

    def with_decision(self, decision: FindingDecision) -> "PinnedFindings":
        """Return these with what is said of a finding now; what says nothing is not kept."""
        others = tuple(each for each in self.decisions if each.key != decision.key)
        return dataclasses.replace(self, decisions=others if decision.says_nothing else (*others, decision))

    def without(self, key: str) -> "PinnedFindings":
        """Return these without the pin of an identity, or without what was said of the finding of a key."""
        return PinnedFindings(
            tuple(pin for pin in self.pins if pin.guid != key),
            tuple(each for each in self.decisions if each.key != key),
        )


def read_pin_photo(data: bytes, place: str) -> Photo:
    """Return a photograph for a pin, as :func:`~stair_inspector.content.images.read_photo`, but smaller."""
    return read_photo(data, "", place, _PHOTO_PIXELS)


def _check_common(value: Pin | FindingDecision, what: str, moment: str) -> None:
    if type(value.is_done) is not bool:
        raise ConfigError(f"{what}: is_done: got {brief(value.is_done)}; give true or false")
    _set(value, "who", _line_of(value.who, f"{what}: who", _LONGEST_NAME))
    if moment and not _is_moment(moment):
        raise ConfigError(f"{what}: got the time {brief(moment)}; give one as 2026-01-31T09:30:00+00:00")


def _is_moment(moment: object) -> bool:
    try:
        return isinstance(moment, str) and len(moment) <= 40 and datetime.fromisoformat(moment).tzinfo is not None
    except ValueError:
        return False


def _text_of(value: object, name: str, *, may_be_empty: bool = True) -> str:
    text = require_text(value, name)
    if len(text) > LONGEST_PIN_TEXT:
        raise ConfigError(f"{name}: {len(text):,} characters; give at most {LONGEST_PIN_TEXT:,}")
    if not text and not may_be_empty:
        raise ConfigError(f"{name}: is empty; write what was found")
    return text


def _line_of(value: object, name: str, most: int) -> str:
    text = require_text(value, name)
    if len(text) > most:
        raise ConfigError(f"{name}: {len(text):,} characters; give at most {most}")
    if not is_plain_line(text):
        raise ConfigError(f"{name}: holds a line break; write it on one line")
    return text


def _set(value: object, name: str, kept: object) -> None:
    object.__setattr__(value, name, kept)
