"""The Checks tab's results as HTML: what a check comes to, by rule, by step, and what was not assessed.

A verdict is written in words with a sign; colour is never the only sign. Texts come from rule files and are escaped.
"""

from collections.abc import Sequence

from stair_inspector.codes import Check, Finding, Fit, Rule, Verdict, gravest, notation_of
from stair_inspector.codes.at_steps import findings_at_steps
from stair_inspector.codes.phrases import gap_text, value_text
from stair_inspector.content.cells import numbers_of
from stair_inspector.content.document import SIGNS, Tone
from stair_inspector.content.remarks import on_page
from stair_inspector.content.rule_tables import limited_words
from stair_inspector.model import Inspection, Measured
from stair_inspector.units import M_PER_INCH, Unit, length_text, measured_text, tidy, uncertainty_text
from stair_inspector.viewer.bridge.markup import CHOSEN, DIM, LINE, button_in_row, pick_script, row_attributes, text
from stair_inspector.viewer.scene.step_marks import mark_html, marks_of, tone_css, tone_of

RULE = "rule"
"""Word before a rule's number, from 1."""
_FIT_TONES: dict[bool | None, Tone] = {True: "good", False: "close", None: "plain"}
_EDITED = f' <b data-testid="edited" style="color:{tone_css("close")}">✎ edited</b>'
_CELL = "padding:5px 4px;vertical-align:top"
STYLE = "font-size:12px;line-height:1.35;padding:2px 12px 6px 9px;overflow-wrap:anywhere"


def rules_html(check: Check | None, opened: int | None, pick_uuid: str, unit: Unit = "mm") -> str:
    """Return a row for each rule: verdict, limit, the value that decides, and whether the scan is fit for it.

    Parameters
    ----------
    check : Check, optional
        None is an empty list.
    opened : int, optional
        Number, from 1, of the rule whose findings are all listed.
    pick_uuid : str
        Identity of the control that a click on a row or a step writes to.
    unit : {"mm", "in"}
        Of the measured lengths; limits are written as their code has them.
    """
    if check is None:
        return '<div data-testid="check-rules"></div>'
    # By rule in one go: a set may have a thousand rules, and a stair sixty steps.
    by_rule: dict[str, list[Finding]] = {rule.rule_id: [] for rule in check.rule_set.rules}
    for found in check.findings:
        by_rule[found.rule.rule_id].append(found)
    shared = _shared_reason(check)
    rows = "".join(
        _rule_rows(check, number, fit, tuple(found), pick_uuid, unit, is_open=number == opened, is_told=bool(shared))
        for number, (fit, found) in enumerate(zip(check.fits, by_rule.values(), strict=True), 1)
    )
    return (
        f'<div data-testid="check-rules" class="si-results" style="{STYLE};font-variant-numeric:tabular-nums">'
        f'{heading_html("Results by rule")}{shared}<table style="border-collapse:collapse;width:100%">'
        f"<tbody>{rows}</tbody></table></div>"
    )


def steps_html(
    inspection: Inspection | None, check: Check | None, selected: int | None, pick_uuid: str, unit: Unit = "mm"
) -> str:
    """Return a row for each step of which there is something to tell, and the numbers of the others.

    A step that is marked here is marked in the other tables and in the scene: see :func:`step_marks.marks_of`.
    """
    if inspection is None or check is None or not inspection.steps:
        return '<div data-testid="check-steps"></div>'
    rows, quiet = [], []
    marks = marks_of(inspection, check)
    for step_id, findings in findings_at_steps(inspection, check).items():
        told = tuple(found for found in findings if found.verdict.is_listed)
        if told:
            mark = mark_html(marks.get(step_id))
            rows.append(_step_row(check, step_id, mark, told, step_id == selected, pick_uuid, unit))
        elif any(found.verdict is Verdict.WITHIN for found in findings):
            quiet.append(step_id)
    rest = ""
    if quiet:
        words = f"{'Step' if len(quiet) == 1 else 'Steps'} {numbers_of(tuple(quiet))}: "
        rest = f'<div data-testid="check-within" style="padding:4px">{text(words)}{said_html("good", "within")}</div>'
    if not rows and not quiet:
        rest = f'<div style="color:{DIM};padding:4px">No value of a single step was judged.</div>'
    return (
        f'<div data-testid="check-steps" class="si-results" style="{STYLE};font-variant-numeric:tabular-nums">'
        f'{heading_html("Results by step")}<table style="border-collapse:collapse;width:100%">'
        f"<tbody>{''.join(rows)}</tbody></table>{rest}</div>"
    )


def heading_html(words: str) -> str:
    """Return the heading of a list."""
    return f'<div style="font-weight:600;border-bottom:1px solid {LINE};padding:2px 0">{words}</div>'


def said_html(tone: Tone, words: str) -> str:
    """Return a judgement in words, with the sign and the colour of its tone."""
    return (
        f'<b style="color:{tone_css(tone)}"><span aria-hidden="true" style="display:inline-block;min-width:1.1em">'
        f"{SIGNS[tone]}</span>{text(words)}</b>"
    )


def _rule_rows(
    check: Check,
    number: int,
    fit: Fit,
    findings: tuple[Finding, ...],
    pick_uuid: str,
    unit: Unit,
    *,
    is_open: bool,
    is_told: bool,
) -> str:
    worst = gravest(findings)
    rule = worst.rule
    mark = _EDITED if check.rule_set.is_changed(rule.rule_id) else ""
    kind = {"advisory": "advice, no limit", "report_only": "reported only"}.get(rule.severity, "")
    if not kind and check.rule_set.is_reported_in_file(rule.rule_id):
        kind = "reported only in the file, judged against the user's limit"
    kind = f' <span style="color:{DIM}">({kind})</span>' if kind else ""
    is_said = rule.applies in worst.reason
    applies = "" if not rule.applies or is_said else f'<div style="color:{DIM}">for {text(rule.applies)}</div>'
    hint = f' title="{text(rule.note)}"' if rule.note else ""
    click = row_attributes(pick_script(pick_uuid, number, RULE), has_buttons=True)
    # Opened, all values are listed below.
    value = "" if is_open else f"<div>{_value_html(worst, pick_uuid, unit)}</div>"
    found = f"{value}{_fit_html(rule, fit, unit)}"
    return (
        f'<tr data-testid="rule-row" data-rule="{text(rule.rule_id)}" data-verdict="{worst.verdict.value}" '
        f'aria-expanded="{"true" if is_open else "false"}" '
        f'style="border-bottom:1px solid {LINE};cursor:pointer"{click}>'
        f'<td style="{_CELL};width:96px">{_verdict_html(worst, findings)}</td>'
        f'<td style="{_CELL}"{hint}><b>{text(limited_words(rule))}</b>{kind}{mark} '
        f'<span style="color:{DIM};font-size:11px">{text(rule.clause)}</span>'
        f"<div>{text(_limits(rule, unit))}</div>{applies}"
        f"{'' if is_told and worst.is_open else found}"
        f"{_findings_html(findings, pick_uuid, unit) if is_open else ''}</td></tr>"
    )


def _shared_reason(check: Check) -> str:
    """Return the one reason why nothing of the whole scan was judged; empty where every rule has its own."""
    reasons = {found.reason for found in check.findings if found.is_open and found.flight is None}
    if len(reasons) != 1:
        return ""
    (reason,) = reasons
    return f'<div data-testid="shared-reason" style="padding:4px">{text(on_page(reason))}</div>'


def _verdict_html(worst: Finding, findings: Sequence[Finding]) -> str:
    said = said_html(tone_of(worst.verdict), worst.verdict.words)
    if len(findings) < 2:
        return said
    alike = sum(found.verdict is worst.verdict for found in findings)
    count = f"all {alike}" if alike == len(findings) else f"{alike} of {len(findings)}"
    n_close = sum(found.verdict is Verdict.OUTSIDE_CLOSE for found in findings)
    if worst.verdict is Verdict.OUTSIDE and n_close:
        count += f", and {n_close} outside by less than U"
    return f'{said}<div style="color:{DIM};font-size:11px;padding-left:1.2em">{count}</div>'


def _value_html(found: Finding, pick_uuid: str, unit: Unit) -> str:
    """Return the value with its uncertainty, its distance from the limit, and its place; or why there is none."""
    place = _place_html(found, pick_uuid)
    reason = f'<span style="color:{DIM}">{text(on_page(found.reason))}</span>' if found.reason else ""
    if found.value is None:
        # Of the scan as a whole the reason says all.
        return reason if found.flight is None and reason else ": ".join(part for part in (place, reason) if part)
    margin = _margin(found, unit)
    said = f'<b style="white-space:nowrap">{text(_value(found, unit))}</b> at {place}'
    if margin:
        said += f', <span style="white-space:nowrap">{text(margin)}</span>'
    return "; ".join(part for part in (said, reason) if part)


def _margin(found: Finding, unit: Unit) -> str:
    """Return how far a value is inside or outside its limit; empty where it was not held against it."""
    if found.margin is None or not (found.verdict.is_outside or found.verdict.is_within):
        return ""
    words = "outside by" if found.verdict.is_outside else "inside by"
    return f"{words} {_length(found.rule, abs(found.margin), unit)}"


def _limits(rule: Rule, unit: Unit) -> str:
    """Return the limits as their code writes them; where inches are read, metric ones with their size in inches."""
    limits = [limit for limit in (rule.minimum, rule.maximum) if limit is not None]
    if not _is_in_inches(rule, unit) or all(limit.unit in ("in", "ft") for limit in limits):
        return rule.limit_text
    sizes = (f"{tidy(limit.value / M_PER_INCH, 3):.3f}".rstrip("0").rstrip(".") for limit in limits)
    return f"{rule.limit_text} ({' to '.join(sizes)} in)"


def _value(found: Finding, unit: Unit) -> str:
    if found.value is None or not _is_in_inches(found.rule, unit):
        return value_text(found)
    if not found.u:
        return length_text(found.value, unit)
    return measured_text(Measured(found.value, found.u), unit)


def _length(rule: Rule, value: float, unit: Unit) -> str:
    """Return a distance from a limit; one that rounds to nothing is not shown as nothing."""
    if _is_in_inches(rule, unit):
        return f"{uncertainty_text(value, unit)} in"
    return gap_text(rule, value)


def _is_in_inches(rule: Rule, unit: Unit) -> bool:
    return unit == "in" and notation_of(rule.quantity).unit == "mm"


def _place_html(found: Finding, pick_uuid: str) -> str:
    """Return where a finding is; a click on a step's number chooses the step."""
    if not found.steps:
        return "the scan" if found.flight is None else f"flight {found.flight}"
    word = "step" if len(found.steps) == 1 else "steps"
    return f"{word} " + " and ".join(_step_button(step, pick_uuid) for step in found.steps)


def _step_button(step: int, pick_uuid: str) -> str:
    return (
        f'<button type="button" data-testid="finding-step" data-of="{step}" title="choose step {step}" '
        f'{button_in_row(pick_script(pick_uuid, step))} style="border:0;background:none;padding:0;cursor:pointer;'
        f'color:inherit;font:inherit;text-decoration:underline dotted">{step}</button>'
    )


def _fit_html(rule: Rule, fit: Fit, unit: Unit) -> str:
    tone = _FIT_TONES[fit.is_fit]
    words = fit.said(lambda size: _length(rule, size, unit)) if _is_in_inches(rule, unit) else fit.words
    words = words[:1].upper() + words[1:]
    color = tone_css(tone) if fit.is_fit is False else DIM
    return (
        f'<div data-testid="fit" data-fit="{fit.is_fit}" style="color:{color};font-size:11px">'
        f'<span aria-hidden="true">{SIGNS[tone]}</span> {text(words)}</div>'
    )


def _findings_html(findings: Sequence[Finding], pick_uuid: str, unit: Unit) -> str:
    items = "".join(
        f'<li data-testid="finding" data-verdict="{found.verdict.value}" style="padding:1px 0">'
        f"{said_html(tone_of(found.verdict), found.verdict.words)}: {_value_html(found, pick_uuid, unit)}</li>"
        for found in findings
    )
    return (
        f'<ul data-testid="findings" style="list-style:none;margin:4px 0 0;padding:4px 0 0 6px;'
        f'border-left:2px solid {LINE}">{items}</ul>'
    )


def _step_row(
    check: Check,
    step_id: int,
    mark: str,
    told: tuple[Finding, ...],
    is_selected: bool,
    pick_uuid: str,
    unit: Unit,
) -> str:
    worst = gravest(told)
    items = "".join(_step_finding(check, step_id, found, unit) for found in told)
    click = row_attributes(pick_script(pick_uuid, step_id))
    style = f"border-bottom:1px solid {LINE};cursor:pointer;" + (f"background:{CHOSEN}" if is_selected else "")
    return (
        f'<tr data-testid="check-step-row" data-of="{step_id}" data-verdict="{worst.verdict.value}" '
        f'aria-selected="{"true" if is_selected else "false"}" style="{style}"{click}>'
        f'<td style="{_CELL};width:58px;white-space:nowrap">step {step_id}{mark}</td>'
        f'<td style="{_CELL}">{items}</td></tr>'
    )


def _step_finding(check: Check, step_id: int, found: Finding, unit: Unit) -> str:
    """Return what a finding says of one step, with the limit and the distance from it."""
    said = said_html(tone_of(found.verdict), found.verdict.words)
    if found.rule.severity == "advisory":
        said += f' <span style="color:{DIM}">(advice, no limit)</span>'
    if found.value is None:
        return f"<div>{said}: {text(found.rule.term)}: {text(on_page(found.reason))}{_others(found, step_id)}</div>"
    limit = ""
    if found.limit is not None:
        parts = [
            f"{'at least' if found.side == 'minimum' else 'at most'} {found.limit.as_written}",
            _margin(found, unit),
        ]
        edited = _EDITED if check.edit_behind(found) is not None else ""
        limit = f'<div style="color:{DIM};padding-left:1.1em">{text(", ".join(filter(None, parts)))}{edited}</div>'
    value = f'<b style="white-space:nowrap">{text(_value(found, unit))}</b>'
    return f"<div>{said}: {text(found.rule.term)} {value}{_others(found, step_id)}{limit}</div>"


def _others(found: Finding, step_id: int) -> str:
    others = [other for other in found.steps if other != step_id]
    return f' <span style="color:{DIM}">(with step {others[0]})</span>' if others else ""
