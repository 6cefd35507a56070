"""What only the inspector knows: whose stair it is, with which instrument, which readings of a tape beside the scan.

All of it is text, readings and pictures that the user gives; what is left empty is a blank to fill in the report.
"""

import dataclasses
import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from stair_inspector.content.images import Photo
from stair_inspector.content.readings import TapeReading
from stair_inspector.content.texts import require_text
from stair_inspector.errors import ConfigError, brief

Paper = Literal["a4", "us-letter"]
TextKind = Literal["line", "lines", "date", "time"]
"""What is written into a field: one line, several, or one that looks like a date or a time."""

MOST_READINGS = 200
MOST_PHOTOS = 12


def _text(label: str, hint: str = "", *, group: str = "", kind: TextKind = "line") -> Any:
    """Return an empty text field; ``label`` stands before it in the report and on the page, ``group`` over it."""
    return field(default="", metadata={"label": label, "hint": hint, "group": group, "kind": kind})


@dataclass(frozen=True, slots=True)
class _Texts:
    """Texts that are checked and stripped when they are made; each has a label and a hint."""

    def __post_init__(self) -> None:
        for item in dataclasses.fields(self):
            object.__setattr__(self, item.name, require_text(getattr(self, item.name), item.name))

    @classmethod
    def label_of(cls, name: str) -> str:
        """Return how the field is called in the report and on the page."""
        return str(_metadata(cls, name)["label"])

    @classmethod
    def hint_of(cls, name: str) -> str:
        """Return what belongs into the field, empty where the label says it."""
        return str(_metadata(cls, name)["hint"])

    @classmethod
    def kind_of(cls, name: str) -> TextKind:
        """Return what is written into the field."""
        kind: TextKind = _metadata(cls, name)["kind"]
        return kind


def _metadata(kind: type[_Texts], name: str) -> Mapping[str, Any]:
    return next(item.metadata for item in dataclasses.fields(kind) if item.name == name)


@dataclass(frozen=True, slots=True)
class ReportFields(_Texts):
    """Identity, instrument and sign-off: one text each, empty for a blank to fill.

    Raises
    ------
    ConfigError
        A field is no text, too long, or holds what :func:`require_text` refuses.
    """

    title: str = _text("Title", "Heading of the report; empty for 'Stair survey report'", group="Report")
    report_number: str = _text("Report no.", group="Report")
    revision: str = _text("Revision", group="Report")
    client: str = _text("Client", group="Object")
    site: str = _text("Site", group="Object")
    building: str = _text("Building", group="Object")
    stair: str = _text("Stair", group="Object")
    flight: str = _text("Flight", "The flights' names on site, from bottom to top", group="Object")
    level_from: str = _text("Level from", group="Object")
    level_to: str = _text("Level to", group="Object")
    inspector: str = _text("Inspector", group="Survey")
    firm: str = _text("Firm", group="Survey")
    licence: str = _text("Licence", group="Survey")
    survey_date: str = _text("Survey date", group="Survey", kind="date")
    survey_time: str = _text("Survey time", group="Survey", kind="time")
    weather: str = _text("Weather", "Only where the stair is outdoors", group="Conditions")
    surface: str = _text("Surface", "Dry, wet, icy, worn", group="Conditions")
    obstructions: str = _text("Obstructions", "What stood on or before the stair", group="Conditions", kind="lines")
    changes: str = _text(
        "Changes since the incident", "Repairs, removals, cleaning, if any", group="Conditions", kind="lines"
    )
    purpose: str = _text("Purpose", group="Commission", kind="lines")
    scope: str = _text("Scope", group="Commission", kind="lines")
    occupancy: str = _text("Occupancy or use", group="Commission")
    build_date: str = _text("Date built or altered", group="Commission", kind="date")
    code_reason: str = _text(
        "Reason for this code", "Why this code, edition and variant apply", group="Commission", kind="lines"
    )
    instrument_make: str = _text("Make", group="Instrument")
    instrument_model: str = _text("Model", group="Instrument")
    instrument_serial: str = _text("Serial no.", group="Instrument")
    instrument_accuracy: str = _text("Stated accuracy", "As the maker states it", group="Instrument")
    calibration_date: str = _text("Calibrated on", group="Instrument", kind="date")
    interim_check_date: str = _text(
        "Last interim check", "Interim performance assessment: its date", group="Instrument", kind="date"
    )
    interim_check_result: str = _text("Result of the interim check", group="Instrument")
    stations: str = _text("Stations", "How many, and where they stood", group="Scanning", kind="lines")
    registration_method: str = _text("Registration method", group="Scanning")
    registration_residual: str = _text("Registration residual", group="Scanning")
    levelling_source: str = _text(
        "Levelling source", "Tilt sensor, level, plumb line, reference plane", group="Scanning"
    )
    limitations: str = _text("Further limitations", group="Limitations", kind="lines")
    signed_by: str = _text("Name", group="Sign-off")
    signed_as: str = _text("Function", group="Sign-off")
    signed_on: str = _text("Date", group="Sign-off", kind="date")
    reviewed_by: str = _text("Reviewed by", group="Sign-off")
    reviewed_on: str = _text("Reviewed on", group="Sign-off", kind="date")


FIELD_GROUPS: dict[str, tuple[str, ...]] = {
    group: tuple(item.name for item in items)
    for group, items in itertools.groupby(dataclasses.fields(ReportFields), key=lambda item: item.metadata["group"])
}
"""Every field of :class:`ReportFields`, in the order and the groups of the report and the page."""
OF_THE_SURVEYOR = ("inspector", "firm", "licence", *FIELD_GROUPS["Instrument"])
"""Fields that are the same for the next stair of a survey."""


@dataclass(frozen=True, slots=True)
class Checklist(_Texts):
    """What no scan of treads shows, seen by eye or by hand: one text each, empty for *not assessed*.

    Raises
    ------
    ConfigError
        As :class:`ReportFields`.
    """

    slip_resistance: str = _text("Slip resistance of treads and nosings")
    nosing_contrast: str = _text("Contrast and visibility of the nosings")
    lighting: str = _text("Lighting and its switches")
    handrails: str = _text("Handrails: height, grip, continuity, extensions")
    guards: str = _text("Guards: height, openings, strength")
    clear_width: str = _text("Clear width between handrails or walls")
    headroom: str = _text("Headroom")
    landings: str = _text("Landings: size, doors that swing over them")
    tactile: str = _text("Tactile warning surfaces and signs")
    condition: str = _text("Condition: loose, cracked or worn parts, drainage")
    structure: str = _text("Structural capacity and fire resistance")


@dataclass(frozen=True, slots=True)
class ReportBasis:
    """All that a report takes from the user: fields, checklist, readings, logo (:func:`read_logo`), photos, paper."""

    fields: ReportFields = field(default_factory=ReportFields)
    checklist: Checklist = field(default_factory=Checklist)
    readings: tuple[TapeReading, ...] = ()
    logo: bytes | None = None
    photos: tuple[Photo, ...] = ()
    paper: Paper = "a4"

    def __post_init__(self) -> None:
        if self.paper not in get_args(Paper):
            raise ConfigError(f"paper: got {brief(self.paper)}; give one of {', '.join(get_args(Paper))}")
        for name, most in (("readings", MOST_READINGS), ("photos", MOST_PHOTOS)):
            entries = tuple(getattr(self, name))
            if len(entries) > most:
                raise ConfigError(f"{name}: {len(entries)} entries; give at most {most}")
            object.__setattr__(self, name, entries)
