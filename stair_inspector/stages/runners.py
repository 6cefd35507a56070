"""On which flights lies a runner of carpet? Their treads are measured where they are bare.

A runner is a strip along the climb, some millimetres thick and narrower than the treads, on the treads and over the
nosings. On it rises and goings are those of the bare treads, but for the lowest and the highest riser, where it begins
and ends. Codes mean the stair itself: the International Residential Code takes the dimensions of treads and risers
without carpets, rugs and runners (R311.7.5, in 2024 R318.7.5). Carpet from side to side leaves nothing bare to be seen,
and is the surface that is measured.
"""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.geometry.strips import Strip, find_strip
from stair_inspector.geometry.trimmed import fit_trimmed
from stair_inspector.model import Chain, Chains, Horizontal, Note, Patches, Surface
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.climbs import straight_climb
from stair_inspector.stages.planes import STRIP_M

_MOST_TO_FIT = 8000
_FEWEST_TREADS, _ON_MOST = 2, 0.6
"""Treads that must show the strip, and their share of the flight's."""
_SAME_SIDE_M, _SAME_THICK_M, _SAME_THICK = 0.03, 0.002, 0.3
"""A runner lies straight: so much its sides may differ from tread to tread, and its thickness, and as a share of it."""
_LEAST_BARE_M = 0.06
"""Of a tread so much must be bare on one side for its edges to be found there; less on the other one is nothing."""
_MARGIN_M = 0.015
"""So far beside a runner its own edge and its shadow may lie."""
_LEAST_SHARE = 0.02
"""Of a surface's points, so many on the strip are no strays."""


def bare_treads(horizontal: Horizontal, patches: Patches, chains: Chains) -> tuple[Patches, Chains]:
    """Take runners of carpet off the treads of straight flights, and off the floor or landing before them.

    Parameters
    ----------
    horizontal, patches, chains
        Of one scan.

    Returns
    -------
    patches, chains
        The same objects where there is no runner. Else the points on it are surfaces of their own, pieces of the treads
        they lie on; the treads say between which places they are covered; and a note says what was done. A strip that
        leaves too little bare on both sides is only told of.
    """
    surfaces, notes = list(patches.surfaces), list(chains.notes)
    for chain in chains.chains:
        climb = straight_climb(chain)
        strip = None if climb is None else _strip_of(horizontal, surfaces, chain, climb)
        if climb is None or strip is None:
            continue
        is_bare = max(strip.bare_m) >= _LEAST_BARE_M
        notes.append(_note(surfaces[chain.steps[0]], strip, is_bare))
        if not is_bare:
            continue
        for number in (*chain.steps, *(() if chain.base is None else (chain.base,))):
            _take_off(horizontal, surfaces, number, chain, climb, strip, patches.cell_m)
    if len(notes) == len(chains.notes):
        return patches, chains
    return Patches(tuple(surfaces), patches.cell_m), dataclasses.replace(chains, notes=tuple(notes))


def _strip_of(horizontal: Horizontal, surfaces: Sequence[Surface], chain: Chain, climb: Floats) -> Strip | None:
    """Return the strip that lies at one place on most treads of a flight; it may lack on a landing."""
    treads = [surfaces[number] for number in chain.steps[:-1]]
    if len(treads) < _FEWEST_TREADS or any(surface.is_barred for surface in treads):
        return None
    found = []
    for surface in treads:
        rows = surface.rows[:: -(-len(surface.rows) // _MOST_TO_FIT)]
        points = horizontal.coordinates_m.take(rows, axis=1)
        strip = find_strip(climb @ points[:2], _left_of(climb) @ points[:2], points[2])
        found += [] if strip is None else [strip]
    if len(found) < max(_FEWEST_TREADS, _ON_MOST * len(treads)):
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
    if len(agree) < max(_FEWEST_TREADS, _ON_MOST * len(treads)):
        return None
    on_low, on_high = (float(np.median([strip.bare_m[side] for strip in agree])) for side in (0, 1))
    return Strip(low, high, thick_m, (on_low, on_high))


def _note(lowest: Surface, strip: Strip, is_bare: bool) -> Note:
    what = (
        f"a strip {strip.high - strip.low:.2f} m wide and {1000.0 * strip.thick_m:.0f} mm thick, as a runner of "
        f"carpet, lies along the flight whose lowest step is at {lowest.height_m:.3f} m: "
    )
    if is_bare:
        message = what + (
            "its steps are measured where they are bare beside it, as the IRC takes them (R311.7.5, without carpets, "
            "rugs and runners); who walks on it meets a first riser that is higher by the thickness, and a last one "
            "that is lower where it ends before the landing"
        )
        return Note("runner", "flights", message)
    message = what + (
        "too little is bare beside it to measure the steps there; they have two levels: the widths, and the lowest and "
        "the highest rise, may be those of either"
    )
    return Note("two_levels", "flights", message)


def _take_off(
    horizontal: Horizontal,
    surfaces: list[Surface],
    number: int,
    chain: Chain,
    climb: Floats,
    strip: Strip,
    cell_m: float,
) -> None:
    """Part the points on a runner from a surface, which keeps its number; a step knows where it is covered."""
    whole = surfaces[number]
    is_step = number in chain.steps
    is_on = _is_on_strip(horizontal.coordinates_m.take(whole.rows, axis=1), chain, climb, strip, is_step)
    bare = whole
    if np.count_nonzero(is_on) >= _LEAST_SHARE * len(whole.rows) and not is_on.all():
        piece = surface_of_rows(horizontal, whole.rows[is_on], whole.level_id, cell_m)
        surfaces.append(dataclasses.replace(piece, part_of=number))
        bare = surface_of_rows(horizontal, whole.rows[~is_on], whole.level_id, cell_m)
    covered = (
        strip.low - _MARGIN_M if strip.bare_m[0] >= _LEAST_BARE_M else -math.inf,
        strip.high + _MARGIN_M if strip.bare_m[1] >= _LEAST_BARE_M else math.inf,
    )
    surfaces[number] = dataclasses.replace(
        bare,
        bounds_m=whole.bounds_m,
        covered_m=covered if is_step else whole.covered_m,
        cover_m=strip.thick_m if is_step else whole.cover_m,
    )


def _is_on_strip(points: Floats, chain: Chain, climb: Floats, strip: Strip, is_step: bool) -> Bools:
    """Return which points (3, n) of a surface lie on a runner: between its sides, and higher than what is bare there.

    On a floor or landing it may lie on a part only, and what is far away may lean otherwise.
    """
    across, ahead = _left_of(climb) @ points[:2], climb @ points[:2]
    if is_step:
        is_near = ahead <= float(np.percentile(ahead, 1.0)) + STRIP_M
    else:
        is_near = ahead >= float(chain.middles[0] @ climb) - STRIP_M
    between = is_near & (across > strip.low - _MARGIN_M) & (across < strip.high + _MARGIN_M)
    beside = is_near & ~between & (across > strip.low - strip.bare_m[0]) & (across < strip.high + strip.bare_m[1])
    n_beside = int(np.count_nonzero(beside))
    if n_beside < 3:
        return np.zeros(points.shape[1], dtype=np.bool_)
    slope, centre, _ = fit_trimmed(points[:, beside][:, :: -(-n_beside // _MOST_TO_FIT)])
    above = points[2] - centre[2] - slope @ (points[:2] - centre[:2, None])
    is_on: Bools = between & (above > strip.thick_m / 2.0) & (above < 2.0 * strip.thick_m)
    return is_on


def _left_of(climb: Floats) -> Floats:
    return np.array([-climb[1], climb[0]])
