"""The folder of the Export tab that makes a report: its files, and what only the inspector knows."""

import dataclasses
from collections.abc import Callable, Iterable
from functools import partial
from typing import Literal, cast, get_args

import numpy as np
import viser

from stair_inspector.codes.limits import LENGTH_UNITS
from stair_inspector.content.cells import QUANTITY_WORDS
from stair_inspector.content.fields import FIELD_GROUPS, Checklist, Paper, ReportBasis, ReportFields
from stair_inspector.content.images import read_logo, read_photo
from stair_inspector.content.moments import odd_moment
from stair_inspector.content.readings import FLIGHT_READINGS, ON_A_LINE, STEP_READINGS, Line, TapeReading, parse_reading
from stair_inspector.content.texts import require_text
from stair_inspector.content.written import split_unit
from stair_inspector.errors import ConfigError, one_of
from stair_inspector.pictures.frames import step_of
from stair_inspector.viewer.bridge.markup import read_order
from stair_inspector.viewer.bridge.widgets import File, Text, Widgets, offer
from stair_inspector.viewer.parts.export.pictures_html import DELETE_PHOTO, logo_html, photos_html
from stair_inspector.viewer.parts.export.readings_html import DELETE, readings_html
from stair_inspector.viewer.parts.export.report import ReportMaker
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.state.change import PageChange

FormPart = Literal["fields", "checklist"]
"""Of what is written for a report."""
PAPERS: dict[str, Paper] = {"A4": "a4", "US Letter": "us-letter"}
READING_QUANTITIES = {
    kind: {QUANTITY_WORDS[name]: name for name in names}
    for kind, names in (("step", STEP_READINGS), ("flight", FLIGHT_READINGS))
}
"""What can be read by hand of a step and of a flight, by the words of the menu."""
NO_PLACE = "no step yet"
_PICTURES = ".png,.jpg,.jpeg"
_LISTS = {DELETE: ("readings", "reading"), DELETE_PHOTO: ("photos", "photograph")}
"""What the first word of an order means: a list of the report's basis, and what one of it is called."""
_ANGLE_UNITS = ("deg", "%")
_SAID: dict[FormPart, str] = {
    "fields": "Stands in the report as it is written here.",
    "checklist": "What was seen on site; where it is empty the report says that it was not assessed.",
}
"""Of a text that has no hint of its own."""
_OBJECT = next(title for title, names in FIELD_GROUPS.items() if "client" in names)
_ELSEWHERE = ("title",)
"""The title of the inspection stands above, and is that of the report."""


class ReportForm:
    """The folder "Report and drawings"; what is written in it is kept with the work on the scan."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._keeper = context.keeper
        self._editor = context.editor
        self._texts: dict[tuple[FormPart, str], Text] = {}
        self._last_units: dict[tuple[str, ...], str] = {}
        widgets = context.widgets
        with widgets.folder("Report and drawings"):
            self.maker = ReportMaker(context)
            self.paper = widgets.dropdown("Paper", tuple(PAPERS), hint="Of PDF and drawings.", on_change=self.set_paper)
            with widgets.folder("Who, where, with what", is_open=False):
                for title, names in FIELD_GROUPS.items():
                    own = [name for name in names if name not in _ELSEWHERE]
                    # Client and site are asked for in every report: no third click for them.
                    with widgets.folder(title, is_open=title == _OBJECT):
                        self._add_texts(widgets, "fields", ReportFields, own)
            with widgets.folder("Seen on site", is_open=False):
                self._add_texts(widgets, "checklist", Checklist, Checklist.__dataclass_fields__)
            with widgets.folder("Readings by hand", is_open=False):
                self._add_readings(widgets)
            with widgets.folder("Photographs", is_open=False):
                self.photos = widgets.html()
                self.caption = widgets.text("Caption", hint="Of the photograph that is added next.")
                hint = "PNG or JPEG. The place and time that cameras hide in it are left out."
                widgets.upload("Add a photograph", _PICTURES, self.take_photo, icon=viser.Icon.PHOTO, hint=hint)
            with widgets.folder("Logo", is_open=False):
                self.logo = widgets.html()
                self.load_logo = widgets.upload(
                    "Load a logo", _PICTURES, self.take_logo, icon=viser.Icon.PHOTO, hint="PNG or JPEG."
                )
                widgets.button(
                    "Remove the logo",
                    self.remove_logo,
                    icon=viser.Icon.TRASH,
                    hint="Reports are made without one then.",
                    is_quiet=True,
                )
            self._orders = widgets.orders("Order", self.obey)

    def show(self) -> None:
        """Show what is kept; the desk is held."""
        basis = self._editor.work.basis
        self._show_basis(basis)
        self.logo.content = logo_html(basis.logo)
        self.photos.content = photos_html(basis.photos, self._orders)
        self.show_readings()

    def show_readings(self) -> None:
        """Show the readings beside the present result; the desk is held."""
        inspection = self._desk.inspection
        self.readings.content = readings_html(inspection, self._editor.work.basis, self._orders, self._desk.unit)
        if inspection is not None:
            self._offer_places(
                (step.step_id for step in inspection.steps), (flight.flight_id for flight in inspection.flights)
            )

    # What a person writes.

    def set_text(self, part: FormPart, name: str, value: object) -> None:
        """Keep a field of the report as it is typed; what is typed in one go is one change."""
        words = str(value)
        try:
            label, kept = self._keep_text(part, name, words)
        except ConfigError:
            self._put_back(part, name, words, getattr(getattr(self._editor.work.basis, part), name))
            raise
        odd = odd_moment(type(getattr(self._editor.work.basis, part)).kind_of(name), kept)
        if odd:
            self._desk.notices.tell(label, odd)
        self._desk.changed(PageChange.HISTORY)

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
        one_of(option, PAPERS, "paper")
        self._change(f"paper {option}", lambda basis: dataclasses.replace(basis, paper=PAPERS[option]))

    def add_reading(self) -> None:
        """Keep a reading by hand."""
        kind, _, number = str(self.place.value).partition(" ")
        quantity = READING_QUANTITIES.get(kind, {}).get(str(self.quantity.value))
        if quantity is None or not number.isdecimal() or len(number) > 6:
            raise ConfigError("reading: choose the step or flight and the quantity from the menus")
        written, written_u = str(self.value.value).strip(), str(self.u.value).strip()
        if not written:
            raise ConfigError("reading: write what was read, such as 170.5 or 6 11/16")
        # A unit that is written with the reading is that of its U too, unless another one is written with that.
        _, own_unit = split_unit(written, "reading")
        unit = own_unit or str(self.unit.value)
        reading = TapeReading(
            quantity,
            parse_reading(written, unit, quantity, "reading"),
            step=int(number) if kind == "step" else None,
            flight=int(number) if kind == "flight" else None,
            line=cast(Line, self.line.value) if quantity in ON_A_LINE else "centre",
            u=parse_reading(written_u, unit, quantity, "reading: its U", is_u=True) if written_u else None,
            instrument=str(self.instrument.value),
            note=str(self.note.value),
            at=self._place_of(int(number)) if kind == "step" else None,
        )
        self._change(
            f"reading of {self.quantity.value}",
            lambda basis: dataclasses.replace(basis, readings=(*basis.readings, reading)),
        )
        self.value.value = self.note.value = ""

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

        def without(basis: ReportBasis) -> ReportBasis:
            known = getattr(basis, entries)
            index = order.index_in(known, entries)
            return dataclasses.replace(basis, **{entries: known[:index] + known[index + 1 :]})

        self._change(f"deleted {one} {order.number}", without)

    def take_photo(self, file: File) -> None:
        """Keep an uploaded picture as a photograph of the site, with the caption that was written for it."""
        photo = read_photo(file.content, str(self.caption.value), f"photograph {str(file.name)[:60]!r}")
        self._change("photograph", lambda basis: dataclasses.replace(basis, photos=(*basis.photos, photo)))
        self.caption.value = ""

    def take_logo(self, file: File) -> None:
        """Keep an uploaded picture as the logo."""
        logo = read_logo(file.content, f"logo {str(file.name)[:60]!r}")
        self._change("logo", lambda basis: dataclasses.replace(basis, logo=logo))

    def remove_logo(self) -> None:
        """Take the logo away."""
        if self._editor.work.basis.logo is None:
            raise ConfigError("logo: there is none")
        self._change("no logo", lambda basis: dataclasses.replace(basis, logo=None))

    def _change(self, words: str, change: Callable[[ReportBasis], ReportBasis]) -> None:
        self._editor.edit(words, lambda work: {"basis": change(work.basis)})

    def _show_basis(self, basis: ReportBasis) -> None:
        """Write what is kept into the fields."""
        for (part, name), control in self._texts.items():
            kept = getattr(getattr(basis, part), name)
            # What is being typed may end with a blank that is not kept.
            if str(control.value).strip() != kept:
                control.value = kept
        self.paper.value = next(words for words, paper in PAPERS.items() if paper == basis.paper)

    def _offer_places(self, steps: Iterable[int], flights: Iterable[int]) -> None:
        """List where readings can be taken."""
        options = (*(f"step {step}" for step in steps), *(f"flight {flight}" for flight in flights)) or (NO_PLACE,)
        if tuple(self.place.options) != options:
            offer(self.place, options)
            self._fit_menus()

    def _put_back(self, part: FormPart, name: str, refused: str, kept: str) -> None:
        """Write what is kept over a text that was refused, unless another one was typed since."""
        control = self._texts[part, name]
        if control.value == refused:
            control.value = kept

    def _fit_menus(self, _: str = "") -> None:
        """Offer what can be read at the chosen place, in its units, and a line where there are three."""
        kind = str(self.place.value).partition(" ")[0]
        known = READING_QUANTITIES.get(kind, READING_QUANTITIES["step"])
        offer(self.quantity, tuple(known))
        name = known.get(str(self.quantity.value), "")
        units = LENGTH_UNITS if {**STEP_READINGS, **FLIGHT_READINGS}.get(name) == "m" else _ANGLE_UNITS
        self._last_units[tuple(self.unit.options)] = str(self.unit.value)
        offer(self.unit, units, self._last_units.get(units))
        self.line.visible = name in ON_A_LINE

    def _add_texts(
        self,
        widgets: Widgets,
        part: FormPart,
        kind: type[ReportFields] | type[Checklist],
        names: Iterable[str],
    ) -> None:
        for name in names:
            self._texts[part, name] = widgets.text(
                kind.label_of(name),
                is_multiline=kind.kind_of(name) == "lines",
                hint=kind.hint_of(name) or _SAID[part],
                on_change=partial(self.set_text, part, name),
            )

    def _add_readings(self, widgets: Widgets) -> None:
        self.readings = widgets.html()
        self.place = widgets.dropdown(
            "At", (NO_PLACE,), hint="The step or flight that was read.", on_change=self._fit_menus
        )
        self.quantity = widgets.dropdown(
            "What is read",
            tuple(READING_QUANTITIES["step"]),
            hint="The same quantity of the scan stands beside it.",
            on_change=self._fit_menus,
        )
        self.value = widgets.text(
            "Reading", hint="A number or a fraction: 170.5, or 6 11/16. A unit behind it counts: 6 11/16 in."
        )
        self.unit = widgets.dropdown(
            "Unit", LENGTH_UNITS, chosen="mm", hint="Where none is written. % is that of a slope."
        )
        self.u = widgets.text("Its U", hint="Expanded, k = 2, in the unit of the reading; empty where it is not known.")
        self.line = widgets.dropdown(
            "On the line", get_args(Line), chosen="centre", hint="Of a rise or going, as seen when climbing."
        )
        self.instrument = widgets.text("Instrument", hint="Tape, digital level, with its number.")
        self.note = widgets.text("Note", hint="Stands beside the reading in the report.")
        widgets.button(
            "Add the reading", self.add_reading, icon=viser.Icon.PLUS, hint="To the list above and the report."
        )
