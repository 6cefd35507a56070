"""The inside of a glTF file: JSON, bytes, and the tables of numbers in them, checked before they are believed."""

import base64
import binascii
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stair_inspector.errors import ReadError
from stair_inspector.files.raw_cloud import TRUNCATED_HINT, excerpt

HINT = "export the mesh again as GLB"
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_JSON, _BIN = b"JSON", b"BIN\0"
_HARMLESS = ("KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_mesh_quantization", "EXT_texture_", "MSFT_texture_")
"""Required extensions by which nothing of the shape changes."""
_EMBEDDED = "data:"


@dataclass(frozen=True, slots=True, eq=False)
class GltfDocument:
    """A glTF file: the JSON at its root, and the bytes of each buffer, in their order."""

    root: dict[str, Any]
    buffers: tuple[bytes, ...]

    def entries(self, name: str) -> list[Any]:
        """Return a list of the root, empty where there is none."""
        return as_list(self.root.get(name, []), name)

    def entry(self, name: str, index: Any) -> dict[str, Any]:
        """Return an entry of a list of the root.

        Raises
        ------
        ReadError
            There is no such list or entry.
        """
        entries = self.entries(name)
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(entries):
            raise ReadError(f"names {excerpt(str(index))} of its {len(entries)} glTF {name}; {HINT}")
        return as_dict(entries[index], name)

    def table(self, index: Any, types: tuple[str, ...]) -> NDArray[Any]:
        """Return the numbers of an accessor.

        Parameters
        ----------
        index : int
            Of the accessor.
        types : tuple of str
            What it may hold, as glTF names it.

        Returns
        -------
        (n, k)
            As stored; normalized integers as float64 from -1 to 1.

        Raises
        ------
        ReadError
            It leaves the file, or is sparse or of another type.
        """
        accessor = self.entry("accessors", index)
        kind, code = accessor.get("type"), accessor.get("componentType")
        if kind not in types or not isinstance(code, int) or code not in _TYPES:
            raise ReadError(
                f"its glTF accessor {index} holds {excerpt(f'{kind} {code}')} instead of {types[0]}; {HINT}"
            )
        if "sparse" in accessor or "bufferView" not in accessor:
            raise ReadError(f"its glTF accessor {index} is sparse, which is not read; {HINT}")
        view = self.entry("bufferViews", accessor["bufferView"])
        number = whole(view, "buffer")
        if number >= len(self.buffers):
            raise ReadError(f"names buffer {number} of its {len(self.buffers)} glTF buffers; {HINT}")
        data = self.buffers[number]
        width, dtype = _WIDTHS[str(kind)], np.dtype(_TYPES[code])
        count = whole(accessor, "count")
        stride = whole(view, "byteStride") or width * dtype.itemsize
        begin = whole(view, "byteOffset") + whole(accessor, "byteOffset")
        end = min(len(data), whole(view, "byteOffset") + whole(view, "byteLength"))
        if count and begin + (count - 1) * stride + width * dtype.itemsize > end:
            raise ReadError(f"its glTF accessor {index} of {count} leaves its {len(data)} bytes; {TRUNCATED_HINT}")
        table: NDArray[Any] = np.ndarray((count, width), dtype, data, begin if count else 0, (stride, dtype.itemsize))
        if accessor.get("normalized") is True and dtype.kind != "f":
            return np.maximum(table / float(np.iinfo(dtype).max), -1.0)
        return table


def as_dict(value: Any, what: str) -> dict[str, Any]:
    """Return a value of the JSON that must be an object."""
    if not isinstance(value, dict):
        raise ReadError(f"its glTF {what} is {excerpt(str(value))} instead of an object; {HINT}")
    return value


def as_list(value: Any, what: str) -> list[Any]:
    """Return a value of the JSON that must be a list."""
    if not isinstance(value, list):
        raise ReadError(f"its glTF {what} is {excerpt(str(value))} instead of a list; {HINT}")
    return value


def whole(entry: dict[str, Any], key: str) -> int:
    """Return a whole number of an object, 0 where it has none."""
    value = entry.get(key, 0)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**40:
        raise ReadError(f"its glTF {key} is {excerpt(str(value))} instead of a whole number; {HINT}")
    return value


def parse_gltf(data: bytes) -> GltfDocument:
    """Parse a GLB file, or a glTF one that holds its numbers itself.

    Raises
    ------
    ReadError
        Damaged, of version 1, in need of an extension or of another file.
    """
    text, binary = _chunks(data) if data.startswith(b"glTF") else (data, None)
    try:
        parsed = json.loads(text.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise ReadError(f"its glTF JSON is damaged ({excerpt(str(error))}); {TRUNCATED_HINT}") from error
    root = as_dict(parsed, "root")
    version = as_dict(root.get("asset", {}), "asset").get("version")
    if not str(version).startswith("2"):
        raise ReadError(f"is glTF version '{excerpt(str(version))}', only 2 is read; {HINT}")
    for name in as_list(root.get("extensionsRequired", []), "extensionsRequired"):
        if not str(name).startswith(_HARMLESS):
            raise ReadError(f"needs the glTF extension '{excerpt(str(name))}', which is not read; export it without")
    buffers = as_list(root.get("buffers", []), "buffers")
    return GltfDocument(root, tuple(_buffer(as_dict(each, "buffer"), k, binary) for k, each in enumerate(buffers)))


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    """Return the JSON and the bytes of a GLB."""
    version, length = (int.from_bytes(data[at : at + 4], "little") for at in (4, 8))
    if version != 2:
        raise ReadError(f"is glTF version '{version}', only 2 is read; {HINT}")
    if length > len(data) or length < 20:
        raise ReadError(f"its GLB header states {length} bytes but there are {len(data)}; {TRUNCATED_HINT}")
    chunks: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
        if at + 8 + size > length:
            raise ReadError(f"a GLB chunk of {size} bytes does not fit its {length}; {TRUNCATED_HINT}")
        chunks.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size + -size % 4
    if _JSON not in chunks:
        raise ReadError(f"has no JSON in its GLB; {HINT}")
    return chunks[_JSON], chunks.get(_BIN)


def _buffer(entry: dict[str, Any], number: int, binary: bytes | None) -> bytes:
    uri = entry.get("uri")
    if uri is None:
        if number or binary is None:
            raise ReadError(f"has no bytes for its glTF buffer {number}; {HINT}")
        return binary
    if not str(uri).startswith(_EMBEDDED):
        raise ReadError(f"keeps its numbers in another file ('{excerpt(str(uri))}'); export the mesh as GLB, one file")
    try:
        return base64.b64decode(str(uri).partition(",")[2], validate=True)
    except (binascii.Error, ValueError) as error:
        raise ReadError(f"its glTF buffer {number} is no base64; {TRUNCATED_HINT}") from error
