"""Write files completely or not at all."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from stair_inspector.errors import WriteError


def write_atomically(path: Path, data: bytes) -> None:
    """Write ``data`` to ``path`` so that the file is either the old one or the complete new one.

    Raises
    ------
    WriteError
        As :func:`write_all_atomically`.
    """
    write_all_atomically({path: data})


def write_all_atomically(contents: Mapping[Path, bytes]) -> None:
    """Write files that belong together.

    The data of all goes to temporary files beside them and is flushed to the disk; only then do they take their names.

    Raises
    ------
    WriteError
        A folder is missing or cannot be written, a name is not possible, or the disk is full; the existing files are
        then untouched.
    """
    staged: list[tuple[str, Path]] = []
    path = Path()
    try:
        for path, data in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            if path.is_dir():
                raise WriteError(f"{path}: cannot be written (it is a folder); choose another folder")
            mode = path.stat().st_mode & 0o777 if path.is_file() else 0o666 & ~_umask()
            # A short name of its own: the file's may already be as long as the file system allows.
            handle, temporary = tempfile.mkstemp(prefix=".si-", dir=path.parent)
            staged.append((temporary, path))
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            os.chmod(temporary, mode)
        for temporary, path in staged:
            os.replace(temporary, path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise WriteError(f"{path}: cannot be written ({reason}); choose a folder you may write to") from error
    finally:
        # Also when the user interrupts.
        for temporary, _ in staged:
            if os.path.exists(temporary):
                os.unlink(temporary)


def _umask() -> int:
    # The only portable way to read the umask is to set it; it is put back at once.
    current = os.umask(0o022)
    os.umask(current)
    return current
