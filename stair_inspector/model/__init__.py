"""Every immutable value that passes between the rooms; no algorithm.

``from stair_inspector.model import Scan`` is the one way in; only the files of this room import each other. A new value
goes into the file of its kind, and its name into the two lists here.

Arrays are float64, contiguous and read-only unless a line says otherwise. "Local" coordinates are metres in the
scan's own axes with ``Scan.origin_m`` subtracted; the scan frame has it added again.
"""

from stair_inspector.model.comparison import (
    ComparedScan,
    EpochAlignment,
    ScanComparison,
    StepChange,
    TreadDeviations,
    ValueChange,
)
from stair_inspector.model.heights import (
    FLOOR_LABEL,
    NON_STAIR_LABEL,
    HeightOrder,
    HeightProfile,
    Horizontal,
    Level,
    Levels,
    Normals,
    NormalsBy,
    Up,
)
from stair_inspector.model.inspection import Inspection, ScanSummary
from stair_inspector.model.notes import (
    BLURRED,
    CUT_BACK,
    CUT_FRONT,
    CUT_SIDES,
    IMPOSSIBLE,
    NO_NOSING,
    Note,
    Observation,
)
from stair_inspector.model.paper import Axes, Edges, Extents, NearestPoints, PaperValues
from stair_inspector.model.scan import Examination, Moved, ReadPart, Scan, ScanStations
from stair_inspector.model.shapes import Arc, LocalPlane, StepShape
from stair_inspector.model.steps import COVERAGE_FACTOR, Flight, Measured, Statistics, Step
from stair_inspector.model.surfaces import NO_CHAINS, Chain, Chains, Patch, Patches, Surface, Surfaces

__all__ = [
    "BLURRED",
    "COVERAGE_FACTOR",
    "CUT_BACK",
    "CUT_FRONT",
    "CUT_SIDES",
    "FLOOR_LABEL",
    "IMPOSSIBLE",
    "NON_STAIR_LABEL",
    "NO_CHAINS",
    "NO_NOSING",
    "Arc",
    "Axes",
    "Chain",
    "Chains",
    "ComparedScan",
    "Edges",
    "EpochAlignment",
    "Examination",
    "Extents",
    "Flight",
    "HeightOrder",
    "HeightProfile",
    "Horizontal",
    "Inspection",
    "Level",
    "Levels",
    "LocalPlane",
    "Measured",
    "Moved",
    "NearestPoints",
    "Normals",
    "NormalsBy",
    "Note",
    "Observation",
    "PaperValues",
    "Patch",
    "Patches",
    "ReadPart",
    "Scan",
    "ScanComparison",
    "ScanStations",
    "ScanSummary",
    "Statistics",
    "Step",
    "StepChange",
    "StepShape",
    "Surface",
    "Surfaces",
    "TreadDeviations",
    "Up",
    "ValueChange",
]
