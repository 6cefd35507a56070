"""What was found about a scan before it was measured, as it is said everywhere: the gravest first, the cure behind."""

from collections.abc import Iterable

from stair_inspector.content.cells import millimetres
from stair_inspector.content.cures import cure_words
from stair_inspector.content.document import Column, Status, Table, Tone, plain, table_of
from stair_inspector.model import Inspection, Observation

LEVELS = ("question", "doubt", "info")
"""The levels of an observation, the gravest first; each is the word for itself."""

_FLAG_MEANS = {"question": "answer it", "doubt": "measure again", "info": "if that is wrong, measure"}
_TONES: dict[str, Tone] = {"question": "bad", "doubt": "close", "info": "plain"}


def examined(inspection: Inspection) -> tuple[Observation, ...]:
    """Return what was found, questions first; those of one level as they were found."""
    return tuple(sorted(inspection.examination, key=lambda found: LEVELS.index(found.level)))


def examination_lines(inspection: Inspection) -> Iterable[str]:
    """Yield a line of plain text for each observation: its level as a word, what was found, the cure."""
    for found in examined(inspection):
        cure = f"; {_asked_for(found)}" if found.cure else ""
        yield plain(f"{found.level}: {found.message}{cure}").replace("\n", " ")


def examination_table(inspection: Inspection) -> Table:
    """Return what was found about the scan before it was measured, the gravest first."""
    return table_of(
        "examination",
        "Examination of the scan",
        examined(inspection),
        (Column("Kind"), lambda found: Status(found.level, _TONES[found.level])),
        (Column("What was found about the scan", width=4.0), lambda found: _sentence(found.message)),
        (Column("Size", "mm", 1), lambda found: millimetres(found.size_m)),
        (Column("What helps", width=3.0), lambda found: _sentence(_helps(found))),
        note=(
            "A question withholds every value until it is answered; a doubt concerns what may be wrong, or is in every "
            "U; an info changes nothing."
        ),
        tone=lambda found: _TONES[found.level],
    )


def _sentence(words: str) -> str:
    said = plain(words)
    return said[:1].upper() + said[1:]


def _asked_for(found: Observation) -> str:
    """Return a cure for someone at the command line: a flag alone is no sentence."""
    if not found.cure.startswith("--"):
        return found.cure
    return f"{_FLAG_MEANS[found.level]} with {found.cure}"


def _helps(found: Observation) -> str:
    """Return a cure in words; what an info names is the other way to take the scan, not what is advised."""
    is_other_way = found.level == "info" and found.cure.startswith("--")
    return f"if that is wrong: {cure_words(found)}" if is_other_way else cure_words(found)
