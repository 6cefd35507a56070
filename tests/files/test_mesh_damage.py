"""Damaged meshes: one sentence, no crash, no hang, little memory."""

import json
import struct
import tracemalloc

import pytest

from stair_inspector.errors import ReadError
from stair_inspector.files import raw_mesh
from stair_inspector.files.scans import read_scan
from tests.files.damage import check_form, n_read_of_damaged
from tests.files.models import box, exported

SOLID = box((0, 0, 0), (1.0, 2.0, 0.5))
NAMES = ("a.ply", "ascii.ply", "a.obj", "a.off", "a.stl", "ascii.stl", "a.glb")
VALID = {name: exported(SOLID, name) for name in NAMES}
GLB = VALID["a.glb"]


@pytest.fixture(autouse=True)
def few_points(monkeypatch):
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 300)
    monkeypatch.setattr(raw_mesh, "POINTS_FOR_UNIT", 300)


def glb(root, binary=b"\0" * 36):
    """A GLB of a JSON and bytes."""
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def root(**changes):
    """The JSON of a triangle, changed."""
    made = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}],
    }
    return made | changes


ACCESSOR = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
MANY = [{"mesh": 0} for _ in range(2000)]
STAR = "".join(f"v {7 * k % 5000} {11 * k % 4999} 0\n" for k in range(5000)).encode()
STAR += b"f " + b" ".join(b"%d" % k for k in range(1, 5001)) + b"\n"
HUGE = {"bufferView": 0, "componentType": 5126, "count": 30_000, "type": "VEC3"}
BAD = {
    "zero.stl": (bytes(84), "does not begin with"),
    "short.stl": (VALID["a.stl"][:-1], "nor is it as long as its number of triangles says"),
    "ascii.stl": (VALID["ascii.stl"][:-30], "before 'endsolid'"),
    "word.stl": (VALID["ascii.stl"].replace(b"vertex 1", b"vertex x1", 1), "holds 'x1"),
    "columns.stl": (b"solid\nfacet\nvertex 1 2\nvertex 1 2 3\nvertex 1 2 3\nendsolid\n", "has 2 numbers instead of 3"),
    "flat.stl": (b"solid\nfacet\n" + b"vertex 1 2 3\n" * 3 + b"endsolid\n", "none of its 1 faces has an area"),
    "nan.stl": (b"solid\nfacet\n" + b"vertex nan 2 3\n" * 3 + b"endsolid\n", "none of its 1 faces has finite corners"),
    "far.stl": (b"solid\nfacet\nvertex 0 0 0\nvertex 1e300 0 0\nvertex 0 1 0\nendsolid\n", "1e+300, beyond 1e+12"),
    "star.obj": (STAR, "none of its 1 faces can be cut into triangles"),
    "none.obj": (b"o a\nf 1 2 3\nv x\n", "its vertex 1 has 1 numbers"),
    "empty.obj": (b"mtllib a.mtl\no a\n", "holds no vertices"),
    "index.obj": (
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
        "its face 1 names vertex 3 (counted from 0) but",
    ),
    "zero.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "names vertex -1"),
    "word.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 a\n", "line 4 is 'f 1 2 a', which is no face"),
    "digits.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + b"9" * 9000 + b"\n", "which is no face"),
    "number.obj": (b"v 0 0 0\nv 1 b 0\nv 0 1 0\nf 1 2 3\n", "its vertex 2 holds 'b'"),
    "lying.off": (b"OFF\n999999999999 5 0\n0 0 0\n", "states 999999999999 OFF vertices"),
    "counts.off": (b"OFF\n3\n0 0 0\n", "OFF counts are '3'"),
    "negative.off": (b"OFF\n-3 1 0\n0 0 0\n", "whole number"),
    "face.off": (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9 0 1 2\n", "states 9 corners"),
    "index.off": (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n", "names vertex 9"),
    "none.off": (b"OFF\n0 0 0\n", "no points"),
    "kind.off": (b"4OFF\n1 0 0\n0 0 0 0\n", "of the kind '4OFF'"),
    "binary.off": (b"OFF BINARY\n\0\0\0", "or binary"),
    "strips.ply": (
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        b"element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "triangle strips",
    ),
    "index.ply": (VALID["ascii.ply"].replace(b"\n3 1 3 0", b"\n3 1 3 8", 1), "names vertex 8"),
    "word.ply": (VALID["ascii.ply"].replace(b"\n3 1 3 0", b"\n3 1 3 a", 1), "its face 1 is '3 1 3 a'"),
    "fractions.ply": (VALID["a.ply"].replace(b"list uchar int", b"list uchar float"), "by fractions"),
    "magic.glb": (b"glTF", "glTF version '0'"),
    "one.glb": (b"glTF" + struct.pack("<II", 1, 20) + bytes(8), "version '1', only 2"),
    "short.glb": (GLB[:-1], "truncated"),
    "chunk.glb": (b"glTF" + struct.pack("<III", 2, 24, 999) + b"JSON" + bytes(4), "does not fit"),
    "json.glb": (GLB.replace(b'"asset"', b'"asset ', 1), "JSON is damaged"),
    "deep.glb": (b'{"asset":' + b"[" * 100_000 + b'"accessors"', "JSON is damaged"),
    "list.glb": (glb([]), "instead of an object"),
    "noversion.glb": (glb(root(asset={})), "version 'None'"),
    "draco.glb": (glb(root(extensionsRequired=["KHR_draco_mesh_compression"])), "KHR_draco_mesh_compression"),
    "empty.glb": (glb(root(meshes=[{"primitives": []}])), "neither triangles nor points"),
    "lines.glb": (
        glb(root(meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "mode": 1}]}])),
        "neither triangles",
    ),
    "loop.glb": (glb(root(nodes=[{"mesh": 0, "children": [0]}])), "has two parents"),
    "lying.glb": (glb(root(accessors=[ACCESSOR | {"count": 10**13}])), "instead of a whole number"),
    "lying2.glb": (glb(root(accessors=[ACCESSOR | {"count": 10**11}])), "leaves its 36 bytes"),
    "stride.glb": (glb(root(bufferViews=[{"buffer": 0, "byteLength": 36, "byteStride": 200}])), "leaves its 36 bytes"),
    "sparse.glb": (glb(root(accessors=[ACCESSOR | {"sparse": {}}])), "sparse"),
    "novec.glb": (glb(root(accessors=[ACCESSOR | {"type": "SCALAR"}])), "instead of VEC3"),
    "type.glb": (glb(root(accessors=[ACCESSOR | {"componentType": [1]}])), "instead of VEC3"),
    "view.glb": (glb(root(bufferViews=[])), "names 0 of its 0 glTF bufferViews"),
    "buffer.glb": (glb(root(buffers=[])), "names buffer 0 of its 0"),
    "matrix.glb": (glb(root(nodes=[{"mesh": 0, "matrix": [1]}])), "instead of 16 numbers"),
    "scale.glb": (glb(root(nodes=[{"mesh": 0, "scale": [1, "a", 1]}])), "instead of 3 numbers"),
    "node.glb": (glb(root(scenes=[{"nodes": [[1]]}])), "of its 1 glTF nodes"),
    "corners.glb": (glb(root(accessors=[ACCESSOR | {"count": 2}])), "2 glTF corners"),
    "often.glb": (
        glb(
            root(
                nodes=MANY,
                scenes=[{"nodes": list(range(2000))}],
                accessors=[HUGE],
                bufferViews=[{"buffer": 0, "byteLength": 360_000}],
            ),
            b"\0" * 360_000,
        ),
        "places its meshes so often",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_mesh(tmp_path, name):
    content, words = BAD[name]
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(ReadError) as caught:
        read_scan(path, "m")
    check_form(path, str(caught.value))
    assert words in str(caught.value)


def test_points_spread_over_a_country_are_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 5000)
    path = tmp_path / "a.obj"
    path.write_bytes(b"v 0 0 0\nv 1e9 0 0\nv 0 1e9 0\nf 1 2 3\n")
    with pytest.raises(ReadError, match="spread over many kilometres; cut out the staircase") as caught:
        read_scan(path, "m")
    check_form(path, str(caught.value))


@pytest.mark.parametrize("name", ["lying.off", "lying2.glb", "sparse.glb", "stride.glb", "digits.obj"])
def test_lying_counts_allocate_nothing(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(BAD[name][0])
    tracemalloc.start()
    with pytest.raises(ReadError):
        read_scan(path, "m")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 5e6


@pytest.mark.parametrize("name", NAMES)
def test_two_hundred_damaged_meshes_give_a_sentence_or_a_scan(name):
    assert n_read_of_damaged(name, VALID[name], seed=5) > 0
