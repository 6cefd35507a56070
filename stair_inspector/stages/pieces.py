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
from stair_inspector.geometry.arrays import Floats, Ints
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.slots import Sides, find_slots, with_common_slots
from stair_inspector.model import Chain, Chains, HeightOrder, Horizontal, Note, Patches, Surface
from stair_inspector.params import FlightsParams
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.climbs import straight_climb
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.foot import without_floor_strips
from stair_inspector.stages.links import depth_along
from stair_inspector.stages.narrow_slots import find_narrow_slot, note_of_narrow_slot
from stair_inspector.stages.rejects import Forced
from stair_inspector.stages.runners import bare_treads
from stair_inspector.stages.split_flights import with_unseen_strips
from stair_inspector.stages.thick_runners import with_bare_sides
from stair_inspector.stages.things import bare_of_things
from stair_inspector.stages.undersides import find_steps_from_below

_ROUNDS = 3
"""A piece that is joined may let the flight go on, and so find the pieces of the next tread."""
_SAME_PLANE_M, _PLANE_SIGMAS = 0.005, 3.0
"""A piece lies no farther off a tread's plane than both: treads lean, and what is seen of one says little about how."""
_WHOLE_TREADS = 2
"""So many other treads of the flight must reach over the piece and the tread without a gap."""
_BESIDE_CELLS = 2.0
"""Cells on the rim of a surface are partly filled: so far a piece may lie outside of where it should."""
_FEWEST_CELLS = 4
_HOLE_M = 1.0
"""Below a tripod a landing is not seen; what lies behind is a piece of it, where it is no wider than the flight."""
_FEWEST_GAPS = 3
"""So many gaps on each tread are those of bars along the climb."""


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
        numbers and say of which surface they are part. Under a runner of carpet it holds what is bare.
    chains : Chains
        Of these surfaces, without strips of floor.
    """
    chains = find_chains(patches, params, least_area_m2, forced)
    lower = find_steps_from_below(heights, patches, chains.chains) - forced.kinds.keys()
    if lower:
        forced = dataclasses.replace(forced, kinds={**forced.kinds, **dict.fromkeys(lower, "rejected")})
        chains = find_chains(patches, params, least_area_m2, forced)
    whole = with_bare_sides(horizontal, patches, chains, forced)
    if whole is not patches:
        patches, chains = whole, find_chains(whole, params, least_area_m2, forced)
    for _ in range(_ROUNDS):
        better = _joined(horizontal, _parted(heights, horizontal, patches, chains, forced), chains, forced)
        if better is patches:
            break
        patches = better
        chains = find_chains(patches, params, least_area_m2, forced)
    chains = without_floor_strips(heights, patches, chains, forced)
    patches, joints = _with_narrow_slots(heights, horizontal, patches, chains)
    patches, strips = with_unseen_strips(heights, horizontal, patches, chains, forced)
    if strips:
        chains = without_floor_strips(heights, patches, find_chains(patches, params, least_area_m2, forced), forced)
        chains = dataclasses.replace(chains, notes=(*chains.notes, *strips))
    doubts = joints + [_note_of_underside(patches.surfaces[number]) for number in sorted(lower)]
    doubts += [note for chain in chains.chains for note in _note_of_bars(horizontal, patches, chain)]
    chains = dataclasses.replace(chains, notes=(*chains.notes, *doubts)) if doubts else chains
    return bare_of_things(horizontal, *bare_treads(horizontal, _with_common_bounds(patches, chains), chains))


def _note_of_underside(surface: Surface) -> Note:
    message = (
        f"the surface at {surface.height_m:.3f} m is the underside of a tread, whose edge stands above it, and is no "
        "step: what was seen of the tread from above is measured; scan from higher up as well"
    )
    return Note("underside", "flights", message)


def _with_common_bounds(patches: Patches, chains: Chains) -> Patches:
    """Let all treads of a flight end where those do that were parted from the flight beside it.

    Of two flights of bars some treads lie far enough apart by themselves. A landing may lie before both.
    """
    surfaces = list(patches.surfaces)
    for chain in chains.chains:
        treads = [number for number in chain.steps if surfaces[number].is_barred]
        bounds = np.array([surfaces[number].bounds_m for number in treads]).reshape(-1, 2)
        if not np.isfinite(bounds).any():
            continue
        common = [
            float(np.median(finite)) if len(finite := side[np.isfinite(side)]) else unbounded
            for side, unbounded in zip(bounds.T, (-math.inf, math.inf), strict=True)
        ]
        for number, (low, high) in zip(treads, bounds, strict=True):
            limits = (float(low) if np.isfinite(low) else common[0], float(high) if np.isfinite(high) else common[1])
            surfaces[number] = dataclasses.replace(surfaces[number], bounds_m=limits)
    return Patches(tuple(surfaces), patches.cell_m)


def _with_narrow_slots(
    heights: HeightOrder, horizontal: Horizontal, patches: Patches, chains: Chains
) -> tuple[Patches, list[Note]]:
    """Let the widths of flights that a narrow gap may part in two hold either half, and say so."""
    surfaces, notes = list(patches.surfaces), []
    for chain in chains.chains:
        climb = straight_climb(chain)
        slot = None if climb is None else find_narrow_slot(heights, horizontal, surfaces, chain, climb)
        if climb is None or slot is None:
            continue
        for number in chain.steps:
            across = left_of(climb) @ surfaces[number].cells_m
            more_m = max(slot.high - float(across.min()), float(across.max()) - slot.low) + patches.cell_m
            surfaces[number] = dataclasses.replace(surfaces[number], aside_m=more_m)
        notes.append(note_of_narrow_slot(slot, chain, surfaces))
    return (Patches(tuple(surfaces), patches.cell_m) if notes else patches), notes


def _note_of_bars(horizontal: Horizontal, patches: Patches, chain: Chain) -> list[Note]:
    """Say of a flight of bars along its climb, wide enough for two, that a gap as between bars may lie between two."""
    climb = straight_climb(chain)
    barred = [patches.surfaces[number] for number in chain.steps if patches.surfaces[number].is_barred]
    if climb is None or len(barred) <= len(chain.steps) // 2:
        return []
    left = left_of(climb)
    sides = [_sides_of(horizontal, surface, left) for surface in barred]
    width_m = float(np.median([each.high - each.low for each in sides]))
    gaps_m = [stop - start for each in sides for start, stop in each.gaps]
    if len(gaps_m) < _FEWEST_GAPS * len(sides) or width_m < 2.0 * priors.NARROWEST_FLIGHT_M:
        return []
    lowest_m = patches.surfaces[chain.steps[0]].height_m
    message = (
        f"the flight whose lowest step is at {lowest_m:.3f} m is {width_m:.2f} m wide, and gaps of about "
        f"{1000.0 * float(np.median(gaps_m)):.0f} mm run through its treads from front to back: two flights side by "
        "side with such a gap between them look the same; if it is two, each is narrower than what is given here"
    )
    return [Note("flights_may_be_two", "flights", message)]


def _sides_of(horizontal: Horizontal, surface: Surface, left: Floats) -> Sides:
    across = left @ horizontal.coordinates_m[:2].take(surface.rows, axis=1)
    return find_slots(across, surface.spacing_m, surface.is_barred)


def _sides_of_steps(horizontal: Horizontal, surfaces: Sequence[Surface], chain: Chain, left: Floats) -> list[Sides]:
    """Return the sides and slots of all steps of a chain; of bars the gaps on all treads tell which are slots."""
    sides = [_sides_of(horizontal, surfaces[number], left) for number in chain.steps]
    barred = [k for k, number in enumerate(chain.steps) if surfaces[number].is_barred]
    if len(barred) > _WHOLE_TREADS:
        known = [slot for k, each in enumerate(sides) if k not in barred for slot in each.slots]
        for k, better in zip(barred, with_common_slots([sides[k] for k in barred], known), strict=True):
            sides[k] = better
    return sides


def _parted(heights: HeightOrder, horizontal: Horizontal, patches: Patches, chains: Chains, forced: Forced) -> Patches:
    """Return the surfaces with those of two flights parted at the slot between them; what is cut off comes last."""
    surfaces = list(patches.surfaces)
    for chain in chains.chains:
        climb = straight_climb(chain)
        if climb is None or len(chain.steps) <= _WHOLE_TREADS:
            continue
        left = left_of(climb)
        sides = _sides_of_steps(horizontal, surfaces, chain, left)
        narrow = find_narrow_slot(heights, horizontal, surfaces, chain, climb)
        if narrow is not None and narrow.is_through:
            sides = [narrow.of_step(each, k + 1 < len(sides)) for k, each in enumerate(sides)]
        for k, number in enumerate(chain.steps):
            if number in forced.kinds:
                continue
            # A landing at the upper end may lie before both flights.
            others = [other for j, other in enumerate(sides[:-1]) if j != k]
            slot = next((slot for slot in sides[k].slots if _is_between_flights(slot, sides[k], others)), None)
            if slot is None:
                continue
            rows, (low, high), middle = surfaces[number].rows, surfaces[number].bounds_m, sum(slot) / 2.0
            is_left = left @ horizontal.coordinates_m[:2].take(rows, axis=1) > middle
            parts = [
                _with_rows(horizontal, surfaces[number], rows[~is_left], patches.cell_m, (low, middle)),
                _with_rows(horizontal, surfaces[number], rows[is_left], patches.cell_m, (middle, high)),
            ]
            # The larger part keeps the number.
            if 2 * np.count_nonzero(is_left) >= len(rows):
                parts.reverse()
            surfaces[number] = parts[0]
            surfaces.append(parts[1])
    return patches if len(surfaces) == len(patches.surfaces) else Patches(tuple(surfaces), patches.cell_m)


def _with_rows(
    horizontal: Horizontal, surface: Surface, rows: Ints, cell_m: float, bounds_m: tuple[float, float]
) -> Surface:
    """Return the surface that other rows form, of the same kind as a surface, and between which bounds it lies."""
    changed = surface_of_rows(horizontal, rows, surface.level_id, cell_m, surface.is_barred)
    return dataclasses.replace(changed, bounds_m=bounds_m)


def _is_between_flights(slot: tuple[float, float], sides: Sides, others: Sequence[Sides]) -> bool:
    """Return whether a slot parts two treads, each wider than a bar, and no other tread reaches over it."""
    low = max((stop for _, stop in sides.slots if stop <= slot[0]), default=sides.low)
    high = min((start for start, _ in sides.slots if start >= slot[1]), default=sides.high)
    is_wide = min(slot[0] - low, high - slot[1]) >= priors.WIDEST_BAR_M
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
            surfaces[number] = _with_rows(horizontal, whole, rows, patches.cell_m, whole.bounds_m)
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
    left = left_of(climb)
    fronts = [float(middle @ climb) for middle in chain.middles]
    near: dict[int, list[int]] = {}
    for k, number in enumerate(chain.steps):
        if k + 1 < len(chain.steps) and chain.n_missing[k + 1]:
            continue
        end = fronts[k + 1] if k + 1 < len(fronts) else fronts[k] + depth_along(surfaces[number], climb) + _HOLE_M
        along = (fronts[k] - _BESIDE_CELLS * cell_m, end + priors.DEEPEST_OVERHANG_M + _BESIDE_CELLS * cell_m)
        found = [other for other in sorted(free) if _is_in_plane(surfaces[other], surfaces[number], climb, along)]
        near |= {k: found} if found else {}
    if not near:
        return {}
    sides = _sides_of_steps(horizontal, surfaces, chain, left)
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
    off_m = abs(piece.height_at(middle) - tread.height_at(middle))
    if off_m > _SAME_PLANE_M + _PLANE_SIGMAS * (piece.sigma_m + tread.sigma_m):
        return False
    ahead = climb @ piece.cells_m
    return bool(along[0] <= ahead.min() and ahead.max() <= along[1])
