"""An inspection as JSON, CSV and a coloured debug PLY."""

import csv
import dataclasses
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from stair_inspector import __version__
from stair_inspector.codes import Check
from stair_inspector.files.atomic import write_all_atomically
from stair_inspector.files.check_records import check_record
from stair_inspector.files.palettes import Palette, Rgb, read_palette
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.settings import params_to_dict
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import (
    SURVEY_VALUES,
    Flight,
    Inspection,
    Measured,
    PaperValues,
    Patch,
    Scan,
    Statistics,
    Step,
)
from stair_inspector.params import Params, parse_force, parse_region, parse_up

SCHEMA = "stair-inspector/inspection-1"
_EDGE_SPACING_M = 0.002
_EDGE_POINTS = 2000
"""Distance of the points that draw an edge in the debug PLY, and the most of them: a wrong unit makes long edges."""
_LINES = ("left", "centre", "right")
"""The measuring lines as seen when climbing, in the order of ``rise_lcr_m`` and ``going_lcr_m``."""


def write_inspection(
    scan: Scan, inspection: Inspection, folder: Path, stem: str, check: Check | None = None
) -> list[Path]:
    """Write ``STEM.json``, ``STEM.csv`` and ``STEM_debug.ply`` into a folder, each completely or not at all.

    A check against a rule set goes into the JSON.

    Raises
    ------
    WriteError
        The folder cannot be written; files that existed are untouched.
    """
    paths = result_paths(folder, stem)
    contents = (json_bytes(inspection, check), csv_bytes(inspection), debug_ply_bytes(scan, inspection))
    write_all_atomically(dict(zip(paths, contents, strict=True)))
    return list(paths)


def result_paths(folder: Path, stem: str) -> tuple[Path, Path, Path]:
    """Return where the JSON, the CSV and the debug PLY of a scan with this stem go."""
    return folder / f"{stem}.json", folder / f"{stem}.csv", folder / f"{stem}_debug.ply"


def json_bytes(inspection: Inspection, check: Check | None = None) -> bytes:
    """Return the inspection as JSON, schema ``stair-inspector/inspection-1``: SI, positions in the scan frame.

    A check against a rule set is its field ``check``, null without one.
    """
    text = json.dumps(inspection_to_dict(inspection, check), indent=1, ensure_ascii=False, allow_nan=False)
    # A lone surrogate, as in a file name that is no UTF-8, cannot be encoded: it is written as an escape.
    return (text + "\n").encode("utf-8", errors="backslashreplace")


def inspection_to_dict(inspection: Inspection, check: Check | None = None) -> dict[str, Any]:
    """Return the inspection as the plain values of its JSON, with a check against a rule set if there is one."""
    origin = np.array(inspection.scan.origin_m)
    scan = inspection.scan
    axes = inspection.axes
    floor = inspection.floor
    return {
        "schema": SCHEMA,
        "software": {"name": "stair_inspector", "version": __version__},
        "scan": {
            "file": scan.name,
            "sha256": scan.sha256,
            "n_points": scan.n_points,
            "n_used": scan.n_used,
            "unit": scan.unit,
            "origin_m": list(scan.origin_m),
        },
        "examination": [dataclasses.asdict(found) for found in inspection.examination],
        "settings": params_to_dict(inspection.params),
        "up": {"vector": inspection.up.vector.tolist(), "source": inspection.up.source, "u_deg": inspection.up.u_deg},
        "axes": None
        if axes is None
        else {"rule": axes.rule, "width": axes.width.tolist(), "depth": axes.depth.tolist()},
        "levels": [
            {
                "id": level.level_id,
                "height_m": level.height_m,
                "n_points": level.n_points,
                "kind": level.kind,
                "reason": level.reason,
            }
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
        "steps": [_step_to_dict(step, origin) for step in inspection.steps],
        "overrules": _overrules_to_list(inspection.params),
        "check": None if check is None else check_record(check),
        "notes": [
            {"code": note.code, "stage": note.stage, "step": note.step, "message": note.message}
            for note in inspection.notes
        ],
        "timings_s": dict(inspection.timings_s),
    }


def csv_bytes(inspection: Inspection) -> bytes:
    """Return one row per step, lengths in millimetres and angles in degrees, the unit in each column's name."""
    rows = [_step_to_row(step) for step in inspection.steps]
    stream = io.StringIO(newline="")
    writer = csv.DictWriter(stream, CSV_COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue().encode("utf-8")


def debug_ply_bytes(scan: Scan, inspection: Inspection, palette: Palette | None = None) -> bytes:
    """Return the scan in the paper's colours, with its edges drawn as rows of extra points (step 11 of the paper).

    Where the survey has measured, each step's nosing line and its three measuring lines are drawn too: the going from
    the nosing along the climb, the rise from the nosing down.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    palette : Palette, optional
        By default the paper's: floor gray, non-stair black, steps in turn red, orange, yellow, green, blue, indigo,
        violet; front edge and nosing line pink, back edge black, side edges gray, the K points nearest to each centre
        black, measuring lines turquoise.

    Returns
    -------
    bytes
        Binary PLY, float64 coordinates in metres in the scan frame; the scan's used points first, then the edges.
    """
    palette = palette or read_palette("paper")
    # Rejected levels have no step: they are drawn as what they are, not part of a stair.
    highest = max((step.step_id for step in inspection.steps), default=0)
    labels = np.where(inspection.labels > highest, -1, inspection.labels).astype(np.int16)
    colors = palette.of_labels(labels)
    extra_points: list[Floats] = []
    extra_colors = []
    for step in inspection.steps:
        colors[step.nearest_ids] = palette.centre
        for start, stop, color in _drawn_lines(step, inspection.up.vector, palette):
            row = _points_along(start, stop)
            extra_points.append(row)
            extra_colors.append(np.tile(np.array(color, dtype=np.uint8), (len(row), 1)))
    points = np.vstack([scan.points, *extra_points]) + scan.origin_m
    return ply_bytes(points, np.vstack([colors, *extra_colors]))


def _drawn_lines(step: Step, up: Floats, palette: Palette) -> list[tuple[Floats, Floats, Rgb]]:
    """Return start, stop and colour of every line that is drawn of a step, local coordinates."""
    front_left, front_right, back_right, back_left = step.corners
    lines = [
        (front_left, front_right, palette.front_edge),
        (back_left, back_right, palette.back_edge),
        (front_left, back_left, palette.side_edge),
        (front_right, back_right, palette.side_edge),
    ]
    if step.nosing is not None:
        lines.append((step.nosing[0], step.nosing[1], palette.front_edge))
    return lines + [(start, stop, palette.measure) for start, stop in _measuring_lines(step, up)]


def _measuring_lines(step: Step, up: Floats) -> list[tuple[Floats, Floats]]:
    """Return start and stop of each going and rise that was measured on the left, centre and right line."""
    if step.line_points is None:
        return []
    lines = []
    for point, going_m, rise_m in zip(step.line_points, _lcr(step.going_lcr_m), _lcr(step.rise_lcr_m), strict=True):
        if going_m is not None and step.climb is not None:
            lines.append((point, point + going_m * step.climb))
        if rise_m is not None:
            lines.append((point, point - rise_m * up))
    return lines


def _lcr(values_m: tuple[float | None, ...] | None) -> tuple[float | None, ...]:
    """Return the value on each measuring line, None where there is none."""
    return (None,) * len(_LINES) if values_m is None else values_m


def _points_along(start: Floats, stop: Floats) -> Floats:
    count = int(min(_EDGE_POINTS, max(2.0, np.ceil(np.linalg.norm(stop - start) / _EDGE_SPACING_M) + 1.0)))
    points: Floats = start + np.linspace(0.0, 1.0, count)[:, None] * (stop - start)
    return points


def _step_to_dict(step: Step, origin: Floats) -> dict[str, Any]:
    return {
        "id": step.step_id,
        "flight": step.flight,
        "kind": step.kind,
        "n_points": step.plane.n_points,
        "centroid_m": (step.plane.centroid + origin).tolist(),
        "normal": None if step.plane.normal is None else step.plane.normal.tolist(),
        "rms_m": step.plane.rms_m,
        "paper": dataclasses.asdict(step.paper),
        **{name: _measured_to_dict(getattr(step, name)) for name in SURVEY_VALUES},
        "coverage": step.coverage,
        "rise_lcr_m": _lcr_to_list(step.rise_lcr_m),
        "going_lcr_m": _lcr_to_list(step.going_lcr_m),
        "nosing_m": None if step.nosing is None else (step.nosing + origin).tolist(),
        "line_points_m": None if step.line_points is None else (step.line_points + origin).tolist(),
        "climb": None if step.climb is None else step.climb.tolist(),
    }


def _measured_to_dict(measured: Measured | None) -> dict[str, Any] | None:
    return None if measured is None else {"value": measured.value, "u": measured.u, "parts": dict(measured.parts)}


def _lcr_to_list(values_m: tuple[float | None, ...] | None) -> list[float | None] | None:
    """Return the values on the three lines; None as a whole where none of them was measured."""
    values = _lcr(values_m)
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
        "pitch_deg": _measured_to_dict(flight.pitch_deg),
        "width_m": _measured_to_dict(flight.width_m),
        "shape": flight.shape,
        "radius_m": _measured_to_dict(flight.radius_m),
        "goes_on": flight.goes_on,
        "climb": flight.climb.tolist(),
        "rise": _statistics_to_dict(flight.rise),
        "going": _statistics_to_dict(flight.going),
    }


def _statistics_to_dict(statistics: Statistics | None) -> dict[str, Any] | None:
    if statistics is None:
        return None
    return {
        "n": statistics.n,
        "mean": statistics.mean,
        "min": statistics.min,
        "max": statistics.max,
        "range": statistics.range,
        "max_adjacent": statistics.max_adjacent,
        "at": None if statistics.at is None else list(statistics.at),
    }


def _overrules_to_list(params: Params) -> list[dict[str, Any]]:
    """Return what the inspector decided and the method heeds, entry by entry."""
    # The paper's method knows no kinds and finds its own axes; a region only chooses the points, for either method.
    decided = [] if params.method == "paper" else _decisions_to_list(params)
    region = parse_region(params.overrules.region)
    if region is not None:
        low, high = region
        decided.append({"what": "region", "low_m": list(low), "high_m": list(high)})
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


def _step_to_row(step: Step) -> dict[str, Any]:
    """Return a step's cells by column, lengths turned from metres to millimetres."""
    values: list[Any] = [step.step_id, step.flight, step.kind, step.plane.n_points, step.plane.rms_m]
    values += dataclasses.astuple(step.paper)
    for name in SURVEY_VALUES:
        measured: Measured | None = getattr(step, name)
        values += [None, None] if measured is None else [measured.value, measured.u]
    values += [step.coverage, *_lcr(step.rise_lcr_m), *_lcr(step.going_lcr_m)]
    return {
        _column(name): _millimetres(value) if name.endswith("_m") else value
        for name, value in zip(_QUANTITIES, values, strict=True)
    }


def _column(name: str) -> str:
    """Return a quantity's name in the table's unit: millimetres for metres."""
    return name.removesuffix("_m") + "_mm" if name.endswith("_m") else name


def _millimetres(value_m: float | None) -> float | None:
    # Nanometres are enough, and keep 0.1 m from becoming 100.00000000000001 mm.
    return None if value_m is None else round(value_m * 1000.0, 6)


def _with_uncertainty(name: str) -> tuple[str, str]:
    stem, unit = name.rsplit("_", 1)
    return name, f"{stem}_u_{unit}"


_QUANTITIES = (
    *("step", "flight", "kind", "n_points", "rms_m"),
    *(f"paper_{item.name}" for item in dataclasses.fields(PaperValues)),
    *(column for name in SURVEY_VALUES for column in _with_uncertainty(name)),
    "coverage",
    *(f"{quantity}_{line}_m" for quantity in ("rise", "going") for line in _LINES),
)

CSV_COLUMNS = [_column(name) for name in _QUANTITIES]
"""Names of the CSV's columns, in order."""
