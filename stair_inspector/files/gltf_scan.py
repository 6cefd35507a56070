"""Reading glTF 2, as GLB or with embedded bytes: triangles or points in metres, turned from y-up to z-up."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.gltf_document import HINT, GltfDocument, as_dict, as_list, parse_gltf
from stair_inspector.files.raw_cloud import READ_STAGE, RawCloud, RawMesh, ScanFormat, excerpt
from stair_inspector.geometry.arrays import Colors, Floats, Ints
from stair_inspector.model import Note

_SNIFFED_BYTES = 65_536
_POINTS, _TRIANGLES, _STRIP, _FAN = 0, 4, 5, 6
_TRIANGLES_PER_BYTE, _TRIANGLES_AT_LEAST = 1 / 3, 5_000_000
"""A file may place a mesh a thousand times, so that few bytes stand for many triangles."""
_Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def is_gltf(data: bytes) -> bool:
    """Return whether a file is a GLB, or begins as the JSON of a glTF."""
    return data.startswith(b"glTF") or (data.lstrip()[:1] == b"{" and b'"asset"' in data and b'"accessors"' in data)


def read_gltf(data: bytes) -> RawCloud | RawMesh:
    """Read a glTF file: its default scene, or its first one.

    Raises
    ------
    ReadError
        Damaged, in need of an extension or of another file, without triangles and points, or with meshes placed so
        often that they would not fit into the memory.
    """
    document = parse_gltf(data)
    limit = _TRIANGLES_AT_LEAST + int(len(data) * _TRIANGLES_PER_BYTE)
    corners: list[Floats] = []
    points: list[Floats] = []
    colors: list[Colors | None] = []
    total = 0
    for primitive, placed in _placed_primitives(document):
        attributes = as_dict(primitive.get("attributes", {}), "attributes")
        mode = primitive.get("mode", _TRIANGLES)
        if "POSITION" not in attributes or mode not in (_POINTS, _TRIANGLES, _STRIP, _FAN):
            continue
        table = document.table(attributes["POSITION"], ("VEC3",))
        picked = _picked(document, primitive, len(table), mode)
        total += len(picked)
        if total > limit:
            raise ReadError(f"places its meshes so often that there are more than {limit:,} triangles; {HINT}")
        # A signalling NaN must not raise numpy's warning.
        with np.errstate(invalid="ignore", over="ignore"):
            places = table[picked].astype(np.float64) @ placed[:3, :3].T + placed[:3, 3]
        (points if mode == _POINTS else corners).append(places @ _Z_UP.T)
        if mode != _POINTS:
            colors.append(_colors(document, attributes, picked))
    notes = (Note("turned_z_up", READ_STAGE, "glTF: in metres, with y up; turned so that z is up"),)
    if corners:
        known = [each for each in colors if each is not None]
        whole = np.concatenate(known).astype(np.float64) if len(known) == len(colors) else None
        return RawMesh(np.concatenate(corners), whole, "m", notes)
    if points:
        return RawCloud(np.concatenate(points), notes=notes, unit="m")
    raise ReadError(f"holds neither triangles nor points; {HINT}")


def _placed_primitives(document: GltfDocument) -> Iterator[tuple[dict[str, Any], Floats]]:
    """Yield each primitive of the scene with its place, a (4, 4) matrix."""
    scenes, nodes = document.entries("scenes"), document.entries("nodes")
    if scenes:
        roots = as_list(document.entry("scenes", document.root.get("scene", 0)).get("nodes", []), "scene")
    else:
        roots = list(range(len(nodes)))
    waiting = [(index, np.eye(4)) for index in roots]
    seen: set[int] = set()
    while waiting:
        index, above = waiting.pop()
        node = document.entry("nodes", index)
        if index in seen:
            raise ReadError(f"its glTF node {index} has two parents; {HINT}")
        seen.add(index)
        placed = above @ _matrix(node)
        if not np.isfinite(placed).all():
            raise ReadError(f"its glTF node {index} has a place that is not finite; {HINT}")
        waiting += [(child, placed) for child in as_list(node.get("children", []), "children")]
        if "mesh" in node:
            mesh = document.entry("meshes", node["mesh"])
            for primitive in as_list(mesh.get("primitives", []), "primitives"):
                yield as_dict(primitive, "primitive"), placed


def _matrix(node: dict[str, Any]) -> Floats:
    """Return where a node is in its parent, (4, 4)."""
    if "matrix" in node:
        return _numbers(node, "matrix", [0.0] * 16).reshape(4, 4).T
    x, y, z, w = _numbers(node, "rotation", [0.0, 0.0, 0.0, 1.0])
    placed = np.eye(4)
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    placed[:3, :3] = np.array(turn) * _numbers(node, "scale", [1.0, 1.0, 1.0])
    placed[:3, 3] = _numbers(node, "translation", [0.0, 0.0, 0.0])
    return placed


def _numbers(node: dict[str, Any], key: str, default: list[float]) -> Floats:
    values = as_list(node.get(key, default), key)
    is_fine = len(values) == len(default) and all(
        isinstance(value, int | float) and abs(value) < 1e30 for value in values
    )
    if not is_fine:
        raise ReadError(f"its glTF {key} is {excerpt(str(values))} instead of {len(default)} numbers; {HINT}")
    return np.array(values, dtype=np.float64)


def _picked(document: GltfDocument, primitive: dict[str, Any], n_vertices: int, mode: int) -> Ints:
    """Return the vertices of each triangle (n, 3), or of each point (n,)."""
    if "indices" in primitive:
        stored = document.table(primitive["indices"], ("SCALAR",))
        if stored.dtype.kind != "u":
            raise ReadError(f"its glTF indices are not whole numbers; {HINT}")
        indices: Ints = stored[:, 0].astype(np.int64)
        if len(indices) and int(indices.max()) >= n_vertices:
            raise ReadError(f"a glTF triangle names vertex {int(indices.max())} of {n_vertices}; {HINT}")
    else:
        indices = np.arange(n_vertices)
    if mode == _POINTS:
        return indices
    if mode == _TRIANGLES:
        if len(indices) % 3:
            raise ReadError(f"has {len(indices)} glTF corners, which is no number of triangles; {HINT}")
        return indices.reshape(-1, 3)
    first = indices[:-2] if mode == _STRIP else np.full(max(len(indices) - 2, 0), indices[0] if len(indices) else 0)
    return np.stack([first, indices[1:-1], indices[2:]], axis=1)


def _colors(document: GltfDocument, attributes: dict[str, Any], picked: Ints) -> Colors | None:
    """Return the colours of the corners (n, 3, 3), None where they have none."""
    if "COLOR_0" not in attributes:
        return None
    table = document.table(attributes["COLOR_0"], ("VEC3", "VEC4"))[:, :3]
    if len(table) <= int(picked.max(initial=-1)):
        raise ReadError(f"has {len(table)} glTF colours for more vertices; {HINT}")
    values = np.nan_to_num(table[picked].astype(np.float64), nan=0.0, posinf=1.0, neginf=0.0)
    return np.rint(255.0 * np.clip(values, 0.0, 1.0)).astype(np.uint8)


FORMAT = ScanFormat(".glb", "'glTF' or the JSON of a glTF", is_gltf, read_gltf, (".gltf",), is_for_meshes=True)
