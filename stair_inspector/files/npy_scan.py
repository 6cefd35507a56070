"""Reading arrays of numpy: NPY, and NPZ, which is several of them in a ZIP; never anything that would run code."""

import ast
import math
import operator
import zipfile
import zlib
from collections.abc import Mapping
from io import BytesIO
from typing import Any

import numpy as np
from numpy.lib import format as npy_format
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.archives import LARGEST_GROWTH
from stair_inspector.files.raw_cloud import (
    NORMAL_XYZ,
    POINT_NAMES,
    RED_GREEN_BLUE,
    TRUNCATED_HINT,
    RawCloud,
    ScanFormat,
    cloud_from_columns,
    excerpt,
)
from stair_inspector.files.unnamed_columns import cloud_without_names
from stair_inspector.geometry.arrays import Floats

_MAGIC = b"\x93NUMPY"
_ZIP = b"PK\x03\x04"
_HINT = "save an array of shape (n, 3), or one with fields x, y and z"
_POINTS = ("points", "xyz", "coords", "vertices", "positions", "pos", "arr_0")
_COLORS = ("colors", "rgb")
_NORMALS = ("normals",)
_MOST_ARRAYS = 100
_MOST_COLUMNS = 1000
_LONGEST_HEADER = 20_000


def is_npy(data: bytes) -> bool:
    """Return whether a file is NPY, or an NPZ: a ZIP whose first member is one."""
    n_name = int.from_bytes(data[26:28], "little")
    return data.startswith(_MAGIC) or (data.startswith(_ZIP) and data[30 : 30 + n_name].endswith(b".npy"))


def read_npy(data: bytes) -> RawCloud:
    """Read an NPY or NPZ.

    Parameters
    ----------
    data : bytes
        The whole file.

    Returns
    -------
    RawCloud
        Of an array (n, 3 or more) with the columns of a text without names, of one (rows, columns, 3) row by row, or of
        one with named fields. An NPZ may hold points, colors and normals, or x, y and z, by these names.

    Raises
    ------
    ReadError
        Damaged, of Python objects, or of a shape that is no list of points.
    """
    if data.startswith(_MAGIC):
        return _cloud_of(_array(data))
    arrays = _arrays(data)
    names = {name.lower(): name for name in arrays}
    if set("xyz") <= set(names):
        named = {name: arrays[names[name]].ravel() for name in names if name in POINT_NAMES}
        _check_equal(named)
        return cloud_from_columns(named)
    chosen = [names[name] for name in _POINTS if name in names] or (list(arrays) if len(arrays) == 1 else [])
    if not chosen:
        raise ReadError(f"holds several arrays ({excerpt(', '.join(arrays))}), none of them called points; {_HINT}")
    cloud = _cloud_of(arrays[chosen[0]])
    columns: dict[str, NDArray[Any]] = dict(zip("xyz", cloud.points.T, strict=True))
    for known, parts in ((_COLORS, RED_GREEN_BLUE), (_NORMALS, NORMAL_XYZ)):
        found = next((arrays[names[name]] for name in known if name in names), None)
        if found is not None and found.shape == cloud.points.shape:
            columns |= dict(zip(parts, found.T, strict=True))
    return cloud if len(columns) == len("xyz") else cloud_from_columns(columns, cloud.notes)


def _arrays(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of an NPZ by their names."""
    arrays: dict[str, NDArray[Any]] = {}
    left = LARGEST_GROWTH * len(data)
    try:
        with zipfile.ZipFile(BytesIO(data)) as archive:
            for member in archive.infolist()[:_MOST_ARRAYS]:
                with archive.open(member) as stream:
                    content = stream.read(left + 1)
                left -= len(content)
                if left < 0:
                    raise ReadError(f"unpacks to more than {LARGEST_GROWTH} times its size, as no scan does; {_HINT}")
                if content.startswith(_MAGIC):
                    arrays[member.filename.removesuffix(".npy")] = _array(content)
    except (zipfile.BadZipFile, EOFError, zlib.error, OSError, NotImplementedError, RuntimeError, ValueError) as error:
        raise ReadError(f"is a damaged NPZ ({excerpt(str(error))}); {TRUNCATED_HINT}") from error
    return arrays


def _array(data: bytes) -> NDArray[Any]:
    """Return the array of an NPY, which numpy's own reader would allocate before it looks whether it is there."""
    length_bytes = 2 if data[6:7] == b"\x01" else 4
    begin = 8 + length_bytes
    end = begin + int.from_bytes(data[8:begin], "little")
    try:
        if end > min(len(data), _LONGEST_HEADER):
            raise ValueError
        header = ast.literal_eval(data[begin:end].decode("utf-8").strip())
        dtype = npy_format.descr_to_dtype(header["descr"])
        is_fortran, shape = bool(header["fortran_order"]), tuple(map(operator.index, header["shape"]))
    except (ValueError, KeyError, SyntaxError, TypeError, RecursionError, MemoryError, IndexError) as error:
        raise ReadError(f"has a damaged NPY header; {TRUNCATED_HINT}") from error
    if dtype.hasobject:
        raise ReadError(f"is an NPY of Python objects, which are not read; {_HINT}")
    count = math.prod(shape)
    if min(shape, default=0) <= 0 or not dtype.itemsize:
        raise ReadError(f"holds no points: an array of shape {excerpt(str(shape))}; {_HINT}")
    needed, got = count * dtype.itemsize, len(data) - end
    if needed != got:
        raise ReadError(f"its NPY header states {needed} bytes but {got} follow; {TRUNCATED_HINT}")
    flat = np.frombuffer(data, dtype, count, end)
    return flat.reshape(shape[::-1]).T if is_fortran else flat.reshape(shape)


def _cloud_of(array: NDArray[Any]) -> RawCloud:
    """Return the points of an array."""
    if array.dtype.names is not None:
        fields = {name.lower(): array[name].ravel() for name in array.dtype.names if array[name].shape == array.shape}
        return cloud_from_columns({name: each for name, each in fields.items() if each.dtype.kind in "fiu"})
    if array.dtype.kind not in "fiu":
        raise ReadError(f"is an NPY of {excerpt(str(array.dtype))} instead of numbers; {_HINT}")
    if array.ndim < 2 or not 3 <= array.shape[-1] <= _MOST_COLUMNS:
        raise ReadError(f"is an array of shape {excerpt(str(array.shape))}, which is no list of points; {_HINT}")
    table: Floats = array.reshape(-1, array.shape[-1]).astype(np.float64)
    return cloud_without_names(table, (), lambda message: ReadError(f"{message}; {_HINT}"))


def _check_equal(columns: Mapping[str, NDArray[Any]]) -> None:
    lengths = {len(column) for column in columns.values()}
    if len(lengths) > 1:
        raise ReadError(f"holds x, y and z of different lengths ({sorted(lengths)[:5]}); {_HINT}")


FORMAT = ScanFormat(".npy", "numpy's mark", is_npy, read_npy, (".npz",))
