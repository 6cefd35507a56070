"""Reading PTX: one station after the other, each a grid of rays with the pose of its scanner."""

import re
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.counted_blocks import LoneNumber, begins_with_number, lone_numbers, parse_block
from stair_inspector.files.number_rows import number_table
from stair_inspector.files.raw_cloud import READ_STAGE, RawCloud, ScanFormat, excerpt
from stair_inspector.files.raw_stations import MOST_STATIONS, find_station
from stair_inspector.files.station_rows import cloud_of_stations
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Note

_SNIFFED_BYTES = 4096
_HEAD = re.compile(rb"\s*(?:\d+\s+){2}(?:(?:\S+[ \t]+){2}\S+\s*\n){4}(?:(?:\S+[ \t]+){3}\S+\s*\n){4}")
"""PTX has no mark of its own: columns, rows, the scanner's place and axes, and a matrix of four by four."""
_HEAD_LINES = 8
_MOST_RAYS = 10**12
_RIGID = 1e-3
"""How far the axes of a pose may be from unit vectors square to each other, as few decimals leave them."""
_BOM = b"\xef\xbb\xbf"


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    """A station of the file: its rays, where they begin and end, and its pose: points @ ``turn`` + ``place``."""

    n_rays: int
    begin: int
    end: int
    n_before: int
    turn: Floats
    place: Floats


def is_ptx(data: bytes) -> bool:
    """Return whether a file begins with the head of a PTX."""
    return begins_with_number(data) and _HEAD.match(data[:_SNIFFED_BYTES].removeprefix(_BOM)) is not None


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
    heads = _heads(data)
    names = [f"scan {k + 1}" for k in range(len(heads))]
    chosen = [find_station(names, station)] if station else list(range(len(heads)))
    grids = [_grid(data, heads, k) for k in range(len(heads))]
    places = np.array([grid.place for grid in grids])
    blocks, n_rays, is_cut = [], 0, False
    for k in chosen:
        grid = grids[k]
        rows, is_cut = parse_block(data[grid.begin : grid.end], grid.n_rays, grid.n_before, f"station {k + 1}")
        n_rays += len(rows)
        rows = rows[rows[:, :3].any(axis=1)]
        with np.errstate(invalid="ignore", over="ignore"):
            turned = [sum(rows[:, i] * grid.turn[i, j] for i in range(3)) + grid.place[j] for j in range(3)]
        rows[:, :3] = np.stack(turned, axis=1)
        blocks.append(rows)
    n_hits = sum(map(len, blocks))
    notes = []
    if not n_hits:
        raise ReadError(f"none of its {n_rays:,} rays hit anything (all are 0 0 0); export the scan again")
    if n_hits < n_rays:
        message = f"{n_rays - n_hits:,} of {n_rays:,} rays dropped: they hit nothing (0 0 0)"
        notes.append(Note("rays_dropped", READ_STAGE, message))
    return cloud_of_stations(blocks, names, chosen, places, notes, is_cut=is_cut)


def _heads(data: bytes) -> list[tuple[LoneNumber, LoneNumber]]:
    """Return the two lines with which each station begins."""
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
    at, lines = rows.end, []
    for _ in range(_HEAD_LINES):
        stop = data.find(b"\n", at, min(end, at + _SNIFFED_BYTES)) + 1
        if not stop:
            raise ReadError(f"the head of its station {k + 1} is cut off or damaged; export the scan again")
        lines.append(data[at:stop].split())
        at = stop
    number_table(lines[:4], 3, f"line of the head of station {k + 1}, after its two counts, no.")
    matrix = number_table(lines[4:], 4, f"line of the matrix of station {k + 1}, no.")
    turn, place = matrix[:3, :3], matrix[3, :3]
    is_rigid = bool(np.isfinite(matrix).all()) and np.abs(matrix).max() < 1e12
    if (
        not is_rigid
        or np.abs(matrix[:, 3] - (0.0, 0.0, 0.0, 1.0)).max() > 1e-9
        or np.abs(turn @ turn.T - np.eye(3)).max() > _RIGID
        or np.linalg.det(turn) < 0.0
    ):
        raise ReadError(
            f"the matrix of its station {k + 1} ('{excerpt(b' '.join(lines[4]))}' ...) is no turn and shift, with the "
            "shift in its last row; export the scan again"
        )
    n_rays = columns.value * rows.value
    if n_rays > _MOST_RAYS:
        raise ReadError(f"its station {k + 1} states {n_rays} rays, more than a file can hold; export the scan again")
    return _Grid(n_rays, at, end, rows.n_before + 1 + _HEAD_LINES, turn, place)


FORMAT = ScanFormat(
    ".ptx", "two counts, the scanner's place and axes, and a matrix", is_ptx, read_ptx, read_station=read_ptx
)
