"""Write files completely or not at all; of several that belong together, all or none.

Names are given to new files one after the other, and a program can be killed in between. So the names that are to be
given are written down first, in a file of their own beside them; whoever writes into or checks the folder next gives
the rest. What was killed earlier has changed nothing.
"""

import contextlib
import errno
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from stair_inspector.errors import WriteError

if sys.platform != "win32":
    import fcntl

_TEMPORARY, _LIST = ".si-", ".si-list-"
_LONGEST_LIST = 100_000
_MOST_FILES = 100
_LEFT_S = 3600.0
"""A temporary file that is older was left by a program that was killed: no file takes so long."""
_FULL = (errno.ENOSPC, errno.EDQUOT)
_WAIT_S, _LOOK_S = 60.0, 0.02
"""How long to wait for another program that writes into a folder, and how often to look."""


def write_atomically(path: Path, data: bytes) -> None:
    """Write ``data`` to ``path`` so that the file is either the old one or the complete new one.

    Raises
    ------
    WriteError
        As :func:`write_all_atomically`.
    """
    write_all_atomically({path: data})


def write_all_atomically(contents: Mapping[Path, bytes]) -> None:
    """Write files that belong together: all of a folder, or none of it.

    The data of all goes to temporary files beside them and is flushed to the disk; only then do they take their names.
    What a program that was killed had still to name in these folders is named first, see :func:`finish_writing`. Of two
    programs that write such files into a folder at once, one waits for the other.

    Raises
    ------
    WriteError
        A folder is missing or cannot be written, a name is not possible, the disk is full, or another program does not
        come to an end there; the existing files are then untouched.
    """
    path = Path()
    alone = contextlib.ExitStack()
    staged: list[tuple[Path, Path]] = []
    lists: list[Path] = []
    kept: list[tuple[Path, Path | None]] = []
    try:
        folders = {path.parent: None for path in contents}
        for path in folders:
            path.mkdir(parents=True, exist_ok=True)
        if len(contents) > 1:
            for real in sorted({os.path.realpath(folder) for folder in folders}):
                alone.enter_context(_alone_in(real))
        for path in folders:
            finish_writing(path)
        for path, data in contents.items():
            if path.is_dir():
                raise WriteError(f"{path}: cannot be written (it is a folder); choose another folder")
            mode = path.stat().st_mode & 0o777 if path.is_file() else 0o666 & ~_umask()
            staged.append((_stage(path.parent, data, mode), path))
        if len(staged) > 1:
            lists = [_list_names(folder, staged) for folder in {path.parent: None for path in contents}]
        for temporary, path in staged:
            if len(staged) > 1:
                kept.append((path, _keep_old(path)))
            _name(temporary, path)
    except OSError as error:
        _undo(kept)
        reason = error.strerror or str(error)
        raise WriteError(f"{path}: cannot be written ({reason}); {_hint_on(error)}") from error
    except BaseException:
        # Also when the user interrupts.
        _undo(kept)
        raise
    finally:
        # The list goes first: without its files it would be an order to name what is not there.
        old = (each for _, each in kept if each is not None)
        for left in (*lists, *(temporary for temporary, _ in staged), *old):
            with contextlib.suppress(OSError):
                left.unlink(missing_ok=True)
        alone.close()


def finish_writing(folder: Path) -> list[str]:
    """Give the names that a killed program had written down, and delete what it had not come to write down.

    Parameters
    ----------
    folder : Path
        Where files are written; need not be there.

    Returns
    -------
    list of str
        Names that were given.

    Raises
    ------
    OSError
        The folder cannot be read, or not be written where there is a name to give.
    """
    named: list[str] = []
    for waiting in sorted(path for path in folder.glob(f"{_LIST}*") if path.is_file()):
        for temporary, name in _read_list(waiting):
            if (folder / temporary).is_file():
                _name(folder / temporary, folder / name)
                named.append(name)
        waiting.unlink(missing_ok=True)
    for left in folder.glob(f"{_TEMPORARY}*"):
        # What cannot be deleted is in nobody's way.
        with contextlib.suppress(OSError):
            # Of a kept old file the time of its content is older.
            if time.time() - left.stat().st_ctime > _LEFT_S:
                left.unlink()
    return named


@contextlib.contextmanager
def _alone_in(folder: str) -> Iterator[None]:
    """Keep other programs from writing files that belong together into a folder; where that can be, as not on Windows.

    Raises
    ------
    WriteError
        One that does so does not come to an end.
    """
    if sys.platform == "win32":
        yield
        return
    try:
        lock = os.open(folder, os.O_RDONLY)
    except OSError:
        # A folder may be written that cannot be read.
        yield
        return
    try:
        end = time.monotonic() + _WAIT_S
        while not _is_locked(lock):
            if time.monotonic() > end:
                raise WriteError(f"{folder}: another program is writing there; wait for it, or choose another folder")
            time.sleep(_LOOK_S)
        yield
    finally:
        # A process that was begun meanwhile may hold the same lock: closing it here alone would not end it.
        with contextlib.suppress(OSError):
            fcntl.flock(lock, fcntl.LOCK_UN)
        os.close(lock)


if sys.platform != "win32":

    def _is_locked(lock: int) -> bool:
        """Lock a folder; false where another program has, true too on a file system without locks."""
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            return True
        return True


def _stage(folder: Path, data: bytes, mode: int) -> Path:
    """Write a temporary file to the disk."""
    # A short name of its own: the file's may already be as long as the file system allows.
    handle, temporary = tempfile.mkstemp(prefix=_TEMPORARY, dir=folder)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, mode)
    except BaseException:
        os.unlink(temporary)
        raise
    return Path(temporary)


def _list_names(folder: Path, staged: Sequence[tuple[Path, Path]]) -> Path:
    """Write down which names the temporary files of a folder are to get, completely or not at all."""
    names = [[temporary.name, path.name] for temporary, path in staged if path.parent == folder]
    temporary = _stage(folder, json.dumps(names).encode("ascii"), 0o600)
    # Its name tells that it is whole.
    listed = folder / f"{_LIST}{temporary.name.removeprefix(_TEMPORARY)}"
    try:
        os.replace(temporary, listed)
    except OSError:
        temporary.unlink()
        raise
    return listed


def _read_list(path: Path) -> list[tuple[str, str]]:
    """Return what a list says; nothing of one that is not as this program writes them."""
    try:
        with path.open("rb") as stream:
            entries = json.loads(stream.read(_LONGEST_LIST))
    except (FileNotFoundError, ValueError, RecursionError):
        return []
    if not isinstance(entries, list) or len(entries) > _MOST_FILES:
        return []
    names: list[tuple[str, str]] = []
    for entry in entries:
        if not (isinstance(entry, list) and len(entry) == 2 and all(isinstance(each, str) for each in entry)):
            return []
        temporary, name = entry
        # Nothing but names within the folder, and nothing but temporary files is named.
        if not temporary.startswith(_TEMPORARY) or not all(is_plain_name(each) for each in entry):
            return []
        names.append((temporary, name))
    return names


def is_plain_name(name: str) -> bool:
    """Return whether a name from a file is that of something beside it: no path, and no folder above."""
    return name not in ("", ".", "..") and name == os.path.basename(name) and "\\" not in name and "\0" not in name


def _name(temporary: Path, path: Path) -> None:
    try:
        os.replace(temporary, path)
    except FileNotFoundError:
        # Another program has come to finish this one's work.
        if not path.is_file():
            raise


def _keep_old(path: Path) -> Path | None:
    """Keep a file that will be replaced, until all are; None where there is none."""
    if not path.is_file():
        return None
    handle, old = tempfile.mkstemp(prefix=_TEMPORARY, dir=path.parent)
    os.close(handle)
    os.unlink(old)
    try:
        os.link(path, old)
    except OSError:
        # Not every file system has links.
        shutil.copy2(path, old)
    return Path(old)


def _undo(kept: Sequence[tuple[Path, Path | None]]) -> None:
    """Bring the files back that were replaced."""
    for path, old in reversed(kept):
        with contextlib.suppress(OSError):
            if old is not None:
                os.replace(old, path)
            else:
                path.unlink(missing_ok=True)


def _hint_on(error: OSError) -> str:
    if error.errno == errno.ENAMETOOLONG:
        return "give the scan, or the folder, a shorter name"
    return "make room on this disk" if error.errno in _FULL else "choose a folder you may write to"


def _umask() -> int:
    # The only portable way to read the umask is to set it; it is put back at once.
    current = os.umask(0o022)
    os.umask(current)
    return current
