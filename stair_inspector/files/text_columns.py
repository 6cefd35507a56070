"""What the columns of a text are called: the names that programs and surveyors give to x, y and z, and their units."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import excerpt
from stair_inspector.params import KnownUnit

AXES = ("x", "y", "z")
_NAMES: Mapping[str, tuple[str, ...]] = {
    "x": ("easting", "eastings", "east", "e", "ost", "rechtswert", "rechts", "este", "est", "abscisse"),
    "y": ("northing", "northings", "north", "n", "nord", "hochwert", "hoch", "norte", "ordonnee"),
    "z": ("elevation", "elev", "height", "h", "hohe", "hoehe", "altitude", "alt", "hoogte", "cota", "quota"),
}
"""Names of coordinates in the field, in lower case, without accents, blanks and marks."""
_AROUND_AXIS = ("{}coord", "{}coordinate", "{}koordinate", "coord{}", "coordinate{}", "pos{}", "position{}", "point{}")
_OTHER_NAMES = {
    "rot": "red",
    "grun": "green",
    "gruen": "green",
    "blau": "blue",
    "r": "red",
    "g": "green",
    "b": "blue",
    "normalx": "nx",
    "normaly": "ny",
    "normalz": "nz",
}
_ROLES: dict[str, str] = {name: axis for axis, names in _NAMES.items() for name in names}
_ROLES |= {form.format(axis): axis for axis in AXES for form in _AROUND_AXIS}
# As ParaView calls the parts of a vector.
_ROLES |= {f"points{k}": axis for k, axis in enumerate(AXES)}
_ROLES |= _OTHER_NAMES
_UNIT_WORDS: Mapping[KnownUnit, tuple[str, ...]] = {
    "m": ("m", "meter", "meters", "metre", "metres"),
    "cm": ("cm", "centimeter", "centimeters", "centimetre", "centimetres", "zentimeter"),
    "mm": ("mm", "millimeter", "millimeters", "millimetre", "millimetres"),
    "in": ("in", "inch", "inches", "zoll"),
    "ft": ("ft", "feet", "foot", "usft", "ftus", "ussurveyfeet", "ussurveyfoot"),
}
_UNITS: dict[str, KnownUnit] = {word: unit for unit, words in _UNIT_WORDS.items() for word in words}
_BRACKETS = {"]": "[", ")": "(", ">": "<", "}": "{"}
_MARKS = re.compile(r"[^a-z0-9]+")
_ANY_SEPARATOR = re.compile(r"[,;|\s]+")
_BEFORE_BRACKET = re.compile(r"(?<=\S)[ \t]{1,9}(?=[\[(<{])")
_UNIT_REMARK = re.compile(
    r"(\w{0,30})\s{0,3}\bunits?\s{0,3}[:=]\s{0,3}(?:in\s{1,3}(?=[a-z]))?([a-z]+)(?![\w/*^])", re.IGNORECASE
)
_OTHER_UNIT = re.compile(
    r"angle|angular|rotation|intensit|reflect|amplitude|veloc|speed|time|temperature|colou?r|normal|area|density|pressure",
    re.IGNORECASE,
)
"""What a remark before "unit" may speak of beside lengths."""
_LABEL = re.compile(r"\s*([^\d,;|\t:]{1,40}):(?=\s)")
_DEGREES = frozenset(("lat", "latitude", "lon", "long", "lng", "longitude"))


@dataclass(frozen=True, slots=True)
class Header:
    """A line that names columns: ``roles`` as scans call them, else the names as they stand; ``units`` as written."""

    roles: tuple[str, ...]
    units: tuple[str, ...]

    @property
    def has_points(self) -> bool:
        """Whether x, y and z are among the roles."""
        return set(AXES) <= set(self.roles)

    def unit(self) -> KnownUnit | None:
        """Return the unit of the coordinates, None where none is written.

        Raises
        ------
        ReadError
            The axes are in different units, or in one that is not read.
        """
        written = {role: unit for role, unit in zip(self.roles, self.units, strict=True) if role in AXES and unit}
        units = {unit_of_word(unit) for unit in written.values()}
        if len(units) > 1:
            raise ReadError(
                f"its header gives its axes in different units ({excerpt(', '.join(written.values()))}); "
                "export the scan in metres"
            )
        if units == {None}:
            raise ReadError(
                f"its header gives coordinates in '{excerpt(next(iter(written.values())))}', which is not read; "
                "export the scan in metres"
            )
        return units.pop() if units else None


def unit_of_word(word: str) -> KnownUnit | None:
    """Return the unit that a word of a header or remark means; None for none."""
    return _UNITS.get(_MARKS.sub("", word.lower()))


def unit_of_remark(line: bytes) -> KnownUnit | None:
    """Return the unit that a remark such as ``# units: mm`` states; None where it states none."""
    for found in _UNIT_REMARK.finditer(decoded(line)):
        unit = unit_of_word(found.group(2))
        # "In" before a word or a number is no inch.
        is_preposition = found.group(2).lower() == "in" and found.string[found.end() :].strip()[:1].isalnum()
        if unit is not None and not is_preposition and _OTHER_UNIT.match(found.group(1)) is None:
            return unit
    return None


def without_label(line: bytes) -> bytes:
    """Return a line that may be a header without what leads it: "columns: x y z" names three."""
    text = decoded(line)
    label = _LABEL.match(text)
    if label is None or _MARKS.sub("", _folded(label.group(1))) in _ROLES or label.group(1).strip().lower() in AXES:
        return line
    return text[label.end() :].strip().encode()


def names_degrees(cells: Sequence[str]) -> bool:
    """Return whether cells name a latitude or longitude."""
    return any(_MARKS.sub("", _folded(_split_unit(cell)[0])) in _DEGREES for cell in cells)


def decoded(line: bytes) -> str:
    """Return a line of a file as text: UTF-8, or else Latin-1, which can hold any bytes."""
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def header_of(cells: Sequence[str]) -> Header:
    """Return what the cells of a line name.

    Raises
    ------
    ReadError
        Two columns could be the same axis, or have one name.
    """
    names, units = zip(*map(_split_unit, cells), strict=True) if cells else ((), ())
    plain = [_MARKS.sub("", _folded(name)) for name in names]
    is_exact = set(AXES) <= set(plain)
    roles = []
    for name, short in zip(names, plain, strict=True):
        role = _ROLES.get(short, "")
        is_other_axis = is_exact and role in AXES and short not in AXES
        known = short if short in AXES else role
        # Names that mean nothing here stay as they are, in case the clouds know them.
        roles.append(known if known and not is_other_axis else _folded(name))
    return Header(tuple(roles), tuple(units))


def header_cells(line: bytes, separator: bytes | None) -> list[str]:
    """Return the cells of a line that may be a header; None separates at white space, commas and semicolons alike."""
    text = decoded(line)
    if separator is None:
        parts = _ANY_SEPARATOR.split(_BEFORE_BRACKET.sub("", text))
        return [part.strip('"') for part in parts if part]
    return [part.strip().strip('"').strip() for part in text.split(separator.decode("ascii"))]


def names_points(line: bytes) -> bool:
    """Return whether a line names x, y and z, whatever separates them."""
    return header_of(header_cells(line, None)).has_points


def _folded(name: str) -> str:
    """Return a name in lower case and without accents."""
    letters = unicodedata.normalize("NFKD", name.lower())
    return "".join(letter for letter in letters if not unicodedata.combining(letter)).strip()


def _split_unit(cell: str) -> tuple[str, str]:
    """Return a name, and the unit that stands behind it: ``X [m]``, ``x(mm)``, ``x_mm``, ``x/m``, ``x in mm``."""
    opening = _BRACKETS.get(cell[-1:])
    if opening is not None:
        name, found, unit = cell[:-1].rpartition(opening)
        if not found or not name.strip():
            return cell, ""
        name, unit = name.strip(" _"), unit.strip()
        axis = _axis_of(name)
        # "X (East)" and "Easting (E)" say an axis twice.
        return name, "" if axis and axis == _axis_of(unit) else unit.removeprefix("in ").strip()
    for mark in ("_", "/", " in ", " "):
        name, found, unit = cell.rpartition(mark)
        if found and name.strip() and unit_of_word(unit) is not None:
            return name.strip(), unit
    return cell, ""


def _axis_of(name: str) -> str:
    """Return the axis that a name means, nothing for none."""
    short = _MARKS.sub("", _folded(name))
    axis = short if short in AXES else "z" if short == "up" else _ROLES.get(short, "")
    return axis if axis in AXES else ""
