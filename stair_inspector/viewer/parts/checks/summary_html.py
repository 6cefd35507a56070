"""What a check comes to, what it was made with, and what is not in it, as HTML."""

import re
from collections.abc import Sequence

from stair_inspector.codes import DECISIONS, Check, RuleEdit, RuleSet
from stair_inspector.codes.phrases import limit_words
from stair_inspector.codes.rules import GRADES
from stair_inspector.content.remarks import on_page
from stair_inspector.content.verdicts import verdict_sentence
from stair_inspector.content.wording import verdict_of
from stair_inspector.viewer.bridge.markup import DIM, text
from stair_inspector.viewer.parts.checks.checks_html import STYLE, heading_html, said_html
from stair_inspector.viewer.scene.step_marks import tone_css

_ID_AND_HASH = re.compile(r" \([a-z0-9.-]+, SHA-256 [0-9a-f]{64}\)")
"""How the words on an overlay go on after its title: see :func:`stair_inspector.codes.overlaid`."""


def summary_html(check: Check | None, error: str, chosen: str = "") -> str:
    """Return what a check comes to and what it was made with; or why there is none.

    ``chosen`` is the title of the chosen rule set, which may wait for a result to be held against it.
    """
    if error:
        words = text(on_page(error))
        return f'<div data-testid="check-error" role="alert" style="{STYLE};color:{tone_css("bad")}">{words}</div>'
    if check is None and chosen:
        words = f"Chosen: {text(chosen)}. Nothing is measured yet; every result is held against it."
        return f'<div data-testid="check" data-set="" style="{STYLE};color:{DIM}">{words}</div>'
    if check is None:
        words = "No rule set is chosen. The measurement does not depend on it; choose one to hold the values against."
        return f'<div data-testid="check" data-set="" style="{STYLE};color:{DIM}">{words}</div>'
    rules, status = check.rule_set, verdict_of(check)
    lines = [
        f'<div style="font-size:13px">{said_html(status.tone, status.words)}</div>',
        f"<div>{text(verdict_sentence(check))}</div>",
        _notes(check.notes),
        f'<div style="color:{DIM};font-size:11px;padding-top:3px">{_origin(rules)}<br>'
        f"{text(DECISIONS[check.decision])}</div>",
    ]
    return (
        f'<div data-testid="check" data-set="{text(rules.set_id)}" class="si-results" style="{STYLE}">'
        f"{''.join(lines)}</div>"
    )


def not_assessed_html(check: Check | None) -> str:
    """Return what the rules limit and a scan does not show."""
    if check is None or not check.not_assessed:
        return '<div data-testid="not-assessed"></div>'
    items = "".join(f"<li>{text(sentence)}</li>" for sentence in check.not_assessed)
    return (
        f'<div data-testid="not-assessed" style="{STYLE}">{heading_html("Not assessed from a scan")}'
        f'<ul style="margin:0;padding-left:16px;color:{DIM}">{items}</ul></div>'
    )


def edits_html(edits: Sequence[RuleEdit]) -> str:
    """Return the limits that were changed, with before, after and reason."""
    if not edits:
        return (
            f'<div data-testid="check-edits" style="{STYLE};color:{DIM}">No limit was changed: all are as in the '
            "rule file.</div>"
        )
    items = "".join(
        f"<li>{text(edit.rule_id)}, {edit.side}: <s>{text(limit_words(edit.before))}</s> → "
        f"<b>{text(limit_words(edit.after))}</b> – {text(edit.reason)}</li>"
        for edit in edits
    )
    return f'<div data-testid="check-edits" style="{STYLE}"><ul style="margin:0;padding-left:16px">{items}</ul></div>'


def _notes(notes: Sequence[str]) -> str:
    """Return what a reader of the whole check must know."""
    if not notes:
        return ""
    items = "".join(f"<li>{text(on_page(note))}</li>" for note in notes)
    return f'<ul data-testid="check-notes" style="margin:2px 0;padding-left:16px;font-size:11px">{items}</ul>'


def _origin(rules: RuleSet) -> str:
    grades = "; ".join(f"{grade}: {GRADES[grade]}" for grade in rules.grades)
    edited = rules.edited_words + (f", {len(rules.edits)} below" if rules.is_edited else "")
    # Of a user's own file the words say that it is one.
    edited = f"edited by the user: {edited}" if rules.is_shipped else edited
    parts = [
        f'<span title="SHA-256 {text(rules.sha256)}">{text(rules.file or "no file")}, '
        f"SHA-256 {text(rules.sha256[:12])}…</span>",
        *(f"overlay {text(_without_hash(words))}" for words in rules.overlays),
        text(edited),
        f'<span title="{text(grades)}">source graded {text(", ".join(rules.grades))}</span>',
    ]
    return " · ".join(parts)


def _without_hash(overlay: str) -> str:
    """Return the words on an overlay without its id and hash, which take a whole line."""
    return _ID_AND_HASH.sub("", overlay)
