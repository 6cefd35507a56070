"""What sliders do to what is measured: ``python -m tests.benchmarks.sweeps [SCAN ...]``, the samples without any.

Each of theta_th, eps_z, k and m is moved over its useful range, the others at their defaults, on the whole scan and
within a region around its stair. For each run is printed whether the steps are those of the defaults, how many of its
values lie within its own u of the plateau's value, which is the median over the runs, and how many values no staircase
has.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stair_inspector import priors
from stair_inspector.errors import StairError
from stair_inspector.files.scans import read_scan
from stair_inspector.files.settings import find_preset
from stair_inspector.memo import Memo
from stair_inspector.model import Inspection, Measured, Scan
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import SURVEY_VALUES

SWEPT: dict[str, tuple[float, ...]] = {
    "horizontal.theta_deg": (8.0, 11.0, 20.0, 25.0),
    "levels.eps_m": (0.004, 0.006, 0.01, 0.03, 0.04),
    "normals.k": (20, 40, 60),
    "levels.min_points": (20, 100, 200, 400),
}
_SAME_STEP_M = 0.1
_AROUND_M, _BEFORE_M = 0.3, 0.6
_LENGTHS = ("rise_m", "going_m", "tread_depth_m", "width_m")


@dataclass(frozen=True, slots=True)
class Run:
    """One run of a sweep: how its steps, by place, and its values compare with those of the plateau.

    ``n_within_u`` values lie within the run's own u of the plateau's value, ``n_within_default`` of the defaults'.
    """

    setting: str
    value: float
    n_lost: int
    n_more: int
    n_within_u: int
    n_within_default: int
    n_compared: int
    n_impossible: int
    worst: str


Values = dict[tuple[int, str], Measured]
"""A run's values by the step of the defaults' run that lies at the same place, and by quantity."""


def sweep(scan: Scan, params: Params, region: str = "") -> Iterator[Run]:
    """Yield the runs of all sweeps of a scan, within a region or on the whole of it.

    The plateau's value is the median over all runs and that of the defaults: no single run is the truth.
    """
    memo = Memo()
    plain = inspect(scan, params, memo)
    params = params.replaced("overrules.region", region)
    runs = [
        (name, value, inspect(scan, params.replaced(name, value), memo))
        for name, values in SWEPT.items()
        for value in values
    ]
    defaults, _ = values_at(plain, plain)
    every = [values_at(plain, found) for _, _, found in runs]
    plateau = {
        key: float(np.median([own.value, *(values[key].value for values, _ in every if key in values)]))
        for key, own in defaults.items()
    }
    for (name, value, found), (values, n_more) in zip(runs, every, strict=True):
        shared = [key for key in values if key in plateau]
        off = {key: abs(values[key].value - plateau[key]) for key in shared}
        moved = {key: abs(values[key].value - defaults[key].value) for key in shared}
        beyond = [key for key in shared if off[key] > values[key].u]
        worst = max(beyond, key=lambda key: off[key] / max(values[key].u, 1e-12), default=None)
        yield Run(
            name,
            value,
            len(plain.steps) - len({step_id for step_id, _ in values}),
            n_more,
            len(shared) - len(beyond),
            sum(moved[key] <= values[key].u for key in shared),
            len(shared),
            n_impossible(found),
            "" if worst is None else _said(worst, plateau[worst], values[worst]),
        )


def values_at(plain: Inspection, found: Inspection) -> tuple[Values, int]:
    """Return the values of a run at the places of the defaults' steps, and how many steps lie elsewhere."""
    known = np.array([step.plane.centroid for step in plain.steps]).reshape(-1, 3)
    values: Values = {}
    n_more = 0
    for step in found.steps:
        gaps = np.linalg.norm(known - step.plane.centroid, axis=1)
        if not len(gaps) or gaps.min() > _SAME_STEP_M:
            n_more += 1
            continue
        number = plain.steps[int(gaps.argmin())].step_id
        measured = {name: getattr(step, name) for name in SURVEY_VALUES}
        values |= {(number, name): each for name, each in measured.items() if each is not None}
    return values, n_more


def _said(key: tuple[int, str], plateau: float, found: Measured) -> str:
    return f"{key[1]} of step {key[0]}: {plateau:.4f} -> {found.value:.4f} ± {found.u:.4f}"


def n_impossible(found: Inspection) -> int:
    """Return how many values no staircase has: lengths that are not positive, and steps steeper than any."""
    lengths = [getattr(step, name) for step in found.steps for name in _LENGTHS]
    pitches = [step.pitch_deg for step in found.steps if step.pitch_deg is not None]
    return sum(length is not None and length.value <= 0.0 for length in lengths) + sum(
        pitch.value > priors.STEEPEST_PITCH_DEG for pitch in pitches
    )


def region_around(scan: Scan, inspection: Inspection) -> str:
    """Return a region around what was measured, with room for the floor in front of it; empty without steps."""
    if not inspection.steps:
        return ""
    corners = np.concatenate([step.corners for step in inspection.steps]) + scan.origin_m
    first = inspection.steps[0]
    before = first.corners + scan.origin_m - _BEFORE_M * (np.zeros(3) if first.climb is None else first.climb)
    every = np.concatenate([corners, before])
    low, high = every.min(axis=0) - _AROUND_M, every.max(axis=0) + _AROUND_M
    return ",".join(f"{value:.3f}" for value in (*low, *high))


def main(arguments: list[str] | None = None) -> int:
    """Print the sweeps; exit with 1 where a run has an impossible value."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*", type=Path)
    parser.add_argument("--preset", default="", help="begin with the settings of this preset")
    options = parser.parse_args(arguments)
    samples = Path(__file__).parents[2] / "sample_scans"
    n_within = n_default = n_all = impossible = 0
    for path in options.scans or sorted(samples.glob("*.ply")):
        try:
            scan = read_scan(path)
            params = find_preset(options.preset).params if options.preset else Params()
            plain = inspect(scan, params)
        except StairError as error:
            print(f"{path.name}: {error}")
            continue
        around = region_around(scan, plain)
        for region in ("", around) if around else ("",):
            print(
                f"{path.name}, {len(plain.steps)} steps, {'region ' + region if region else 'whole scan'}", flush=True
            )
            for run in sweep(scan, params, region):
                n_within, n_all = n_within + run.n_within_u, n_all + run.n_compared
                n_default += run.n_within_default
                impossible += run.n_impossible
                share = f"{run.n_within_u}/{run.n_compared}"
                print(
                    f"  {run.setting} {run.value:g}: lost {run.n_lost}, more {run.n_more}, within u {share}, "
                    f"impossible {run.n_impossible}{'; ' + run.worst if run.worst else ''}",
                    flush=True,
                )
    print(
        f"within u of the plateau: {n_within} of {n_all} ({100.0 * n_within / max(n_all, 1):.1f} %), of the defaults' "
        f"run: {n_default} ({100.0 * n_default / max(n_all, 1):.1f} %); impossible values: {impossible}"
    )
    return int(impossible > 0)


if __name__ == "__main__":
    sys.exit(main())
