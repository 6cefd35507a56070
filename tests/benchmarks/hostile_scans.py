"""What is made of scans as people really have them: ``python -m tests.benchmarks.hostile_scans``.

Scans of known staircases, spoilt in the ways in which real files are: coordinates on a step, turned and in other units,
seen by a depth camera or from the foot alone, sparse, of stations that do not fit, of stairs that curve or are made of
bars, and scenes without a staircase. Each goes through a file and the reader, as a user's would. For each kind is
counted, scan by scan:

- right: every tread, nine of ten values within u, and u small enough to be of use;
- honest: not right, but u covers what is off, or a sentence names what was not measured;
- withheld: a question is asked, or there is no staircase by a sentence that says why, and no value is given;
- confidently wrong: a step that is none, a tread that is missing without a word, or a value off by more than twice its
  u and by more than matters;
- false verdicts: an even stair judged outside, or an uneven one within.
"""

import argparse
import fnmatch
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from stair_inspector.codes import Verdict, check
from stair_inspector.errors import CannotMeasure, ReadError
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.files.scans import read_scan
from stair_inspector.files.settings import find_preset
from stair_inspector.model import Inspection
from stair_inspector.pipeline import inspect
from tests.benchmarks.hostile_kinds import KINDS, Variant

RULE_SETS = ("us-ibc-2024", "us-nfpa-101-uniformity", "us-osha-1910-25")
_NEAR_M = 0.08
"""A step that is found belongs to the true nosing nearest to its own nosing's middle, if it is as near as this or as
the u of its goings allows."""
_NEAR_UNMEASURED_M = 0.14
"""The same of a step from whose nosing nothing is measured: half a going."""
QUANTITIES = {"rise": "rise_m", "going": "going_m", "width": "width_m"}
_MATTERS_MM = {"rise": 1.0, "going": 2.0, "width": 5.0}
"""What a value may be off beyond twice its u without being called wrong: an inspector's tape does no better."""
_USEFUL_MM = {"rise": 5.0, "going": 10.0}
"""Median u up to which a scan's values are of use."""
_LARGE_U_MM = 20.0
"""A going whose u is larger says little: how many are is printed beside how many lie within it."""
_MOST_BEYOND = 0.1
_TOLD = (
    "tread_missing",
    "treads_missing",
    "goes_on",
    "end_unseen",
    "scan_ends",
    "step_blurred",
    "foot_unclear",
    "foot_tall",
    "settings_do_not_fit",
    "withheld",
)
"""Notes that say that treads are there and not measured."""


@dataclass
class Tally:
    """How many scans of a kind ended how, the values' errors as shares of their u, and the u of the goings in mm."""

    n_scans: int = 0
    outcomes: dict[str, int] = field(
        default_factory=lambda: dict.fromkeys(("right", "honest", "withheld", "wrong", "false verdict"), 0)
    )
    ratios: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in QUANTITIES})
    going_u_mm: list[float] = field(default_factory=list)


def examine_variant(variant: Variant, folder: Path, tally: Tally) -> tuple[str, list[str]]:
    """Read, measure and judge one scan; the outcome and what is wrong in words. Errors over u go into the tally."""
    path = folder / "scan.ply"
    path.write_bytes(ply_bytes(variant.points))
    try:
        scan = read_scan(path)
        inspection = inspect(scan, find_preset(variant.preset).params)
    except (ReadError, CannotMeasure) as error:
        return "withheld", [str(error)]
    if inspection.questions:
        return "withheld", [found.message for found in inspection.questions]
    if not inspection.steps:
        reason = next((note.message for note in inspection.notes if note.code == "no_staircase"), "")
        return ("withheld" if variant.nosings and variant.has_flight else "right"), [reason]
    ratios: dict[str, list[float]] = {name: [] for name in QUANTITIES}
    wrong, n_missed = _compare(variant, inspection, scan.origin_m, ratios)
    for name, values in ratios.items():
        tally.ratios[name] += values
    tally.going_u_mm += [1000.0 * step.going_m.u for step in inspection.steps if step.going_m is not None]
    false = _false_verdicts(variant, inspection)
    if false:
        return "false verdict", [*wrong, *false]
    is_told = any(note.code in _TOLD for note in inspection.notes) or any(
        found.level == "doubt" for found in inspection.examination
    )
    if n_missed and not is_told:
        wrong.append(f"{n_missed} of {len(variant.nosings)} treads missing without a word")
    if wrong:
        return "wrong", wrong
    beyond = np.mean([ratio > 1.0 for values in ratios.values() for ratio in values] or [1.0])
    is_useful = all(_median_u_mm(inspection, name) <= most for name, most in _USEFUL_MM.items())
    is_right = is_useful and beyond <= _MOST_BEYOND and (n_missed == 0 or (variant.is_partly_seen and is_told))
    return ("right" if is_right else "honest"), []


def _compare(
    variant: Variant, inspection: Inspection, origin_m: np.ndarray, ratios: dict[str, list[float]]
) -> tuple[list[str], int]:
    """Hold every step against the true one nearest to it: what is wrong, and how many true steps are missing."""
    wrong = []
    free = set(range(len(variant.nosings)))
    going_u_m = {step.step_id: 0.0 if step.going_m is None else step.going_m.u for step in inspection.steps}
    for step in inspection.steps:
        middle = step.nosing.mean(axis=0) + origin_m
        distances = [_distance(middle, *nosing) for nosing in variant.nosings]
        k = int(np.argmin(distances)) if distances else -1
        if step.rise_m is None and step.going_m is None:
            u_m = _NEAR_UNMEASURED_M
        else:
            u_m = max(going_u_m[step.step_id], going_u_m.get(step.step_id - 1, 0.0))
        if k not in free or distances[k] > max(_NEAR_M, u_m):
            wrong.append(f"step {step.step_id} is none")
            continue
        free.discard(k)
        for name, attribute in QUANTITIES.items():
            measured, true_m = getattr(step, attribute), variant.truths[k].get(name)
            if measured is None or true_m is None:
                continue
            off_mm, u_mm = 1000.0 * (measured.value - true_m), 1000.0 * measured.u
            ratios[name].append(abs(off_mm) / u_mm)
            if abs(off_mm) > max(2.0 * u_mm, _MATTERS_MM[name]):
                wrong.append(f"step {step.step_id} {name} {1000.0 * measured.value:.1f} u {u_mm:.1f}, off {off_mm:.1f}")
    return wrong, len(free)


def _distance(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    """Distance of a point from a line from start to end."""
    share = np.clip((point - start) @ (end - start) / ((end - start) @ (end - start)), 0.0, 1.0)
    return float(np.linalg.norm(start + share * (end - start) - point))


def _median_u_mm(inspection: Inspection, name: str) -> float:
    found = [getattr(step, QUANTITIES[name]) for step in inspection.steps]
    return float(np.median([1000.0 * each.u for each in found if each is not None] or [np.inf]))


def _false_verdicts(variant: Variant, inspection: Inspection) -> Iterator[str] | list[str]:
    """Name every plain verdict on rises and goings that the building does not deserve."""
    found = []
    for rule_id in RULE_SETS:
        for finding in check(inspection, find_rule_set(rule_id)).findings:
            quantity, is_spread = finding.rule.quantity, finding.rule.statistic != "each"
            if quantity not in ("rise", "going"):
                continue
            is_uneven = quantity == "rise" and is_spread and variant.is_uneven
            if finding.verdict is Verdict.OUTSIDE and not is_uneven:
                found.append(f"{rule_id} {finding.rule.rule_id}: outside at {finding.steps}, and is within")
            if finding.verdict is Verdict.WITHIN and is_uneven and set(finding.steps) & {variant.uneven_step}:
                found.append(f"{rule_id} {finding.rule.rule_id}: within at {finding.steps}, and is outside")
    return found


def run(kinds: str, seeds: Sequence[int], verbose: bool) -> dict[str, Tally]:
    """Examine all variants of the kinds that match a pattern."""
    tallies: dict[str, Tally] = {}
    with tempfile.TemporaryDirectory() as folder:
        for kind, make in KINDS.items():
            if not fnmatch.fnmatch(kind, kinds):
                continue
            tally = tallies[kind] = Tally()
            for variant in (variant for seed in seeds for variant in make(seed)):
                began = time.perf_counter()
                outcome, words = examine_variant(variant, Path(folder), tally)
                tally.n_scans += 1
                tally.outcomes[outcome] += 1
                if verbose:
                    seconds = time.perf_counter() - began
                    print(
                        f"  {kind}, {variant.name}: {outcome} ({seconds:.1f} s)", *words[:6], sep="\n    ", flush=True
                    )
    return tallies


def table(tallies: dict[str, Tally]) -> Iterator[str]:
    """The result as a table in Markdown."""
    outcomes = list(Tally().outcomes)
    yield (
        "| kind | scans | "
        + " | ".join(outcomes)
        + " | within u: "
        + ", ".join(QUANTITIES)
        + " | goings with u > 20 mm |"
    )
    yield "|---" * (4 + len(outcomes)) + "|"
    for kind, tally in tallies.items():
        shares = [
            f"{100.0 * np.mean(np.array(values) <= 1.0):.0f} %" if values else "-" for values in tally.ratios.values()
        ]
        counts = [str(tally.outcomes[name]) for name in outcomes]
        large = _share_of_large(tally.going_u_mm)
        yield f"| {kind} | {tally.n_scans} | " + " | ".join(counts) + f" | {', '.join(shares)} | {large} |"


def _share_of_large(going_u_mm: Sequence[float]) -> str:
    return f"{100.0 * np.mean(np.array(going_u_mm) > _LARGE_U_MM):.0f} %" if going_u_mm else "-"


def main(argv: Sequence[str] | None = None) -> int:
    """Examine and print the table; 1 where something is confidently wrong or judged falsely."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.benchmarks.hostile_scans", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--kinds", default="*", help="only kinds whose name matches this pattern")
    parser.add_argument("--seeds", nargs="*", type=int, default=[1, 2, 3], help="other seeds make other scans")
    parser.add_argument("--verbose", action="store_true", help="name every scan and what is wrong with it")
    args = parser.parse_args(argv)
    tallies = run(args.kinds, args.seeds, args.verbose)
    print(*table(tallies), sep="\n")
    totals = {name: sum(tally.outcomes[name] for tally in tallies.values()) for name in Tally().outcomes}
    n_scans = sum(tally.n_scans for tally in tallies.values())
    print("\n" + ", ".join(f"{name} {count} of {n_scans}" for name, count in totals.items()))
    every = [u_mm for tally in tallies.values() for u_mm in tally.going_u_mm]
    within = [ratio <= 1.0 for tally in tallies.values() for ratio in tally.ratios["going"]]
    if every and within:
        share = f"{100.0 * np.mean(within):.0f} %"
        print(f"goings with u > 20 mm: {_share_of_large(every)} of {len(every)}; within u: {share}")
    return 1 if totals["wrong"] or totals["false verdict"] else 0


if __name__ == "__main__":
    sys.exit(main())
