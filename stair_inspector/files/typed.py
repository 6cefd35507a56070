"""Numbers as people type them."""

import unicodedata


def with_plain_fractions(text: str) -> str:
    """Return a text with fractions of one letter, and the slash of typeset ones, in plain digits: ``7¾`` as 7 3/4."""
    return "".join(
        f" {unicodedata.normalize('NFKC', letter)}"
        if unicodedata.decomposition(letter).startswith("<fraction>")
        else letter
        for letter in text
    ).replace("\N{FRACTION SLASH}", "/")
