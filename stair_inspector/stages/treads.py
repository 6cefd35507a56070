"""Where does each step's surface lie, which way does it face, and where does it end?"""

import math
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats, Ints, freeze, own, project
from stair_inspector.geometry.fits import PlaneFit, fit_plane_rows, principal_axis
from stair_inspector.geometry.percentiles import percentiles
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Axes, Edges, Extents, Horizontal, Levels, NearestPoints, Note, Surfaces
from stair_inspector.params import AxesRule, DisplayParams, EdgesParams, Method

_ROUND_RATIO = 0.8
"""Ratio of the two variances above which PCA does not know which axis is the wider."""
_STEEPEST_CLIMB = 0.1
"""Horizontal over vertical distance of levels that lie as good as straight above each other (84 degrees)."""
_DISAGREE_DEG = 20.0
"""Half covered treads turn the direction of rise by some degrees; more than this is PCA's mistake."""


def fit_surfaces(horizontal: Horizontal, levels: Levels) -> Surfaces:
    """Fit the plane pi_k of every level, the floor first (step 8 of the paper).

    Returns
    -------
    Surfaces
        Centroids and normals in local scan axes, n_k . u > 0.
    """
    planes, plan_scatter = [], []
    for start, stop in zip(levels.start, levels.stop, strict=True):
        plane, scatter = plane_of_rows(horizontal, slice(start, stop))
        plan_scatter.append(own(scatter[:2, :2], (2, 2), "plan_scatter"))
        planes.append(plane)
    return Surfaces(tuple(planes), tuple(plan_scatter))


def plane_of_rows(horizontal: Horizontal, rows: Ints | slice) -> tuple[PlaneFit, Floats]:
    """Return the SVD plane of some rows in local scan axes, and their scatter (3, 3) in the level frame."""
    fit, scatter = fit_plane_rows(_chosen(horizontal.coordinates_m, rows), np.array([0.0, 0.0, 1.0]))
    turn = horizontal.level_from_scan.T
    normal = None if fit.normal is None else own(turn @ fit.normal, (3,), "normal")
    return PlaneFit(own(turn @ fit.centroid, (3,), "centroid"), normal, fit.rms_m, fit.n_points), scatter


def _chosen(coordinates: Floats, rows: Ints | slice) -> Floats:
    # Taken row by row, the coordinates stay together in memory.
    return coordinates[:, rows] if isinstance(rows, slice) else coordinates.take(rows, axis=1)


def find_axes(horizontal: Horizontal, surfaces: Surfaces, rule: AxesRule, method: Method) -> Axes | None:
    """Find the width and depth directions of the staircase (steps 5, 5a and 6 of the paper).

    Parameters
    ----------
    horizontal, surfaces
        Of one scan.
    rule : {"auto", "global", "per_step"}
        ``global``: PCA of all step points together. ``per_step``: PCA of the steps' points, each step centred.
        ``auto``: with the paper's method ``global``; else ``per_step``, unless its depth axis is more than 20 degrees
        from the direction in which the steps rise, which is then taken.

    Returns
    -------
    Axes or None
        None when there is no level above the floor.
    """
    steps = surfaces.planes[1:]
    if not steps:
        return None
    basis = horizontal.level_from_scan[:2]
    climb, climb_note = _find_climb(surfaces, horizontal.level_from_scan)
    scatter = np.sum(surfaces.plan_scatter[1:], axis=0)
    pooled: Literal["global", "per_step"] = "per_step"
    if rule == "global" or (rule == "auto" and method == "paper"):
        # The scatter about the common mean is that about each mean plus that of the means.
        pooled = "global"
        counts = np.array([plane.n_points for plane in steps], dtype=np.float64)
        means = np.array([basis @ plane.centroid for plane in steps])
        shift = means - counts @ means / counts.sum()
        scatter = scatter + (shift * counts[:, None]).T @ shift
    width, ratio = principal_axis(scatter)
    depth = left_of(width)
    notes = [] if climb_note is None else [climb_note]
    decided: Literal["global", "per_step", "rise"] = pooled
    if climb is not None:
        angle_deg = math.degrees(math.acos(min(1.0, abs(float(depth @ climb)))))
        if rule == "auto" and method != "paper":
            if angle_deg > _DISAGREE_DEG:
                decided, depth = "rise", -climb
            message = (
                f"axes by the rule '{decided}': PCA of the centred steps is {angle_deg:.0f}° from the direction of rise"
            )
            notes.append(Note("axes_rule", "treads", message))
        elif angle_deg > _DISAGREE_DEG:
            message = (
                f"the depth axis by the rule '{decided}' is {angle_deg:.0f}° from the direction in which the steps "
                "rise: width and depth may be exchanged; try another axes rule"
            )
            notes.append(Note("axes_disagree", "treads", message))
    if decided != "rise" and ratio > _ROUND_RATIO:
        message = (
            f"the step points spread almost equally in both directions (variance ratio {ratio:.2f}): "
            "width and depth may be exchanged; try another axes rule"
        )
        notes.append(Note("axes_uncertain", "treads", message))
    if climb is not None and depth @ climb > 0.0:
        depth = -depth
    # w = u x (climbing direction); the climbing direction is -d, and u x turns the plan by a quarter to the left.
    width = np.array([depth[1], -depth[0]])
    return Axes(own(width @ basis, (3,), "width"), own(depth @ basis, (3,), "depth"), decided, tuple(notes))


def find_extents(horizontal: Horizontal, levels: Levels, axes: Axes) -> Extents:
    """Project every step's points on the axes: d_k and w_k (step 7 of the paper), metres, local."""
    plan = horizontal.level_from_scan[:2]
    depth, width = [], []
    for start, stop in zip(levels.start[1:], levels.stop[1:], strict=True):
        rows = horizontal.coordinates_m[:2, start:stop]
        depth.append(freeze(project(rows, plan @ axes.depth)))
        width.append(freeze(project(rows, plan @ axes.width)))
    return Extents(tuple(depth), tuple(width))


def place_edges(extents: Extents, params: EdgesParams) -> Edges:
    """Place front, back and side edges at percentiles (step 7 of the paper).

    Returns
    -------
    Edges
        f_k = perc_alpha_f(d_k), b_k = perc_alpha_b(d_k); ``high_w`` and ``low_w`` the side percentile of w_k and its
        complement; metres, local, one per step.
    """
    front, back = _percentiles(extents.depth_m, params.front_percentile, params.back_percentile)
    high_w, low_w = _percentiles(extents.width_m, params.side_percentile, 100.0 - params.side_percentile)
    return Edges(front, back, high_w, low_w)


def find_nearest(horizontal: Horizontal, levels: Levels, surfaces: Surfaces, params: DisplayParams) -> NearestPoints:
    """Find the K points of each step nearest to its centroid, nearest first (step 10 of the paper)."""
    return NearestPoints(
        tuple(
            nearest_rows(horizontal, slice(start, stop), plane.centroid, params.nearest_k)
            for start, stop, plane in zip(levels.start[1:], levels.stop[1:], surfaces.planes[1:], strict=True)
        )
    )


def nearest_rows(horizontal: Horizontal, rows: Ints | slice, centre: Floats, wanted: int) -> Ints:
    """Return the ids into the scan of the ``wanted`` points among some rows that are nearest to a place, nearest first.

    Parameters
    ----------
    horizontal : Horizontal
        Upright points.
    rows : (r,) or slice
        Which of them.
    centre : (3,)
        Local scan axes, metres.
    wanted : int
        All are returned where there are fewer.
    """
    offset = _chosen(horizontal.coordinates_m, rows) - (horizontal.level_from_scan @ centre)[:, None]
    distance = np.einsum("ij,ij->j", offset, offset)
    k = min(wanted, len(distance))
    few = np.argpartition(distance, k - 1)[:k] if 0 < k < len(distance) else np.arange(k)
    few = few[np.argsort(distance[few], kind="stable")]
    return freeze(horizontal.point_ids[rows][few])


def _percentiles(coordinates: tuple[Floats, ...], first: float, second: float) -> list[tuple[float, ...]]:
    """Return the first percentile of each step's coordinates, and the second of each."""
    of_steps = [percentiles(values, first, second) for values in coordinates]
    return [tuple(each[k] for each in of_steps) for k in (0, 1)]


def _find_climb(surfaces: Surfaces, level_from_scan: Floats) -> tuple[Floats | None, Note | None]:
    """Return the plan direction in which the centroids move as they rise: the regression of place on height."""
    # A single step has no neighbour above or below but the floor.
    planes = surfaces.planes[1:] if len(surfaces.planes) > 2 else surfaces.planes
    centroids = np.array([level_from_scan @ plane.centroid for plane in planes])
    shift = centroids - centroids.mean(axis=0)
    climb = shift[:, 2] @ shift[:, :2]
    length = float(np.linalg.norm(climb))
    # The slope of place on height; below it, noise decides which way the levels lean.
    if length <= _STEEPEST_CLIMB * float(shift[:, 2] @ shift[:, 2]):
        message = "the levels lie straight above each other: which side is the front is not known"
        return None, Note("climb_unknown", "treads", message)
    return climb / length, None
