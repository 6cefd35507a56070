"""A reading as somebody writes it down: ``170.5``, ``170.5 mm``, ``7 9/16"``, ``7¾ in``."""

import re
import unicodedata

from stair_inspector.errors import ConfigError
from stair_inspector.files.typed import with_plain_fractions
from stair_inspector.params import brief

_SIGNS = {
    '"': "in",
    "”": "in",
    "′′": "in",
    "''": "in",
    "inch": "in",
    "inches": "in",
    "'": "ft",
    "’": "ft",
    "′": "ft",
    "°": "deg",
}
"""Signs and words of units beside their names."""
_WRITTEN = re.compile(r"(?P<number>.*[0-9])\s*(?P<unit>[A-Za-z]+|[\"”'’′°%]{1,2}|)", re.DOTALL)
_RAISED = re.compile(r"(?<=[0-9])(?=[⁰¹²³⁴⁵⁶⁷⁸⁹])")
_SLASH = re.compile(r" ?/ ?")
_COMMA = re.compile(r"[+−-]?\s*[0-9]+,[0-9]+")


def split_unit(text: str, place: str) -> tuple[str, str]:
    """Return the number of a reading, fractions with a slash, and its unit, empty where none is written.

    Raises
    ------
    ConfigError
        A comma stands in the number: a thousand to some, a decimal to others.
    """
    plain = unicodedata.normalize("NFKC", _RAISED.sub(" ", with_plain_fractions(text)))
    found = _WRITTEN.fullmatch(_SLASH.sub("/", " ".join(plain.split())))
    number, unit = (plain, "") if found is None else (found["number"], found["unit"])
    if _COMMA.fullmatch(number):
        raise ConfigError(f"{place}: got {brief(text)}; write a point, not a comma, as in 170.5")
    return number, _SIGNS.get(unit.lower(), unit.lower())
