"""How does a surface lie near a step? Its plane in the step's frame, how sure it is, and how it was sampled."""

import math

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, Ints, freeze, project
from stair_inspector.geometry.percentiles import mad_sigma, median
from stair_inspector.geometry.plan import left_of
from stair_inspector.geometry.trimmed import fit_trimmed
from stair_inspector.model import Horizontal, LocalPlane, Surface

FINE_M = 0.02
"""Side of the blocks to whose means a plane is fitted."""
_BLOCK_M = 0.08
"""Side of the blocks whose scatter tells how sure the plane is: larger than what noise has in common."""
_MOST_TO_FIT = 30_000
_LEAST_SIGMA_M = 1e-4
_LAYERS_REACH_M, _MOST_FOR_LAYERS, _FEWEST_FOR_LAYERS = 0.03, 4000, 60
_LEAST_OF_LAYER = 0.1
_LAYERS_APART = 4.2
"""Distance of the halves of a distribution over the deviation within them: 2.6 if it is normal, 3.5 if it is even."""
_LAYERS_SHARE = 0.4
"""Share of a surface's blocks in which both layers must be seen."""


def fit_local(
    horizontal: Horizontal,
    surface: Surface,
    origin: Floats,
    climb: Floats,
    extent: tuple[float, float, float, float],
) -> LocalPlane:
    """Fit the plane of a surface within an extent of a step's frame, from its upright points.

    For a tread it is the patch's own; of a floor or landing only the part near the edge counts, which may lean
    otherwise than the whole.
    """
    left = left_of(climb)
    # Tens of thousands of points give a plane as well as hundreds of thousands.
    stride = -(-len(surface.rows) // _MOST_TO_FIT)
    rows = horizontal.coordinates_m.take(surface.rows[::stride], axis=1)
    plan = rows[:2] - origin[:, None]
    s, w = project(plan, climb), project(plan, left)
    s_low, s_high, w_low, w_high = extent
    if float(s.max()) - s_low <= priors.FLOOR_STRIP_M:
        rough = surface.height_at(origin), float(surface.slope @ climb), float(surface.slope @ left)
        return plane_of(s, w, rows[2], rough, stride)
    within = (s >= s_low) & (s <= min(s_high, s_low + priors.FLOOR_STRIP_M)) & (w >= w_low) & (w <= w_high)
    if np.count_nonzero(within) < 10:
        within = np.ones(len(s), dtype=np.bool_)
    s, w, z = s[within], w[within], rows[2][within]
    blocks, counts = block_means(s, w, z, FINE_M)
    full = blocks[:, counts >= 0.3 * median(counts)]
    slope, centre, _ = fit_trimmed(full)
    z0 = float(centre[2] - slope @ centre[:2])
    return plane_of(s, w, z, (z0, float(slope[0]), float(slope[1])), stride)


def plane_of(s: Floats, w: Floats, z: Floats, numbers: tuple[float, float, float], stride: int = 1) -> LocalPlane:
    """Return a plane with its noise, spacing, misfit and covariance, from every ``stride``-th of its points."""
    z0, slope = numbers[0], numbers[1:]
    residual = z - z0 - slope[0] * s - slope[1] * w
    sigma_m = max(mad_sigma(residual), _LEAST_SIGMA_M)
    kept = np.abs(residual) <= 4.0 * sigma_m
    large, _ = block_means(s[kept], w[kept], residual[kept], _BLOCK_M, minimum=3)
    # Blocks without points are in the numbering too.
    fine_counts = np.bincount(_block_keys(s[kept], w[kept], FINE_M)) if kept.any() else np.zeros(0)
    # Cells on the rim are only partly on the surface: the usual cell tells the spacing.
    per_cell = stride * median(fine_counts[fine_counts > 0]) if fine_counts.size else 1.0
    spacing_m = FINE_M / math.sqrt(per_cell)
    if per_cell <= stride and kept.any():
        # Of a sparse scan each small block that is occupied holds one point, however far apart they lie.
        coarse_counts = np.bincount(_block_keys(s[kept], w[kept], _BLOCK_M))
        per_block = stride * float(np.percentile(coarse_counts[coarse_counts > 0], 75.0))
        spacing_m = max(spacing_m, _BLOCK_M / math.sqrt(per_block))
    n_kept = int(np.count_nonzero(kept))
    covariance = _covariance(large, sigma_m, n_kept, s, w)
    scatter = float(np.var(large[2])) if large.shape[1] else 0.0
    misfit_m = math.sqrt(max(0.0, scatter - sigma_m**2 * large.shape[1] / max(n_kept, 1)))
    layers_m = find_layers(s, w, residual)
    return LocalPlane(z0, slope, freeze(covariance), sigma_m, spacing_m, misfit_m, stride * n_kept, layers_m)


def find_layers(s: Floats, w: Floats, residual: Floats) -> float:
    """Return how far apart the two layers lie that a surface is made of, 0 where it is one.

    Notes
    -----
    Otsu's threshold parts the distances from the plane in two. Two layers are much farther apart than each is thick,
    which no single noise is, be it normal or even; and they lie in the same places, which a nosing strip, a wedge or
    a worn hollow does not. Where one station saw the front and another the back, the surface alone does not tell.

    References
    ----------
    .. [1] Otsu: A threshold selection method from gray-level histograms, IEEE Trans. SMC 9, 1979.
    """
    near = np.flatnonzero(np.abs(residual - median(residual)) <= _LAYERS_REACH_M)
    near = near[:: -(-len(near) // _MOST_FOR_LAYERS) or 1]
    n = len(near)
    if n < _FEWEST_FOR_LAYERS:
        return 0.0
    ordered = np.sort(residual[near])
    count = np.arange(1, n)
    sums = np.cumsum(ordered)
    low, high = sums[:-1] / count, (sums[-1] - sums[:-1]) / (n - count)
    between = count * (n - count) * (high - low) ** 2
    # Beyond, the smaller of both would be a few stray points.
    least = math.ceil(_LEAST_OF_LAYER * n)
    k = least - 1 + int(np.argmax(between[least - 1 : n - least]))
    within = float(ordered.var()) - float(between[k]) / n**2
    apart_m = float(high[k] - low[k])
    if apart_m**2 < _LAYERS_APART**2 * within:
        return 0.0
    is_high = residual[near] > 0.5 * (low[k] + high[k])
    keys = _block_keys(s[near], w[near], _BLOCK_M)
    counts = np.bincount(keys)
    shares = np.bincount(keys, is_high)[counts > 0] / counts[counts > 0]
    is_both = (shares >= _LEAST_OF_LAYER) & (shares <= 1.0 - _LEAST_OF_LAYER)
    return apart_m if float(is_both.mean()) >= _LAYERS_SHARE else 0.0


def block_means(s: Floats, w: Floats, value: Floats, side_m: float, minimum: int = 1) -> tuple[Floats, Floats]:
    """Return the means (3, b) of s, w and a value over square blocks, and the number of points of each."""
    if not s.size:
        return np.zeros((3, 0)), np.zeros(0)
    keys = _block_keys(s, w, side_m)
    counts = np.bincount(keys).astype(np.float64)
    chosen = counts >= minimum
    means = np.stack([np.bincount(keys, axis)[chosen] / counts[chosen] for axis in (s, w, value)])
    return means, counts[chosen]


def _block_keys(s: Floats, w: Floats, side_m: float) -> Ints:
    """Return a number for the square block of each of at least one point, none negative."""
    column, row = np.floor(s / side_m).astype(np.int64), np.floor(w / side_m).astype(np.int64)
    column -= column.min()
    row -= row.min()
    keys: Ints = column * (int(row.max()) + 1) + row
    return keys


def _covariance(blocks: Floats, sigma_m: float, n: int, s: Floats, w: Floats) -> Floats:
    """Return the covariance (3, 3) of a plane's constant and slopes from the scatter of block means."""
    n_blocks = blocks.shape[1]
    if n_blocks < 6:
        # Too few blocks to tell: as if every block had the noise of a single point.
        design = np.stack([np.ones(len(s)), s, w])
        normal = np.einsum("in,jn->ij", design, design) * (max(n_blocks, 1) / max(len(s), 1))
        rough: Floats = np.linalg.pinv(normal) * sigma_m**2
        return rough
    design = np.stack([np.ones(n_blocks), blocks[0], blocks[1]])
    normal = np.einsum("in,jn->ij", design, design)
    inverse = np.asarray(np.linalg.pinv(normal))
    fit = inverse @ (design @ blocks[2])
    left_over = blocks[2] - fit @ design
    variance = float(left_over @ left_over) / (n_blocks - 3)
    covariance: Floats = inverse * max(variance, sigma_m**2 * n_blocks / max(n, 1))
    return covariance
