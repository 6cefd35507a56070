"""Hostile and broken input from end to end: exit code 2 or 3, one line on stderr, no traceback, nothing written."""

import os
from pathlib import Path

import numpy as np
import pytest

from stair_inspector.cli import main
from stair_inspector.files.ply import ply_bytes
from tests.synthetic import Stair

GOOD = ply_bytes(Stair(noise=0.002).sample()[0])


@pytest.fixture
def refused(tmp_path, capsys):
    def measure(content, *args, name="scan.ply", code=3, says, up="z"):
        """Measure a file with ``content`` (None: no file) and check the one line."""
        scan = tmp_path / name
        if content is not None:
            scan.write_bytes(content)
        before = sorted(tmp_path.rglob("*"))
        argv = ["measure", str(scan), "-o", str(tmp_path / "out"), "--up", up, *map(str, args)]
        assert main(argv) == code
        out, err = capsys.readouterr()
        assert out == ""
        assert err.startswith("stair-inspector: ")
        assert err.count("\n") == 1
        assert err.endswith("\n")
        assert "Traceback" not in err
        assert len(err) < 600
        assert says in err
        assert sorted(tmp_path.rglob("*")) == before, "nothing is written"
        if content is not None:
            with scan.open("rb") as stream:
                assert stream.read() == content

    return measure


def header(n, kind="ascii"):
    lines = ["ply", f"format {kind} 1.0", f"element vertex {n}", *(f"property double {axis}" for axis in "xyz")]
    return "\n".join([*lines, "end_header\n"]).encode()


def cloud(points):
    return ply_bytes(np.asarray(points, dtype=np.float64))


def test_an_empty_file(refused):
    refused(b"", says="is empty")


def test_a_truncated_header(refused):
    refused(GOOD[:60], says="truncated")


def test_a_truncated_body(refused):
    refused(GOOD[:-1000], says="truncated")


def test_a_truncated_ascii_body(refused):
    refused(header(3) + b"0 0 0\n1 1 1\n", says="states 3 points but 2 follow")


def test_a_header_that_states_fewer_points_than_there_are(refused):
    count = GOOD.split(b"element vertex ")[1].split(b"\n")[0]
    refused(GOOD.replace(b"vertex " + count, b"vertex 100"), says="bytes more than the 100 points")


def test_a_header_that_states_more_points_than_any_memory_holds(refused):
    count = GOOD.split(b"element vertex ")[1].split(b"\n")[0]
    refused(GOOD.replace(b"vertex " + count, b"vertex 99999999999999"), says="truncated")


def test_a_header_with_a_negative_count(refused):
    refused(header(-5), says="should be a whole number")


def test_text_where_binary_is_promised(refused):
    refused(header(2, "binary_little_endian") + b"0 0 0\n1 1 1\n", says="the data ends before")


def test_words_where_numbers_are_promised(refused):
    refused(header(2) + b"0 0 0\n1 one 1\n", says="'one' where a number is expected")


def test_binary_rubbish(refused):
    refused(bytes(range(256)) * 50, says="scan.ply: ")


def test_rubbish_as_text(refused):
    refused(bytes(range(256)) * 50, name="scan.xyz", says="scan.xyz: ")


def test_another_format(refused):
    refused(b"%PDF" + bytes(400), name="scan.e57", says="is PDF, which is not read")


def test_all_nan(refused):
    refused(cloud(np.full((100, 3), np.nan)), says="none of its 100 points is finite")


def test_all_infinite(refused):
    refused(cloud(np.full((100, 3), np.inf)), says="none of its 100 points is finite")


def test_all_equal(refused):
    refused(cloud(np.full((100, 3), 0.1)), says="1 distinct point, at least 50 are needed")


@pytest.mark.parametrize("up", ["z", "auto"])
def test_collinear(refused, up):
    refused(cloud(np.outer(np.linspace(0, 3, 500), [1.0, 0.2, 0.6])), says="all 500 points lie on one line", up=up)


def test_three_points(refused):
    refused(cloud([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), says="3 distinct points, at least 50 are needed")


def test_coordinates_beyond_every_scan(refused):
    refused(cloud(Stair().sample()[0] * 1e200), says="e+200")


def test_a_point_far_away_is_no_traceback(refused):
    points = Stair().sample()[0]
    points[0] = 1e11
    refused(cloud(points), "--unit", "m", says="1e+11 m, beyond 1e+09 m")


def test_a_missing_file(refused):
    refused(None, says="there is no such file")


def test_a_folder_without_scans_instead_of_a_file(refused, tmp_path):
    (tmp_path / "scan.ply").mkdir()
    refused(None, says="this folder holds no scans")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_instead_of_a_file_does_not_hang(refused, tmp_path):
    os.mkfifo(tmp_path / "scan.ply")
    refused(None, says="is a device or a pipe")


def test_a_file_that_may_not_be_opened(refused, monkeypatch):
    def deny(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", deny)
    refused(GOOD, says="cannot be opened (Permission denied)")


def test_an_unknown_setting(refused):
    refused(GOOD, "--levels.esp-m", "0.02", code=2, says="did you mean --levels.eps-m?")


def test_an_unknown_preset(refused):
    refused(GOOD, "--preset", "nothing_like_it", code=2, says="unknown preset 'nothing_like_it'")


def test_a_preset_file_that_is_no_toml(refused, tmp_path):
    (tmp_path / "mine.toml").write_text("levels {")
    refused(GOOD, "--preset", tmp_path / "mine.toml", code=2, says="mine.toml: is not valid TOML")


def test_a_preset_file_with_a_number_of_many_digits(refused, tmp_path):
    (tmp_path / "mine.toml").write_text("[levels]\nmin_points = " + "9" * 320)
    refused(GOOD, "--preset", tmp_path / "mine.toml", code=2, says="give a value from 1 to")


def test_a_value_out_of_range(refused):
    refused(GOOD, "--levels.eps-m", "5", code=2, says="levels.eps_m: got 5.0; give a value from")


def test_a_value_that_is_no_number(refused):
    refused(GOOD, "--edges.front-percentile", "nan", code=2, says="edges.front_percentile: got nan; give a number")


def test_a_number_of_many_digits(refused):
    refused(GOOD, "--levels.min-points", "9" * 320, code=2, says="give a value from 1 to")


def test_a_file_as_output_folder(refused, tmp_path):
    (tmp_path / "file").write_bytes(b"mine")
    refused(GOOD, "-o", tmp_path / "file", code=2, says="is a file, not a folder")


def test_an_output_folder_that_may_not_be_written(refused, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)
    refused(GOOD, code=2, says="cannot be written (permission denied)")


def test_settings_that_make_too_many_levels(refused):
    # A slope of 45 degrees, sampled in 510 rows that lie on no lattice.
    rng = np.random.default_rng(1)
    row = np.repeat(np.arange(510) * 0.05 + rng.uniform(-0.02, 0.02, 510), 6)
    place = rng.uniform(0.0, 0.3, len(row))
    refused(
        cloud(np.column_stack([row, place, row])),
        *("--levels.eps-m", "0.001", "--levels.min-points", "1", "--horizontal.theta-deg", "60"),
        says="510 height clusters, more than 500 can be steps",
    )
