"""Writes simulated scans: the point cloud, and its truth beside it."""

import dataclasses
import json
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from stair_inspector.errors import ConfigError
from stair_inspector.files.atomic import write_all_atomically
from stair_inspector.files.ply import ply_bytes
from stair_inspector.geometry.arrays import Floats
from stair_inspector.simulation.samples import SAMPLES
from stair_inspector.simulation.scanner import SimulatedScan, scan
from stair_inspector.simulation.scanner_specs import Scanner
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build, output_from_stair

TRUTH_SCHEMA = "stair-inspector/truth-1"

# Single precision resolves 0.01 mm up to here; farther away coordinates need double precision.
_SINGLE_REACH_M = 64.0
# A nanometre: hides the last binary digits of sums such as 3 * 0.17.
_TRUTH_DECIMALS = 9


def simulate_to_file(path: Path, stair: Stair, scanner: Scanner) -> list[Path]:
    """Build a staircase, scan it and write both files.

    Parameters
    ----------
    path : Path
        The scan, ending in ``.ply``; the truth goes to ``STEM.truth.json`` beside it.
    stair, scanner
        What is built, and how it is scanned.

    Returns
    -------
    list of Path
        The scan and the truth.

    Raises
    ------
    ConfigError
        The name does not end in ``.ply``, or the scanner sees nothing.
    WriteError
        The files cannot be written.
    """
    _check_name(path)
    return write_simulation(path, scan(build(stair), scanner))


def write_simulation(path: Path, simulated: SimulatedScan) -> list[Path]:
    """Write a simulated scan as binary PLY and its truth as JSON.

    Parameters
    ----------
    path : Path
        The scan, ending in ``.ply``; the truth goes to ``STEM.truth.json`` beside it.
    simulated : SimulatedScan
        Its points are written in metres, in single precision within 64 m of the origin, in double precision beyond.

    Returns
    -------
    list of Path
        The scan and the truth.

    Raises
    ------
    ConfigError
        The name does not end in ``.ply``, or there are no points.
    WriteError
        A file cannot be written.
    """
    _check_name(path)
    if not len(simulated.points):
        raise ConfigError(
            "scanner: no ray returns a point; give a longer range_max_m, a wider field of view or a finer grid"
        )
    truth_path = path.with_suffix(".truth.json")
    is_far = float(np.abs(simulated.points).max()) > _SINGLE_REACH_M
    text = json.dumps(truth_of(simulated), indent=2, sort_keys=True, allow_nan=False) + "\n"
    write_all_atomically(
        {path: ply_bytes(simulated.points, simulated.colors, double=is_far), truth_path: text.encode("ascii")}
    )
    return [path, truth_path]


def write_samples(folder: Path) -> list[Path]:
    """Write all bundled sample scans; the same bytes every time.

    Parameters
    ----------
    folder : Path
        Made if missing; files of the same names are replaced.

    Returns
    -------
    list of Path
        Every scan, each followed by its truth.

    Raises
    ------
    WriteError
        A file cannot be written.
    """
    written: list[Path] = []
    for name, (stair, scanner) in SAMPLES.items():
        written += write_simulation(folder / f"{name}.ply", scan(build(stair), scanner))
    return written


_CURVED_CONVENTIONS = {
    "going_m": "Horizontal, from the middle of the nosing of this step to that of the next, along the arc through them "
    "about the centre of the curve; null for the upper landing.",
    "going_lcr_m": "The same through 15, 50 and 85 % of the nosing's length from the left.",
    "rise_lcr_m": "At 15, 50 and 85 % of the nosing's length from the left, along those arcs.",
}


def truth_of(simulated: SimulatedScan) -> dict[str, Any]:
    """Return the truth of a simulated scan as plain values for JSON, positions in the output frame.

    ``nosing_m`` runs from left to right as seen when climbing. A step's ``rise_m`` is the rise to it, its ``going_m``
    the going from it to the next, null for the upper landing and for a landing that turns. ``n_points`` counts the
    points on its top. A scene without a staircase has no steps; its ``stair`` is null and ``scene`` its name.
    """
    building, stair = simulated.building, simulated.building.stair
    directions_only = None if stair is None else dataclasses.replace(stair, offset_m="0,0,0")
    steps = []
    for step in building.steps:
        steps.append(
            {
                "id": step.step_id,
                "flight": step.flight,
                "kind": step.kind,
                "shape": step.shape,
                "is_missing": step.is_missing,
                "rise_m": _tidy(step.rise_m),
                "going_m": None if step.going_m is None else _tidy(step.going_m),
                "tread_depth_m": _tidy(step.tread_depth_m),
                "width_m": _tidy(step.width_m),
                "nosing_overhang_m": _tidy(step.nosing_overhang_m),
                "height_m": _tidy(step.height_m),
                "fall_deg": step.fall_deg,
                "cross_fall_deg": step.cross_fall_deg,
                "dish_m": step.dish_m,
                "worn_m": step.worn_m,
                "rise_lcr_m": _tidy_all(step.rise_lcr_m),
                "going_lcr_m": None if step.going_lcr_m is None else _tidy_all(step.going_lcr_m),
                "pitch_deg": None if step.pitch_deg is None else _tidy(step.pitch_deg),
                "climb": _rows(output_from_stair(directions_only, np.array([[*step.climb, 0.0]])))[0],
                "nosing_m": _rows(output_from_stair(stair, np.array(step.nosing))),
                "n_points": int((simulated.labels == step.step_id).sum()),
            }
        )
    stations = [
        {
            "position_m": _rows(output_from_stair(stair, np.array([station.position])))[0],
            "shift_m": _rows(output_from_stair(directions_only, np.array([station.shift_m])))[0],
            "tilt_deg": _tidy(math.degrees(station.tilt_rad)),
            "n_points": int((simulated.station_ids == index).sum()),
        }
        for index, station in enumerate(simulated.stations)
    ]
    return {
        "schema": TRUTH_SCHEMA,
        "conventions": {
            "levels": "Level 0 is the floor; step k is the level reached over riser k; the last is the upper landing.",
            "rise_m": "Vertical, from the nosing below (or the floor, or a landing that turns, at the foot of the "
            "riser) to the nosing of this step, at mid-width.",
            "rise_lcr_m": "The same at 15, 50 and 85 % of the nosing's length from the left, along the line of climb.",
            "going_m": "Horizontal, from the nosing of this step to the next, at mid-width; null for the upper landing "
            "and for a landing that turns. For wedge treads, and on the three lines, square to this step's nosing.",
            "going_lcr_m": "At 15, 50 and 85 % of the nosing's length from the left.",
            "pitch_deg": "Angle of the line to the next nosing, from the next rise and this going.",
            "climb": "Unit vector up the stair at this step, seen from above.",
            "is_missing": "The step is not built; its measures are those it would have, its neighbours' are to it.",
            "tread_depth_m": "From the nosing to the face of the riser above, or to the back edge.",
            "height_m": "Height of the nosing at mid-width above the floor: of the strip where it stands proud, of the "
            "tread's plane where it is worn by worn_m; where "
            "the edge is rounded, of the line where the plane of the tread meets the upright in front.",
            "nosing_m": "Left and right end, as seen when climbing.",
            **(_CURVED_CONVENTIONS if stair is not None and stair.shape == "curved" else {}),
        },
        "frame": {
            "up": [0.0, 0.0, 1.0],
            "climb": _rows(output_from_stair(directions_only, np.array([[1.0, 0.0, 0.0]])))[0],
            "foot_m": _rows(output_from_stair(stair, np.zeros((1, 3))))[0],
        },
        "scan": {
            "n_points": len(simulated.points),
            "n_floor": int((simulated.labels == 0).sum()),
            "n_mixed": int(simulated.is_mixed.sum()),
        },
        "scene": building.scene or None,
        "stair": None if stair is None else _stair_to_dict(stair),
        "scanner": dataclasses.asdict(simulated.scanner),
        "stations": stations,
        "flights": [
            {
                "id": flight,
                "steps": [step.step_id for step in building.steps if step.flight == flight],
                "n_risers": sum(step.flight == flight for step in building.steps),
                "shape": next(
                    (s.shape for s in building.steps if s.flight == flight and s.shape != "straight"), "straight"
                ),
            }
            for flight in sorted({step.flight for step in building.steps})
        ],
        "steps": steps,
    }


def _stair_to_dict(stair: Stair) -> dict[str, Any]:
    """Return a staircase's settings; what only a curved one has is left out of all others."""
    values = dataclasses.asdict(stair)
    return values if stair.shape == "curved" else {name: values[name] for name in values if name != "curve_radius_m"}


def _check_name(path: Path) -> None:
    if path.suffix.lower() != ".ply":
        raise ConfigError(f"{path}: a simulated scan is a PLY file; give a name that ends in .ply")


def _tidy(value: float) -> float:
    # Adding zero turns -0.0 into 0.0.
    return round(float(value), _TRUTH_DECIMALS) + 0.0


def _tidy_all(values: Iterable[float]) -> list[float]:
    return [_tidy(value) for value in values]


def _rows(points: Floats) -> list[list[float]]:
    return [_tidy_all(row) for row in points.tolist()]
