"""Of files that belong together all are new or none, whatever happens and whenever the program is killed."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from stair_inspector.errors import WriteError
from stair_inspector.files import atomic
from stair_inspector.files.atomic import finish_writing, write_all_atomically

NAMES = ("stair.json", "stair.csv", "stair_debug.ply", "stair_report.pdf")
OLD, NEW = b"old", b"new, and longer"
CALLS = ("fsync", "chmod", "replace", "link", "unlink")
"""What changes a folder, and where a disk may be full or the program be killed."""

DIE_AT_EVERY_CALL = """
import os, sys
from pathlib import Path
from stair_inspector.files import atomic

folder, names, calls = Path(sys.argv[1]), sys.argv[2].split(","), sys.argv[3].split(",")

def dying(name, left):
    call = getattr(os, name)
    def counted(*args, **options):
        left[0] -= 1
        if left[0] < 0:
            os._exit(9)
        return call(*args, **options)
    return counted

number, status = 0, 9
while status == 9:
    place = folder / str(number)
    place.mkdir()
    for name in names:
        (place / name).write_bytes(b"old")
    child = os.fork()
    if child == 0:
        left = [number]
        for name in calls:
            setattr(os, name, dying(name, left))
        atomic.write_all_atomically({place / name: b"new, and longer" for name in names})
        os._exit(0)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    number += 1
print(number)
"""

WRITE_ON_AND_ON = """
import itertools, sys
from pathlib import Path
from stair_inspector.files.atomic import write_all_atomically

folder, names = Path(sys.argv[1]), sys.argv[2].split(",")
for number in itertools.count():
    write_all_atomically({folder / name: str(number).encode() * 1000 for name in names})
    print(number, flush=True)
"""

WRITE_AT_ONCE = """
import sys
from pathlib import Path
from stair_inspector.files.atomic import write_all_atomically

folder, names = Path(sys.argv[1]), sys.argv[2].split(",")
sys.stdin.read()
for number in range(40):
    write_all_atomically({folder / name: f"{sys.argv[3]} {number}".encode() for name in names})
"""


def filled(folder):
    for name in NAMES:
        (folder / name).write_bytes(OLD)
    return {folder / name: NEW for name in NAMES}


def contents(folder):
    """The contents of the files; nothing else may lie there."""
    assert sorted(path.name for path in folder.iterdir()) == sorted(NAMES)
    return {(folder / name).read_bytes() for name in NAMES}


@pytest.mark.parametrize("call", CALLS[:4])
@pytest.mark.parametrize("number", range(len(NAMES) + 1))
def test_a_disk_that_is_full_at_any_point_leaves_the_old_files_and_no_other(tmp_path, monkeypatch, call, number):
    new = filled(tmp_path)
    plain, done = getattr(os, call), []

    def fails_at_last(*args, **options):
        done.append(args)
        if len(done) == number + 1:
            raise OSError(28, "No space left on device")
        return plain(*args, **options)

    monkeypatch.setattr(atomic.os, call, fails_at_last)
    if call == "link":
        # A file system without links: the old files are copied.
        write_all_atomically(new)
        assert contents(tmp_path) == {NEW}
        return
    with pytest.raises(WriteError, match="No space left on device"):
        write_all_atomically(new)
    assert contents(tmp_path) == {OLD}


def test_a_program_that_is_killed_at_any_call_leaves_all_old_or_all_new(tmp_path):
    run = subprocess.run(
        [sys.executable, "-c", DIE_AT_EVERY_CALL, str(tmp_path), ",".join(NAMES), ",".join(CALLS)],
        capture_output=True,
        text=True,
        check=True,
    )
    seen = []
    for number in range(int(run.stdout)):
        folder = tmp_path / str(number)
        finish_writing(folder)
        found = {(folder / name).read_bytes() for name in NAMES}
        assert len(found) == 1
        seen += found
    # Early deaths change nothing, late ones nothing more.
    assert seen[0] == OLD
    assert seen[-1] == NEW
    assert seen == sorted(seen, reverse=True)
    assert len(seen) > 4 * len(NAMES)


@pytest.mark.slow
def test_two_hundred_random_kills_leave_no_mixed_folder(tmp_path):
    rng = np.random.default_rng(0)
    for _ in range(200):
        with subprocess.Popen(
            [sys.executable, "-c", WRITE_ON_AND_ON, str(tmp_path), ",".join(NAMES)],
            stdout=subprocess.PIPE,
            text=True,
        ) as child:
            assert child.stdout.readline()
            time.sleep(float(rng.uniform(0.0, 0.03)))
            child.send_signal(signal.SIGKILL)
            child.wait()
        finish_writing(tmp_path)
        assert len({(tmp_path / name).read_bytes() for name in NAMES}) == 1


def test_what_was_killed_is_finished_by_the_next_that_writes_there(tmp_path):
    filled(tmp_path)
    (tmp_path / ".si-a").write_bytes(NEW)
    (tmp_path / ".si-list-b").write_text(json.dumps([[".si-a", NAMES[0]]]))
    write_all_atomically({tmp_path / NAMES[1]: NEW})
    assert (tmp_path / NAMES[0]).read_bytes() == NEW
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(NAMES)


@pytest.mark.parametrize(
    "said",
    [
        "[",
        "{}",
        "[[]]",
        '[["stair.csv", "stair.json"]]',
        '[[".si-a", "../taken"]]',
        '[[".si-a", ""]]',
        '[["../.si-a", "taken"]]',
        '[[".si-a", 3]]',
        '[[".si-a", "a\\u0000"]]',
        json.dumps([[".si-a", "taken"]] * 101),
    ],
)
def test_a_list_that_no_program_of_ours_wrote_names_nothing(tmp_path, said):
    folder = tmp_path / "results"
    folder.mkdir()
    filled(folder)
    (folder / ".si-a").write_bytes(NEW)
    (folder / ".si-list-b").write_text(said)
    assert finish_writing(folder) == []
    assert not (tmp_path / "taken").exists()
    assert {(folder / name).read_bytes() for name in NAMES} == {OLD}


def test_what_a_killed_program_left_is_deleted_once_it_is_old(tmp_path, monkeypatch):
    (tmp_path / ".si-a").write_bytes(NEW)
    finish_writing(tmp_path)
    assert (tmp_path / ".si-a").exists()
    now = time.time()
    monkeypatch.setattr(atomic.time, "time", lambda: now + 3700.0)
    finish_writing(tmp_path)
    assert not (tmp_path / ".si-a").exists()


def test_two_programs_that_write_at_once_leave_the_files_of_one(tmp_path):
    command = [sys.executable, "-c", WRITE_AT_ONCE, str(tmp_path), ",".join(NAMES)]
    programs = [subprocess.Popen([*command, name], stdin=subprocess.PIPE) for name in ("one", "two")]
    for program in programs:
        program.stdin.close()
    assert [program.wait(60) for program in programs] == [0, 0]
    (found,) = contents(tmp_path)
    assert found in (b"one 39", b"two 39")


@pytest.mark.skipif(sys.platform == "win32", reason="folders cannot be locked there")
def test_a_program_that_does_not_come_to_an_end_is_a_sentence(tmp_path, monkeypatch):
    new = filled(tmp_path)
    monkeypatch.setattr(atomic, "_WAIT_S", 0.05)
    with (
        atomic._alone_in(str(tmp_path)),
        pytest.raises(WriteError, match="another program is writing there; wait for it, or choose another folder"),
    ):
        write_all_atomically(new)
    assert contents(tmp_path) == {OLD}
    # One file cannot be mixed with others, and waits for nobody.
    with atomic._alone_in(str(tmp_path)):
        write_all_atomically({tmp_path / NAMES[0]: NEW})
    write_all_atomically(new)
    assert contents(tmp_path) == {NEW}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes there")
def test_a_list_that_is_no_file_is_left_alone(tmp_path):
    (tmp_path / ".si-list-a").mkdir()
    os.mkfifo(tmp_path / ".si-list-b")
    assert finish_writing(tmp_path) == []


def test_a_name_that_is_too_long_has_its_own_cure(tmp_path):
    new = filled(tmp_path) | {tmp_path / ("x" * 300): NEW}
    with pytest.raises(WriteError, match=r"cannot be written \(File name too long\); give the scan, or the folder, a "):
        write_all_atomically(new)
    assert contents(tmp_path) == {OLD}


@pytest.mark.skipif(sys.platform == "win32", reason="folders cannot be locked there")
def test_a_process_that_was_begun_while_files_were_written_keeps_nobody_waiting(tmp_path, monkeypatch):
    new, copies = filled(tmp_path), []
    plain = os.open

    def copied(*args, **options):
        copies.append(os.dup(handle := plain(*args, **options)))
        return handle

    with monkeypatch.context() as during:
        # What a child has of its parent's files.
        during.setattr(atomic.os, "open", copied)
        with atomic._alone_in(str(tmp_path)):
            assert len(copies) == 1
    monkeypatch.setattr(atomic, "_WAIT_S", 0.05)
    write_all_atomically(new)
    os.close(copies[0])
    assert contents(tmp_path) == {NEW}
