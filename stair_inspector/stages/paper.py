"""What are the paper's numbers? Step 9: heights, depths, widths and slopes from planes, axes and edges."""

import itertools
import math

from stair_inspector.geometry.arrays import Floats, own
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Axes, Edges, NearestPoints, Note, PaperValues, Scan, Step, Surfaces, Up

_STEEPEST_COSINE = 0.1
"""A plane steeper than 84 degrees is not extended to the corners: they would fly off along the vertical."""


def measure_steps(
    scan: Scan, up: Up, surfaces: Surfaces, axes: Axes, edges: Edges, nearest: NearestPoints
) -> tuple[Step, ...]:
    """Measure every step C_1..C_n by the paper's equations (step 9).

    Returns
    -------
    tuple of Step
        From bottom to top. f_m and b_m are coordinates along the depth axis in the scan frame. The last step has no
        step above it, so its h, d_FF and theta are None.
    """
    planes = surfaces.planes[1:]
    origin_d = float(scan.origin_m @ axes.depth)
    steps = []
    for k, plane in enumerate(planes):
        above = planes[k + 1] if k + 1 < len(planes) else None
        values = PaperValues(
            h_m=None if above is None else measure_h(plane, above, up),
            d_fb_m=edges.front[k] - edges.back[k],
            d_ff_m=None if above is None else abs(edges.front[k + 1] - edges.front[k]),
            w_m=edges.high_w[k] - edges.low_w[k],
            theta_deg=None if above is None else measure_theta(plane, above),
            f_m=edges.front[k] + origin_d,
            b_m=edges.back[k] + origin_d,
        )
        corners = place_corners(plane, up, axes, edges, k)
        steps.append(Step(k + 1, plane, corners, nearest.ids[k], values))
    return tuple(steps)


def measure_h(plane: PlaneFit, above: PlaneFit, up: Up) -> float:
    """Return h_k = (c_{k+1} - c_k) . u, metres."""
    return float((above.centroid - plane.centroid) @ up.vector)


def measure_theta(plane: PlaneFit, above: PlaneFit) -> float | None:
    """Return theta_k = arcsin(|n_k . (c_{k+1} - c_k)| / |c_{k+1} - c_k|), degrees; None without a normal."""
    to_above = above.centroid - plane.centroid
    length = math.sqrt(float(to_above @ to_above))
    if plane.normal is None or length == 0.0:
        return None
    return math.degrees(math.asin(min(1.0, abs(float(plane.normal @ to_above)) / length)))


def place_corners(plane: PlaneFit, up: Up, axes: Axes, edges: Edges, k: int) -> Floats:
    """Return the (4, 3) corners of step k in its plane: front left, front right, back right, back left; local."""
    corners = []
    for d, w in (
        (edges.front[k], edges.high_w[k]),
        (edges.front[k], edges.low_w[k]),
        (edges.back[k], edges.low_w[k]),
        (edges.back[k], edges.high_w[k]),
    ):
        offset = (d - plane.centroid @ axes.depth) * axes.depth + (w - plane.centroid @ axes.width) * axes.width
        rise = 0.0
        if plane.normal is not None and plane.normal @ up.vector > _STEEPEST_COSINE:
            rise = -float(offset @ plane.normal) / float(plane.normal @ up.vector)
        corners.append(plane.centroid + offset + rise * up.vector)
    return own(corners, (4, 3), "corners")


def review_steps(steps: tuple[Step, ...]) -> tuple[Note, ...]:
    """Note every step whose front edge breaks the monotone progress (step 6), and every one without a plane."""
    notes = []
    for below, step in itertools.pairwise(steps):
        # The depth axis points to the front, against the climb: fronts must fall from step to step.
        if step.paper.f_m is not None and below.paper.f_m is not None and step.paper.f_m >= below.paper.f_m:
            back_mm = (step.paper.f_m - below.paper.f_m) * 1000.0
            message = (
                f"the front edge of step {step.step_id} lies {back_mm:.0f} mm in front of that of step "
                f"{below.step_id}: the fronts do not progress with the climb"
            )
            notes.append(Note("front_not_monotonic", "paper", message, step.step_id))
    for step in steps:
        if step.plane.normal is None:
            message = f"the {step.plane.n_points} points of step {step.step_id} lie on one line: no plane, no slope"
            notes.append(Note("no_plane", "paper", message, step.step_id))
    return tuple(notes)
