"""Notes of a measurement as the page says them: in its own words, and which of them an inspector must look at."""

from collections.abc import Iterable

from stair_inspector.content.cures import advice_in_words
from stair_inspector.model import Note
from stair_inspector.stages.withhold import ANSWERED_BY

_ON_THE_PAGE = (
    ("give another up direction, as --up z", "set another Up on the Scan tab, as z"),
    ("give --up=", "set Up on the Scan tab to "),
    ("give --up if it is not", "correct Up on the Scan tab if it is not"),
    ("give --unit ", "set Unit of the file on the Scan tab to "),
    ("state the unit with --unit", "set Unit of the file on the Scan tab"),
    ("give the up direction, for example --up z", "set Up on the Scan tab, for example z"),
    ("give --up -z if the scan's z axis points down", "set Up on the Scan tab to -z if the scan's z axis points down"),
    ("give --up if that is wrong", "correct Up on the Scan tab if that is wrong"),
    ("give --up if you know it", "set Up on the Scan tab if you know it"),
    ("measure it without --station", "choose 'all together' under Which station on the Scan tab"),
    ("or set uncertainty.*", "or state them on the Tune tab, under Survey"),
)
"""What the command line is told, and what the page has for it."""
_ROUTINE = frozenset(
    {
        "unit_guessed",
        "axes_rule",
        "uncertainty_unstated",
        "back_hidden",
        "back_unobserved",
        "side_unobserved",
        "nosing_unobserved",
        "duplicates_dropped",
        "non_finite_dropped",
        "no_return_dropped",
        "colors_dropped",
        "normals_dropped",
        "without_open3d",
        "columns_ignored",
        "stations_read",
        "rays_dropped",
        "pose_in_matrix_only",
        "pose_stretches",
        "invalid_dropped",
    }
)
"""Codes of notes that say how a value came about, and stand beside it too. All others may change what is a step."""


def on_page(words: str) -> str:
    """Return the words of a note or an error with the page's controls for the options of the command line."""
    for said, meant in _ON_THE_PAGE:
        words = words.replace(said, meant)
    # A page has buttons for it, above the tabs.
    return advice_in_words(words.partition(ANSWERED_BY)[0])


def needs_look(note: Note) -> bool:
    """Return whether a note may mean that the result is wrong, and not only how exact it is."""
    return note.code not in _ROUTINE


def n_to_look_at(notes: Iterable[Note]) -> int:
    """Return how many of the notes may mean that the result is wrong."""
    return sum(map(needs_look, notes))
