"""The stations of a file as it has them, and the one of them that a user names."""

import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from stair_inspector.errors import ReadError
from stair_inspector.geometry.arrays import Floats, Ints, Labels
from stair_inspector.model import Note, ScanStations

MOST_STATIONS = 1000
NAME_CHARACTERS = 200
"""Of a longer name only these are read."""
_SHOWN = 8


@dataclass(frozen=True, slots=True, eq=False)
class RawStations:
    """Which station saw each point, and where it stood.

    ``names`` (k) of all stations of the file in its order; ``of_point`` (n,) from 0 on; ``places`` (k, 3) in the file's
    unit and frame, NaN where the file does not say.
    """

    names: tuple[str, ...]
    of_point: Labels
    places: Floats

    def placed(self, rows: Ints, metres: float, origin_m: Floats) -> ScanStations:
        """Return the same of these points, in metres about an origin; the file's unit is so many metres."""
        return ScanStations(self.names, self.of_point[rows], self.places * metres - origin_m)


def find_station(names: Sequence[str], wanted: str) -> int:
    """Return the place of the station with this name, or with this number from 1 on.

    ``#2`` is always a number; ``2`` is one where no station has that name. Names may differ in case, and in how their
    accents are encoded.

    Raises
    ------
    ReadError
        There is none, or several have the name.
    """
    is_number = wanted.strip().startswith("#") and _is_count(wanted.strip()[1:])
    found = [] if is_number else [k for k, name in enumerate(names) if name == wanted]
    if not found and not is_number:
        sought = _folded(wanted)
        found = [k for k, name in enumerate(names) if _folded(name) == sought]
    if len(found) > 1:
        numbers = " and ".join(f"#{k + 1}" for k in found[:_SHOWN])
        more = f" and {len(found) - _SHOWN} more" if len(found) > _SHOWN else ""
        raise ReadError(f"has several stations named '{short_name(wanted)}'; give the number of one, {numbers}{more}")
    if found:
        return found[0]
    digits = wanted.strip().removeprefix("#")
    if _is_count(digits) and 1 <= int(digits) <= len(names):
        return int(digits) - 1
    raise ReadError(f"has no station '{short_name(wanted)}'; it has {listed(names)}: give a name, or a number as #1")


def asked_as(names: Sequence[str]) -> list[str]:
    """Return what :func:`find_station` finds each station by: its name where that is clear, else its number."""
    often = Counter(map(_folded, names))
    return [
        name if often[_folded(name)] == 1 and name == name.strip() and not name.startswith("#") else f"#{number}"
        for number, name in enumerate(names, start=1)
    ]


def _is_count(digits: str) -> bool:
    return digits.isascii() and digits.isdigit() and len(digits) < 6


def _folded(name: str) -> str:
    apart = unicodedata.normalize("NFD", name[:NAME_CHARACTERS].strip())
    return unicodedata.normalize("NFC", apart.casefold())


def stations_note(names: Sequence[str], counts: Sequence[int], chosen: Sequence[int]) -> Note:
    """Return the note that says which stations a file holds, and which of them are read."""
    if len(chosen) < len(names):
        (only,) = chosen
        message = f"station {only + 1} of {len(names)} was read: {listed([names[only]], [counts[only]])}"
    elif len(names) == 1:
        message = f"the file holds one station: {listed(names, counts)}"
    else:
        message = f"the file holds {len(names)} stations, taken together: {listed(names, counts)}"
    return Note("stations_read", "read", message)


def listed(names: Sequence[str], counts: Sequence[int] | None = None) -> str:
    """Return the names of stations, of many only the first, with how many points each has."""
    shown = [f"'{short_name(name)}'" for name in names[:_SHOWN]]
    if counts is not None:
        shown = [f"{name} ({count:,} points)" for name, count in zip(shown, counts, strict=False)]
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(shown) + more


def short_name(name: str) -> str:
    """Return the name of a station so that it fits into a sentence."""
    clean = "".join(letter if letter.isprintable() else "?" for letter in name[:41])
    return clean if len(name) <= 40 else f"{clean[:40]}..."
