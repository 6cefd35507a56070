"""A file is the old one or the complete new one, whatever happens."""

import os
import stat

import pytest

from stair_inspector.errors import WriteError
from stair_inspector.files import atomic
from stair_inspector.files.atomic import write_atomically


def failing(error):
    def fail(*_, **__):
        raise error

    return fail


def test_writes_a_new_file_with_the_folders_above_it(tmp_path):
    path = tmp_path / "a" / "b" / "result.json"
    write_atomically(path, b"data")
    assert path.read_bytes() == b"data"
    assert [file.name for file in path.parent.iterdir()] == ["result.json"]


def test_replaces_a_file_without_leaving_another(tmp_path):
    path = tmp_path / "result.json"
    path.write_bytes(b"old and longer")
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("step", ["fsync", "chmod", "replace"])
def test_a_failing_write_leaves_the_old_file_and_no_other(tmp_path, monkeypatch, step):
    path = tmp_path / "result.json"
    path.write_bytes(b"old")
    monkeypatch.setattr(atomic.os, step, failing(OSError(28, "No space left on device")))
    with pytest.raises(WriteError) as error:
        write_atomically(path, b"new")
    assert str(error.value) == (f"{path}: cannot be written (No space left on device); make room on this disk")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_an_interrupted_write_leaves_the_old_file_and_no_other(tmp_path, monkeypatch):
    path = tmp_path / "result.json"
    path.write_bytes(b"old")
    monkeypatch.setattr(atomic.os, "fsync", failing(KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        write_atomically(path, b"new")
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == b"old"


def test_a_folder_that_may_not_be_written_is_a_write_error(tmp_path, monkeypatch):
    monkeypatch.setattr(atomic.tempfile, "mkstemp", failing(PermissionError(13, "Permission denied")))
    with pytest.raises(WriteError, match=r"cannot be written \(Permission denied\)"):
        write_atomically(tmp_path / "result.json", b"data")


def test_a_file_where_a_folder_is_needed_is_a_write_error(tmp_path):
    (tmp_path / "file").write_bytes(b"mine")
    with pytest.raises(WriteError, match="cannot be written"):
        write_atomically(tmp_path / "file" / "result.json", b"data")
    assert (tmp_path / "file").read_bytes() == b"mine"


def test_a_folder_where_the_file_should_be_is_a_write_error(tmp_path):
    (tmp_path / "result.json").mkdir()
    with pytest.raises(WriteError, match="cannot be written"):
        write_atomically(tmp_path / "result.json", b"data")
    assert list(tmp_path.iterdir()) == [tmp_path / "result.json"]


def test_a_name_that_is_too_long_is_a_write_error(tmp_path):
    with pytest.raises(WriteError, match="cannot be written"):
        write_atomically(tmp_path / ("x" * 300), b"data")


@pytest.mark.skipif(os.name == "nt", reason="modes are those of POSIX")
@pytest.mark.parametrize("mode", [0o600, 0o644, 0o664])
def test_the_mode_of_an_existing_file_is_kept(tmp_path, mode):
    path = tmp_path / "result.json"
    path.write_bytes(b"old")
    path.chmod(mode)
    write_atomically(path, b"new")
    assert stat.S_IMODE(path.stat().st_mode) == mode


@pytest.mark.skipif(os.name == "nt", reason="modes are those of POSIX")
@pytest.mark.parametrize(("umask", "mode"), [(0o022, 0o644), (0o077, 0o600)])
def test_a_new_file_has_the_mode_of_the_umask(tmp_path, umask, mode):
    before = os.umask(umask)
    try:
        write_atomically(tmp_path / "result.json", b"new")
        assert os.umask(umask) == umask
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "result.json").stat().st_mode) == mode
