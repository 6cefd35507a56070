"""Do heights scatter more in some places of a tread than in others, because two layers lie over each other there?

Where noise or rounding fills the gap between stations, and the order of the points is lost, nothing else shows them:
what both stations saw scatters more than what one of them saw.
"""

from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.geometry.block_scatter import BlockScatter, find_scatter
from stair_inspector.model import Chains, Examination, Note, Observation, StepShape
from stair_inspector.stages.examine import CURES, size_text
from stair_inspector.stages.layers import is_stated
from stair_inspector.stages.near_points import NearPoints

_INSET_M, _BACK_INSET_M, _SIDE_INSET_M, _REACH_M = 0.03, 0.04, 0.04, 0.03
"""What of a tread is left out beside its edges, and what lies farther off its plane."""
_RATIO, _LIKE_TWO, _SURELY_TWO, _LEAST_SHARE = 2.5, 0.35, 0.5, 0.3
"""Of two layers heights scatter so many times as much as beside them, and their kurtosis is so much of what two equal
layers have, on one tread at least the larger share: noises of two sizes have none of it, noise that neighbouring points
have in common up to half. So many of a flight's treads show it."""
_ONE_RATIO, _BESIDE_OTHERS, _NO_CLUTTER = 3.0, 1.45, -0.3
"""The same of a single tread, whose heights scatter so many times as much as those of the two nearest others. What
stands on it, or strays, has a kurtosis on the other side."""
_LEAST_APART_M = 0.002
_UNEQUAL = 1.15
"""Two layers of which one has a quarter of the points lie so much farther apart than equal ones would."""


@dataclass(frozen=True, slots=True, eq=False)
class ToldLayers:
    """A scan's flights and examination with the layers that blocks of treads show, and what is newly observed."""

    shapes: tuple[tuple[StepShape, ...], ...]
    chains: Chains
    examined: Examination
    observations: tuple[Observation, ...]


def scatter_on(near: NearPoints, extent: tuple[float, float, float, float]) -> BlockScatter | None:
    """Return how heights scatter in small blocks of a tread, from the points near it; without its edges."""
    s_low, s_high, w_low, w_high = extent
    s_high = min(s_high, s_low + priors.FLOOR_STRIP_M)
    inside = (near.s >= s_low + _INSET_M) & (near.s <= s_high - _BACK_INSET_M) & (np.abs(near.r) <= _REACH_M)
    inside &= (near.w >= w_low + _SIDE_INSET_M) & (near.w <= w_high - _SIDE_INSET_M)
    return find_scatter(near.s[inside], near.w[inside], near.r[inside])


def tell_layers(
    shapes: tuple[tuple[StepShape, ...], ...],
    chains: Chains,
    examined: Examination,
    level_from_scan: Floats,
    registration_m: float,
) -> ToldLayers:
    """Tell flights whose stations lie apart in height, and single treads that changed between stations.

    Parameters
    ----------
    shapes, chains, examined
        Of one scan.
    level_from_scan : (3, 3)
        Turns scan axes to those of the level frame.
    registration_m : float
        What is stated of the scanner: passes that lie apart no farther than that allows for are no news.

    Returns
    -------
    ToldLayers
        The same objects where nothing is double, where that is known already, and in a camera's single frame. The
        treads of a flight that is double have ``layers_m``, and the scan has them for what shows a single one. A tread
        that alone is double has both levels as a cover, and a note names it.
    """
    if len(examined.layers_m) or examined.is_view:
        return ToldLayers(shapes, chains, examined, ())
    doubled = [shape for own in shapes for shape in _doubled(own)]
    numbers = {id(shape): shape.scatter.apart_m for shape in doubled if shape.scatter is not None}
    apart_m = float(np.median(list(numbers.values()))) if numbers else 0.0
    if not is_stated(apart_m, registration_m):
        told = tuple(tuple(_with_layers(shape, numbers.get(id(shape), 0.0)) for shape in own) for own in shapes)
        layers_m = freeze(apart_m * level_from_scan[2:])
        return ToldLayers(told, chains, replace(examined, layers_m=layers_m), (_observe(apart_m, len(doubled)),))
    notes, found = [], []
    first_id = 1
    for own in shapes:
        changed = {
            k: _UNEQUAL * apart_m for k, apart_m in _changed(own).items() if not is_stated(apart_m, registration_m)
        }
        notes += [_note(first_id + k, own[k], apart_m) for k, apart_m in changed.items()]
        found.append(tuple(_with_cover(shape, changed.get(k, 0.0)) for k, shape in enumerate(own)))
        first_id += len(own)
    if not notes:
        return ToldLayers(shapes, chains, examined, ())
    return ToldLayers(tuple(found), replace(chains, notes=(*chains.notes, *notes)), examined, ())


def _doubled(shapes: tuple[StepShape, ...]) -> list[StepShape]:
    """Return the treads of a flight that show two layers, if enough of them do."""
    treads = shapes[:-1]
    found = [
        (shape.scatter.share_of_two, shape)
        for shape in treads
        if shape.scatter is not None and shape.scatter.ratio >= _RATIO and shape.scatter.apart_m >= _LEAST_APART_M
    ]
    alike = [(share, shape) for share, shape in found if share >= _LIKE_TWO]
    if len(alike) < max(2.0, _LEAST_SHARE * len(treads)) or max(share for share, _ in alike) < _SURELY_TWO:
        return []
    return [shape for _, shape in alike]


def _changed(shapes: tuple[StepShape, ...]) -> dict[int, float]:
    """Return which treads of a flight scatter as those beside them do not, and how far apart their layers lie."""
    found = {}
    scatters = [shape.scatter for shape in shapes]
    for k, own in enumerate(scatters[:-1]):
        nearest = sorted((j for j in range(len(shapes)) if j != k), key=lambda j: abs(j - k))[:2]
        beside = [each.high_m for each in (scatters[j] for j in nearest) if each is not None]
        if own is None or len(beside) < 2 or own.ratio < _ONE_RATIO or own.apart_m < _LEAST_APART_M:
            continue
        if own.high_m >= _BESIDE_OTHERS * max(beside) and own.share_of_two >= _NO_CLUTTER:
            found[k] = own.apart_m
    return found


def _with_layers(shape: StepShape, apart_m: float) -> StepShape:
    if apart_m <= shape.plane.layers_m:
        return shape
    return replace(shape, plane=replace(shape.plane, layers_m=apart_m))


def _with_cover(shape: StepShape, apart_m: float) -> StepShape:
    return replace(shape, plane=replace(shape.plane, cover_m=apart_m)) if apart_m else shape


def _observe(apart_m: float, n_treads: int) -> Observation:
    message = (
        f"surfaces are double, about {size_text(round(apart_m, 3))} apart: noise or rounding fills the gap, but "
        f"heights on {n_treads} treads scatter more where both layers lie than beside; stations that do not lie over "
        "each other"
    )
    return Observation("surfaces_doubled", "doubt", message, apart_m, CURES["surfaces_doubled"])


def _note(step_id: int, shape: StepShape, apart_m: float) -> Note:
    message = (
        f"in a part of step {step_id}, at {shape.plane.z0_m:.2f} m, heights lie up to {1000.0 * apart_m:.0f} mm apart, "
        "and on the treads beside it they do not, as where a tread changed between two stations' scans: which of the "
        "two levels is right is not known, and its uncertainties hold both; measure it by hand, or scan it again"
    )
    return Note("two_levels", "survey", message, step_id)
