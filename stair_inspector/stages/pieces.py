"""Which surfaces are pieces of one tread, and which are treads of two flights side by side?

What a person or a box on a tread parts, and two staircases with a slot between them, look alike in themselves. The
other treads tell them apart: where they go on from one side to the other without a gap, so does the one of which only
pieces were seen; where none does, there are two flights.
"""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.slots import Sides, find_slots
from stair_inspector.model import Chain, Chains, HeightOrder, Horizontal, Patches, Surface
from stair_inspector.params import FlightsParams
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.foot import without_floor_strips
from stair_inspector.stages.links import depth_along, height_at
from stair_inspector.stages.nosings import straight_climb
from stair_inspector.stages.rejects import Forced

_ROUNDS = 3
"""A piece that is joined may let the flight go on, and so find the pieces of the next tread."""
_SAME_PLANE_M, _PLANE_SIGMAS = 0.005, 3.0
"""A piece lies no farther off a tread's plane than both: treads lean, and what is seen of one says little about how."""
_WHOLE_TREADS = 2
"""So many other treads of the flight must reach over the piece and the tread without a gap."""
_BESIDE_CELLS = 2.0
"""Cells on the rim of a surface are partly filled: so far a piece may lie outside of where it should."""
_FEWEST_CELLS = 4
_SIDE_M = 0.15
"""What lies on either side of a slot between two flights is wider than a bar."""


def find_flights(
    heights: HeightOrder,
    horizontal: Horizontal,
    patches: Patches,
    params: FlightsParams,
    least_area_m2: float,
    forced: Forced,
) -> tuple[Patches, Chains]:
    """Chain surfaces into flights, and put the pieces of their treads together.

    Parameters
    ----------
    heights, horizontal, patches
        Of one scan.
    params, least_area_m2, forced
        As :func:`stair_inspector.stages.flights.find_chains` takes them.

    Returns
    -------
    patches : Patches
        The same object where no tread is in pieces. Else a tread holds the points of all its pieces, which keep their
        numbers and say of which surface they are part.
    chains : Chains
        Of these surfaces, without strips of floor.
    """
    chains = find_chains(patches, params, least_area_m2, forced)
    for _ in range(_ROUNDS):
        better = _joined(horizontal, _parted(horizontal, patches, chains, forced), chains, forced)
        if better is patches:
            break
        patches = better
        chains = find_chains(patches, params, least_area_m2, forced)
    return patches, without_floor_strips(heights, patches, chains, forced)


def _sides_of(horizontal: Horizontal, surface: Surface, left: Floats) -> Sides:
    across = left @ horizontal.coordinates_m[:2].take(surface.rows, axis=1)
    return find_slots(across, math.sqrt(surface.area_m2 / len(across)), surface.is_barred)


def _parted(horizontal: Horizontal, patches: Patches, chains: Chains, forced: Forced) -> Patches:
    """Return the surfaces with those of two flights parted at the slot between them; what is cut off comes last."""
    surfaces = list(patches.surfaces)
    for chain in chains.chains:
        climb = straight_climb(chain)
        if climb is None or len(chain.steps) <= _WHOLE_TREADS:
            continue
        left = np.array([-climb[1], climb[0]])
        sides = [_sides_of(horizontal, surfaces[number], left) for number in chain.steps]
        for k, number in enumerate(chain.steps):
            if number in forced.kinds:
                continue
            # A landing at the upper end may lie before both flights.
            others = [other for j, other in enumerate(sides[:-1]) if j != k]
            slot = next((slot for slot in sides[k].slots if _is_between_flights(slot, sides[k], others)), None)
            if slot is None:
                continue
            rows, level_id = surfaces[number].rows, surfaces[number].level_id
            is_left = left @ horizontal.coordinates_m[:2].take(rows, axis=1) > sum(slot) / 2.0
            # The larger part keeps the number.
            is_less = is_left if 2 * np.count_nonzero(is_left) < len(rows) else ~is_left
            is_barred = surfaces[number].is_barred
            surfaces[number] = surface_of_rows(horizontal, rows[~is_less], level_id, patches.cell_m, is_barred)
            surfaces.append(surface_of_rows(horizontal, rows[is_less], level_id, patches.cell_m, is_barred))
    return patches if len(surfaces) == len(patches.surfaces) else Patches(tuple(surfaces), patches.cell_m)


def _is_between_flights(slot: tuple[float, float], sides: Sides, others: Sequence[Sides]) -> bool:
    """Return whether a slot parts two treads, each wider than a bar, and no other tread reaches over it."""
    low = max((stop for _, stop in sides.slots if stop <= slot[0]), default=sides.low)
    high = min((start for start, _ in sides.slots if start >= slot[1]), default=sides.high)
    is_wide = min(slot[0] - low, high - slot[1]) >= _SIDE_M
    return is_wide and not any(other.reaches_over(*slot) for other in others)


def _joined(horizontal: Horizontal, patches: Patches, chains: Chains, forced: Forced) -> Patches:
    """Return the surfaces with every step's pieces put into it; the same object where there are none."""
    surfaces = list(patches.surfaces)
    used = {k for chain in chains.chains for k in (chain.base, *chain.steps)} | forced.kinds.keys()
    free = {k for k, surface in enumerate(surfaces) if k not in used and _may_be_piece(surface)}
    for chain in chains.chains:
        for number, pieces in _pieces_of(horizontal, surfaces, chain, free, patches.cell_m).items():
            whole = surfaces[number]
            rows = np.unique(np.concatenate([whole.rows, *(surfaces[k].rows for k in pieces)]))
            surfaces[number] = surface_of_rows(horizontal, rows, whole.level_id, patches.cell_m, whole.is_barred)
            for k in pieces:
                surfaces[k] = dataclasses.replace(surfaces[k], part_of=number)
            free -= set(pieces)
    is_same = all(a is b for a, b in zip(surfaces, patches.surfaces, strict=True))
    return patches if is_same else Patches(tuple(surfaces), patches.cell_m)


def _may_be_piece(surface: Surface) -> bool:
    return surface.part_of is None and surface.cells_m.shape[1] >= _FEWEST_CELLS


def _pieces_of(
    horizontal: Horizontal, surfaces: Sequence[Surface], chain: Chain, free: set[int], cell_m: float
) -> dict[int, list[int]]:
    """Return for each step of a straight flight of which pieces lie apart the numbers of those."""
    climb = straight_climb(chain)
    if climb is None or len(chain.steps) <= _WHOLE_TREADS or not free:
        return {}
    left = np.array([-climb[1], climb[0]])
    fronts = [float(middle @ climb) for middle in chain.middles]
    near: dict[int, list[int]] = {}
    for k, number in enumerate(chain.steps):
        if k + 1 < len(chain.steps) and chain.n_missing[k + 1]:
            continue
        end = fronts[k + 1] if k + 1 < len(fronts) else fronts[k] + depth_along(surfaces[number], climb)
        along = (fronts[k] - _BESIDE_CELLS * cell_m, end + priors.DEEPEST_OVERHANG_M + _BESIDE_CELLS * cell_m)
        found = [other for other in sorted(free) if _is_in_plane(surfaces[other], surfaces[number], climb, along)]
        near |= {k: found} if found else {}
    if not near:
        return {}
    sides = [_sides_of(horizontal, surfaces[number], left) for number in chain.steps]
    result: dict[int, list[int]] = {}
    for k, found in near.items():
        number, others = chain.steps[k], [other for j, other in enumerate(sides) if j != k]
        for other in found:
            across = left @ np.concatenate([surfaces[number].cells_m, surfaces[other].cells_m], axis=1)
            low, high = float(across.min()) + _BESIDE_CELLS * cell_m, float(across.max()) - _BESIDE_CELLS * cell_m
            if sum(each.reaches_over(low, high) for each in others) >= _WHOLE_TREADS:
                result.setdefault(number, []).append(other)
    return result


def _is_in_plane(piece: Surface, tread: Surface, climb: Floats, along: tuple[float, float]) -> bool:
    """Return whether a surface lies in the plane of a tread and between two places along the climb."""
    middle = piece.cells_m.mean(axis=1)
    off_m = abs(height_at(piece, middle) - height_at(tread, middle))
    if off_m > _SAME_PLANE_M + _PLANE_SIGMAS * (piece.sigma_m + tread.sigma_m):
        return False
    ahead = climb @ piece.cells_m
    return bool(along[0] <= ahead.min() and ahead.max() <= along[1])
