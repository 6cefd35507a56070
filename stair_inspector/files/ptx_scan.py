"""Reading PTX: one station after the other, each a grid of rays with the pose of its scanner."""

from dataclasses import dataclass
from itertools import islice

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.counted_blocks import (
    LoneNumber,
    begins_with_number,
    lone_numbers,
    parse_block,
    with_newlines,
)
from stair_inspector.files.ptx_pose import HEAD_LINES, PtxPose, pose_notes, pose_of
from stair_inspector.files.raw_cloud import READ_STAGE, RawCloud, ScanFormat, excerpt
from stair_inspector.files.raw_stations import MOST_STATIONS, find_station
from stair_inspector.files.station_rows import cloud_of_stations
from stair_inspector.model import Note

_SNIFFED_BYTES = 4096
_WORDS = (1, 1, 3, 3, 3, 3, 4, 4, 4, 4)
"""PTX has no mark of its own: columns, rows, the scanner's place and axes, and a matrix of four by four."""
_MOST_RAYS = 10**12
_COUNT_DIGITS = 15
_BOM = b"\xef\xbb\xbf"


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    """A station of the file: its rays, where they begin and end, the lines before them, and where they lie."""

    n_rays: int
    begin: int
    end: int
    n_before: int
    pose: PtxPose


def is_ptx(data: bytes) -> bool:
    """Return whether a file begins with the head of a PTX."""
    if not begins_with_number(data):
        return False
    lines = _first_lines(data)
    return tuple(map(len, lines)) == _WORDS and lines[1][0].isdigit()


def _first_lines(data: bytes) -> list[list[bytes]]:
    """Return the words of the first whole lines that are not blank, of as many as a head has."""
    *lines, _ = with_newlines(data[:_SNIFFED_BYTES].removeprefix(_BOM)).split(b"\n")
    return list(islice(filter(None, map(bytes.split, lines)), len(_WORDS)))


def read_ptx(data: bytes, station: str = "") -> RawCloud:
    """Read the stations of a PTX, or the one with a name or number; ``scan 1`` is the first.

    Returns
    -------
    RawCloud
        In the frame of the file. Without the rays that hit nothing, which are written as 0 0 0. Notes:
        ``stations_read``, ``rays_dropped``, ``columns_ignored``, ``last_line_unfinished``.

    Raises
    ------
    ReadError
        A head is damaged, or its number of rays is not that of the lines that follow, a line is not numbers, there is
        no such station, or no ray hit anything.
    """
    data = with_newlines(data)
    heads = _heads(data)
    names = [f"scan {k + 1}" for k in range(len(heads))]
    chosen = [find_station(names, station)] if station else list(range(len(heads)))
    grids = [_grid(data, heads, k) for k in chosen]
    places = np.full((len(heads), 3), np.nan)
    places[chosen] = [grid.pose.place for grid in grids]
    blocks, n_rays, is_cut = [], 0, False
    for k, grid in zip(chosen, grids, strict=True):
        rows, is_cut = parse_block(data[grid.begin : grid.end], grid.n_rays, grid.n_before, f"station {k + 1}")
        n_rays += len(rows)
        rows = rows[rows[:, :3].any(axis=1)]
        turn, shift = grid.pose.turn, grid.pose.shift
        with np.errstate(invalid="ignore", over="ignore"):
            turned = [sum(rows[:, i] * turn[i, j] for i in range(3)) + shift[j] for j in range(3)]
        rows[:, :3] = np.stack(turned, axis=1)
        blocks.append(rows)
    n_hits = sum(map(len, blocks))
    notes = pose_notes([grid.pose for grid in grids], chosen)
    if n_rays and not n_hits:
        whose = f" of its station {chosen[0] + 1}" if station else ""
        raise ReadError(f"none of the {n_rays:,} rays{whose} hit anything (all are 0 0 0); export the scan again")
    if n_hits < n_rays:
        message = f"{n_rays - n_hits:,} of {n_rays:,} rays dropped: they hit nothing (0 0 0)"
        notes.append(Note("rays_dropped", READ_STAGE, message))
    return cloud_of_stations(blocks, names, chosen, places, notes, is_cut=is_cut)


def _heads(data: bytes) -> list[tuple[LoneNumber, LoneNumber]]:
    """Return the two lines with which each station begins."""
    for words in _first_lines(data)[:2]:
        if len(words[0]) > _COUNT_DIGITS:
            raise ReadError(f"states '{excerpt(words[0])}' columns or rows, more than a file can hold; export it again")
    numbers = lone_numbers(data)
    heads: list[tuple[LoneNumber, LoneNumber]] = []
    k = 0
    while k + 1 < len(numbers) and len(heads) <= MOST_STATIONS:
        if data[numbers[k].end : numbers[k + 1].start].strip():
            raise ReadError(
                f"line {numbers[k].n_before + 1} ('{numbers[k].value}') is neither a point nor the head of a PTX "
                "station; correct the line or export the scan again"
            )
        heads.append((numbers[k], numbers[k + 1]))
        k += 2
    if len(heads) > MOST_STATIONS:
        raise ReadError(f"holds more than {MOST_STATIONS} stations; export fewer of them")
    if k < len(numbers):
        raise ReadError(f"line {numbers[k].n_before + 1} begins a PTX station that ends there; export the scan again")
    return heads


def _grid(data: bytes, heads: list[tuple[LoneNumber, LoneNumber]], k: int) -> _Grid:
    """Return a station from its head."""
    columns, rows = heads[k]
    end = heads[k + 1][0].start if k + 1 < len(heads) else len(data)
    at, n_before, lines = rows.end, rows.n_before + 1, list[list[bytes]]()
    while len(lines) < HEAD_LINES:
        stop = data.find(b"\n", at, min(end, rows.end + _SNIFFED_BYTES)) + 1
        if not stop:
            raise ReadError(f"the head of its station {k + 1} is cut off or damaged; export the scan again")
        words = data[at:stop].split()
        if words:
            lines.append(words)
        at, n_before = stop, n_before + 1
    pose = pose_of(lines, k + 1)
    n_rays = columns.value * rows.value
    if n_rays > _MOST_RAYS:
        raise ReadError(f"its station {k + 1} states {n_rays} rays, more than a file can hold; export the scan again")
    return _Grid(n_rays, at, end, n_before, pose)


FORMAT = ScanFormat(
    ".ptx", "two counts, the scanner's place and axes, and a matrix", is_ptx, read_ptx, takes=("station",)
)
