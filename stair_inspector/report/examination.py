"""What was found about a scan before it was measured, as it is said everywhere: the gravest first, the cure behind."""

from collections.abc import Iterable

from stair_inspector.model import Inspection, Observation
from stair_inspector.report.document import plain

LEVELS = ("question", "doubt", "info")
"""The levels of an observation, the gravest first; each is the word for itself."""


def examined(inspection: Inspection) -> tuple[Observation, ...]:
    """Return what was found, questions first; those of one level as they were found."""
    return tuple(sorted(inspection.examination, key=lambda found: LEVELS.index(found.level)))


def examination_lines(inspection: Inspection) -> Iterable[str]:
    """Yield a line of plain text for each observation: its level as a word, what was found, the cure."""
    for found in examined(inspection):
        cure = f"; {_asked_for(found)}" if found.cure else ""
        yield plain(f"{found.level}: {found.message}{cure}").replace("\n", " ")


def _asked_for(found: Observation) -> str:
    """Return a cure for someone at the command line: a flag alone is no sentence."""
    if not found.cure.startswith("--"):
        return found.cure
    return f"{'answer it' if found.level == 'question' else 'measure again'} with {found.cure}"
