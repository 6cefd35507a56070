"""Write a file completely or not at all."""

import os
import tempfile
from pathlib import Path

from stair_inspector.errors import WriteError


def write_atomically(path: Path, data: bytes) -> None:
    """Write ``data`` to ``path`` so that the file is either the old one or the complete new one.

    The data goes to a temporary file in the same folder, is flushed to the disk and then takes the name.

    Raises
    ------
    WriteError
        The folder is missing or cannot be written, or the disk is full; an existing file is then untouched.
    """
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        mode = path.stat().st_mode & 0o777 if path.is_file() else 0o666 & ~_umask()
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, mode)
        os.replace(temporary, path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise WriteError(f"{path}: cannot be written ({reason}); choose a folder you may write to") from error
    finally:
        # Also when the user interrupts.
        if temporary is not None and os.path.exists(temporary):
            os.unlink(temporary)


def _umask() -> int:
    # The only portable way to read the umask is to set it; it is put back at once.
    current = os.umask(0o022)
    os.umask(current)
    return current
