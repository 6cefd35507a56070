"""The drill of a new scan format: one file, one line."""

import subprocess
import sys

import pytest

from stair_inspector import cli
from tests.package_copy import copy_package, environment_of
from tests.synthetic import Stair

READER = '''"""Reads ABC: the word ABC, then x, y, z as little-endian float64."""

import numpy as np

from stair_inspector.files.raw_cloud import RawCloud, ScanFormat


def is_abc(data: bytes) -> bool:
    """Return whether a file begins as ABC does."""
    return data.startswith(b"ABC")


def read_abc(data: bytes) -> RawCloud:
    """Read an ABC file."""
    return RawCloud(np.frombuffer(data[3:], dtype="<f8").reshape(-1, 3).copy())


FORMAT = ScanFormat(".abc", "'ABC'", is_abc, read_abc)
'''


@pytest.mark.slow
def test_a_new_format_is_one_file_and_one_line(tmp_path, capsys):
    copy, folder = tmp_path / "copy", tmp_path / "scans"
    room = copy_package(copy) / "files"
    folder.mkdir()
    points, *_ = Stair(noise=0.002).sample()
    (folder / "stair.abc").write_bytes(b"ABC" + points.astype("<f8").tobytes())
    words = ["measure", str(folder), "-o", str(copy / "out"), "--up", "z", "--unit", "m"]
    assert cli.main(words) == 3
    assert "this folder holds no scans" in capsys.readouterr().err

    (room / "abc_scan.py").write_text(READER, encoding="utf-8")
    table = (room / "scans.py").read_text(encoding="utf-8")
    line = '    "pcd_scan",\n'
    assert table.count(line) == 1
    (room / "scans.py").write_text(table.replace(line, line + '    "abc_scan",\n'), encoding="utf-8")
    command = [sys.executable, "-m", "stair_inspector", *words]
    environment = environment_of(copy)
    after = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True, check=False)
    assert after.stderr == ""
    assert after.returncode == 0
    assert (copy / "out" / "stair.json").is_file()
