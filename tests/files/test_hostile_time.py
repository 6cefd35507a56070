"""Time grows with the size of a hostile text and no faster: no pattern goes back over what it has seen."""

import contextlib
import time

import pytest

from stair_inspector.codes.limits import parse_written
from stair_inspector.columns import parse_columns
from stair_inspector.content.cures import advice_in_words
from stair_inspector.errors import StairError
from stair_inspector.files.scans import read_scan
from stair_inspector.files.toml import parse_toml
from stair_inspector.files.typed import split_typed
from stair_inspector.overrules import parse_force, parse_region

SMALL, TIMES = 12_000, 4
PLY = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
PCD = b"VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 4\nHEIGHT 1\nDATA ascii\n"
HEADS = {
    "nothing": b"",
    "names": b"x,y,z\n",
    "row": b"1 2 3 # a\n",
    "commas": b'"1,5";"2,5";"3,5"\n',
    "stl": b"solid a facet\n",
    "obj": b"v 1 2 3\nf 1 1 1\n",
    "off": b"OFF\n3 1 0\n",
    "glTF": b'{"asset":{"version":"2.0"},"accessors":[',
    "ply": PLY,
    "pcd": PCD,
}
UNITS = (b"\n", b" \n", b"\t", b" ", b",", b"0,", b"1 ", b"#", b"# \n", b";", b'"', b'" "\n', b"vertex\n", b"1 2 3\n")
UNITS += (b"a b c\n", b"1 2 a 3\n", b"1 2 3 a b\n4 5 c 6 d\n", b"\r", b"x [", b"1,5 ", b"1d", b"units: ", b"{", b"-")
SETTINGS = {
    "toml": lambda text: parse_toml(text.encode(), "a.toml"),
    "typed": split_typed,
    "limit": lambda text: parse_written(text, "mm"),
    "columns": parse_columns,
    "force": parse_force,
    "region": parse_region,
    "advice": advice_in_words,
}


def seconds(call, content):
    began = time.process_time()
    with contextlib.suppress(StairError, ValueError):
        call(content)
    return time.process_time() - began


def check_growth(call, begin, units):
    for unit in units:
        few = seconds(call, begin + unit * (SMALL // len(unit)))
        # What is quadratic takes 16 times as long; a tenth of a second is nothing to measure a ratio by. The least of
        # three times is that in which nothing else was done.
        allowed = 2 * TIMES * few + 0.1
        times = (seconds(call, begin + unit * (TIMES * SMALL // len(unit))) for _ in range(3))
        assert any(each < allowed for each in times), unit


@pytest.mark.parametrize("name", HEADS)
def test_scans(tmp_path, name):
    path = tmp_path / "a.txt"

    def read(content):
        path.write_bytes(content)
        read_scan(path)

    check_growth(read, HEADS[name], UNITS)


@pytest.mark.parametrize("name", SETTINGS)
def test_settings(name):
    units = [unit.decode() for unit in UNITS] + ["a.", "--up x ", "1 1/", "\\(", "at:1,", '"a".']
    check_growth(SETTINGS[name], "", units)
