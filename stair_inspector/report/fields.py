"""What only the inspector knows: whose stair it is, with which instrument, which readings of a tape beside the scan.

All of it is text, readings and pictures that the user gives; what is left empty is a blank to fill in the report.
"""

import base64
import binascii
import dataclasses
import datetime
import io
import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from stair_inspector.codes.rules import LENGTH_UNITS, is_plain_line, parse_written
from stair_inspector.errors import ConfigError
from stair_inspector.files.toml import check_keys, read_toml
from stair_inspector.params import METRES_PER_UNIT, brief
from stair_inspector.report.written import split_unit

Paper = Literal["a4", "us-letter"]
Line = Literal["left", "centre", "right"]

LONGEST_TEXT = 4000
"""Characters of one field: half a page."""
MOST_READINGS = 200
MOST_PHOTOS = 12
_LARGEST_IMAGE_BYTES = 20_000_000
_LARGEST_IMAGE_PIXELS = 60_000_000
_LOGO_PIXELS = (1200, 600)
_PHOTO_PIXELS = (1600, 1600)
"""What a picture is made smaller to: enough for print at the size at which the report shows it."""
_PHOTO_QUALITY = 85
_END_OF_JPEG = b"\xff\xd9"

STEP_QUANTITIES: dict[str, str] = {
    "rise": "m",
    "going": "m",
    "tread_depth": "m",
    "width": "m",
    "nosing_overhang": "m",
    "pitch": "deg",
    "fall": "deg",
    "cross_fall": "deg",
}
"""What can be read off one step by hand, and the unit that its value is kept in."""
FLIGHT_QUANTITIES: dict[str, str] = {"flight_rise": "m", "flight_run": "m", "pitch": "deg", "width": "m"}
"""What can be read off a whole flight by hand."""
_MAY_BE_NEGATIVE = ("fall", "cross_fall", "nosing_overhang")
"""Quantities with a direction; another one of zero or below is a slip of the pen."""
ON_A_LINE = ("rise", "going")
"""Quantities that are measured on three lines."""
_LONGEST_READING = {"m": 100.0, "deg": 90.0}
_LARGEST_NUMBER = 1e9
"""Of any reading in any unit."""
_SIZES = {**METRES_PER_UNIT, "deg": 1.0, "%": 0.01}
"""Units of readings in metres, degrees or as a tangent."""


def _text(label: str, hint: str = "") -> Any:
    """Return an empty text field; ``label`` stands before it in the report and on the page."""
    return field(default="", metadata={"label": label, "hint": hint})


@dataclass(frozen=True, slots=True)
class _Texts:
    """Texts that are checked and stripped when they are made; each has a label and a hint."""

    def __post_init__(self) -> None:
        for item in dataclasses.fields(self):
            object.__setattr__(self, item.name, check_text(getattr(self, item.name), item.name))

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
        A field is no text, too long, or holds what :func:`check_text` refuses.
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
class TapeReading:
    """One reading by hand, to be compared with the scan.

    ``quantity`` is a name of :data:`STEP_QUANTITIES` where ``step`` is given, else of :data:`FLIGHT_QUANTITIES` with
    ``flight``; ``value`` is in metres or degrees, ``u`` its expanded uncertainty (k = 2) where known; ``line`` is the
    measuring line of a rise or going. ``at`` is the middle of the step's tread, scan frame, metres, where it is known:
    the number of a step may change with the settings, its place does not.

    Raises
    ------
    ConfigError
        Unknown quantity, neither or both of step and flight, a place of a flight or one that is none, or a value that
        no stair has.
    """

    quantity: str
    value: float
    step: int | None = None
    flight: int | None = None
    line: Line = "centre"
    u: float | None = None
    instrument: str = ""
    note: str = ""
    at: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        place = f"reading of {brief(self.quantity)}"
        if (self.step is None) == (self.flight is None):
            raise ConfigError(f"{place}: give either step or flight, a number from 1")
        known = STEP_QUANTITIES if self.flight is None else FLIGHT_QUANTITIES
        check_keys("reading", [str(self.quantity)], known, "quantity")
        for name in ("step", "flight"):
            number = getattr(self, name)
            if number is not None and (type(number) is not int or not 1 <= number <= 10_000):
                raise ConfigError(f"{place}: {name}: got {brief(number)}; give a whole number from 1")
        if self.line not in get_args(Line):
            raise ConfigError(f"{place}: line: got {brief(self.line)}; give one of {', '.join(get_args(Line))}")
        if self.line != "centre" and self.quantity not in ON_A_LINE:
            raise ConfigError(
                f"{place}: line: only {' and '.join(ON_A_LINE)} are measured on three lines; leave it out"
            )
        unit = known[self.quantity]
        has_sign = self.quantity in _MAY_BE_NEGATIVE
        value = _check_number(self.value, f"{place}: value", unit, has_sign=has_sign)
        object.__setattr__(self, "value", value)
        if self.u is not None:
            object.__setattr__(self, "u", _check_number(self.u, f"{place}: u", unit))
        if self.at is not None:
            object.__setattr__(self, "at", _check_place(self.at, f"{place}: at", is_of_step=self.step is not None))
        for name in ("instrument", "note"):
            object.__setattr__(self, name, check_text(getattr(self, name), f"{place}: {name}"))

    @property
    def unit(self) -> str:
        """The unit of ``value``: ``m`` or ``deg``."""
        return (STEP_QUANTITIES if self.flight is None else FLIGHT_QUANTITIES)[self.quantity]


@dataclass(frozen=True, slots=True)
class Photo:
    """A photograph of the site with its caption: ``data`` are the bytes of a JPEG or PNG (:func:`read_photo`)."""

    data: bytes
    caption: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "caption", check_text(self.caption, "a photo's caption"))


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


def check_text(value: object, name: str) -> str:
    """Return a user's text without blanks at its ends; a date or time, as TOML knows them, is written as in ISO 8601.

    Raises
    ------
    ConfigError
        No text, longer than :data:`LONGEST_TEXT`, or with control characters, half letters or marks that turn the
        direction of reading.
    """
    if isinstance(value, (datetime.date, datetime.time)):
        value = value.isoformat()
    if not isinstance(value, str):
        raise ConfigError(f"{name}: got {brief(value)}; give a text in quotes")
    text = value.replace("\r\n", "\n").replace("\r", "\n").replace("\t", " ").strip()
    if len(text) > LONGEST_TEXT:
        raise ConfigError(f"{name}: {len(text):,} characters; give at most {LONGEST_TEXT:,}")
    broken = next((letter for letter in text if letter != "\n" and not is_plain_line(letter)), "")
    if broken:
        raise ConfigError(
            f"{name}: holds a control character, half a letter or a mark that turns the direction of reading, "
            f"{broken!a}; take it out"
        )
    return text


def _check_number(value: object, place: str, unit: str, *, has_sign: bool = False, written: str = "") -> float:
    """Return a size in metres or degrees; ``written`` is what the message repeats of it."""
    most = _LONGEST_READING[unit]
    said = written or brief(value)
    # A comparison with something that is no number is False; a whole number may be too long for a float.
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -most <= value <= most:
        raise ConfigError(f"{place}: got {said}; give a number of at most {most:g} {unit}")
    if value <= 0.0 and not has_sign:
        raise ConfigError(f"{place}: got {said}; give a number above 0")
    return float(value)


def _check_place(value: object, place: str, *, is_of_step: bool) -> tuple[float, float, float]:
    if not is_of_step:
        raise ConfigError(f"{place}: only a step has a place; leave it out")
    numbers = [number for number in value if type(number) in (int, float)] if isinstance(value, (list, tuple)) else []
    if len(numbers) != 3 or not isinstance(value, (list, tuple)) or len(value) != 3:
        raise ConfigError(f"{place}: got {brief(value)}; give x, y and z in metres")
    if not all(-_LARGEST_NUMBER <= number <= _LARGEST_NUMBER for number in numbers):
        raise ConfigError(f"{place}: got {brief(value)}; give x, y and z in metres")
    x, y, z = map(float, numbers)
    return x, y, z


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
        photos.append(_photo_as_kept(_from_base64(entry["base64"], where), entry.get("caption", ""), where))
    return ReportBasis(
        fields=_texts_from(ReportFields, table.get("fields", {}), f"{place}: fields"),
        checklist=_texts_from(Checklist, table.get("checklist", {}), f"{place}: checklist"),
        readings=tuple(readings),
        logo=None if logo is None else read_logo(_from_base64(logo, f"{place}: logo"), f"{place}: logo"),
        photos=tuple(photos),
        paper=table.get("paper", "a4"),
    )


def parse_reading(written: str | float, unit: str, quantity: str, place: str = "value", *, is_u: bool = False) -> float:
    """Return a reading as it was given, ``"6 11/16"`` inches or 170.5 mm, in metres or degrees.

    Parameters
    ----------
    written : str or float
        A number, or a text with a number or a fraction; a unit written behind it counts before ``unit``.
    unit : str
        A unit of length; for an angle ``deg``, or ``%`` for a slope as a level shows it.
    quantity : str
        A name of :data:`STEP_QUANTITIES` or :data:`FLIGHT_QUANTITIES`.
    is_u : bool
        Whether it is the uncertainty of a reading, which has no direction.

    Raises
    ------
    ConfigError
        Not a number, a unit that does not fit the quantity, or a size that no stair has.
    """
    kept_in = {**STEP_QUANTITIES, **FLIGHT_QUANTITIES}.get(quantity, "deg")
    number, own_unit = split_unit(written, place) if isinstance(written, str) else (written, "")
    unit = own_unit or unit
    units = LENGTH_UNITS if kept_in == "m" else ("deg", "%")
    if unit not in units:
        raise ConfigError(f"{place}: unit: got {brief(unit)}; give one of {', '.join(units)}")
    if isinstance(number, str):
        value = _size_of(number, unit, place)
    elif isinstance(number, bool) or not isinstance(number, (int, float)):
        raise ConfigError(f'{place}: got {brief(written)}; give a number, or a text such as "6 11/16"')
    else:
        # Out of any range, and too long for a float.
        value = number if abs(number) > _LARGEST_NUMBER else number * _SIZES[unit]
    said = f"{number if isinstance(number, str) else brief(number)} {unit}"
    if unit == "%" and -_LARGEST_NUMBER <= value <= _LARGEST_NUMBER:
        value = math.degrees(math.atan(value))
    return _check_number(value, place, kept_in, has_sign=quantity in _MAY_BE_NEGATIVE and not is_u, written=said)


def _size_of(number: str, unit: str, place: str) -> float:
    """Return what a text with a sign says, in metres, degrees or as a tangent."""
    sign, digits = (-1.0, number[1:].strip()) if number[:1] in ("-", "−") else (1.0, number)
    try:
        return sign * float(parse_written(digits, unit))
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def read_logo(data: bytes, place: str = "logo") -> bytes:
    """Return a logo as PNG, made small enough for the head of a page.

    Raises
    ------
    ConfigError
        Not a PNG or JPEG, damaged, or too large.
    """
    return _redrawn(data, place, _LOGO_PIXELS, "PNG")


def read_photo(data: bytes, caption: str = "", place: str = "photo") -> Photo:
    """Return a photograph as JPEG, upright, without the place and time that cameras hide in it.

    Raises
    ------
    ConfigError
        Not a PNG or JPEG, damaged, or too large.
    """
    return Photo(_redrawn(data, place, _PHOTO_PIXELS, "JPEG"), caption)


def _photo_as_kept(data: bytes, caption: str, place: str) -> Photo:
    """Return a photograph of a project: as it is where it was redrawn before, since each time would cost some of it."""
    return Photo(data, caption) if _is_redrawn(data) else read_photo(data, caption, place)


def _is_redrawn(data: bytes) -> bool:
    """Return whether a picture is a JPEG as :func:`read_photo` makes them, sound, small enough and nothing hidden."""
    from PIL import Image, JpegImagePlugin

    if len(data) > _LARGEST_IMAGE_BYTES:
        return False
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(data), formats=("JPEG",)) as picture:
                assert isinstance(picture, JpegImagePlugin.JpegImageFile)
                has_room = all(2 <= size <= most for size, most in zip(picture.size, _PHOTO_PIXELS, strict=True))
                # Places and times, comments and profiles stand in segments of their own.
                is_bare = [name for name, _ in picture.applist] == ["APP0"] and data.endswith(_END_OF_JPEG)
                if not has_room or not is_bare or picture.mode != "RGB":
                    return False
                picture.load()
    except (OSError, ValueError, SyntaxError, Warning, Image.DecompressionBombError):
        return False
    return True


def _redrawn(data: bytes, place: str, most_pixels: tuple[int, int], kind: Literal["PNG", "JPEG"]) -> bytes:
    from PIL import Image, ImageOps

    if len(data) > _LARGEST_IMAGE_BYTES:
        raise ConfigError(f"{place}: larger than {_LARGEST_IMAGE_BYTES // 1_000_000} MB; give a smaller picture")
    try:
        with warnings.catch_warnings():
            # Pillow only warns of a picture that would fill the memory.
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
                if picture.width * picture.height > _LARGEST_IMAGE_PIXELS:
                    raise ConfigError(f"{place}: {picture.width} x {picture.height} pixels; give a smaller picture")
                upright = ImageOps.exif_transpose(picture)
                drawn = upright.convert("RGBA" if kind == "PNG" else "RGB")
    except ConfigError:
        raise
    except (OSError, ValueError, SyntaxError, Warning, Image.DecompressionBombError) as error:
        raise ConfigError(f"{place}: is not a PNG or JPEG picture that can be read; give another file") from error
    if min(drawn.size) < 2:
        raise ConfigError(f"{place}: {drawn.width} x {drawn.height} pixels; give a larger picture")
    drawn.thumbnail(most_pixels)
    # It would be written again.
    drawn.info.pop("comment", None)
    stream = io.BytesIO()
    drawn.save(stream, kind, quality=_PHOTO_QUALITY, optimize=True)
    return stream.getvalue()


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
    check_keys(place, [quantity], {**STEP_QUANTITIES, **FLIGHT_QUANTITIES}, "quantity")
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
            return stream.read(_LARGEST_IMAGE_BYTES + 1)
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
