"""Every setting, declared once: its type, default, range, unit, help, and where the page has its control.

Flags, help, sliders and fields, presets, the schema of the JSON, sweeps and checks all come from here. To add a
setting, add a field to the group of the stage that reads it; see :mod:`stair_inspector.declarations`.
"""

import dataclasses
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, NamedTuple, get_args

from stair_inspector import priors
from stair_inspector.columns import parse_columns
from stair_inspector.declarations import (
    DEGREES,
    MM,
    PERCENTILE,
    SQUARE_METRES,
    Catalogue,
    DisplayUnit,
    Group,
    Knob,
    Setting,
    check_fields,
    parse_box,
)
from stair_inspector.errors import ConfigError
from stair_inspector.overrules import OverrulesParams, parse_up
from stair_inspector.stated_uncertainty import UncertaintyParams

Method = Literal["survey", "paper"]
Stations = Literal["auto", "as_read"]
AxesRule = Literal["auto", "global", "per_step"]
KnownUnit = Literal["m", "cm", "mm", "in", "ft"]
KNOWN_UNITS: tuple[KnownUnit, ...] = get_args(KnownUnit)
ScanUnit = Literal["auto", "m", "cm", "mm", "in", "ft"]
NormalsSource = Literal["estimate", "given"]
EdgeSource = Literal["auto", "tread", "face"]


@dataclass(frozen=True)
class NormalsParams(Group):
    """Surface normals."""

    k: Annotated[
        int,
        Knob("neighbours", 5, 300, 1, symbol="k", place="tune", rank=1, swept=3).says(
            "Neighbours for a normal {range}. More smooths noise and rounds edges."
        ),
    ] = 30
    source: Annotated[
        NormalsSource,
        Setting("Normals", place="scan").says(
            "'estimate' computes normals as the paper does; 'given' takes those stored in the scan."
        ),
    ] = "estimate"


@dataclass(frozen=True)
class FloorParams(Group):
    """RANSAC floor plane; used only when the up vector is 'auto'."""

    distance_m: Annotated[
        float,
        Knob("floor tolerance", 0.001, 0.1, 0.001, MM).says(
            "Distance within which a point belongs to the floor plane, {range}."
        ),
    ] = 0.01


@dataclass(frozen=True)
class HorizontalParams(Group):
    """Which points lie on a horizontal surface."""

    theta_deg: Annotated[
        float,
        Knob("normal tolerance", 1.0, 60.0, 0.5, DEGREES, symbol="θ_th", place="tune", swept=2, is_tried=True).says(
            "theta_th: largest angle between a normal and the up vector, {range}."
        ),
    ] = 15.0


@dataclass(frozen=True)
class LevelsParams(Group):
    """One-dimensional DBSCAN on height."""

    eps_m: Annotated[
        float,
        Knob("vertical reach", 0.001, 0.1, 0.001, MM, symbol="ε_z", place="tune", swept=1, is_tried=True).says(
            "eps_z: vertical reach of DBSCAN, {range}. Smaller than half a riser, larger than the noise."
        ),
    ] = 0.02
    min_points: Annotated[
        int,
        Knob("points in reach", 1, 5000, 1, symbol="m", place="tune", swept=1, is_tried=True).says(
            "m: smallest neighbourhood of a core point, the point itself included {range}."
        ),
    ] = 50


@dataclass(frozen=True)
class AxesParams(Group):
    """Width and depth directions."""

    rule: Annotated[
        AxesRule,
        Setting("Axes rule", place="heights").says(
            "PCA of all step points together ('global'), of each step centred ('per_step'), or 'auto': "
            "per_step, checked against the direction in which the steps rise; with --method paper 'auto' means "
            "'global'."
        ),
    ] = "auto"


@dataclass(frozen=True)
class EdgesParams(Group):
    """Percentiles that place the edges of the paper's columns; the survey finds its own."""

    front_percentile: Annotated[
        float,
        Knob("front edge", 51.0, 100.0, 0.5, PERCENTILE, symbol="paper's α_f", place="tune", swept=2).says(
            "alpha_f: percentile of depth that is the front edge {range}. Paper's columns only."
        ),
    ] = 95.0
    back_percentile: Annotated[
        float,
        Knob("back edge", 0.0, 49.0, 0.5, PERCENTILE, symbol="paper's α_b", place="tune", swept=2).says(
            "alpha_b: percentile of depth that is the back edge {range}. Paper's columns only."
        ),
    ] = 5.0
    side_percentile: Annotated[
        float,
        Knob("paper's side", 51.0, 100.0, 0.5, PERCENTILE, place="tune", swept=2).says(
            "Percentile of width that is one side edge; the other is its complement {range}. Paper's columns only."
        ),
    ] = 99.0


@dataclass(frozen=True)
class PatchesParams(Group):
    """Surfaces of equal height that lie apart in plan (survey)."""

    cell_m: Annotated[
        float,
        Knob("plan cell", 0.005, 0.1, 0.001, MM, place="survey", swept=4).says(
            "Plan cell for telling surfaces of equal height apart, {range}; larger for a coarse scan."
        ),
    ] = 0.02
    min_area_m2: Annotated[
        float,
        Knob("smallest surface", 0.0, 1.0, 0.005, SQUARE_METRES, swept=4).says(
            "Smallest surface that can be a tread, {range}."
        ),
    ] = priors.SMALLEST_TREAD_M2


@dataclass(frozen=True)
class FlightsParams(Group):
    """How surfaces chain into flights (survey)."""

    min_rise_m: Annotated[
        float, Knob("smallest rise", 0.03, 0.2, 0.005, MM).says("Smallest rise between two steps, {range}.")
    ] = priors.LEAST_RISE_M
    max_rise_m: Annotated[
        float, Knob("largest rise", 0.2, 0.6, 0.005, MM).says("Largest rise between two steps, {range}.")
    ] = priors.MOST_RISE_M
    max_gap_m: Annotated[
        float,
        Knob("largest gap", 0.02, 0.5, 0.01, MM, place="survey", swept=4).says(
            "Largest gap in plan between two steps that follow each other, {range}, as a shadow leaves it."
        ),
    ] = 0.15
    turn_deg: Annotated[
        float,
        Knob("largest turn", 5.0, 60.0, 1.0, DEGREES, place="survey").says(
            "Largest turn of the direction of climb from one step to the next, {range}."
        ),
    ] = priors.MOST_TURN_DEG
    min_risers: Annotated[
        int, Knob("fewest risers", 1, 10, 1).says("Fewest risers that make a flight {range}; one alone is a kerb.")
    ] = 2

    @property
    def at_least_usual(self) -> "FlightsParams":
        """These limits or the defaults, whichever are wider: for what narrower limits must not move, as up."""
        usual = FlightsParams()
        return dataclasses.replace(
            usual,
            min_rise_m=min(self.min_rise_m, usual.min_rise_m),
            max_rise_m=max(self.max_rise_m, usual.max_rise_m),
            max_gap_m=max(self.max_gap_m, usual.max_gap_m),
            turn_deg=max(self.turn_deg, usual.turn_deg),
        )


@dataclass(frozen=True)
class SurveyParams(Group):
    """Where the survey takes its edges and lines."""

    edge_source: Annotated[
        EdgeSource,
        Setting("Edges from", place="survey").says(
            "Evidence for an edge: the upright face below or above it ('face'), the extent of the tread "
            "('tread'), or 'auto': the face where it is seen, else the tread."
        ),
    ] = "auto"
    line_percent: Annotated[
        float,
        Knob("outer lines", 2.0, 45.0, 1.0, DisplayUnit("percent of the width", "%"), place="survey").says(
            "Distance of the left and right measuring line from the side edges, {range}."
        ),
    ] = 15.0
    band_m: Annotated[
        float,
        Knob("tread tolerance", 0.0, 0.1, 0.001, MM, place="survey", swept=4).says(
            "Distance from a tread's plane within which points belong to it, {range}; 0 takes 3 sigma."
        ),
    ] = 0.0

    @property
    def of_edges(self) -> "SurveyParams":
        """What of these settings places the edges: a change of the rest leaves them where they are."""
        return dataclasses.replace(self, line_percent=SurveyParams.line_percent)


@dataclass(frozen=True)
class DisplayParams(Group):
    """What is kept to be looked at."""

    nearest_k: Annotated[
        int,
        Knob("points at a centre", 0, 1000, 1, symbol="K").says(
            "K: points kept around each step's centre for display {range}."
        ),
    ] = 50


class FileReading(NamedTuple):
    """The settings that a file is read with: where they are the same, so is the scan."""

    unit: ScanUnit = "auto"
    station: str = ""
    columns: str = "auto"
    crop: str = ""
    detail_m: float = 0.0


@dataclass(frozen=True)
class Params:
    """All settings of one inspection, grouped by the stage that reads them."""

    method: Annotated[
        Method,
        Setting("Method", place="scan").says(
            "'paper' is the published method and nothing else; 'survey' is the measurement for real stairs."
        ),
    ] = "survey"
    up: Annotated[
        str,
        Setting("Up", place="scan").says(
            'Up direction in the scan\'s frame: auto (RANSAC floor), x, y, z, -x, -y, -z, or three numbers "0.1,0,1".'
        ),
    ] = "auto"
    unit: Annotated[
        ScanUnit,
        Setting("Unit of the file", place="scan").says(
            "Unit of the scan's coordinates; 'auto' guesses from the size and says so."
        ),
    ] = "auto"
    station: Annotated[
        str,
        Setting("Station", place="scene").says(
            "Name, or number as #2, of the one station that is measured; '' takes all together."
        ),
    ] = ""
    columns: Annotated[
        str,
        Setting("Columns of the file", place="scan").says(
            "Columns of a text, as -,x,y,z,r,g,b; '-' skips one, others are intensity, nx, ny, nz; 'auto' by names."
        ),
    ] = "auto"
    crop: Annotated[
        str,
        Setting("Part of the file", place="scan").says(
            "Box of the file that is read, xmin,ymin,zmin,xmax,ymax,zmax in its coordinates (glTF: z up); '' reads all."
        ),
    ] = ""
    detail_m: Annotated[
        float,
        Knob("detail", 0.0, 1.0, 0.001, MM, place="more").says(
            "Of a COPC only what points about so far apart need is read, {range}; 0 reads every point."
        ),
    ] = 0.0
    stations: Annotated[
        Stations,
        Setting("Stations", place="scan").says(
            "'auto' lays stations onto each other where file or order tells them, 'as_read' moves no point (survey)."
        ),
    ] = "auto"
    normals: NormalsParams = field(default_factory=NormalsParams)
    floor: FloorParams = field(default_factory=FloorParams)
    horizontal: HorizontalParams = field(default_factory=HorizontalParams)
    levels: LevelsParams = field(default_factory=LevelsParams)
    axes: AxesParams = field(default_factory=AxesParams)
    edges: EdgesParams = field(default_factory=EdgesParams)
    patches: PatchesParams = field(default_factory=PatchesParams)
    flights: FlightsParams = field(default_factory=FlightsParams)
    survey: SurveyParams = field(default_factory=SurveyParams)
    uncertainty: UncertaintyParams = field(default_factory=UncertaintyParams)
    overrules: OverrulesParams = field(default_factory=OverrulesParams)
    display: DisplayParams = field(default_factory=DisplayParams)

    def __post_init__(self) -> None:
        check_fields(self)
        parse_up(self.up)
        parse_columns(self.columns)
        parse_box(self.crop, "crop", "the file's own coordinates")

    @property
    def reading(self) -> FileReading:
        """The settings that the file is read with."""
        return FileReading(*(self.value(name) for name in FileReading._fields))

    def value(self, name: str) -> Any:
        """Return the value of the setting with the dotted ``name`` (``levels.eps_m``)."""
        group, _, field_name = name.rpartition(".")
        return getattr(getattr(self, group) if group else self, field_name)

    def replaced(self, name: str, value: object) -> "Params":
        """Return a copy in which the setting with the dotted ``name`` (``levels.eps_m``) has another value.

        Raises
        ------
        ConfigError
            No such setting, wrong type, or out of range.
        """
        if name not in SETTINGS:
            raise ConfigError(f"{name}: unknown setting")
        group, _, field_name = name.rpartition(".")
        changes: dict[str, Any] = {field_name: value}
        if group:
            changes = {group: dataclasses.replace(getattr(self, group), **changes)}
        return dataclasses.replace(self, **changes)


SETTINGS = Catalogue(Params)
"""Every setting by its dotted name (``levels.eps_m``)."""
GROUPS = SETTINGS.groups
"""The settings groups by their name in flags, TOML and JSON."""
