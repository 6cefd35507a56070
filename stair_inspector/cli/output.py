"""What the command line prints: results on stdout, an error as one line on stderr."""

import os
import sys

from stair_inspector.errors import ConfigError, StairError, WriteError


def say(text: str) -> None:
    """Print a result. A reader that has seen enough, such as head, must not stop the work."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - must outlive this function


def report_error(error: StairError) -> int:
    """Print an error as one line and return its exit code."""
    line = " ".join(str(error).split())
    print(f"stair-inspector: {line}", file=sys.stderr)
    return 2 if isinstance(error, (ConfigError, WriteError)) else 3


def internal_words(error: BaseException) -> str:
    """Return what is said of an error that nobody foresaw."""
    if isinstance(error, MemoryError):
        return "there is not enough memory"
    if isinstance(error, OSError) and error.strerror:
        return f"the system reports: {error.strerror}"
    return f"internal error ({type(error).__name__}: {error})"
