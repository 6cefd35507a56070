"""The stations of a file as it has them, and the one of them that a user names."""

from collections.abc import Sequence
from dataclasses import dataclass

from stair_inspector.errors import ReadError
from stair_inspector.geometry.arrays import Floats, Labels
from stair_inspector.model import Note

MOST_STATIONS = 1000
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


def find_station(names: Sequence[str], wanted: str) -> int:
    """Return the place of the station with this name, or with this number from 1 on.

    Raises
    ------
    ReadError
        There is none, or several have the name.
    """
    found = [k for k, name in enumerate(names) if name == wanted]
    found = found or [k for k, name in enumerate(names) if name.casefold() == wanted.strip().casefold()]
    if len(found) > 1:
        numbers = " and ".join(str(k + 1) for k in found[:_SHOWN])
        raise ReadError(f"has several stations named '{_short(wanted)}'; give the number of one, {numbers}")
    if found:
        return found[0]
    digits = wanted.strip()
    if digits.isascii() and digits.isdigit() and len(digits) < 6 and 1 <= int(digits) <= len(names):
        return int(digits) - 1
    raise ReadError(f"has no station '{_short(wanted)}'; it has {listed(names)}: give a name, or a number from 1 on")


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
    shown = [f"'{_short(name)}'" for name in names[:_SHOWN]]
    if counts is not None:
        shown = [f"{name} ({count:,} points)" for name, count in zip(shown, counts, strict=False)]
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(shown) + more


def _short(name: str) -> str:
    clean = "".join(letter if letter.isprintable() else "?" for letter in name[:41])
    return clean if len(name) <= 40 else f"{clean[:40]}..."
