"""What are the values of each step of a flight? Rise, going, depth, width, slopes, with their uncertainties."""

import math
from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats, own
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.geometry.plan import left_of
from stair_inspector.model import Chain, Measured, PaperValues, Step, StepShape
from stair_inspector.params import SurveyParams
from stair_inspector.stages.arcs import arc_length
from stair_inspector.stages.climbs import find_climbs, straight_climb
from stair_inspector.stages.doubt import NEAR_REGISTRATION, expanded, slope_doubt, surface_doubt
from stair_inspector.stages.parts import Common, Doubts


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """A measuring line on one step: its points, one at the nosing, in plan (2,) and height."""

    plan: Floats
    s_m: float
    w_m: float
    height_m: float


class StepMeasurer:
    """Measures the steps of one chain."""

    def __init__(
        self,
        chain: Chain,
        shapes: tuple[StepShape, ...],
        after: StepShape | None,
        context: Common,
        params: SurveyParams,
    ) -> None:
        self._chain = chain
        self._n_steps = len(shapes)
        # The first step of the flight that goes straight on from this one's landing gives the landing its depth.
        self._shapes = shapes if after is None else (*shapes, after)
        self._context = context
        self._doubts = Doubts(context, self._shapes)
        self._climbs = find_climbs(chain, shapes)
        self._arc = shapes[0].arc
        self._is_straight = self._arc is None and straight_climb(chain) is not None
        share = params.line_percent / 100.0
        self._lines = [self._lines_of(shape, (1.0 - share, 0.5, share)) for shape in self._shapes]

    def measure(self) -> list[Step]:
        """Return the steps from bottom to top; their ids, planes and kinds are filled in later."""
        n = self._n_steps
        is_bridged = [k + 1 < n and self._chain.n_missing[k + 1] > 0 for k in range(n)]
        goings = [None if k + 1 == len(self._shapes) or is_bridged[k] else self._goings(k) for k in range(n)]
        rises = [None if self._chain.n_missing[k] else self._rises(k) for k in range(n)]
        steps = []
        for k, shape in enumerate(self._shapes[:n]):
            going, depth = self._going(k, goings[k]), self._depth(k, goings[k])
            next_rise = self._rise(k + 1, rises[k + 1], goings[k]) if k + 1 < n else None
            steps.append(
                Step(
                    step_id=0,
                    plane=_NO_PLANE,
                    corners=self._corners(k),
                    nearest_ids=np.zeros(0, dtype=np.int64),
                    paper=PaperValues(),
                    rise_m=self._rise(k, rises[k], goings[k - 1] if k else None),
                    going_m=going,
                    tread_depth_m=depth,
                    width_m=self._width(k),
                    nosing_overhang_m=self._overhang(k, depth, going),
                    pitch_deg=None if going is None or next_rise is None else self._pitch(going, next_rise),
                    fall_deg=self._slope(shape, self._climbs[k]),
                    cross_fall_deg=self._slope(shape, left_of(self._climbs[k])),
                    coverage=shape.coverage,
                    rise_lcr_m=rises[k],
                    going_lcr_m=goings[k],
                    nosing=self._nosing(k),
                    line_points=own(
                        [self._to_scan(line.plan, line.height_m) for line in self._lines[k]], (3, 3), "line"
                    ),
                    climb=own(self._context.scan_from_level[:, :2] @ self._climbs[k], (3,), "climb"),
                )
            )
        return steps

    def _lines_of(self, shape: StepShape, shares: tuple[float, ...]) -> list[_Line]:
        """Return the points of the nosing on the measuring lines; shares count from the right."""
        low, high = shape.line_range
        lines = []
        for share, offset in zip(shares, shape.nosing_offsets, strict=True):
            w = low + share * (high - low)
            s = shape.front.at(w)
            lines.append(_Line(shape.to_plan(s, w), s, w, shape.plane.at(s, w) + offset))
        return lines

    def _crossing(self, plan: Floats, climb: Floats, k: int) -> tuple[float, float]:
        """Return where a line of the plan crosses the nosing of step k, in the step's frame: s and w."""
        shape = self._shapes[k]
        s, w = shape.from_plan(plan)
        ds, dw = float(climb @ shape.climb), float(climb @ left_of(shape.climb))
        # s + t ds = front(w + t dw)
        t = (shape.front.at(w) - s) / (ds - shape.front.slope * dw)
        return s + t * ds, w + t * dw

    def _goings(self, k: int) -> tuple[float | None, ...]:
        # The flight that goes on behind a landing has an arc of its own, or none.
        if self._arc is not None and k + 1 < self._n_steps:
            pairs = zip(self._lines[k], self._lines[k + 1], strict=True)
            return tuple(arc_length(self._arc, line.plan, after.plan) for line, after in pairs)
        climb = self._climbs[k]
        result = []
        for line in self._lines[k]:
            s, w = self._crossing(line.plan, climb, k + 1)
            result.append(float((self._shapes[k + 1].to_plan(s, w) - line.plan) @ climb))
        return tuple(result)

    def _rises(self, k: int) -> tuple[float | None, ...] | None:
        shape = self._shapes[k]
        if k == 0:
            foot = shape.foot
            if foot is None:
                return None
            return tuple(float(line.height_m - foot.at(line.s_m, line.w_m)) for line in self._lines[0])
        if self._arc is not None:
            pairs = zip(self._lines[k - 1], self._lines[k], strict=True)
            return tuple(float(line.height_m - below.height_m) for below, line in pairs)
        result = []
        lower = self._shapes[k - 1]
        for line, offset in zip(self._lines[k], lower.nosing_offsets, strict=True):
            # Back along the line of climb of the step below, on which its going is measured.
            s, w = self._crossing(line.plan, self._climbs[k - 1], k - 1)
            result.append(float(line.height_m - lower.plane.at(s, w) - offset))
        return tuple(result)

    def _rise(
        self, k: int, rises: tuple[float | None, ...] | None, goings: tuple[float | None, ...] | None
    ) -> Measured | None:
        if rises is None or rises[1] is None:
            return None
        shape, line = self._shapes[k], self._lines[k][1]
        doubts = self._doubts
        below = shape.foot if k == 0 else self._shapes[k - 1].plane
        if k == 0:
            noise_below = 0.0 if below is None else below.noise_at(line.s_m, line.w_m)
            if below is not None:
                noise_below = math.hypot(noise_below, surface_doubt(below))
            edge_below, apart = 0.0, 0.0
        else:
            lower = self._shapes[k - 1]
            _, w = self._crossing(line.plan, self._climbs[k - 1], k - 1)
            noise_below = math.hypot(lower.nosing_noise[1], surface_doubt(lower.plane))
            edge_below = abs(lower.plane.slope[0]) * doubts.nosing(lower, w)
            apart = 0.0 if goings is None or goings[1] is None else goings[1]
        edge = abs(shape.plane.slope[0]) * doubts.nosing(shape, line.w_m)
        return expanded(
            rises[1],
            noise=math.hypot(shape.nosing_noise[1], surface_doubt(shape.plane), noise_below),
            edge=math.hypot(edge, edge_below),
            resolution=math.hypot(*(doubts.resolution_of_level(plane, shape) for plane in (shape.plane, below))),
            layers=math.hypot(doubts.layers(shape.plane), doubts.layers(below)),
            up=self._context.up_rad * apart,
            registration=self._context.registration_m,
            scale=self._context.scale * abs(rises[1]),
        )

    def _going(self, k: int, goings: tuple[float | None, ...] | None) -> Measured | None:
        if goings is None or goings[1] is None:
            return None
        lower, upper, line = self._shapes[k], self._shapes[k + 1], self._lines[k][1]
        _, w = self._crossing(line.plan, self._climbs[k], k + 1)
        rise_m = upper.plane.at(upper.front.at(w), w) - line.height_m
        doubts = self._doubts
        return expanded(
            goings[1],
            noise=math.hypot(lower.front.noise_at(line.w_m), upper.front.noise_at(w)),
            edge=math.hypot(
                doubts.place(lower.front, lower), doubts.place(upper.front, upper), self._wedge_doubt(k, goings)
            ),
            **doubts.across((lower.front, lower), (upper.front, upper)),
            up=self._context.up_rad * abs(rise_m),
            registration=self._context.registration_m,
            scale=self._context.scale * goings[1],
        )

    def _wedge_doubt(self, k: int, goings: tuple[float | None, ...] | None) -> float:
        """Return what is added by not knowing the middle of a wedge's nosing: its going grows along the nosing."""
        shape = self._shapes[k]
        if goings is None or goings[0] is None or goings[2] is None or self._is_straight:
            return 0.0
        if self._arc is not None:
            # The middle line is the same for all steps.
            return abs(goings[1] or 0.0) / self._arc.radius_m * self._arc.middle_noise_m
        left, _, right = self._lines[k]
        growth = (goings[0] - goings[2]) / (left.w_m - right.w_m)
        return abs(growth) * math.hypot(shape.left.noise_m, shape.right.noise_m) / 2.0

    def _depth(self, k: int, goings: tuple[float | None, ...] | None) -> Measured | None:
        shape, line = self._shapes[k], self._lines[k][1]
        if shape.back is None and shape.back_limits is None:
            return None
        edge = math.hypot(self._doubts.place(shape.front, shape), self._wedge_doubt(k, goings))
        noise, edge = self._with_back(k, shape.front.noise_at(line.w_m), edge)
        back_m = sum(shape.back_limits or ()) / 2.0 if shape.back is None else shape.back.at(line.w_m)
        depth_m = back_m - line.s_m
        return expanded(
            depth_m,
            noise=noise,
            edge=edge,
            **self._doubts.across((shape.front, shape), (shape.back, shape)),
            registration=self._context.registration_m,
            scale=self._context.scale * depth_m,
        )

    def _with_back(self, k: int, noise: float, edge: float) -> tuple[float, float]:
        """Return what is uncertain of another edge, by its noise and by where it is, with the same of a step's back."""
        shape = self._shapes[k]
        if shape.back is not None:
            back = shape.back.noise_at(self._lines[k][1].w_m), self._doubts.place(shape.back, shape)
            return math.hypot(noise, back[0]), math.hypot(edge, back[1])
        # Anywhere between the limits: half the interval is the expanded uncertainty.
        low, high = shape.back_limits or (0.0, 0.0)
        return noise, math.hypot(edge, (high - low) / 4.0)

    def _overhang(self, k: int, depth: Measured | None, going: Measured | None) -> Measured | None:
        """Return how far the next nosing stands over this tread; its own nosing, in both terms, drops out.

        The two edges lie at one place, where registration adds less than from step to step.
        """
        if depth is None or going is None:
            return None
        shape, above = self._shapes[k], self._shapes[k + 1]
        nosing = above.front.noise_at(self._lines[k + 1][1].w_m), self._doubts.place(above.front, above)
        noise, edge = self._with_back(k, *nosing)
        rise_m = above.plane.at(0.0, 0.0) - shape.plane.at(0.0, 0.0)
        overhang_m = depth.value - going.value
        if shape.back is not None and not self._is_straight:
            # Depth and going are not measured the same way there, nor square to the riser.
            s, w_above = shape.from_plan(self._lines[k + 1][1].plan)
            overhang_m = (shape.back.at(w_above) - s) / math.hypot(1.0, shape.back.slope)
        return expanded(
            overhang_m,
            noise=noise,
            edge=edge,
            **self._doubts.across((shape.back, shape), (above.front, above)),
            up=self._context.up_rad * abs(rise_m),
            registration=NEAR_REGISTRATION * self._context.registration_m,
        )

    def _width(self, k: int) -> Measured:
        shape = self._shapes[k]
        # Where the side edges were looked for and their noise is least.
        s = (shape.left.along_m + shape.right.along_m) / 2.0
        doubt = math.hypot(self._doubts.side(shape.left, shape), self._doubts.side(shape.right, shape))
        width_m = shape.left.at(s) - shape.right.at(s)
        if shape.arc is not None:
            # Square to the sides, which slant against the nosing in the middle of the tread.
            width_m *= math.cos(math.atan((shape.left.slope + shape.right.slope) / 2.0))
        return expanded(
            width_m,
            noise=math.hypot(shape.left.noise_at(s), shape.right.noise_at(s)),
            edge=doubt,
            resolution=math.hypot(*(self._doubts.resolution_aside(side, shape) for side in (shape.left, shape.right))),
            layers=math.sqrt(2.0) * self._doubts.layers_aside(shape),
            registration=self._context.registration_m,
            scale=self._context.scale * width_m,
        )

    def _pitch(self, going: Measured, rise: Measured) -> Measured:
        """Return the angle of the line from this nosing to the next; a tilt turns it as a whole."""
        g, r = going.value, rise.value
        by_going, by_rise = dict(going.parts), dict(rise.parts)
        parts = {
            name: math.degrees(math.hypot(g * by_rise.get(name, 0.0), r * by_going.get(name, 0.0)) / (g * g + r * r))
            / 2.0
            for name in ("noise", "edge", "resolution", "layers", "registration")
        }
        return expanded(math.degrees(math.atan2(r, g)), **parts, up=math.degrees(self._context.up_rad))

    def _slope(self, shape: StepShape, direction: Floats) -> Measured:
        """Return the slope of a tread in a direction of the plan, degrees, positive where it rises that way."""
        along = np.array([0.0, float(direction @ shape.climb), float(direction @ left_of(shape.climb))])
        slope = float(along[1] * shape.plane.slope[0] + along[2] * shape.plane.slope[1])
        noise = math.sqrt(max(0.0, float(along @ shape.plane.covariance @ along)))
        # Over the width, what one station and the other see is mixed everywhere.
        depth_m = shape.extent[1] - shape.extent[0]
        noise = math.hypot(noise, abs(along[1]) * slope_doubt(shape.plane, depth_m))
        width_m = shape.extent[3] - shape.extent[2]
        length_m = math.hypot(along[1] * depth_m, along[2] * width_m)
        doubts = {
            "noise": noise,
            "resolution": self._doubts.resolution_of_slope(shape, length_m),
            "layers": math.hypot(
                along[1] * self._doubts.layers_of_slope(shape.plane, depth_m),
                along[2] * self._doubts.cover_of_slope(shape.plane, width_m),
            ),
            "registration": abs(along[1]) * self._context.slope,
        }
        in_degrees = {name: math.degrees(doubt / (1.0 + slope * slope)) for name, doubt in doubts.items()}
        return expanded(math.degrees(math.atan(slope)), **in_degrees, up=math.degrees(self._context.up_rad))

    def _corners(self, k: int) -> Floats:
        shape = self._shapes[k]
        front = shape.front.middle_m
        back = shape.extent[1] if shape.back is None else shape.back.middle_m
        if shape.back is None and shape.back_limits is not None:
            back = sum(shape.back_limits) / 2.0
        corners = []
        for s, side in ((front, shape.left), (front, shape.right), (back, shape.right), (back, shape.left)):
            w = side.at(s)
            edge = shape.front if s == front else shape.back
            s = s if edge is None else edge.at(w)
            corners.append(self._to_scan(shape.to_plan(s, w), shape.plane.at(s, w)))
        return own(corners, (4, 3), "corners")

    def _nosing(self, k: int) -> Floats:
        shape = self._shapes[k]
        ends = []
        for side in (shape.left, shape.right):
            w = side.at(shape.front.middle_m)
            s = shape.front.at(w)
            ends.append(self._to_scan(shape.to_plan(s, w), shape.plane.at(s, w)))
        return own(ends, (2, 3), "nosing")

    def _to_scan(self, plan: Floats, height_m: float) -> Floats:
        point: Floats = self._context.scan_from_level @ np.array([plan[0], plan[1], height_m])
        return point


_NO_PLANE = PlaneFit(np.zeros(3), None, None, 0)
