"""At which heights is there a horizontal surface?"""

import math

import numpy as np

from stair_inspector.errors import CannotMeasure
from stair_inspector.geometry.arrays import freeze
from stair_inspector.geometry.clusters import Reach, cluster_sorted, find_reach
from stair_inspector.model import NON_STAIR_LABEL, HeightOrder, HeightProfile, Horizontal, Levels
from stair_inspector.params import HorizontalParams, LevelsParams

MAX_LEVELS = 500
"""More height clusters than any staircase has treads: the settings do not fit the scan."""
PROFILE_BIN_M = 0.002
_MAX_BINS = 5000


def select_horizontal(heights: HeightOrder, params: HorizontalParams) -> Horizontal:
    """Keep the points H = { p_i : |n_i . u| >= cos(theta_th) } (step 2 of the paper), sorted by height."""
    ids = np.flatnonzero(heights.alignment >= math.cos(math.radians(params.theta_deg)))
    return Horizontal(
        point_ids=freeze(heights.point_ids.take(ids)),
        coordinates_m=freeze(heights.coordinates_m.take(ids, axis=1)),
        level_from_scan=heights.level_from_scan,
        up=heights.up,
        n_scan=heights.n_scan,
        plan_corner_m=heights.plan_corner_m,
        whole=None if heights.whole is None else select_horizontal(heights.whole, params),
    )


def find_height_reach(horizontal: Horizontal, eps_m: float) -> Reach:
    """Find every height's eps_z-neighbourhood (first half of step 3 of the paper)."""
    return find_reach(horizontal.coordinates_m[2], eps_m)


def find_levels(horizontal: Horizontal, reach: Reach, params: LevelsParams) -> Levels:
    """Cluster the heights by DBSCAN(z; eps_z, m); the lowest cluster is the floor (steps 3 and 4 of the paper).

    Returns
    -------
    Levels
        Possibly without any cluster.

    Raises
    ------
    CannotMeasure
        More than 500 clusters: eps_z and m are far too small for this scan.
    """
    clusters = cluster_sorted(reach, params.min_points)
    if len(clusters.start) > MAX_LEVELS:
        raise CannotMeasure(
            f"levels: {len(clusters.start):,} height clusters, more than {MAX_LEVELS} can be steps; "
            "raise levels.min_points (m) or levels.eps_m (eps_z)"
        )
    labels = np.full(horizontal.n_scan, NON_STAIR_LABEL, dtype=np.int16)
    for level_id, (start, stop) in enumerate(zip(clusters.start, clusters.stop, strict=True)):
        labels[horizontal.point_ids[start:stop]] = level_id
    return Levels(clusters.start, clusters.stop, freeze(labels))


def profile_heights(horizontal: Horizontal, bin_m: float = PROFILE_BIN_M) -> HeightProfile:
    """Count the upright points in bins of height; what one looks at to choose eps_z.

    Notes
    -----
    Heights are local. More than 5000 bins are made wider, so that a scan of a tower stays drawable.
    """
    heights = horizontal.coordinates_m[2]
    if len(heights) == 0:
        return HeightProfile(0.0, bin_m, freeze(np.zeros(0, dtype=np.int64)))
    low, high = float(heights[0]), float(heights[-1])
    bin_m = max(bin_m, (high - low) / _MAX_BINS)
    n_bins = int((high - low) / bin_m) + 1
    edges = low + bin_m * np.arange(1, n_bins)
    ends = np.concatenate([[0], np.searchsorted(heights, edges), [len(heights)]])
    return HeightProfile(low, bin_m, freeze(np.diff(ends)))
