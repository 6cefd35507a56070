"""What only the inspector knows: whose stair it is, with which instrument, which readings of a tape beside the scan.

All of it is text, readings and pictures that the user gives; what is left empty is a blank to fill in the report.
"""

import base64
import binascii
import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from stair_inspector.content.images import LARGEST_IMAGE_BYTES, Photo, photo_as_kept, read_logo, read_photo
from stair_inspector.content.readings import FLIGHT_READINGS, STEP_READINGS, TapeReading, parse_reading
from stair_inspector.content.texts import require_text
from stair_inspector.content.written import split_unit
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.toml import check_keys, read_toml

Paper = Literal["a4", "us-letter"]

MOST_READINGS = 200
MOST_PHOTOS = 12


def _text(label: str, hint: str = "") -> Any:
    """Return an empty text field; ``label`` stands before it in the report and on the page."""
    return field(default="", metadata={"label": label, "hint": hint})


@dataclass(frozen=True, slots=True)
class _Texts:
    """Texts that are checked and stripped when they are made; each has a label and a hint."""

    def __post_init__(self) -> None:
        for item in dataclasses.fields(self):
            object.__setattr__(self, item.name, require_text(getattr(self, item.name), item.name))

    @classmethod
    def label_of(cls, name: str) -> str:
        """Return how the field is called in the report and on the page."""
        return str(_metadata(cls, name)["label"])

    @classmethod
    def hint_of(cls, name: str) -> str:
        """Return what belongs into the field, empty where the label says it."""
        return str(_metadata(cls, name)["hint"])


def _metadata(kind: type[_Texts], name: str) -> Mapping[str, Any]:
    return next(item.metadata for item in dataclasses.fields(kind) if item.name == name)


@dataclass(frozen=True, slots=True)
class ReportFields(_Texts):
    """Identity, instrument and sign-off: one text each, empty for a blank to fill.

    Raises
    ------
    ConfigError
        A field is no text, too long, or holds what :func:`require_text` refuses.
    """

    title: str = _text("Title", "Heading of the report; empty for 'Stair survey report'")
    report_number: str = _text("Report no.")
    revision: str = _text("Revision")
    client: str = _text("Client")
    site: str = _text("Site")
    building: str = _text("Building")
    stair: str = _text("Stair")
    flight: str = _text("Flight", "The flights' names on site, from bottom to top")
    level_from: str = _text("Level from")
    level_to: str = _text("Level to")
    inspector: str = _text("Inspector")
    firm: str = _text("Firm")
    licence: str = _text("Licence")
    survey_date: str = _text("Survey date")
    survey_time: str = _text("Survey time")
    weather: str = _text("Weather", "Only where the stair is outdoors")
    surface: str = _text("Surface", "Dry, wet, icy, worn")
    obstructions: str = _text("Obstructions", "What stood on or before the stair")
    changes: str = _text("Changes since the incident", "Repairs, removals, cleaning, if any")
    purpose: str = _text("Purpose")
    scope: str = _text("Scope")
    code_reason: str = _text("Reason for this code", "Why this code, edition and variant apply")
    build_date: str = _text("Date built or altered")
    occupancy: str = _text("Occupancy or use")
    instrument_make: str = _text("Make")
    instrument_model: str = _text("Model")
    instrument_serial: str = _text("Serial no.")
    instrument_accuracy: str = _text("Stated accuracy", "As the maker states it")
    calibration_date: str = _text("Calibrated on")
    interim_check_date: str = _text("Last interim check", "Interim performance assessment: its date")
    interim_check_result: str = _text("Result of the interim check")
    stations: str = _text("Stations", "How many, and where they stood")
    registration_method: str = _text("Registration method")
    registration_residual: str = _text("Registration residual")
    levelling_source: str = _text("Levelling source", "Tilt sensor, level, plumb line, reference plane")
    limitations: str = _text("Further limitations")
    signed_by: str = _text("Name")
    signed_as: str = _text("Function")
    signed_on: str = _text("Date")
    reviewed_by: str = _text("Reviewed by")
    reviewed_on: str = _text("Reviewed on")


FIELD_GROUPS: dict[str, tuple[str, ...]] = {
    "Report": ("title", "report_number", "revision"),
    "Object": ("client", "site", "building", "stair", "flight", "level_from", "level_to"),
    "Survey": ("inspector", "firm", "licence", "survey_date", "survey_time"),
    "Conditions": ("weather", "surface", "obstructions", "changes"),
    "Commission": ("purpose", "scope", "occupancy", "build_date", "code_reason"),
    "Instrument": (
        "instrument_make",
        "instrument_model",
        "instrument_serial",
        "instrument_accuracy",
        "calibration_date",
        "interim_check_date",
        "interim_check_result",
    ),
    "Scanning": ("stations", "registration_method", "registration_residual", "levelling_source"),
    "Limitations": ("limitations",),
    "Sign-off": ("signed_by", "signed_as", "signed_on", "reviewed_by", "reviewed_on"),
}
"""Every field of :class:`ReportFields`, in the order and the groups of the report and the page."""
OF_THE_SURVEYOR = ("inspector", "firm", "licence", *FIELD_GROUPS["Instrument"])
"""Fields that are the same for the next stair of a survey."""
_OF_THE_SITE = ("client", "site", "building")


@dataclass(frozen=True, slots=True)
class Checklist(_Texts):
    """What no scan of treads shows, seen by eye or by hand: one text each, empty for *not assessed*.

    Raises
    ------
    ConfigError
        As :class:`ReportFields`.
    """

    slip_resistance: str = _text("Slip resistance of treads and nosings")
    nosing_contrast: str = _text("Contrast and visibility of the nosings")
    lighting: str = _text("Lighting and its switches")
    handrails: str = _text("Handrails: height, grip, continuity, extensions")
    guards: str = _text("Guards: height, openings, strength")
    clear_width: str = _text("Clear width between handrails or walls")
    headroom: str = _text("Headroom")
    landings: str = _text("Landings: size, doors that swing over them")
    tactile: str = _text("Tactile warning surfaces and signs")
    condition: str = _text("Condition: loose, cracked or worn parts, drainage")
    structure: str = _text("Structural capacity and fire resistance")


@dataclass(frozen=True, slots=True)
class ReportBasis:
    """All that a report takes from the user: fields, checklist, readings, logo (:func:`read_logo`), photos, paper."""

    fields: ReportFields = field(default_factory=ReportFields)
    checklist: Checklist = field(default_factory=Checklist)
    readings: tuple[TapeReading, ...] = ()
    logo: bytes | None = None
    photos: tuple[Photo, ...] = ()
    paper: Paper = "a4"

    def __post_init__(self) -> None:
        if self.paper not in get_args(Paper):
            raise ConfigError(f"paper: got {brief(self.paper)}; give one of {', '.join(get_args(Paper))}")
        for name, most in (("readings", MOST_READINGS), ("photos", MOST_PHOTOS)):
            entries = tuple(getattr(self, name))
            if len(entries) > most:
                raise ConfigError(f"{name}: {len(entries)} entries; give at most {most}")
            object.__setattr__(self, name, entries)


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
        photos.append(photo_as_kept(_from_base64(entry["base64"], where), entry.get("caption", ""), where))
    return ReportBasis(
        fields=_texts_from(ReportFields, table.get("fields", {}), f"{place}: fields"),
        checklist=_texts_from(Checklist, table.get("checklist", {}), f"{place}: checklist"),
        readings=tuple(readings),
        logo=None if logo is None else read_logo(_from_base64(logo, f"{place}: logo"), f"{place}: logo"),
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


def _from_base64(text: object, place: str) -> bytes:
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
