"""The short report: what the full one says first, and what it rests on; one page of result and about two of evidence.

It is chosen from the blocks of the full report, so both say the same. Forms that nobody has filled take no room in it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal

from stair_inspector.codes.findings import Verdict
from stair_inspector.content.change_blocks import CHANGES
from stair_inspector.content.document import (
    Block,
    Bullets,
    Cell,
    Document,
    Facts,
    Figure,
    Paragraph,
    Section,
    Signatures,
    Status,
    Table,
)

ReportLength = Literal["short", "full"]
LENGTHS: tuple[ReportLength, ...] = ("short", "full")
_SUMMARY, _LIMITATIONS, _SIGN_OFF = "Summary", "Limitations and what was not assessed", "Sign-off"
_LEFT_OUT = ("At steps", "Findings", "Margin")
"""Columns of the results by rule."""
_FLIGHT = "Flight"
_NOT_HELD = frozenset(verdict.words for verdict in (Verdict.REPORTED, Verdict.NOT_ASSESSED))
"""What is said of rules against which no value is held: reported with the steps, or listed as not assessed."""
_EVIDENCE: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("Dimensions of the steps", ("flights", "steps", "rise_", "going_")),
    ("What is not plainly within", ("findings",)),
    ("Pins of the inspector", ("list_of_findings", "pin_photo_")),
    ("Readings by hand", ("readings", "photo_")),
    ("The scan and the rules", ("fits", "scan", "rule_set", "instrument")),
)
"""The titles of the other sections, with the keys of their blocks; those that end in ``_`` are beginnings of keys."""
_FULL = "The full report holds the views, drawings, uncertainty budget, closure, settings and every note."


def shortened(document: Document) -> Document:
    """Return the short report of a full one."""
    by_title = {section.title: section.blocks for section in document.sections}
    summary = by_title.get(_SUMMARY, ())
    remarks = [block for block in summary if isinstance(block, Paragraph)]
    sections: list[tuple[str, list[Block]]] = []
    for title, keys in _EVIDENCE:
        found = [block for block in document.blocks() if _is_one_of(block, keys)]
        sections.append((title, [filled for block in found for filled in _filled(block)]))
    # After the dimensions: who chose a second scan asks for it.
    sections.insert(1, (CHANGES, list(by_title.get(CHANGES, ()))))
    # How values were decided on stands with what the decision does not hold.
    sections.append(
        (_LIMITATIONS, [*remarks, *_said_shortly(by_title.get(_LIMITATIONS, ())), Paragraph(_FULL, "remark")])
    )
    sections.append((_SIGN_OFF, [each for block in by_title.get(_SIGN_OFF, ()) for each in _filled(block)]))
    numbered = enumerate((each for each in sections if each[1]), 1)
    return replace(
        document,
        # On the first page the pictures take what is left beneath the results.
        front=(
            *(each for each in document.front if not isinstance(each, Figure)),
            *_results(summary),
            *_figures(document.front),
        ),
        sections=tuple(
            Section(str(number), title, tuple(blocks), starts_page=number == 1 or title == CHANGES)
            for number, (title, blocks) in numbered
        ),
    )


def _figures(blocks: Iterable[Block]) -> list[Figure]:
    return [block for block in blocks if isinstance(block, Figure)]


def _results(blocks: Sequence[Block]) -> list[Block]:
    """Return the results of all rules against which values are held; without a check, what the full report has."""
    rules = [block for block in blocks if isinstance(block, Table) and block.key == "rules"]
    if not rules:
        return list(blocks)
    # What is outside stands in the sentence at the head and in the table.
    return [_narrowed(table) for table in rules]


def _narrowed(table: Table) -> Table:
    """Return the results by rule without the columns and the rows that only the full report has room for."""
    flight = [column.name for column in table.columns].index(_FLIGHT)
    # One flight needs no number.
    left_out = _LEFT_OUT if len({row[flight] for row in table.rows} - {None}) > 1 else (*_LEFT_OUT, _FLIGHT)
    kept = [number for number, column in enumerate(table.columns) if column.name not in left_out]
    judged = [
        row for row in table.rows if not any(isinstance(cell, Status) and cell.words in _NOT_HELD for cell in row)
    ]
    tones = dict(table.tones)
    tone_of = {row: tones[number] for number, row in enumerate(table.rows) if number in tones}
    return replace(
        table,
        columns=tuple(table.columns[number] for number in kept),
        rows=tuple(tuple(row[number] for number in kept) for row in judged),
        note="",
        empty="No value was held against a limit: see what was not assessed.",
        tones=tuple((number, tone_of[row]) for number, row in enumerate(judged) if row in tone_of),
    )


def _is_one_of(block: Block, keys: Sequence[str]) -> bool:
    if not isinstance(block, (Table, Facts, Figure)):
        return False
    return any(block.key == key or (key.endswith("_") and block.key.startswith(key)) for key in keys)


def _filled(block: Block) -> Iterable[Block]:
    """Yield a block without what nobody has filled in."""
    if isinstance(block, Facts):
        items = tuple((label, value) for label, value in block.items if value)
        if items:
            yield replace(block, items=items, columns=2)
    elif isinstance(block, Table) and block.key == "list_of_findings":
        # What the program found stands before it.
        kind, by = ([column.name for column in block.columns].index(name) for name in ("Kind", "By"))
        rows = tuple(row for row in block.rows if row[kind] == "pin" or row[by] != "program")
        if rows:
            yield replace(block, rows=rows, tones=(), note="")
    elif isinstance(block, Table) and block.key == "fits":
        # Of the checks for which the scan is good enough nothing is to be said.
        rows = tuple(
            row for row in block.rows if any(isinstance(cell, Status) and cell.tone in ("bad", "close") for cell in row)
        )
        if rows:
            yield replace(block, rows=rows, tones=())
    elif isinstance(block, Signatures):
        # A reviewer signs where one is named.
        yield replace(
            block, items=block.items[:1] + tuple(each for each in block.items[1:] if any(value for _, value in each[1]))
        )
    elif not isinstance(block, Table) or block.rows or block.key == "findings":
        # Without a row, the table of findings says that all is within, or why nothing could be judged.
        yield block


def _said_shortly(blocks: Iterable[Block]) -> Iterable[Block]:
    """Yield the limitations, their lists as running text and without the checklist's blanks."""
    for block in blocks:
        if isinstance(block, Bullets):
            yield Paragraph(" ".join(_sentence(item) for item in block.items), "remark")
        elif isinstance(block, Table):
            rows = tuple(row for row in block.rows if any(_is_told(cell) for cell in row[1:]))
            if rows:
                yield replace(block, rows=rows, tones=())
        else:
            yield from _filled(block)


def _is_told(cell: Cell) -> bool:
    return cell not in (None, "") and not (isinstance(cell, Status) and cell.tone == "plain")


def _sentence(words: str) -> str:
    return words if words.endswith((".", "!", "?")) else f"{words}."
