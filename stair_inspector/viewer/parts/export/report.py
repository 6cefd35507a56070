"""The report from the page: what the inspector writes for it, and its files made from the result that is shown."""

import dataclasses
import datetime
import io
import zipfile
from collections.abc import Callable
from typing import Any

import numpy as np

from stair_inspector.codes import Check
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.images import read_logo, read_photo
from stair_inspector.content.moments import odd_moment
from stair_inspector.content.project_basis import titled
from stair_inspector.content.readings import ON_A_LINE, TapeReading, parse_reading
from stair_inspector.content.texts import require_text
from stair_inspector.content.written import split_unit
from stair_inspector.errors import ConfigError
from stair_inspector.model import Inspection
from stair_inspector.pictures.frames import step_of
from stair_inspector.pictures.render import RenderedView
from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.bridge.markup import read_order
from stair_inspector.viewer.compute.jobs import Making, Tell
from stair_inspector.viewer.parts.checks.check import Checking
from stair_inspector.viewer.parts.desk import Desk, Editor, Shown
from stair_inspector.viewer.parts.export.pictures_html import DELETE_PHOTO, logo_html, photos_html
from stair_inspector.viewer.parts.export.readings_html import DELETE, readings_html
from stair_inspector.viewer.parts.export.report_tab import (
    DOCUMENTS,
    DRAWINGS,
    EVERYTHING,
    PAPERS,
    READING_QUANTITIES,
    FormPart,
)
from stair_inspector.viewer.parts.export.scene_views import SceneViews
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.state.work import Keeper
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.html import html_bytes
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.pdf import pdf_bytes
from stair_inspector.writers.report import DRAWING_SUFFIXES, SUFFIXES, drawing_bytes, make_report
from stair_inspector.writers.xlsx import xlsx_bytes

_VIEWS_PERCENT = 70.0
"""Share of the time that the pictures of the scene take."""
_MAKERS = dict(zip(DOCUMENTS, (pdf_bytes, html_bytes, xlsx_bytes), strict=True))
_ENDINGS = {
    EVERYTHING: "_report.zip",
    **dict(zip((*DOCUMENTS, *DRAWINGS), (*SUFFIXES, *DRAWING_SUFFIXES.values()), strict=True)),
}
"""How the name of each file ends after that of the scan."""
_LISTS = {DELETE: ("readings", "reading"), DELETE_PHOTO: ("photos", "photograph")}
"""What the first word of an order means: a list of the report's basis, and what one of it is called."""


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class _Order:
    """What a report is made of, all of one moment."""

    shown: Shown
    check: Check | None
    basis: ReportBasis
    made_at: datetime.datetime


class Reporting:
    """The folder "Report and drawings" of the Export tab."""

    def __init__(
        self,
        desk: Desk,
        panel: Panel,
        checking: Checking,
        keeper: Keeper,
        editor: Editor,
        views: SceneViews,
        making: Making,
        show_changes: Callable[[], None],
    ) -> None:
        self._desk = desk
        self._folder = panel.export.report
        self._checking = checking
        self._keeper = keeper
        self._editor = editor
        self._views = views
        self._making = making
        self._show_changes = show_changes

    # What a person writes.

    def set_text(self, part: FormPart, name: str, value: object) -> None:
        """Keep a field of the report as it is typed; what is typed in one go is one change."""
        words = str(value)
        try:
            label, kept = self._keep_text(part, name, words)
        except ConfigError:
            self._folder.put_back(part, name, words, getattr(getattr(self._editor.work.basis, part), name))
            raise
        odd = odd_moment(name, kept)
        if odd:
            self._desk.notices.tell(label, odd)
        self._show_changes()

    def _keep_text(self, part: FormPart, name: str, words: str) -> tuple[str, str]:
        """Keep a text, and return its label and what is kept of it."""
        # The fields are not written again meanwhile: more may have been typed by now.
        with self._keeper.lock:
            basis = self._editor.work.basis
            texts = getattr(basis, part)
            label = str(type(texts).label_of(name))
            kept = require_text(words, label)
            changed = dataclasses.replace(basis, **{part: dataclasses.replace(texts, **{name: kept})})
            self._keeper.change(f"report: {label}", f"report {part} {name}", basis=changed)
        return label, kept

    def set_paper(self, option: str) -> None:
        """Choose the size of the PDF's pages."""
        if option not in PAPERS:
            raise ConfigError(f"paper: got {str(option)[:40]!r}; give one of {', '.join(PAPERS)}")
        self._change(f"paper {option}", lambda _: {"paper": PAPERS[option]})

    def add_reading(self) -> None:
        """Keep a reading by hand."""
        folder = self._folder
        kind, _, number = str(folder.place.value).partition(" ")
        quantity = READING_QUANTITIES.get(kind, {}).get(str(folder.quantity.value))
        if quantity is None or not number.isdecimal() or len(number) > 6:
            raise ConfigError("reading: choose the step or flight and the quantity from the menus")
        written, written_u = str(folder.value.value).strip(), str(folder.u.value).strip()
        if not written:
            raise ConfigError("reading: write what was read, such as 170.5 or 6 11/16")
        # A unit that is written with the reading is that of its U too, unless another one is written with that.
        _, own_unit = split_unit(written, "reading")
        unit = own_unit or str(folder.unit.value)
        reading = TapeReading(
            quantity,
            parse_reading(written, unit, quantity, "reading"),
            step=int(number) if kind == "step" else None,
            flight=int(number) if kind == "flight" else None,
            line=folder.line.value if quantity in ON_A_LINE else "centre",
            u=parse_reading(written_u, unit, quantity, "reading: its U", is_u=True) if written_u else None,
            instrument=str(folder.instrument.value),
            note=str(folder.note.value),
            at=self._place_of(int(number)) if kind == "step" else None,
        )
        self._change(f"reading of {folder.quantity.value}", lambda basis: {"readings": (*basis.readings, reading)})
        folder.value.value = folder.note.value = ""

    def _place_of(self, step_id: int) -> tuple[float, float, float]:
        """Return the middle of a step's tread, scan frame, metres: its number may change with the settings."""
        inspection = self._desk.inspection
        step = step_of(inspection, step_id)
        if inspection is None or step is None:
            raise ConfigError(f"reading: step {step_id} is not in the result; choose another one")
        x, y, z = (float(value) for value in step.plane.centroid + np.array(inspection.scan.origin_m))
        return x, y, z

    def obey(self, message: str) -> None:
        """Delete the reading or the photograph that a button of its list names."""
        order = read_order(message, _LISTS)
        entries, one = _LISTS[order.word]

        def without(basis: ReportBasis) -> dict[str, Any]:
            known = getattr(basis, entries)
            index = order.index_in(known, entries)
            return {entries: known[:index] + known[index + 1 :]}

        self._change(f"deleted {one} {order.number}", without)

    def take_photo(self, file: Any) -> None:
        """Keep an uploaded picture as a photograph of the site, with the caption that was written for it."""
        photo = read_photo(file.content, str(self._folder.caption.value), f"photograph {str(file.name)[:60]!r}")
        self._change("photograph", lambda basis: {"photos": (*basis.photos, photo)})
        self._folder.caption.value = ""

    def take_logo(self, file: Any) -> None:
        """Keep an uploaded picture as the logo."""
        logo = read_logo(file.content, f"logo {str(file.name)[:60]!r}")
        self._change("logo", lambda _: {"logo": logo})

    def remove_logo(self) -> None:
        """Take the logo away."""
        if self._editor.work.basis.logo is None:
            raise ConfigError("logo: there is none")
        self._change("no logo", lambda _: {"logo": None})

    def show(self) -> None:
        """Show what is kept; the caller holds the desk's lock."""
        basis, folder = self._editor.work.basis, self._folder
        folder.show_basis(basis)
        folder.logo.content = logo_html(basis.logo)
        folder.photos.content = photos_html(basis.photos, uuid_of(folder.order))
        self.show_readings()

    def show_readings(self) -> None:
        """Show the readings beside the present result; the caller holds the desk's lock."""
        inspection = self._desk.inspection
        self._folder.readings.content = readings_html(
            inspection, self._editor.work.basis, uuid_of(self._folder.order), self._desk.unit
        )
        if inspection is not None:
            self._folder.offer_places(
                (step.step_id for step in inspection.steps), (flight.flight_id for flight in inspection.flights)
            )

    def _change(self, words: str, change: Callable[[ReportBasis], dict[str, Any]]) -> None:
        self._editor.edit(words, lambda work: {"basis": dataclasses.replace(work.basis, **change(work.basis))})

    # What is made of it.

    def make(self, kind: str) -> None:
        """Make a file of the result that is shown, with the check and the fields of this moment, and send it."""
        if kind not in _ENDINGS:
            raise ConfigError(f"report: got {str(kind)[:40]!r}; choose one of the buttons")
        order = self._order()
        ending = _ENDINGS[kind]
        name = f"{order.shown.stem}{ending}"
        data = self._making.make(name, lambda tell: self._made(kind, order, tell))
        self._desk.client.send_file_download(name, data, save_immediately=True)

    def _order(self) -> _Order:
        with self._desk.lock:
            shown = self._desk.result("report")
            work = self._editor.work
            check = self._checking.checked()
            return _Order(shown, check, titled(work.basis, work.title), datetime.datetime.now())

    def _made(self, kind: str, order: _Order, tell: Tell) -> bytes:
        if kind in DRAWINGS:
            return self._drawn(kind, order)
        shown, stem = order.shown, order.shown.stem
        # A workbook has no pictures.
        views = () if kind == "XLSX" else self._views_of(order, tell)
        tell("report: charts and drawings …", _VIEWS_PERCENT)
        document = make_report(shown.scan, shown.inspection, order.basis, order.made_at, order.check, views)
        if kind in DOCUMENTS:
            tell(f"report: {kind} …", 85.0)
            return _MAKERS[kind](document)
        files: dict[str, bytes] = {}
        for number, name in enumerate(DOCUMENTS):
            tell(f"report: {name} …", 80.0 + 4.0 * number)
            files[f"{stem}{_ENDINGS[name]}"] = _MAKERS[name](document)
        tell("report: drawings …", 94.0)
        for suffix, data in drawing_bytes(shown.inspection, order.made_at).items():
            files[f"{stem}{suffix}"] = data
        files[f"{stem}.csv"] = csv_bytes(shown.inspection)
        files[f"{stem}.json"] = json_bytes(shown.inspection, order.check)
        return _zipped(files, order.made_at)

    def _drawn(self, kind: str, order: _Order) -> bytes:
        made = drawing_bytes(order.shown.inspection, order.made_at)
        if _ENDINGS[kind] not in made:
            raise ConfigError(f"{kind}: {_why_nothing(order.shown.inspection)}")
        return made[_ENDINGS[kind]]

    def _views_of(self, order: _Order, tell: Tell) -> tuple[RenderedView, ...]:
        def tell_view(number: int, n_views: int) -> None:
            tell(f"report: view {number + 1} of {n_views} …", _VIEWS_PERCENT * number / n_views)

        return self._views.take(
            order.shown,
            f"{order.made_at:%Y-%m-%d}",
            order.basis.fields.stair or order.basis.fields.title,
            tell_view,
            from_scene=bool(self._folder.from_scene.value),
        )


def _why_nothing(inspection: Inspection) -> str:
    if inspection.params.method == "paper":
        return "the paper's method measures no nosings, so there is nothing to draw; set the method to survey"
    if not inspection.steps:
        return "no step was found, so there is nothing to draw; see the notes for the reason"
    return "no nosing was measured, so there is nothing to draw; see the notes for the reason"


def _zipped(files: dict[str, bytes], made_at: datetime.datetime) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name, made_at.timetuple()[:6]), data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
