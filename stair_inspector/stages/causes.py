"""Why is there no staircase? Every failure has a cause of its own, and what to do about it."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.model import Chain, Chains, Horizontal, Inspection, Level, Patches, Scan, Surface
from stair_inspector.params import SETTINGS, FlightsParams, Params
from stair_inspector.stages.density import find_spacing
from stair_inspector.stages.examine import POINTS_PER_TREAD, TREAD_M2, size_text
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.hopeless import why_hopeless
from stair_inspector.stages.rejects import Forced, lean_deg, narrow_side, plan_keys
from stair_inspector.stages.up_questions import BESIDE_LEVEL_M
from stair_inspector.units import METRES_PER_UNIT, UNIT_NAMES

_ADVICE = "check the up direction, then theta_th, eps_z and m"
_FEW_FACE_UP = 0.02
MERGED_M = 0.1
"""A level whose points spread over more than this is several that ran together."""
_BELOW_SHARE = 0.9
_LARGE = 0.3
_STACKED, _OVER_SHARE = 3, 0.5
_LEAST_SHELF_M = 0.1
_SMALLER = 0.2
_OTHER_UNIT = 5.0
"""A unit that was given is doubted only where another differs by such a factor."""


def why_no_flight(
    scan: Scan, paper: Inspection, horizontal: Horizontal, patches: Patches, chains: Chains, forced: Forced
) -> str:
    """Return why no surfaces follow each other as steps, and what to do.

    Parameters
    ----------
    scan, paper, horizontal, patches, chains, forced
        Of one scan; ``paper`` holds the settings, what the examination found, and the height clusters.
    """
    hopeless = why_hopeless(scan, paper.examination, paper.params.flights)
    if hopeless is not None:
        return hopeless
    if not patches.surfaces:
        return _why_no_surface(scan, paper, horizontal)
    what = _count(len(patches.surfaces), "horizontal surface")
    largest = max(patches.surfaces, key=lambda surface: surface.area_m2)
    lean = lean_deg(largest)
    is_ramp = priors.RAMP_DEG[0] <= lean <= priors.RAMP_DEG[1]
    ramp = f"; the largest, of {largest.area_m2:.1f} m², leans by {lean:.1f}° as a ramp does" if is_ramp else ""
    found, advice = (
        _left_out_by_climb(patches, chains, forced, paper.params)
        or _left_out_by_limits(scan, patches, chains, forced, paper.params)
        or _wrong_unit(scan, paper.levels, paper.params.flights)
        or _too_sparse(horizontal)
        or _upside_down(scan, paper, patches)
        or _by_risers(patches, chains, paper.params)
    )
    return f"{what}, but {found}{ramp}; {advice}"


def _why_no_surface(scan: Scan, paper: Inspection, horizontal: Horizontal) -> str:
    """Return why no points form a level surface."""
    n_levels = len(paper.levels)
    n_points = max(1, len(scan.points))
    share = len(horizontal.point_ids) / n_points
    what = f"{_count(n_levels, 'horizontal level')} and no connected surface in {'it' if n_levels == 1 else 'them'}"
    cause = _wrong_unit(scan, paper.levels, paper.params.flights) or _too_sparse(horizontal)
    if cause is not None:
        return f"{what}: {cause[0]}; {cause[1]}"
    if share < _FEW_FACE_UP:
        return (
            f"no level surface: {share:.1%} of the points face up ({paper.up.source} up direction, within theta_th = "
            f"{paper.params.horizontal.theta_deg:g}°); give another up direction, as --up z"
        )
    tallest_m = max((level.high_m - level.low_m for level in paper.levels), default=0.0)
    if tallest_m > MERGED_M:
        return (
            f"{what}: one level spans {size_text(tallest_m)}, so several have run together; lower eps_z or raise m, "
            "and check the up direction"
        )
    if not n_levels:
        return (
            f"no level surface: {len(horizontal.point_ids):,} points face up, but nowhere "
            f"{paper.params.levels.min_points} of them (m) within {size_text(paper.params.levels.eps_m)} of one height "
            "(eps_z); lower m or raise eps_z"
        )
    return f"{what}; {_ADVICE}"


IF_STEPS = "if they are steps, give"
"""Begins the advice to widen a limit, which is good only where no other cause is known."""
Cause = tuple[str, str]
"""What was found and what to do."""


def _left_out_by_climb(patches: Patches, chains: Chains, forced: Forced, params: Params) -> Cause | None:
    """Return what overrules.climb leaves out that would be more of a flight; None if nothing, or if it is not set."""
    if forced.climb is None:
        return None
    free = find_chains(patches, params.flights, params.patches.min_area_m2, Forced(forced.kinds))
    if free.longest_risers <= chains.longest_risers:
        return None
    risers = _count(free.longest_risers, "riser")
    left_out = f"overrules.climb ({params.overrules.climb}) leaves out {risers} in a row, which climb another way"
    return left_out, "correct overrules.climb, or set it to auto"


def _left_out_by_limits(scan: Scan, patches: Patches, chains: Chains, forced: Forced, params: Params) -> Cause | None:
    """Return the limit without which there would be a flight; None where there would be none without any."""
    flights, area_m2 = params.flights, params.patches.min_area_m2
    if 2 <= chains.longest_risers < flights.min_risers:
        found = f"at most {_count(chains.longest_risers, 'riser')} in a row, where flights.min_risers asks for more"
        return found, f"set --flights.min-risers {chains.longest_risers}"
    any_rise = replace(
        flights, min_rise_m=SETTINGS.knob("flights.min_rise_m").low, max_rise_m=SETTINGS.knob("flights.max_rise_m").high
    )
    free = find_chains(patches, any_rise, area_m2, forced)
    if free.chains:
        return _by_rise(scan, patches.surfaces, max(free.chains, key=lambda chain: len(chain.steps)), flights)
    if free.longest_risers >= 2 and _depth(patches.surfaces) > priors.LONGEST_TREAD_M:
        found = f"{free.longest_risers + 1} of them follow each other, {size_text(_depth(patches.surfaces))} deep"
        return f"{found}, deeper than treads: tiers of seats or terraces", _ADVICE
    for name, wider, least_m2 in (
        ("flights.max_gap_m", replace(flights, max_gap_m=SETTINGS.knob("flights.max_gap_m").high), area_m2),
        ("flights.turn_deg", replace(flights, turn_deg=SETTINGS.knob("flights.turn_deg").high), area_m2),
        ("patches.min_area_m2", flights, _SMALLER * area_m2),
    ):
        free = find_chains(patches, wider, least_m2, forced)
        most = max((len(chain.steps) for chain in free.chains), default=0)
        if most >= priors.SURE_RISERS:
            flag = f"--{name.replace('_', '-')}"
            way = "lower" if name.startswith("patches") else "raise"
            return f"{name} ({params.value(name):g}) leaves out {_count(most, 'step')} in a row", f"{way} {flag}"
    return None


def _by_rise(scan: Scan, surfaces: Sequence[Surface], chain: Chain, flights: FlightsParams) -> Cause | None:
    """Return what a run of surfaces is whose rises are beyond the limits."""
    numbers = [*(() if chain.base is None else (chain.base,)), *chain.steps]
    rises_m = np.diff([surfaces[number].height_m for number in numbers])
    out = rises_m[(rises_m < flights.min_rise_m) | (rises_m > flights.max_rise_m)]
    if not len(out):
        return None
    rise_m = float(np.median(out))
    is_tall = rise_m > flights.max_rise_m
    limit = flights.max_rise_m if is_tall else flights.min_rise_m
    name = "max" if is_tall else "min"
    goings_m = np.hypot(*np.diff(chain.middles, axis=0).T)
    run = f"{len(numbers)} of them follow each other with rises of about {rise_m * 1000.0:.0f} mm"
    beyond = f"{'above' if is_tall else 'below'} flights.{name}_rise_m, {limit * 1000.0:.0f} mm"
    wide = math.ceil(1.05 * max(out) * 200.0) / 200.0 if is_tall else math.floor(0.95 * min(out) * 200.0) / 200.0
    flag = f"{IF_STEPS} --flights.{name}-rise-m {wide:g}"
    low, high = priors.COMMON_RISES_M
    if is_tall and any(low <= rise_m / n <= high for n in (2, 3)):
        flag = f"as where treads between them were not found: check theta_th, eps_z and m; {flag}"
    unit = _unit_by_rise(scan, rise_m)
    if unit is not None:
        flag += f"; in {UNIT_NAMES[unit[0]]} the rises are {unit[1] * 1000.0:.0f} mm: if so, give --unit {unit[0]}"
    if is_tall and len(goings_m) and float(np.median(goings_m)) > priors.LONGEST_TREAD_M:
        return f"{run} and {size_text(float(np.median(goings_m)))} deep, as tiers of seats: {beyond}", flag
    return f"{run}, {beyond}", flag


def _depth(surfaces: Sequence[Surface]) -> float:
    """Return the median of the narrow sides of the surfaces, metres."""
    return float(np.median([narrow_side(surface) for surface in surfaces]))


def _unit_by_rise(scan: Scan, rise_m: float) -> tuple[str, float] | None:
    """Return the unit in which a rise is usual, and that rise: not one as near as the foot where the unit was given."""
    low, high = priors.COMMON_RISES_M
    is_guessed = any(note.code == "unit_guessed" for note in scan.notes)
    for unit, per in METRES_PER_UNIT.items():
        ratio = per / METRES_PER_UNIT[scan.unit]
        if low <= ratio * rise_m <= high and (is_guessed or not 1.0 / _OTHER_UNIT < ratio < _OTHER_UNIT):
            return unit, ratio * rise_m
    return None


def _wrong_unit(scan: Scan, levels: Sequence[Level], flights: FlightsParams) -> Cause | None:
    """Say so where levels follow each other evenly, as risers would in another unit."""
    rises_m = np.diff(sorted(level.height_m for level in levels))
    if len(rises_m) < priors.SURE_RISERS or max(rises_m) > priors.MOST_UNEVEN * min(rises_m):
        return None
    rise_m = float(np.median(rises_m))
    unit = None if flights.min_rise_m <= rise_m <= flights.max_rise_m else _unit_by_rise(scan, rise_m)
    if unit is None:
        return None
    name, usual_m = unit
    found = (
        f"the levels follow each other {size_text(rise_m)} apart, read in {UNIT_NAMES[scan.unit]}; in "
        f"{UNIT_NAMES[name]} these are rises of {size_text(usual_m)}"
    )
    return found, f"if so, give --unit {name}"


def _too_sparse(horizontal: Horizontal) -> Cause | None:
    """Say so where the points that face up are too few for treads."""
    if len(horizontal.point_ids) < POINTS_PER_TREAD // 2:
        return None
    spacing_m = find_spacing(np.ascontiguousarray(horizontal.coordinates_m.T))
    per_tread = TREAD_M2 / spacing_m**2
    if per_tread >= POINTS_PER_TREAD:
        return None
    found = f"too sparse: points lie about {size_text(spacing_m)} apart, some {per_tread:.0f} on a tread"
    return found, "scan from nearer or with a finer resolution, or export without thinning"


def _upside_down(scan: Scan, paper: Inspection, patches: Patches) -> Cause | None:
    """Say so where nearly everything lies below the largest surface, and nothing as large lies under it."""
    largest = max(patches.surfaces, key=lambda surface: surface.area_m2)
    others = [surface for surface in patches.surfaces if surface is not largest]
    if any(other.area_m2 >= _LARGE * largest.area_m2 and other.height_m < largest.height_m for other in others):
        return None
    above = scan.points @ paper.up.vector - largest.height_m
    n_below = int(np.count_nonzero(above < -BESIDE_LEVEL_M))
    n_above = int(np.count_nonzero(above > BESIDE_LEVEL_M))
    if n_below < max(_LARGE * len(above), _BELOW_SHARE * (n_below + n_above)):
        return None
    axis = "xyz"[int(np.abs(paper.up.vector).argmax())]
    sign = "" if paper.up.vector["xyz".index(axis)] < 0.0 else "-"
    found = f"{n_below:,} points lie below the largest of them and {n_above:,} above it: up may point down"
    return found, f"give --up={sign}{axis} if it does"


def _by_risers(patches: Patches, chains: Chains, params: Params) -> Cause:
    """Return what is seen of risers."""
    if len(patches.surfaces) == 1:
        settings = f"theta_th, eps_z and m ({params.levels.min_points:,})"
        return "it is the only one", f"check the up direction, then {settings}"
    if chains.longest_risers == 1:
        return "only single risers, as of a kerb or a platform, where a flight has two and more in a row", _ADVICE
    if chains.longest_risers:
        return f"at most {chains.longest_risers} risers in a row, too uneven or too few for a flight", _ADVICE
    stack = _tallest_stack(patches)
    if len(stack) >= _STACKED:
        apart_m = float(np.median(np.diff(stack)))
        found = f"{len(stack)} of them lie over each other, about {size_text(apart_m)} apart, as shelves do"
        return found, "if there is a staircase too, give a region around it, or check the up direction"
    return "no two of them a riser apart in height and side by side in plan", _ADVICE


def _tallest_stack(patches: Patches) -> list[float]:
    """Return the heights of most surfaces that lie over each other, nearer than headroom, metres."""
    surfaces = sorted(patches.surfaces, key=lambda surface: surface.height_m)
    keys = [plan_keys(surface, 2.0 * patches.cell_m) for surface in surfaces]
    stacks: list[list[int]] = []
    for upper, surface in enumerate(surfaces):
        for stack in stacks:
            gap_m = surface.height_m - surfaces[stack[-1]].height_m
            smaller, larger = sorted((upper, stack[-1]), key=lambda k: len(keys[k]))
            is_like = surfaces[smaller].area_m2 >= _LARGE * surfaces[larger].area_m2
            if (
                _LEAST_SHELF_M <= gap_m <= priors.FURNITURE_M[1]
                and is_like
                and np.isin(keys[smaller], keys[larger]).mean() >= _OVER_SHARE
            ):
                stack.append(upper)
                break
        else:
            stacks.append([upper])
    best = max(stacks, key=len, default=[])
    return [surfaces[k].height_m for k in best]


def _count(n: int, noun: str) -> str:
    return f"{n} {noun}{'' if n == 1 else 's'}"
