"""What is a step's uncertainty made of? The doubts about its level and its edges, from what the scan is like."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Examination, LocalPlane, StepShape, Up
from stair_inspector.stages.doubt import (
    edge_doubt,
    facet_doubt,
    layers_doubt,
    noise_before_rounding,
    rounding_doubt,
    thinning_doubt,
    view_doubt,
)
from stair_inspector.stages.layers import is_stated
from stair_inspector.stated_uncertainty import UncertaintyParams

_OF_COVER = 0.6
"""Standard uncertainty of what may be a strip's or the surface's under it, as a share of its thickness: k = 2 holds all
of it, and that the thickness itself is known to a fifth."""
_MISTAKEN_M = 0.007
"""Treads that are double by so much in height have no one face before them."""


@dataclass(frozen=True, slots=True, eq=False)
class Common:
    """What all quantities of a scan have in common."""

    up_rad: float
    registration_m: float
    edge_m: float
    side_m: float
    slope: float
    scale: float
    scan_from_level: Floats
    steps_m: Floats
    layers_m: Floats
    aside_m: Floats
    is_thinned: bool
    is_view: bool
    facet_m: float

    @classmethod
    def of(cls, up: Up, doubts: UncertaintyParams, level_from_scan: Floats, examined: Examination | None) -> "Common":
        """Return what the user states about a scan, and what was found about it before it was measured."""
        moved = None if examined is None else examined.moved
        layers_m = np.zeros((0, 3)) if examined is None else examined.layers_m
        if examined is not None and examined.is_by_order:
            sizes_m = np.linalg.norm(layers_m, axis=1)
            layers_m = layers_m[[not is_stated(float(size_m), doubts.registration_m) for size_m in sizes_m]]
        return cls(
            up_rad=math.radians(math.hypot((up.u_deg or 0.0) / 2.0, doubts.up_deg)),
            registration_m=doubts.registration_m,
            edge_m=doubts.edge_m,
            side_m=doubts.side_m,
            slope=math.tan(math.radians(doubts.slope_deg)),
            scale=doubts.scale_percent / 100.0,
            scan_from_level=level_from_scan.T,
            steps_m=np.zeros(3) if examined is None else examined.steps_m,
            layers_m=layers_m @ level_from_scan.T,
            aside_m=np.zeros((0, 3)) if moved is None else moved.unheld_m @ level_from_scan.T,
            is_thinned=examined is not None and examined.is_thinned,
            is_view=examined is not None and examined.is_view,
            facet_m=0.0 if examined is None else examined.facet_m or 0.0,
        )


class Doubts:
    """The doubts about the levels and the edges of one flight's steps, standard uncertainties in metres."""

    def __init__(self, common: Common, shapes: tuple[StepShape, ...]) -> None:
        self._common = common
        self._is_stepped = bool(common.steps_m.any())
        # One scanner saw them all. Where points lie to both sides of a rounding limit they seem to have noise, and in
        # the middle between two limits none: the surface with least tells.
        self._sigma_m = min(
            (
                noise_before_rounding(shape.plane.sigma_m, self._normal_of(shape.plane, shape.climb), common.steps_m)
                for shape in shapes
            ),
            default=0.0,
        )

        doubled = sorted(shape.plane.layers_m for shape in shapes if shape.plane.layers_m)
        # Where most treads are doubled, those that seem not to be were seen from one station, which may be either.
        of_scan = self._apart_m(np.array([0.0, 0.0, 1.0]))
        self._layers_m = doubled[len(doubled) // 2] if 2 * len(doubled) > len(shapes) else of_scan

    def place(self, edge: EdgeLine, shape: StepShape) -> float:
        """Return how uncertain the place of a front or back edge is beyond the scatter along it."""
        seen = self._of_view(edge, shape, shape.climb, shape.extent[3] - shape.extent[2])
        # At a back the nosing above casts its shadow, and a count of points ends where that does.
        plain = replace(edge, is_counted=False)
        return math.hypot(edge_doubt(plain, shape.plane), self._common.edge_m, seen)

    def side(self, edge: EdgeLine, shape: StepShape) -> float:
        """Return the same of an edge at a tread's side."""
        seen = self._of_view(edge, shape, left_of(shape.climb), shape.extent[1] - shape.extent[0])
        return math.hypot(edge_doubt(edge, shape.plane), self._common.side_m, seen)

    def _of_view(self, edge: EdgeLine, shape: StepShape, across: Floats, length_m: float) -> float:
        """Return what a camera's view leaves uncertain of an edge of a step; the camera is the origin."""
        if not self._common.is_view:
            return 0.0
        return view_doubt(edge, shape.plane, ray_to(shape)[0], across, length_m)

    def nosing(self, shape: StepShape, w_m: float) -> float:
        """Return how uncertain the place of a nosing is on a line along the climb."""
        return math.hypot(shape.front.noise_at(w_m), self.place(shape.front, shape))

    def layers(self, plane: LocalPlane | None) -> float:
        """Return what doubled surfaces leave uncertain of a level: its own layers, else its flight's or scan's.

        The mean of a level that shows both layers lies between them; one that shows a single layer is either of the two
        (JCGM 100:2008, 4.3.7 and 4.3.8: an even distribution, and one at both ends).
        """
        if plane is None:
            return 0.0
        apart_m = layers_doubt(plane.layers_m) if plane.layers_m else self._layers_m / 2.0
        return math.hypot(apart_m, _OF_COVER * plane.cover_m)

    def layers_across(self, edge: EdgeLine | None, shape: StepShape) -> float:
        """Return what doubled surfaces leave uncertain of the place of a front or back edge, along the climb.

        Of two layers of a face either may have been found. Where a tread is double in height by more than the depth in
        which a face's upper end is sought, the face of a nosing and that of the riser behind it are mistaken for each
        other.
        """
        if edge is None:
            return 0.0
        apart_m = self._apart_m(np.array([*shape.climb, 0.0]))
        above_m = shape.plane.layers_m or self._layers_m
        mistaken = layers_doubt(priors.DEEPEST_OVERHANG_M) if above_m > _MISTAKEN_M else 0.0
        return math.hypot(apart_m / 2.0, mistaken, _OF_COVER * shape.plane.cover_m)

    def across(self, *edges: tuple[EdgeLine | None, StepShape]) -> dict[str, float]:
        """Return what resolution and doubled surfaces leave uncertain of the distance of front or back edges."""
        return {
            "resolution": math.hypot(*(self.resolution_across(*edge) for edge in edges)),
            "layers": math.hypot(*(self.layers_across(*edge) for edge in edges), self._untold_between(edges)),
        }

    def _untold_between(self, edges: Sequence[tuple[EdgeLine | None, StepShape]]) -> float:
        """Return what a shift of stations along the climb that no surface shows leaves of the distance of edges.

        A face that both had seen would show it. Nothing of it lies between two faces that one station saw; all of it
        may between those of two stations; and the end of a tread is that of either.
        """
        known = [(edge, shape) for edge, shape in edges if edge is not None]
        untold_m = max((self._untold_m(shape.climb) for _, shape in known), default=0.0)
        n_ends = sum(edge.source != "face" for edge, _ in known)
        seen_by = {edge.seen_by for edge, _ in known if edge.source == "face" and edge.seen_by >= 0}
        return 2.0 * untold_m if len(seen_by) > 1 else math.sqrt(n_ends) * untold_m

    def layers_aside(self, shape: StepShape) -> float:
        """Return the same of an edge at a tread's side, square to the climb.

        Every tread is as wide as the stations together show it, so a shift that no surface shows widens it; the faces
        of nosings and risers are seen from below, mostly by the same stations.
        """
        left = np.array([*left_of(shape.climb), 0.0])
        apart_m = self._apart_m(left)
        untold_m = self._untold_m(left_of(shape.climb))
        # What a strip of carpet leaves of the width goes to two sides, and to one direction; so does an untold shift.
        return math.hypot(apart_m / 2.0, math.hypot(shape.plane.aside_m / 2.0, untold_m) / math.sqrt(2.0))

    def _untold_m(self, direction: Floats) -> float:
        """Return half of what stations may be apart in a direction (2,) of the plan in which no surface shows it."""
        return float(np.abs(self._common.aside_m @ np.array([*direction, 0.0])).max(initial=0.0)) / 2.0

    def _apart_m(self, direction: Floats) -> float:
        """Return how far doubled surfaces lie apart in a direction of the level frame."""
        return float(np.abs(self._common.layers_m @ direction).max(initial=0.0))

    def layers_of_slope(self, plane: LocalPlane, depth_m: float) -> float:
        """Return the same of a slope, as a tangent: at the front one layer may be seen, at the back the other."""
        return math.sqrt(2.0) * self.layers(plane) / max(depth_m, plane.spacing_m, 1e-3)

    def cover_of_slope(self, plane: LocalPlane, width_m: float) -> float:
        """Return what a strip that may lie on a part of a surface leaves uncertain of its slope across, as a tangent.

        A strip of thickness t over half of it turns its plane by 3 t / 2 over the width: within k = 2.
        """
        return math.sqrt(2.0) * _OF_COVER * plane.cover_m / max(width_m, plane.spacing_m, 1e-3)

    def resolution_of_level(self, plane: LocalPlane | None, shape: StepShape) -> float:
        """Return what rounding and the faces of a mesh leave uncertain of a surface's height along a step's nosing."""
        if plane is None:
            return 0.0
        of_facets_m = facet_doubt(self._common.facet_m, "level")
        if not self._is_stepped:
            return of_facets_m
        low, high = shape.line_range
        left = left_of(shape.climb)
        along = (high - low) * np.array([left[0], left[1], plane.slope[1]])
        rounded_m = self._rounding(self._normal_of(plane, shape.climb), along, self._sigma_m)
        return math.hypot(rounded_m, of_facets_m)

    def resolution_of_slope(self, shape: StepShape, length_m: float) -> float:
        """Return the same of a surface's slope over a length, as a tangent: one end against the other."""
        return (
            math.sqrt(2.0) * self.resolution_of_level(shape.plane, shape) / max(length_m, shape.plane.spacing_m, 1e-3)
        )

    def resolution_across(self, edge: EdgeLine | None, shape: StepShape) -> float:
        """Return the same of the place of a front or back edge, along the climb."""
        if edge is None:
            return 0.0
        of_facets_m = facet_doubt(self._common.facet_m, "edge")
        if not self._is_stepped:
            return of_facets_m
        left = left_of(shape.climb)
        rounded_m = self._of_edge(
            edge, shape.climb - edge.slope * left, left + edge.slope * shape.climb, np.ptp(shape.line_range)
        )
        return math.hypot(rounded_m, of_facets_m)

    def resolution_aside(self, edge: EdgeLine, shape: StepShape) -> float:
        """Return the same of an edge at a tread's side, square to the climb."""
        of_facets_m = 0.0 if edge.is_wall else facet_doubt(self._common.facet_m, "side")
        if not self._is_stepped:
            return of_facets_m
        left = left_of(shape.climb)
        depth_m = shape.extent[1] - shape.extent[0]
        rounded_m = self._of_edge(edge, left - edge.slope * shape.climb, shape.climb + edge.slope * left, depth_m)
        return math.hypot(rounded_m, of_facets_m)

    def _of_edge(self, edge: EdgeLine, across: Floats, along: Floats, length_m: float) -> float:
        length = math.hypot(1.0, edge.slope)
        normal, reach = np.array([*across, 0.0]) / length, length_m / length * np.array([*along, 0.0])
        # Noise blurs a face. The end of a tread is blurred by nothing: its points lie anywhere up to there.
        turn = self._common.scan_from_level
        return self._rounding(turn @ normal, reach, self._sigma_m if edge.source == "face" else 0.0)

    def _normal_of(self, plane: LocalPlane, climb: Floats) -> Floats:
        """Return the normal of a surface in scan axes."""
        lean = plane.slope[0] * climb + plane.slope[1] * left_of(climb)
        normal: Floats = self._common.scan_from_level @ (np.array([*-lean, 1.0]) / math.hypot(1.0, *lean))
        return normal

    def _rounding(self, normal: Floats, reach: Floats, sigma_m: float) -> float:
        turned = self._common.scan_from_level @ reach
        if self._common.is_thinned:
            # A cell counts once, however many points lay in it: there noise averages nothing out.
            rounded = rounding_doubt(normal, (turned,), 0.0, self._common.steps_m)
            return max(rounded, thinning_doubt(normal, turned, self._common.steps_m))
        return rounding_doubt(normal, (turned,), sigma_m, self._common.steps_m)


def ray_to(shape: StepShape) -> tuple[Floats, float]:
    """Return the direction from a camera at the origin to the middle of a step, (3,), level frame, and its range."""
    s_low, s_high, w_low, w_high = shape.extent
    s, w = (s_low + s_high) / 2.0, (w_low + w_high) / 2.0
    ray = np.array([*shape.to_plan(s, w), shape.plane.at(s, w)])
    range_m = float(np.linalg.norm(ray))
    return ray / max(range_m, 1e-9), range_m
