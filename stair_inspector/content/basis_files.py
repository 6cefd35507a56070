"""What the user gave for a report, read from a TOML file and from a project, and kept in one."""

import base64
import binascii
import dataclasses
from pathlib import Path
from typing import Any

from stair_inspector.content.fields import OF_THE_SURVEYOR, Checklist, ReportBasis, ReportFields
from stair_inspector.content.images import LARGEST_IMAGE_BYTES, Photo, photo_as_kept, read_logo, read_photo
from stair_inspector.content.readings import FLIGHT_READINGS, STEP_READINGS, TapeReading, parse_reading
from stair_inspector.content.written import split_unit
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.toml import check_keys, read_toml

_OF_THE_SITE = ("client", "site", "building")


def read_basis(path: Path) -> ReportBasis:
    """Read what a report takes from the user, from a TOML file.

    Tables ``[fields]`` and ``[checklist]`` hold texts by name, ``[[readings]]`` a quantity, step or flight, value and
    unit each, ``[[photos]]`` a file and a caption; ``logo`` names a picture, ``paper`` is ``a4`` or ``us-letter``.
    Names of files are relative to the TOML file.

    Raises
    ------
    ConfigError
        Not readable, no TOML, an unknown key (the nearest known name is given), a value that is not possible, or a
        picture that is none.
    """
    values = read_toml(path)
    place = str(path)
    check_keys(place, values, ("fields", "checklist", "readings", "photos", "logo", "paper"))
    logo = values.get("logo")
    try:
        return ReportBasis(
            fields=_texts_from(ReportFields, values.get("fields", {}), "[fields]"),
            checklist=_texts_from(Checklist, values.get("checklist", {}), "[checklist]"),
            readings=tuple(
                _reading_from(entry, f"[[readings]] {number}")
                for number, entry in enumerate(_tables(values.get("readings", []), "[[readings]]"), 1)
            ),
            logo=None if logo is None else read_logo(_bytes_of(path.parent, logo, "logo"), f"logo {brief(logo)}"),
            photos=tuple(
                _photo_from(entry, path.parent, f"[[photos]] {number}")
                for number, entry in enumerate(_tables(values.get("photos", []), "[[photos]]"), 1)
            ),
            paper=values.get("paper", "a4"),
        )
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def entries_of_one_stair(basis: ReportBasis) -> tuple[str, ...]:
    """Return what is given that can not be true of every stair of a survey, by its name in the file."""
    shared = (*OF_THE_SURVEYOR, *_OF_THE_SITE)
    fields = (name for name in _filled(basis.fields) if name not in shared)
    lists = (name for name in ("readings", "photos") if getattr(basis, name))
    return (*fields, *_filled(basis.checklist), *lists)


def basis_to_dict(basis: ReportBasis) -> dict[str, Any]:
    """Return what the user gave as plain values for a project file; what is empty is left out."""
    readings = [
        {name: value for name, value in dataclasses.asdict(reading).items() if value not in (None, "")}
        for reading in basis.readings
    ]
    values: dict[str, Any] = {
        "fields": _filled(basis.fields),
        "checklist": _filled(basis.checklist),
        "readings": readings,
        "logo_base64": None if basis.logo is None else base64.b64encode(basis.logo).decode("ascii"),
        "photos": [
            {"caption": photo.caption, "base64": base64.b64encode(photo.data).decode("ascii")} for photo in basis.photos
        ],
        "paper": basis.paper,
    }
    return {name: value for name, value in values.items() if value}


def basis_from_dict(values: object, place: str = "report") -> ReportBasis:
    """Return what :func:`basis_to_dict` wrote.

    Raises
    ------
    ConfigError
        Unknown keys (the nearest known name is given), or values that are not possible.
    """
    table = _table(values, place)
    check_keys(place, table, ("fields", "checklist", "readings", "logo_base64", "photos", "paper"))
    logo = table.get("logo_base64")
    readings = []
    for number, entry in enumerate(_tables(table.get("readings", []), f"{place}: readings"), 1):
        names = [item.name for item in dataclasses.fields(TapeReading)]
        check_keys(f"{place}: reading {number}", entry, names)
        _check_named(f"{place}: reading {number}", entry, ("quantity", "value"))
        readings.append(TapeReading(**entry))
    photos = []
    for number, entry in enumerate(_tables(table.get("photos", []), f"{place}: photos"), 1):
        where = f"{place}: photo {number}"
        check_keys(where, entry, ("caption", "base64"))
        _check_named(where, entry, ("base64",))
        photos.append(photo_as_kept(picture_from_base64(entry["base64"], where), entry.get("caption", ""), where))
    return ReportBasis(
        fields=_texts_from(ReportFields, table.get("fields", {}), f"{place}: fields"),
        checklist=_texts_from(Checklist, table.get("checklist", {}), f"{place}: checklist"),
        readings=tuple(readings),
        logo=None if logo is None else read_logo(picture_from_base64(logo, f"{place}: logo"), f"{place}: logo"),
        photos=tuple(photos),
        paper=table.get("paper", "a4"),
    )


def _texts_from(kind: type[Any], values: object, place: str) -> Any:
    table = _table(values, place)
    check_keys(place, table, [item.name for item in dataclasses.fields(kind)])
    try:
        return kind(**table)
    except ConfigError as error:
        raise ConfigError(f"{place} {error}") from error


def _reading_from(entry: dict[str, Any], place: str) -> TapeReading:
    names = [item.name for item in dataclasses.fields(TapeReading)]
    check_keys(place, entry, [*names, "unit"])
    _check_named(place, entry, ("quantity", "value", "unit"))
    given = dict(entry)
    unit = given.pop("unit")
    quantity = str(given["quantity"])
    # Said before the unit is asked for: the unit follows from the quantity.
    check_keys(place, [quantity], {**STEP_READINGS, **FLIGHT_READINGS}, "quantity")
    for name in ("value", "u"):
        if name in given:
            given[name] = _read_size(given[name], unit, quantity, f"{place}: {name}", is_u=name == "u")
    try:
        return TapeReading(**given)
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _read_size(written: str | float, unit: str, quantity: str, place: str, *, is_u: bool) -> float:
    own_unit = split_unit(written, place)[1] if isinstance(written, str) else ""
    if own_unit not in ("", unit):
        raise ConfigError(f"{place}: got {brief(written)} and the unit {brief(unit)}; give the same unit in both")
    return parse_reading(written, unit, quantity, place, is_u=is_u)


def _photo_from(entry: dict[str, Any], folder: Path, place: str) -> Photo:
    check_keys(place, entry, ("file", "caption"))
    _check_named(place, entry, ("file",))
    return read_photo(
        _bytes_of(folder, entry["file"], place), entry.get("caption", ""), f"{place} {brief(entry['file'])}"
    )


def _bytes_of(folder: Path, name: object, place: str) -> bytes:
    if not isinstance(name, str) or not name:
        raise ConfigError(f"{place}: got {brief(name)}; give the name of a picture in quotes")
    path = folder / name
    try:
        # Opening a pipe would wait for ever.
        if not path.is_file():
            raise ConfigError(f"{place}: {path} is no file; check the name")
        with path.open("rb") as stream:
            return stream.read(LARGEST_IMAGE_BYTES + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"{place}: {brief(name)} cannot be read; check the name") from error


def picture_from_base64(text: object, place: str) -> bytes:
    """Return the bytes of a picture of a project file, not looked at yet.

    Raises
    ------
    ConfigError
        It is no text in base64.
    """
    try:
        return base64.b64decode(text if isinstance(text, str) else "?", validate=True)
    except (binascii.Error, ValueError) as error:
        raise ConfigError(f"{place}: is no picture in base64; take it out") from error


def _filled(texts: ReportFields | Checklist) -> dict[str, str]:
    return {name: text for name, text in dataclasses.asdict(texts).items() if text}


def _table(values: object, place: str) -> dict[str, Any]:
    if not isinstance(values, dict):
        raise ConfigError(f"{place}: got {brief(values)}; give a table")
    return values


def _tables(values: object, place: str) -> list[dict[str, Any]]:
    if not isinstance(values, list) or not all(isinstance(entry, dict) for entry in values):
        raise ConfigError(f"{place}: got {brief(values)}; give one table for each")
    return values


def _check_named(place: str, entry: dict[str, Any], names: tuple[str, ...]) -> None:
    missing = [name for name in names if name not in entry]
    if missing:
        raise ConfigError(f"{place}: {missing[0]} is missing; add it")
