"""The list of findings in reports: a table with a row for each, and the photographs of pins."""

from datetime import datetime
from typing import Any

from stair_inspector.content.document import Block, Column, Figure, Status, Table, Tone, table_of
from stair_inspector.content.finding_list import ListedFinding
from stair_inspector.content.pins import PinSeverity

SEVERITY_TONES: dict[PinSeverity, Tone] = {"info": "plain", "minor": "close", "major": "bad", "critical": "bad"}


def finding_blocks(findings: tuple[ListedFinding, ...]) -> list[Block]:
    """Return the table of findings and behind it, small, the photographs of pins; nothing without a finding."""
    if not findings:
        return []
    photos = [
        Figure(
            f"pin_photo_{entry.number}",
            f"Finding {entry.number}, {entry.where}",
            f"photograph of finding {entry.number}: {entry.text}",
            "jpeg",
            entry.photo.data,
            0.25,
        )
        for entry in findings
        if entry.photo is not None
    ]
    return [listed_table(findings), *photos]


def listed_table(findings: tuple[ListedFinding, ...]) -> Table:
    """Return a row for each finding."""
    return table_of(
        "list_of_findings",
        "Findings",
        findings,
        (Column("No.", digits=0), lambda each: each.number),
        (Column("Kind"), lambda each: each.kind),
        (Column("Where"), lambda each: each.where),
        (Column("What was found", width=5.0), lambda each: _words_of(each)),
        (Column("Severity"), lambda each: Status(each.severity, SEVERITY_TONES[each.severity])),
        (Column("State"), lambda each: each.state),
        (Column("By"), _by_of),
        (Column("When"), lambda each: moment_words(each.when)),
        note=(
            "Pins of the inspector come first, then what the program found. Severity: a value outside its limit is "
            "major, one outside by less than U, advice and what nothing is said of are minor, until the inspector says "
            "otherwise; critical is the inspector's word alone."
        ),
    )


def moment_words(moment: str) -> str:
    """Return a time of ISO 8601 as a reader wants it, to the minute; empty for none."""
    return f"{datetime.fromisoformat(moment):%Y-%m-%d %H:%M}" if moment else ""


def listed_record(entry: ListedFinding) -> dict[str, Any]:
    """Return a finding as plain values of the inspection's JSON; of a photograph it says whether there is one."""
    return {
        "number": entry.number,
        "key": entry.key,
        "kind": entry.kind,
        "where": entry.where,
        "steps": list(entry.steps),
        "place_m": None if entry.place_m is None else list(entry.place_m),
        "text": entry.text,
        "severity": entry.severity,
        "state": entry.state,
        "remark": entry.remark,
        "who": entry.who,
        "when": entry.when or None,
        "has_photo": entry.photo is not None,
    }


def _by_of(entry: ListedFinding) -> str:
    """Return who found it, or said something of it: the inspector where no name was given."""
    return entry.who or ("inspector" if entry.is_pin or entry.remark or entry.when else "program")


def _words_of(entry: ListedFinding) -> str:
    return f"{entry.text}\nRemark: {entry.remark}" if entry.remark else entry.text
