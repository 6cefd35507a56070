"""The scan with what every point was taken for, as fields of a PLY or LAZ file."""

import importlib.util
import io
import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stair_inspector import __version__
from stair_inspector.content.segmented_points import KINDS, SegmentedPoints, segmented_points
from stair_inspector.errors import WriteError
from stair_inspector.files.palettes import read_palette
from stair_inspector.files.ply import ply_bytes
from stair_inspector.geometry.arrays import Colors, Floats
from stair_inspector.model import Inspection, Scan

SegmentedFormat = Literal["laz", "ply"]
FIELDS = ("step", "kind", "residual_m")
"""Names of the fields in both formats: int16, uint8 and float32."""
_SCALE_M = 0.0001
_MOST_WHOLE = 2**31 - 1
_MOST_16_BITS = 2**16 - 1
_DAY = slice(90, 94)
"""Where the header of LAS has day and year of its making."""
_WIDE_FROM_NARROW = 257
"""Turns a colour of 8 bits into one of 16, as LAS asks: 255 becomes 65535."""


def segmented_bytes(scan: Scan, inspection: Inspection, form: SegmentedFormat) -> bytes:
    """Return the scan's used points with step, kind of surface and residual as fields.

    ``step`` is the step's number, 0 the floor, -1 neither; ``kind`` the place in
    :data:`~stair_inspector.content.segmented_points.KINDS`; ``residual_m`` the signed distance from the plane of the
    step or floor, NaN where there is none. Points stand where they lay when they were measured, in metres of the scan
    frame, with the colours of the scan, or those of the segmentation where it has none, and with its intensity where
    it has one.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    form
        ``laz`` is LAS 1.4, point format 7, with extra bytes and coordinates to 0.1 mm; ``ply`` is binary PLY with
        float64 coordinates. The same input gives the same bytes.

    Raises
    ------
    WriteError
        The package that packs LAZ is not there.
    """
    points = segmented_points(scan, inspection)
    colors = read_palette("paper").of_labels(points.steps) if scan.colors is None else scan.colors
    return (_ply if form == "ply" else _laz)(points, colors, scan.intensities)


def _ply(points: SegmentedPoints, colors: Colors, intensities: Floats | None) -> bytes:
    meaning = ", ".join(f"{number} {kind}" for number, kind in enumerate(KINDS))
    fields = dict(zip(FIELDS, _columns(points), strict=True))
    if intensities is not None:
        fields["intensity"] = intensities
    return ply_bytes(points.places_m, colors, fields=fields, comments=[f"kind: {meaning}"])


def _columns(points: SegmentedPoints) -> tuple[NDArray[np.generic], ...]:
    return points.steps, points.kinds, points.residuals_m.astype(np.float32)


def _of_16_bits(intensities: Floats) -> NDArray[np.uint16]:
    """Return intensities as LAS has them: whole numbers that fit as they are, others from the least to the greatest."""
    known = np.nan_to_num(intensities, nan=float(np.nanmin(intensities)))
    low, high = float(known.min()), float(known.max())
    if low < 0.0 or high > _MOST_16_BITS or (known != np.rint(known)).any():
        # Shares of one stay shares of the whole range.
        low, high = (0.0, 1.0) if low >= 0.0 and high <= 1.0 else (low, high)
        known = (known - low) / max(high - low, 1e-300) * _MOST_16_BITS
    whole: NDArray[np.uint16] = np.rint(known).astype(np.uint16)
    return whole


def _laz(points: SegmentedPoints, colors: Colors, intensities: Floats | None) -> bytes:
    if any(importlib.util.find_spec(package) is None for package in ("laspy", "lazrs")):
        raise WriteError(
            "the segmented scan cannot be packed as LAZ, which needs the packages laspy and lazrs; write it as PLY"
        )
    import laspy

    columns = _columns(points)
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.generating_software = f"stair-inspector {__version__}"
    low, high = points.places_m.min(axis=0), points.places_m.max(axis=0)
    header.offsets = np.floor(low)
    reach = float((high - header.offsets).max())
    header.scales = np.full(3, max(_SCALE_M, 10.0 ** math.ceil(math.log10(max(reach, 1.0) / _MOST_WHOLE))))
    descriptions = ("0 floor, -1 no step", "see the docs", "from the plane of its step [m]")
    header.add_extra_dims(
        [
            laspy.ExtraBytesParams(name, column.dtype.str, description)
            for name, column, description in zip(FIELDS, columns, descriptions, strict=True)
        ]
    )
    made = laspy.LasData(header)
    made.x, made.y, made.z = points.places_m.T
    wide = colors.astype(np.uint16) * _WIDE_FROM_NARROW
    made.red, made.green, made.blue = wide.T
    if intensities is not None:
        made.intensity = _of_16_bits(intensities)
    for name, column in zip(FIELDS, columns, strict=True):
        made[name] = column
    stream = io.BytesIO()
    made.write(stream, do_compress=True)
    # The day would make two files of the same numbers differ: LAS allows 0 for none.
    stream.getbuffer()[_DAY] = bytes(4)
    return stream.getvalue()
