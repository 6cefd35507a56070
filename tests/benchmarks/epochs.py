"""What is found, and what is not there, between two scans of one stair: ``python -m tests.benchmarks.epochs``.

A stair of two flights is scanned by simulated tripods, once as it was built, once again from other stations, and once
with a nosing strip worn by 3 mm, a tread turned by 1 degree and the upper flight 4 mm lower. Every scan is turned and
tilted at random. For each quantity: how many values were compared, how many exceed their U, how many were called
changed where the truth is not, how many true changes were found, and in what share U holds the truth.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stair_inspector.comparison.compare import compare_scans
from stair_inspector.errors import CannotMeasure
from stair_inspector.files.cleaning import to_local_metres
from stair_inspector.model import Inspection, Scan, ScanComparison
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.layout import StepTruth
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import Building, build
from tests.benchmarks.accuracy import CLASSES, settings_for, tilted
from tests.synthetic import make_scan

BUILT = Stair(n_risers=11, landing_after=5, floor_front_m=2.0, upper_landing_m=1.5)
WORN, TURNED, SETTLED = 3, 9, 6
"""The step whose nosing is worn, the one whose tread is turned, the first of the flight that settled."""
CHANGED = replace(
    BUILT,
    wear_errors_m=f"{WORN}:0.003",
    cross_fall_errors_deg=f"{TURNED}:1",
    rise_errors_m=f"{SETTLED}:-0.004",
)
SCANNERS = {
    "noise of 1 mm": Scanner(noise_m=0.001, spacing_m=0.005, mixed_share=0.01),
    "and stations 0.5 mm off": replace(PROFILES["tls_good"], spacing_m=0.005),
}
FIRST = {"standoff_m": 1.4, "sensor_height_m": 1.7}
SECOND = {"standoff_m": 1.0, "sensor_height_m": 1.5}
_OF_TRUTH = {
    "tread_depth": "tread_depth_m",
    "nosing_overhang": "nosing_overhang_m",
    "pitch": "pitch_deg",
    "fall": "fall_deg",
    "cross_fall": "cross_fall_deg",
}
_SAME = 1e-6


@dataclass
class Count:
    """What came of the changes of one quantity."""

    n: int = 0
    n_beyond_u: int = 0
    n_false: int = 0
    n_true: int = 0
    n_found: int = 0
    n_held: int = 0
    errors: list[float] = field(default_factory=list)


def epoch(stair: Stair, scanner: Scanner, seed: int, stands: dict[str, float]) -> tuple[Scan, Inspection, Building]:
    """A scan of a stair that lies anywhere, and its inspection."""
    rng = np.random.default_rng(seed)
    turned = replace(stair, yaw_deg=float(rng.uniform(-180.0, 180.0)), offset_m=f"{rng.uniform(-9.0, 9.0):.3f},3,-1.5")
    building = build(turned)
    simulated = scan_building(building, replace(scanner, seed=seed, **stands))
    points, origin_m = to_local_metres(tilted(simulated.points, 0.05, seed), "m")
    scan = make_scan(points, origin_m=origin_m)
    return scan, inspect(scan, settings_for(CLASSES["tls_good"])), building


def true_changes(before: StepTruth, after: StepTruth) -> dict[str, float | None]:
    """The true changes of the values of a step, metres and degrees; heights of the tread's plane in its middle."""

    def change(name: str) -> float | None:
        one, two = getattr(before, name), getattr(after, name)
        return None if one is None or two is None else two - one

    found = {name: change(_OF_TRUTH.get(name, f"{name}_m")) for name in ("rise", "going", "width", *_OF_TRUTH)}
    x, y = np.mean(before.plan.outline, axis=0).tolist()
    return {**found, "height": after.top(x, y) - before.top(x, y)}


def count(found: ScanComparison, before: Building, after: Building, counts: dict[str, Count]) -> Iterator[str]:
    """Count what was said of each value; yields a line for each false change."""
    for step in found.steps:
        truths = true_changes(before.steps[step.before_id - 1], after.steps[step.after_id - 1])
        for value in (*step.values, step.height):
            true = truths[value.quantity]
            if value.change is None or true is None:
                continue
            tally = counts.setdefault(value.quantity, Count())
            error = value.change.value - true
            tally.n += 1
            tally.n_held += abs(error) <= value.change.u
            tally.n_beyond_u += abs(error) > value.change.u and abs(true) < _SAME
            tally.errors.append(error)
            if abs(true) >= _SAME:
                # A change within U cannot be told from none.
                tally.n_true += abs(true) > 2.0 * value.change.u
                tally.n_found += abs(true) > 2.0 * value.change.u and value.is_changed
            elif value.is_changed:
                tally.n_false += 1
                yield f"false: step {step.before_id} {value.quantity} {value.change}"
        tally = counts.setdefault("place on a tread", Count())
        tally.n += 1
        is_worn = after.steps[step.after_id - 1].worn_m != before.steps[step.before_id - 1].worn_m
        worst = None if step.deviations is None else step.deviations.worst_m
        tally.n_true += is_worn
        tally.n_found += is_worn and worst is not None
        if worst is not None and not is_worn:
            tally.n_false += 1
            yield f"false: step {step.before_id} place {worst}"


def table(counts: dict[str, Count]) -> Iterator[str]:
    """The result as a table in Markdown."""
    yield "| change of | compared | unchanged, beyond U | unchanged, called changed | found | U holds | 95 % |"
    yield "|---" * 7 + "|"
    for name, tally in counts.items():
        errors = np.abs(tally.errors)
        is_angle = name in ("pitch", "fall", "cross_fall")
        size = f"{np.percentile(errors, 95.0) * (1.0 if is_angle else 1000.0):.2f}" if len(errors) else "-"
        held = f"{100.0 * tally.n_held / tally.n:.1f} %" if len(errors) else "-"
        found = f"{tally.n_found} of {tally.n_true}"
        yield f"| {name} | {tally.n} | {tally.n_beyond_u} | {tally.n_false} | {found} | {held} | {size} |"


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.epochs", description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=10, help="how many pairs of scans of each kind")
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--scanners", nargs="*", default=list(SCANNERS), choices=list(SCANNERS))
    args = parser.parse_args(argv)
    for title in args.scanners:
        scanner = SCANNERS[title]
        same: dict[str, Count] = {}
        changed: dict[str, Count] = {}
        for seed in range(args.first, args.first + args.seeds):
            scan, inspection, built = epoch(BUILT, scanner, 10 * seed, FIRST)
            for stair, counts, shift in ((BUILT, same, 1), (CHANGED, changed, 2)):
                later = epoch(stair, scanner, 10 * seed + shift, SECOND)
                try:
                    found = compare_scans(scan, inspection, *later[:2])
                except CannotMeasure as error:
                    print(f"  seed {seed}: refused: {error}", flush=True)
                    continue
                print(
                    *(f"  seed {seed}: {line}" for line in count(found, built, later[2], counts)), sep="\n", flush=True
                )
                if shift == 2:
                    print(f"  seed {seed}:", "; ".join(note.message for note in found.notes), flush=True)
        print(f"\n{title}, unchanged:\n", *table(same), f"\n{title}, changed:\n", *table(changed), "", sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
