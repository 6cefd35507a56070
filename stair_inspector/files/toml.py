"""TOML files and tables of values, read so that every error names the file and the key."""

import difflib
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from stair_inspector.errors import ConfigError, brief

_MAX_BYTES = 1_000_000
_MOST_PARTS = 50
_KEY_PART = r"""(?:[\w-]{1,200}|"(?:[^"\\\n]|\\.){0,200}"|'[^'\n]{0,200}')"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_KEY_PART}(?:[ \t]*\.[ \t]*{_KEY_PART}){{{_MOST_PARTS}}}")
"""More parts with dots between them than a key has. The reader's time grows with the square of their number.

Parts are bounded, so that the search itself takes no longer for a text that was made to be slow."""


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    ConfigError
        Missing, unreadable, larger than 1 MB, not UTF-8 or not TOML.
    """
    return parse_toml(read_toml_bytes(path), str(path))


def read_toml_bytes(path: Path) -> bytes:
    """Return the bytes of a TOML file, at most what :func:`parse_toml` needs to refuse one that is too large.

    Raises
    ------
    ConfigError
        Missing or unreadable.
    """
    try:
        with path.open("rb") as stream:
            return stream.read(_MAX_BYTES + 1)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}); check the name") from error


def parse_toml(data: bytes, place: str) -> dict[str, Any]:
    """Read TOML from the bytes of its file; ``place`` is its name, for the messages.

    Raises
    ------
    ConfigError
        Larger than 1 MB, not UTF-8, a key of more than 50 parts, or not TOML.
    """
    if len(data) > _MAX_BYTES:
        raise ConfigError(f"{place}: larger than {_MAX_BYTES // 1_000_000} MB, which no settings file is")
    try:
        # As a file that is opened as text: TOML itself allows no lone carriage return, and no mark of the byte order.
        content = data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
        long_key = _LONG_KEY.search(content)
        if long_key is not None:
            line = content.count("\n", 0, long_key.start()) + 1
            raise ConfigError(f"{place}: line {line}: a key of more than {_MOST_PARTS} parts; give a shorter one")
        return tomllib.loads(content)
    except UnicodeDecodeError as error:
        raise ConfigError(f"{place}: is not a text file; give a TOML file") from error
    except (ValueError, RecursionError) as error:
        # tomllib's own error is a ValueError; numbers of thousands of digits and deep nesting raise the others.
        raise ConfigError(f"{place}: is not valid TOML ({error}); mend that place") from error


def check_keys(place: str, keys: Iterable[str], known: Iterable[str], what: str = "key") -> None:
    """Raise ConfigError for the first key that is not known, naming the nearest known one."""
    known = list(known)
    for key in keys:
        if key not in known:
            near = difflib.get_close_matches(key, known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(sorted(known))}"
            raise ConfigError(f"{place}: unknown {what} {key[:60]!r}; {hint}")


def as_table(value: object, place: str, keys: Iterable[str], later: Iterable[str] = ()) -> dict[str, Any]:
    """Return a table that has these keys, and of others at most the later ones.

    Raises
    ------
    ConfigError
        No table, an unknown key (the nearest known one is named), or a missing one.
    """
    keys = tuple(keys)
    if not isinstance(value, dict):
        raise ConfigError(f"{place}: got {brief(value)}; give a table with {', '.join(keys)}")
    check_keys(place, value, (*keys, *later))
    missing = [key for key in keys if key not in value]
    if missing:
        raise ConfigError(f"{place}: the key {missing[0]!r} is missing; give it, or another file")
    return value
