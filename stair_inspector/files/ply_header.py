"""The header of a PLY file: which elements, how many, and what is in a row of each."""

from dataclasses import dataclass, field

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt, parse_count

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
_FACE_NAMES = ("vertex_indices", "vertex_index")
_HEADER_LINES = 10_000
LINE_BYTES = 4096
ELEMENT_HINT = "export the scan again"


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
    def faces(self) -> PlyProperty | None:
        """The list that makes each row a face: the numbers of its corners."""
        return next((item for item in self.properties if item.count_type and item.name in _FACE_NAMES), None)

    @property
    def scalars(self) -> tuple[PlyProperty, ...]:
        """The properties of one value."""
        return tuple(item for item in self.properties if item.count_type is None)

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

    @property
    def face(self) -> PlyElement | None:
        """The element that holds the faces, None where there are none."""
        return next((each for each in self.elements if each.name == "face" and each.faces and each.count), None)


def parse_ply_header(data: bytes) -> PlyHeader:
    """Parse and check the header of a PLY file.

    Raises
    ------
    ReadError
        Cut off, unknown format, type or keyword, a count that is no count, no vertices or two kinds of them.
    """
    at = data.find(b"\n", 0, LINE_BYTES) + 1
    form: str | None = None
    elements: list[PlyElement] = []
    for _ in range(_HEADER_LINES):
        end = data.find(b"\n", at, at + LINE_BYTES)
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
                raise ReadError(f"is PLY version '{excerpt(words[2])}', only 1.0 is known; {ELEMENT_HINT}")
        elif keyword == "element" and len(words) == 3 and form is not None:
            elements.append(PlyElement(words[1], parse_count(words[2], f"the number of PLY '{excerpt(words[1])}'")))
        elif keyword == "property" and elements:
            elements[-1].properties.append(_property(words, _BYTE_ORDERS[_checked_format(form)]))
        else:
            raise ReadError(f"its PLY header has the line '{excerpt(line)}', which means nothing there; {ELEMENT_HINT}")
    raise ReadError(f"its PLY header does not end with 'end_header'; {TRUNCATED_HINT}")


def _checked_format(form: str | None) -> str:
    if form is None:
        raise ReadError(f"its PLY header has no 'format' line; {ELEMENT_HINT}")
    if form not in _BYTE_ORDERS:
        raise ReadError(f"its PLY format is '{excerpt(form)}', known are {', '.join(_BYTE_ORDERS)}; {ELEMENT_HINT}")
    return form


def _property(words: list[str], order: str) -> PlyProperty:
    is_list = len(words) == 5 and words[1] == "list"
    types = words[2:4] if is_list else words[1:2]
    unknown = [word for word in types if word not in _TYPES]
    if unknown or not (is_list or len(words) == 3):
        raise ReadError(f"its PLY header has the property '{excerpt(' '.join(words[1:]))}', unknown; {ELEMENT_HINT}")
    codes = [order + _TYPES[word] for word in types]
    if is_list and "f" in codes[0]:
        raise ReadError(f"the PLY list '{excerpt(words[4])}' has lengths that are not whole numbers; {ELEMENT_HINT}")
    if is_list and "f" in codes[1] and words[4].lower() in _FACE_NAMES:
        raise ReadError(f"the PLY list '{excerpt(words[4])}' numbers corners by fractions; {ELEMENT_HINT}")
    return PlyProperty(words[-1].lower(), codes[-1], codes[0] if is_list else None)


def _checked_elements(elements: list[PlyElement]) -> tuple[PlyElement, ...]:
    vertices = [element for element in elements if element.name == "vertex"]
    if len(vertices) != 1:
        raise ReadError(f"its PLY header describes 'vertex' {len(vertices)} times instead of once; {ELEMENT_HINT}")
    names = [item.name for item in vertices[0].properties]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ReadError(f"its PLY vertices have the property '{excerpt(twice[0])}' twice; {ELEMENT_HINT}")
    count, n_scalars = vertices[0].count, len(vertices[0].scalars)
    if count == 0 or n_scalars == 0:
        raise ReadError(f"its PLY header states {count} points with {n_scalars} properties; {ELEMENT_HINT}")
    if any(element.name == "tristrips" and element.count for element in elements):
        raise ReadError("its PLY faces are triangle strips, which are not read; export the mesh with single faces")
    return tuple(elements)
