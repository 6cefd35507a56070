"""Reading arrays of numpy: NPY, and NPZ, which is several of them in a ZIP; never anything that would run code."""

import ast
import math
import operator
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.lib import format as npy_format
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.archives import most_unpacked, open_zip, unpack_member
from stair_inspector.files.raw_cloud import (
    NORMAL_XYZ,
    POINT_NAMES,
    READ_STAGE,
    RED_GREEN_BLUE,
    TRUNCATED_HINT,
    RawCloud,
    ScanFormat,
    cloud_from_columns,
    excerpt,
)
from stair_inspector.files.unnamed_columns import cloud_without_names
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Note

_MAGIC = b"\x93NUMPY"
_ZIP = b"PK\x03\x04"
_HINT = "save an array of shape (n, 3), or one with fields x, y and z"
_POINTS = ("points", "xyz", "coords", "vertices", "positions", "pos")
_WITHOUT_NAME = re.compile(r"arr_\d+")
_COLORS = ("colors", "rgb")
_NORMALS = ("normals",)
_READ = frozenset((*POINT_NAMES, *_POINTS, *_COLORS, *_NORMALS))
_NUMBERS = "fiu"
"""Kinds of numpy: floats, signed and unsigned whole numbers."""
_MOST_ARRAYS = 100
_MOST_COLUMNS = 64
"""An array with more is an image, a depth map, or points that lie side by side."""
_MOST_AXES = 8
_LONGEST_HEADER = 20_000


def is_npy(data: bytes) -> bool:
    """Return whether a file is NPY, or an NPZ: a ZIP of nothing but those."""
    if not data.startswith(_ZIP):
        return data.startswith(_MAGIC)
    try:
        _, files = open_zip(data)
    except ReadError:
        # A truncated one is told by its first member.
        return data[30 : 30 + int.from_bytes(data[26:28], "little")].endswith(b".npy")
    return bool(files) and all(each.filename.lower().endswith(".npy") for each in files)


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
        one with named fields. An NPZ may hold points, colors and normals, or x, y and z, by these names. Note
        ``colors_dropped`` where its colours are not those of the points.

    Raises
    ------
    ReadError
        Damaged, of Python objects or no numbers, of a shape that is no list of points, or with two lists of points.
    """
    if data.startswith(_MAGIC):
        return _cloud_of(_array(data))
    arrays = _arrays(data)
    spelt = _by_lower_case(arrays, "arrays")
    names = {name: spelt[name] for name in spelt if name in _POINTS or _WITHOUT_NAME.fullmatch(name)}
    fitting = [name for name in names.values() if _is_list_of_points(arrays[name])]
    has_axes = set("xyz") <= set(spelt)
    axes = {name: arrays[spelt[name]] for name in spelt if name in POINT_NAMES} if has_axes else {}
    if len(fitting) + (has_axes and _are_numbers_alike({axis: axes[axis] for axis in "xyz"})) > 1:
        found = ", ".join([*(("x y z",) if has_axes else ()), *fitting])
        raise ReadError(
            f"holds several arrays that may be the points ({excerpt(found)}); save those to be measured alone"
        )
    if has_axes and not fitting:
        _check_numbers(axes)
        if not _are_numbers_alike(axes):
            raise ReadError(f"holds x, y and z of different shapes ({excerpt(_shapes(axes.values()))}); {_HINT}")
        cloud = cloud_from_columns({name: array.ravel() for name, array in axes.items()})
        return _with_attributes(cloud, axes["x"].shape, arrays, spelt)
    chosen = fitting or list(names.values()) or (list(arrays) if len(arrays) == 1 else [])
    if not chosen:
        raise ReadError(f"holds several arrays ({excerpt(', '.join(arrays))}), none of them called points; {_HINT}")
    points = arrays[chosen[0]]
    rows = points.shape if points.dtype.names is not None else points.shape[:-1]
    return _with_attributes(_cloud_of(points), rows, arrays, spelt)


def _is_list_of_points(array: NDArray[Any]) -> bool:
    """Return whether an array may be the points: numbers (..., 3 or more), or fields x, y and z."""
    if array.dtype.names is not None:
        return set("xyz") <= {name.lower() for name in array.dtype.names}
    return array.dtype.kind in _NUMBERS and array.ndim >= 2 and 3 <= array.shape[-1] <= _MOST_COLUMNS


def _are_numbers_alike(axes: Mapping[str, NDArray[Any]]) -> bool:
    """Return whether arrays are numbers of one shape."""
    return len({array.shape for array in axes.values()}) == 1 and all(a.dtype.kind in _NUMBERS for a in axes.values())


def _shapes(arrays: Iterable[NDArray[Any]]) -> str:
    return ", ".join(str(array.shape) for array in arrays)


def _check_numbers(arrays: Mapping[str, NDArray[Any]]) -> None:
    """Check that what a cloud is made of are numbers: numpy would turn truths, times and words into some."""
    for name, array in arrays.items():
        if array.dtype.kind not in _NUMBERS:
            raise ReadError(f"has '{name}' of {excerpt(str(array.dtype))} instead of numbers; {_HINT}")


def _by_lower_case(names: Iterable[str], what: str) -> dict[str, str]:
    """Return names by themselves in lower case; two that differ in no more are refused where they would be read."""
    spelt = {name.lower(): name for name in names}
    doubled = [n for n, count in Counter(map(str.lower, names)).items() if count > 1 and n in _READ]
    if doubled:
        raise ReadError(f"has two {what} called '{doubled[0]}', of which the one is no better than the other; {_HINT}")
    return spelt


def _with_attributes(
    cloud: RawCloud, rows: tuple[int, ...], arrays: Mapping[str, NDArray[Any]], spelt: Mapping[str, str]
) -> RawCloud:
    """Return the cloud with the colours and normals that lie beside its points, which came in an array of ``rows``."""
    columns: dict[str, NDArray[Any]] = {}
    notes = list(cloud.notes)
    for what, choices, parts in (("colors", _COLORS, RED_GREEN_BLUE), ("normals", _NORMALS, NORMAL_XYZ)):
        found = next((arrays[spelt[name]] for name in choices if name in spelt), None)
        if found is None:
            continue
        _check_numbers({what: found})
        if found.shape in ((*rows, 3), cloud.points.shape):
            columns |= dict(zip(parts, found.reshape(-1, 3).T, strict=True))
        else:
            message = f"{what} dropped: an array of shape {excerpt(str(found.shape))} beside points of {(*rows, 3)}"
            notes.append(Note(f"{what}_dropped", READ_STAGE, message))
    if not columns:
        return replace(cloud, notes=tuple(notes))
    beside = cloud_from_columns({**dict(zip("xyz", cloud.points.T, strict=True)), **columns}, notes)
    colors = cloud.colors if beside.colors is None else beside.colors
    return replace(beside, colors=colors, normals=cloud.normals if beside.normals is None else beside.normals)


def _arrays(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of an NPZ by their names."""
    arrays: dict[str, NDArray[Any]] = {}
    left = most_unpacked(len(data))
    archive, files = open_zip(data)
    if len(files) > _MOST_ARRAYS:
        raise ReadError(f"holds {len(files)} arrays, more than {_MOST_ARRAYS}; {_HINT}")
    for member in files:
        content = unpack_member(archive, member, left)
        left -= len(content)
        name = member.filename[: -len(".npy")]
        if name in arrays:
            raise ReadError(f"holds two arrays called '{excerpt(name)}'; {_HINT}")
        if not content.startswith(_MAGIC):
            raise ReadError(f"its '{excerpt(member.filename)}' does not begin with numpy's mark; {_HINT}")
        arrays[name] = _array(content)
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
        if dtype.subdtype is not None:
            raise ValueError
        is_fortran, shape = bool(header["fortran_order"]), tuple(map(operator.index, header["shape"]))
    except (ValueError, KeyError, SyntaxError, TypeError, RecursionError, MemoryError, IndexError) as error:
        raise ReadError(f"has a damaged NPY header; {TRUNCATED_HINT}") from error
    if dtype.hasobject:
        raise ReadError(f"is an NPY of Python objects, which are not read; {_HINT}")
    if len(shape) > _MOST_AXES:
        raise ReadError(f"is an array of {len(shape)} axes, which is no list of points; {_HINT}")
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
        spelt = _by_lower_case(array.dtype.names, "fields")
        fields = {name: array[field].ravel() for name, field in spelt.items() if array[field].shape == array.shape}
        _check_numbers({name: each for name, each in fields.items() if name in POINT_NAMES})
        return cloud_from_columns(fields)
    if array.dtype.kind not in _NUMBERS:
        raise ReadError(f"is an NPY of {excerpt(str(array.dtype))} instead of numbers; {_HINT}")
    if not _is_list_of_points(array):
        raise ReadError(f"is an array of shape {excerpt(str(array.shape))}, which is no list of points; {_HINT}")
    table: Floats = array.reshape(-1, array.shape[-1]).astype(np.float64)
    return cloud_without_names(table, (), lambda message, _: ReadError(f"{message}; {_HINT}"))


FORMAT = ScanFormat(".npy", "numpy's mark", is_npy, read_npy, (".npz",))
