"""How long a slider takes, and what our clustering and our normals save: ``python -m tests.benchmarks.speed``.

Milliseconds depend on the machine; the ratios are between two measurements of one run and hardly do.
"""

import argparse
import math
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from io import BytesIO

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.clusters import cluster_sorted, find_reach
from stair_inspector.geometry.normals import estimate_normals
from stair_inspector.geometry.open3d import load_open3d
from stair_inspector.memo import Memo
from stair_inspector.model import Scan
from stair_inspector.params import NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.camera_frames import is_view
from stair_inspector.stages.orient import POINTS_TO_COMPARE, find_normals
from stair_inspector.stages.readings import read_rhythm
from stair_inspector.stages.thinned import thin
from stair_inspector.stages.units import decide_unit
from tests.synthetic import Stair, make_scan

STAIR = Stair(n_steps=10, risers=True, noise=0.002, seed=7)
EPS_M, MIN_POINTS = 0.02, 50
SLIDERS = (
    ("alpha_f", "edges.front_percentile", (95.0, 94.5), 5.0),
    ("eps_z", "levels.eps_m", (0.02, 0.021), 60.0),
    ("m", "levels.min_points", (50, 51), 60.0),
    ("theta_th", "horizontal.theta_deg", (15.0, 14.5), 120.0),
)
"""Name, setting, the two values between which it moves, and the milliseconds that feel like at once."""
_SURVEY_SETTINGS = (
    ("edge source", "survey.edge_source", ("face", "auto"), 150.0),
    ("largest gap", "flights.max_gap_m", (0.1, 0.15), 150.0),
    ("outer lines", "survey.line_percent", (20.0, 15.0), 150.0),
    ("eps_z", "levels.eps_m", (0.021, 0.02), None),
)
_ORACLE = f"""
import io, sys, time, numpy as np
from sklearn.cluster import DBSCAN
heights = np.load(io.BytesIO(sys.stdin.buffer.read()))
began = time.perf_counter()
labels = DBSCAN(eps={EPS_M}, min_samples={MIN_POINTS}).fit(heights[:, None]).labels_
seconds = time.perf_counter() - began
np.save(sys.stdout.buffer, np.append(labels.astype(float), seconds))
"""


@dataclass(frozen=True)
class Row:
    """A line of the table; ``ratio`` is the other measurement over this one."""

    what: str
    ms: float
    budget_ms: float | None
    ratio: float | None
    compared: str

    def __str__(self):
        budget = "" if self.budget_ms is None else f"{self.budget_ms:.0f}"
        ratio = "" if self.ratio is None else f"{self.ratio:,.1f}"
        return f"{self.what:<30}{self.ms:>12,.1f}{budget:>9}{ratio:>12}  {self.compared}"


HEAD = f"{'what':<30}{'ms':>12}{'budget':>9}{'ratio':>12}  compared with"


def dense_scan(n_points: int) -> Scan:
    """The stair with about ``n_points`` points in random order, as several scan positions leave them."""
    s = STAIR
    area = s.width * (s.floor_depth + s.n_steps * (s.going + s.rise))
    # A little denser than asked for, since surfaces are cut into whole cells; the surplus is dropped at random.
    points, _ = Stair(**{**vars(s), "spacing": math.sqrt(0.98 * area / n_points)}).sample()
    order = np.random.default_rng(s.seed).permutation(len(points))[:n_points]
    return make_scan(points[order])


def time_ms(call: Callable[[], object]) -> float:
    """Milliseconds of one call."""
    began = time.perf_counter()
    call()
    return (time.perf_counter() - began) * 1000.0


def measure_sliders(scan: Scan, repeats: int) -> list[Row]:
    """Median of ``repeats`` changes of each slider with the paper's method, beside a run from scratch."""
    params = Params(up="z", unit="m", method="paper")
    memo = Memo()
    scratch_ms = time_ms(lambda: inspect(scan, params, memo))
    found = inspect(scan, params, memo).levels
    n_found = sum(level.n_points for level in found)
    rows = [Row("run from scratch", scratch_ms, None, None, f"(found {len(found)} levels with {n_found:,} points)")]
    for label, name, values, budget_ms in SLIDERS:
        # The first change fills the caches of the machine and is not counted.
        changed = [params.replaced(name, values[(k + 1) % 2]) for k in range(repeats + 1)]
        times = [time_ms(lambda settings=settings: inspect(scan, settings, memo)) for settings in changed]
        inspect(scan, params, memo)
        ms = statistics.median(times[1:])
        rows.append(Row(f"{label} change", ms, budget_ms, scratch_ms / ms, "run from scratch"))
    return rows


def measure_survey(scan: Scan, repeats: int) -> list[Row]:
    """What the survey adds to a run from scratch, and how long a change of one of its settings takes."""
    rows = []
    for up in ("auto", "z"):
        # The quicker of two runs each, in turn: the rest is what else the machine does.
        runs = {"paper": [], "survey": []}
        for method in ("paper", "survey", "paper", "survey"):
            params = Params(up=up, unit="m", method=method)
            runs[method].append(time_ms(partial(inspect, scan, params, Memo())))
        paper_ms, survey_ms = min(runs["paper"]), min(runs["survey"])
        added = 100.0 * (survey_ms / paper_ms - 1.0)
        compared = f"the paper's method {paper_ms:,.0f} ms: {added:+.0f} %"
        rows.append(Row(f"survey from scratch, up {up}", survey_ms, None, paper_ms / survey_ms, compared))
    params = Params(up="z", unit="m")
    memo = Memo()
    inspect(scan, params, memo)
    for label, name, values, budget_ms in _SURVEY_SETTINGS:
        changed = [params.replaced(name, values[k % 2]) for k in range(repeats + 1)]
        times = [time_ms(partial(inspect, scan, settings, memo)) for settings in changed]
        ms = statistics.median(times[1:])
        rows.append(Row(f"{label} change, survey", ms, budget_ms, survey_ms / ms, "survey from scratch"))
        inspect(scan, params, memo)
    return rows


def measure_deciding(scan: Scan, repeats: int) -> Row:
    """What it costs that the stair decides unit and up, beside the normals of all points."""
    began = time.perf_counter()
    normals = find_normals(scan, NormalsParams())
    normals_ms = (time.perf_counter() - began) * 1000.0

    spared = -(-len(scan.points) // POINTS_TO_COMPARE)

    def decide_up() -> None:
        thinned = thin(scan.points[::spared], normals.vectors[::spared])
        read_rhythm(thinned, priors.MOST_RISE_M, np.zeros(3), is_camera=is_view(scan, thinned.points))

    unit_ms, up_ms = (
        min(time_ms(decide) for _ in range(repeats)) for decide in (partial(decide_unit, scan.points), decide_up)
    )
    ms = unit_ms + up_ms
    compared = f"the normals {normals_ms:,.0f} ms; unit {unit_ms:,.0f} ms, up {up_ms:,.0f} ms"
    return Row("unit and up by the stair", ms, 500.0, normals_ms / ms, compared)


def measure_clustering(n_heights: int, repeats: int) -> Row:
    """Our clustering and scikit-learn's, the latter once, in a process of its own that gives its memory back."""
    rng = np.random.default_rng(STAIR.seed)
    treads = rng.integers(0, STAIR.n_steps + 1, n_heights) * STAIR.rise
    heights = np.sort(treads + rng.normal(0.0, STAIR.noise, n_heights))
    ms = statistics.median(
        time_ms(lambda: cluster_sorted(find_reach(heights, EPS_M), MIN_POINTS)) for _ in range(repeats)
    )
    what = f"clustering {n_heights:,} heights"
    run = subprocess.run(
        [sys.executable, "-c", _ORACLE],
        input=_npy(heights),
        capture_output=True,
        check=False,
    )
    if run.returncode != 0:
        return Row(what, ms, None, None, f"scikit-learn DBSCAN did not finish (exit {run.returncode}): lower --heights")
    *labels, seconds = _from_npy(run.stdout)
    clusters = cluster_sorted(find_reach(heights, EPS_M), MIN_POINTS)
    ours = np.full(n_heights, -1.0)
    for label, (start, stop) in enumerate(zip(clusters.start, clusters.stop, strict=True)):
        ours[start:stop] = label
    # Both count clusters from the lowest height upwards.
    same = bool((ours == labels).all())
    other_ms = float(seconds) * 1000.0
    return Row(what, ms, None, other_ms / ms, f"scikit-learn DBSCAN {other_ms:,.0f} ms, same clusters: {same}")


def measure_normals(scan: Scan, k: int = 30) -> Row:
    """Our normals and the same Open3D call without the sorting, both on shuffled points."""
    o3d = load_open3d()
    points = scan.points
    plain = []

    def call_open3d():
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points.copy()))
        cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(k))
        plain.append(np.asarray(cloud.normals))

    ours = []
    ms = time_ms(lambda: ours.append(estimate_normals(points, k)))
    other_ms = time_ms(call_open3d)
    identical = bool((ours[0] == plain[0]).all())
    return Row("normals", ms, None, other_ms / ms, f"plain Open3D call {other_ms:,.0f} ms, identical: {identical}")


def _npy(array: np.ndarray) -> bytes:
    stream = BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def _from_npy(data: bytes) -> np.ndarray:
    return np.load(BytesIO(data))


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.speed", description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=1_000_000, help="points of the scan (default: %(default)s)")
    parser.add_argument(
        "--heights",
        type=int,
        default=40_000,
        help="heights for scikit-learn, which lists all pairs of neighbours (default %(default)s: 1.2 GB; 0: none)",
    )
    parser.add_argument("--repeats", type=int, default=7, help="runs of which the median counts (default: %(default)s)")
    args = parser.parse_args(argv)

    scan = dense_scan(args.points)
    print(
        f"{len(scan.points):,} points, {STAIR.n_steps + 1} levels with risers, noise {STAIR.noise * 1000:g} mm; ",
        end="",
    )
    print(f"median of {args.repeats} changes")
    print(HEAD, flush=True)
    for row in measure_sliders(scan, args.repeats):
        print(row, flush=True)
    for row in measure_survey(scan, args.repeats):
        print(row, flush=True)
    print(measure_deciding(scan, args.repeats), flush=True)
    print(measure_normals(scan), flush=True)
    if args.heights:
        print(measure_clustering(args.heights, args.repeats), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
