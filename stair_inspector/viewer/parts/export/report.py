"""The report from the page: its files, made from the result that is shown."""

import dataclasses
import datetime

import viser

from stair_inspector.codes import Check
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.content.project_basis import titled
from stair_inspector.content.short import LENGTHS, ReportLength
from stair_inspector.errors import ConfigError, one_of
from stair_inspector.model import ComparedScan, Inspection
from stair_inspector.pictures.report_views import RenderedView
from stair_inspector.viewer.compute.jobs import Tell
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.export.scene_views import SceneViews
from stair_inspector.viewer.parts.part import Context
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.html import html_bytes
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.pdf import pdf_bytes
from stair_inspector.writers.record import hashes_of, results_words, with_manifest
from stair_inspector.writers.report import DRAWING_SUFFIXES, SUFFIXES, drawing_bytes, make_report, of_length
from stair_inspector.writers.xlsx import xlsx_bytes
from stair_inspector.writers.zips import zip_bytes

EVERYTHING = "Report"
DOCUMENTS = ("PDF", "HTML", "XLSX")
DRAWINGS = ("Plan DXF", "Section DXF")
_VIEWS_PERCENT = 70.0
"""Share of the time that the pictures of the scene take."""
_MAKERS = dict(zip(DOCUMENTS, (pdf_bytes, html_bytes, xlsx_bytes), strict=True))
_ENDINGS = {
    EVERYTHING: "_report.zip",
    **dict(zip((*DOCUMENTS, *DRAWINGS), (*SUFFIXES, *DRAWING_SUFFIXES.values()), strict=True)),
}
"""How the name of each file ends after that of the scan."""


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class _Order:
    """What a report is made of, all of one moment: ``inspection`` is that shown, with all that the page says of it."""

    shown: Shown
    inspection: Inspection
    check: Check | None
    basis: ReportBasis
    pinned: PinnedFindings
    made_at: datetime.datetime
    length: ReportLength
    compared: ComparedScan | None


class ReportMaker:
    """The buttons that make a report, drawings, or both, of the result that is shown."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._judge = context.judge
        self._editor = context.editor
        self._making = context.making
        self.views = SceneViews(context)
        self._length: ReportLength = LENGTHS[0]
        widgets = context.widgets
        widgets.button(
            EVERYTHING,
            lambda: self.make(EVERYTHING),
            icon=viser.Icon.FILE_ZIP,
            hint="PDF, HTML page, XLSX workbook, CSV, JSON, plan and section as DXF, in one ZIP.",
        )
        widgets.buttons("Or one of", DOCUMENTS, self.make, hint="The same content; the workbook has every table.")
        self.length = widgets.choice(
            "Length",
            tuple(each.capitalize() for each in LENGTHS),
            LENGTHS[0].capitalize(),
            self.set_length,
            hint="Short: one page of result and two of evidence. Full: some 14 pages. The workbook holds all in both.",
        )
        widgets.buttons("Drawings", DRAWINGS, self.make, hint="In millimetres, with dimensions.")
        self._from_scene = widgets.checkbox(
            "Views of this scene",
            is_on=True,
            hint="Taken with this page, whose camera moves meanwhile; off, the program draws them without a page.",
        )

    def make(self, kind: str) -> None:
        """Make a file of the result that is shown, with the check and the fields of this moment, and send it."""
        if kind not in _ENDINGS:
            raise ConfigError(f"report: got {str(kind)[:40]!r}; choose one of the buttons")
        order = self._order()
        ending = _ENDINGS[kind]
        name = f"{order.shown.stem}{ending}"
        data = self._making.make(name, lambda tell: self._made(kind, order, tell))
        self._desk.client.send_file_download(name, data, save_immediately=True)

    def set_length(self, option: str) -> None:
        """Choose the short or the full report."""
        self._length = one_of(str(option).lower(), LENGTHS, "length of the report")
        self.length.show(self._length.capitalize())

    def _order(self) -> _Order:
        with self._desk.lock:
            shown, inspection = self._desk.result("report"), self._desk.inspection_to_send("report")
            work = self._editor.work
            check = self._judge.checked()
            compared = self._desk.comparison("report")
            basis = titled(work.basis, work.title)
            made_at = datetime.datetime.now()
            return _Order(shown, inspection, check, basis, work.findings, made_at, self._length, compared)

    def _made(self, kind: str, order: _Order, tell: Tell) -> bytes:
        if kind in DRAWINGS:
            return self._drawn(kind, order)
        inspection, stem = order.inspection, order.shown.stem
        # A workbook has no pictures.
        views = () if kind == "XLSX" else self._views_of(order, tell)
        tell("report: charts and drawings …", _VIEWS_PERCENT)
        json_name = f"{stem}.json"
        results = json_bytes(inspection, order.check, order.pinned, order.compared)
        document = make_report(
            order.shown.scan,
            inspection,
            order.basis,
            order.made_at,
            order.check,
            views,
            order.pinned,
            order.compared,
            # A single document goes without the JSON.
            "" if kind in DOCUMENTS else results_words(json_name, results),
        )
        told = dict(zip(DOCUMENTS, of_length(document, order.length).values(), strict=True))
        if kind in DOCUMENTS:
            tell(f"report: {kind} …", 85.0)
            return _MAKERS[kind](told[kind])
        files: dict[str, bytes] = {}
        for number, name in enumerate(DOCUMENTS):
            tell(f"report: {name} …", 80.0 + 4.0 * number)
            files[_ENDINGS[name]] = _MAKERS[name](told[name])
        tell("report: drawings …", 94.0)
        files |= drawing_bytes(inspection, order.made_at)
        files |= {".csv": csv_bytes(inspection), ".json": results}
        compared = order.compared
        measured = hashes_of([inspection.scan] if compared is None else [compared.found.before, compared.found.after])
        made = with_manifest(stem, files, measured, inspection.params, order.made_at.astimezone(), order.check)
        return zip_bytes(made, order.made_at)

    def _drawn(self, kind: str, order: _Order) -> bytes:
        made = drawing_bytes(order.inspection, order.made_at)
        if _ENDINGS[kind] not in made:
            raise ConfigError(f"{kind}: {_why_nothing(order.inspection)}")
        return made[_ENDINGS[kind]]

    def _views_of(self, order: _Order, tell: Tell) -> tuple[RenderedView, ...]:
        def tell_view(number: int, n_views: int) -> None:
            tell(f"report: view {number + 1} of {n_views} …", _VIEWS_PERCENT * number / n_views)

        return self.views.take(
            order.shown,
            f"{order.made_at:%Y-%m-%d}",
            order.basis.fields.stair or order.basis.fields.title,
            tell_view,
            from_scene=bool(self._from_scene.value),
        )


def _why_nothing(inspection: Inspection) -> str:
    if inspection.params.method == "paper":
        return "the paper's method measures no nosings, so there is nothing to draw; set the method to survey"
    if not inspection.steps:
        return "no step was found, so there is nothing to draw; see the notes for the reason"
    return "no nosing was measured, so there is nothing to draw; see the notes for the reason"
