"""The few errors a user can cause, and how their text repeats what was given.

The command line and the page show the text of an error and nothing else.
"""

import unicodedata
from collections.abc import Iterable
from typing import TypeVar

Option = TypeVar("Option", bound=str)
_LONGEST_SHOWN = 60
"""Characters of a wrong value that a message repeats: a file may hold megabytes of it."""


class StairError(Exception):
    """Root of all errors that are told to the user as one sentence: what, where, what to do."""


class ReadError(StairError):
    """A scan or a settings file cannot be read: missing, damaged, or not what its header says."""


class ColumnsUnclear(ReadError):
    """A scan in text does not say which of its columns are x, y and z.

    ``lines`` are the first of its table, to be shown; ``proposals`` what ``--columns`` might be given.
    """

    def __init__(self, message: str, lines: tuple[str, ...] = (), proposals: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.lines = lines
        self.proposals = proposals


class WriteError(StairError):
    """A result cannot be written where the user asked for it."""


class ConfigError(StairError, ValueError):
    """A setting, preset, flag or value from a page is unknown, of the wrong type or out of range."""


class DegenerateGeometry(StairError, ValueError):
    """Points do not determine what was asked of them: too few, not finite, or all on one line."""


class CannotMeasure(StairError):
    """A stage finds nothing to hand on; the text says what was seen and which setting to try."""


class MissingLibrary(StairError):
    """A shared library of the operating system is missing; the text names the package that has it."""


def is_one_line(text: str) -> bool:
    """Return whether a text can stand on one line of a page or a file: without control characters or half letters."""
    return not any(unicodedata.category(letter) in ("Cc", "Cs", "Zl", "Zp") for letter in text)


def brief(value: object) -> str:
    """Return a wrong value as a message repeats it, its end cut off where it is long."""
    try:
        shown = repr(value)
    except RecursionError:
        shown = f"a {type(value).__name__} nested too deeply to be shown"
    if "\n" in shown:
        # As arrays are shown.
        shown = " ".join(shown.split())
    return shown if len(shown) <= _LONGEST_SHOWN else f"{shown[:_LONGEST_SHOWN]}..."


def one_of(value: object, options: Iterable[Option], place: str) -> Option:
    """Return the option that a control names: a page may send anything.

    Raises
    ------
    ConfigError
        It is none of the options; ``place`` says whose it would be.
    """
    known = tuple(options)
    for option in known:
        if option == value:
            return option
    raise ConfigError(f"{place}: got {str(value)[:40]!r}; give one of {', '.join(known)}")
