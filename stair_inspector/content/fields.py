"""What only the inspector knows: whose stair it is, with which instrument, which readings of a tape beside the scan.

All of it is text, readings and pictures that the user gives; what is left empty is a blank to fill in the report.
"""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from stair_inspector.content.images import Photo
from stair_inspector.content.readings import TapeReading
from stair_inspector.content.texts import require_text
from stair_inspector.errors import ConfigError, brief

Paper = Literal["a4", "us-letter"]

MOST_READINGS = 200
MOST_PHOTOS = 12


def _text(label: str, hint: str = "") -> Any:
    """Return an empty text field; ``label`` stands before it in the report and on the page."""
    return field(default="", metadata={"label": label, "hint": hint})


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

    title: str = _text("Title", "Heading of the report; empty for 'Stair survey report'")
    report_number: str = _text("Report no.")
    revision: str = _text("Revision")
    client: str = _text("Client")
    site: str = _text("Site")
    building: str = _text("Building")
    stair: str = _text("Stair")
    flight: str = _text("Flight", "The flights' names on site, from bottom to top")
    level_from: str = _text("Level from")
    level_to: str = _text("Level to")
    inspector: str = _text("Inspector")
    firm: str = _text("Firm")
    licence: str = _text("Licence")
    survey_date: str = _text("Survey date")
    survey_time: str = _text("Survey time")
    weather: str = _text("Weather", "Only where the stair is outdoors")
    surface: str = _text("Surface", "Dry, wet, icy, worn")
    obstructions: str = _text("Obstructions", "What stood on or before the stair")
    changes: str = _text("Changes since the incident", "Repairs, removals, cleaning, if any")
    purpose: str = _text("Purpose")
    scope: str = _text("Scope")
    code_reason: str = _text("Reason for this code", "Why this code, edition and variant apply")
    build_date: str = _text("Date built or altered")
    occupancy: str = _text("Occupancy or use")
    instrument_make: str = _text("Make")
    instrument_model: str = _text("Model")
    instrument_serial: str = _text("Serial no.")
    instrument_accuracy: str = _text("Stated accuracy", "As the maker states it")
    calibration_date: str = _text("Calibrated on")
    interim_check_date: str = _text("Last interim check", "Interim performance assessment: its date")
    interim_check_result: str = _text("Result of the interim check")
    stations: str = _text("Stations", "How many, and where they stood")
    registration_method: str = _text("Registration method")
    registration_residual: str = _text("Registration residual")
    levelling_source: str = _text("Levelling source", "Tilt sensor, level, plumb line, reference plane")
    limitations: str = _text("Further limitations")
    signed_by: str = _text("Name")
    signed_as: str = _text("Function")
    signed_on: str = _text("Date")
    reviewed_by: str = _text("Reviewed by")
    reviewed_on: str = _text("Reviewed on")


FIELD_GROUPS: dict[str, tuple[str, ...]] = {
    "Report": ("title", "report_number", "revision"),
    "Object": ("client", "site", "building", "stair", "flight", "level_from", "level_to"),
    "Survey": ("inspector", "firm", "licence", "survey_date", "survey_time"),
    "Conditions": ("weather", "surface", "obstructions", "changes"),
    "Commission": ("purpose", "scope", "occupancy", "build_date", "code_reason"),
    "Instrument": (
        "instrument_make",
        "instrument_model",
        "instrument_serial",
        "instrument_accuracy",
        "calibration_date",
        "interim_check_date",
        "interim_check_result",
    ),
    "Scanning": ("stations", "registration_method", "registration_residual", "levelling_source"),
    "Limitations": ("limitations",),
    "Sign-off": ("signed_by", "signed_as", "signed_on", "reviewed_by", "reviewed_on"),
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
