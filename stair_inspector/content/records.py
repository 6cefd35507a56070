"""An inspection as plain values, as its JSON holds them: SI, positions in the scan frame."""

import dataclasses
from typing import Any

import numpy as np

from stair_inspector import __version__
from stair_inspector.codes import Check
from stair_inspector.content.check_records import by_name, check_record
from stair_inspector.content.comparisons import comparison_to_dict
from stair_inspector.content.finding_list import list_findings
from stair_inspector.content.finding_tables import listed_record
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.files.settings import params_to_dict
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import ComparedScan, Flight, Inspection, Measured, Patch, Statistics, Step
from stair_inspector.overrules import parse_force, parse_region, parse_up
from stair_inspector.params import Params
from stair_inspector.quantities import COMPARED, IN_FILES, ON_LINES, PAPER_QUANTITIES, PITCH, WIDTH, with_above

SCHEMA = "stair-inspector/inspection-1"


def inspection_to_dict(
    inspection: Inspection,
    check: Check | None = None,
    pinned: PinnedFindings | None = None,
    compared: ComparedScan | None = None,
) -> dict[str, Any]:
    """Return the inspection as the plain values of its JSON, with a check against a rule set if there is one.

    ``pinned`` are pins of the inspector, and what was said of findings: the list of findings holds them too.
    ``compared`` is what changed against a second scan.
    """
    listed = list_findings(inspection, check, pinned or PinnedFindings())
    origin = np.array(inspection.scan.origin_m)
    scan = inspection.scan
    axes = inspection.axes
    floor = inspection.floor
    return {
        "schema": SCHEMA,
        "software": {"name": "stair_inspector", "version": __version__},
        "scan": {
            "file": scan.name,
            **by_name(scan, "sha256", "n_points", "n_used", "unit", "origin_m"),
        },
        "examination": [dataclasses.asdict(found) for found in inspection.examination],
        "settings": params_to_dict(inspection.params),
        "normals": {"by": inspection.normals_by},
        "up": {"vector": inspection.up.vector.tolist(), "source": inspection.up.source, "u_deg": inspection.up.u_deg},
        "axes": None
        if axes is None
        else {"rule": axes.rule, "width": axes.width.tolist(), "depth": axes.depth.tolist()},
        "levels": [
            {"id": level.level_id, **by_name(level, "height_m", "n_points", "kind", "reason")}
            for level in inspection.levels
        ],
        "floor": None
        if floor is None
        else {
            "n_points": floor.n_points,
            "centroid_m": (floor.centroid + origin).tolist(),
            "normal": None if floor.normal is None else floor.normal.tolist(),
            "rms_m": floor.rms_m,
            "h_m": inspection.floor_h_m,
        },
        "patches": [_patch_to_dict(patch, origin) for patch in inspection.patches],
        "flights": [_flight_to_dict(flight) for flight in inspection.flights],
        "steps": [_step_to_dict(step, above, origin) for step, above in with_above(inspection.steps)],
        "overrules": overrule_records(inspection.params),
        "check": None if check is None else check_record(check),
        "comparison": None if compared is None else comparison_to_dict(compared.found),
        "findings": [listed_record(entry) for entry in listed],
        "notes": [by_name(note, "code", "stage", "step", "message") for note in inspection.notes],
        "timings_s": dict(inspection.timings_s),
    }


def _step_to_dict(step: Step, above: Step | None, origin: Floats) -> dict[str, Any]:
    return {
        "id": step.step_id,
        "flight": step.flight,
        "kind": step.kind,
        "n_points": step.plane.n_points,
        "centroid_m": (step.plane.centroid + origin).tolist(),
        "normal": None if step.plane.normal is None else step.plane.normal.tolist(),
        "rms_m": step.plane.rms_m,
        "paper": {quantity.column: quantity.of_paper(step.paper) for quantity in PAPER_QUANTITIES},
        **{quantity.column: _measured_to_dict(quantity.of(step, above)) for quantity in IN_FILES},
        "coverage": step.coverage,
        **{quantity.lines_field: _lcr_to_list(quantity.lines_of(step)) for quantity in ON_LINES},
        "nosing_m": None if step.nosing is None else (step.nosing + origin).tolist(),
        "line_points_m": None if step.line_points is None else (step.line_points + origin).tolist(),
        "climb": None if step.climb is None else step.climb.tolist(),
    }


def _measured_to_dict(measured: Measured | None) -> dict[str, Any] | None:
    return None if measured is None else {"value": measured.value, "u": measured.u, "parts": dict(measured.parts)}


def _lcr_to_list(values: tuple[float | None, ...]) -> list[float | None] | None:
    """Return the values on the three lines; None as a whole where none of them was measured."""
    return None if all(value is None for value in values) else list(values)


def _patch_to_dict(patch: Patch, origin: Floats) -> dict[str, Any]:
    return {
        "id": patch.patch_id,
        "level": patch.level_id,
        "kind": patch.kind,
        "step": patch.step_id,
        "reason": patch.reason,
        "height_m": patch.height_m,
        "n_points": patch.plane.n_points,
        "area_m2": patch.area_m2,
        "centroid_m": (patch.plane.centroid + origin).tolist(),
    }


def _flight_to_dict(flight: Flight) -> dict[str, Any]:
    return {
        "id": flight.flight_id,
        "steps": list(flight.step_ids),
        "n_risers": flight.n_risers,
        PITCH.column: _measured_to_dict(flight.pitch_deg),
        WIDTH.column: _measured_to_dict(flight.width_m),
        "shape": flight.shape,
        "radius_m": _measured_to_dict(flight.radius_m),
        "goes_on": flight.goes_on,
        "climb": flight.climb.tolist(),
        **{quantity.name: _statistics_to_dict(quantity.statistics_of(flight)) for quantity in COMPARED},
    }


def _statistics_to_dict(statistics: Statistics | None) -> dict[str, Any] | None:
    names = ("n", "mean", "min", "max", "range", "max_adjacent", "at")
    return None if statistics is None else by_name(statistics, *names)


def overrule_records(params: Params) -> list[dict[str, Any]]:
    """Return what the inspector decided and the method heeds, entry by entry."""
    # The paper's method knows no kinds and finds its own axes; a region only chooses the points, for either method.
    decided = [] if params.method == "paper" else _decisions_to_list(params)
    region = parse_region(params.overrules.region)
    if region is not None:
        bearing = {} if region.bearing_deg is None else {"bearing_deg": region.bearing_deg}
        decided.append({"what": "region", "low_m": list(region.low), "high_m": list(region.high), **bearing})
    return decided


def _decisions_to_list(params: Params) -> list[dict[str, Any]]:
    decided: list[dict[str, Any]] = []
    for force in parse_force(params.overrules.force):
        place = ",".join(f"{value}" for value in force.point_m) if force.target == "at" else force.number
        decided.append({"what": f"{force.target} {place}", "kind": force.kind, "reason": force.reason or None})
    climb = parse_up(params.overrules.climb, "overrules.climb")
    if climb is not None:
        decided.append({"what": "climb", "vector": list(climb)})
    return decided
