"""Do floor and treads agree about the vertical, and how well is it known?"""

import math
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, own
from stair_inspector.geometry.percentiles import MAD_TO_SIGMA, MEDIAN_NOISE
from stair_inspector.model import Normals, Note, Scan, Surface, Up
from stair_inspector.params import FlightsParams, HorizontalParams, LevelsParams, PatchesParams
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.foot import without_floor_strips
from stair_inspector.stages.levels import find_height_reach, find_levels, select_horizontal
from stair_inspector.stages.orient import order_by_height
from stair_inspector.stages.patches import split_levels
from stair_inspector.stages.readings import LEVELLED_DEG
from stair_inspector.stages.rejects import Forced

_POINTS = 150_000
"""The vertical is found from at most this many points: slopes of whole treads need no more."""
_FEWEST_TREADS = 3
_ROUNDS = 2
_SURE_DEG = 0.12
_SIGMAS = 3.0
_BLOCK_M = 0.25
_TREAD_SPREAD_M = priors.LONGEST_TREAD_M / math.sqrt(12.0)
"""Standard deviation across a floor that is no deeper than a tread: of a strip the slope is badly known."""


@dataclass(frozen=True, slots=True, eq=False)
class _Slopes:
    """Slopes of the treads on the whole and of the floor, relative to an up direction; noises are standard ones."""

    n_treads: int
    tread_slope: Floats
    tread_noise_deg: float
    base_noise_deg: float | None
    has_floor: bool
    up_from_treads: Floats


def refine_up(scan: Scan, normals: Normals, up: Up, limits: FlightsParams | None = None) -> Up:
    """Compare the floor's normal with the treads', take the better one where they disagree, and say how sure it is.

    Parameters
    ----------
    scan, normals
        Of one scan.
    up : Up
        As the floor gives it.
    limits : FlightsParams, optional
        What follows each other as steps; the defaults where none are given.

    Returns
    -------
    Up
        ``u_deg`` (k = 2) from the scatter of the surfaces that give it. With fewer than three treads it is the floor's.

    Notes
    -----
    But for limits that are wider, the treads are found with the default settings, whatever the user's are, so that up
    does not move while a slider does. Where floor and treads disagree: if the scan's z axis is within 3 degrees of
    either it was levelled, and the one nearer to it is taken; else the treads are, of which there are several, if they
    agree with each other. Of a scan that was not levelled and shows no more of a floor than a strip, they are too.
    """
    few = _thinned(scan, normals)
    limits = limits or FlightsParams()
    floor_up = up
    by_floor = _slopes(*few, up, limits)
    if by_floor is None:
        return up
    # Without a floor at the foot of a flight, nothing tells how well the plane found elsewhere is known.
    base_noise_deg = by_floor.base_noise_deg
    floor_up = up if base_noise_deg is None else replace(up, u_deg=2.0 * base_noise_deg)
    if by_floor.n_treads < _FEWEST_TREADS:
        return floor_up
    if not by_floor.has_floor and _from_z_deg(up.vector) > LEVELLED_DEG:
        vector, treads = _up_from_treads(few, by_floor, up, limits)
        u_deg = 2.0 * math.hypot(treads.tread_noise_deg, priors.BUILT_LEVEL_DEG)
        return Up(own(vector, (3,), "up"), "treads", u_deg, up.notes, up.observations)
    # Where the treads are the better known, an uneven floor's own doubt must not hide that it leans.
    floor_noise_deg = base_noise_deg or 0.0
    is_floor_better = floor_noise_deg <= by_floor.tread_noise_deg
    doubt_deg = math.hypot(by_floor.tread_noise_deg, floor_noise_deg if is_floor_better else 0.0)
    limit_deg = max(priors.UNLEVEL_DEG, _SIGMAS * doubt_deg)
    apart_deg = math.degrees(math.atan(float(np.hypot(*by_floor.tread_slope))))
    if apart_deg <= limit_deg:
        if apart_deg > _SURE_DEG and floor_up.u_deg is not None:
            # Which of the two is level is not known: up lies anywhere between.
            return replace(floor_up, u_deg=math.hypot(floor_up.u_deg, 2.0 * apart_deg / math.sqrt(3.0)))
        return floor_up
    vector, treads = _up_from_treads(few, by_floor, up, limits)
    to_floor, to_treads = _from_z_deg(up.vector), _from_z_deg(vector)
    is_levelled = min(to_floor, to_treads) <= LEVELLED_DEG
    takes_treads = to_treads < to_floor if is_levelled else treads.tread_noise_deg < apart_deg / _SIGMAS
    why = "the scan's z axis is nearer to it" if is_levelled else f"{treads.n_treads} treads agree with each other"
    if not takes_treads:
        why = "the scan's z axis is nearer to it" if is_levelled else "the treads do not agree with each other"
    message = (
        f"floor and treads disagree about the vertical by {apart_deg:.1f}°, which moves each rise by about "
        f"{1000.0 * priors.USUAL_GOING_M * math.tan(math.radians(apart_deg)):.0f} mm; up is taken from the "
        f"{'treads' if takes_treads else 'floor'}, because {why}; give --up if you know it"
    )
    note = Note("up_disagree", "plumb", message)
    if not takes_treads:
        return replace(floor_up, notes=(*up.notes, note))
    # What was said about the floor's plane concerns the direction no longer.
    return Up(own(vector, (3,), "up"), "treads", 2.0 * treads.tread_noise_deg, (*up.notes, note), up.observations)


def _up_from_treads(
    few: tuple[Scan, Normals], by_floor: _Slopes, up: Up, limits: FlightsParams
) -> tuple[Floats, _Slopes]:
    """Return up as the treads give it, found again along it, and the slopes relative to it."""
    treads = by_floor
    vector = up.vector
    for _ in range(_ROUNDS):
        vector = treads.up_from_treads
        again = _slopes(*few, replace(up, vector=own(vector, (3,), "up")), limits)
        if again is None or again.n_treads < _FEWEST_TREADS:
            break
        treads = again
        vector = treads.up_from_treads
    return vector, treads


def _thinned(scan: Scan, normals: Normals) -> tuple[Scan, Normals]:
    n = len(scan.points)
    if n <= _POINTS:
        return scan, normals
    ids = np.sort(np.random.default_rng(0).choice(n, _POINTS, replace=False))
    few = replace(
        scan,
        points=scan.points[ids],
        colors=None,
        normals=None,
        repeats=None,
        is_outward=None,
        stations=None,
        intensities=None,
    )
    return few, Normals(own(normals.vectors[ids], (None, 3), "normals"))


def _slopes(scan: Scan, normals: Normals, up: Up, limits: FlightsParams) -> _Slopes | None:
    """Find treads and floor relative to an up direction; None where there is no flight."""
    heights = order_by_height(scan, normals, up)
    horizontal = select_horizontal(heights, HorizontalParams())
    params = LevelsParams()
    levels = find_levels(horizontal, find_height_reach(horizontal, params.eps_m), params)
    patches = split_levels(horizontal, levels, PatchesParams(), params)
    chains = find_chains(patches, limits, PatchesParams().min_area_m2, Forced({}))
    chains = without_floor_strips(heights, patches, chains, Forced({}))
    numbers = sorted({k for chain in chains.chains for k in chain.steps})
    if not numbers:
        return None
    slopes = np.array([patches.surfaces[k].slope for k in numbers])
    middle = np.median(slopes, axis=0)
    scatter = MAD_TO_SIGMA * float(np.median(np.abs(slopes - middle)))
    normal = np.array([-middle[0], -middle[1], 1.0])
    bases = {chain.base for chain in chains.chains if chain.base is not None}
    noises = [_slope_noise(patches.surfaces[k]) for k in bases]
    return _Slopes(
        n_treads=len(numbers),
        tread_slope=middle,
        tread_noise_deg=math.degrees(MEDIAN_NOISE * scatter / math.sqrt(len(numbers))),
        base_noise_deg=None if not noises else math.degrees(min(noises)),
        has_floor=any(_least_spread(patches.surfaces[k]) > _TREAD_SPREAD_M for k in bases),
        up_from_treads=horizontal.level_from_scan.T @ (normal / np.linalg.norm(normal)),
    )


def _slope_noise(surface: Surface) -> float:
    """Return the standard uncertainty of a surface's slope: its unevenness over its size, one bump in each block."""
    spread_m = _least_spread(surface)
    n_blocks = max(1.0, surface.area_m2 / _BLOCK_M**2)
    return surface.sigma_m / (max(spread_m, 1e-3) * math.sqrt(n_blocks))


def _least_spread(surface: Surface) -> float:
    """Return the standard deviation of a surface's cells across its longer side, metres."""
    return math.sqrt(float(np.min(np.linalg.eigvalsh(np.cov(surface.cells_m)))))


def _from_z_deg(vector: Floats) -> float:
    return math.degrees(math.acos(min(1.0, abs(float(vector[2])))))
