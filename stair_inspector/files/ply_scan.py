"""Reading PLY: ascii and both binary byte orders, any scalar types, other elements and properties ignored.

numpy reads the body, not Open3D: Open3D returns uninitialised memory as points where a file is shorter than its header
states, and this module has to walk the elements anyway to find that out.
"""

from dataclasses import dataclass, field

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import (
    TRUNCATED_HINT,
    NumberLines,
    RawCloud,
    ScanFormat,
    as_declared,
    check_rest_is_padding,
    cloud_from_columns,
    cut_note,
    excerpt,
    parse_count,
    strided_column,
)

_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
_BYTE_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
_HEADER_LINES = 10_000
_LINE_BYTES = 4096
_ELEMENT_HINT = "export the scan again"


@dataclass(frozen=True, slots=True)
class PlyProperty:
    """A property: numpy type codes with byte order; ``count_type`` is None unless it is a list."""

    name: str
    type: str
    count_type: str | None = None

    @property
    def size(self) -> int:
        """Bytes of one value."""
        return np.dtype(self.type).itemsize


@dataclass(slots=True)
class PlyElement:
    """An element of the header: how many rows, and what is in one."""

    name: str
    count: int
    properties: list[PlyProperty] = field(default_factory=list)

    @property
    def has_lists(self) -> bool:
        """Whether rows may differ in size."""
        return any(item.count_type is not None for item in self.properties)

    @property
    def smallest_row(self) -> int:
        """Bytes of a row, every list empty."""
        return sum(
            item.size if item.count_type is None else np.dtype(item.count_type).itemsize for item in self.properties
        )


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """A checked header: ``format``, elements in the order of the body, byte offset of the body."""

    format: str
    elements: tuple[PlyElement, ...]
    body: int

    @property
    def vertex(self) -> PlyElement:
        """The element that holds the points."""
        return next(element for element in self.elements if element.name == "vertex")


def is_ply(data: bytes) -> bool:
    """Return whether a file begins as PLY does."""
    return data[:4] in (b"ply", b"ply\n", b"ply\r", b"ply ", b"ply\t")


def parse_ply_header(data: bytes) -> PlyHeader:
    """Parse and check the header of a PLY file.

    Raises
    ------
    ReadError
        Cut off, unknown format, type or keyword, a count that is no count, no vertices or two kinds of them.
    """
    at = data.find(b"\n", 0, _LINE_BYTES) + 1
    form: str | None = None
    elements: list[PlyElement] = []
    for _ in range(_HEADER_LINES):
        end = data.find(b"\n", at, at + _LINE_BYTES)
        if at == 0 or end < 0:
            break
        line = data[at:end].strip()
        at = end + 1
        words = line.decode("latin-1").split()
        keyword = words[0] if words else "comment"
        if keyword in ("comment", "obj_info"):
            continue
        if words == ["end_header"]:
            return PlyHeader(_checked_format(form), _checked_elements(elements), at)
        if keyword == "format" and len(words) == 3 and form is None and not elements:
            form = words[1]
            _checked_format(form)
            if words[2] != "1.0":
                raise ReadError(f"is PLY version '{excerpt(words[2])}', only 1.0 is known; {_ELEMENT_HINT}")
        elif keyword == "element" and len(words) == 3 and form is not None:
            elements.append(PlyElement(words[1], parse_count(words[2], f"the number of PLY '{excerpt(words[1])}'")))
        elif keyword == "property" and elements:
            elements[-1].properties.append(_property(words, _BYTE_ORDERS[_checked_format(form)]))
        else:
            raise ReadError(
                f"its PLY header has the line '{excerpt(line)}', which means nothing there; {_ELEMENT_HINT}"
            )
    raise ReadError(f"its PLY header does not end with 'end_header'; {TRUNCATED_HINT}")


def _checked_format(form: str | None) -> str:
    if form is None:
        raise ReadError(f"its PLY header has no 'format' line; {_ELEMENT_HINT}")
    if form not in _BYTE_ORDERS:
        raise ReadError(f"its PLY format is '{excerpt(form)}', known are {', '.join(_BYTE_ORDERS)}; {_ELEMENT_HINT}")
    return form


def _property(words: list[str], order: str) -> PlyProperty:
    is_list = len(words) == 5 and words[1] == "list"
    types = words[2:4] if is_list else words[1:2]
    unknown = [word for word in types if word not in _TYPES]
    if unknown or not (is_list or len(words) == 3):
        raise ReadError(f"its PLY header has the property '{excerpt(' '.join(words[1:]))}', unknown; {_ELEMENT_HINT}")
    codes = [order + _TYPES[word] for word in types]
    if is_list and "f" in codes[0]:
        raise ReadError(f"the PLY list '{excerpt(words[4])}' has lengths that are not whole numbers; {_ELEMENT_HINT}")
    return PlyProperty(words[-1].lower(), codes[-1], codes[0] if is_list else None)


def _checked_elements(elements: list[PlyElement]) -> tuple[PlyElement, ...]:
    vertices = [element for element in elements if element.name == "vertex"]
    if len(vertices) != 1:
        raise ReadError(f"its PLY header describes 'vertex' {len(vertices)} times instead of once; {_ELEMENT_HINT}")
    names = [item.name for item in vertices[0].properties]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ReadError(f"its PLY vertices have the property '{excerpt(twice[0])}' twice; {_ELEMENT_HINT}")
    if vertices[0].count == 0 or not names:
        raise ReadError(
            f"its PLY header states {vertices[0].count} points with {len(names)} properties; {_ELEMENT_HINT}"
        )
    if vertices[0].has_lists:
        raise ReadError("its PLY vertices have a list property, which is not supported; export the points without it")
    return tuple(elements)


def read_ply(data: bytes) -> RawCloud:
    """Read the vertices of a PLY file.

    Parameters
    ----------
    data : bytes
        The whole file.

    Returns
    -------
    RawCloud
        Ascii numbers as float64 whatever their declared floating type; binary ones as stored.

    Raises
    ------
    ReadError
        The header is damaged or does not fit the body: bytes or lines missing or left over, text that is no number.
    """
    if b"\n" not in data[: _LINE_BYTES * 16]:
        # Old Macintosh line ends; in a binary body nothing may be replaced, and its header is then refused.
        data = data.replace(b"\r", b"\n") if b"format ascii" in data[:_LINE_BYTES] else data
    header = parse_ply_header(data)
    return _read_ascii(data, header) if header.format == "ascii" else _read_binary(data, header)


def _read_ascii(data: bytes, header: PlyHeader) -> RawCloud:
    vertex = header.vertex
    # One row of an element is one line; an element without properties has none.
    counts = [element.count if element.properties else 0 for element in header.elements]
    n_before = sum(counts[: header.elements.index(vertex)])
    n_expected_after = sum(counts) - n_before - vertex.count
    values, n_after, is_cut = NumberLines(data, header.body, len(vertex.properties), vertex.count, n_before).parse()
    if n_after != n_expected_after:
        hint = TRUNCATED_HINT if n_after < n_expected_after else "the header is wrong, export the scan again"
        raise ReadError(
            f"the lines after its {vertex.count} points should be {n_expected_after}, got {n_after}; {hint}"
        )
    columns = {
        item.name: as_declared(column, np.dtype(item.type))
        for item, column in zip(vertex.properties, values.T, strict=True)
    }
    return cloud_from_columns(columns, cut_note() if is_cut else ())


def _read_binary(data: bytes, header: PlyHeader) -> RawCloud:
    at = begin = header.body
    for element in header.elements:
        begin = at if element is header.vertex else begin
        at = _end_of(data, at, element)
    vertex = header.vertex
    check_rest_is_padding(data[at:], vertex.count)
    columns = {}
    for item in vertex.properties:
        columns[item.name] = strided_column(data, item.type, vertex.count, begin, vertex.smallest_row)
        begin += item.size
    return cloud_from_columns(columns)


def _end_of(data: bytes, at: int, element: PlyElement) -> int:
    """Return the offset after a binary element, or refuse a file that ends before."""
    _check_fits(data, at, element, element.count * element.smallest_row)
    if not element.has_lists or element.count == 0:
        return at + element.count * element.smallest_row
    # Nearly all meshes have lists of one length: try that of the first row for all.
    first, lengths = _walk_row(data, at, element)
    stride = first - at
    if at + element.count * stride <= len(data) and all(
        (strided_column(data, count_type, element.count, at + offset, stride) == length).all()
        for count_type, offset, length in lengths
    ):
        return at + element.count * stride
    end = at
    for _ in range(element.count):
        end, _ = _walk_row(data, end, element)
    return end


def _walk_row(data: bytes, at: int, element: PlyElement) -> tuple[int, list[tuple[str, int, int]]]:
    """Return the offset after one row, and the type, offset in the row and value of each list length in it."""
    begin = at
    lengths = []
    for item in element.properties:
        if item.count_type is not None:
            count_type = np.dtype(item.count_type)
            raw = data[at : at + count_type.itemsize]
            is_big = item.count_type.startswith(">")
            length = int.from_bytes(raw, "big" if is_big else "little", signed=count_type.kind == "i")
            if length < 0:
                raise ReadError(f"its PLY '{excerpt(element.name)}' has a list of length {length}; {_ELEMENT_HINT}")
            lengths.append((item.count_type, at - begin, length))
            at += count_type.itemsize + length * item.size
        else:
            at += item.size
        _check_fits(data, at, element, 0)
    return at, lengths


def _check_fits(data: bytes, at: int, element: PlyElement, needed: int) -> None:
    if at + needed > len(data):
        raise ReadError(
            f"its header states {element.count} PLY '{excerpt(element.name)}' but the data ends before "
            f"({max(len(data) - at, 0)} bytes left); {TRUNCATED_HINT}"
        )


FORMAT = ScanFormat(".ply", "'ply'", is_ply, read_ply)
