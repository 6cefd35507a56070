"""What every scan format is first turned into, and the checks that all of them share.

Takes named columns as they stand in the file, gives points, colours and normals in the file's own unit. The readers
here raise ``ReadError`` without the file's name; ``scans.read_scan`` puts it in front.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_stations import RawStations
from stair_inspector.geometry.arrays import Bools, Colors, Floats
from stair_inspector.model import Note
from stair_inspector.params import KnownUnit

READ_STAGE = "read"
RED_GREEN_BLUE = ("red", "green", "blue")
NORMAL_XYZ = ("nx", "ny", "nz")
TRUNCATED_HINT = "the file is truncated, copy or export it again"
_COLOR_NAMES = (RED_GREEN_BLUE, ("r", "g", "b"), ("rf", "gf", "bf"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_INTENSITY_NAMES = ("intensity", "scalar_intensity", "reflectance", "scalar_reflectance", "reflectivity")
_NORMAL_NAMES = (NORMAL_XYZ, ("normal_x", "normal_y", "normal_z"))
POINT_NAMES = frozenset(
    name for names in (tuple("xyz"), *_COLOR_NAMES, *_NORMAL_NAMES, _INTENSITY_NAMES) for name in names
)
"""Names of the columns of which a cloud is made."""
_COUNT_DIGITS = 15
"""A count with more digits exceeds any file."""
_SHOWN_CHARACTERS = 60


@dataclass(frozen=True, slots=True, eq=False)
class RawCloud:
    """A cloud as the file has it: ``points`` (n, 3) in the file's unit and frame, not finite where the file says so.

    ``colors`` (n, 3) uint8 or None; ``normals`` (n, 3) as written, of any length, or None; ``is_outward`` (n,)
    where they are known to point out of a solid, None of a scan; ``unit`` where the file states one; ``step``
    (3,) on which its coordinates lie, in the file's unit, where the format states one; ``facet`` the length of the
    edges of a mesh that was scanned, in the file's unit; ``stations`` that saw the points; ``has_levels`` where no more
    levels of detail were read than wanted; ``intensities`` (n,) how strongly they reflected, on the file's own scale.
    """

    points: Floats
    colors: Colors | None = None
    normals: Floats | None = None
    notes: tuple[Note, ...] = ()
    is_outward: Bools | None = None
    unit: KnownUnit | None = None
    step: Floats | None = None
    facet: float | None = None
    stations: RawStations | None = None
    has_levels: bool = False
    intensities: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RawMesh:
    """A mesh as the file has it: ``corners`` (n, 3, 3) of its triangles in the file's unit and frame.

    ``colors`` (n, 3, 3) of each corner, 0 to 255, or None; ``unit`` where the format states one.
    """

    corners: Floats
    colors: Floats | None = None
    unit: KnownUnit | None = None
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True, slots=True)
class ScanFormat:
    """A format of scans that is known by how a file begins.

    ``suffix`` in lower case, and ``also`` what else its files end in; ``beginning`` are the words for what a file of it
    begins with. ``fits`` tells it from a file's bytes, ``read`` turns them into a cloud or a mesh or raises ReadError.
    ``is_for_meshes`` where a scan should rather not be exported as it; ``is_text`` where other text may have the suffix
    too. ``takes`` are the keywords that ``read`` has besides: ``station``, a name or number, all where that is '';
    ``columns``, what they are; ``part``, where reading no more than that takes less.
    """

    suffix: str
    beginning: str
    fits: Callable[[bytes], bool]
    read: Callable[..., RawCloud | RawMesh]
    also: tuple[str, ...] = ()
    is_for_meshes: bool = False
    is_text: bool = False
    takes: tuple[Literal["station", "columns", "part"], ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """All that its files end in."""
        return (self.suffix, *self.also)


def excerpt(text: str | bytes, limit: int = _SHOWN_CHARACTERS) -> str:
    r"""Return text from a file or a path so that it fits into a one-line message.

    Examples
    --------
    >>> excerpt(b"two\nlines \xff")
    'two\\nlines \\xff'
    """
    # Cut first: a line of a hostile file may have gigabytes.
    cut = text[: limit + 1]
    decoded = cut.decode("ascii", "backslashreplace") if isinstance(cut, bytes) else cut
    clean = "".join(
        c if c.isprintable() else c.encode("unicode_escape", "backslashreplace").decode("ascii") for c in decoded
    )
    return clean if len(text) <= limit else clean[:limit] + "..."


def parse_count(token: str, what: str) -> int:
    """Return a count stated by a header.

    Raises
    ------
    ReadError
        Not a plain whole number, or more digits than a file can hold points.
    """
    if not (token.isascii() and token.isdigit()) or len(token) > _COUNT_DIGITS:
        raise ReadError(f"{what} should be a whole number, got '{excerpt(token)}'; export the scan again")
    return int(token)


def strided_column(data: bytes | bytearray, dtype: str, count: int, offset: int, stride: int) -> NDArray[Any]:
    """Return ``count`` values that lie ``stride`` bytes apart in a buffer; numpy refuses to leave the buffer."""
    return np.ndarray(shape=(count,), dtype=dtype, buffer=data, offset=offset, strides=(stride,))


def check_rest_is_padding(rest: bytes, n_points: int) -> None:
    """Check that nothing but zeros or white space follows the data that a header announced.

    Raises
    ------
    ReadError
        More data: the header states fewer points than the file holds.
    """
    if rest.strip(b"\0 \t\r\n"):
        raise ReadError(
            f"holds {len(rest)} bytes more than the {n_points} points its header states; "
            "the header or the file is damaged, export the scan again"
        )


def cut_note() -> tuple[Note, ...]:
    """Return the note of a file that ends in the middle of its last line of points."""
    return (
        Note(
            "last_line_unfinished",
            READ_STAGE,
            "the file ends without a line end, so its last number may have lost digits",
        ),
    )


def as_declared(column: Floats, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return an ascii column in its declared integer type where every value fits, else unchanged.

    Coordinates written with decimals under an integer type stay what was written.
    """
    if dtype.kind not in "iu":
        return column
    limits = np.iinfo(dtype)
    fits = (column >= float(limits.min)) & (column <= float(limits.max)) & (column == np.floor(column))
    # The largest 64-bit integers are not doubles; a colour is never that large.
    return column.astype(dtype) if dtype.itemsize < 8 and fits.all() else column


def as_whole(column: Floats) -> NDArray[np.float64] | NDArray[np.int64]:
    """Return a column of whole numbers as integers, so that colours of 0 and 1 are not taken for shares of one."""
    is_whole = bool((np.abs(column) < 2.0**31).all()) and bool((column == np.floor(column)).all())
    return column.astype(np.int64) if is_whole else column


def cloud_from_columns(columns: Mapping[str, NDArray[Any]], notes: Sequence[Note] = ()) -> RawCloud:
    """Pick points, colours and normals from the named columns of a file.

    Parameters
    ----------
    columns : mapping of name to (n,)
        Names in lower case; integer or floating type, of any byte order.
    notes : sequence of Note
        What the reader has to say.

    Raises
    ------
    ReadError
        No x, y or z, or no points.
    """
    missing = [axis for axis in "xyz" if axis not in columns]
    if missing:
        names = excerpt(", ".join(columns), 100)
        raise ReadError(f"has no {' and no '.join(missing)} (its fields: {names}); export the scan with x, y and z")
    points = _stacked(columns, tuple("xyz"))
    if not len(points):
        raise ReadError("holds no points; export the scan again")
    noted = list(notes)
    colors = None
    color_names = _first_present(columns, _COLOR_NAMES)
    if color_names is not None:
        colors = _to_bytes([columns[name] for name in color_names])
        if colors is None:
            noted.append(
                Note("colors_dropped", READ_STAGE, "colours dropped: they are neither 0 to 1, 0 to 255 nor 16-bit")
            )
    normal_names = _first_present(columns, _NORMAL_NAMES)
    normals = None if normal_names is None else _stacked(columns, normal_names)
    shine = next((columns[name] for name in _INTENSITY_NAMES if name in columns), None)
    return RawCloud(points, colors, normals, tuple(noted), intensities=None if shine is None else as_intensities(shine))


def as_intensities(column: NDArray[Any]) -> Floats | None:
    """Return how strongly points (n,) reflected, NaN where that is not finite; None where all are alike."""
    if column.dtype.kind not in "iuf":
        return None
    with np.errstate(invalid="ignore", over="ignore"):
        values = column.astype(np.float64)
    known = values[np.isfinite(values)]
    if not len(known) or not np.ptp(known):
        return None
    values[~np.isfinite(values)] = np.nan
    return values


def _first_present(columns: Mapping[str, object], choices: Sequence[tuple[str, ...]]) -> tuple[str, ...] | None:
    return next((names for names in choices if all(name in columns for name in names)), None)


def _stacked(columns: Mapping[str, NDArray[Any]], names: tuple[str, ...]) -> Floats:
    # A signalling NaN or a float64 beyond float32 in a hostile file must not raise numpy's warning.
    with np.errstate(invalid="ignore", over="ignore"):
        return np.stack([columns[name].astype(np.float64) for name in names], axis=1)


def _to_bytes(channels: Sequence[NDArray[Any]]) -> Colors | None:
    """Return colours as (n, 3) uint8, or None where their range has no usual meaning."""
    if all(channel.dtype == np.uint8 for channel in channels):
        return np.stack(channels, axis=1)
    is_integer = all(channel.dtype.kind in "iu" for channel in channels)
    values = _stacked(dict(zip(RED_GREEN_BLUE, channels, strict=True)), RED_GREEN_BLUE)
    if not np.isfinite(values).all() or values.min() < 0.0:
        return None
    high = values.max()
    if not is_integer and high <= 1.0:
        values = values * 255.0
    elif is_integer and 255.0 < high <= 65535.0:
        values = values / 257.0
    elif high > 255.0:
        return None
    return np.rint(values).astype(np.uint8)
