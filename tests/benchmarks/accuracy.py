"""How exact the survey is, and whether its uncertainties are true: ``python -m tests.benchmarks.accuracy``.

Simulated scans of known staircases by scanners of six classes. For each class: in how many scans the steps were found
exactly, the 95th percentile and the worst of the errors of each quantity, the share of the values whose truth lies
within value +- u, and in parentheses how many values rest on an edge that a note calls hidden, or on where along the
nosing of a winder they are taken: those count for the share but not for the errors. Then scans without a staircase, in
which no step must be found.
"""

import argparse
import fnmatch
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stair_inspector.files.cleaning import to_local_metres
from stair_inspector.files.settings import find_preset
from stair_inspector.memo import Memo
from stair_inspector.model import Inspection
from stair_inspector.params import Params, UncertaintyParams
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES, Scanner
from stair_inspector.simulation.scenes import SCENES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import Building, StepTruth, build, output_from_stair
from tests.synthetic import make_scan


@dataclass(frozen=True)
class Target:
    """Largest 95th percentile of |error| to reach, millimetres."""

    rise: float
    going: float
    depth: float
    width: float


@dataclass(frozen=True)
class Class:
    """A class of scanners: how it scans, the preset an inspector would take for it, what is to be reached."""

    title: str
    scanner: Scanner
    preset: str
    target: Target | None = None
    levelled_deg: float = 0.0
    """Standard deviation of the tilt of the whole cloud."""
    stated: UncertaintyParams | None = None
    """What the user states about this scan, where it is not what the preset says."""


CLASSES = {
    # Two stations, registered to each other, and the whole levelled by the scanner's compensator to 0.05 degrees.
    "tls_good": Class(
        "TLS good",
        replace(PROFILES["tls_good"], spacing_m=0.004),
        "tls",
        Target(0.3, 1.0, 2.0, 3.0),
        levelled_deg=0.05,
    ),
    "tls_fair": Class(
        "TLS fair",
        replace(PROFILES["tls_fair"], registration_m=0.0015, tilt_deg=0.02),
        "tls",
        Target(1.2, 2.5, 5.0, 6.0),
        levelled_deg=0.05,
        stated=UncertaintyParams(registration_m=0.00016, slope_deg=0.15, up_deg=0.01),
    ),
    "handheld": Class("hand-held", PROFILES["handheld"], "handheld", Target(2.5, 5.0, 10.0, 15.0)),
    "robot_lidar": Class("robot LiDAR", PROFILES["robot_lidar"], "robot_lidar"),
    "depth_camera": Class("depth camera", PROFILES["depth_camera"], "depth_camera"),
    "phone": Class("phone", PROFILES["phone"], "phone"),
}
EVEN = Stair(
    n_risers=10, rise_m=0.17, going_m=0.28, width_m=1.2, overhang_m=0.025, floor_front_m=2.0, upper_landing_m=2.0
)
CASES: dict[str, Stair] = {
    "even": EVEN,
    "first riser -15 mm": replace(EVEN, n_risers=9, rise_m=0.175, rise_errors_m="1:-0.015", yaw_deg=20.0),
    "top riser +32 mm": replace(EVEN, n_risers=8, rise_m=0.178, going_m=0.25, rise_errors_m="8:0.032", yaw_deg=-70.0),
    "one riser +8 mm": replace(EVEN, n_risers=9, rise_m=0.165, going_m=0.3, width_m=1.0, rise_errors_m="5:0.008"),
    "going shrinks": replace(
        EVEN, going_m=0.29, going_errors_m=",".join(f"{k}:{-0.002 * k:g}" for k in range(1, 10)), yaw_deg=135.0
    ),
    "fall and +1/4 in": replace(EVEN, fall_errors_deg="4:3.6", rise_errors_m="5:0.00635", overhang_m=0.0),
    "twist 10 mm": replace(EVEN, cross_fall_errors_deg="4:0.48,7:-0.48", skew_errors_m="6:0.01", yaw_deg=45.0),
    "three risers": replace(EVEN, n_risers=3, rise_m=0.15, going_m=0.32, width_m=1.6),
    "tread missing": replace(EVEN, open_risers=True, missing_treads="5"),
    "open risers": replace(EVEN, open_risers=True, overhang_m=0.03, going_m=0.26, rise_m=0.18, width_m=0.9),
    "two flights, landing": replace(EVEN, n_risers=13, landing_after=6, rise_m=0.16, going_m=0.3),
    "L turn": replace(EVEN, n_risers=12, landing_after=6, turn="left", width_m=1.0),
    "U turn": replace(EVEN, n_risers=14, landing_after=7, turn="u_right", width_m=1.0, rise_m=0.16),
    "twins": replace(EVEN, n_risers=7, twin_gap_m=0.25, width_m=0.9),
    "worn, strips": replace(EVEN, dish_errors_m="3:0.005,4:0.006,5:0.004", going_m=0.3),
    "strips proud": replace(EVEN, strip_proud_m=0.003, n_risers=8),
    "rounded nosings": replace(EVEN, round_nosing_m=0.01, overhang_m=0.02, n_risers=9),
    "far away, turned": replace(EVEN, n_risers=8, yaw_deg=33.0, offset_m="691000,5335000,520"),
    "wall, ceiling, clutter": replace(
        EVEN, n_risers=8, wall="left", ceiling=True, headroom_m=2.1, clutter=True, floor_width_m=2.6
    ),
    "between walls": replace(EVEN, wall="both", n_risers=11, overhang_m=0.0),
    "winder": replace(EVEN, n_risers=10, shape="winder", winder_after=3, width_m=1.0),
    "spiral": replace(EVEN, n_risers=12, shape="spiral", width_m=0.9, going_m=0.24, rise_m=0.19, open_risers=True),
}
_SEVEN = (
    "even",
    "first riser -15 mm",
    "one riser +8 mm",
    "three risers",
    "two flights, landing",
    "U turn",
    "going shrinks",
)
_WINDING = ("winder", "spiral")
PLAN: dict[str, tuple[str, ...]] = {
    "tls_good": tuple(CASES),
    "tls_fair": tuple(name for name in CASES if name not in _WINDING),
    "handheld": (*_SEVEN, "L turn", "twist 10 mm", "open risers", "between walls", "wall, ceiling, clutter"),
    "robot_lidar": _SEVEN,
    "depth_camera": _SEVEN,
    "phone": _SEVEN,
}
QUANTITIES = ("rise", "going", "depth", "width", "overhang", "pitch", "fall", "cross_fall")
_HIDDEN = {"back_hidden": ("depth", "overhang"), "side_unobserved": ("width",), "nosing_unobserved": ("going", "depth")}
"""Notes that say an edge was not seen, and what it spoils: such values count for u, but not for the errors."""
_OF_WEDGES = ("going", "depth", "width", "overhang", "pitch")
"""What depends, on a winding flight, on where along a nosing it is taken; listed apart."""
_UNIT = {"pitch": 1.0, "fall": 1.0, "cross_fall": 1.0}
_TURNING_STATIONS = 4
_NEAR_M = 0.08
"""A step that is found belongs to the true nosing nearest to its own nosing's middle, if it is as near as this."""


@dataclass
class Tally:
    """What was found in the scans of one class."""

    n_scans: int = 0
    n_exact: int = 0
    n_false: int = 0
    n_missed: int = 0
    errors: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in QUANTITIES})
    ratios: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in QUANTITIES})
    hidden: dict[str, int] = field(default_factory=lambda: dict.fromkeys(QUANTITIES, 0))
    winding: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in QUANTITIES})
    shapes: list[str] = field(default_factory=list)
    inexact: list[str] = field(default_factory=list)


def settings_for(kind: Class) -> Params:
    """The preset an inspector would take, everything else found in the scan."""
    params = replace(find_preset(kind.preset).params, unit="m")
    return params if kind.stated is None else replace(params, uncertainty=kind.stated)


def simulate(stair: Stair, scanner: Scanner, seed: int):
    """A scan and the building it is of; a stair that turns is seen from its landing too."""
    building = build(stair)
    stations = max(scanner.stations, _TURNING_STATIONS) if stair.is_turning else scanner.stations
    return scan_building(building, replace(scanner, seed=seed, stations=stations)), building


def tilted(points, degrees: float, seed: int):
    """Points turned by a random angle, of the given standard deviation, about a random level axis through the first."""
    rng = np.random.default_rng(seed)
    angle, azimuth = np.radians(degrees * rng.standard_normal()), rng.uniform(0.0, 2.0 * np.pi)
    axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    from_first = points - points[0]
    along = (from_first @ axis)[:, None] * axis
    return points[0] + along + np.cos(angle) * (from_first - along) + np.sin(angle) * np.cross(axis, from_first)


def true_values(truth: StepTruth) -> dict[str, float | None]:
    """The truth of the quantities, millimetres and degrees."""
    lengths = {
        "rise": truth.rise_m,
        "going": truth.going_m,
        "depth": truth.tread_depth_m,
        "width": truth.width_m,
        "overhang": truth.nosing_overhang_m,
    }
    values: dict[str, float | None] = {
        name: None if value is None else 1000.0 * value for name, value in lengths.items()
    }
    values |= {"pitch": truth.pitch_deg, "fall": truth.fall_deg, "cross_fall": truth.cross_fall_deg}
    return values


def found_values(step) -> dict[str, tuple[float, float] | None]:
    """The survey's values and u, millimetres and degrees."""
    names = {
        "rise": "rise_m",
        "going": "going_m",
        "depth": "tread_depth_m",
        "width": "width_m",
        "overhang": "nosing_overhang_m",
        "pitch": "pitch_deg",
        "fall": "fall_deg",
        "cross_fall": "cross_fall_deg",
    }
    result = {}
    for name, attribute in names.items():
        measured = getattr(step, attribute)
        scale = _UNIT.get(name, 1000.0)
        result[name] = None if measured is None else (scale * measured.value, scale * measured.u)
    return result


def match(inspection: Inspection, building: Building, origin_m) -> tuple[dict[int, StepTruth], int, int]:
    """The true step of every step found, how many found ones are none, and how many true ones are missing."""
    truths = [truth for truth in building.steps if not truth.is_missing]
    nosings = [output_from_stair(building.stair, np.array(truth.nosing)) for truth in truths]
    pairs, n_false = {}, 0
    free = set(range(len(truths)))
    for step in inspection.steps:
        middle = step.nosing.mean(axis=0) + origin_m
        distances = [_distance(middle, *nosing) for nosing in nosings]
        k = int(np.argmin(distances))
        if k in free and distances[k] <= _NEAR_M:
            pairs[step.step_id] = truths[k]
            free.discard(k)
        else:
            n_false += 1
    return pairs, n_false, len(free)


def _distance(point, start, end) -> float:
    """Distance of a point from a line from start to end."""
    share = np.clip((point - start) @ (end - start) / ((end - start) @ (end - start)), 0.0, 1.0)
    return float(np.linalg.norm(start + share * (end - start) - point))


def measure(name: str, stair: Stair, kind: Class, seed: int, tally: Tally, memo: Memo | None = None) -> Iterator[str]:
    """Scan, measure, compare; yields a line for every value that is off by more than twice its u."""
    simulated, building = simulate(stair, kind.scanner, seed)
    points, origin_m = to_local_metres(tilted(simulated.points, kind.levelled_deg, seed), "m")
    scan = make_scan(points, origin_m=origin_m)
    inspection = inspect(scan, settings_for(kind), memo)
    pairs, n_false, n_missed = match(inspection, building, scan.origin_m)
    tally.n_scans += 1
    tally.n_false += n_false
    tally.n_missed += n_missed
    tally.n_exact += not n_false and not n_missed
    if n_false or n_missed:
        tally.inexact.append(f"{name} ({n_false} false, {n_missed} missed)")
    hidden = {(note.step, quantity) for note in inspection.notes for quantity in _HIDDEN.get(note.code, ())}
    tally.shapes += [flight.shape for flight in inspection.flights if flight.shape != "straight"]
    winding = {step for flight in inspection.flights if flight.shape != "straight" for step in flight.step_ids}
    for step in inspection.steps:
        truth = pairs.get(step.step_id)
        if truth is None:
            continue
        true, found = true_values(truth), found_values(step)
        for quantity in QUANTITIES:
            if true[quantity] is None or found[quantity] is None:
                continue
            # The upper landing's depth and the turning landing's sides are those of the floor, not of a step.
            if truth.kind == "landing" and quantity in ("depth", "width", "overhang", "going", "pitch"):
                continue
            # A worn tread has no one slope.
            if truth.dish_m and quantity in ("fall", "cross_fall"):
                continue
            value, u = found[quantity]
            error = value - true[quantity]
            tally.ratios[quantity].append(error / u)
            if step.step_id in winding and quantity in _OF_WEDGES:
                tally.winding[quantity].append(error)
            elif (step.step_id, quantity) in hidden:
                tally.hidden[quantity] += 1
            else:
                tally.errors[quantity].append(error)
            if abs(error) > 2.0 * u:
                yield f"    {name}: step {truth.step_id} {quantity} {value:.2f} u {u:.2f}, true {true[quantity]:.2f}"


def table(tallies: dict[str, Tally]) -> Iterator[str]:
    """The result as a table in Markdown."""
    yield "| scanner | scans | steps exact | false | missed | " + " | ".join(QUANTITIES) + " |"
    yield "|---" * (5 + len(QUANTITIES)) + "|"
    for key, tally in tallies.items():
        cells = []
        for name in QUANTITIES:
            errors, ratios = np.abs(tally.errors[name]), np.abs(tally.ratios[name])
            if not len(errors):
                cells.append("-")
                continue
            inside = 100.0 * float(np.mean(ratios <= 1.0))
            n_apart = tally.hidden[name] + len(tally.winding[name])
            hidden = f" ({n_apart})" if n_apart else ""
            cells.append(f"{np.percentile(errors, 95.0):.2f} / {errors.max():.1f} / {inside:.0f} %{hidden}")
        row = (CLASSES[key].title, tally.n_scans, tally.n_exact, tally.n_false, tally.n_missed, *cells)
        yield "| " + " | ".join(str(cell) for cell in row) + " |"


def run(
    wanted: Sequence[str], cases: str, make_memo: Callable[[], Memo | None], verbose: bool, seed: int = 100
) -> dict[str, Tally]:
    """Measure all cases of the wanted classes."""
    tallies = {}
    for key in wanted:
        tally = tallies[key] = Tally()
        for index, name in enumerate(PLAN[key]):
            if not fnmatch.fnmatch(name, cases):
                continue
            began = time.perf_counter()
            lines = list(measure(name, CASES[name], CLASSES[key], seed + index, tally, make_memo()))
            if verbose:
                print(f"  {key}: {name} ({time.perf_counter() - began:.1f} s)", *lines, sep="\n", flush=True)
    return tallies


def run_negatives(wanted: Sequence[str]) -> Iterator[str]:
    """Scan buildings without a staircase; yields the steps found in each and the reason given."""
    for key in wanted:
        for index, (name, make) in enumerate(SCENES.items()):
            simulated = scan_building(make(), replace(CLASSES[key].scanner, seed=500 + index))
            inspection = inspect(make_scan(simulated.points), settings_for(CLASSES[key]))
            reason = next((note.message for note in inspection.notes if note.code == "no_staircase"), "")
            yield f"{CLASSES[key].title}, {name}: {len(inspection.steps)} steps. {reason}"


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.accuracy", description=__doc__.splitlines()[0])
    parser.add_argument("--classes", nargs="*", default=list(CLASSES), choices=list(CLASSES))
    parser.add_argument("--cases", default="*", help="only cases whose name matches this pattern")
    parser.add_argument("--seed", type=int, default=100, help="of the first scan: another one makes other scans")
    parser.add_argument("--verbose", action="store_true", help="name every scan, and every value beyond twice its u")
    args = parser.parse_args(argv)
    tallies = run(args.classes, args.cases, lambda: None, args.verbose, args.seed)
    print("95th percentile of |error| / worst |error| / share within u (values listed apart); mm and degrees\n")
    print(*table(tallies), sep="\n")
    for key, tally in tallies.items():
        if tally.inexact:
            print(f"{CLASSES[key].title}, steps not exact: {'; '.join(tally.inexact)}")
        if tally.shapes:
            worst = ", ".join(f"{name} {np.abs(found).max():.0f}" for name, found in tally.winding.items() if found)
            print(f"{CLASSES[key].title}, flights found to wind: {', '.join(tally.shapes)}; worst |error|: {worst}")
    for key, tally in tallies.items():
        target = CLASSES[key].target
        for name in ("rise", "going", "depth", "width") if target else ():
            reached = float(np.percentile(np.abs(tally.errors[name]), 95.0)) if tally.errors[name] else np.nan
            wanted = getattr(target, name)
            verdict = "reached" if reached <= wanted else "NOT reached"
            print(f"{CLASSES[key].title}, {name}: {reached:.2f} mm, {verdict} ({wanted:g} mm)")
    print("\nscans without a staircase:")
    print(*run_negatives(args.classes), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
