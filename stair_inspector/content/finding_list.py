"""The one list of findings: pins, values outside a limit, limits that nothing was said of, doubts, and what is gone."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from stair_inspector.codes.at_steps import findings_at_steps
from stair_inspector.codes.findings import Check, Finding, Verdict
from stair_inspector.codes.phrases import limits_text, place_text, value_text
from stair_inspector.codes.rules import Rule
from stair_inspector.content.document import plain
from stair_inspector.content.images import Photo
from stair_inspector.content.note_words import note_words
from stair_inspector.content.pins import FindingDecision, Pin, PinnedFindings, PinSeverity
from stair_inspector.content.remarks import needs_look
from stair_inspector.content.step_places import step_at
from stair_inspector.geometry.arrays import Point
from stair_inspector.model import Inspection

FindingKind = Literal["pin", "limit", "not judged", "examination", "note", "gone"]
KIND_WORDS: dict[FindingKind, str] = {
    "pin": "pin of the inspector",
    "limit": "outside a limit",
    "not judged": "nothing said of a limit",
    "examination": "examination of the scan",
    "note": "note of the measurement",
    "gone": "no longer found",
}
_OF_VERDICT: dict[Verdict, PinSeverity] = {Verdict.OUTSIDE: "major", Verdict.OUTSIDE_CLOSE: "minor"}
_MOST_STEPS_NAMED = 4
_NOWHERE: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class ListedFinding:
    """One row of the list.

    ``key`` is the same in every run: the identity of a pin; else rule, examination or note with its place. ``number``
    counts from 1 and is that of the mark in the scene. ``steps`` are those of the present result. ``place_m`` is a
    pin's place in the scan's own frame, metres. ``remark`` is the inspector's on a finding of the program.
    """

    key: str
    kind: FindingKind
    where: str
    text: str
    severity: PinSeverity
    number: int = 0
    steps: tuple[int, ...] = ()
    place_m: Point | None = None
    is_done: bool = False
    remark: str = ""
    photo: Photo | None = None
    who: str = ""
    when: str = ""

    @property
    def is_pin(self) -> bool:
        """Whether the inspector set it."""
        return self.kind == "pin"

    @property
    def state(self) -> str:
        """``done`` or ``open``."""
        return "done" if self.is_done else "open"


def list_findings(
    inspection: Inspection | None, check: Check | None, pinned: PinnedFindings
) -> tuple[ListedFinding, ...]:
    """Return every finding, numbered: pins as they were set, then those of the program, then what is gone.

    Parameters
    ----------
    inspection : Inspection, optional
        Without a result there are pins alone.
    check : Check, optional
        The same inspection held against a rule set.
    pinned : PinnedFindings
        Pins, and what the inspector said of findings of the program.
    """
    found = [_of_pin(pin, inspection) for pin in pinned.pins]
    if inspection is not None:
        said = {decision.key: decision for decision in pinned.decisions}
        program = list(_keyed((*_of_check(inspection, check), *_of_examination(inspection), *_of_notes(inspection))))
        found += [_decided(entry, said.get(entry.key)) for entry in program]
        present = {entry.key for entry in program}
        found += [_gone(each) for each in pinned.decisions if each.key not in present and each.remark]
    return tuple(replace(entry, number=number) for number, entry in enumerate(found, 1))


def steps_marked(findings: Iterable[ListedFinding]) -> dict[int, tuple[int, ...]]:
    """Return the numbers of the open findings at each step; a pin on a point has its own mark."""
    numbers: dict[int, tuple[int, ...]] = {}
    for entry in findings:
        if not entry.is_done and not (entry.is_pin and not entry.steps):
            for step_id in entry.steps:
                numbers[step_id] = (*numbers.get(step_id, ()), entry.number)
    return numbers


def _of_pin(pin: Pin, inspection: Inspection | None) -> ListedFinding:
    where, steps = "point", _NOWHERE
    if pin.step is not None:
        step = step_at(inspection, pin.step, pin.place_m) if inspection is not None else None
        where = f"step {pin.step}" if inspection is None else f"former step {pin.step}"
        if step is not None:
            where, steps = f"step {step.step_id}", (step.step_id,)
    return ListedFinding(
        pin.guid,
        "pin",
        where,
        plain(pin.text),
        pin.severity,
        steps=steps,
        place_m=pin.place_m,
        is_done=pin.is_done,
        photo=pin.photo,
        who=plain(pin.who),
        when=pin.made_at,
    )


def _of_check(inspection: Inspection, check: Check | None) -> Iterator[ListedFinding]:
    """Return values outside a limit one by one, and what nothing is said of once for each rule and flight."""
    if check is None:
        return
    told = findings_at_steps(inspection, check)
    open_ones: dict[tuple[str, int | None], list[Finding]] = {}
    for found in check.findings:
        if found.rule.severity == "report_only" and not found.is_reported_beyond:
            continue
        if found.verdict.is_outside or found.is_reported_beyond:
            # Of steps that differ too much, the odd one, as it is marked everywhere.
            steps = tuple(step_id for step_id, own in told.items() if any(each is found for each in own))
            yield _outside(check, found, steps)
        elif found.is_open and found.rule.from_scan != "no":
            open_ones.setdefault((found.rule.rule_id, found.flight), []).append(found)
    for (_, flight), several in open_ones.items():
        yield _not_judged(check, flight, several)


def _outside(check: Check, found: Finding, steps: tuple[int, ...]) -> ListedFinding:
    rule = found.rule
    severity: PinSeverity = "info" if found.is_reported_beyond else _OF_VERDICT[found.verdict]
    if rule.severity == "advisory":
        severity = "minor"
    said = "beyond the number of its clause" if found.is_reported_beyond else found.verdict.words
    text = f"{rule.term} {value_text(found)}: {said} ({limits_text(check.rule_set, rule)}, {rule.clause})"
    where = place_text(found)
    # The odd ones of a flight's range may be others after the next run: it is one finding of the flight.
    at = f"/{where}" if rule.statistic in ("each", "adjacent_difference") else ""
    key = f"{_key_of(check, rule, found.flight)}{at}"
    return ListedFinding(key, "limit", where, plain(text), severity, steps=steps)


def _not_judged(check: Check, flight: int | None, several: list[Finding]) -> ListedFinding:
    rule = several[0].rule
    steps = tuple(dict.fromkeys(step for found in several for step in found.steps))
    where = "scan" if flight is None else f"flight {flight}"
    if steps:
        named = ", ".join(str(step) for step in steps[:_MOST_STEPS_NAMED])
        more = f" and {len(steps) - _MOST_STEPS_NAMED} more" if len(steps) > _MOST_STEPS_NAMED else ""
        where = f"step{'s' if len(steps) > 1 else ''} {named}{more}"
    reasons = list(dict.fromkeys(note_words(found.reason) for found in several if found.reason))
    said = several[0].verdict.words if len({found.verdict for found in several}) == 1 else "not measured or not judged"
    text = f"{rule.term}: {said} ({rule.clause})" + (f": {reasons[0]}" if reasons else "")
    key = f"{_key_of(check, rule, flight)}/not judged"
    return ListedFinding(key, "not judged", where, plain(text), "minor", steps=steps)


def _key_of(check: Check, rule: Rule, flight: int | None) -> str:
    """Return the key of a rule in a flight: what was said of a limit of one code is not said of another's."""
    return f"rule/{check.rule_set.set_id}/{rule.rule_id}/{'scan' if flight is None else f'flight {flight}'}"


def _of_examination(inspection: Inspection) -> Iterator[ListedFinding]:
    """Return questions and doubts; an info changes nothing."""
    for found in inspection.examination:
        if found.level != "info":
            severity: PinSeverity = "major" if found.level == "question" else "minor"
            text = f"{found.level}: {note_words(found.message)}"
            yield ListedFinding(f"examination/{found.code}", "examination", "scan", text, severity)


def _of_notes(inspection: Inspection) -> Iterator[ListedFinding]:
    """Return the notes that may mean that a value is wrong or missing; what the examination says stands there."""
    known = {step.step_id for step in inspection.steps}
    examined = {found.code for found in inspection.examination}
    for note in inspection.notes:
        if needs_look(note) and note.code not in examined:
            where = "scan" if note.step is None else f"step {note.step}"
            steps = (note.step,) if note.step in known and note.step is not None else ()
            key = f"note/{note.code}/{where}"
            yield ListedFinding(key, "note", where, note_words(note.message), "minor", steps=steps)


def _keyed(found: Iterable[ListedFinding]) -> Iterator[ListedFinding]:
    """Return findings whose keys differ: a second one of the same kind and place has a number behind it."""
    times: dict[str, int] = {}
    for entry in found:
        times[entry.key] = times.get(entry.key, 0) + 1
        key = plain(entry.key)
        yield replace(entry, key=key if times[entry.key] == 1 else f"{key} #{times[entry.key]}")


def _decided(entry: ListedFinding, decision: FindingDecision | None) -> ListedFinding:
    if decision is None:
        return entry
    return replace(
        entry,
        severity=decision.severity or entry.severity,
        is_done=decision.is_done,
        remark=plain(decision.remark),
        who=plain(decision.who),
        when=decision.decided_at,
    )


def _gone(decision: FindingDecision) -> ListedFinding:
    said = f"no longer found with these settings and rules; it was: {decision.text}" if decision.text else "is gone"
    entry = ListedFinding(decision.key, "gone", plain(decision.where) or "scan", plain(said), "info")
    return _decided(entry, decision)
