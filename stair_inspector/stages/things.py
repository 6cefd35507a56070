"""Does something flat lie on a part of a single tread? A mat, a book, a plate: the tread is measured where it is bare.

A thing a few millimetres high is no surface of its own, and a plane through it and the tread leans as neither does.
"""

import dataclasses

import numpy as np

from stair_inspector.geometry.arrays import Bools, Floats
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.raised import Raised, find_raised
from stair_inspector.model import Chains, Horizontal, Note, Patches, Surface
from stair_inspector.stages.bars import surface_of_rows
from stair_inspector.stages.climbs import straight_climb

_MOST_TO_FIT = 20_000
_MOST_COVERED = 0.45
"""Share of a tread up to which a thing leaves enough bare."""
_MOST_TREADS = 1.0 / 3.0
"""What more of a flight's treads show is no single thing."""
_MOST_HIGH, _MOST_SCATTER_M, _USUAL = 0.75, 0.0015, 5.0
"""Of a tread that lies high but for a small part, that is damage. Where the cells of the other treads scatter by more
than this, a scanner's noise makes levels; and a thing is so many times as high as they scatter."""
_LEAST_BARE_M, _MARGIN_M = 0.2, 0.02
"""Of a tread's width, so much is bare beside the thing; and how far beside its cells its own edge may lie."""


def bare_of_things(horizontal: Horizontal, patches: Patches, chains: Chains) -> tuple[Patches, Chains]:
    """Take flat things off single treads of straight flights.

    Parameters
    ----------
    horizontal, patches, chains
        Of one scan.

    Returns
    -------
    patches, chains
        The same objects where there is nothing. The points on a thing are a surface of their own, a piece of the tread
        it lies on, which says between which places it is covered. Where too little is bare, or it is not known which
        level is the tread's, the height of the one over the other is a doubt about the tread and its edges. A note
        says what was done.
    """
    surfaces, notes = list(patches.surfaces), []
    for chain in chains.chains:
        climb = straight_climb(chain)
        treads = chain.steps[:-1]
        if climb is None or any(_is_settled(surfaces[number]) for number in treads):
            continue
        turn = np.stack([climb, left_of(climb)])
        found = {number: _raised_on(horizontal, surfaces[number], turn) for number in treads}
        things = {
            number: raised
            for number, raised in found.items()
            if raised is not None and _stands_out(raised, _usual_sigma_m(surfaces, treads, number))
        }
        if len(things) > max(1.0, _MOST_TREADS * len(treads)):
            continue
        for number, raised in things.items():
            is_bare = _take_off(horizontal, surfaces, number, turn, raised, patches.cell_m)
            notes.append(_note(surfaces[number], raised, is_bare))
    if not notes:
        return patches, chains
    return Patches(tuple(surfaces), patches.cell_m), dataclasses.replace(chains, notes=(*chains.notes, *notes))


def _is_settled(surface: Surface) -> bool:
    return surface.is_barred or surface.covered_m is not None or surface.cover_m > 0.0


def _stands_out(raised: Raised, usual_sigma_m: float) -> bool:
    is_quiet = usual_sigma_m <= min(_MOST_SCATTER_M, raised.high_m / _USUAL)
    return is_quiet and raised.share <= _MOST_HIGH


def _usual_sigma_m(surfaces: list[Surface], treads: tuple[int, ...], number: int) -> float:
    """Return the scatter of the cells of a flight's other treads: what a scanner adds to parts of each."""
    others = [surfaces[other].sigma_m for other in treads if other != number]
    return float(np.median(others)) if others else 0.0


def _raised_on(horizontal: Horizontal, surface: Surface, turn: Floats) -> Raised | None:
    points = horizontal.coordinates_m.take(surface.rows[:: -(-len(surface.rows) // _MOST_TO_FIT)], axis=1)
    return find_raised(turn @ points[:2], points[2])


def _take_off(
    horizontal: Horizontal, surfaces: list[Surface], number: int, turn: Floats, raised: Raised, cell_m: float
) -> bool:
    """Part what lies on a tread from it, if it is bare enough; else let its uncertainty hold both levels."""
    whole = surfaces[number]
    plan = turn @ horizontal.coordinates_m[:2].take(whole.rows, axis=1)
    is_high, is_mixed = raised.of(plan)
    is_off: Bools = is_high | is_mixed
    low, high = (float(end) for end in np.percentile(plan[1][is_high], [0.5, 99.5]))
    covered = low - _MARGIN_M, high + _MARGIN_M
    is_beside = (plan[1] < covered[0]) | (plan[1] > covered[1])
    bare_m = float(np.ptp(plan[1])) - (covered[1] - covered[0])
    if raised.share > _MOST_COVERED or bare_m < _LEAST_BARE_M or not is_beside.any():
        surfaces[number] = dataclasses.replace(whole, cover_m=raised.high_m)
        return False
    piece = surface_of_rows(horizontal, whole.rows[is_off], whole.level_id, cell_m)
    surfaces.append(dataclasses.replace(piece, part_of=number))
    bare = surface_of_rows(horizontal, whole.rows[~is_off], whole.level_id, cell_m)
    surfaces[number] = dataclasses.replace(bare, bounds_m=whole.bounds_m, aside_m=whole.aside_m, covered_m=covered)
    return True


def _note(tread: Surface, raised: Raised, is_bare: bool) -> Note:
    where = f"the tread at {tread.height_m:.2f} m lies {1000.0 * raised.high_m:.0f} mm higher than the rest of it"
    if is_bare:
        message = (
            f"{100.0 * raised.share:.0f} % of {where}, as a mat or a plate on it does: the tread is measured where it "
            "is bare; who steps on the thing has other rises there"
        )
        return Note("thing_on_tread", "flights", message)
    message = (
        f"{100.0 * raised.share:.0f} % of {where}, and which of the two levels is the tread's is not known: its "
        "uncertainties hold both; measure it by hand, or scan it without what lies there"
    )
    return Note("two_levels", "flights", message)
