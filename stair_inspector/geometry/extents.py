"""Where does a surface end by its own points? Edges from integrals of density, and from the last points before them.

Coordinates as in :mod:`stair_inspector.geometry.edges`.
"""

import dataclasses
import math

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine, Half, Sampling, count_bins, fit_line_robust
from stair_inspector.geometry.percentiles import median, percentile_of_sorted

_PER_COLUMN = 5.0
"""Points that a column of a piece of the surface should hold, lest it be empty by chance."""
_INNER_M = 0.06
"""Strip behind the edge in which the density of the surface is taken."""
_OUTER_M = 0.12
"""How far outside the first guess an edge is looked for."""
_EVENNESS = 0.6
"""Scatter of counts on a scan thinned to a grid, as a share of a Poisson process's (measured on simulated scans)."""
_LEAST_INNER = 6
"""Pieces of an edge behind which fewer points lie are hidden by an obstacle and say nothing about it."""
_HALF = 0.5
_HOLE, _SHADOW = 0.6, 0.4
_BLUR_SIGMAS, _SHARP_SPACINGS, _SHARP_SIGMAS = 1.5, 0.35, 2.0
_SHARP_ROUNDS, _SHARP_SETTLED_M, _FEWEST_BEHIND, _STRAYS = 12, 0.00005, 24, 3
"""The last strip of a surface: behind what noise blurs, a part of the points' distance deep or twice the noise."""
_MOST_BLUR = 0.5
_FRAYED_SIGMAS, _THIN_SIGMAS, _THIN_SHARE = 2.5, 3.0, 0.7
_TURN_SIGMAS, _MOVED_SPACINGS = 3.0, 2.0
_SEARCHED = 1.25
"""Where the strip ends is found by the same points, by whose chance it is drawn to thin places."""
_ROWS_APART, _FEWEST_ROWS, _ROWS_DEEP = (0.3, 2.5), 2.5, 2.5
"""How far rows of points may lie apart, in spacings of the points; how many rows, and how many spacings, the strip
behind an edge holds in which they are looked for: farther in they lie otherwise apart."""
_FEWEST_IN_ROWS, _MOST_IN_ROWS, _ROWS_SHARP, _ROWS_SURE, _ROW_FILLED = 36, 240, 0.45, 12.0, 1.0 / 3.0
"""Points that are needed, and enough, to find rows; how much of a single wave they follow at least, and so many of them
that chance does not; the last row holds this share of a usual one's points."""
_WAVE_STEP = 0.2
"""From one distance of rows that is tried to the next, the waves in the strip grow by so much of one."""


def find_extent_edge(
    out: Floats,
    along: Floats,
    offset: Floats,
    span: tuple[float, float],
    guess_m: float,
    sampling: Sampling,
    half: Half,
    is_square: bool = False,
) -> EdgeLine | None:
    """Find an edge from where the points of the surface end.

    Parameters
    ----------
    out, along, offset : (n,)
        Points near the surface's plane and near the edge; others do no harm but cost time.
    span : (low, high)
        Range along the edge.
    guess_m : float
        First guess of the edge, not farther outside than 60 mm.
    sampling : Sampling
        Noise and spacing of the surface.
    half : {"all", "above", "below"}
        Which side of the plane to use: where a face goes down from the edge its points lie below the plane, so that
        only those above it belong to the surface for certain, and the reverse at the foot of a wall.
    is_square : bool
        Whether the edge is known to run along ``along``, without a slope.

    Returns
    -------
    EdgeLine or None
        None where too little of the edge was seen.

    Notes
    -----
    In each piece along the edge: the number of points beyond a line well inside the surface, over the density of the
    surface behind that line, is the distance of the edge from the line. Symmetric noise does not move it, since it only
    carries points to and fro, and stray points matter by their number and not by how far they stray.
    """
    is_half = np.ones(len(out), dtype=np.bool_)
    if half == "above":
        is_half = offset > 0.0
    elif half == "below":
        is_half = offset < 0.0
    low, high = span
    n_bins = count_bins(span, sampling)
    inside = is_half & (along > low) & (along < high) & (out > guess_m - 2.0 * _INNER_M) & (out < guess_m + _OUTER_M)
    out, piece = out[inside], ((along[inside] - low) / (high - low) * n_bins).astype(np.int64)
    # Half of the surface's points are used where there is a face.
    per_column = _PER_COLUMN * (1.0 if half == "all" else 2.0)
    fine_m = max(0.002, sampling.spacing_m, per_column * sampling.spacing_m**2 * n_bins / (high - low))
    fine_m = min(fine_m, _INNER_M / 2.0)
    n_fine = int((2.0 * _INNER_M + _OUTER_M) / fine_m) + 1
    column = ((out - guess_m + 2.0 * _INNER_M) / fine_m).astype(np.int64)
    counts = np.bincount(piece * n_fine + column, minlength=n_bins * n_fine).reshape(n_bins, n_fine).astype(np.float64)
    n_inner = max(2, int(_INNER_M / fine_m))
    # The shadow of a rail runs all along the edge: told by all pieces together, where chance evens out.
    profile = counts.sum(axis=0)
    is_whole = profile >= _SHADOW * percentile_of_sorted(np.sort(profile[: 2 * n_inner]), 75.0)
    is_whole[:n_inner] |= not is_whole[:n_inner].any()
    density = counts[:, :n_inner][:, is_whole[:n_inner]].mean(axis=1)
    if not density.any():
        return None
    # Strips of two and three columns: one alone may be empty by chance.
    smooth = counts.copy()
    smooth[:, 1:-1] = (counts[:, :-2] + counts[:, 1:-1] + counts[:, 2:]) / 3.0
    is_on = smooth >= _HALF * density[:, None]
    is_on[:, :n_inner] = True
    # The outermost pair of filled columns: a hole nearer by, or the shadow of a rail, is not the edge.
    pairs = is_on[:, :-1] & is_on[:, 1:]
    coarse = n_fine - np.argmax(pairs[:, ::-1], axis=1)
    edges, places, sigmas = [], [], []
    reach = max(2.0 * fine_m, 3.0 * sampling.sigma_m)
    n_reach = math.ceil(reach / fine_m)
    for k in range(n_bins):
        # An edge that is never reached, or lies where the first guess would have to be far too large, is none.
        if density[k] * n_inner < _LEAST_INNER or coarse[k] >= n_fine - 1:
            continue
        inner_stop = max(2, int(coarse[k]) - n_reach)
        inner = slice(max(0, inner_stop - n_inner), inner_stop)
        rho = float(counts[k, inner][is_whole[inner]].mean()) if is_whole[inner].any() else 0.0
        if rho < _HOLE * density[k]:
            # A hole lies there; farther inside the surface is whole.
            rho = float(density[k])
        outer = counts[k, inner_stop : min(n_fine, int(coarse[k]) + n_reach + 1)]
        edges.append(guess_m - 2.0 * _INNER_M + fine_m * (inner_stop + float(outer.sum()) / rho))
        places.append(low + (k + 0.5) / n_bins * (high - low))
        # Counts scatter like those of a Poisson process, but for the evenness of a grid of rays or voxels. Expected
        # ones, from inside: by the counts at the edge itself, pieces that hold few by chance would seem the surer.
        beyond = n_reach * float(density[k])
        sigmas.append(_EVENNESS * fine_m * math.sqrt(max(beyond, 1.0) * (1.0 + n_reach / n_inner)) / float(density[k]))
    line = fit_line_robust(np.array(places), np.array(edges), np.array(sigmas), is_square) if len(edges) >= 2 else None
    if line is None:
        return None
    support = sampling.seen_share(len(edges), n_bins, span)
    return _sharpened_line(out, along[inside], span, line.as_edge(support, "tread"), sampling, is_square)


def _sharpened_line(
    out: Floats, along: Floats, span: tuple[float, float], first: EdgeLine, sampling: Sampling, is_square: bool
) -> EdgeLine:
    """Return an edge at which the surface's own points end, given a first line for it."""
    middle = sum(span) / 2.0
    length_m = span[1] - span[0]
    line = first
    if sampling.sigma_m > _MOST_BLUR * sampling.spacing_m:
        # What noise blurs so far is known best by the whole strip behind it, and cells of the thinning matter less.
        return first
    if not is_square and first.support < 1.0:
        # Of an edge that is hidden in part the first line may lie anywhere, and what is near it is not the edge's.
        return first
    if not is_square:
        halves = []
        for is_half in (along < middle, along >= middle):
            beyond = first.beyond(out[is_half], along[is_half])
            halves.append(_sharpened(beyond, sampling, first.slope_noise * length_m / 2.0))
        (low_m, low_noise_m), (high_m, high_noise_m) = halves
        if low_noise_m is not None and high_noise_m is not None:
            turned = (high_m - low_m) / (length_m / 2.0)
            slope_noise = math.hypot(low_noise_m, high_noise_m) / (length_m / 2.0)
            # Farther than chance turns the first line something else lies at one end.
            if abs(turned) <= _TURN_SIGMAS * math.hypot(first.slope_noise, slope_noise):
                at_middle = first.at(middle) + (low_m + high_m) / 2.0
                line = dataclasses.replace(
                    first, middle_m=at_middle, along_m=middle, slope=first.slope + turned, slope_noise=slope_noise
                )
    beyond = line.beyond(out, along)
    rows = _rows_along(beyond, sampling)
    if rows is not None:
        return dataclasses.replace(line, middle_m=line.middle_m + rows[0], noise_m=rows[1], is_counted=True)
    moved_m, noise_m = _sharpened(beyond, sampling, line.slope_noise * length_m)
    if noise_m is None:
        return first
    beyond_m = line.at(middle) + moved_m - first.at(middle)
    if beyond_m > _FRAYED_SIGMAS * first.noise_m or _is_thin(first.beyond(out, along), beyond_m, sampling):
        # The last strip is thinner than the surface, as of one station alone where two do not fit: the edge is between.
        return dataclasses.replace(first, noise_m=math.hypot(first.noise_m, beyond_m / 2.0))
    return dataclasses.replace(line, middle_m=line.middle_m + moved_m, noise_m=noise_m, is_counted=True)


def _rows_along(beyond: Floats, sampling: Sampling) -> tuple[float, float] | None:
    """Return how far beyond a first line a surface ends whose points lie in rows along the edge, and its uncertainty.

    Where the rays of a grid meet the surface so that rows of points run along its edge, all of them miss it by the
    same: it lies anywhere between the last row and where the next one would be, however many points a row has. None
    where there are no such rows.

    Notes
    -----
    Rows are a wave in the density: of all their distances the one counts that the phases of the points agree with best
    (Rayleigh's test). What rows are wide takes away from the interval between them.

    References
    ----------
    .. [1] Mardia, Jupp: Directional Statistics, Wiley 2000, 2.3 for the circular deviation, 6.3.1 for the test.
    """
    if len(beyond) < _FEWEST_IN_ROWS:
        return None
    last_m = float(np.partition(beyond, -_STRAYS)[-_STRAYS])
    behind = last_m - np.partition(beyond, -_FEWEST_IN_ROWS)[-_FEWEST_IN_ROWS]
    depth_m = max(_ROWS_DEEP * sampling.spacing_m, float(behind))
    strip = beyond[(beyond >= last_m - depth_m) & (beyond <= last_m + sampling.spacing_m)]
    some = strip[:: -(-len(strip) // _MOST_IN_ROWS)]
    low, high = _ROWS_APART
    shortest, longest = low * sampling.spacing_m, min(high * sampling.spacing_m, depth_m / _FEWEST_ROWS)
    waves = np.arange(1.0 / longest, 1.0 / shortest, _WAVE_STEP / depth_m)
    # Each wave is the one before it, turned by as much again: two exponentials for each point instead of one a wave.
    turns = np.tile(np.exp(2j * math.pi * _WAVE_STEP / depth_m * some), (len(waves), 1))
    turns[0] = np.exp(2j * math.pi * waves[0] * some)
    sums = np.multiply.accumulate(turns, axis=0).mean(axis=1)
    best = int(np.argmax(np.abs(sums)))
    sharpness = min(float(np.abs(sums[best])), 1.0)
    if sharpness < _ROWS_SHARP or len(some) * sharpness**2 < _ROWS_SURE:
        return None
    apart_m = 1.0 / float(waves[best])
    phase_m = float(np.angle(sums[best])) / (2.0 * math.pi) * apart_m
    row = np.round((strip - phase_m) / apart_m).astype(np.int64)
    numbers, counts = np.unique(row, return_counts=True)
    last = int(numbers[counts >= _ROW_FILLED * median(counts)].max())
    # Of rows farther in, the distance and the slant are others.
    outer, inner = strip[row == last], strip[row == last - 1]
    if min(len(outer), len(inner)) < 2:
        return None
    apart_m = float(outer.mean() - inner.mean())
    scatter_m = math.sqrt((float(outer.var(ddof=1)) + float(inner.var(ddof=1))) / 2.0)
    open_m = max(0.0, apart_m - math.sqrt(12.0) * scatter_m)
    noise_m = math.hypot(open_m / math.sqrt(12.0), scatter_m / math.sqrt(len(outer)))
    return float(outer.mean()) + apart_m / 2.0, noise_m


def _is_thin(beyond: Floats, ends_m: float, sampling: Sampling) -> bool:
    """Return whether the strip from as far inside a first line as the surface ends beyond it is thinner than the rest.

    Noise thins the last strip too, unless it is wider.
    """
    if 2.0 * ends_m <= _THIN_SIGMAS * sampling.sigma_m:
        return False
    n_strip = np.count_nonzero((beyond > -ends_m) & (beyond <= ends_m))
    n_inner = np.count_nonzero((beyond <= -ends_m) & (beyond > -ends_m - _INNER_M))
    expected = n_inner * 2.0 * ends_m / _INNER_M
    return bool(n_strip < _THIN_SHARE * expected and expected - n_strip > _FRAYED_SIGMAS * math.sqrt(expected))


def _sharpened(beyond: Floats, sampling: Sampling, turned_m: float) -> tuple[float, float | None]:
    """Return how far beyond a first line a surface ends, and the standard uncertainty, None where it does not tell.

    Thinning to one point in each cell of a grid leaves the cells that the edge cuts as full as the others: near the
    edge the surface is denser than inside, and by the density inside it would seem to reach a third of a cell too far.
    So the density is taken where it counts, just behind what noise blurs, from all points along the edge.

    Parameters
    ----------
    beyond : (n,)
        Distance of the surface's points from the line, positive outside.
    sampling : Sampling
        Noise and spacing of the surface.
    turned_m : float
        Standard uncertainty of how much farther out the line lies at one end of the edge than at the other, which blurs
        the edge as noise does.
    """
    blur_m = _BLUR_SIGMAS * math.hypot(sampling.sigma_m, turned_m / math.sqrt(12.0))
    if len(beyond) <= _FEWEST_BEHIND:
        return 0.0, None
    moved_m = previous_m = min(0.0, float(np.partition(beyond, -_STRAYS)[-_STRAYS]))
    for _ in range(_SHARP_ROUNDS):
        start = moved_m - blur_m
        depth_m = max(_SHARP_SPACINGS * sampling.spacing_m, _SHARP_SIGMAS * sampling.sigma_m)
        n_behind = np.count_nonzero((beyond <= start) & (beyond > start - depth_m))
        while n_behind < _FEWEST_BEHIND and depth_m < _INNER_M:
            depth_m *= 1.3
            n_behind = np.count_nonzero((beyond <= start) & (beyond > start - depth_m))
        if n_behind < _FEWEST_BEHIND:
            return 0.0, None
        # What lies farther outside has strayed.
        n_beyond = np.count_nonzero((beyond > start) & (beyond <= moved_m + 2.0 * blur_m + sampling.spacing_m))
        previous_m, moved_m = moved_m, start + depth_m * n_beyond / n_behind
        if abs(moved_m - previous_m) < _SHARP_SETTLED_M:
            break
    if abs(moved_m) > 2.0 * blur_m + _MOVED_SPACINGS * sampling.spacing_m:
        return 0.0, None
    scatter = max(float(n_beyond), 1.0) * (1.0 + n_beyond / n_behind)
    return moved_m, _SEARCHED * depth_m / n_behind * math.sqrt(scatter)
