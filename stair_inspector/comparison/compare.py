"""Compare two inspections of one stair."""

import math
from dataclasses import replace
from statistics import NormalDist

import numpy as np

from stair_inspector.comparison.alignment import Aligned, align, alignment_of, height_noise
from stair_inspector.comparison.cells import tread_change
from stair_inspector.comparison.deviations import map_deviations
from stair_inspector.comparison.epochs import Epoch, epoch_of, height_doubt, surface_doubts, systematic
from stair_inspector.comparison.matching import Matching, match_steps
from stair_inspector.comparison.surfaces import PlaneChange
from stair_inspector.comparison.words import notes_on
from stair_inspector.geometry.arrays import Floats
from stair_inspector.measured import usable
from stair_inspector.model import (
    COVERAGE_FACTOR,
    Inspection,
    Measured,
    Scan,
    ScanComparison,
    Step,
    StepChange,
    TreadDeviations,
    ValueChange,
)
from stair_inspector.quantities import IN_FILES

HEIGHT = "height"
"""The name of the change of a tread's height, beside those of the quantities."""
_FALSE_SHARE = 0.05
"""Chance that of all values of two scans of an unchanged stair one is called changed."""
_COMPARED_VALUES = tuple(quantity for quantity in IN_FILES if quantity.field is not None and not quantity.made_of)
"""What is measured of a step; what is worked out from it tells nothing more."""
_NO_VALUE = ValueChange(HEIGHT, None, None, None)


def compare_scans(before: Scan, found_before: Inspection, after: Scan, found_after: Inspection) -> ScanComparison:
    """Compare two inspections of one stair, which may lie anywhere to each other.

    Parameters
    ----------
    before, found_before
        The earlier scan and its inspection by survey.
    after, found_after
        The later ones.

    Raises
    ------
    ConfigError
        An inspection by the paper's method, or of another scan.
    CannotMeasure
        Another stair, too little in common, or a question open in one of the scans.

    Notes
    -----
    The later scan is laid onto the earlier one on what did not move (:mod:`alignment`); values of a step need no
    alignment, heights and maps do. A change is called one only beyond its U, and beyond what the largest of as many
    differences is by chance: of a hundred values with k = 2, five exceed their U where nothing changed.
    """
    one, two = epoch_of(before, found_before), epoch_of(after, found_after)
    matching = match_steps(one, two)
    aligned = align(one, two, matching)
    pairs = [(one.treads[i].step, two.treads[j].step) for i, j in matching.pairs]
    values = [_values_of(*pair) for pair in pairs]
    heights = [
        _height_change(aligned, plane, one.treads[i].corners.mean(axis=0))
        for plane, (i, _) in zip(aligned.planes, matching.pairs, strict=True)
    ]
    floor = _height_change(aligned, aligned.floor, None)
    n_tested = sum(value.change is not None for each in values for value in each)
    n_tested += sum(height.change is not None for height in (*heights, floor))
    widening = chance_widening(n_tested)
    steps = tuple(
        StepChange(
            before_id=step.step_id,
            after_id=other.step_id,
            kind=step.kind,
            values=tuple(_judged(value, widening) for value in values[k]),
            height=_judged(heights[k], widening),
            deviations=_map(one, two, aligned, matching, k),
            is_steady=aligned.is_steady[k],
        )
        for k, (step, other) in enumerate(pairs)
    )
    matched_before, matched_after = ({step.step_id for step in side} for side in zip(*pairs, strict=True))
    found = ScanComparison(
        before=found_before.scan,
        after=found_after.scan,
        alignment=alignment_of(one, two, aligned, matching),
        steps=steps,
        floor=_judged(floor, widening),
        only_before=tuple(step.step_id for step in found_before.steps if step.step_id not in matched_before),
        only_after=tuple(step.step_id for step in found_after.steps if step.step_id not in matched_after),
        notes=(),
    )
    return replace(found, notes=notes_on(found))


def chance_widening(n_tested: int) -> float:
    """Return by how much U (k = 2) is widened so that of so many differences of nothing one exceeds it rarely."""
    quantile = NormalDist().inv_cdf(1.0 - _FALSE_SHARE / (2.0 * max(1, n_tested)))
    return max(1.0, quantile / COVERAGE_FACTOR)


def _values_of(step: Step, other: Step) -> list[ValueChange]:
    """Return the changes of the values of a step, without a judgement."""
    changes = []
    for quantity in _COMPARED_VALUES:
        before, after = usable(quantity.of(step)), usable(quantity.of(other))
        change = None
        if before is not None and after is not None:
            change = Measured(after.value - before.value, math.hypot(before.u, after.u))
        changes.append(ValueChange(quantity.name, before, after, change))
    return changes


def _height_change(aligned: Aligned, plane: PlaneChange | None, place: Floats | None) -> ValueChange:
    """Return the change of the height of a surface at a place of the plan, or in the middle of what was seen."""
    if plane is None:
        return _NO_VALUE
    place = plane.middle_m if place is None else place
    row = np.array([1.0, *(place - plane.middle_m)])
    own_u = COVERAGE_FACTOR * math.sqrt(float(row @ plane.covariance @ row))
    laid_u = COVERAGE_FACTOR * height_noise(aligned, place)
    parts = (("surface", own_u), ("alignment", laid_u))
    return ValueChange(HEIGHT, None, None, Measured(float(row @ plane.change), math.hypot(own_u, laid_u), parts))


def _judged(value: ValueChange, widening: float) -> ValueChange:
    change = value.change
    return value if change is None else replace(value, is_changed=abs(change.value) > widening * change.u)


def _map(one: Epoch, two: Epoch, aligned: Aligned, matching: Matching, k: int) -> TreadDeviations:
    i, j = matching.pairs[k]
    ours, theirs = one.treads[i], two.treads[j]
    surface = tread_change(one, ours, two, theirs, aligned.motion)
    both = ((ours.step, one.inspection.steps), (theirs.step, two.inspection.steps))
    over_all = math.hypot(height_noise(aligned, ours.corners.mean(axis=0)), *(height_doubt(*each) for each in both))
    nearby = math.hypot(*(systematic(surface_doubts(*each)) for each in both))
    n_cells = int(np.count_nonzero(np.isfinite(surface.deviation_m)))
    widening = chance_widening(n_cells * len(matching.pairs))
    return map_deviations(surface, aligned.planes[k], over_all, nearby, widening, one.level_from_scan)
