"""On which flights lies a runner of carpet? Their treads are measured where they are bare.

A runner is a strip along the climb, some millimetres thick and narrower than the treads, on the treads and over the
nosings. On it rises and goings are those of the bare treads, but for the lowest and the highest riser, where it begins
and ends. Codes mean the stair itself: the International Residential Code takes the dimensions of treads and risers
without carpets, rugs and runners (R311.7.5, in 2024 R318.7.5). Carpet from side to side leaves nothing bare to be seen,
and is the surface that is measured.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.strips import Strip, find_strip
from stair_inspector.geometry.trimmed import fit_trimmed
from stair_inspector.model import Chain, Chains, Horizontal, Note, Patches, Surface
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.climbs import straight_climb

_MOST_TO_FIT = 4000
_FEWEST_TREADS, _ON_MOST = 2, 0.6
"""Treads that must show the strip, and their share of the flight's."""
_SAME_SIDE_M, _SAME_THICK_M, _SAME_THICK = 0.03, 0.002, 0.3
"""A runner lies straight: so much its sides may differ from tread to tread, and its thickness, and as a share of it."""
_LEAST_BARE_M = 0.09
"""Of every tread so much must be bare on both sides: heights in the middle lie between what is seen there. Beside a
runner on one side they would lie beyond it, where the slope of a narrow strip says little."""
_ASIDE_M = 0.03
"""The bare sides of a strip are known to half a column each, and to what its shadow hides."""
_DENSE_M = 0.012
"""Distance of points up to which the faces of the risers beside a runner and under it are told apart."""
_MARGIN_M = 0.015
"""So far beside a runner its own edge and its shadow may lie."""
_LEAST_SHARE = 0.02
"""Of a surface's points, so many on the strip are no strays."""


@dataclass(frozen=True, slots=True)
class _Runner(Strip):
    """A strip that lies at one place on most treads of a flight, and on how many of them."""

    n_treads: int


def bare_treads(horizontal: Horizontal, patches: Patches, chains: Chains) -> tuple[Patches, Chains]:
    """Take runners of carpet off the treads of straight flights, and off the floor or landing before them.

    Parameters
    ----------
    horizontal, patches, chains
        Of one scan.

    Returns
    -------
    patches, chains
        The same objects where there is no runner. Where it lies on all treads and each is bare on both sides, the
        points on it are surfaces of their own, pieces of the treads they lie on; the treads say between which places
        they are covered. Any other strip stays where it is, and its thickness is a doubt about the flight's surfaces
        and edges. A note says what was done.
    """
    surfaces, notes = list(patches.surfaces), list(chains.notes)
    for chain in chains.chains:
        climb = straight_climb(chain)
        strip = None if climb is None else _strip_of(horizontal, surfaces, chain, climb)
        if climb is None or strip is None:
            continue
        numbers = (*chain.steps, *(() if chain.base is None else (chain.base,)))
        is_on = {
            number: _is_on_strip(
                horizontal.coordinates_m.take(surfaces[number].rows, axis=1), chain, climb, strip, number in chain.steps
            )
            for number in numbers
        }
        is_bare = _can_be_bare(surfaces, chain, strip, is_on)
        notes.append(_note(strip, surfaces[chain.steps[0]], is_bare))
        for number in numbers:
            if is_bare:
                _take_off(horizontal, surfaces, number, chain, strip, is_on[number], patches.cell_m)
            elif number in chain.steps:
                # The side edges, too, may be those of the strip.
                aside_m = max(_ASIDE_M + sum(strip.bare_m), surfaces[number].aside_m)
                surfaces[number] = dataclasses.replace(surfaces[number], cover_m=strip.thick_m, aside_m=aside_m)
    if len(notes) == len(chains.notes):
        return patches, chains
    return Patches(tuple(surfaces), patches.cell_m), dataclasses.replace(chains, notes=tuple(notes))


def _strip_of(horizontal: Horizontal, surfaces: Sequence[Surface], chain: Chain, climb: Floats) -> _Runner | None:
    """Return the strip that lies at one place on most treads of a flight; it may lack on a landing."""
    treads = [surfaces[number] for number in chain.steps[:-1]]
    if len(treads) < _FEWEST_TREADS or any(surface.is_barred for surface in treads):
        return None
    found = []
    for surface in treads:
        rows = surface.rows[:: -(-len(surface.rows) // _MOST_TO_FIT)]
        points = horizontal.coordinates_m.take(rows, axis=1)
        strip = find_strip(climb @ points[:2], left_of(climb) @ points[:2], points[2])
        found += [] if strip is None else [strip]
    fewest = max(_FEWEST_TREADS, _ON_MOST * len(treads))
    if len(found) < fewest:
        return None
    low = float(np.median([strip.low for strip in found]))
    high = float(np.median([strip.high for strip in found]))
    thick_m = float(np.median([strip.thick_m for strip in found]))
    agree = [
        strip
        for strip in found
        if max(abs(strip.low - low), abs(strip.high - high)) <= _SAME_SIDE_M
        and abs(strip.thick_m - thick_m) <= max(_SAME_THICK_M, _SAME_THICK * thick_m)
    ]
    if len(agree) < fewest:
        return None
    on_low, on_high = (float(np.median([strip.bare_m[side] for strip in agree])) for side in (0, 1))
    return _Runner(low, high, thick_m, (on_low, on_high), len(agree))


def _can_be_bare(surfaces: Sequence[Surface], chain: Chain, strip: _Runner, is_on: Mapping[int, Bools]) -> bool:
    """Return whether every tread of a flight shows the strip, and enough of itself on both sides of it.

    Where one lacks it, or lies elsewhere under it as where a flight curves, some nosings would be those of the carpet
    and others bare ones.
    """
    treads = chain.steps[:-1]
    spacings = [surfaces[number].spacing_m for number in treads]
    return (
        min(strip.bare_m) >= _LEAST_BARE_M
        and max(spacings) <= _DENSE_M
        and strip.n_treads == len(treads)
        and all(_is_cut(is_on[number]) for number in treads)
    )


def _is_cut(is_on: Bools) -> bool:
    return bool(np.count_nonzero(is_on) >= _LEAST_SHARE * len(is_on) and not is_on.all())


def _note(strip: _Runner, lowest: Surface, is_bare: bool) -> Note:
    what = (
        f"a strip {strip.high - strip.low:.2f} m wide and {1000.0 * strip.thick_m:.0f} mm thick, as a runner of "
        f"carpet, lies along the flight whose lowest tread is at {lowest.height_m:.2f} m: "
    )
    if is_bare:
        message = what + (
            "its steps are measured where they are bare beside it, as the IRC takes them (R311.7.5, without carpets, "
            "rugs and runners); where the strip begins and ends the riser under foot differs by its thickness: measure "
            "those two by hand if they matter"
        )
        return Note("runner", "flights", message)
    message = what + (
        "it leaves too little of the treads bare, or does not lie on all of them; each edge may be that of the strip "
        "or of the tread, which the uncertainties hold: measure by hand, or scan the stair without it"
    )
    return Note("two_levels", "flights", message)


def _take_off(
    horizontal: Horizontal,
    surfaces: list[Surface],
    number: int,
    chain: Chain,
    strip: _Runner,
    is_on: Bools,
    cell_m: float,
) -> None:
    """Part the points on a runner from a surface, which keeps its number; a step knows where it is covered."""
    whole = bare = surfaces[number]
    # Not on a landing at which the runner ends, or a floor before which it begins.
    if _is_cut(is_on):
        piece = surface_of_rows(horizontal, whole.rows[is_on], whole.level_id, cell_m)
        surfaces.append(dataclasses.replace(piece, part_of=number))
        bare = surface_of_rows(horizontal, whole.rows[~is_on], whole.level_id, cell_m)
    # Where it ends at a landing's nosing it still covers the riser below.
    covered = (strip.low - _MARGIN_M, strip.high + _MARGIN_M) if number in chain.steps else whole.covered_m
    surfaces[number] = dataclasses.replace(bare, bounds_m=whole.bounds_m, aside_m=whole.aside_m, covered_m=covered)


def _is_on_strip(points: Floats, chain: Chain, climb: Floats, strip: _Runner, is_step: bool) -> Bools:
    """Return which points (3, n) of a surface lie on a runner: between its sides, and higher than what is bare there.

    On a floor or landing it may lie on a part only, and what is far away may lean otherwise.
    """
    across, ahead = left_of(climb) @ points[:2], climb @ points[:2]
    if is_step:
        is_near = ahead <= float(np.percentile(ahead, 1.0)) + priors.FLOOR_STRIP_M
    else:
        is_near = ahead >= float(chain.middles[0] @ climb) - priors.FLOOR_STRIP_M
    between = is_near & (across > strip.low - _MARGIN_M) & (across < strip.high + _MARGIN_M)
    beside = is_near & ~between & (across > strip.low - strip.bare_m[0]) & (across < strip.high + strip.bare_m[1])
    n_beside = int(np.count_nonzero(beside))
    if n_beside < 3:
        return np.zeros(points.shape[1], dtype=np.bool_)
    slope, centre, _ = fit_trimmed(points[:, beside][:, :: -(-n_beside // _MOST_TO_FIT)])
    above = points[2] - centre[2] - slope @ (points[:2] - centre[:2, None])
    is_on: Bools = between & (above > strip.thick_m / 2.0) & (above < 2.0 * strip.thick_m)
    return is_on
