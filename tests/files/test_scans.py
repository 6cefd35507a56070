"""Reading scans: every variant of every format, exactly; units, origin, what is dropped; the real captures."""

import hashlib
import io
import struct
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from stair_inspector.errors import ConfigError, ReadError
from stair_inspector.files import raw_mesh
from stair_inspector.files.cleaning import first_occurrences
from stair_inspector.files.lzf import lzf_decompress
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import SUFFIXES, find_scans, read_scan
from stair_inspector.model import Scan
from stair_inspector.params import ScanUnit
from stair_inspector.units import METRES_PER_UNIT
from tests.oracles import open3d_or_skip

REAL = Path(__file__).parents[2].parent / "shared" / "scans"

POINTS = np.array([[0.1, -2.5, 3.0], [1 / 3, 1e-7, -0.25], [12.0, 7.125, 2.0]])
COLORS = np.array([[255, 0, 1], [2, 128, 254], [7, 8, 9]], dtype=np.uint8)
NORMALS = np.array([[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [-1.0, 0.0, 0.0]])

PLY_CODES = {"float": "f4", "double": "f8", "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4"}
PLY_CODES |= {"uint": "u4", "float32": "f4", "float64": "f8", "int16": "i2", "uint8": "u1"}
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def ply_file(form: str, properties: str, rows: list[tuple[float, ...]], before: str = "", after: str = "") -> bytes:
    """A PLY of vertices: ``properties`` is "double x, double y, ...", ``before`` and ``after`` are header lines."""
    pairs = [tuple(item.split()) for item in properties.split(",")]
    lines = ["ply", f"format {form} 1.0", "comment by hand", *before.splitlines(), f"element vertex {len(rows)}"]
    lines += [f"property {kind} {name}" for kind, name in pairs] + [*after.splitlines(), "end_header"]
    head = ("\n".join(lines) + "\n").encode()
    if form == "ascii":
        return head + "".join(" ".join(repr(v) for v in row) + "\n" for row in rows).encode()
    dtype = [(name, ORDERS[form] + PLY_CODES[kind]) for kind, name in pairs]
    return head + np.array(rows, dtype=dtype).tobytes()


def pcd_file(fields: str, rows: list[tuple[float, ...]], data: str = "binary", n: int | None = None) -> bytes:
    """A PCD; ``fields`` is "x:F8 y:F8 ...", a field of several values "name:F4x3"."""
    parts = [item.split(":") for item in fields.split()]
    names = [name for name, _ in parts]
    kinds, sizes = [code[0] for _, code in parts], [code[1] for _, code in parts]
    counts = [code[3:] or "1" for _, code in parts]
    n = len(rows) if n is None else n
    head = (
        f"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {' '.join(names)}\nSIZE {' '.join(sizes)}\n"
        f"TYPE {' '.join(kinds)}\nCOUNT {' '.join(counts)}\nWIDTH {n}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {n}\nDATA {data}\n"
    ).encode()
    if data == "ascii":
        return head + "".join(" ".join(repr(v) for v in row) + "\n" for row in rows).encode()
    flat = [f"<{k.lower()}{s}" for k, s, c in zip(kinds, sizes, counts, strict=True) for _ in range(int(c))]
    table = np.array(rows, dtype=[(f"f{i}", code) for i, code in enumerate(flat)])
    if data == "binary":
        return head + table.tobytes()
    at, columns = 0, b""
    for count in filter(None, map(int, counts)):
        columns += (
            table[[f"f{i}" for i in range(at, at + count)]]
            .copy()
            .astype([(f"f{i}", flat[i]) for i in range(at, at + count)])
            .tobytes()
        )
        at += count
    packed = b"".join(bytes([len(columns[i : i + 32]) - 1]) + columns[i : i + 32] for i in range(0, len(columns), 32))
    return head + struct.pack("<II", len(packed), len(columns)) + packed


def with_colors(points: np.ndarray = POINTS) -> list[tuple[float, ...]]:
    return [(*p, *map(int, c)) for p, c in zip(points.tolist(), COLORS, strict=True)]


def read(tmp_path: Path, name: str, content: bytes | str, unit: ScanUnit = "m") -> Scan:
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_scan(path, unit)


def codes(scan: Scan) -> list[str]:
    return [note.code for note in scan.notes]


@contextmanager
def quiet() -> Iterator[None]:
    """The oracles may warn of what they like."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


# --- PLY ---


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
@pytest.mark.parametrize("kind", ["float", "double", "float32", "float64"])
def test_ply_keeps_every_bit(tmp_path: Path, form: str, kind: str) -> None:
    rows = [(*row, i) for i, row in enumerate(with_colors())]
    props = f"{kind} x,{kind} y,{kind} z,uchar red,uchar green,uchar blue,int scan_id"
    scan = read(tmp_path, "a.ply", ply_file(form, props, rows))
    is_rounded = PLY_CODES[kind] == "f4" and form != "ascii"
    expected = POINTS.astype(np.float32).astype(np.float64) if is_rounded else POINTS
    assert np.array_equal(scan.points, expected)
    assert scan.colors is not None
    assert np.array_equal(scan.colors, COLORS)
    assert scan.normals is None
    assert (scan.n_points, scan.unit, scan.notes) == (3, "m", ())


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
@pytest.mark.parametrize("kind", ["char", "uchar", "short", "ushort", "int", "uint"])
def test_ply_reads_whole_number_coordinates(tmp_path: Path, form: str, kind: str) -> None:
    low = 0 if kind.startswith("u") else -100
    rows = [(low, 1, 2), (100, 50, 3)]
    scan = read(tmp_path, "a.ply", ply_file(form, f"{kind} x,{kind} y,{kind} z", rows))
    assert np.array_equal(scan.points, np.array(rows, dtype=float))


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
def test_ply_properties_in_any_order_and_normals(tmp_path: Path, form: str) -> None:
    rows = [(n[0], p[2], n[1], p[0], 9.0, n[2], p[1]) for p, n in zip(POINTS.tolist(), NORMALS.tolist(), strict=True)]
    props = "double nx,double z,double ny,double x,float quality,double nz,double y"
    scan = read(tmp_path, "a.ply", ply_file(form, props, rows))
    assert np.array_equal(scan.points, POINTS)
    assert scan.normals is not None
    assert np.allclose(scan.normals, NORMALS, atol=1e-16)


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
@pytest.mark.parametrize("lengths", [(2, 2, 2), (0, 3, 1)])
def test_ply_lists_among_the_vertices_are_left_out(tmp_path: Path, form: str, lengths: tuple[int, ...]) -> None:
    head = f"ply\nformat {form} 1.0\nelement vertex 3\nproperty double x\nproperty list uchar short views\n"
    head += "property double y\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty double z\n"
    body = b""
    for (x, y, z), color, length in zip(POINTS.tolist(), COLORS.tolist(), lengths, strict=True):
        row = (x, length, *range(length), y, *color, z)
        if form == "ascii":
            body += (" ".join(map(repr, row)) + "\n").encode()
        else:
            body += struct.pack(f"{ORDERS[form]}dB{length}hd3Bd", *row)
    scan = read(tmp_path, "a.ply", f"{head}end_header\n".encode() + body)
    assert np.array_equal(scan.points, POINTS)
    assert np.array_equal(scan.colors, COLORS)


def test_ply_columns_that_its_header_does_not_name_are_ignored_with_a_note(tmp_path: Path) -> None:
    rows = [(*p, 0, 7) for p in POINTS.tolist()]
    content = ply_file("ascii", "double x,double y,double z", rows)
    scan = read(tmp_path, "a.ply", content)
    assert np.array_equal(scan.points, POINTS)
    (note,) = scan.notes
    assert note.code == "columns_ignored"
    assert note.message == "its header names 3 columns but its lines have 5: columns 4 to 5 ignored"
    with pytest.raises(ReadError, match="line 10 should have 5 columns, got 4"):
        read(tmp_path, "b.ply", content.replace(b" 0 7\n", b" 7\n").replace(b" 7\n", b" 0 7\n", 1))


FACES = [(0, 1, 2), (2, 1, 0, 1), (0, 2, 1)]
FACE_HEADER = "element face {n}\nproperty list uchar int vertex_indices\nproperty uchar flag"


def face_bytes(form: str, faces: list[tuple[int, ...]]) -> bytes:
    if form == "ascii":
        return "".join(f"{len(face)} {' '.join(map(str, face))} 7\n" for face in faces).encode()
    order = ORDERS[form]
    return b"".join(struct.pack(f"{order}B{len(face)}iB", len(face), *face, 7) for face in faces)


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
@pytest.mark.parametrize("faces", [FACES, FACES[:1] * 5, []])
def test_ply_reads_faces_before_and_after_the_points_and_notices_missing_ones(
    tmp_path: Path, form: str, faces: list[tuple[int, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 50)
    header = FACE_HEADER.format(n=len(faces))
    props, body = "double x,double y,double z", face_bytes(form, faces)
    after = ply_file(form, props, [tuple(p) for p in POINTS.tolist()], after=header) + body
    plain = ply_file(form, props, [tuple(p) for p in POINTS.tolist()], before=header)
    cut = plain.index(b"end_header\n") + len(b"end_header\n")
    scan = read(tmp_path, "a.ply", after)
    assert np.array_equal(read(tmp_path, "b.ply", plain[:cut] + body + plain[cut:]).points, scan.points)
    if not faces:
        assert np.array_equal(scan.points, POINTS)
        return
    assert len(scan.points) == 50
    # All lie in the triangle of the three points.
    weights = np.linalg.solve(POINTS.T, scan.points.T)
    assert weights.min() > -1e-9
    assert np.allclose(weights.sum(axis=0), 1.0)
    if faces:
        with pytest.raises(ReadError, match="truncated"):
            read(tmp_path, "c.ply", after[: -2 if form != "ascii" else -10])


@pytest.mark.parametrize("ends", [b"\r\n", b"\r"])
def test_ply_line_ends_of_other_systems(tmp_path: Path, ends: bytes) -> None:
    rows = [tuple(p) for p in POINTS.tolist()]
    ascii_file = ply_file("ascii", "double x,double y,double z", rows).replace(b"\n", ends)
    assert np.array_equal(read(tmp_path, "a.ply", ascii_file).points, POINTS)
    if ends == b"\r\n":
        head, body = ply_file("binary_little_endian", "double x,double y,double z", rows).split(b"end_header\n")
        assert np.array_equal(
            read(tmp_path, "b.ply", (head + b"end_header\n").replace(b"\n", ends) + body).points, POINTS
        )


@pytest.mark.parametrize(
    ("kind", "values", "expected"),
    [
        ("float", [(0.0, 0.5, 1.0), (1.0, 0.2, 0.0), (0, 0, 0)], [(0, 128, 255), (255, 51, 0), (0, 0, 0)]),
        ("ushort", [(0, 257, 65535), (514, 0, 0), (0, 0, 0)], [(0, 1, 255), (2, 0, 0), (0, 0, 0)]),
        ("float", [(0.0, 255.0, 7.0), (1.0, 2.0, 3.0), (0, 0, 0)], [(0, 255, 7), (1, 2, 3), (0, 0, 0)]),
        ("uchar", [(0, 1, 1), (1, 1, 0), (0, 0, 0)], [(0, 1, 1), (1, 1, 0), (0, 0, 0)]),
    ],
)
@pytest.mark.parametrize("form", ["ascii", *ORDERS])
def test_ply_colors_of_other_types(tmp_path: Path, form: str, kind: str, values: list, expected: list) -> None:
    rows = [(*p, *c) for p, c in zip(POINTS.tolist(), values, strict=True)]
    props = f"double x,double y,double z,{kind} red,{kind} green,{kind} blue"
    scan = read(tmp_path, "a.ply", ply_file(form, props, rows))
    assert scan.colors is not None
    assert scan.colors.tolist() == [list(row) for row in expected]


def test_colors_without_a_meaning_are_dropped_with_a_note(tmp_path: Path) -> None:
    rows = [(*p, -1.0, 0.0, 0.0) for p in POINTS.tolist()]
    scan = read(tmp_path, "a.ply", ply_file("ascii", "double x,double y,double z,float r,float g,float b", rows))
    assert scan.colors is None
    assert codes(scan) == ["colors_dropped"]


@pytest.mark.parametrize("form", ["ascii", *ORDERS])
@pytest.mark.parametrize("kind", ["float", "double"])
def test_ply_oracle_open3d_and_trimesh(tmp_path: Path, form: str, kind: str) -> None:
    import trimesh

    rng = np.random.default_rng(3)
    points = rng.normal(size=(50, 3)).astype(np.float32).astype(np.float64)
    colors = rng.integers(0, 256, (50, 3))
    rows = [(*p, *map(int, c)) for p, c in zip(points.tolist(), colors, strict=True)]
    props = f"{kind} x,{kind} y,{kind} z,uchar red,uchar green,uchar blue"
    scan = read(tmp_path, "a.ply", ply_file(form, props, rows))
    with quiet():
        cloud = open3d_or_skip().io.read_point_cloud(str(tmp_path / "a.ply"), remove_nan_points=False)
        other = trimesh.load(io.BytesIO((tmp_path / "a.ply").read_bytes()), file_type="ply")
    assert np.array_equal(scan.points, np.asarray(cloud.points))
    assert scan.colors is not None
    assert np.array_equal(scan.colors, np.rint(np.asarray(cloud.colors) * 255))
    assert np.array_equal(scan.points, np.asarray(other.vertices))


def test_reads_what_this_package_writes(tmp_path: Path) -> None:
    scan = read(tmp_path, "a.ply", ply_bytes(POINTS, COLORS))
    assert np.array_equal(scan.points, POINTS)
    assert scan.colors is not None
    assert np.array_equal(scan.colors, COLORS)


# --- PCD ---

STORAGES = ["ascii", "binary", "binary_compressed"]


@pytest.mark.parametrize("data", STORAGES)
@pytest.mark.parametrize("code", ["F4", "F8"])
def test_pcd_keeps_every_bit(tmp_path: Path, data: str, code: str) -> None:
    rows = [(*p, *n, 5) for p, n in zip(POINTS.tolist(), NORMALS.tolist(), strict=True)]
    fields = f"x:{code} y:{code} z:{code} normal_x:F8 normal_y:F8 normal_z:F8 ring:U2"
    scan = read(tmp_path, "a.pcd", pcd_file(fields, rows, data))
    expected = POINTS.astype(np.float32).astype(np.float64) if code == "F4" and data != "ascii" else POINTS
    assert np.array_equal(scan.points, expected)
    assert scan.normals is not None
    assert np.allclose(scan.normals, NORMALS, atol=1e-16)


@pytest.mark.parametrize("data", STORAGES)
@pytest.mark.parametrize("code", ["I1", "U1", "I2", "U2", "I4", "U4", "I8", "U8"])
def test_pcd_whole_number_coordinates_and_wide_fields(tmp_path: Path, data: str, code: str) -> None:
    low = -100 if code[0] == "I" else 0
    rows = [(1, 2, 3, low, 1, 2, 9), (4, 5, 6, 100, 50, 3, 9)]
    scan = read(tmp_path, "a.pcd", pcd_file(f"fpfh:F4x3 x:{code} y:{code} z:{code} _:U1", rows, data))
    assert np.array_equal(scan.points, np.array([row[3:6] for row in rows], dtype=float))


@pytest.mark.parametrize("data", STORAGES)
@pytest.mark.parametrize("name", ["rgb", "rgba"])
@pytest.mark.parametrize("kind", ["F", "U", "I"])
def test_pcd_packed_colors(tmp_path: Path, data: str, name: str, kind: str) -> None:
    bits = (COLORS.astype(np.uint32) << np.array([16, 8, 0], dtype=np.uint32)).sum(axis=1).astype(np.uint32)
    bits |= np.uint32(0x10000000)
    values = {"F": bits.view(np.float32).astype(float), "U": bits, "I": bits.view(np.int32)}[kind].tolist()
    rows = [(*p, v) for p, v in zip(POINTS.tolist(), values, strict=True)]
    scan = read(tmp_path, "a.pcd", pcd_file(f"x:F8 y:F8 z:F8 {name}:{kind}4", rows, data))
    assert scan.colors is not None
    assert np.array_equal(scan.colors, COLORS)


@pytest.mark.parametrize("bits", [0xFFFF0000, 0x7F800001])
def test_pcd_packed_colors_whose_float_is_not_a_number(tmp_path: Path, bits: int) -> None:
    content = pcd_file("x:F4 y:F4 z:F4 rgb:U4", [(1.0, 2.0, 3.0, bits)]).replace(b"TYPE F F F U", b"TYPE F F F F")
    scan = read(tmp_path, "a.pcd", content)
    assert scan.colors is not None
    assert scan.colors.tolist() == [[(bits >> 16) & 255, (bits >> 8) & 255, bits & 255]]


def test_pcd_ascii_colors_that_are_lost_are_noted(tmp_path: Path) -> None:
    scan = read(tmp_path, "a.pcd", pcd_file("x:F4 y:F4 z:F4 rgb:F4", [(1.0, 2.0, 3.0, float("nan"))], "ascii"))
    assert scan.colors is None
    assert codes(scan) == ["colors_dropped"]


@pytest.mark.parametrize("data", STORAGES)
def test_pcd_nan_points_are_dropped_and_counted(tmp_path: Path, data: str) -> None:
    nan, inf = float("nan"), float("inf")
    rows = [(nan, nan, nan, 1), (1.0, 2.0, 3.0, 2), (4.0, -inf, 1.0, 3), (7.0, 8.0, 9.0, 4)]
    scan = read(tmp_path, "a.pcd", pcd_file("x:F4 y:F4 z:F4 rgb:U4", rows, data))
    assert scan.points.tolist() == [[1, 2, 3], [7, 8, 9]]
    assert scan.colors is not None
    assert scan.colors.tolist() == [[0, 0, 2], [0, 0, 4]]
    assert scan.n_points == 4
    assert codes(scan) == ["non_finite_dropped"]
    assert "2 of 4" in scan.notes[0].message


@pytest.mark.parametrize("data", STORAGES)
def test_pcd_padding_of_no_values(tmp_path: Path, data: str) -> None:
    rows = [(1.0, 2.0, 3.0, 9), (4.0, 5.0, 6.0, 9)]
    fields = "x:F4 _:U1x0 y:F4 z:F4 ring:U2 _:U2x0"
    assert read(tmp_path, "a.pcd", pcd_file(fields, rows, data)).points.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize("data", STORAGES)
def test_pcd_organised_with_pixels_without_a_return(tmp_path: Path, data: str) -> None:
    nan = float("nan")
    rows = [(0.5, 1.0, 2.0), (nan, nan, nan), (nan, nan, nan), (1.5, 1.0, 2.0), (2.5, 1.0, 2.0), (nan, nan, nan)]
    content = pcd_file("x:F4 y:F4 z:F4", rows, data).replace(b"WIDTH 6\nHEIGHT 1", b"WIDTH 3\nHEIGHT 2")
    scan = read(tmp_path, "a.pcd", content)
    assert scan.points[:, 0].tolist() == [0.5, 1.5, 2.5]
    assert [note.message for note in scan.notes] == ["3 of 6 points dropped: not finite (NaN or infinite)"]


def test_pcd_organised_and_old_headers(tmp_path: Path) -> None:
    rows = [(float(i), 0.0, 0.0) for i in range(6)]
    content = pcd_file("x:F4 y:F4 z:F4", rows).replace(b"WIDTH 6\nHEIGHT 1", b"WIDTH 3\nHEIGHT 2")
    assert len(read(tmp_path, "a.pcd", content).points) == 6
    old = content.replace(b"VERSION 0.7", b"VERSION .7").replace(b"FIELDS", b"COLUMNS").replace(b"COUNT 1 1 1\n", b"")
    old = old.replace(b"VIEWPOINT 0 0 0 1 0 0 0\n", b"").replace(b"POINTS 6\n", b"")
    assert len(read(tmp_path, "b.pcd", old).points) == 6
    assert len(read(tmp_path, "c.pcd", content.replace(b"DATA binary\n", b"DATA binary\r\n")).points) == 6


@pytest.mark.parametrize("options", [{"write_ascii": True}, {}, {"compressed": True}])
def test_pcd_oracle_open3d(tmp_path: Path, options: dict[str, bool]) -> None:
    # A grid, so that the compressor finds something to refer back to.
    grid = np.stack(np.meshgrid(*[np.arange(12) / 8.0] * 3), axis=-1).reshape(-1, 3)
    o3d = open3d_or_skip()
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(grid))
    cloud.colors = o3d.utility.Vector3dVector(np.tile([[0.2, 0.4, 1.0], [1.0, 0.0, 0.6]], (len(grid) // 2, 1)))
    cloud.normals = o3d.utility.Vector3dVector(np.tile([[0.0, 0.0, 1.0]], (len(grid), 1)))
    path = tmp_path / "a.pcd"
    assert o3d.io.write_point_cloud(str(path), cloud, **options)
    scan = read_scan(path, "m")
    again = o3d.io.read_point_cloud(str(path))
    assert np.array_equal(scan.points, np.asarray(again.points))
    assert scan.colors is not None
    assert np.array_equal(scan.colors, np.rint(np.asarray(again.colors) * 255))
    assert scan.normals is not None
    assert np.array_equal(scan.normals, np.asarray(again.normals))


def test_lzf_repeats_bytes_and_refuses_damage() -> None:
    # One literal "ab", then 12 bytes from two back: length 7 + 2 + 3.
    assert lzf_decompress(b"\x01ab\xe0\x03\x01", 14) == b"ab" * 7
    for stream, size in [
        (b"\x01ab\xe0\x03\x02", 14),
        (b"\x01ab\xe0", 14),
        (b"\x05ab", 2),
        (b"\x01ab", 3),
        (b"\x01ab", 1),
    ]:
        with pytest.raises(ReadError, match="damaged"):
            lzf_decompress(stream, size)
    with pytest.raises(ReadError, match="damaged"):
        lzf_decompress(b"\x00a", 2**32 - 1)


def test_without_its_package_a_compressed_pcd_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "lzf", None)
    rows = [(1.0, 2.0, 3.0)]
    with pytest.raises(ReadError, match="the package python-neo-lzf is missing; install it or export as binary PCD"):
        read(tmp_path, "a.pcd", pcd_file("x:F4 y:F4 z:F4", rows, "binary_compressed"))
    assert read(tmp_path, "b.pcd", pcd_file("x:F4 y:F4 z:F4", rows)).points.tolist() == [[1, 2, 3]]


# --- text ---


def rows_of(*columns: np.ndarray, separator: str = " ") -> str:
    return "".join(separator.join(repr(v) for v in row) + "\n" for row in np.hstack(columns).tolist())


@pytest.mark.parametrize("separator", [" ", "\t", ",", ";", " , ", "; ", "  "])
@pytest.mark.parametrize("header", ["", "x y z", "//X Y Z", "# exported today\n# X Y Z", "\ufeffX Y Z", "\ufeff"])
def test_text_of_three_columns(tmp_path: Path, separator: str, header: str) -> None:
    head = header.replace("x y z", f"x{separator}y{separator}z")
    content = head + ("\n" if head.strip("\ufeff") else "") + rows_of(POINTS, separator=separator)
    scan = read(tmp_path, "a.xyz", content)
    assert np.array_equal(scan.points, POINTS)
    assert scan.notes == ()


@pytest.mark.parametrize("ends", ["\r\n", "\r", "\n\n", "  \n"])
def test_text_line_ends_and_blank_lines(tmp_path: Path, ends: str) -> None:
    assert np.array_equal(read(tmp_path, "a.xyz", rows_of(POINTS).replace("\n", ends)).points, POINTS)


def whole(values: np.ndarray) -> np.ndarray:
    return values.astype(object)


@pytest.mark.parametrize(
    ("name", "content", "has_colors", "has_normals", "noted"),
    [
        ("intensity", rows_of(POINTS, [[1], [2], [3]]), False, False, []),
        ("colors", rows_of(POINTS, whole(COLORS)), True, False, []),
        ("normals", rows_of(POINTS, NORMALS), False, True, []),
        ("neither", rows_of(POINTS, NORMALS * 3.3), False, False, ["columns_ignored"]),
        ("pts", "3\n" + rows_of(POINTS, [[-5], [2], [3]], whole(COLORS)), True, False, []),
        ("both", rows_of(POINTS, whole(COLORS), NORMALS), True, True, []),
        (
            "named",
            "nx ny nz X Y Z intensity R G B\n" + rows_of(NORMALS, POINTS, [[0]] * 3, whole(COLORS)),
            True,
            True,
            [],
        ),
        ("cloudcompare", "//X Y Z R G B Nx Ny Nz\n3\n" + rows_of(POINTS, whole(COLORS), NORMALS), True, True, []),
        ("quoted", '"Point ID",x,y,z\n' + rows_of([[4], [5], [6]], POINTS, separator=","), False, False, []),
        ("remark", "# x y z in metres\n" + rows_of(POINTS), False, False, []),
        ("two more", rows_of(POINTS, [[1, 2]] * 3), False, False, ["columns_ignored"]),
    ],
)
def test_text_columns(
    tmp_path: Path, name: str, content: str, has_colors: bool, has_normals: bool, noted: list[str]
) -> None:
    scan = read(tmp_path, f"{name}.txt", content)
    assert np.array_equal(scan.points, POINTS)
    assert (scan.colors is not None, scan.normals is not None) == (has_colors, has_normals)
    if scan.colors is not None:
        assert np.array_equal(scan.colors, COLORS)
    if scan.normals is not None:
        assert np.allclose(scan.normals, NORMALS, atol=1e-16)
    assert codes(scan) == noted


def test_text_black_and_nearly_black_are_not_shares_of_one(tmp_path: Path) -> None:
    scan = read(tmp_path, "a.csv", "x,y,z,r,g,b\n0,0,0,0,1,1\n1,0,0,1,0,0\n")
    assert scan.colors is not None
    assert scan.colors.tolist() == [[0, 1, 1], [1, 0, 0]]


def test_text_without_a_last_line_end_is_noted(tmp_path: Path) -> None:
    assert codes(read(tmp_path, "a.xyz", "1 2 3\n4 5 6")) == ["last_line_unfinished"]
    assert codes(read(tmp_path, "a.pcd", pcd_file("x:F4 y:F4 z:F4", [(1.0, 2.0, 3.0)], "ascii")[:-1])) == [
        "last_line_unfinished"
    ]


def test_text_values_are_correctly_rounded(tmp_path: Path) -> None:
    scan = read(tmp_path, "a.xyz", "0.1 5e-324 123.45600000000000307\n1e2 +.5 -3.\n")
    assert scan.points.tolist() == [[0.1, 5e-324, 123.456], [100.0, 0.5, -3.0]]


# --- metres, origin, what is dropped ---


@pytest.mark.parametrize("unit", list(METRES_PER_UNIT))
def test_unit_converts(tmp_path: Path, unit: str) -> None:
    scan = read(tmp_path, "a.ply", ply_bytes(POINTS * 20), unit)
    assert np.array_equal(scan.points + scan.origin_m, POINTS * 20 * METRES_PER_UNIT[unit])
    assert (scan.unit, scan.notes) == (unit, ())


def test_unknown_unit(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="yard"):
        read(tmp_path, "a.xyz", "1 2 3\n", "yard")


@pytest.mark.parametrize(
    ("size", "unit", "words"),
    [
        (5.0, "m", "metres, which makes the scan 5 m"),
        (0.1, "m", "too small"),
        (150.0, "m", "150 m"),
        (150.001, "cm", "centimetres, which makes the scan 1.5 m"),
        (1499.9, "cm", "15 m"),
        (1500.0, "mm", "millimetres, which makes the scan 1.5 m"),
        (8000.0, "mm", "8 m"),
        (800_000.0, "mm", "too large"),
    ],
)
def test_auto_guesses_the_unit_and_says_so(tmp_path: Path, size: float, unit: str, words: str) -> None:
    # Half of the points at either end, and one stray point that must not decide.
    points = np.ones((101, 3))
    points[50:, 0] += size
    points[100] = 1e5
    scan = read(tmp_path, "a.ply", ply_bytes(points), "auto")
    note = next(note for note in scan.notes if note.code == "unit_guessed")
    assert scan.unit == unit
    assert words in note.message
    assert "--unit" in note.message
    assert note.stage == "read"


def test_points_without_a_return_are_dropped_but_a_single_point_at_zero_stays(tmp_path: Path) -> None:
    points = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0], [4.0, 5.0, 6.0], [0.0, -0.0, 0.0]])
    scan = read(tmp_path, "a.ply", ply_bytes(points))
    assert scan.points.tolist() == [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    assert [note.code for note in scan.notes] == ["no_return_dropped"]
    assert scan.notes[0].message == "2 of 4 points dropped: all at 0, 0, 0: no return"
    assert len(read(tmp_path, "b.ply", ply_bytes(points[:3])).points) == 3


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_georeferenced_coordinates_lose_nothing(tmp_path: Path, form: str) -> None:
    """A thousandth of a millimetre at 5,000 km: the spacing of float64 there is 1e-9 m, of float32 half a metre."""
    rng = np.random.default_rng(1)
    far = np.array([456_789.0, 5_412_345.0, 312.0]) + np.round(rng.uniform(-5, 5, (200, 3)), 6)
    rows = [tuple(p) for p in far.tolist()]
    scan = read(tmp_path, "a.ply", ply_file(form, "double x,double y,double z", rows))
    assert np.array_equal(scan.points + scan.origin_m, far)
    assert np.array_equal(scan.origin_m, np.rint(scan.origin_m))
    assert np.abs(scan.points).max() < 6.0
    # Exact differences: what float64 has of the file, not what is left after a detour.
    assert np.array_equal(scan.points[:, 1], far[:, 1] - scan.origin_m[1])


def test_origin_stays_zero_up_to_a_kilometre(tmp_path: Path) -> None:
    near = np.array([[999.9, 0.0, 0.0], [998.0, 1.0, 0.0]])
    assert read(tmp_path, "a.ply", ply_bytes(near)).origin_m.tolist() == [0.0, 0.0, 0.0]
    assert read(tmp_path, "b.ply", ply_bytes(near + np.array([0.1, 0, 0]))).origin_m.tolist() == [999.0, 0.0, 0.0]
    assert read(tmp_path, "c.ply", ply_bytes(near * 1000), "mm").origin_m.tolist() == [0.0, 0.0, 0.0]


def test_duplicates_keep_the_first_and_the_order(tmp_path: Path) -> None:
    points = np.array([[3.0, 0, 0], [0.0, 1, 0], [3.0, 0, 0], [-0.0, 1, -0.0], [1.0, 1, 1], [3.0, 0, 0]])
    colors = np.arange(18, dtype=np.uint8).reshape(6, 3)
    scan = read(tmp_path, "a.ply", ply_bytes(points, colors))
    assert scan.points.tolist() == [[3, 0, 0], [0, 1, 0], [1, 1, 1]]
    assert not np.signbit(scan.points).any()
    assert scan.colors is not None
    assert scan.colors[:, 0].tolist() == [0, 3, 12]
    assert codes(scan) == ["duplicates_dropped"]
    assert "3 of 6" in scan.notes[0].message
    assert scan.repeats.tolist() == [3, 2, 1]
    assert read(tmp_path, "b.ply", ply_bytes(points[3:])).repeats is None
    assert scan.n_points == 6


@settings(deadline=None)
@given(arrays(np.float64, st.tuples(st.integers(1, 60), st.just(3)), elements=st.sampled_from([0.0, 1.0, 0.5, -2.0])))
def test_first_occurrences_oracle(points: np.ndarray) -> None:
    _, first = np.unique(points, axis=0, return_index=True)
    assert np.flatnonzero(first_occurrences(points)).tolist() == sorted(first.tolist())


def test_first_occurrences_survives_equal_hashes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stair_inspector.files.cleaning._hash", lambda points: np.zeros(len(points), dtype=np.uint64))
    points = np.array([[1.0, 0, 0], [2.0, 0, 0], [1.0, 0, 0], [2.0, 0, 1]])
    assert first_occurrences(points).tolist() == [True, True, False, True]


def test_normals_become_unit_length_or_go(tmp_path: Path) -> None:
    props = "double x,double y,double z,double nx,double ny,double nz"
    rows = [(*p, *n) for p, n in zip(POINTS.tolist(), (NORMALS * [[1e-300], [7.0], [1e300]]).tolist(), strict=True)]
    scan = read(tmp_path, "a.ply", ply_file("binary_big_endian", props, rows))
    assert scan.normals is not None
    assert np.allclose(scan.normals, NORMALS, atol=1e-15)
    for bad in (0.0, float("nan"), float("inf")):
        spoilt = [*rows[:2], (*rows[2][:3], bad, 0.0, 0.0)]
        scan = read(tmp_path, "b.ply", ply_file("ascii", props, spoilt))
        assert scan.normals is None
        assert codes(scan) == ["normals_dropped"]
        # The normal of a point that is dropped does not matter.
        gone = [*rows[:2], (float("nan"), 0.0, 0.0, bad, 0.0, 0.0)]
        assert read(tmp_path, "c.ply", ply_file("ascii", props, gone)).normals is not None


@pytest.mark.parametrize("n", [1, 2, 3])
def test_few_points_are_a_scan(tmp_path: Path, n: int) -> None:
    assert np.array_equal(read(tmp_path, "a.ply", ply_bytes(POINTS[:n])).points, POINTS[:n])
    same = read(tmp_path, "b.xyz", "1 1 1\n" * 4, "auto")
    assert same.points.tolist() == [[1, 1, 1]]


# --- contract ---


def test_the_file_is_untouched_and_the_arrays_are_read_only(tmp_path: Path) -> None:
    content = ply_bytes(POINTS, COLORS)
    path = tmp_path / "stair case.PLY"
    path.write_bytes(content)
    path.chmod(0o444)
    first, second = read_scan(path), read_scan(path)
    assert path.read_bytes() == content
    assert first.name == "stair case.PLY"
    assert first.sha256 == hashlib.sha256(content).hexdigest()
    assert first.points.tobytes() == second.points.tobytes()
    for array in (first.points, first.origin_m, first.colors):
        assert array is not None
        assert not array.flags.writeable
        assert array.flags.c_contiguous


def test_the_content_decides_not_the_suffix(tmp_path: Path) -> None:
    rows = [tuple(p) for p in POINTS.tolist()]
    files = [ply_bytes(POINTS), pcd_file("x:F8 y:F8 z:F8", rows), rows_of(POINTS).encode()]
    for content in files:
        for name in ("a.ply", "a.pcd", "a.xyz", "a.csv", "a.unknown", "a"):
            assert np.array_equal(read(tmp_path, name, content).points, POINTS)


def test_find_scans(tmp_path: Path) -> None:
    for name in ("b.PLY", "a.pcd", "c.csv", "README.md", "notes.txt", ".hidden.ply"):
        (tmp_path / name).write_text("1 2 3\n")
    (tmp_path / "folder.ply").mkdir()
    explicit = tmp_path / "README.md"
    expected = [explicit, tmp_path / "a.pcd", tmp_path / "b.PLY", tmp_path / "c.csv"]
    assert find_scans([explicit, tmp_path]) == expected
    with pytest.raises(ReadError, match=r"folder\.ply: this folder holds no scans"):
        find_scans([tmp_path / "folder.ply"])
    with pytest.raises(ReadError, match=r"gone\.ply: there is no such file"):
        find_scans([explicit, tmp_path / "gone.ply"])
    assert {".ply", ".pcd", ".xyz", ".pts", ".csv"} <= set(SUFFIXES)


# --- real captures ---


@pytest.mark.real
@pytest.mark.skipif(not REAL.is_dir(), reason="the shared real captures are not beside this checkout")
@pytest.mark.parametrize(
    ("name", "n_points", "n_used", "noted"),
    [
        # 109 pixels of the Kinect frame have no return and are stored as 0 0 0.
        ("kinect_v2_five_steps.pcd", 217_088, 216_979, ["no_return_dropped", "unit_guessed"]),
        ("anymal_entrance_stairs.pcd", 107_772, 18_323, ["unit_guessed", "duplicates_dropped"]),
        ("apartment_no_stairs.xyz", 36_674, 36_674, ["last_line_unfinished", "unit_guessed"]),
        ("tilted_platform_no_stairs.pcd", 181_648, 181_648, ["unit_guessed"]),
    ],
)
def test_real_captures(name: str, n_points: int, n_used: int, noted: list[str]) -> None:
    scan = read_scan(REAL / name)
    assert (scan.n_points, len(scan.points), scan.unit) == (n_points, n_used, "m")
    assert codes(scan) == noted
    if name.endswith(".pcd"):
        cloud = open3d_or_skip().io.read_point_cloud(str(REAL / name), remove_nan_points=False)
        _, first = np.unique(np.asarray(cloud.points), axis=0, return_index=True)
        kept = np.sort(first)
        kept = kept[np.asarray(cloud.points)[kept].any(axis=1)]
        assert np.array_equal(scan.points, np.asarray(cloud.points)[kept])
        if scan.colors is not None:
            assert np.array_equal(scan.colors, np.rint(np.asarray(cloud.colors)[kept] * 255))
