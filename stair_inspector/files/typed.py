"""Numbers with their units as people type them."""

import re
import unicodedata

_SIGNS = {
    '"': "in",
    "”": "in",
    "′′": "in",
    "''": "in",
    "’’": "in",
    "inch": "in",
    "inches": "in",
    "'": "ft",
    "’": "ft",
    "′": "ft",
    "°": "deg",
}
"""Signs and words of units beside their names, as keyboards and word processors write them."""
_WRITTEN = re.compile(r"(?P<number>.*[0-9])\s*(?P<unit>[A-Za-z]+|[\"”'’′°%]{1,2}|)", re.DOTALL)
_RAISED = re.compile(r"(?<=[0-9])(?=[⁰¹²³⁴⁵⁶⁷⁸⁹])")
_SLASH = re.compile(r" ?/ ?")


def split_typed(text: str) -> tuple[str, str]:
    """Return a number in plain digits, fractions with a slash, and its unit, empty where none is written.

    What is no number with a unit after it comes back whole, without a unit.

    Examples
    --------
    >>> split_typed("7¾″")
    ('7 3/4', 'in')
    """
    plain = unicodedata.normalize("NFKC", _RAISED.sub(" ", _with_plain_fractions(text)))
    found = _WRITTEN.fullmatch(_SLASH.sub("/", " ".join(plain.split())))
    if found is None:
        return plain, ""
    return found["number"], _SIGNS.get(found["unit"].lower(), found["unit"].lower())


def _with_plain_fractions(text: str) -> str:
    """Return a text with fractions of one letter, and the slash of typeset ones, in plain digits: ``7¾`` as 7 3/4."""
    return "".join(
        f" {unicodedata.normalize('NFKC', letter)}"
        if unicodedata.decomposition(letter).startswith("<fraction>")
        else letter
        for letter in text
    ).replace("\N{FRACTION SLASH}", "/")
