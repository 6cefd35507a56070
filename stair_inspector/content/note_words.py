"""Notes of a measurement as a report prints them: what they say, without the advice on the program's settings."""

import re

from stair_inspector.content.document import plain

_ADVICE = re.compile(
    r"(?:;|:|, so several have run together:) (?:"
    r"give --up\b|if that is wrong, state the unit with --unit|choose the scanner's preset, or set uncertainty\.\*|"
    r"check the up direction|try another axes rule|lower eps_z or raise m|correct overrules\.climb|"
    r"it is answered by:|measure with the method survey|overrule it if that is the step|"
    r"make the (?:region|box) larger to measure it|"
    r"as where treads between them were not found: check|if they are steps, give|(?:raise|lower|set|use) --|"
    r"if so, give --unit"
    r").*\Z",
    re.DOTALL,
)
"""The end of a message that tells the user of the program, and not the reader of a report, what to do."""
_IN_WORDS = (
    ("overrules.climb (", "the direction of climb that was set ("),
    ("(patches.min_area_m2 is ", "(the least area that was set, m²: "),
)
"""Names of settings that a message gives, and what they mean."""


def note_words(message: str) -> str:
    """Return what a note says, without what it advises and without names of settings."""
    said = _ADVICE.sub("", message)
    for name, meant in _IN_WORDS:
        said = said.replace(name, meant)
    return plain(said)


def note_sentence(message: str) -> str:
    """Return what a note says as a sentence."""
    words = note_words(message)
    return f"{words[:1].upper()}{words[1:]}."
