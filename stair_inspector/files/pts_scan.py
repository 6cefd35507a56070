"""Reading PTS of several stations: the points of each follow the line that counts them. PTS of one is text as any."""

from collections.abc import Sequence
from functools import partial

from stair_inspector.errors import ColumnsUnclear, ReadError
from stair_inspector.files.counted_blocks import begins_with_number, lone_numbers, parse_block, with_newlines
from stair_inspector.files.raw_cloud import RawCloud, ScanFormat
from stair_inspector.files.raw_stations import MOST_STATIONS, find_station
from stair_inspector.files.station_rows import cloud_of_stations
from stair_inspector.files.text_head import unclear_columns
from stair_inspector.files.text_table import find_table
from stair_inspector.files.unnamed_columns import check_first_columns

_TEXT_BYTES = 1000


def has_blocks(data: bytes) -> bool:
    """Return whether a file holds several counts, and points after the first."""
    if not begins_with_number(data):
        return False
    data = with_newlines(data)
    heads = lone_numbers(data)
    full = next((head for head in heads if head.value), None)
    if full is None or len(heads) < 2:
        return False
    return len(data[full.end : full.end + _TEXT_BYTES].lstrip().partition(b"\n")[0].split()) >= 3


def read_pts(data: bytes, station: str = "", columns: Sequence[str] = ()) -> RawCloud:
    """Read the stations of a PTS, or the one with a name or number; ``columns`` as those of any text.

    Raises
    ------
    ColumnsUnclear
        Without ``columns``, the first three may not be x, y and z.
    ReadError
        A count is not that of the lines that follow, a line is not numbers, or there is no such station.
    """
    data = with_newlines(data)
    heads = lone_numbers(data)
    if len(heads) > MOST_STATIONS:
        raise ReadError(f"holds more than {MOST_STATIONS} counts of points, one for each station; export fewer of them")
    names = [f"scan {k + 1}" for k in range(len(heads))]
    chosen = [find_station(names, station)] if station else list(range(len(heads)))
    ends = [*(head.start for head in heads[1:]), len(data)]
    blocks, is_cut = [], False
    for k in chosen:
        body = data[heads[k].end : ends[k]]
        rows, is_cut = parse_block(body, heads[k].value, heads[k].n_before + 1, f"line {heads[k].n_before + 1}")
        blocks.append(rows)
    if not columns:
        for k, rows in zip(chosen, blocks, strict=True):
            check_first_columns(rows, partial(_unclear, data[heads[k].end : ends[k]]))
    return cloud_of_stations(blocks, names, chosen, roles=columns, is_cut=is_cut)


def _unclear(body: bytes, message: str, place: int) -> ColumnsUnclear:
    return unclear_columns(message, find_table(body, 0), at=place)


FORMAT = ScanFormat(".pts", "a count of points", has_blocks, read_pts, is_text=True, takes=("station", "columns"))
