"""Reading PTS of several stations: the points of each follow the line that counts them. PTS of one is text as any."""

from stair_inspector.errors import ReadError
from stair_inspector.files.counted_blocks import begins_with_number, lone_numbers, parse_block
from stair_inspector.files.raw_cloud import RawCloud, ScanFormat
from stair_inspector.files.raw_stations import MOST_STATIONS, find_station
from stair_inspector.files.station_rows import cloud_of_stations

_TEXT_BYTES = 1000


def has_blocks(data: bytes) -> bool:
    """Return whether a file holds several counts, and points after the first."""
    if not begins_with_number(data):
        return False
    heads = lone_numbers(data)
    return len(heads) > 1 and len(data[heads[0].end : heads[0].end + _TEXT_BYTES].partition(b"\n")[0].split()) >= 3


def read_pts(data: bytes, station: str = "") -> RawCloud:
    """Read the stations of a PTS, or the one with a name or number.

    Raises
    ------
    ReadError
        A count is not that of the lines that follow, a line is not numbers, or there is no such station.
    """
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
    return cloud_of_stations(blocks, names, chosen, is_cut=is_cut)


FORMAT = ScanFormat(".pts", "a count of points", has_blocks, read_pts, read_station=read_pts, is_text=True)
