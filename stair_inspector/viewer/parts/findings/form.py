"""The fields of a pin and of a remark: for a new pin, or for the finding that was chosen in the list."""

import dataclasses
import datetime
import uuid
from collections.abc import Callable

import viser

from stair_inspector.content.finding_list import ListedFinding
from stair_inspector.content.images import Photo
from stair_inspector.content.pins import (
    LONGEST_PIN_TEXT,
    PIN_SEVERITIES,
    FindingDecision,
    Pin,
    read_pin_photo,
)
from stair_inspector.content.step_places import middle_of
from stair_inspector.errors import ConfigError, one_of
from stair_inspector.geometry.arrays import Point
from stair_inspector.pictures.frames import step_of
from stair_inspector.viewer.bridge.markup import aside
from stair_inspector.viewer.bridge.widgets import File
from stair_inspector.viewer.parts.findings.list_html import chosen_html
from stair_inspector.viewer.parts.part import Context

_PICTURES = ".png,.jpg,.jpeg"
_SET, _KEEP = "Set the pin", "Keep what is written"


class FindingForm:
    """Sets pins, and keeps what is written about a finding.

    Parameters
    ----------
    context : Context
        Of the page.
    chosen : callable
        Returns the finding that was chosen in the list; None for a new pin.
    leave : callable
        Chooses none.
    """

    def __init__(self, context: Context, chosen: Callable[[], ListedFinding | None], leave: Callable[[], None]) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self._chosen = chosen
        self._place: Point | None = None
        self._photo: Photo | None = None
        self._frame: tuple[str, str] | None = None
        # Which finding the fields were last filled from: what is being typed is not written over.
        self._filled = ""
        widgets = context.widgets
        self._head = widgets.html()
        self.words = widgets.text("Words", is_multiline=True, hint="What was found; of the program's, your remark.")
        self.severity = widgets.dropdown(
            "Severity", PIN_SEVERITIES, chosen="minor", hint="Of the finding, in list, report and BCF."
        )
        self.who = widgets.text("By", hint="Your name; empty for the inspector of the report.")
        self.pick = widgets.button(
            "Pick a point", self.start_picking, icon=viser.Icon.CURRENT_LOCATION, hint="Then shift-click it. Key I."
        )
        self.photograph = widgets.upload(
            "Photograph",
            _PICTURES,
            self.take_photo,
            icon=viser.Icon.PHOTO,
            hint="PNG or JPEG, kept small. The place and time that cameras hide in it are left out.",
        )
        self._told = widgets.html()
        self.keep = widgets.button(
            _SET, self.submit, icon=viser.Icon.FLAG, hint="Keeps what is written here with the project."
        )
        self.leave = widgets.button(
            "Back to a new pin", leave, hint="Leaves the chosen finding as it is.", is_quiet=True, is_visible=False
        )

    # What a person asks for.

    def start_picking(self) -> None:
        """Let the next shift-click in the scene say where the pin is."""
        with self._desk.lock:
            self._desk.result("pin")
            self._desk.point_taker = self._take
            self._say("Shift-click the point in the scene.")

    def stop_picking(self) -> bool:
        """Give up picking, or forget the point; return whether there was one."""
        with self._desk.lock:
            is_picking = self._desk.stop_taking(self._take)
            had = is_picking or self._place is not None
            self._place = None
            if had:
                self._say("")
                self.show()
            return had

    def take_photo(self, file: File) -> None:
        """Keep an uploaded picture with the chosen pin, or for the new one."""
        photo = read_pin_photo(file.content, f"photograph {str(file.name)[:60]!r}")
        with self._desk.lock:
            entry = self._chosen()
            if entry is None:
                self._photo = photo
                self.show()
            else:
                pin = self._pin_of(entry, "photograph: goes with a pin")
                self._keep_pin(f"photograph of finding {entry.number}", dataclasses.replace(pin, photo=photo))

    def submit(self) -> None:
        """Set the new pin, or keep what is written about the chosen finding."""
        with self._desk.lock:
            entry = self._chosen()
            severity = one_of(self.severity.value, PIN_SEVERITIES, "severity")
            words = str(self.words.value)
            if entry is None:
                self._set_pin(words)
            elif entry.is_pin:
                pin = self._pin_of(entry, "finding")
                changed = dataclasses.replace(pin, text=words, severity=severity, who=self._who())
                self._keep_pin(f"finding {entry.number}", changed)
            else:

                def written(before: FindingDecision) -> FindingDecision:
                    # The program's own severity stays its own where it is left as it is.
                    own = before.severity is None and severity == entry.severity
                    return dataclasses.replace(before, remark=words, severity=None if own else severity)

                self.decide(entry, written)

    def decide(self, entry: ListedFinding, change: Callable[[FindingDecision], FindingDecision]) -> None:
        """Keep what is said of a finding of the program: ``change`` gets what was said of it before."""
        known = next((each for each in self._editor.work.findings.decisions if each.key == entry.key), None)
        before = known or FindingDecision(entry.key)
        if entry.kind != "gone":
            text = entry.text[: LONGEST_PIN_TEXT - 1]
            before = dataclasses.replace(before, where=entry.where, text=text)
        decision = dataclasses.replace(change(before), who=self._who(), decided_at=_now())
        self._editor.edit(f"finding {entry.number}", lambda work: {"findings": work.findings.with_decision(decision)})

    def set_done(self, entry: ListedFinding, is_done: bool) -> None:
        """Mark a finding as done, or as open again."""
        if entry.is_pin:
            pin = dataclasses.replace(self._pin_of(entry, "finding"), is_done=is_done)
            self._keep_pin(f"finding {entry.number}", pin)
        else:
            self.decide(entry, lambda before: dataclasses.replace(before, is_done=is_done))

    # What is shown.

    def show(self) -> None:
        """Show what the fields are about; the desk is held."""
        if self._frame != self._desk.frame:
            # A point or a photograph of another scan is none of this one.
            self._frame, self._place, self._photo = self._desk.frame, None, None
            self._desk.stop_taking(self._take)
            self._say("")
        entry = self._chosen()
        self._head.content = chosen_html(entry, self._place_words(), self._photo)
        self.keep.label = _SET if entry is None else _KEEP
        self.leave.visible, self.pick.visible = entry is not None, entry is None
        self.photograph.visible = entry is None or entry.is_pin
        key = "" if entry is None else entry.key
        if key != self._filled:
            self._filled = key
            self.words.value = "" if entry is None else entry.text if entry.is_pin else entry.remark
            self.severity.value = "minor" if entry is None else entry.severity

    def _set_pin(self, words: str) -> None:
        inspection = self._desk.result("pin").inspection
        step = step_of(inspection, self._desk.selected) if self._place is None else None
        if self._place is None and step is None:
            raise ConfigError("pin: choose a step or pick a point first")
        place = self._place or (middle_of(inspection, step) if step is not None else (0.0, 0.0, 0.0))
        pin = Pin(
            str(uuid.uuid4()),
            words,
            one_of(self.severity.value, PIN_SEVERITIES, "severity"),
            place,
            None if step is None else step.step_id,
            who=self._who(),
            made_at=_now(),
            photo=self._photo,
        )
        where = "a point" if step is None else f"step {step.step_id}"
        self._keep_pin(f"pin at {where}", pin)
        self._place = self._photo = None
        self.words.value = ""
        self._say("")
        self.show()

    def _pin_of(self, entry: ListedFinding, what: str) -> Pin:
        pin = next((pin for pin in self._editor.work.findings.pins if pin.guid == entry.key), None)
        if pin is None:
            raise ConfigError(f"{what}; choose a pin of the list, or set a new one")
        return pin

    def _keep_pin(self, words: str, pin: Pin) -> None:
        self._editor.edit(words, lambda work: {"findings": work.findings.with_pin(pin)})

    def _take(self, place_m: Point) -> None:
        """Take a point that was picked; the desk is held."""
        self._desk.point_taker = None
        self._place = place_m
        self._say("")
        self.show()

    def _place_words(self) -> str:
        if self._place is not None:
            return f"({', '.join(f'{value:.3f}' for value in self._place)}) m"
        step_id = self._desk.selected
        return "no place yet" if step_id is None else f"step {step_id}"

    def _who(self) -> str:
        return str(self.who.value).strip() or self._editor.work.basis.fields.inspector[:100]

    def _say(self, words: str) -> None:
        self._told.content = aside("pin-told", words) if words else ""


def _now() -> str:
    """Return the time of the server's clock, ISO 8601 with its offset."""
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")
