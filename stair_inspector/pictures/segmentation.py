"""What is drawn of an inspection as plain arrays: colours, edges, nosings, names; and how the staircase stands."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.files.palettes import Palette, Rgb
from stair_inspector.geometry.arrays import Colors, Floats, Ints, Labels
from stair_inspector.model import Inspection
from stair_inspector.pictures.coloring import rejected_of, step_colors
from stair_inspector.pictures.display import Display

SURFACE = "surface"
"""Word before a surface's number, where a step has its number alone."""
MOST_REJECTED = 30
"""Rejected surfaces that are listed and named in the scene, the largest; a cluttered scan has hundreds."""
_BESIDE_M = 0.1
_FAR_OUT = 0.15
"""So far beyond 99 % of the points, as a share of their reach, a picture still shows others: not a lost reflection."""


_GROUND_SHARE = 0.7


@dataclass(frozen=True, slots=True, eq=False)
class SegmentedScene:
    """The segmentation as plain data, local coordinates.

    ``colors`` (m, 3) of the displayed points; ``edges`` (e, 2, 3) with ``edge_colors`` (e, 3), lifted off the surface
    by about a point's size so that its points do not cover them; ``nosings`` (k, 2, 3) the survey's nosing lines,
    lifted too; ``centres`` (c, 3) the points kept around the centroids; ``corners`` one (4, 3) plate for each step;
    ``labels`` their names; ``rejected`` the name and place (3,) of each rejected surface that is to be seen.
    """

    colors: Colors
    edges: Floats
    edge_colors: Colors
    nosings: Floats
    centres: Floats
    corners: tuple[Floats, ...]
    labels: tuple[str, ...]
    rejected: tuple[tuple[str, Floats], ...] = ()


def draw(
    inspection: Inspection,
    display: Display,
    scan_points: Floats,
    palette: Palette,
    *,
    with_rejected: bool = False,
    colors: Colors | None = None,
) -> SegmentedScene:
    """Return what is drawn of an inspection.

    Parameters
    ----------
    inspection, display
        Of the same scan.
    scan_points : (n, 3)
        All points of that scan, local.
    palette : Palette
        Colours of the page.
    with_rejected : bool
        Whether surfaces that are no part of the staircase have a colour of their own and, the largest, a name.
    colors : (m, 3), optional
        Of the displayed points; None colours them by step.
    """
    rejected = rejected_of(inspection) if with_rejected else []
    if colors is None:
        colors = step_colors(inspection, display, palette, with_rejected=with_rejected)
    edges, edge_colors = [], []
    nosings = []
    for step in inspection.steps:
        lift = lift_of(display.spacing_m, step.plane.rms_m) * inspection.up.vector
        front_left, front_right, back_right, back_left = step.corners + lift
        edges += [(front_left, back_left), (front_right, back_right), (back_left, back_right)]
        edge_colors += [palette.side_edge, palette.side_edge, palette.back_edge]
        if step.nosing is not None:
            nosings.append(step.nosing + lift)
        else:
            edges.append((front_left, front_right))
            edge_colors.append(palette.front_edge)
    centres = [inspection.places(scan_points[ids], ids) for ids in (step.nearest_ids for step in inspection.steps)]
    return SegmentedScene(
        colors=colors,
        edges=np.array(edges).reshape(-1, 2, 3),
        edge_colors=np.array(edge_colors, dtype=np.uint8).reshape(-1, 3),
        nosings=np.array(nosings).reshape(-1, 2, 3),
        centres=np.concatenate(centres) if centres else np.zeros((0, 3)),
        corners=tuple(step.corners for step in inspection.steps),
        labels=tuple(str(step.step_id) for step in inspection.steps),
        rejected=tuple((f"{SURFACE} {patch.patch_id}", patch.plane.centroid) for patch in rejected[:MOST_REJECTED]),
    )


def lift_of(spacing_m: float, rms_m: float | None) -> float:
    """Return how far above a surface a line is drawn, metres: in it, half of the surface's points would cover it."""
    return spacing_m + 2.0 * (rms_m or 0.0)


def ground_of(palette: Palette) -> Rgb:
    """Return a quiet colour on which measuring lines and arrows are seen, for the points of a step with dimensions."""
    # Arrows are dark on the light theme and light on the dark one.
    far = 255 if sum(palette.centre) < 3 * 128 else 0
    red, green, blue = (round(_GROUND_SHARE * far + (1.0 - _GROUND_SHARE) * channel) for channel in palette.measure)
    return (red, green, blue)


def points_of(inspection: Inspection, display: Display, step_id: int | None, patch_id: int | None) -> Floats:
    """Return the displayed points (k, 3) of a step, or of a surface, or none."""
    owners: Labels | Ints | None = inspection.labels if step_id is not None else inspection.patch_ids
    number = step_id if step_id is not None else patch_id
    if owners is None or number is None:
        return np.zeros((0, 3))
    points: Floats = display.points[owners[display.point_ids] == number]
    return points


def view_from_local(inspection: Inspection) -> Floats:
    """Return the rotation (3, 3) from local axes to the view: right of the climber, along the climb, up.

    The climb is that at the foot of the first flight, or that of the paper's axes where no flight is known.
    """
    up = inspection.up.vector
    if inspection.flights:
        right = np.cross(inspection.flights[0].climb, up)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(up, right), up])
    if inspection.axes is not None:
        return np.stack([-inspection.axes.width, -inspection.axes.depth, up])
    some = np.eye(3)[np.argmin(np.abs(up))]
    right = np.cross(some, up)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(up, right), up])


def is_left_hidden(inspection: Inspection, display: Display) -> bool:
    """Return whether something tall, such as a wall, stands on the left of the stair and not on the right.

    Seen when climbing; what lies lower than the steps hides nothing.
    """
    if not inspection.steps:
        return False
    turn = view_from_local(inspection)
    corners = np.concatenate([step.corners for step in inspection.steps]) @ turn.T
    x, _, z = (display.points @ turn.T).T
    is_in_the_way = (inspection.labels[display.point_ids] < 0) & (z > corners[:, 2].max())
    n_left = np.count_nonzero(is_in_the_way & (x < corners[:, 0].min() + _BESIDE_M))
    n_right = np.count_nonzero(is_in_the_way & (x > corners[:, 0].max() - _BESIDE_M))
    return bool(n_left > 2 * n_right)


def extent_of(points: Floats) -> Floats:
    """Return the eight corners (8, 3) of the box around the points, but for those that lie far from nearly all."""
    inner_low, inner_high = np.percentile(points, [0.5, 99.5], axis=0)
    reach = _FAR_OUT * (inner_high - inner_low)
    low = np.maximum(points.min(axis=0), inner_low - reach)
    high = np.minimum(points.max(axis=0), inner_high + reach)
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
