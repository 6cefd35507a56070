"""Where does a flight begin? A strip of floor that a scan cuts off before the first riser is no tread."""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Bools, Floats, freeze
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Chain, Chains, HeightOrder, Note, Patches, Surface
from stair_inspector.stages.rejects import Forced

_COLUMN_M = 0.04
"""Parts of a front edge in each of which is asked what lies under it: some rows of a coarse scan."""
_BELOW_M, _BELOW_SIGMAS = 0.012, 4.0
_LOWEST_SHARE = 0.8
"""Under a nosing its riser's face, or its own, lies from below the tread's noise down to this share of a rise."""
_FEWEST_UNDER = 2
_SEEN_SHARE = 0.3
"""Of a nosing's columns, those that must have something under them for its riser to be seen."""


def without_floor_strips(heights: HeightOrder, patches: Patches, chains: Chains, forced: Forced) -> Chains:
    """Let a flight that begins with a strip of floor begin behind it.

    Of a floor that is cut off by a camera's view or by the scan's end, what is left may have the size of a tread. But
    it ends in the air: where most nosings of its flight show what is under them, a riser or their own face, there is
    nothing under this one. It is then what the first riser stands on, and no step.

    Parameters
    ----------
    heights : HeightOrder
        All points, whatever their normals.
    patches, chains
        Of the same scan.
    forced : Forced
        What the user calls a tread is one.

    Returns
    -------
    Chains
        With a note for each flight whose lowest surface is taken as floor for that reason.
    """
    raised, notes = [], list(chains.notes)
    for number, chain in enumerate(chains.chains, 1):
        strip = chain.steps[0]
        is_strip = strip not in forced.those("tread") and _begins_with_floor(heights, patches.surfaces, chain)
        raised.append(_raised(chain) if is_strip else chain)
        if is_strip:
            message = (
                f"the surface before the first riser of flight {number}, at {patches.surfaces[strip].height_m:.3f} m, "
                "has nothing under its front, as a floor has that the scan cuts off: it is taken as the floor or "
                "landing; if it is a tread, the flight goes on below"
            )
            notes.append(Note("foot_unclear", "foot", message))
    return replace(chains, chains=tuple(raised), notes=tuple(notes))


def _begins_with_floor(heights: HeightOrder, surfaces: Sequence[Surface], chain: Chain) -> bool:
    if chain.base is not None or len(chain.steps) <= priors.SURE_RISERS or any(chain.n_missing[:2]):
        return False
    members = [surfaces[k] for k in chain.steps]
    edges = chain.middles[1:]
    rises = [
        b.height_at(edge) - a.height_at(edge) for (a, b), edge in zip(itertools.pairwise(members), edges, strict=True)
    ]
    rise_m = float(np.median(rises))
    seen = [
        _shows_what_is_under(heights, surface, climb, rise_m)
        for surface, climb in zip(members, chain.climbs, strict=True)
    ]
    return not seen[0] and 2 * sum(seen[1:]) > len(seen) - 1


def _shows_what_is_under(heights: HeightOrder, surface: Surface, climb: Floats, rise_m: float) -> bool:
    """Return whether points are seen under the front edge of a surface, along enough of it."""
    below_m = max(_BELOW_M, _BELOW_SIGMAS * surface.sigma_m)
    lean_m = float(np.abs(surface.slope @ (surface.cells_m - surface.centre_m[:2, None])).max())
    rows = heights.between(surface.height_m - (rise_m + lean_m), surface.height_m + lean_m)
    plan, z = heights.coordinates_m[:2, rows], heights.coordinates_m[2, rows]
    under_m = surface.centre_m[2] + surface.slope @ (plan - surface.centre_m[:2, None]) - z
    plan = plan[:, (under_m >= below_m) & (under_m <= _LOWEST_SHARE * rise_m)]
    across = left_of(climb)
    first = float((across @ surface.cells_m).min())
    columns = np.floor((across @ surface.cells_m - first) / _COLUMN_M).astype(np.int64)
    fronts = np.full(int(columns.max()) + 1, np.inf)
    np.minimum.at(fronts, columns, climb @ surface.cells_m)
    column = np.floor((across @ plan - first) / _COLUMN_M).astype(np.int64)
    is_beside: Bools = (column >= 0) & (column < len(fronts))
    column, ahead = column[is_beside], climb @ plan[:, is_beside]
    behind_m = ahead - fronts[column]
    near = (behind_m >= -priors.DEEPEST_OVERHANG_M) & (behind_m <= priors.RISER_BEHIND_M)
    counts = np.bincount(column[near], minlength=len(fronts))[np.isfinite(fronts)]
    return bool(np.count_nonzero(counts >= _FEWEST_UNDER) >= _SEEN_SHARE * len(counts))


def _raised(chain: Chain) -> Chain:
    """Return a chain without its lowest step, which becomes what the next one rises from."""
    return Chain(
        base=chain.steps[0],
        steps=chain.steps[1:],
        climbs=freeze(chain.climbs[1:].copy()),
        middles=freeze(chain.middles[1:].copy()),
        lengths_m=chain.lengths_m[1:],
        n_missing=chain.n_missing[1:],
    )
