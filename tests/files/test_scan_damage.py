"""Bad scan files, one by one and at random: one sentence, no crash, never a wrong number."""

import dataclasses
import os
import stat
import struct
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from stair_inspector.errors import ReadError
from stair_inspector.files import scans
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import find_scans, read_scan
from tests.files.damage import check_form, points_or_none

POINTS = np.array([[0.5, 1.25, -2.0], [1.5, 1.0, 3.0], [0.25, 4.0, 5.0], [8.0, 1.0, 6.5]])
COLORS = np.arange(12, dtype=np.uint8).reshape(4, 3)
LINES = "".join(f"{x} {y} {z}\n" for x, y, z in POINTS.tolist())
PLY = ply_bytes(POINTS, COLORS)
PLY_ASCII = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    f"element face 1\nproperty list uchar int vertex_indices\nend_header\n{LINES}3 0 1 2\n"
).encode()
PLY_MESH = (
    b"ply\nformat binary_big_endian 1.0\nelement face 2\nproperty list uchar int vertex_indices\n"
    b"element vertex 4\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
    + struct.pack(">B3iB4i", 3, 0, 1, 2, 4, 0, 1, 2, 3)
    + POINTS.astype(">f8").tobytes()
)
PCD_HEAD = (
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA {}\n"
)
PCD = PCD_HEAD.format("binary").encode() + POINTS.tobytes()
PCD_ASCII = (PCD_HEAD.format("ascii") + LINES).encode()
_SOA = np.ascontiguousarray(POINTS.T).tobytes()
_LZF = b"".join(b"\x1f" + _SOA[i : i + 32] for i in range(0, 96, 32))
PCD_PACKED = PCD_HEAD.format("binary_compressed").encode() + struct.pack("<II", len(_LZF), 96) + _LZF
LISTS = "property list uchar int views\nproperty double z\nend_header\n"
PLY_LISTS = (
    "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\n" + LISTS
).encode() + b"".join(struct.pack(f"<2dB{k}id", x, y, k, *range(k), z) for k, (x, y, z) in enumerate(POINTS.tolist()))
PLY_LISTS_ASCII = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
    + LISTS
    + "".join(f"{x} {y} 2 7 8 {z}\n" for x, y, z in POINTS.tolist())
).encode()
PTS = f"4\n{LINES}".encode()
XYZ = LINES.encode()
CSV = b"x,y,z,r,g,b\n1.5,2,3,0,255,7\n2,3,4,1,2,3\n"

VALID = {
    "a.ply": PLY,
    "ascii.ply": PLY_ASCII,
    "lists.ply": PLY_LISTS,
    "asciilists.ply": PLY_LISTS_ASCII,
    "a.pcd": PCD,
    "ascii.pcd": PCD_ASCII,
    "packed.pcd": PCD_PACKED,
    "a.pts": PTS,
    "a.xyz": XYZ,
    "a.csv": CSV,
}
COUNTED = [name for name in VALID if name not in ("a.xyz", "a.csv")]


def message_of(tmp_path: Path, name: str, content: bytes) -> str:
    """Read what must not be readable; check the form of the message and return it."""
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(ReadError) as caught:
        read_scan(path, "m")
    check_form(path, str(caught.value))
    return str(caught.value).removeprefix(f"{path}: ")


BAD = {
    # any format
    "empty.ply": (b"", "is empty"),
    "zeros.bin": (bytes(100), "unknown format"),
    "zeros.xyz": (bytes(100), "binary data"),
    "blank.xyz": (b"\n \n\t\n", "no points"),
    "text.ply": (b"Dear all,\nthe scan is late.\n", "does not begin with 'ply'"),
    "text.pcd": (b"Dear all,\nthe scan is late.\n", "does not begin with a PCD header"),
    "prose.txt": (b"Dear all,\nthe scan is late.\n", "line 1 ('Dear all,') is neither"),
    "scan.las": (b"LASF" + bytes(300), "is LAS version 0.0"),
    "small.ptx": (b"2\n2\n" + b"0 0 0\n" * 4 + b"1 0 0 0\n" * 4 + b"1 2 3 0.5\n" * 4, "matrix of its station 1"),
    "scan.e57": (b"ASTM-E57" + bytes(300), "states 0 bytes"),
    "scan.zip": (b"PK\x03\x04" + bytes(300), "is a damaged archive"),
    # PLY
    "magic.ply": (b"ply", "header does not end"),
    "header.ply": (PLY[: PLY.index(b"end_header")], "header does not end"),
    "short.ply": (PLY[:-1], "truncated"),
    "headeronly.ply": (PLY[: PLY.index(b"end_header\n") + 11], "truncated"),
    "long.ply": (PLY + b"\1" * 27, "27 bytes more than the 4 points"),
    "lying.ply": (PLY.replace(b"vertex 4", b"vertex 999999999999"), "truncated"),
    "fewer.ply": (PLY.replace(b"vertex 4", b"vertex 3"), "27 bytes more"),
    "huge.ply": (PLY.replace(b"vertex 4", b"vertex " + b"9" * 400), "whole number"),
    "negative.ply": (PLY.replace(b"vertex 4", b"vertex -4"), "whole number"),
    "none.ply": (PLY.replace(b"vertex 4", b"vertex 0"), "0 points"),
    "noz.ply": (PLY.replace(b"double z", b"double w"), "has no z"),
    "xx.ply": (PLY.replace(b"double y", b"double x"), "'x' twice"),
    "format.ply": (PLY.replace(b"binary_little_endian", b"binary_middle_endian"), "'binary_middle_endian'"),
    "noformat.ply": (PLY.replace(b"format binary_little_endian 1.0\n", b""), "means nothing there"),
    "version.ply": (PLY.replace(b"endian 1.0", b"endian 2.0"), "only 1.0"),
    "type.ply": (PLY.replace(b"double z", b"quad z"), "'quad z'"),
    "keyword.ply": (PLY.replace(b"element vertex", b"elephant vertex"), "'elephant vertex 4'"),
    "list.ply": (PLY.replace(b"property double z", b"property list uchar double z"), "truncated"),
    "onlylists.ply": (PLY_LISTS.replace(b"property double", b"property list uchar double"), "with 0 properties"),
    "listshort.ply": (PLY_LISTS[:-1], "truncated"),
    "listzero.ply": (PLY_LISTS_ASCII.replace(b" 2 7 8 ", b" 9 7 8 ", 1), "line 9 should have 3 columns, got 1"),
    "listword.ply": (PLY_LISTS_ASCII.replace(b" 2 7 8 ", b" x 7 8 ", 1), "line 9 should have 3 columns, got 1"),
    "novertex.ply": (PLY.replace(b"element vertex", b"element vortex"), "'vertex' 0 times"),
    "twovertices.ply": (PLY.replace(b"end_header", b"element vertex 1\nproperty double x\nend_header"), "2 times"),
    "mesh.ply": (PLY_MESH[:-1], "truncated"),
    "lyingmesh.ply": (PLY_MESH.replace(b"face 2", b"face 5"), "truncated"),
    "lyinglist.ply": (PLY_MESH.replace(b"\x03\0\0\0\0", b"\xff\0\0\0\0"), "truncated"),
    "negativelist.ply": (
        PLY_MESH.replace(b"list uchar", b"list char").replace(b"\x03\0\0\0\0", b"\xff\0\0\0\0"),
        "length -1",
    ),
    "floatlist.ply": (PLY_MESH.replace(b"list uchar", b"list float"), "not whole numbers"),
    "asciifewer.ply": (PLY_ASCII.replace(b"3 0 1 2\n", b""), "truncated"),
    "asciishort.ply": (PLY_ASCII[: PLY_ASCII.index(b"8.0 1.0")], "states 4 points but 3 follow"),
    "asciimore.ply": (PLY_ASCII.replace(b"vertex 4", b"vertex 3"), "after its 3 points should be 1, got 2"),
    "asciilying.ply": (PLY_ASCII.replace(b"vertex 4", b"vertex 99999999999"), "line 14 should have 3 columns, got 4"),
    "asciijunk.ply": (PLY_ASCII.replace(b"1.5 1.0", b"abc 1.0"), "line 11 holds 'abc'"),
    "asciibinary.ply": (PLY.replace(b"binary_little_endian", b"ascii"), "line "),
    "binaryascii.ply": (PLY_ASCII.replace(b"format ascii", b"format binary_little_endian"), "data ends before"),
    # PCD
    "magic.pcd": (b"# .PCD v0.7\n", "does not end with a 'DATA' line"),
    "short.pcd": (PCD[:-1], "4 points, 96 bytes, but 95 bytes follow"),
    "long.pcd": (PCD + b"abc", "3 bytes more"),
    "lying.pcd": (PCD.replace(b"4\nHEIGHT", b"400000000000\nHEIGHT"), "4 POINTS but"),
    "lying2.pcd": (PCD.replace(b"4\nH", b"99999999999\nH").replace(b"POINTS 4", b"POINTS 99999999999"), "truncated"),
    "nopoints.pcd": (PCD.replace(b"4\nHEIGHT", b"0\nHEIGHT").replace(b"POINTS 4", b"POINTS 0"), "0 points"),
    "noz.pcd": (PCD.replace(b"x y z", b"x y w"), "has no z"),
    "xx.pcd": (PCD.replace(b"x y z", b"x x z"), "'x' twice"),
    "lists.pcd": (PCD.replace(b"SIZE 8 8 8", b"SIZE 8 8"), "FIELDS, SIZE, TYPE and COUNT"),
    "size.pcd": (PCD.replace(b"SIZE 8 8 8", b"SIZE 8 8 3"), "'F 3'"),
    "type.pcd": (PCD.replace(b"TYPE F F F", b"TYPE F F Q"), "'Q 8'"),
    "count.pcd": (PCD.replace(b"COUNT 1 1 1", b"COUNT 1 1 2"), "COUNT 2 instead of 1"),
    "count0.pcd": (PCD.replace(b"COUNT 1 1 1", b"COUNT 1 1 0"), "COUNT 0 instead of 1"),
    "count-.pcd": (PCD.replace(b"COUNT 1 1 1", b"COUNT 1 1 -1"), "whole number"),
    "rgb.pcd": (PCD.replace(b"x y z", b"x y rgb"), "8 x 1 bytes instead of 4"),
    "data.pcd": (PCD.replace(b"DATA binary", b"DATA base64"), "'base64'"),
    "nosize.pcd": (PCD.replace(b"SIZE 8 8 8\n", b""), "has no SIZE"),
    "twice.pcd": (PCD.replace(b"HEIGHT 1\n", b"HEIGHT 1\nHEIGHT 1\n"), "twice"),
    "keyword.pcd": (PCD.replace(b"VIEWPOINT", b"VIEWPORT"), "means nothing there"),
    "asciishort.pcd": (PCD_ASCII[: PCD_ASCII.index(b"8.0 1.0")], "states 4 points but 3 follow"),
    "asciimore.pcd": (PCD_ASCII + b"1 2 3\n", "4 points but 5 lines"),
    "asciicolumns.pcd": (PCD_ASCII.replace(b"1.5 1.0 3.0", b"1.5 1.0"), "line 13 should have 3 columns, got 2"),
    "asciijunk.pcd": (PCD_ASCII.replace(b"1.5 1.0", b"1.5 -"), "line 13 holds '-'"),
    "asciibinary.pcd": (PCD.replace(b"DATA binary", b"DATA ascii"), "line "),
    "packedshort.pcd": (PCD_PACKED[:-1], "truncated"),
    "packednone.pcd": (PCD_PACKED[: PCD_PACKED.index(b"compressed\n") + 13], "truncated"),
    "packedlying.pcd": (PCD_PACKED.replace(b"\x60\0\0\0", b"\xff\xff\xff\xff"), "states 4294967295"),
    "packedless.pcd": (PCD_PACKED.replace(b"\x63\0\0\0\x60", b"\x42\0\0\0\x60")[:-33], "damaged"),
    "packedback.pcd": (PCD_PACKED.replace(b"\x60\0\0\0\x1f", b"\x60\0\0\0\x3f"), "damaged"),
    "packedbomb.pcd": (
        PCD_HEAD.format("binary_compressed")
        .replace("WIDTH 4", "WIDTH 178000000")
        .replace("POINTS 4", "POINTS 178000000")
        .encode()
        + struct.pack("<II", 10, 178_000_000 * 24)
        + bytes(10),
        "damaged",
    ),
    # text
    "two.xyz": (b"1 2\n3 4\n", "2 columns"),
    "ragged.xyz": (b"1 2 3\n\n4 5 6\n7 8\n", "line 4 should have 3 columns, got 2"),
    "word.xyz": (b"1 2 3\n4 five 6\n", "line 2 holds 'five'"),
    "underscore.xyz": (b"1 2 3\n4 1_0 6\n", "line 2 holds '1_0'"),
    "hole.csv": (b"1,2,3\n4,,6\n", "line 2 holds ''"),
    "trailing.csv": (b"1,2,3\n4,5,6,\n", "line 2 should have 3 columns, got 4"),
    "thousands.csv": (b"1,23;4,56;7,89\n1.234,5;4,56;7,89\n", "line 2 holds '1.234,5;4,56;7,89'"),
    "latethousands.csv": (b"1,23;4,56;7,89\n" * 300 + b"1.234;4,56;7,89\n", "line 301 holds '1.234;4,56;7,89'"),
    "comma6.csv": (b"1,23,4,05,7,89\n", "decimal commas"),
    "latecomma.csv": (b"1;2;3\n" * 300 + b"1,5;2;3\n", "line 301 holds '1,5'"),
    "pointless.csv": (b"a,b,c\n1,2,3\n", "line 1 ('a,b,c') names the columns, but not x, y and z; give --columns"),
    "columns.csv": (b"x,y,z\n1,2,3,4\n", "names 3 columns but its lines have 4"),
    "twice.csv": (b"x,y,z,x\n1,2,3,4\n", "'x' twice"),
    "headeronly.csv": (b"x,y,z\n", "no points"),
    "less.pts": (b"5\n" + XYZ, "states 5 points but 4 follow"),
    "more.pts": (b"3\n" + XYZ, "states 3 points but 4 follow"),
    "blocks.pts": (b"4\n" + XYZ + b"5\n" + XYZ, "states 5 points but 4 follow"),
    "countonly.pts": (b"4\n", "no points"),
    "numbered.txt": ("".join(f"{i} {i / 7} 1.5 2.5\n" for i in range(12)).encode(), "numbers the lines"),
    "utf16.xyz": ("1 2 3\n".encode("utf-16"), "UTF-16"),
    "binary.xyz": (b"1 2 3\n4 5 6\n\x00\x01\xff\n", "binary data"),
    "latebinary.xyz": (b"1 2 3\n" * 20000 + b"\x00\x01\xff \x02 \x03\n", "line 20001 holds"),
    "oneline.xyz": (b"1 " * 100_000, "longer than"),
    "wide.xyz": (b"1 " * 2000 + b"\n", "2000 columns"),
    # numbers
    "nan.xyz": (b"nan nan nan\n" * 3, "none of its 3 points is finite"),
    "inf.xyz": (b"1 inf 2\n1e999 1 1\n", "none of its 2 points is finite"),
    "far.xyz": (b"1 2 3\n4 5e9 6\n", "5e+09 m, beyond 1e+09 m"),
    "veryfar.xyz": (b"1 2 3\n4 5e300 6\n", "5e+300, beyond 1e+12"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_file(tmp_path: Path, name: str) -> None:
    content, words = BAD[name]
    assert words in message_of(tmp_path, name, content)


def test_lying_headers_allocate_nothing(tmp_path: Path) -> None:
    for name in ("lying.ply", "lying2.pcd", "packedlying.pcd", "packedbomb.pcd", "lyinglist.ply", "asciilying.ply"):
        tracemalloc.start()
        message_of(tmp_path, name, BAD[name][0])
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert peak < 5e6, name


def test_zero_padding_after_the_data_is_accepted(tmp_path: Path) -> None:
    for name, content in {"a.ply": PLY, "a.pcd": PCD, "b.pcd": PCD_PACKED}.items():
        (tmp_path / name).write_bytes(content + bytes(512))
        assert np.array_equal(read_scan(tmp_path / name, "m").points, POINTS)


# --- paths ---


def refuse(path: Path, words: str) -> None:
    with pytest.raises(ReadError) as caught:
        read_scan(path)
    assert words in str(caught.value)
    assert str(caught.value).isprintable()


def test_missing_file(tmp_path: Path) -> None:
    refuse(tmp_path / "gone.ply", "gone.ply: there is no such file; check the path")


def test_folder(tmp_path: Path) -> None:
    refuse(tmp_path, "is a folder")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_pipe_does_not_wait(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.ply")
    refuse(tmp_path / "a.ply", "a device or a pipe")
    refuse(Path(os.devnull), "a device or a pipe")


def test_unreadable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(PLY)

    def denied(_: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    # Permissions do not bind root, as which tests often run.
    monkeypatch.setattr(Path, "read_bytes", denied)
    refuse(path, "cannot be opened (Permission denied)")


def test_impossible_paths(tmp_path: Path) -> None:
    refuse(tmp_path / "a\0b.ply", "not a valid path")
    refuse(tmp_path / ("a" * 5000), "cannot be opened")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    refuse(tmp_path / "loop", "cannot be opened")
    refuse(tmp_path / "a.ply" / "b.ply", "no such file")
    with pytest.raises(ReadError, match="not a valid path"):
        find_scans([tmp_path / "a\0b.ply"])


def test_names_that_would_break_the_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = "stair\n\x1b[31m\udcff.ply"
    refuse(tmp_path / name, r"stair\n\x1b[31m\udcff.ply: there is no such file")
    # Not every file system takes such a name: the scan is read from another file.
    (tmp_path / "a.ply").write_bytes(PLY)
    of_the_other = os.stat(tmp_path / "a.ply")
    monkeypatch.setattr(Path, "stat", lambda _, **__: of_the_other)
    monkeypatch.setattr(Path, "read_bytes", lambda _: PLY)
    assert read_scan(tmp_path / name).name == r"stair\n\x1b[31m\udcff.ply"


def test_too_large_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.ply"
    path.write_bytes(PLY)
    # The file itself stays small: not every file system has sparse files.
    fields = list(os.stat(path))
    fields[stat.ST_SIZE] = 4 * 2**30 + 1
    monkeypatch.setattr(Path, "stat", lambda _, **__: os.stat_result(fields))
    refuse(path, "has 4.0 GiB, more than the 4 GiB")


def test_memory_that_is_not_there_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(_: bytes) -> None:
        raise MemoryError

    (tmp_path / "a.ply").write_bytes(PLY)
    exhausting = dataclasses.replace(scans.FORMATS[0], read=exhausted)
    monkeypatch.setattr(scans, "FORMATS", (exhausting, *scans.FORMATS[1:]))
    refuse(tmp_path / "a.ply", "does not fit into the memory")


# --- random damage ---


@pytest.mark.parametrize("name", VALID)
def test_truncation_at_every_byte(name: str) -> None:
    """With a stated count no point is ever lost; without, no line is."""
    content = VALID[name]
    whole = points_or_none(name, content)
    assert whole is not None
    n_lines = [content[:cut].count(b"\n") for cut in range(len(content))]
    for cut in range(len(content)):
        points = points_or_none(name, content[:cut])
        if points is None:
            continue
        if name in COUNTED:
            # Only the last digits of the last line of text may be missing, which a note tells.
            assert len(points) == len(whole), cut
            assert np.array_equal(points[:-1], whole[:-1]), cut
            assert np.array_equal(points[-1], whole[-1]) or not content[:cut].endswith(b"\n"), cut
        else:
            is_begun = not content[:cut].endswith(b"\n")
            n_header = int(name == "a.csv")
            assert len(points) == n_lines[cut] - n_header + is_begun, cut


def read_soon(name: str, content: bytes) -> None:
    """Read what may be damaged, within seconds of the processor's time: others may have it meanwhile."""
    began = time.process_time()
    points_or_none(name, content)
    # The first time includes the libraries that are imported when they are needed: two seconds.
    assert time.process_time() - began < 5.0


@pytest.mark.parametrize("name", VALID)
@settings(max_examples=120, deadline=None)
@given(data=st.data())
def test_flipped_bytes_give_an_error_or_a_scan(name: str, data: st.DataObject) -> None:
    content = bytearray(VALID[name])
    for _ in range(data.draw(st.integers(1, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    read_soon(name, bytes(content))


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(name=st.sampled_from(sorted(VALID)), junk=st.binary(max_size=80), at=st.floats(0, 1))
@example(name="a.xyz", junk=b"\r", at=0.1)
@example(name="a.pts", junk=b"\x1c", at=0.5)
def test_inserted_bytes_give_an_error_or_a_scan(name: str, junk: bytes, at: float) -> None:
    content = VALID[name]
    cut = int(at * len(content))
    read_soon(name, content[:cut] + junk + content[cut:])


@settings(max_examples=150, deadline=None)
@given(
    magic=st.sampled_from([b"", b"ply\n", b"ply\nformat ascii 1.0\n", b"# .PCD v0.7\n", b"VERSION 0.7\n", b"3\n"]),
    text=st.text(alphabet='0123456789.,;-+eE xyz\n\r\tnaif#/"_', max_size=60),
)
def test_random_text_gives_an_error_or_a_scan(magic: bytes, text: str) -> None:
    read_soon("a.xyz", magic + text.encode())
