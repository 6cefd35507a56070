"""What a report says, before it is typeset: sections of paragraphs, field lists, tables with raw numbers, pictures.

It is made once (:mod:`stair_inspector.content.order`) and read by every renderer, so that all formats say the same.
"""

import unicodedata
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Literal, TypeVar, cast

from stair_inspector.content.fields import Paper
from stair_inspector.units import tidy, u_text

Tone = Literal["good", "close", "bad", "plain"]
SIGNS: dict[Tone, str] = {"good": "✓", "close": "≈", "bad": "✗", "plain": "–"}
"""A sign for each tone, because colour alone is no sign."""

EMPTY = "–"
"""What stands in a cell whose value was not measured or is not defined."""


@dataclass(frozen=True, slots=True)
class Status:
    """A judgement in words, with the tone that colours it."""

    words: str
    tone: Tone


_GROUPED = 10_000
"""Whole numbers from here on are set in groups of three."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number in a column whose rows have different decimals; ``mark`` is a sign that stands after it."""

    value: float
    digits: int
    mark: str = ""


Cell = str | float | int | Number | Status | None
"""A cell holds a text, a raw number in its column's unit, a judgement, or None for what was not measured."""
Entry = TypeVar("Entry")


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    ``digits`` is the number of decimals that are shown, None for texts. ``is_u`` marks the expanded uncertainty of the
    column before it, which is shown beside that column's value. ``is_difference`` leaves blank what is zero as shown.
    ``width`` is that of a text column relative to others; one of width 1 takes no more than its texts need where they
    are short. ``is_signed`` numbers have a plus too.
    """

    name: str
    unit: str = ""
    digits: int | None = None
    is_u: bool = False
    is_difference: bool = False
    width: float = 1.0
    is_signed: bool = False

    @property
    def is_number(self) -> bool:
        """Whether the column holds numbers."""
        return self.digits is not None

    @property
    def title(self) -> str:
        """The name with its unit, as a table without a line for units has it."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def text(self, cell: Cell) -> str:
        """Return what is shown of a cell: the same in every format."""
        if cell is None:
            return EMPTY
        if isinstance(cell, Status):
            return f"{SIGNS[cell.tone]} {cell.words}"
        if isinstance(cell, str):
            return cell
        value, digits = (cell.value, cell.digits) if isinstance(cell, Number) else (float(cell), self.digits or 0)
        mark = f" {cell.mark}" if isinstance(cell, Number) and cell.mark else ""
        if self.is_u:
            return u_text(value) + mark
        number = tidy(value, digits)
        if self.is_difference and not number:
            return ""
        is_grouped = not digits and abs(number) >= _GROUPED
        shown = f"{number:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}") if is_grouped else f"{number:.{digits}f}"
        plus = "+" if self.is_signed and number > 0.0 else ""
        return plus + shown.replace("-", "−") + mark


@dataclass(frozen=True, slots=True)
class Table:
    """A table; ``tones`` has one entry for each row that is not plain, by its number from 0.

    ``key`` names it in a workbook. ``empty`` is the sentence that stands there instead when there is no row.
    """

    key: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    note: str = ""
    empty: str = ""
    tones: tuple[tuple[int, Tone], ...] = ()

    def __post_init__(self) -> None:
        for number, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise ValueError(f"table {self.key}: row {number} has {len(row)} cells for {len(self.columns)} columns")

    def is_attached(self, column: int) -> bool:
        """Tell whether a column is shown beside the one before it, whose uncertainty it holds."""
        before = self.columns[column - 1] if column else None
        return self.columns[column].is_u and before is not None and before.is_number and not before.is_u

    def tone_of(self, row: int) -> Tone:
        """Return the tone of a row."""
        return dict(self.tones).get(row, "plain")


TablePart = tuple[Column | Sequence[Column], Callable[[Entry], Cell | Sequence[Cell]]]
"""One column, or a few, of a table that is made by :func:`table_of`, and what stands there of an entry."""


def table_of(
    key: str,
    title: str,
    entries: Iterable[Entry],
    *parts: TablePart[Entry],
    note: str = "",
    empty: str = "",
    tone: Callable[[Entry], Tone] | None = None,
) -> Table:
    """Return a table with a row for each entry, from its columns, each with what stands in it.

    Parameters
    ----------
    key, title, note, empty : str
        As of :class:`Table`.
    entries : iterable
        What the rows tell of.
    parts : tuple
        A column and the function that returns the cell of an entry; or a few columns and that of all their cells.
    tone : callable, optional
        Returns the tone of an entry's row.
    """
    known = list(entries)
    columns: list[Column] = []
    rows: list[list[Cell]] = [[] for _ in known]
    for heads, cells in parts:
        columns += [heads] if isinstance(heads, Column) else heads
        for row, entry in zip(rows, known, strict=True):
            found = cells(entry)
            row += [cast(Cell, found)] if isinstance(heads, Column) else cast(Sequence[Cell], found)
    tones = tuple((number, tone(entry)) for number, entry in enumerate(known)) if tone is not None else ()
    loud = tuple((number, each) for number, each in tones if each in ("bad", "close"))
    return Table(key, title, tuple(columns), tuple(map(tuple, rows)), note, empty, loud)


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text; a ``lead`` is set larger, a ``remark`` smaller."""

    text: str
    style: Literal["body", "lead", "remark"] = "body"


@dataclass(frozen=True, slots=True)
class Bullets:
    """Short sentences, one below the other."""

    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Facts:
    """Labels with their values; an empty value is a blank to fill by hand."""

    key: str
    title: str
    items: tuple[tuple[str, str], ...]
    columns: Literal[1, 2] = 2


@dataclass(frozen=True, slots=True)
class KeyFigure:
    """A number that one looks for first: its value with unit as text, and what it is."""

    value: str
    unit: str
    label: str


@dataclass(frozen=True, slots=True)
class KeyFigures:
    """The few numbers at the head of a report, and the judgement on them where there is one."""

    items: tuple[KeyFigure, ...]
    status: Status | None = None


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture: ``data`` are the bytes of an SVG, PNG or JPEG; ``alt`` says in words what it shows.

    ``share`` is the part of the page's width that it takes: pictures of 0.5 stand side by side.
    """

    key: str
    caption: str
    alt: str
    kind: Literal["svg", "png", "jpeg"]
    data: bytes
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class Signatures:
    """Lines to sign on: for each the fields beside it, by label and value."""

    items: tuple[tuple[str, tuple[tuple[str, str], ...]], ...]


Block = Paragraph | Bullets | Facts | KeyFigures | Table | Figure | Signatures


@dataclass(frozen=True, slots=True)
class Section:
    """A numbered section, ``number`` as in ``3`` or ``3.1`` or ``A``; with ``is_wide`` its pages lie on the side."""

    number: str
    title: str
    blocks: tuple[Block, ...]
    starts_page: bool = False

    @property
    def level(self) -> int:
        """1 for a section, 2 for a part of one."""
        return 1 + self.number.count(".")


@dataclass(frozen=True, slots=True)
class Document:
    """A report. ``front`` stands before the first section; ``identity`` are the few lines under its title."""

    title: str
    identity: tuple[tuple[str, str], ...]
    firm: str
    logo: bytes | None
    reference: str
    made_at: datetime
    paper: Paper
    front: tuple[Block, ...]
    sections: tuple[Section, ...]

    def blocks(self) -> Iterator[Block]:
        """Yield every block in reading order."""
        yield from self.front
        for section in self.sections:
            yield from section.blocks

    def tables(self) -> list[Table]:
        """Return every table in reading order."""
        return [block for block in self.blocks() if isinstance(block, Table)]

    def figures(self) -> list[Figure]:
        """Return every picture in reading order."""
        return [block for block in self.blocks() if isinstance(block, Figure)]


def plain(text: object) -> str:
    r"""Return a text from a file as a report shows it: what cannot be seen is spelt out, nothing is left out.

    Control characters, half letters, and marks that turn the direction of reading, with which a name can be made to
    look like another, are written as escapes.

    Examples
    --------
    >>> plain("stair\x07.ply")
    'stair\\u0007.ply'
    """
    return "".join(letter if letter == "\n" or not _is_unseen(letter) else _escape(letter) for letter in str(text))


def _escape(letter: str) -> str:
    number = ord(letter)
    return rf"\u{number:04x}" if number < 0x10000 else rf"\U{number:08x}"


def _is_unseen(letter: str) -> bool:
    kind = unicodedata.category(letter)
    return kind in ("Cc", "Cs", "Co", "Cn", "Zl", "Zp") or (kind == "Cf" and letter not in "\u200c\u200d")
