"""Reading E57: every station of a file, each laid where its pose says.

The library that knows the format, libE57Format by way of pye57, runs in a process of its own, which reads in blocks:
it takes the file, 35 bytes for each point, and half a gigabyte at most besides.
"""

import importlib.util
from collections.abc import Sequence

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.e57_process import E57Block, E57Process, E57Station
from stair_inspector.files.raw_cloud import READ_STAGE, TRUNCATED_HINT, RawCloud, ScanFormat, as_intensities
from stair_inspector.files.raw_stations import RawStations, find_station, short_name, stations_note
from stair_inspector.geometry.arrays import Colors, Floats, Labels
from stair_inspector.model import Note

_MAGIC = b"ASTM-E57"
_HEADER_BYTES = 48


def is_e57(data: bytes) -> bool:
    """Return whether a file begins as E57 does."""
    return data.startswith(_MAGIC)


def read_e57(data: bytes, station: str = "") -> RawCloud:
    """Read the stations of an E57, or one of them.

    Parameters
    ----------
    data : bytes
        The whole file.
    station : str
        Name or number of the one to be read; '' reads all.

    Returns
    -------
    RawCloud
        Metres, in the frame of the file. Without the points that the file marks as invalid. Colours between the limits
        that it states; points of a station without colours are black, and have no intensity where it has none. Notes:
        ``stations_read``, ``invalid_dropped``, ``colors_dropped``.

    Raises
    ------
    ReadError
        The file is damaged, pye57 is missing, there is no such station, or no point is left.
    """
    if len(data) < _HEADER_BYTES:
        raise ReadError(f"its E57 header ends after {len(data)} of {_HEADER_BYTES} bytes; {TRUNCATED_HINT}")
    stated = int.from_bytes(data[16:24], "little")
    if stated != len(data):
        raise ReadError(f"its E57 header states {stated} bytes but it has {len(data)}; {TRUNCATED_HINT}")
    if importlib.util.find_spec("pye57") is None:
        raise ReadError(
            "is E57, which needs the package pye57; pip install pye57 where it exists for this system, or export it as "
            "LAS, PLY or PTX"
        )
    with E57Process() as process:
        return read_stations(process, data, station)


def read_stations(process: E57Process, data: bytes, station: str = "") -> RawCloud:
    """Do the same in a process that is there already."""
    found = process.open(data)
    names = [each.name for each in found]
    chosen = [find_station(names, station)] if station else list(range(len(found)))
    refused = next((found[k].refused for k in chosen if found[k].refused), "")
    if refused:
        raise ReadError(f"{refused}; export the scan again")
    wanted = [k for k in chosen if found[k].count]
    if not wanted:
        which = f"its station '{short_name(names[chosen[0]])}' holds" if station else "holds"
        raise ReadError(f"{which} no points with coordinates; export the scan again")
    gathered = _Gathered(found, wanted)
    for block in process.read(wanted):
        gathered.take(block)
    return gathered.cloud(chosen)


class _Gathered:
    """The points of stations as they come, in memory that is taken as it is filled."""

    def __init__(self, stations: Sequence[E57Station], wanted: Sequence[int]) -> None:
        self._stations = stations
        self._wanted = wanted
        self._n_stated = n = sum(stations[k].count for k in wanted)
        self._points: Floats = np.zeros((n, 3))
        self._of_point: Labels = np.zeros(n, dtype=np.int16)
        has_colors = any(stations[k].has_colors for k in wanted)
        self._colors: Colors | None = np.zeros((n, 3), dtype=np.uint8) if has_colors else None
        has_shine = any(stations[k].has_intensities for k in wanted)
        self._intensities: Floats | None = np.full(n, np.nan) if has_shine else None
        self._n = 0
        self._n_invalid = 0

    def take(self, block: E57Block) -> None:
        """Take a block of points."""
        own = slice(self._n, self._n + len(block.points))
        self._points[own] = block.points
        self._of_point[own] = block.station
        if self._colors is not None and block.colors is not None:
            self._colors[own] = block.colors
        if self._intensities is not None and block.intensities is not None:
            self._intensities[own] = block.intensities
        self._n += len(block.points)
        self._n_invalid += block.n_invalid

    def cloud(self, chosen: Sequence[int]) -> RawCloud:
        """Return all that was taken."""
        stations, n = self._stations, self._n
        if not n:
            whose = (
                f"its station '{short_name(stations[chosen[0]].name)}'"
                if len(chosen) < len(stations)
                else "its stations"
            )
            raise ReadError(f"marks all {self._n_stated:,} points of {whose} as invalid; export the scan again")
        of_point = self._of_point[:n]
        counts = np.bincount(of_point, minlength=len(stations))
        names = tuple(each.name for each in stations)
        notes = [stations_note(names, counts.tolist(), chosen)]
        if self._n_invalid:
            message = f"{self._n_invalid:,} of {self._n_stated:,} points dropped: the file marks them as invalid"
            notes.append(Note("invalid_dropped", READ_STAGE, message))
        if any(stations[k].has_unknown_colors for k in self._wanted):
            message = "colours dropped: the file does not state between which limits they lie"
            notes.append(Note("colors_dropped", READ_STAGE, message))
        places = [np.full(3, np.nan) if each.place is None else each.place for each in stations]
        steps = [stations[k].steps for k in self._wanted]
        stated = [each for each in steps if each is not None]
        return RawCloud(
            self._points[:n],
            None if self._colors is None else self._colors[:n],
            notes=tuple(notes),
            unit="m",
            step=np.max(stated, axis=0) if stated else None,
            stations=RawStations(names, of_point, np.array(places)),
            intensities=None if self._intensities is None else as_intensities(self._intensities[:n]),
        )


FORMAT = ScanFormat(".e57", "'ASTM-E57'", is_e57, read_e57, takes=("station",))
