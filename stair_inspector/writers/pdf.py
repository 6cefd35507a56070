"""A report as PDF: typeset with typst, fonts embedded, headings and tables tagged, the same bytes for the same content.

The content goes to typst as data, never as markup. What no font can draw is spelt out as its code point.
"""

import dataclasses
import json
import re
import tempfile
import unicodedata
from importlib import resources
from pathlib import Path
from typing import Any

from stair_inspector.content.document import (
    SIGNS,
    Block,
    Bullets,
    Cell,
    Column,
    Document,
    Facts,
    Figure,
    KeyFigures,
    Paragraph,
    Signatures,
    Status,
    Table,
)
from stair_inspector.errors import MissingLibrary, WriteError
from stair_inspector.pictures.fonts import font_folders

_ALWAYS_DRAWN = frozenset(map(chr, range(0x20, 0x7F))) | frozenset("\n")
_IS_DRAWN: dict[str, bool] = {}
"""Whether typst has a font for a character, of those that were met."""
_IN_NO_FONT = "\uffff"
_SPECIMEN = """#set page(width: 200cm, height: auto, margin: 0pt)
#set text(font: ("Source Sans 3", "Noto Sans KR"))
#for word in json(bytes(sys.inputs.words)) { box[|]; box(word) }"""
"""Every word by itself, behind a bar that tells it from the one before."""
_SUFFIXES = {"svg": "svg", "png": "png", "jpeg": "jpg"}
_TABLE_PT = 8.0
_SMALLEST_PT = 6.0
_PAGE_PT = {"a4": 481.9, "us-letter": 498.6}
"""Width of the text, points: the paper less its margins of 20 mm."""
_EM_PER_LETTER = 0.51
_CELL_EM = 0.8
_U_EM = 0.9
"""Width of a figure or small letter in Source Sans 3, of a cell's inset, and of the sign before an uncertainty, em."""
_TITLE_WIDTH = 70
"""Letters of the title on the first page: two lines. The section on the report's identity has the whole."""
_RUNNING_WIDTHS = (45, 25, 30)
"""Letters of title, stair and firm at the head of the other pages: together one line."""
_WHOLE_ROWS = 14
"""A table of so few rows is not broken over two pages."""
_NARROWEST_TEXT_EM, _WANTED_TEXT_EM = 7.0, 13.0
_SHORT_TEXT_EM = 10.0
"""Least width of a column that wraps, the width that long texts ask for, and widest text that does not wrap, em."""


def pdf_bytes(document: Document) -> bytes:
    """Return the report as PDF (PDF/UA-1: tagged, with words for every picture).

    Raises
    ------
    MissingLibrary
        typst or its fonts are not installed.
    WriteError
        A picture cannot be read.
    """
    pdf: bytes = _typeset(document, pdf_standards="ua-1", timestamp=int(document.made_at.timestamp()))
    return pdf


def page_pngs(document: Document, ppi: float) -> list[bytes]:
    """Return the report's pages as pictures, PNG, so many pixels for an inch; errors as :func:`pdf_bytes`."""
    pages = _typeset(document, format="png", ppi=ppi)
    return [pages] if isinstance(pages, bytes) else list(pages)


def _typeset(document: Document, **wanted: Any) -> Any:
    content = _spelt(_to_data(document))
    with tempfile.TemporaryDirectory(prefix="stair-report-") as name:
        folder = Path(name)
        (folder / "content.json").write_text(json.dumps(content), encoding="ascii")
        (folder / "report.typ").write_bytes(resources.files(__package__).joinpath("report.typ").read_bytes())
        for file, data in _pictures(document).items():
            (folder / file).write_bytes(data)
        return _compiled(str(folder / "report.typ"), root=name, **wanted)


def _compiled(source: str | bytes, **wanted: Any) -> Any:
    typst = _typst()
    try:
        return typst.compile(source, font_paths=list(font_folders()), **wanted)
    except typst.TypstError as error:
        reason = " ".join(str(error).split())
        raise WriteError(f"the report cannot be typeset ({reason}); leave out the picture, or report this") from error


def _typst() -> Any:
    try:
        import typst
    except ImportError as error:
        raise MissingLibrary("typst is not installed, which typesets the PDF: pip install typst") from error
    return typst


def _spelt(value: Any) -> Any:
    """Return plain values in which every character that no font has is written as its code point."""
    letters = _letters_in(value)
    _learn(letters)
    return _written(value, {letter for letter in letters if not _IS_DRAWN[letter]})


def _letters_in(value: Any) -> set[str]:
    if isinstance(value, str):
        return set(value) - _ALWAYS_DRAWN
    entries = value.values() if isinstance(value, dict) else value if isinstance(value, (list, tuple)) else ()
    return set().union(*map(_letters_in, entries))


def _written(value: Any, missing: set[str]) -> Any:
    if isinstance(value, str):
        return "".join(f"⟨U+{ord(letter):04X}⟩" if letter in missing else letter for letter in value)
    if isinstance(value, dict):
        return {name: _written(entry, missing) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_written(entry, missing) for entry in value]
    return value


def _learn(letters: set[str]) -> None:
    """Find out for which characters typst has a font: it draws them all at once, and what has none is drawn alike."""
    new = sorted(letters - _IS_DRAWN.keys())
    if not new:
        return
    # A mark that joins to the letter before it is tried on one.
    words = [_IN_NO_FONT, *("o" + letter if unicodedata.combining(letter) else letter for letter in new)]
    inputs = {"words": json.dumps(words)}
    drawn: bytes = _compiled(_SPECIMEN.encode(), format="svg", sys_inputs=inputs)
    bar, *glyphs = re.findall(rb'<use[^>]* xlink:href="#([^"]+)"', drawn)
    groups: list[set[bytes]] = [set()]
    for glyph in glyphs:
        if glyph == bar:
            groups.append(set())
        else:
            groups[-1].add(glyph)
    (missing,), *found = groups
    _IS_DRAWN.update({letter: missing not in group for letter, group in zip(new, found, strict=True)})


def _pictures(document: Document) -> dict[str, bytes]:
    files = {_file_of(figure, document): _drawable(figure) for figure in document.figures()}
    if document.logo is not None:
        files["logo.png"] = document.logo
    return files


def _drawable(figure: Figure) -> bytes:
    """Return a picture in which every letter can be drawn: an SVG holds words, perhaps those of a user's rule file."""
    if figure.kind != "svg":
        return figure.data
    words: str = _spelt(figure.data.decode("utf-8"))
    return words.encode("utf-8")


def _file_of(figure: Figure, document: Document) -> str:
    """Return a name that no key can lead elsewhere: the picture's number."""
    return f"figure-{document.figures().index(figure)}.{_SUFFIXES[figure.kind]}"


def _to_data(document: Document) -> dict[str, Any]:
    made = document.made_at
    date = f"{made:%Y-%m-%d}"
    stair = next((value for label, value in document.identity if label == "Stair" and value), "")
    return {
        "title": document.title,
        "firm": document.firm,
        "logo": None if document.logo is None else "logo.png",
        "shown-title": _clipped(document.title, _TITLE_WIDTH),
        "running": {
            "title": _clipped(document.title, _RUNNING_WIDTHS[0]),
            "stair": _clipped(stair, _RUNNING_WIDTHS[1]),
            "firm": _clipped(document.firm, _RUNNING_WIDTHS[2]),
        },
        "footer": " · ".join(part for part in (document.reference, date) if part),
        "made": {
            "year": made.year,
            "month": made.month,
            "day": made.day,
            "hour": made.hour,
            "minute": made.minute,
            "second": made.second,
        },
        "paper": document.paper,
        "identity": document.identity,
        "front": _blocks(document.front, document),
        "sections": [
            {
                "number": section.number,
                "title": section.title,
                "level": section.level,
                "starts_page": section.starts_page,
                "is_whole": any(isinstance(block, Signatures) for block in section.blocks),
                "blocks": _blocks(section.blocks, document, section.title),
            }
            for section in document.sections
        ],
    }


def _clipped(text: str, most: int) -> str:
    """Return a text in one line, with three dots where it is wider than so many letters; Korean counts twice."""
    shown, width = "", 0
    for letter in " ".join(text.split()):
        width += 2 if unicodedata.east_asian_width(letter) in "WF" else 1
        if width > most:
            return f"{shown.rstrip()}…"
        shown += letter
    return shown


def _blocks(blocks: tuple[Block, ...], document: Document, section_title: str = "") -> list[dict[str, Any]]:
    """Return blocks as plain values; pictures of half the width or less are put side by side."""
    found: list[dict[str, Any]] = []
    for block in blocks:
        values = _block(block, document)
        if values.get("title") == section_title:
            # Said once is enough.
            values["title"] = ""
        if isinstance(block, Figure) and block.share <= 0.5:
            last, columns = found[-1] if found else {}, round(1.0 / block.share)
            if last.get("columns") == columns and len(last["figures"]) < columns:
                last["figures"].append(values)
                continue
            values = {"kind": "figure_row", "columns": columns, "figures": [values]}
        found.append(values)
    return found


def _block(block: Block, document: Document) -> dict[str, Any]:
    if isinstance(block, Table):
        return _table(block, _PAGE_PT[document.paper])
    if isinstance(block, Figure):
        return {
            "kind": "figure",
            "file": _file_of(block, document),
            "alt": block.alt,
            "caption": block.caption,
        }
    if isinstance(block, KeyFigures):
        status = None if block.status is None else _status(block.status)
        return {"kind": "key_figures", "items": [dataclasses.asdict(item) for item in block.items], "status": status}
    kinds = {Paragraph: "paragraph", Bullets: "bullets", Facts: "facts", Signatures: "signatures"}
    return {"kind": kinds[type(block)], **dataclasses.asdict(block)}


def _status(status: Status) -> dict[str, str]:
    return {"text": f"{SIGNS[status.tone]} {status.words}", "tone": status.tone}


def _table(table: Table, page_pt: float) -> dict[str, Any]:
    widths = [_natural_em(table, k) for k in range(len(table.columns))]
    is_fixed = [
        column.is_number or (column.width == 1.0 and width <= _SHORT_TEXT_EM) or _is_blank(table, k)
        for k, (column, width) in enumerate(zip(table.columns, widths, strict=True))
    ]
    needed = sum(
        width if fixed else max(_NARROWEST_TEXT_EM, min(width / 2.0, _WANTED_TEXT_EM), _longest_word(column.name))
        for column, width, fixed in zip(table.columns, widths, is_fixed, strict=True)
    )
    size = max(_SMALLEST_PT, min(_TABLE_PT, page_pt / needed))
    return {
        "kind": "table",
        "title": table.title,
        "size": size,
        "columns": [
            {
                "name": column.name,
                "unit": column.unit,
                "kind": "u" if table.is_attached(k) else "number" if column.is_number else "text",
                # Where every column knows its width they share the page.
                "fr": not is_fixed[k] or all(is_fixed),
                "width": widths[k] if is_fixed[k] else column.width,
            }
            for k, column in enumerate(table.columns)
        ],
        "rows": [[_cell(column, cell) for column, cell in zip(table.columns, row, strict=True)] for row in table.rows],
        "tones": [table.tone_of(row) for row in range(len(table.rows))],
        "note": table.note,
        "empty": table.empty,
        "is_whole": len(table.rows) <= _WHOLE_ROWS,
    }


def _cell(column: Column, cell: Cell) -> Any:
    return _status(cell) if isinstance(cell, Status) else column.text(cell)


def _natural_em(table: Table, k: int) -> float:
    """Return how wide a column wants to be, em: its longest cell, the longest word or half of its head."""
    column = table.columns[k]
    longest = max((len(column.text(row[k])) for row in table.rows), default=1)
    if table.is_attached(k):
        return longest * _EM_PER_LETTER + _CELL_EM + _U_EM
    half_head = len(column.name) / 2.0 * _EM_PER_LETTER + _CELL_EM
    return max(longest * _EM_PER_LETTER + _CELL_EM, _longest_word(column.name), half_head)


def _is_blank(table: Table, k: int) -> bool:
    return all(row[k] in ("", None) for row in table.rows)


def _longest_word(name: str) -> float:
    return max(len(word) for word in name.split(" ")) * (_EM_PER_LETTER + 0.04) + _CELL_EM
