"""Rows of numbers of several stations as one cloud."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.counted_blocks import named_columns
from stair_inspector.files.raw_cloud import READ_STAGE, RawCloud, cloud_from_columns, cut_note
from stair_inspector.files.raw_stations import RawStations, stations_note
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Note


def cloud_of_stations(
    blocks: Sequence[Floats],
    names: Sequence[str],
    chosen: Sequence[int],
    places: Floats | None = None,
    notes: Sequence[Note] = (),
    *,
    roles: Sequence[str] = (),
    is_cut: bool = False,
) -> RawCloud:
    """Return the cloud of the stations that were chosen.

    Parameters
    ----------
    blocks : sequence of (n, columns)
        Rows of each of them, in the frame of the file.
    names : sequence of str
        Of all stations (k).
    chosen : sequence of int
        Which of them the blocks are.
    places : (k, 3), optional
        Where each stood.
    notes : sequence of Note
        What is to be said of them already.
    roles : sequence of str
        What their columns are, as :func:`stair_inspector.columns.parse_columns` says it; none where they follow custom.
    is_cut : bool
        Whether the last number of the last block may have been cut.

    Raises
    ------
    ReadError
        No points, or the blocks have different columns, or fewer than roles.
    """
    if not any(map(len, blocks)):
        raise ReadError("holds no points; export the scan again")
    columns, n_ignored = named_columns(blocks, roles)
    counts = np.zeros(len(names), dtype=np.int64)
    counts[list(chosen)] = [len(rows) for rows in blocks]
    noted = [stations_note(names, counts.tolist(), chosen), *notes, *(cut_note() if is_cut else ())]
    if n_ignored:
        message = f"{n_ignored} columns after x, y, z were ignored: they are no colours (whole numbers 0 to 255)"
        noted.append(Note("columns_ignored", READ_STAGE, message))
    cloud = cloud_from_columns(columns, noted)
    of_point = np.repeat(np.arange(len(names), dtype=np.int16), counts)
    places = np.full((len(names), 3), np.nan) if places is None else places
    return replace(cloud, stations=RawStations(tuple(names), of_point, places))
