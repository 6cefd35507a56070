"""The folder of the Export tab that makes a report: its files, and what only the inspector knows."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, get_args

import viser

from stair_inspector.codes.rules import LENGTH_UNITS
from stair_inspector.content.cells import QUANTITY_WORDS
from stair_inspector.content.fields import FIELD_GROUPS, Checklist, ReportBasis, ReportFields
from stair_inspector.content.readings import FLIGHT_READINGS, ON_A_LINE, STEP_READINGS, Line
from stair_inspector.viewer.bridge.notices import from_page, orders_from_page

FormPart = Literal["fields", "checklist"]
EVERYTHING = "Report"
DOCUMENTS = ("PDF", "HTML", "XLSX")
DRAWINGS = ("Plan DXF", "Section DXF")
PAPERS = {"A4": "a4", "US Letter": "us-letter"}
READING_QUANTITIES = {
    kind: {QUANTITY_WORDS[name]: name for name in names}
    for kind, names in (("step", STEP_READINGS), ("flight", FLIGHT_READINGS))
}
"""What can be read by hand of a step and of a flight, by the words of the menu."""
NO_PLACE = "no step yet"
_ANGLE_UNITS = ("deg", "%")
_MULTILINE = ("obstructions", "changes", "purpose", "scope", "code_reason", "stations", "limitations")
_ELSEWHERE = ("title",)
"""The title of the inspection stands above, and is that of the report."""


@dataclass(frozen=True)
class ReportActions:
    """What the folder calls."""

    on_make: Callable[[str], None]
    on_text: Callable[[FormPart, str, str], None]
    on_paper: Callable[[str], None]
    on_add_reading: Callable[[], None]
    on_order: Callable[[str], None]
    on_photo: Callable[[Any], None]
    on_logo: Callable[[Any], None]
    on_remove_logo: Callable[[], None]


class ReportFolder:
    """The controls of the folder."""

    def __init__(self, gui: viser.GuiApi, actions: ReportActions) -> None:
        self._texts: dict[tuple[FormPart, str], Any] = {}
        self._last_units: dict[tuple[str, ...], str] = {}
        with gui.add_folder("Report and drawings"):
            make = gui.add_button(
                EVERYTHING,
                icon=viser.Icon.FILE_ZIP,
                hint="PDF, HTML page, XLSX workbook, CSV, JSON, plan and section as DXF, in one ZIP.",
            )
            make.on_click(lambda _: actions.on_make(EVERYTHING))
            for label, kinds, hint in (
                ("Or one of", DOCUMENTS, None),
                ("Drawings", DRAWINGS, "In millimetres, with dimensions."),
            ):
                group: Any = gui.add_button_group(label, kinds, hint=hint)
                group.on_click(from_page(actions.on_make, partial(getattr, group, "value")))
            self.from_scene: Any = gui.add_checkbox(
                "Views of this scene",
                True,
                hint="Taken with this page, whose camera moves meanwhile; off, the program draws them without a page.",
            )
            self.paper: Any = gui.add_dropdown("Paper", tuple(PAPERS), initial_value=next(iter(PAPERS)))
            self.paper.on_update(from_page(actions.on_paper, lambda: self.paper.value))
            with gui.add_folder("Who, where, with what", expand_by_default=False):
                for title, names in FIELD_GROUPS.items():
                    own = [name for name in names if name not in _ELSEWHERE]
                    with gui.add_folder(title, expand_by_default=False):
                        self._add_texts(gui, actions, "fields", ReportFields, own)
            with gui.add_folder("Seen on site", expand_by_default=False):
                self._add_texts(gui, actions, "checklist", Checklist, Checklist.__dataclass_fields__)
            with gui.add_folder("Readings by hand", expand_by_default=False):
                self._add_readings(gui, actions)
            with gui.add_folder("Photographs", expand_by_default=False):
                self.photos = gui.add_html("")
                self.caption: Any = gui.add_text("Caption", "", hint="Of the photograph that is added next.")
                hint = "PNG or JPEG. The place and time that cameras hide in it are left out."
                _add_picture_upload(gui, "Add a photograph", hint, actions.on_photo)
            with gui.add_folder("Logo", expand_by_default=False):
                self.logo = gui.add_html("")
                self.load_logo = _add_picture_upload(gui, "Load a logo", "PNG or JPEG.", actions.on_logo)
                remove = gui.add_button("Remove the logo", icon=viser.Icon.TRASH, color="gray")
                remove.on_click(lambda _: actions.on_remove_logo())
            # Buttons of the lists write here; see markup.order_button.
            self.order: Any = gui.add_text("Order", "", visible=False)
            self.order.on_update(orders_from_page(actions.on_order, lambda: self.order.value))

    def show_basis(self, basis: ReportBasis) -> None:
        """Write what is kept into the fields."""
        for (part, name), control in self._texts.items():
            kept = getattr(getattr(basis, part), name)
            # What is being typed may end with a blank that is not kept.
            if str(control.value).strip() != kept:
                control.value = kept
        self.paper.value = next(words for words, paper in PAPERS.items() if paper == basis.paper)

    def offer_places(self, steps: Iterable[int], flights: Iterable[int]) -> None:
        """List where readings can be taken."""
        options = (*(f"step {step}" for step in steps), *(f"flight {flight}" for flight in flights)) or (NO_PLACE,)
        if tuple(self.place.options) != options:
            before = self.place.value
            self.place.options = options
            self.place.value = before if before in options else options[0]
            self._fit_menus()

    def put_back(self, part: FormPart, name: str, refused: str, kept: str) -> None:
        """Write what is kept over a text that was refused, unless another one was typed since."""
        control = self._texts[part, name]
        if control.value == refused:
            control.value = kept

    def _fit_menus(self) -> None:
        """Offer what can be read at the chosen place, in its units, and a line where there are three."""
        kind = str(self.place.value).partition(" ")[0]
        known = READING_QUANTITIES.get(kind, READING_QUANTITIES["step"])
        _offer(self.quantity, tuple(known))
        name = known.get(str(self.quantity.value), "")
        units = LENGTH_UNITS if {**STEP_READINGS, **FLIGHT_READINGS}.get(name) == "m" else _ANGLE_UNITS
        self._last_units[tuple(self.unit.options)] = str(self.unit.value)
        _offer(self.unit, units, self._last_units.get(units))
        self.line.visible = name in ON_A_LINE

    def _add_texts(
        self, gui: viser.GuiApi, actions: ReportActions, part: FormPart, kind: Any, names: Iterable[str]
    ) -> None:
        for name in names:
            control: Any = gui.add_text(
                kind.label_of(name), "", multiline=name in _MULTILINE, hint=kind.hint_of(name) or None
            )
            control.on_update(from_page(partial(actions.on_text, part, name), partial(getattr, control, "value")))
            self._texts[part, name] = control

    def _add_readings(self, gui: viser.GuiApi, actions: ReportActions) -> None:
        self.readings = gui.add_html("")
        self.place: Any = gui.add_dropdown("At", (NO_PLACE,), initial_value=NO_PLACE)
        self.quantity: Any = gui.add_dropdown("What is read", tuple(READING_QUANTITIES["step"]))
        self.value: Any = gui.add_text(
            "Reading", "", hint="A number or a fraction: 170.5, or 6 11/16. A unit behind it counts: 6 11/16 in."
        )
        self.unit: Any = gui.add_dropdown(
            "Unit", LENGTH_UNITS, initial_value="mm", hint="Where none is written. % is that of a slope."
        )
        self.u: Any = gui.add_text(
            "Its U", "", hint="Expanded, k = 2, in the unit of the reading; empty where it is not known."
        )
        self.line: Any = gui.add_dropdown(
            "On the line", get_args(Line), initial_value="centre", hint="Of a rise or going, as seen when climbing."
        )
        self.instrument: Any = gui.add_text("Instrument", "", hint="Tape, digital level, with its number.")
        self.note: Any = gui.add_text("Note", "")
        for menu in (self.place, self.quantity):
            menu.on_update(from_page(self._fit_menus))
        add = gui.add_button("Add the reading", icon=viser.Icon.PLUS)
        add.on_click(lambda _: actions.on_add_reading())


def _add_picture_upload(gui: viser.GuiApi, label: str, hint: str, take: Callable[[Any], None]) -> Any:
    upload: Any = gui.add_upload_button(label, icon=viser.Icon.PHOTO, mime_type=".png,.jpg,.jpeg", hint=hint)
    upload.on_upload(lambda _: take(upload.value))
    return upload


def _offer(menu: Any, options: tuple[str, ...], before: str | None = None) -> None:
    """Offer other options, and choose what was chosen before, or now, where it is among them."""
    if tuple(menu.options) != options:
        wanted = before or menu.value
        menu.options = options
        menu.value = wanted if wanted in options else options[0]
