"""A reading as somebody writes it down: ``170.5``, ``170.5 mm``, ``7 9/16"``, ``7¾ in``."""

import re

from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.typed import split_typed

_COMMA = re.compile(r"[+−-]?\s*[0-9]+,[0-9]+")


def split_unit(text: str, place: str) -> tuple[str, str]:
    """Return the number of a reading, fractions with a slash, and its unit, empty where none is written.

    Raises
    ------
    ConfigError
        A comma stands in the number: a thousand to some, a decimal to others.
    """
    number, unit = split_typed(text)
    if _COMMA.fullmatch(number):
        raise ConfigError(f"{place}: got {brief(text)}; write a point, not a comma, as in 170.5")
    return number, unit
