"""Pins, and what was said of the findings of the program, as the plain values of a project file."""

import base64
import dataclasses
from collections.abc import Callable
from typing import Any, TypeVar

from stair_inspector.content.basis_files import picture_from_base64
from stair_inspector.content.images import Photo, kept_photo
from stair_inspector.content.pins import (
    MOST_DECISIONS,
    MOST_PIN_PHOTOS,
    MOST_PINS,
    FindingDecision,
    Pin,
    PinnedFindings,
)
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.toml import as_table, check_keys

_Made = TypeVar("_Made")
_PIN_KEYS = ("guid", "text", "severity", "place_m")
_PIN_LATER = ("step", "is_done", "who", "made_at", "photo_base64")
_DECISION_LATER = tuple(field.name for field in dataclasses.fields(FindingDecision) if field.name != "key")


def pinned_to_dict(findings: PinnedFindings) -> dict[str, Any]:
    """Return findings as plain values; what is empty is left out."""
    values: dict[str, Any] = {
        "pins": [_pin_to_dict(pin) for pin in findings.pins],
        "decisions": [
            {name: value for name, value in dataclasses.asdict(each).items() if value} for each in findings.decisions
        ],
    }
    return {name: entries for name, entries in values.items() if entries}


def pinned_from_dict(values: object, place: str = "findings") -> PinnedFindings:
    """Return what :func:`pinned_to_dict` wrote.

    Raises
    ------
    ConfigError
        Unknown or missing keys (the nearest known name is given), or values that are not possible.
    """
    if not isinstance(values, dict):
        raise ConfigError(f"{place}: got {brief(values)}; give a table")
    check_keys(place, values, ("pins", "decisions"))
    return PinnedFindings(
        tuple(
            _pin_from(entry, f"{place}: pin {number}")
            for number, entry in enumerate(_entries(values.get("pins", []), f"{place}: pins", MOST_PINS), 1)
        ),
        tuple(
            _decision_from(entry, f"{place}: decision {number}")
            for number, entry in enumerate(
                _entries(values.get("decisions", []), f"{place}: decisions", MOST_DECISIONS), 1
            )
        ),
    )


def _entries(values: object, place: str, most: int) -> list[Any]:
    if not isinstance(values, list):
        raise ConfigError(f"{place}: got {brief(values)}; give a list")
    # Before a picture of any of them is opened.
    n_photos = sum("photo_base64" in entry for entry in values if isinstance(entry, dict))
    if n_photos > MOST_PIN_PHOTOS:
        raise ConfigError(f"{place}: got {n_photos} photographs; keep at most {MOST_PIN_PHOTOS}, delete some")
    if len(values) > most:
        raise ConfigError(f"{place}: got {len(values):,}; keep at most {most}, delete some")
    return values


def _pin_to_dict(pin: Pin) -> dict[str, Any]:
    names = (*_PIN_KEYS, *_PIN_LATER[:-1])
    values = {name: getattr(pin, name) for name in names}
    values["place_m"] = list(pin.place_m)
    if pin.photo is not None:
        values["photo_base64"] = base64.b64encode(pin.photo.data).decode("ascii")
    return {name: value for name, value in values.items() if name in _PIN_KEYS or value}


def _pin_from(entry: object, place: str) -> Pin:
    given = dict(as_table(entry, place, _PIN_KEYS, _PIN_LATER))
    picture = given.pop("photo_base64", None)
    photo: Photo | None = None
    if picture is not None:
        photo = kept_photo(picture_from_base64(picture, f"{place}: photo"), f"{place}: photo")
    return _made(place, lambda: Pin(**given, photo=photo))


def _decision_from(entry: object, place: str) -> FindingDecision:
    given = as_table(entry, place, ("key",), _DECISION_LATER)
    return _made(place, lambda: FindingDecision(**given))


def _made(place: str, make: Callable[[], _Made]) -> _Made:
    try:
        return make()
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error
