"""What writes the one small stair of the dialects: other libraries, and the forms in which programs export."""

import csv
import io
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import laspy
import numpy as np
import pandas
import plyfile

from tests.oracles import open3d_or_skip
from tests.synthetic import Stair

_SAMPLE, _NORMALS = Stair(noise=0.002, risers=True, spacing=0.03).sample()
POINTS = np.unique(np.round(_SAMPLE, 4), axis=0)[np.random.default_rng(2).permutation(len(_SAMPLE))]
"""(n, 3) metres, in no order, of four decimals: what most dialects keep exactly."""
N = len(POINTS)
_RNG = np.random.default_rng(5)
COLORS = _RNG.integers(0, 256, (N, 3)).astype(np.uint8)
COLORS[0] = (0, 255, 7)
INTENSITY = _RNG.integers(0, 4000, N)
NORMALS = np.tile([0.0, 0.6, 0.8], (N, 1))


@dataclass(frozen=True)
class Written:
    """A way to write the stair: the end of the file's name, its bytes, what is lost, and what it is read with.

    ``coarse_m`` is the largest error of a coordinate that the format itself makes; ``is_sorted`` tells that it puts the
    points into an order of its own; ``refused`` are words of the sentence
    with which the dialect is refused.
    """

    suffix: str
    make: Callable[[], bytes | str]
    coarse_m: float = 1e-9
    unit: str = "m"
    columns: str = "auto"
    is_sorted: bool = False
    refused: str = ""


def lines(form="{:.4f}", sep=" ", head="", foot="", end="\n", comma=False, points=POINTS, before=None, behind=None):
    """The points as text. ``before`` and ``behind`` give the cells around those of a row by its number."""
    made = [head]
    for k, point in enumerate(points.tolist()):
        cells = [form.format(value) for value in point]
        cells = [cell.replace(".", ",") for cell in cells] if comma else cells
        made.append(sep.join([*(before(k) if before else ()), *cells, *(behind(k) if behind else ())]) + end)
    return "".join(made) + foot


def rgb(k):
    return map(str, COLORS[k].tolist())


def intensity(k):
    return (str(INTENSITY[k]),)


def called(k):
    return (f"P{k + 1}",)


def written(save):
    """The bytes that ``save(path)`` writes."""

    def make(suffix):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"a{suffix}"
            save(path)
            return path.read_bytes()

    return make


def by_path(suffix, save, **options):
    return Written(suffix, lambda: written(save)(suffix), **options)


def savetxt(**options):
    stream = io.BytesIO()
    np.savetxt(stream, POINTS, **options)
    return stream.getvalue()


def frame():
    return pandas.DataFrame(POINTS, columns=["x", "y", "z"])


def with_csv(dialect, head=("X", "Y", "Z"), **options):
    stream = io.StringIO()
    writer = csv.writer(stream, dialect, **options)
    writer.writerow(head)
    writer.writerows(POINTS.tolist())
    return stream.getvalue()


def with_plyfile(kind="f8", text=False, order="<", lists=False):
    dtype = [("x", kind), ("y", kind), ("z", kind), ("red", "u1"), ("green", "u1"), ("blue", "u1")]
    table = np.zeros(N, dtype=dtype + ([("views", "O")] if lists else []))
    for name, column in zip(("x", "y", "z", "red", "green", "blue"), [*POINTS.T, *COLORS.T], strict=True):
        table[name] = column
    for k in range(N if lists else 0):
        table["views"][k] = np.arange(k % 3, dtype="u4")
    element = plyfile.PlyElement.describe(table, "vertex", val_types={"views": "u4"}, len_types={"views": "u1"})
    stream = io.BytesIO()
    plyfile.PlyData([element], text=text, byte_order="=" if text else order).write(stream)
    return stream.getvalue()


def ply_header(properties, form="binary_little_endian", more=""):
    rows = "".join(f"property {kind} {name}\n" for kind, name in properties)
    return f"ply\nformat {form} 1.0\n{more}element vertex {N}\n{rows}end_header\n".encode()


def table(**columns):
    made = np.zeros(N, dtype=[(name, np.asarray(column).dtype) for name, column in columns.items()])
    for name, column in columns.items():
        made[name] = column
    return made


def axes(kind="<f4"):
    return {name: column.astype(kind) for name, column in zip("xyz", POINTS.T, strict=True)}


def pcd(fields, sizes, types, counts, body, data="binary", width=N, height=1):
    return (
        f"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\n"
        f"COUNT {counts}\nWIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {width * height}\n"
        f"DATA {data}\n"
    ).encode() + body


def organised():
    """Every other pixel without a return, as a depth camera writes them."""
    pixels = np.full((2 * N, 3), np.nan, dtype="<f4")
    pixels[::2] = POINTS
    return pcd("x y z", "4 4 4", "F F F", "1 1 1", pixels.tobytes(), width=2, height=N)


def las(form=3, packed=False, scale=0.0001, version=None, offset=0.0):
    header = laspy.LasHeader(point_format=form, version=version or ("1.2" if form < 6 else "1.4"))
    header.scales, header.offsets = [scale] * 3, [offset] * 3
    made = laspy.LasData(header)
    made.x, made.y, made.z = POINTS.T
    stream = io.BytesIO()
    made.write(stream, do_compress=packed)
    return stream.getvalue()


def npy(array, save=np.save, **options):
    stream = io.BytesIO()
    save(stream, array, **options)
    return stream.getvalue()


def npz(save=np.savez, **arrays):
    stream = io.BytesIO()
    save(stream, **arrays)
    return stream.getvalue()


def zipped(method, **members):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name.replace("__", "."), content)
    return stream.getvalue()


def with_open3d(name, **options):
    """As Open3D writes the points."""

    def save(path):
        o3d = open3d_or_skip()
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(POINTS))
        cloud.colors = o3d.utility.Vector3dVector(COLORS / 255.0)
        cloud.normals = o3d.utility.Vector3dVector(NORMALS)
        assert o3d.io.write_point_cloud(str(path), cloud, **options)

    return save


def ptx():
    rows = "".join(f"{x} {y} {z} 0.5\n" for x, y, z in POINTS.tolist())
    return f"{N}\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n{rows}"


def e57(path):
    from tests.files.e57_files import XYZ, doubles, e57_bytes, station

    e57_bytes(path, station(doubles(XYZ, POINTS), "Hall"))
