"""Texts that somebody wrote for the report."""

import datetime

from stair_inspector.codes.texts import is_plain_line
from stair_inspector.errors import ConfigError, brief

LONGEST_TEXT = 4000
"""Characters of one field: half a page."""


def require_text(value: object, name: str) -> str:
    """Return a user's text without blanks at its ends; a date or time, as TOML knows them, is written as in ISO 8601.

    Raises
    ------
    ConfigError
        No text, longer than :data:`LONGEST_TEXT`, or with control characters, half letters or marks that turn the
        direction of reading.
    """
    if isinstance(value, (datetime.date, datetime.time)):
        value = value.isoformat()
    if not isinstance(value, str):
        raise ConfigError(f"{name}: got {brief(value)}; give a text in quotes")
    text = value.replace("\r\n", "\n").replace("\r", "\n").replace("\t", " ").strip()
    if len(text) > LONGEST_TEXT:
        raise ConfigError(f"{name}: {len(text):,} characters; give at most {LONGEST_TEXT:,}")
    broken = next((letter for letter in text if letter != "\n" and not is_plain_line(letter)), "")
    if broken:
        raise ConfigError(
            f"{name}: holds a control character, half a letter or a mark that turns the direction of reading, "
            f"{broken!a}; take it out"
        )
    return text
