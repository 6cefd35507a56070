"""A drawing as DXF: millimetres, layers, real dimension entities, and a title; opens without errors in CAD programs."""

import hashlib
import io
import math
import re
import uuid
from datetime import datetime
from typing import TYPE_CHECKING

from stair_inspector import __version__
from stair_inspector.content.document import plain
from stair_inspector.drawings.model import (
    Arrow,
    Circle,
    Dimension,
    Drawing,
    Layer,
    Path,
    SheetPoint,
    Words,
    head_of,
    readable_deg,
)
from stair_inspector.drawings.plan import plan
from stair_inspector.drawings.section import section
from stair_inspector.errors import MissingLibrary
from stair_inspector.model import Inspection

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.layouts.layout import Modelspace

TEXT_MM = 45.0
"""Height of the letters in a DXF file: small enough to stand beside one going, large enough at a scale of 1:25."""
_STYLE = "STAIR"
_MIDDLE = 0.5
_BAR_MM = 1000.0
_BLUE = 5
_LINES: dict[Layer, tuple[int, int, str]] = {
    "STAIR-NOSING": (7, 50, "CONTINUOUS"),
    "STAIR-OUTLINE": (8, 25, "CONTINUOUS"),
    "STAIR-HIDDEN": (8, 13, "DASHED"),
    "STAIR-WALKING-LINE": (4, 25, "CONTINUOUS"),
    "STAIR-PITCH": (4, 18, "DASHDOT"),
    "STAIR-DIM-RISE": (_BLUE, 18, "CONTINUOUS"),
    "STAIR-DIM-GOING": (_BLUE, 18, "CONTINUOUS"),
    "STAIR-DIM-WIDTH": (_BLUE, 18, "CONTINUOUS"),
    "STAIR-DIM-DEPTH": (_BLUE, 18, "CONTINUOUS"),
    "STAIR-HEIGHT": (8, 18, "CONTINUOUS"),
    "STAIR-NUMBER": (7, 18, "CONTINUOUS"),
    "STAIR-NOT-MEASURED": (1, 18, "CONTINUOUS"),
    "STAIR-TITLE": (7, 25, "CONTINUOUS"),
}
"""Of each layer: colour index, line weight in hundredths of a millimetre, line type."""
_DATE = re.compile(r"(\$TDU?(?:CREATE|UPDATE)\n *40\n)[^\n]*")
_GUID = re.compile(r"(\$(?:VERSION|FINGERPRINT)GUID\n *2\n)[^\n]*")
_MARKER = re.compile(r"^(\d[\w.]* @ )\d{4}-\d\d-\d\dT[^\n]*$", re.MULTILINE)
"""Where ezdxf writes the time of writing, and what differs from file to file."""
_ALIGN = {"start": "MIDDLE_LEFT", "middle": "MIDDLE_CENTER", "end": "MIDDLE_RIGHT"}


def dxf_files(inspection: Inspection, made_at: datetime) -> dict[str, bytes]:
    """Return the plan and the section of the whole staircase as DXF, by ``plan`` and ``section``.

    Nothing is returned where no nosing was measured, as by the paper's method or without a staircase.

    Raises
    ------
    MissingLibrary
        ezdxf is not installed.
    """
    drawings = (plan(inspection, TEXT_MM), section(inspection, TEXT_MM))
    name = inspection.scan.name
    return {drawing.key: dxf_bytes(drawing, name, made_at) for drawing in drawings if drawing is not None}


def dxf_document(drawing: Drawing, scan_name: str, made_at: datetime) -> "Document":
    """Return a drawing as an ezdxf document, in millimetres.

    Parameters
    ----------
    drawing : Drawing
        With letters of :data:`TEXT_MM`.
    scan_name : str
        Written below the title; whatever it holds is text and nothing else.
    made_at : datetime
        The date in the file and below the title.

    Raises
    ------
    MissingLibrary
        ezdxf is not installed.
    """
    document = _new_document(drawing.text_mm)
    space = document.modelspace()
    for part in drawing.parts:
        if isinstance(part, Path):
            space.add_lwpolyline(part.places, close=part.is_closed, dxfattribs={"layer": part.layer})
        elif isinstance(part, Circle):
            space.add_circle(part.centre, part.radius, dxfattribs={"layer": part.layer})
        elif isinstance(part, Arrow):
            _add_arrow(space, part)
        elif isinstance(part, Words):
            _add_words(space, part)
        else:
            _add_dimension(space, part)
    _add_title(space, drawing, scan_name, made_at)
    return document


def dxf_bytes(drawing: Drawing, scan_name: str, made_at: datetime) -> bytes:
    """Return a drawing as a DXF file; the same drawing and date give the same bytes.

    Raises
    ------
    MissingLibrary
        ezdxf is not installed.
    """
    stream = io.StringIO()
    document = dxf_document(drawing, scan_name, made_at)
    _sort_classes(document)
    document.write(stream)
    return _dated(stream.getvalue(), made_at).encode("utf-8", errors="backslashreplace")


def dxf_text(value: str) -> str:
    """Return a text that a CAD program shows as it is: without its own codes for symbols and control characters."""
    one_line = plain(value).replace("\n", " ")
    # A caret begins a control character, two per cent signs a symbol, a backslash with U+ a letter by its number.
    return one_line.replace("^", "^ ").replace("%%", "% %").replace("\\U+", "\\ U+").replace("\\M+", "\\ M+")


def _new_document(text_mm: float) -> "Document":
    try:
        from ezdxf import filemanagement, units
        from ezdxf.render.arrows import ARROWS
    except ImportError as error:
        raise MissingLibrary("ezdxf is not installed, which writes DXF: pip install ezdxf") from error
    document = filemanagement.new("R2010", setup=["linetypes"])
    document.units = units.MM
    document.header["$MEASUREMENT"] = 1
    for name, (color, weight, line_type) in _LINES.items():
        document.layers.add(name, color=color, lineweight=weight, linetype=line_type)
    document.header["$LTSCALE"] = text_mm / 2.0
    document.styles.add(_STYLE, font="arial.ttf")
    style = document.dimstyles.duplicate_entry("Standard", _STYLE)
    style.dxf.dimtxt = text_mm
    style.dxf.dimtxsty = _STYLE
    style.dxf.dimasz = 0.7 * text_mm
    style.dxf.dimexo = 0.4 * text_mm
    style.dxf.dimexe = 0.5 * text_mm
    style.dxf.dimgap = 0.3 * text_mm
    style.dxf.dimscale = 1.0
    style.dxf.dimlfac = 1.0
    style.dxf.dimdec = 1
    style.dxf.dimdsep = ord(".")
    # Anything written there, zero too, rounds to whole numbers.
    style.dxf.discard("dimrnd")
    style.dxf.dimzin = 0
    style.dxf.dimtad = 1
    style.dxf.dimclrd = style.dxf.dimclre = style.dxf.dimclrt = _BLUE
    style.set_arrows(blk=ARROWS.architectural_tick)
    return document


def _sort_classes(document: "Document") -> None:
    """Give the CLASS entries one order: ezdxf 1.4 takes them from a set, whose order differs between processes."""
    document.classes.add_required_classes(document.dxfversion)
    classes = document.classes.classes
    for key in sorted(classes):
        classes[key] = classes.pop(key)


def _dated(text: str, made_at: datetime) -> str:
    """Return a DXF file's text with one date in it, and with an identity that follows from its content."""
    from ezdxf.tools.juliandate import juliandate

    text = _DATE.sub(rf"\g<1>{juliandate(made_at.replace(tzinfo=None)):.9f}", text)
    text = _MARKER.sub(rf"\g<1>{made_at:%Y-%m-%dT%H:%M:%S}", text)
    text = _GUID.sub(rf"\g<1>{{{uuid.UUID(int=0)}}}", text)
    own = str(uuid.uuid5(uuid.NAMESPACE_OID, hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()))
    return _GUID.sub(rf"\g<1>{{{own.upper()}}}", text)


def _add_dimension(space: "Modelspace", part: Dimension) -> None:
    turn = readable_deg(part.turn_deg)
    # Upside down otherwise, and on the other side of its line.
    start, end = (part.start, part.end) if math.isclose(turn, part.turn_deg) else (part.end, part.start)
    added = space.add_linear_dim(
        base=part.line,
        p1=start,
        p2=end,
        angle=turn,
        dimstyle=_STYLE,
        # In its middle CAD programs place a text themselves, where it has room.
        location=None if part.text_share == _MIDDLE else part.text_at,
        dxfattribs={"layer": part.layer},
    )
    added.render()


def _add_words(space: "Modelspace", part: Words) -> None:
    from ezdxf.enums import TextEntityAlignment

    made = space.add_text(
        dxf_text(part.text),
        height=part.size,
        rotation=part.turn_deg,
        dxfattribs={"layer": part.layer, "style": _STYLE},
    )
    made.set_placement(part.at, align=TextEntityAlignment[_ALIGN[part.anchor]])


def _add_arrow(space: "Modelspace", part: Arrow) -> None:
    space.add_line(part.start, part.end, dxfattribs={"layer": part.layer})
    space.add_solid(head_of(part), dxfattribs={"layer": part.layer})


def _add_title(space: "Modelspace", drawing: Drawing, scan_name: str, made_at: datetime) -> None:
    x_low, y_low, _, _ = drawing.bounds
    size, y = drawing.text_mm, y_low - 4.0 * drawing.text_mm
    lines = (
        (drawing.title, 1.6),
        (f"{scan_name}, {made_at:%Y-%m-%d}, stair_inspector {__version__}", 1.0),
        *((note, 0.8) for note in drawing.notes),
    )
    for words, factor in lines:
        _add_words(space, Words(words, (x_low, y), factor * size, "STAIR-TITLE", "start"))
        y -= 2.0 * factor * size
    _add_bar(space, (x_low, y - size), size)


def _add_bar(space: "Modelspace", at: SheetPoint, size: float) -> None:
    """Draw a scale bar of a metre in quarters, for who prints the drawing and does not know its scale."""
    x, y = at
    quarter = _BAR_MM / 4.0
    for k in range(5):
        space.add_line((x + k * quarter, y), (x + k * quarter, y + 0.5 * size), dxfattribs={"layer": "STAIR-TITLE"})
    space.add_line((x, y), (x + _BAR_MM, y), dxfattribs={"layer": "STAIR-TITLE"})
    for place, words in ((x, "0"), (x + _BAR_MM, f"{_BAR_MM:g} mm")):
        _add_words(space, Words(words, (place, y - size), 0.8 * size, "STAIR-TITLE"))
