"""The page of a report on what changed between two scans of one stair."""

from collections.abc import Sequence

from stair_inspector.comparison.words import LAID_ON, notes_on
from stair_inspector.content.comparisons import alignment_facts, changes_in_numbers
from stair_inspector.content.document import Block, Bullets, Figure, Paragraph, plain
from stair_inspector.model import ComparedScan, Note

CHANGES = "Changes between two scans"
"""The title of the page."""


def what_changed(compared: ComparedScan) -> tuple[Note, ...]:
    """Return what changed, by the numbers of the scan at hand; what the scans were laid on is told beside it."""
    return tuple(note for note in notes_on(compared.found, is_earlier=compared.is_earlier) if note.code != LAID_ON)


def change_blocks(compared: ComparedScan, pictures: Sequence[Figure] = ()) -> list[Block]:
    """Return what changed in words and numbers, what the scans were laid onto each other on, and the maps of treads."""
    found = compared.found
    at_hand, which = (found.before, "the earlier one") if compared.is_earlier else (found.after, "the later one")
    count = len(found.steps)
    words = (
        f"{plain(found.before.name)} and {plain(found.after.name)} have {count} step{'' if count == 1 else 's'} in "
        f"common; the rest of this report is of {plain(at_hand.name)}, {which}."
    )
    return [
        Paragraph(words),
        Bullets(tuple(plain(note.message) for note in what_changed(compared))),
        changes_in_numbers(compared),
        alignment_facts(compared),
        *pictures,
    ]
