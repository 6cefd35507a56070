"""A report as a workbook: one sheet for each table, numbers as numbers, units in the heads, no formulas."""

import io
from typing import Any

from stair_inspector.content.document import (
    Bullets,
    Cell,
    Column,
    Document,
    Facts,
    KeyFigures,
    Number,
    Paragraph,
    Signatures,
    Status,
    Table,
)
from stair_inspector.errors import MissingLibrary

_LONGEST_NAME = 31
_LONGEST_CELL = 32_000
"""Characters: a workbook takes 32,767 in one cell."""
_WIDEST, _NARROWEST = 60, 8
_OWN_SHEETS = ("About", "Fields", "Text")
"""The sheets of the words, before those of the tables."""
_COLOURS = {"good": "#1F6B45", "close": "#8A5A00", "bad": "#B3261E", "plain": "#5B6670"}
_FILLS = {"close": "#FDF5E3", "bad": "#FCEBE9"}
_ABOUT = (
    "One sheet for each table of the report. An empty cell was not measured or is not defined. Numbers are not "
    "rounded; the report shows as many decimals as the cell's format."
)


def xlsx_bytes(document: Document) -> bytes:
    """Return the report's tables and texts as XLSX; what looks like a formula or a link stays text.

    Raises
    ------
    MissingLibrary
        XlsxWriter is not installed.
    """
    try:
        import xlsxwriter
    except ImportError as error:
        raise MissingLibrary(
            "XlsxWriter is not installed, which writes the workbook: pip install XlsxWriter"
        ) from error
    stream = io.BytesIO()
    options = {
        "in_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
        "nan_inf_to_errors": False,
    }
    with xlsxwriter.Workbook(stream, options) as workbook:
        workbook.set_properties(
            {
                "title": _cut(document.title, 200),
                "company": _cut(document.firm, 200),
                # The one time in a workbook; without it the clock's would be there.
                "created": document.made_at.replace(tzinfo=None),
            }
        )
        sheets = _Sheets(workbook)
        held = [(sheets.name_of(table), table) for table in document.tables() if table.rows]
        sheets.about(document, held)
        sheets.facts(document)
        sheets.texts(document)
        for name, table in held:
            sheets.table(name, table)
    return stream.getvalue()


class _Sheets:
    """Writes the sheets of one workbook."""

    def __init__(self, workbook: Any) -> None:
        self._workbook = workbook
        self._names = {name.casefold() for name in _OWN_SHEETS}
        self._formats: dict[tuple[Any, ...], Any] = {}
        self._head = workbook.add_format(
            {"bold": True, "text_wrap": True, "valign": "bottom", "bottom": 2, "bottom_color": "#12466B"}
        )
        self._plain = workbook.add_format({"text_wrap": True, "valign": "top"})

    def about(self, document: Document, held: list[tuple[str, Table]]) -> None:
        """Write what the workbook holds: its sheets of tables by name, with their notes."""
        rows = [(name, f"{table.title}. {table.note}" if table.note else table.title) for name, table in held]
        made = f"{document.made_at:%Y-%m-%d}"
        head = [(document.title, " · ".join(part for part in (document.reference, made) if part)), ("", _ABOUT)]
        first = [row for block in document.front if isinstance(block, Table) for row in _told(block)]
        self._texts(_OWN_SHEETS[0], ("Sheet", "What it holds"), [*head, *first, *rows], (34, 110))

    def facts(self, document: Document) -> None:
        """Write the identity, instrument, scan and rule set: labels with values."""
        rows = [("", label, value) for label, value in document.identity]
        for block in document.blocks():
            if isinstance(block, Facts):
                rows += [(block.title, label, value) for label, value in block.items]
            elif isinstance(block, Signatures):
                rows += [(role, label, value) for role, lines in block.items for label, value in lines]
        self._texts(_OWN_SHEETS[1], ("Group", "Field", "Value"), rows, (22, 30, 90))

    def texts(self, document: Document) -> None:
        """Write the sentences of the report, also those that stand for a table without rows."""
        rows = []
        for title, blocks in (("", document.front), *((s.title, s.blocks) for s in document.sections)):
            for block in blocks:
                if isinstance(block, Paragraph):
                    rows.append((title, block.text))
                elif isinstance(block, Bullets):
                    rows += [(title, item) for item in block.items]
                elif isinstance(block, KeyFigures):
                    rows += [(title, f"{item.label}: {item.value} {item.unit}".strip()) for item in block.items]
                    rows += [] if block.status is None else [(title, block.status.words)]
                elif isinstance(block, Table) and not block.rows:
                    rows.append((block.title, block.empty))
        self._texts(_OWN_SHEETS[2], ("Section", "Text"), rows, (34, 120))

    def table(self, name: str, table: Table) -> None:
        """Write one table on a sheet of that name."""
        sheet = self._workbook.add_worksheet(name)
        for k, column in enumerate(table.columns):
            sheet.write_string(0, k, _cut(column.title), self._head)
            sheet.set_column(k, k, _width_of(table, k))
            for row, cells in enumerate(table.rows, 1):
                self._write(sheet, row, k, column, cells[k], table.tone_of(row - 1))
        sheet.freeze_panes(1, 1)
        sheet.autofilter(0, 0, len(table.rows), len(table.columns) - 1)
        sheet.set_landscape()
        sheet.fit_to_pages(1, 0)
        sheet.repeat_rows(0)

    def _texts(self, name: str, heads: tuple[str, ...], rows: list[Any], widths: tuple[int, ...]) -> None:
        sheet = self._workbook.add_worksheet(name)
        for k, (head, width) in enumerate(zip(heads, widths, strict=True)):
            sheet.write_string(0, k, head, self._head)
            sheet.set_column(k, k, width)
        for row, cells in enumerate(rows, 1):
            for k, text in enumerate(cells):
                if text:
                    sheet.write_string(row, k, _cut(text), self._plain)
        sheet.freeze_panes(1, 0)

    def _write(self, sheet: Any, row: int, k: int, column: Column, cell: Cell, tone: str) -> None:
        if cell is None or cell == "":
            sheet.write_blank(row, k, None, self._format("", None, tone))
        elif isinstance(cell, Status):
            sheet.write_string(row, k, cell.words, self._format("", cell.tone, tone))
        elif isinstance(cell, str):
            sheet.write_string(row, k, _cut(cell), self._format("", None, tone))
        else:
            value, digits = (cell.value, cell.digits) if isinstance(cell, Number) else (cell, column.digits or 0)
            # An uncertainty is shown with the digits that mean something, two at least.
            digits = max(digits, 2) if column.is_u else digits
            pattern = f"0.{'0' * digits}" if digits else "0"
            if column.is_difference:
                least = f"{0.5 * 10.0**-digits:.{digits + 1}f}"
                pattern = f'[>={least}]{pattern};[<=-{least}]-{pattern};""'
            if isinstance(cell, Number) and cell.mark:
                pattern += f'" {cell.mark}"'
            sheet.write_number(row, k, value, self._format(pattern, None, tone))

    def _format(self, pattern: str, text_tone: str | None, row_tone: str) -> Any:
        key = (pattern, text_tone, row_tone)
        if key not in self._formats:
            values: dict[str, Any] = {"valign": "top"}
            values |= {"num_format": pattern} if pattern else {"text_wrap": True}
            values |= {"font_color": _COLOURS[text_tone], "bold": True} if text_tone else {}
            values |= {"bg_color": _FILLS[row_tone]} if row_tone in _FILLS else {}
            self._formats[key] = self._workbook.add_format(values)
        return self._formats[key]

    def name_of(self, table: Table) -> str:
        """Return a sheet's name: without the signs that a workbook forbids, and once only, whatever its capitals."""
        title = table.key.replace("_", " ").capitalize()
        words = "".join(" " if letter in "[]:*?/\\'" else letter for letter in title).strip()[:_LONGEST_NAME].strip()
        name, number = words or "Table", 2
        while name.casefold() in self._names:
            ending = f" {number}"
            name = words[: _LONGEST_NAME - len(ending)] + ending
            number += 1
        self._names.add(name.casefold())
        return name


def _told(table: Table) -> list[tuple[str, str]]:
    """Return the rows of a table of the first page as texts: what a reader must know before the sheets."""
    return [
        (table.title if not number else "", "; ".join(filter(None, map(_text_of, table.columns, cells))))
        for number, cells in enumerate(table.rows)
    ]


def _text_of(column: Column, cell: Cell) -> str:
    if cell is None or isinstance(cell, str):
        return cell or ""
    return cell.words if isinstance(cell, Status) else f"{column.text(cell)} {column.unit}".strip()


def _width_of(table: Table, k: int) -> int:
    column = table.columns[k]
    longest = max((len(column.text(row[k])) for row in table.rows), default=0)
    head = max(len(word) for word in column.title.split(" "))
    return max(_NARROWEST, min(_WIDEST, max(longest, head) + 3))


def _cut(text: str, most: int = _LONGEST_CELL) -> str:
    """Return a text that fits into a cell; what is cut off is counted, and is whole in the other formats."""
    return text if len(text) <= most else f"{text[:most]} [and {len(text) - most} more characters, see the report]"
