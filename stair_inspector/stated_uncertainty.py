"""What the user states about how uncertain a scan is, beyond what can be seen in it."""

from dataclasses import dataclass
from typing import Annotated

from stair_inspector.declarations import DEGREES, MM, PERCENT, Group, Knob


@dataclass(frozen=True)
class UncertaintyParams(Group):
    """What the user states about the scan, as standard uncertainties (k = 1); it enters every u (survey)."""

    registration_m: Annotated[
        float,
        Knob("registration", 0.0, 0.05, 0.0001, MM, place="survey").says(
            "Standard uncertainty that registration and drift add from one step to the next, {range}."
        ),
    ] = 0.0
    edge_m: Annotated[
        float,
        Knob("edges", 0.0, 0.05, 0.0005, MM).says(
            "Standard uncertainty of a nosing or back edge that the scanner rounds or displaces, {range}."
        ),
    ] = 0.0
    side_m: Annotated[
        float,
        Knob("sides", 0.0, 0.05, 0.0005, MM).says(
            "Standard uncertainty of a tread's side edge that the scanner rounds or displaces, {range}."
        ),
    ] = 0.0
    slope_deg: Annotated[
        float,
        Knob("slopes", 0.0, 5.0, 0.01, DEGREES).says(
            "Standard uncertainty of a tread's fall that stations or passes of the scanner leave, {range}."
        ),
    ] = 0.0
    up_deg: Annotated[
        float,
        Knob("up", 0.0, 5.0, 0.01, DEGREES, place="survey").says(
            "Standard uncertainty of the up direction beyond what the scan shows, {range}."
        ),
    ] = 0.0
    scale_percent: Annotated[
        float,
        Knob("scale", 0.0, 5.0, 0.05, PERCENT, place="survey").says(
            "Standard uncertainty of the scan's scale, {range}."
        ),
    ] = 0.0
