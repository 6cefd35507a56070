"""Which steps have a value outside a limit: marked by a sign, in words and by a colour, in the tables and the scene."""

from dataclasses import dataclass
from statistics import median

from stair_inspector.codes import Check, Finding, Verdict, gravest
from stair_inspector.codes.quantities import step_value
from stair_inspector.codes.text import value_text
from stair_inspector.files.palettes import Rgb
from stair_inspector.model import Inspection
from stair_inspector.report.document import SIGNS, Tone
from stair_inspector.report.rule_tables import TONES
from stair_inspector.viewer.markup import DIM, text

TONE_RGB: dict[Tone, Rgb] = {"good": (47, 158, 68), "close": (232, 89, 12), "bad": (224, 49, 49)}
"""Colours that read well on the light and on the dark theme; each has a sign beside it."""
MARKED: dict[Tone, str] = {
    "bad": f"{SIGNS['bad']} outside a limit",
    "close": f"{SIGNS['close']} outside by less than U",
}
"""What the marks mean, for legends."""
_TIE_M = 1e-6
"""Two steps that are as far from the median but for this are as odd."""


@dataclass(frozen=True, slots=True)
class StepMark:
    """How one step is marked: ``words`` say which values are outside which limits."""

    tone: Tone
    words: str

    @property
    def sign(self) -> str:
        """The sign that stands beside the step's number."""
        return SIGNS[self.tone]


def marks_of(inspection: Inspection | None, check: Check | None) -> dict[int, StepMark]:
    """Return a mark for every step that has a value outside a limit; advice does not count.

    Of two steps whose difference is too large, that which is farther from the flight's median is marked: it is the odd
    one. Where both are as far, both are.
    """
    if inspection is None or check is None:
        return {}
    found: dict[int, list[Finding]] = {}
    for outside in check.findings:
        if outside.rule.severity == "limit" and outside.verdict.is_outside:
            for step_id in _odd_ones(inspection, outside):
                found.setdefault(step_id, []).append(outside)
    return {
        step_id: StepMark(tone_of(gravest(tuple(own)).verdict), "; ".join(map(_words_of, own)))
        for step_id, own in sorted(found.items())
    }


def tone_of(verdict: Verdict) -> Tone:
    """Return the tone of a verdict; plain for one that says nothing of a limit."""
    return TONES.get(verdict, "plain")


def tone_css(tone: Tone) -> str:
    """Return a tone's colour for a style."""
    return f"rgb{TONE_RGB[tone]}" if tone in TONE_RGB else DIM


def mark_html(mark: StepMark | None) -> str:
    """Return the sign of a mark with its words as a title; nothing for no mark."""
    if mark is None:
        return ""
    return (
        f' <b data-testid="mark" role="img" aria-label="{text(mark.words)}" title="{text(mark.words)}" '
        f'style="color:{tone_css(mark.tone)}">{mark.sign}</b>'
    )


def _odd_ones(inspection: Inspection, found: Finding) -> tuple[int, ...]:
    if found.rule.statistic == "each" or len(found.steps) < 2:
        return found.steps
    values = {
        step.step_id: value.value
        for step in inspection.steps
        if step.flight == found.flight and (value := step_value(step, found.rule.quantity)) is not None
    }
    away = {step_id: abs(values[step_id] - median(values.values())) for step_id in found.steps if step_id in values}
    return tuple(step_id for step_id, far in away.items() if far >= max(away.values()) - _TIE_M)


def _words_of(found: Finding) -> str:
    limit = "" if found.limit is None else f" (limit {found.limit.text}, {found.rule.clause})"
    return f"{found.rule.term} {value_text(found)}, {found.verdict.words}{limit}"
