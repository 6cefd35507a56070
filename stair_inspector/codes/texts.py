"""What may stand in a text of a rule set: ids, plain lines, words of a list."""

import re

from stair_inspector.errors import ConfigError, is_one_line

_ID = re.compile(r"[a-z0-9](?:[a-z0-9.-]{0,79})")
_TEXT_LIMIT = 2000
_TURNERS = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Letters that turn the direction of those after them, so that a text reads as another than it is."""


def is_plain_line(text: str) -> bool:
    """Return whether a text is one line that reads in its own order: no control and no turn of the direction."""
    return is_one_line(text) and _TURNERS.isdisjoint(text)


def check_id(what: str, text: str) -> None:
    """Raise ConfigError unless the text is an id: small letters, digits, dots and hyphens."""
    if not isinstance(text, str) or _ID.fullmatch(text) is None:
        shown = repr(text)[:60]
        raise ConfigError(f"{what} {shown}: give up to 80 small letters, digits, dots and hyphens, as us-irc-2024")


def check_plain_text(place: str, text: str, may_be_empty: bool = False) -> None:
    """Raise ConfigError unless the text is one plain line that is not too long."""
    if not isinstance(text, str) or len(text) > _TEXT_LIMIT:
        raise ConfigError(f"{place}: give a text of at most {_TEXT_LIMIT} characters in quotes")
    if not text.strip() and not may_be_empty:
        raise ConfigError(f"{place}: is empty; fill it in")
    if not is_plain_line(text):
        raise ConfigError(f"{place}: holds a line break or a control character; write it on one line")


def check_member(place: str, value: str, known: tuple[str, ...]) -> None:
    """Raise ConfigError unless the value is one of those that are known."""
    if value not in known:
        raise ConfigError(f"{place}: got {repr(value)[:60]}; give one of {', '.join(known)}")
