"""Scans in gzip and ZIP, and numpy's arrays: the same points; bombs, several scans, Python objects are a sentence."""

import gzip
import io
import tracemalloc
import zipfile

import numpy as np
import pytest

from stair_inspector.errors import ReadError
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import FOLDER_SUFFIXES, SUFFIXES, find_scans, read_scan
from tests.files.damage import N_DAMAGED, check_form, n_read_of_damaged

POINTS = np.array([[0.5, 1.25, -2.0], [1.5, 1.0, 3.0], [0.25, 4.0, 5.0], [8.0, 1.0, 6.5]])
COLORS = np.arange(12, dtype=np.uint8).reshape(4, 3)
PLY = ply_bytes(POINTS, COLORS)
LINES = b"".join(b"%r %r %r\n" % tuple(point) for point in POINTS.tolist())


def zipped(method=zipfile.ZIP_DEFLATED, **members):
    """A ZIP of members, a double underscore in their names for a point."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name.replace("__", "."), content)
    return stream.getvalue()


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def npz(save=np.savez, **arrays):
    stream = io.BytesIO()
    save(stream, **arrays)
    return stream.getvalue()


def fields(**columns):
    made = np.zeros(len(POINTS), dtype=[(name, np.asarray(column).dtype) for name, column in columns.items()])
    for name, column in columns.items():
        made[name] = column
    return made


X, Y, Z = POINTS.T
RED, GREEN, BLUE = COLORS.T
READ = {
    "a.ply.gz": gzip.compress(PLY),
    "a.xyz.gz": gzip.compress(LINES[:30]) + gzip.compress(LINES[30:]),
    "a.zip": zipped(a__ply=PLY),
    "stored.zip": zipped(zipfile.ZIP_STORED, a__xyz=LINES),
    "beside.zip": zipped(readme__md="a", a__ply=PLY, __MACOSX="b"),
    "strange.zip": zipped(points=LINES),
    "a.npy": npy(POINTS),
    "fortran.npy": npy(np.asfortranarray(POINTS)),
    "big.npy": npy(POINTS.astype(">f8")),
    "colors.npy": npy(np.hstack([POINTS, COLORS])),
    "rows.npy": npy(POINTS.reshape(2, 2, 3)),
    "fields.npy": npy(fields(X=X, Y=Y, Z=Z, red=RED, green=GREEN, blue=BLUE, name=["a"] * 4)),
    "a.npz": npz(anything=POINTS),
    "packed.npz": npz(np.savez_compressed, other=POINTS[:2], points=POINTS, colors=COLORS),
    "axes.npz": npz(x=X, y=Y, z=Z, red=RED, green=GREEN, blue=BLUE),
    "rows.npz": npz(points=POINTS.reshape(2, 2, 3), colors=COLORS.reshape(2, 2, 3), labels=X),
    "axes and colors.npz": npz(x=X, y=Y, z=Z, colors=COLORS),
    "first of two.npz": npz(np.savez, arr_0=POINTS, arr_1=X),
}
"""Files of the same points."""
WITH_COLORS = {
    "a.ply.gz",
    "a.zip",
    "beside.zip",
    "colors.npy",
    "fields.npy",
    "packed.npz",
    "axes.npz",
    "rows.npz",
    "axes and colors.npz",
}


@pytest.mark.parametrize("name", READ)
def test_the_points_are_those_of_the_plain_file(tmp_path, name):
    (tmp_path / name).write_bytes(READ[name])
    scan = read_scan(tmp_path / name, "m")
    assert np.array_equal(scan.points, POINTS)
    assert (scan.colors is not None) == (name in WITH_COLORS)
    assert scan.colors is None or np.array_equal(scan.colors, COLORS)


def test_folders_give_packed_scans_but_no_zip(tmp_path):
    for name in ("a.ply.gz", "a.zip", "b.npy", "c.tar.gz"):
        (tmp_path / name).write_bytes(b"a")
    assert [path.name for path in find_scans([tmp_path])] == ["a.ply.gz", "b.npy"]
    assert {".gz", ".zip"} <= set(SUFFIXES)
    assert {".npy", ".npz"} <= set(FOLDER_SUFFIXES)


BOMB = bytes(30_000_000)
LYING = npy(POINTS).replace(b"(4, 3), }          ", b"(999999999999, 3), }")
BAD = {
    "bomb.gz": (gzip.compress(BOMB), "unpacks to more than"),
    "bomb.zip": (zipped(a__xyz=BOMB), "unpacks to more than"),
    "bomb.npz": (
        npz(np.savez_compressed, a=np.zeros(3_000_000)),
        "unpacks to more than",
    ),
    "two.zip": (zipped(a__ply=PLY, b__xyz=LINES), "holds 2 scans (a.ply, b.xyz); unpack it"),
    "many.zip": (zipped(**{f"a{k}__ply": PLY for k in range(9)}), "a4.ply and 4 more)"),
    "none.zip": (zipped(a__md="a", b__png="b"), "holds no scan (a.md, b.png); unpack it"),
    "empty.zip": (zipped(), "holds no scan (no file)"),
    "nothing.zip": (zipped(a__ply=""), "holds an empty file ('a.ply')"),
    "nested.zip": (zipped(a__ply=gzip.compress(PLY)), "holds another archive ('a.ply')"),
    "method.zip": (zipped(zipfile.ZIP_BZIP2, a__ply=PLY), "other than deflate"),
    "cut.zip": (zipped(a__ply=PLY)[:-30], "is a damaged archive"),
    "cut.gz": (gzip.compress(PLY)[:-12], "is a damaged archive"),
    "crc.gz": (gzip.compress(PLY)[:-8] + bytes(8), "is a damaged archive"),
    "bad.zip": (zipped(a__ply=PLY[:-1]), "truncated"),
    "objects.npy": (npy(np.array([[{}, 1, 2]], dtype=object)), "is an NPY of Python objects, which are not read"),
    "lying.npy": (LYING, "its NPY header states 23999999999976 bytes but 97 follow"),
    "short.npy": (npy(POINTS)[:-1], "states 96 bytes but 95 follow"),
    "header.npy": (npy(POINTS)[:40], "has a damaged NPY header"),
    "code.npy": (npy(POINTS).replace(b"'descr'", b"f('des'"), "has a damaged NPY header"),
    "none.npy": (npy(np.zeros((0, 3))), "holds no points"),
    "flat.npy": (npy(X), "is an array of shape (4,)"),
    "turned.npy": (npy(np.zeros((3, 2000))), "is an array of shape (3, 2000)"),
    "texts.npy": (npy(np.array([["a", "b", "c"]])), "instead of numbers"),
    "complex.npy": (npy(POINTS * 1j), "is an NPY of complex128 instead of numbers"),
    "named.npy": (npy(fields(x=X, y=Y)), "has no z"),
    "numbered.npy": (npy(np.hstack([np.arange(40.0)[:, None], np.ones((40, 3)) / 3])), "numbers the lines"),
    "several.npz": (npz(a=X, b=POINTS), "holds several arrays (a, b), none of them called points"),
    "uneven.npz": (npz(x=X, y=Y, z=Z[:2]), "of different shapes"),
    "two without names.npz": (npz(arr_0=POINTS * 0.0 + 1.0, arr_1=POINTS), "may be the points (arr_0, arr_1)"),
    "two with names.npz": (npz(points=POINTS[:2], vertices=POINTS), "may be the points (points, vertices)"),
    "axes and points.npz": (npz(x=X, y=Y, z=Z, points=POINTS), "may be the points (x y z, points)"),
    "cases.npz": (npz(points=POINTS, POINTS=POINTS), "has two arrays called 'points'"),
    "words.npz": (npz(x=X.astype("U8"), y=Y, z=Z), "has 'x' of <U8 instead of numbers"),
    "truths.npz": (npz(x=X > 0, y=Y, z=Z), "has 'x' of bool instead of numbers"),
    "times.npz": (npz(x=X.astype("datetime64[s]"), y=Y, z=Z), "has 'x' of datetime64[s] instead of numbers"),
    "colors.npz": (npz(points=POINTS, colors=np.full(POINTS.shape, "a")), "has 'colors' of <U1 instead of numbers"),
    "normals.npz": (npz(points=POINTS, normals=POINTS * 1j), "has 'normals' of complex128 instead of numbers"),
    "cases.npy": (npy(fields(X=X, x=X, y=Y, z=Z)), "has two fields called 'x'"),
    "complex field.npy": (npy(fields(x=X * 1j, y=Y, z=Z)), "has 'x' of complex128 instead of numbers"),
    "axes.npy": (npy(POINTS[:1].reshape((1,) * 30 + (3,))), "is an array of 31 axes"),
    "depth.npy": (npy(np.ones((48, 65))), "is an array of shape (48, 65)"),
    "npy first.zip": (zipped(a__npy=npy(POINTS), b__ply=PLY), "holds 2 scans (a.npy, b.ply)"),
    "cut.npz": (npz(a=POINTS)[:-30], "is a damaged archive"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_refused(tmp_path, name):
    content, words = BAD[name]
    (tmp_path / name).write_bytes(content)
    tracemalloc.start()
    with pytest.raises(ReadError) as caught:
        read_scan(tmp_path / name, "m")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    check_form(tmp_path / name, str(caught.value))
    assert words in str(caught.value)
    # In parts, joined, and what a buffer is ahead: at most three times 200 times the file, whatever a header states.
    assert peak < 2_000_000 + 3 * 200 * len(content)


DAMAGED = ("a.ply.gz", "a.zip", "a.npy", "fields.npy", "packed.npz")


@pytest.mark.parametrize("name", DAMAGED)
def test_two_hundred_damaged_files_give_a_sentence_or_a_scan(name):
    assert n_read_of_damaged(name, READ[name], seed=7) < N_DAMAGED // 2
