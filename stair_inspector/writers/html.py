"""A report as one HTML page that needs nothing else: no scripts, pictures inside, made to be read and printed."""

import base64
import hashlib
from collections.abc import Sequence
from html import escape

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
    Number,
    Paragraph,
    Section,
    Signatures,
    Status,
    Table,
)

_QUARTER = 0.25
_TYPES = {"svg": "image/svg+xml", "png": "image/png", "jpeg": "image/jpeg"}
_STYLE = """
:root{--ink:#1b2228;--quiet:#5b6670;--line:#cbd2d8;--accent:#12466b;--shade:#f3f6f8;--good:#1f6b45;--close:#8a5a00;
--bad:#b3261e;--plain:#5b6670}
*{box-sizing:border-box}
body{margin:0;background:#fff;color:var(--ink);font:15px/1.5 "Source Sans 3","Source Sans Pro",system-ui,-apple-system,
"Segoe UI","Noto Sans KR",sans-serif;font-variant-numeric:tabular-nums}
main{max-width:1080px;margin:0 auto;padding:40px 32px 80px}
header{border-bottom:2px solid var(--accent);padding-bottom:16px;margin-bottom:20px}
.brand{display:flex;justify-content:space-between;align-items:center;min-height:56px;color:var(--quiet);
font-weight:600}
.brand img{max-height:56px;max-width:50%}
h1{color:var(--accent);font-size:34px;line-height:1.15;margin:24px 0 4px;font-weight:600;overflow-wrap:anywhere}
h2{color:var(--accent);font-size:22px;margin:44px 0 14px;padding-bottom:4px;border-bottom:1px solid var(--accent);
font-weight:600}
h2 .no{display:inline-block;min-width:1.6em}
h3{color:var(--accent);font-size:15px;margin:24px 0 6px;font-weight:600}
p{margin:0 0 10px;overflow-wrap:anywhere}
.lead{font-size:18px;margin-bottom:18px}
.remark,.note,figcaption,.empty{color:var(--quiet);font-size:12.5px}
ul{margin:0 0 12px;padding-left:20px}
li{margin-bottom:5px;overflow-wrap:anywhere}
.facts{display:grid;grid-template-columns:1fr 1fr;column-gap:32px;margin:0}
.facts.one{grid-template-columns:1fr}
.facts div{display:grid;grid-template-columns:150px 1fr;column-gap:14px;border-bottom:1px solid var(--line);
padding:6px 0;min-height:34px}
.facts dt{color:var(--quiet);font-size:13px}
.facts dd{margin:0;overflow-wrap:anywhere;white-space:pre-line}
.key{display:flex;flex-wrap:wrap;border-top:1px solid var(--line);border-bottom:1px solid var(--line);margin:0 0 0}
.key div{flex:1 1 130px;padding:12px 16px;border-left:1px solid var(--line)}
.key div:first-child{border-left:0}
.key b{display:block;font-size:30px;font-weight:300;color:var(--accent);line-height:1.1}
.key b span{font-size:15px;color:var(--quiet)}
.key small{color:var(--quiet)}
.status{padding:12px 16px;font-weight:600;margin-bottom:20px;background:var(--shade)}
.good{color:var(--good)}.close{color:var(--close)}.bad{color:var(--bad)}.plain{color:var(--plain)}
b.good,b.close,b.bad,b.plain{font-weight:600;white-space:nowrap}
.status.good{background:#eaf4ee}.status.close{background:#fdf5e3}.status.bad{background:#fcebe9}
.wide{overflow-x:auto;margin-bottom:8px}
table{border-collapse:collapse;width:100%;font-size:13px}
caption{text-align:left;color:var(--accent);font-weight:600;font-size:15px;padding:24px 0 6px}
caption .note{display:block;font-weight:400;padding-top:2px}
th{text-align:left;vertical-align:bottom;border-bottom:1.5px solid var(--accent);padding:4px 7px;font-weight:600}
th small{display:block;font-weight:400;color:var(--quiet)}
td{border-bottom:1px solid var(--line);padding:4px 7px;vertical-align:top;overflow-wrap:break-word}
.n{text-align:right;white-space:nowrap;overflow-wrap:normal}
th.n{white-space:normal}
th.v,td.v{text-align:right;padding-right:0;white-space:nowrap}
td.u{padding-left:3px;color:var(--quiet);white-space:nowrap}
th.v{text-align:center}
tr.at-bad td{background:#fcebe9}tr.at-close td{background:#fdf5e3}
figure{margin:18px 0;break-inside:avoid}
figure img{width:100%;height:auto;display:block}
.pair{display:grid;grid-template-columns:1fr 1fr;gap:20px}
.four{display:grid;grid-template-columns:repeat(4,1fr);gap:16px}
footer{margin-top:48px;border-top:1px solid var(--line);padding-top:8px;color:var(--quiet);font-size:12.5px}
@media (max-width:720px){.facts,.pair{grid-template-columns:1fr}main{padding:20px 16px}}
@page{margin:20mm 16mm;@bottom-right{content:"Page " counter(page) " of " counter(pages);font-size:8pt;color:#5b6670}}
@media print{main{max-width:none;padding:0}body{font-size:9.5pt}table{font-size:7.5pt}thead{display:table-header-group}
tr,.facts div,.key,.status{break-inside:avoid}h2,h3,caption{break-after:avoid}.wide{overflow:visible}
th,td{padding:2.5px 3.5px}tr.at-bad td,tr.at-close td,.status{print-color-adjust:exact}}
"""
_IN_A_NOTEBOOK = """
.stair-inspector caption{text-align:left;font-weight:600}
.stair-inspector caption .note{display:block;font-weight:400;font-size:smaller;max-width:80em}
.stair-inspector th small{display:block;font-weight:400}
.stair-inspector td.v,.stair-inspector td.n{text-align:right;white-space:nowrap}
.stair-inspector td.u{text-align:left;white-space:nowrap}
"""


def html_bytes(document: Document) -> bytes:
    """Return the report as HTML: UTF-8, every text escaped, nothing loaded, no script can run."""
    digest = base64.b64encode(hashlib.sha256(_STYLE.encode()).digest()).decode("ascii")
    policy = f"default-src 'none'; img-src data:; style-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'"
    made = f"{document.made_at:%Y-%m-%d}"
    foot = " · ".join(part for part in (document.title, document.reference, made, document.firm) if part)
    parts = [
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n',
        f'<meta http-equiv="Content-Security-Policy" content="{_text(policy)}">\n',
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n',
        '<meta name="referrer" content="no-referrer">\n',
        f"<title>{_text(document.title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n<main>\n",
        _head(document, made),
        blocks_html(document.front),
        *(_section(section) for section in document.sections),
        f"<footer>{_text(foot)}</footer>\n</main>\n</body>\n</html>\n",
    ]
    return "".join(parts).encode("utf-8")


def notebook_html(blocks: Sequence[Block]) -> str:
    """Return blocks for a cell of a notebook, which has its own style for tables."""
    return f'<div class="stair-inspector"><style>{_IN_A_NOTEBOOK}</style>\n{blocks_html(blocks)}</div>\n'


def _text(value: str) -> str:
    return escape(value, quote=True)


def _head(document: Document, made: str) -> str:
    logo = "<span></span>"
    if document.logo is not None:
        logo = f'<img alt="Logo of {_text(document.firm or "the firm")}" src="{_data_url("png", document.logo)}">'
    line = " · ".join(part for part in (document.reference, made) if part)
    return (
        f'<header><div class="brand">{logo}<span>{_text(document.firm)}</span></div>'
        f'<h1>{_text(document.title)}</h1><p class="remark">{_text(line)}</p></header>\n'
        f"{_facts(document.identity, 2)}\n"
    )


def _row_of(block: Block, rest: Sequence[Block]) -> list[Figure]:
    """Return the pictures of one row from a block on, as wide as each other; none where it stands by itself."""
    row: list[Figure] = []
    for each in (block, *rest):
        if not isinstance(each, Figure) or each.share > 0.5 or len(row) == round(1.0 / each.share):
            break
        if row and each.share != row[0].share:
            break
        row.append(each)
    # One of half the width is as wide as the page where there is no other; a small one is not.
    return row if len(row) > 1 or (row and row[0].share <= _QUARTER) else []


def blocks_html(blocks: Sequence[Block], title: str = "") -> str:
    """Return blocks one below the other, but pictures of half the width, or of a quarter, side by side."""
    rest = list(blocks)
    body = []
    while rest:
        block = rest.pop(0)
        row = _row_of(block, rest)
        if row:
            del rest[: len(row) - 1]
            kind = "pair" if row[0].share > _QUARTER else "four"
            body.append(f'<div class="{kind}">{"".join(map(_figure, row))}</div>\n')
        else:
            body.append(_block(block, title))
    return "".join(body)


def _section(section: Section) -> str:
    number = f'<span class="no">{_text(section.number)}</span>'
    return (
        f"<section>\n<h2>{number} {_text(section.title)}</h2>\n{blocks_html(section.blocks, section.title)}</section>\n"
    )


def _block(block: Block, section_title: str = "") -> str:
    if isinstance(block, Paragraph):
        return f'<p class="{block.style}">{_text(block.text)}</p>\n'
    if isinstance(block, Bullets):
        return "<ul>" + "".join(f"<li>{_text(item)}</li>" for item in block.items) + "</ul>\n"
    if isinstance(block, Facts):
        return f"<h3>{_text(block.title)}</h3>\n{_facts(block.items, block.columns)}\n"
    if isinstance(block, KeyFigures):
        return _key_figures(block)
    if isinstance(block, Table):
        return _table(block, block.title if block.title != section_title else "")
    if isinstance(block, Figure):
        return _figure(block)
    return _signatures(block)


def _facts(items: tuple[tuple[str, str], ...], columns: int) -> str:
    rows = "".join(f"<div><dt>{_text(label)}</dt><dd>{_text(value)}</dd></div>" for label, value in items)
    return f'<dl class="facts{" one" if columns == 1 else ""}">{rows}</dl>'


def _key_figures(block: KeyFigures) -> str:
    items = "".join(
        f"<div><b>{_text(item.value)}<span>{_text(_unit(item.unit))}</span></b><small>{_text(item.label)}</small></div>"
        for item in block.items
    )
    status = ""
    if block.status is not None:
        status = f'<p class="status {block.status.tone}">{_text(_status(block.status))}</p>\n'
    return (f'<div class="key">{items}</div>\n' if items else "") + status


def _unit(unit: str) -> str:
    return unit if unit in ("", "°") else f" {unit}"


def _status(status: Status) -> str:
    return f"{SIGNS[status.tone]} {status.words}"


def _table(table: Table, title: str) -> str:
    if not table.rows:
        head = f"<h3>{_text(title)}</h3>\n" if title else ""
        return f'{head}<p class="empty">{_text(table.empty)}</p>\n'
    note = f'<span class="note">{_text(table.note)}</span>' if table.note else ""
    caption = f"<caption>{_text(title)}{note}</caption>" if title or note else ""
    heads = []
    for k, column in enumerate(table.columns):
        if table.is_attached(k):
            continue
        has_u = k + 1 < len(table.columns) and table.is_attached(k + 1)
        kind = ' class="v" colspan="2"' if has_u else ' class="n"' if column.is_number else ""
        unit = f"<small>{_text(column.unit)}</small>" if column.unit else ""
        heads.append(f'<th scope="col"{kind}>{_text(column.name)}{unit}</th>')
    rows = []
    for number, row in enumerate(table.rows):
        cells = "".join(_cell(table, k, cell) for k, cell in enumerate(row))
        tone = table.tone_of(number)
        rows.append((f'<tr class="at-{tone}">' if tone != "plain" else "<tr>") + f"{cells}</tr>\n")
    return (
        f'<div class="wide"><table id="{_text(table.key)}">{caption}<thead><tr>{"".join(heads)}</tr></thead>\n'
        f"<tbody>\n{''.join(rows)}</tbody></table></div>\n"
    )


def _cell(table: Table, k: int, cell: Cell) -> str:
    column = table.columns[k]
    if isinstance(cell, Status):
        return f'<td><b class="{cell.tone}">{_text(_status(cell))}</b></td>'
    is_attached = table.is_attached(k)
    has_u = k + 1 < len(table.columns) and table.is_attached(k + 1)
    kind = "u" if is_attached else "v" if has_u else "n" if column.is_number else ""
    # A missing uncertainty of a missing value is not told twice.
    shown = "" if is_attached and cell is None else _number(column, cell)
    sign = "± " if is_attached and cell is not None else ""
    return f'<td class="{kind}">{sign}{shown}</td>' if kind else f"<td>{shown}</td>"


def _number(column: Column, cell: Cell) -> str:
    words = _text(column.text(cell))
    if isinstance(cell, Number):
        return f'<data value="{cell.value!r}">{words}</data>'
    return f'<data value="{cell!r}">{words}</data>' if isinstance(cell, (int, float)) else words


def _figure(figure: Figure) -> str:
    source = _data_url(figure.kind, figure.data)
    caption = f"<figcaption>{_text(figure.caption)}</figcaption>"
    return f'<figure id="{_text(figure.key)}"><img alt="{_text(figure.alt)}" src="{source}">{caption}</figure>\n'


def _data_url(kind: str, data: bytes) -> str:
    return f"data:{_TYPES[kind]};base64,{base64.b64encode(data).decode('ascii')}"


def _signatures(block: Signatures) -> str:
    return "".join(f"<h3>{_text(role)}</h3>\n{_facts((*lines, ('Signature', '')), 2)}\n" for role, lines in block.items)
