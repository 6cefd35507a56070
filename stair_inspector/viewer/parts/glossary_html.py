"""What is measured, for the help card: a drawing of steps with the quantities on it, and a line on each."""

from stair_inspector.quantities import GOING, PITCH, QUANTITIES, RISE, SHOWN_OF_PAPER, WIDTH, quantity_of
from stair_inspector.viewer.bridge.markup import DIM, hint_of, text
from stair_inspector.viewer.parts.step_columns import COVERAGE, RMS

_OTHER_WORDS = (
    ("nosing", "Front edge of a tread"),
    ("flight", "Steps that follow each other without a landing in between"),
    ("U, ±", "Expanded uncertainty, k = 2: the value lies within it in about 95 of 100 cases"),
)
_LINE = 'fill="none" stroke="currentColor"'
_THIN = f'{_LINE} stroke-width="0.9"'
_WORDS = 'font-size="12" fill="currentColor"'


def glossary_html() -> str:
    """Return the drawing, and the words that an inspector may not know, as quantities and columns define them."""
    entries = [
        *_OTHER_WORDS,
        *(
            (each.label, hint_of(each) + (f". In codes: {each.code_term}" if each.code_term else ""))
            for each in QUANTITIES
        ),
        *((column.head, column.hint) for column in (RMS, COVERAGE)),
        *((f"{each.symbol} (paper)", hint_of(each)) for each in SHOWN_OF_PAPER),
    ]
    rows = "".join(
        f'<div style="break-inside:avoid;padding:1px 0"><dt style="display:inline;font-weight:600">{text(name)}</dt>'
        f'<dd style="display:inline;margin:0;color:{DIM}"> {text(words)}</dd></div>'
        for name, words in entries
    )
    return (
        f'<div data-testid="glossary" style="font-size:12.5px;line-height:1.4">{_drawing()}'
        f'<dl style="columns:17em;column-gap:24px;margin:6px 0">{rows}</dl></div>'
    )


def _drawing() -> str:
    """Return three steps seen from the side, and one from above."""
    depth, overhang = quantity_of("tread_depth"), quantity_of("nosing_overhang")
    drawn = (RISE, GOING, depth, overhang, PITCH, WIDTH)
    places = ((146, 134, "start"), (245, 82, "middle"), (142, 186, "middle"), (208, 112, "start"), (78, 136, "end"))
    labels = "".join(
        f'<text x="{x}" y="{y}" text-anchor="{anchor}">{text(each.label)}</text>'
        for each, (x, y, anchor) in zip(drawn, (*places, (494, 190, "middle")), strict=True)
    )
    said = ", ".join(each.label for each in drawn)
    return (
        f'<svg viewBox="0 0 580 206" style="display:block;width:100%;max-width:640px" role="img" '
        f'aria-label="{text(f"Steps from the side and from above: {said}")}">'
        f'<path d="M10 196H94V154H80V146H204V94H190V86H314V34H300V26H408" {_LINE} stroke-width="2.5"/>'
        f'<path d="M40 168L340 4" {_THIN} stroke-dasharray="5 4"/>'
        f'<path d="M140 146V86M136 146h8M136 86h52" {_THIN}/>'
        f'<path d="M190 60V84M300 20V66M190 66H300M190 62v8M300 62v8" {_THIN}/>'
        f'<path d="M80 148V172M204 148V172M80 168H204" {_THIN}/>'
        f'<path d="M190 96V112M204 108H190M204 96V112" {_THIN}/>'
        f'<rect x="430" y="96" width="128" height="60" {_LINE} stroke-width="2.5"/>'
        f'<path d="M430 160V178M558 160V178M430 174H558" {_THIN}/>'
        f"<g {_WORDS}>{labels}</g></svg>"
    )
