"""What are the survey's numbers? Rise, going, depth, width and slopes from nosing to nosing, with uncertainties."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, own
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import (
    Arc,
    Chain,
    Chains,
    Examination,
    Flight,
    Horizontal,
    Measured,
    Note,
    PaperValues,
    Patches,
    Statistics,
    Step,
    StepShape,
    Up,
)
from stair_inspector.params import DisplayParams, SurveyParams, UncertaintyParams
from stair_inspector.stages.arcs import arc_length, climb_at_nosing, climb_on_arc
from stair_inspector.stages.doubt import NEAR_REGISTRATION, expanded, slope_doubt, surface_doubt
from stair_inspector.stages.links import angle_deg, turn_deg
from stair_inspector.stages.nosings import flight_after, straight_climb
from stair_inspector.stages.parts import Common, Doubts
from stair_inspector.stages.rejects import Forced
from stair_inspector.stages.treads import nearest_rows

_OWN = ("noise", "resolution", "layers")
"""Parts that every nosing has for itself."""


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """All steps and flights; ``steps`` in the order of the flights, ``surfaces`` the patch of each."""

    steps: tuple[Step, ...]
    flights: tuple[Flight, ...]
    surfaces: tuple[int, ...]
    notes: tuple[Note, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """A measuring line on one step: its points, one at the nosing, in plan (2,) and height."""

    plan: Floats
    s_m: float
    w_m: float
    height_m: float


def measure_survey(
    horizontal: Horizontal,
    patches: Patches,
    chains: Chains,
    shapes: tuple[tuple[StepShape, ...], ...],
    paper: tuple[Step, ...],
    up: Up,
    forced: Forced,
    params: SurveyParams,
    doubts: UncertaintyParams,
    display: DisplayParams,
    examined: Examination | None = None,
) -> Survey:
    """Measure every step of every flight (DESIGN: nosing to nosing, on three lines, with uncertainties).

    Parameters
    ----------
    horizontal, patches, chains, shapes
        Of one scan; level frame.
    paper : tuple of Step
        The paper's steps, one for each height cluster above the lowest.
    up : Up
        With its uncertainty, if known.
    forced : Forced
        What the user has decided.
    params, doubts, display
        Measuring lines; what the user states about the scan; points kept around each centroid.
    examined : Examination, optional
        The steps of the coordinates and doubled surfaces, which no scatter of points shows.

    Returns
    -------
    Survey
        Steps counted from 1 in the order of the flights, positions in local scan axes.
    """
    context = Common.of(up, doubts, horizontal.level_from_scan, examined)
    bases = frozenset(chain.base for chain in chains.chains)
    steps: list[Step] = []
    flights: list[Flight] = []
    notes: list[Note] = list(chains.notes)
    if chains.chains and not (doubts.registration_m or doubts.edge_m or doubts.up_deg):
        message = (
            "u holds what the scan itself shows; what registration, levelling and the rounding of edges add is not "
            "stated: choose the scanner's preset, or set uncertainty.*"
        )
        notes.append(Note("uncertainty_unstated", "survey", message))
    numbers: list[int] = []
    for flight_id, (chain, own_shapes) in enumerate(zip(chains.chains, shapes, strict=True), 1):
        first_id = len(steps) + 1
        after = flight_after(chains, flight_id - 1)
        next_shape = None if after is None else shapes[after][0]
        measured = _Measurer(chain, own_shapes, next_shape, context, params).measure()
        kinds = _kinds_of(chain, own_shapes, measured, bases, forced)
        for k, (values, shape, kind) in enumerate(zip(measured, own_shapes, kinds, strict=True)):
            surface = patches.surfaces[shape.surface]
            fit = surface.plane
            numbers.append(shape.surface)
            steps.append(
                replace(
                    values,
                    step_id=first_id + k,
                    plane=fit,
                    # To the paper the lowest height cluster is the floor and has no values of a step.
                    paper=paper[surface.level_id - 1].paper if surface.level_id else PaperValues(),
                    nearest_ids=nearest_rows(horizontal, surface.rows, fit.centroid, display.nearest_k),
                    kind=kind,
                    flight=flight_id,
                )
            )
        own_steps = steps[first_id - 1 :]
        flights.append(_flight_of(flight_id, chain, own_shapes, own_steps, context))
        if flights[-1].radius_m is not None:
            message = (
                f"flight {flight_id} curves: its goings are measured along the arc through the middles of its nosings, "
                "and on the left and right along arcs about the same centre; a limit that a code puts on a walking "
                "line elsewhere cannot be judged on them"
            )
            notes.append(Note("curved", "survey", message))
        elif flights[-1].shape != "straight":
            message = (
                f"flight {flight_id} winds ({flights[-1].shape}): its steps are measured about their own nosings, in "
                "the middle of what was seen of them; codes measure on a walking line and cannot be judged on it"
            )
            notes.append(Note("winding", "survey", message))
        notes += _notes_of(chain, own_shapes, own_steps)
    return Survey(tuple(steps), tuple(flights), tuple(numbers), tuple(notes))


class _Measurer:
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
            going = None if goings[k] is None else self._going(k, goings[k])
            rise = self._rise(k, rises[k], goings[k - 1] if k else None)
            next_rise = None
            if k + 1 < n:
                next_rise = self._rise(k + 1, rises[k + 1], goings[k])
            depth = self._depth(k, goings[k])
            steps.append(
                Step(
                    step_id=0,
                    plane=_NO_PLANE,
                    corners=self._corners(k),
                    nearest_ids=np.zeros(0, dtype=np.int64),
                    paper=PaperValues(),
                    rise_m=rise,
                    going_m=going,
                    tread_depth_m=depth,
                    width_m=self._width(k),
                    nosing_overhang_m=self._overhang(k, depth, going),
                    pitch_deg=None if going is None or next_rise is None else self._pitch(going, next_rise),
                    fall_deg=self._slope(shape, self._climbs[k]),
                    cross_fall_deg=self._slope(shape, _left_of(self._climbs[k])),
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
        ds, dw = float(climb @ shape.climb), float(climb @ _left_of(shape.climb))
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
            resolution=math.hypot(*(doubts.rounding_of_level(plane, shape) for plane in (shape.plane, below))),
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
            resolution=math.hypot(
                doubts.rounding_across(lower.front, lower), doubts.rounding_across(upper.front, upper)
            ),
            layers=math.hypot(doubts.layers_across(lower.front, lower), doubts.layers_across(upper.front, upper)),
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
        edge = math.hypot(self._doubts.place(shape.front, shape), self._wedge_doubt(k, goings))
        noise = shape.front.noise_at(line.w_m)
        if shape.back is not None:
            depth_m = shape.back.at(line.w_m) - line.s_m
            noise = math.hypot(noise, shape.back.noise_at(line.w_m))
            edge = math.hypot(edge, self._doubts.place(shape.back, shape))
        elif shape.back_limits is not None:
            # Anywhere between the two: half the interval is the expanded uncertainty.
            low, high = shape.back_limits
            depth_m = (low + high) / 2.0 - line.s_m
            edge = math.hypot(edge, (high - low) / 4.0)
        else:
            return None
        return expanded(
            depth_m,
            noise=noise,
            edge=edge,
            resolution=math.hypot(*(self._doubts.rounding_across(end, shape) for end in (shape.front, shape.back))),
            layers=math.hypot(*(self._doubts.layers_across(end, shape) for end in (shape.front, shape.back))),
            registration=self._context.registration_m,
            scale=self._context.scale * depth_m,
        )

    def _overhang(self, k: int, depth: Measured | None, going: Measured | None) -> Measured | None:
        """Return how far the next nosing stands over this tread; its own nosing, in both terms, drops out.

        The two edges lie at one place, where registration adds less than from step to step.
        """
        if depth is None or going is None:
            return None
        shape, above = self._shapes[k], self._shapes[k + 1]
        w = self._lines[k][1].w_m
        noise, edge = above.front.noise_at(self._lines[k + 1][1].w_m), self._doubts.place(above.front, above)
        if shape.back is not None:
            noise = math.hypot(noise, shape.back.noise_at(w))
            edge = math.hypot(edge, self._doubts.place(shape.back, shape))
        elif shape.back_limits is not None:
            edge = math.hypot(edge, (shape.back_limits[1] - shape.back_limits[0]) / 4.0)
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
            resolution=math.hypot(
                self._doubts.rounding_across(shape.back, shape), self._doubts.rounding_across(above.front, above)
            ),
            layers=math.hypot(
                self._doubts.layers_across(shape.back, shape), self._doubts.layers_across(above.front, above)
            ),
            up=self._context.up_rad * abs(rise_m),
            registration=NEAR_REGISTRATION * self._context.registration_m,
        )

    def _width(self, k: int) -> Measured:
        shape = self._shapes[k]
        s = self._mid_depth(k)
        doubt = math.hypot(self._doubts.side(shape.left, shape), self._doubts.side(shape.right, shape))
        width_m = shape.left.at(s) - shape.right.at(s)
        if shape.arc is not None:
            # Square to the sides, which slant against the nosing in the middle of the tread.
            width_m *= math.cos(math.atan((shape.left.slope + shape.right.slope) / 2.0))
        return expanded(
            width_m,
            noise=math.hypot(shape.left.noise_at(s), shape.right.noise_at(s)),
            edge=doubt,
            resolution=math.hypot(*(self._doubts.rounding_aside(side, shape) for side in (shape.left, shape.right))),
            layers=math.sqrt(2.0) * self._doubts.layers_aside(shape),
            registration=self._context.registration_m,
            scale=self._context.scale * width_m,
        )

    def _mid_depth(self, k: int) -> float:
        shape = self._shapes[k]
        # Where the side edges were looked for and their noise is least.
        return (shape.left.along_m + shape.right.along_m) / 2.0

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
        along = np.array([0.0, float(direction @ shape.climb), float(direction @ _left_of(shape.climb))])
        slope = float(along[1] * shape.plane.slope[0] + along[2] * shape.plane.slope[1])
        noise = math.sqrt(max(0.0, float(along @ shape.plane.covariance @ along)))
        # Over the width, what one station and the other see is mixed everywhere.
        depth_m = shape.extent[1] - shape.extent[0]
        noise = math.hypot(noise, abs(along[1]) * slope_doubt(shape.plane, depth_m))
        length_m = math.hypot(along[1] * depth_m, along[2] * (shape.extent[3] - shape.extent[2]))
        doubts = {
            "noise": noise,
            "resolution": self._doubts.rounding_of_slope(shape, length_m),
            "layers": abs(along[1]) * self._doubts.layers_of_slope(shape.plane, depth_m),
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


def find_climbs(chain: Chain, shapes: tuple[StepShape, ...]) -> list[Floats]:
    """Return the direction of climb at every step.

    One for a straight flight, that of the arc where it curves, each nosing's own where it winds.
    """
    if shapes[0].arc is not None:
        return [climb_on_arc(shapes[0].arc, shape) for shape in shapes]
    normals = [climb_at_nosing(shape) for shape in shapes]
    if straight_climb(chain) is None:
        return normals
    weights = np.array([1.0 / max(shape.front.slope_noise, 1e-4) ** 2 for shape in shapes])
    middle = np.median(normals, axis=0)
    is_alike = np.array([angle_deg(normal, middle) <= 2.0 for normal in normals])
    common = (weights * is_alike) @ np.array(normals) if is_alike.any() else middle
    return [common / np.hypot(*common)] * len(shapes)


def _left_of(climb: Floats) -> Floats:
    return np.array([-climb[1], climb[0]])


def _kinds_of(
    chain: Chain,
    shapes: tuple[StepShape, ...],
    steps: Sequence[Step],
    bases: frozenset[int | None],
    forced: Forced,
) -> list[Literal["tread", "landing"]]:
    """Tell landings from treads: by depth, by another flight that begins there, or because the user says so."""
    goings = [step.going_m.value for step in steps if step.going_m is not None]
    usual_m = float(np.median(goings)) if goings else priors.LONGEST_TREAD_M / priors.LANDING_RATIO
    kinds: list[Literal["tread", "landing"]] = []
    for k, (number, shape) in enumerate(zip(chain.steps, shapes, strict=True)):
        depth_m = shape.extent[1] - shape.front.middle_m
        # Only where a flight ends can a landing be: within it, a tread is missing above a step that looks deep.
        is_deep = depth_m > min(priors.LONGEST_TREAD_M, priors.LANDING_RATIO * usual_m) and k == len(shapes) - 1
        decided = forced.kinds.get(number)
        is_landing = decided == "landing" or (decided != "tread" and (is_deep or number in bases))
        kinds.append("landing" if is_landing else "tread")
    return kinds


def _flight_of(
    flight_id: int, chain: Chain, shapes: tuple[StepShape, ...], steps: Sequence[Step], context: Common
) -> Flight:
    climb = find_climbs(chain, shapes)[0]
    treads = [step for step in steps if step.kind == "tread"] or list(steps)
    widths = [step.width_m for step in treads if step.width_m is not None]
    return Flight(
        flight_id=flight_id,
        step_ids=tuple(step.step_id for step in steps),
        n_risers=sum(chain.n_missing) + len(steps) - (1 if chain.base is None else 0),
        shape=_shape_name(chain, shapes),
        climb=own(context.scan_from_level[:, :2] @ climb, (3,), "climb"),
        pitch_deg=_best_pitch(chain, shapes, steps, context),
        width_m=_mean_of(widths),
        rise=statistics_of([(step.step_id, step.rise_m) for step in steps]),
        going=statistics_of([(step.step_id, step.going_m) for step in steps if step.kind == "tread"]),
        radius_m=_radius_of(shapes[0].arc, context),
    )


def _radius_of(arc: Arc | None, context: Common) -> Measured | None:
    if arc is None:
        return None
    return expanded(arc.radius_m, noise=arc.radius_noise_m, edge=arc.middle_noise_m, scale=context.scale * arc.radius_m)


def _shape_name(chain: Chain, shapes: tuple[StepShape, ...]) -> Literal["straight", "curved", "winder", "spiral"]:
    if shapes[0].arc is not None:
        return "curved"
    if straight_climb(chain) is not None:
        return "straight"
    climbs = find_climbs(chain, shapes)
    turns = [turn_deg(a, b) for a, b in itertools.pairwise(climbs)]
    is_one_way = all(turn * sum(turns) > 0.0 for turn in turns)
    return "spiral" if is_one_way and abs(sum(turns)) > priors.SPIRAL_DEG else "winder"


def _best_pitch(chain: Chain, shapes: tuple[StepShape, ...], steps: Sequence[Step], context: Common) -> Measured | None:
    """Fit a line to the nosings' centres, over the way along the flight and the height."""
    if len(steps) < 2 or any(chain.n_missing):
        return None
    rises = [step.rise_m for step in steps[1:]]
    goings = [step.going_m for step in steps[:-1]]
    if any(value is None for value in (*rises, *goings)):
        return None
    run = np.concatenate([[0.0], np.cumsum([going.value for going in goings if going is not None])])
    height = np.concatenate([[0.0], np.cumsum([rise.value for rise in rises if rise is not None])])
    centred = run - run.mean()
    slope = float(centred @ height / (centred @ centred))
    # Each nosing's own doubt in height and, through the slope, in place.
    each = [
        math.sqrt(sum(_part(rise, name) ** 2 + (slope * _part(going, name)) ** 2 for name in _OWN) / 2.0)
        for rise, going in zip(rises, goings, strict=True)
    ]
    noise = math.sqrt(float(np.mean(np.square(each)))) / math.sqrt(float(centred @ centred))
    edge = max(slope * _part(going, "edge") for going in goings) / float(np.ptp(run))
    registration = context.registration_m / float(np.ptp(run))
    to_deg = math.degrees(1.0) / (1.0 + slope * slope)
    return expanded(
        math.degrees(math.atan(slope)),
        noise=noise * to_deg,
        edge=edge * to_deg,
        registration=registration * to_deg,
        up=math.degrees(context.up_rad),
    )


def _part(measured: Measured | None, name: str) -> float:
    """Return one part of an uncertainty, k = 1."""
    return 0.0 if measured is None else dict(measured.parts).get(name, 0.0) / 2.0


def _mean_of(values: Sequence[Measured]) -> Measured | None:
    """Return the mean; its noise shrinks with the number of values, what they have in common does not."""
    if not values:
        return None
    names = sorted({name for value in values for name, _ in value.parts})
    parts = {name: math.sqrt(float(np.mean([_part(value, name) ** 2 for value in values]))) for name in names}
    parts["noise"] = parts.get("noise", 0.0) / math.sqrt(len(values))
    return expanded(float(np.mean([value.value for value in values])), **parts)


def statistics_of(values: Sequence[tuple[int, Measured | None]]) -> Statistics | None:
    """Return the statistics of a quantity over steps; a step without a value parts its neighbours."""
    known = [value.value for _, value in values if value is not None]
    if not known:
        return None
    pairs = [
        (abs(b.value - a.value), (i, j))
        for (i, a), (j, b) in itertools.pairwise(values)
        if a is not None and b is not None
    ]
    widest = max(pairs, key=lambda pair: pair[0]) if pairs else None
    return Statistics(
        n=len(known),
        mean=float(np.mean(known)),
        min=min(known),
        max=max(known),
        range=max(known) - min(known),
        max_adjacent=None if widest is None else widest[0],
        at=None if widest is None else widest[1],
    )


def _notes_of(chain: Chain, shapes: tuple[StepShape, ...], steps: Sequence[Step]) -> list[Note]:
    """Say of every step what was not observed, and why a value is null."""
    notes = []
    for k, (shape, step) in enumerate(zip(shapes, steps, strict=True)):
        here = step.step_id
        if chain.n_missing[k]:
            count = chain.n_missing[k]
            text = "a tread is" if count == 1 else f"{count} treads are"
            below, lost = f"step {here - 1}", f"neither the rise to step {here} nor the going of step {here - 1} is"
            if k == 0:
                below, lost = "the floor or landing", f"the rise to step {here} is not"
            message = f"{text} missing or not seen between {below} and step {here}: {lost} defined"
            notes.append(Note("tread_missing", "survey", message, here))
        elif step.rise_m is None:
            message = f"step {here} has no rise: no floor or landing was seen a riser below it"
            notes.append(Note("rise_unobserved", "survey", message, here))
        if not shape.front.support:
            message = f"the nosing of step {here} was not seen, only the rim of its surface: its place is uncertain"
            notes.append(Note("nosing_unobserved", "survey", message, here))
        if shape.back is None and shape.back_limits is not None:
            message = (
                f"the back of step {here} is hidden, as under the nosing above it: its depth is the middle of what is "
                "possible"
            )
            notes.append(Note("back_hidden", "survey", message, here))
        elif shape.back is None:
            notes.append(Note("back_unobserved", "survey", f"the back edge of step {here} was not seen", here))
        if not min(shape.left.support, shape.right.support):
            message = f"a side of step {here} was not seen, or ends inside those of the others: its width is uncertain"
            notes.append(Note("side_unobserved", "survey", message, here))
    return notes


_NO_PLANE = PlaneFit(np.zeros(3), None, None, 0)
