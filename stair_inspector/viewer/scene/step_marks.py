"""Which steps have a value outside a limit: marked by a sign, in words and by a colour, in the tables and the scene."""

from dataclasses import dataclass

from stair_inspector.codes import Check, Finding, Verdict, gravest
from stair_inspector.codes.at_steps import outside_at_steps
from stair_inspector.codes.phrases import value_text
from stair_inspector.content.document import SIGNS, Tone
from stair_inspector.content.rule_tables import TONES
from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.model import Inspection
from stair_inspector.viewer.bridge.markup import DIM, text

TONE_CSS: dict[Tone, str] = {
    "good": "light-dark(#237032, #51cf66)",
    "close": "light-dark(#b03a07, #ff922b)",
    "bad": "light-dark(#c92a2a, #ff8787)",
}
"""Colours of words, on the light and on the dark theme: of small letters at least 4.5 times as bright or as dark."""
MARKED: dict[Tone, str] = {
    "bad": f"{SIGNS['bad']} outside a limit",
    "close": f"{SIGNS['close']} outside by less than U",
}
"""What the marks mean, for legends."""


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
    """Return a mark for every step that has a value outside a limit; advice does not count."""
    if inspection is None or check is None:
        return {}
    return {
        step_id: StepMark(tone_of(gravest(own).verdict), "; ".join(_words_of(check, found) for found in own))
        for step_id, own in outside_at_steps(inspection, check).items()
    }


def tone_of(verdict: Verdict) -> Tone:
    """Return the tone of a verdict; plain for one that says nothing of a limit."""
    return TONES.get(verdict, "plain")


def mark_color(tone: Tone, palette: Palette) -> Rgb:
    """Return the colour of a mark in the scene; each has a sign beside it."""
    return palette.outside if tone == "bad" else palette.nearly


def tone_css(tone: Tone) -> str:
    """Return a tone's colour for a style."""
    return TONE_CSS.get(tone, DIM)


def mark_html(mark: StepMark | None) -> str:
    """Return the sign of a mark with its words as a title; nothing for no mark."""
    if mark is None:
        return ""
    return (
        f' <b data-testid="mark" role="img" aria-label="{text(mark.words)}" title="{text(mark.words)}" '
        f'style="color:{tone_css(mark.tone)}">{mark.sign}</b>'
    )


def _words_of(check: Check, found: Finding) -> str:
    limit = ""
    if found.limit is not None:
        own = ", changed by the user" if check.edit_behind(found) is not None else ""
        limit = f" (limit {found.limit.text}{own}, {found.rule.clause})"
    return f"{found.rule.term} {value_text(found)}, {found.verdict.words}{limit}"
