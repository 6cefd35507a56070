"""A report in all its formats and its drawings, made from one content."""

from collections.abc import Sequence
from datetime import datetime

from stair_inspector.codes.findings import Check
from stair_inspector.content.document import Document
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.order import build_document
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.content.short import ReportLength, shortened
from stair_inspector.model import ComparedScan, Inspection, Scan
from stair_inspector.pictures.report_views import RenderedView
from stair_inspector.writers.dxf import dxf_files
from stair_inspector.writers.figures import draw_pictures
from stair_inspector.writers.html import html_bytes
from stair_inspector.writers.pdf import pdf_bytes
from stair_inspector.writers.xlsx import xlsx_bytes

SUFFIXES = ("_report.pdf", "_report.html", "_report.xlsx")
"""What is added to a scan's stem for each format, in order."""
DRAWING_SUFFIXES = {"plan": "_plan.dxf", "section": "_section.dxf"}
"""The same for the drawings, which are made where nosings were measured."""


def make_report(
    scan: Scan,
    inspection: Inspection,
    basis: ReportBasis,
    made_at: datetime,
    check: Check | None = None,
    views: Sequence[RenderedView] | None = None,
    pinned: PinnedFindings | None = None,
    compared: ComparedScan | None = None,
    results: str = "",
) -> Document:
    """Return a report's content with its pictures.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    basis : ReportBasis
        What the user adds.
    made_at : datetime
        The report's date: the same input gives the same bytes but for it.
    check : Check, optional
        The same inspection held against a rule set.
    views : sequence of RenderedView, optional
        Pictures of the inspector's own scene; by default they are rendered without a display.
    pinned : PinnedFindings, optional
        Pins of the inspector, and what was said of findings.
    compared : ComparedScan, optional
        What changed against a second scan, which has a page of its own.
    results : str, optional
        Name and SHA-256 of the JSON that is written with it.
    """
    title = basis.fields.stair or basis.fields.title
    pictures = draw_pictures(scan, inspection, check, made_at, title=title, views=views, compared=compared)
    return build_document(inspection, check, basis, made_at, pictures, pinned, compared, results)


def of_length(document: Document, length: ReportLength) -> dict[str, Document]:
    """Return what each file of the report tells, by suffix: PDF and HTML short or in full, XLSX every table."""
    told = document if length == "full" else shortened(document)
    return dict(zip(SUFFIXES, (told, told, document), strict=True))


def report_bytes(document: Document, length: ReportLength = "full") -> dict[str, bytes]:
    """Return the report by suffix: PDF and HTML, short or in full, and XLSX, which holds every table at all times.

    Raises
    ------
    MissingLibrary
        A library that typesets is not installed.
    """
    makers = zip((pdf_bytes, html_bytes, xlsx_bytes), of_length(document, length).items(), strict=True)
    return {suffix: make(told) for make, (suffix, told) in makers}


def drawing_bytes(inspection: Inspection, made_at: datetime) -> dict[str, bytes]:
    """Return the drawings by suffix: plan and section as DXF; none where no nosing was measured.

    Raises
    ------
    MissingLibrary
        ezdxf is not installed.
    """
    return {DRAWING_SUFFIXES[key]: data for key, data in dxf_files(inspection, made_at).items()}


def report_files(
    scan: Scan,
    inspection: Inspection,
    basis: ReportBasis,
    made_at: datetime,
    check: Check | None = None,
    views: Sequence[RenderedView] | None = None,
    pinned: PinnedFindings | None = None,
    length: ReportLength = "short",
    compared: ComparedScan | None = None,
    results: str = "",
) -> dict[str, bytes]:
    """Return ``_report.pdf``, ``.html``, ``.xlsx``, ``_plan.dxf`` and ``_section.dxf`` by what is added to the stem.

    Parameters as :func:`make_report`, and ``length`` as :func:`report_bytes`.

    Raises
    ------
    MissingLibrary
        A library that typesets is not installed.
    """
    document = make_report(scan, inspection, basis, made_at, check, views, pinned, compared, results)
    return report_bytes(document, length) | drawing_bytes(inspection, made_at)
