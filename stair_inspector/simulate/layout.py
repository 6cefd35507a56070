"""Where every step lies: takes a Stair, gives the true measures of its steps.

Steps are first laid out as seen from above, as footprints, always turning left; a stair that turns right is the mirror
image. The stair frame: z up, the stair climbs along +x at its foot, the foot of the first riser is x = 0, the floor
z = 0, the middle of the width y = 0; so left, as seen when climbing, is +y at the foot.
"""

import dataclasses
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from stair_inspector.geometry.arrays import Point
from stair_inspector.simulate.specs import N_WINDERS, Shape, Stair, parse_errors, parse_steps

Flat = tuple[float, float]
Three = tuple[float, float, float]

SHARES_FROM_LEFT = (0.15, 0.5, 0.85)
"""Where rise and going are measured, as shares of the width counted from the left."""

POST_RADIUS_M = 0.05
"""Radius of the post about which winder treads turn."""

_ARC_DEG = 6.0  # Longest facet of a spiral's outer edge.
_CURVE_DEG = 0.75  # The same of a curved stair's sides: 0.1 mm from the arc at a radius of 5 m.
_SAME_M = 1e-9  # Corners this near to each other are one.
_PARALLEL = 0.05  # Sine of the angle below which a line is not followed to the next edge: it would meet it far away.


@dataclass(frozen=True, slots=True)
class Footprint:
    """A step seen from above, stair frame, metres; left and right as seen when climbing.

    ``climb`` is the unit vector up the stair; ``front`` holds the ends of the nosing, ``riser`` those of the
    riser's face under it, left first. ``left`` and ``right`` are the side edges from the riser (left out) to the back
    edge, which joins the last of either.
    """

    climb: Flat
    front: tuple[Flat, Flat]
    riser: tuple[Flat, Flat]
    left: tuple[Flat, ...]
    right: tuple[Flat, ...]

    @property
    def back(self) -> tuple[Flat, Flat]:
        """Ends of the back edge, left and right."""
        return self.left[-1], self.right[-1]

    @property
    def middle(self) -> Flat:
        """Middle of the nosing."""
        return along(self.front, 0.5)

    @property
    def outline(self) -> tuple[Flat, ...]:
        """Corners of the top, counter-clockwise from the left end of the nosing; none on a straight line."""
        ring = without_repeats((*self.front, self.riser[1], *self.right, *reversed(self.left), self.riser[0]))
        return tuple(
            corner
            for index, corner in enumerate(ring)
            if index < 2 or not _is_straight(ring[index - 1], corner, ring[(index + 1) % len(ring)])
        )

    def mapped(self, place: Callable[[Flat], Flat], turn: Callable[[Flat], Flat]) -> "Footprint":
        """Return the footprint elsewhere: ``place`` moves points, ``turn`` directions."""
        return Footprint(
            climb=turn(self.climb),
            front=(place(self.front[0]), place(self.front[1])),
            riser=(place(self.riser[0]), place(self.riser[1])),
            left=tuple(place(corner) for corner in self.left),
            right=tuple(place(corner) for corner in self.right),
        )

    def mirrored(self) -> "Footprint":
        """Return the mirror image about the x axis: left becomes right."""
        image = self.mapped(_mirror, _mirror)
        return Footprint(image.climb, image.front[::-1], image.riser[::-1], image.right, image.left)


@dataclass(frozen=True, slots=True)
class StepTruth:
    """The true measures of one step, metres and degrees; ``nosing`` holds its left and right end, stair frame.

    ``rise_m`` is to this step, from the nosing below (or the floor, or a landing that turns, at the foot of the riser),
    at the middle of the width; ``going_m`` is from this step to the next, None for the upper landing and a landing that
    turns; ``tread_depth_m`` runs to the riser above, or to the back edge. Of a step that is missing these are the
    measures it would have, and its neighbours' are measured to it.

    ``rise_lcr_m`` and ``going_lcr_m`` are the same on three lines, at 15, 50 and 85 % of the nosing's length from the
    left: the rise along the line of climb, the going square to the edge of this step. On a curved stair both follow the
    arcs through those points, about the stair's centre, and the going is the length of the arc. ``pitch_deg`` is that
    of the line to the next nosing, None where there is no going. ``climb`` is the unit vector up the stair, seen from
    above.
    """

    step_id: int
    flight: int
    kind: Literal["tread", "landing"]
    rise_m: float
    going_m: float | None
    tread_depth_m: float
    width_m: float
    nosing_overhang_m: float
    height_m: float
    fall_deg: float
    cross_fall_deg: float
    dish_m: float
    nosing: tuple[Point, Point]
    plan: Footprint
    rise_lcr_m: Three
    going_lcr_m: Three | None
    pitch_deg: float | None
    shape: Shape = "straight"
    is_missing: bool = False

    @property
    def climb(self) -> Flat:
        """Unit vector up the stair, seen from above."""
        return self.plan.climb

    def top(self, x: float, y: float) -> float:
        """Return the height of the plane through the nosing, without dish or strip, at x and y."""
        (middle_x, middle_y), (climb_x, climb_y) = self.plan.middle, self.plan.climb
        ahead = (x - middle_x) * climb_x + (y - middle_y) * climb_y
        aside = (y - middle_y) * climb_x - (x - middle_x) * climb_y
        fall, cross = math.tan(math.radians(self.fall_deg)), math.tan(math.radians(self.cross_fall_deg))
        return self.height_m + ahead * fall + aside * cross


def lay_out(stair: Stair) -> tuple[StepTruth, ...]:
    """Return the true measures of every step, from the bottom up; the last one is the upper landing.

    Notes
    -----
    Flights are counted from 1; a landing is the last step of the flight that leads to it. The steps of a twin follow
    those of the first staircase, and so do its flights.
    """
    last = stair.n_risers
    plans = _plans(stair)
    rise_errors = parse_errors("stair.rise_errors_m", stair.rise_errors_m, last, math.inf)
    going_errors = parse_errors("stair.going_errors_m", stair.going_errors_m, last, math.inf)
    falls = parse_errors("stair.fall_errors_deg", stair.fall_errors_deg, last, math.inf)
    cross_falls = parse_errors("stair.cross_fall_errors_deg", stair.cross_fall_errors_deg, last, math.inf)
    dishes = parse_errors("stair.dish_errors_m", stair.dish_errors_m, last, math.inf)
    missing = parse_steps("stair.missing_treads", stair.missing_treads, last)
    steps: list[StepTruth] = []
    height = 0.0
    for k, plan in enumerate(plans, start=1):
        rise = stair.rise_m + rise_errors.get(k, 0.0)
        height += rise
        is_landing = k in (stair.landing_after, last)
        shape = _shape_of(stair, k)
        going: float | None = None
        if k < last and not _is_turning_landing(stair, k):
            going = (stair.landing_depth_m if is_landing else stair.going_m) + going_errors.get(k, 0.0)
        step = StepTruth(
            step_id=k,
            flight=2 if 0 < stair.landing_after < k else 1,
            kind="landing" if is_landing else "tread",
            rise_m=rise,
            going_m=going,
            tread_depth_m=_tread_depth(stair, k, plan, going),
            width_m=stair.width_m if shape in ("straight", "curved") else math.dist(*plan.front),
            nosing_overhang_m=stair.overhang_m,
            height_m=height,
            fall_deg=falls.get(k, 0.0),
            cross_fall_deg=cross_falls.get(k, 0.0),
            dish_m=dishes.get(k, 0.0),
            nosing=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            plan=plan,
            rise_lcr_m=(rise, rise, rise),
            going_lcr_m=None,
            pitch_deg=None,
            shape=shape,
            is_missing=k in missing,
        )
        left, right = ((x, y, step.top(x, y)) for x, y in plan.front)
        steps.append(dataclasses.replace(step, nosing=(left, right)))
    measured = _measured(stair, steps)
    return measured + _twins(stair, measured) if stair.twin_gap_m else measured


def way_up(stair: Stair, steps: tuple[StepTruth, ...]) -> tuple[Point, ...]:
    """Return the way up, from the first nosing to the upper landing: the ground has each point's height from there on.

    Parameters
    ----------
    stair : Stair
        Its landings are crossed along their middle.
    steps : tuple of StepTruth
        As ``lay_out`` gives them; a twin is not walked on.
    """
    line: list[Point] = []
    ground = 0.0
    steps = steps[: stair.n_risers]
    for step in steps:
        if not step.is_missing:
            ground = step.height_m
        line.append((*step.plan.middle, ground))
        if _is_turning_landing(stair, step.step_id):
            line += [(x, y, ground) for x, y in _middle_of_turn(step.plan, steps[step.step_id].plan)]
    # Far enough for the upper nosing not to lie in the blind spot under the scanner.
    far = min(1.6, 0.8 * stair.upper_landing_m)
    line.append((*shifted(steps[-1].plan.middle, steps[-1].climb, far), ground))
    return tuple(line)


def along(edge: tuple[Flat, Flat], share: float) -> Flat:
    """Return the point at a share of an edge's length from its first end."""
    (x0, y0), (x1, y1) = edge
    # The middle of two ends that lie opposite each other about zero is zero itself.
    return x0 * (1.0 - share) + x1 * share, y0 * (1.0 - share) + y1 * share


def without_repeats(ring: Sequence[Flat]) -> tuple[Flat, ...]:
    """Return a ring of corners without those that lie where the one before them lies."""
    kept = list(ring[:1])
    for corner in ring[1:]:
        if math.dist(corner, kept[-1]) > _SAME_M and math.dist(corner, kept[0]) > _SAME_M:
            kept.append(corner)
    return tuple(kept)


def square_to(edge: tuple[Flat, Flat]) -> Flat:
    """Return the unit vector square to an edge, upwards for one who has its first end on the left."""
    (x0, y0), (x1, y1) = edge
    length = math.dist(*edge)
    return (y0 - y1) / length, (x1 - x0) / length


def shifted(point: Flat, direction: Flat, distance: float) -> Flat:
    """Return a point moved along a direction."""
    return point[0] + direction[0] * distance, point[1] + direction[1] * distance


def _plans(stair: Stair) -> tuple[Footprint, ...]:
    """Return the footprints of all steps of the first staircase."""
    n = stair.n_risers
    if stair.shape == "spiral":
        plans = _spiral(stair)
    elif stair.shape == "curved":
        plans = _curved(stair)
    elif stair.shape == "winder":
        below = _run(stair, 1, stair.winder_after)
        corner_x = sum(_goings(stair, 1, stair.winder_after))
        quarter = _placed_at((corner_x + stair.width_m / 2.0, stair.width_m / 2.0), (0.0, 1.0))
        above = [quarter(plan) for plan in _run(stair, stair.winder_after + N_WINDERS + 1, n)]
        plans = below + _winders(stair, corner_x) + above
    elif stair.turn == "none":
        plans = _run(stair, 1, n)
    else:
        plans = _turned(stair)
    return tuple(plan.mirrored() for plan in plans) if stair.turn in ("right", "u_right") else tuple(plans)


def _goings(stair: Stair, first: int, last: int) -> list[float]:
    errors = parse_errors("stair.going_errors_m", stair.going_errors_m, stair.n_risers, math.inf)
    return [
        (stair.landing_depth_m if k == stair.landing_after else stair.going_m) + errors.get(k, 0.0)
        for k in range(first, last + 1)
    ]


def _run(stair: Stair, first: int, last: int) -> list[Footprint]:
    """Return steps one behind the other, the first riser of them at x = 0, climbing along +x."""
    skews = parse_errors("stair.skew_errors_m", stair.skew_errors_m, stair.n_risers, math.inf)
    if stair.turn in ("right", "u_right"):
        skews = {step: -skew for step, skew in skews.items()}  # The mirror will turn them over.
    half, front = stair.width_m / 2.0, -stair.overhang_m
    plans: list[Footprint] = []
    for k, going in zip(range(first, last + 1), _goings(stair, first, last), strict=True):
        depth = stair.upper_landing_m if k == stair.n_risers else going + stair.overhang_m
        lead = skews.get(k, 0.0) / 2.0
        back_lead = 0.0 if k == last else skews.get(k + 1, 0.0) / 2.0
        riser, back = front + stair.overhang_m, front + depth
        plans.append(
            Footprint(
                climb=(1.0, 0.0),
                front=((front - lead, half), (front + lead, -half)),
                riser=((riser - lead, half), (riser + lead, -half)),
                left=((back - back_lead, half),),
                right=((back + back_lead, -half),),
            )
        )
        front += going
    return plans


def _turned(stair: Stair) -> list[Footprint]:
    """Return two flights that meet at a landing, the second to the left of the first or coming back beside it."""
    turn_at, width, half = stair.landing_after, stair.width_m, stair.width_m / 2.0
    below = _run(stair, 1, turn_at - 1)
    above = _run(stair, turn_at + 1, stair.n_risers)
    entry_x = sum(_goings(stair, 1, turn_at - 1))
    if stair.turn in ("left", "right"):
        far_x, far_y = entry_x + width, half
        place = _placed_at((entry_x + half, half), (0.0, 1.0))
    else:
        far_x, far_y = entry_x + stair.landing_depth_m, half + stair.well_m + width
        place = _placed_at((entry_x, width + stair.well_m), (-1.0, 0.0))
    # The first riser of the second flight may be skew, and the landing ends at it.
    above = [place(plan) for plan in above]
    # The first riser of the second flight and that of the landing may be skew; what lies below either ends at it.
    exit_left, exit_right = above[0].riser
    entry = _placed_at((entry_x, 0.0), (1.0, 0.0))(_run(stair, turn_at, turn_at)[0])
    landing = dataclasses.replace(entry, left=(exit_left,), right=((far_x, -half), (far_x, far_y), exit_right))
    if below:
        below[-1] = dataclasses.replace(below[-1], left=entry.riser[:1], right=entry.riser[1:])
    return [*below, landing, *above]


def _winders(stair: Stair, corner_x: float) -> list[Footprint]:
    """Return three wedge treads that turn left in the square behind x = ``corner_x``, about its inner corner."""
    half = stair.width_m / 2.0
    corner, far_x = (corner_x, half), corner_x + stair.width_m

    def edge(angle: float, overhang_m: float) -> tuple[Flat, Flat]:
        # From the post to the side of the square that is met first.
        out = (math.sin(angle), -math.cos(angle))
        base = shifted(corner, (math.cos(angle), math.sin(angle)), -overhang_m)
        to_far = (far_x - base[0]) / out[0] if out[0] > _PARALLEL else math.inf
        to_near = (-half - base[1]) / out[1] if out[1] < -_PARALLEL else math.inf
        return shifted(base, out, POST_RADIUS_M), shifted(base, out, min(to_far, to_near))

    plans: list[Footprint] = []
    for index in range(N_WINDERS):
        start, stop = (math.radians(90.0 * number / N_WINDERS) for number in (index, index + 1))
        riser, back = edge(start, 0.0), edge(stop, 0.0)
        outer = ((far_x, -half),) if start < math.pi / 4.0 < stop else ()
        climb = (math.cos(start), math.sin(start))
        plans.append(Footprint(climb, edge(start, stair.overhang_m), riser, (back[0],), (*outer, back[1])))
    return plans


def _spiral(stair: Stair) -> list[Footprint]:
    """Return wedge treads that turn left about a column; the upper landing leaves straight ahead."""
    inner, outer = stair.spiral_radius_m, stair.spiral_radius_m + stair.width_m
    middle = (inner + outer) / 2.0
    centre = (0.0, stair.width_m / 2.0 + inner)
    ahead = stair.going_m - stair.overhang_m
    # The turn for which the line square to a nosing, from its middle, meets the next nosing at just the going.
    step_rad = math.atan2(ahead, middle) + math.asin(stair.overhang_m / math.hypot(middle, ahead))

    def at(radius: float, angle: float) -> Flat:
        return centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle)

    n_facets = max(1, math.ceil(math.degrees(step_rad) / _ARC_DEG))
    plans: list[Footprint] = []
    for index in range(stair.n_risers):
        start, stop = index * step_rad, (index + 1) * step_rad
        climb = (math.cos(start), math.sin(start))
        riser = (at(inner, start), at(outer, start))
        front = (shifted(riser[0], climb, -stair.overhang_m), shifted(riser[1], climb, -stair.overhang_m))
        if index + 1 < stair.n_risers:
            left: tuple[Flat, ...] = (at(inner, stop),)
            right = tuple(at(outer, start + step_rad * (facet + 1) / n_facets) for facet in range(n_facets))
        else:
            far = stair.upper_landing_m
            left, right = (shifted(front[0], climb, far),), (shifted(front[1], climb, far),)
        plans.append(Footprint(climb, front, riser, left, right))
    return plans


def _curved(stair: Stair) -> list[Footprint]:
    """Return treads that turn left about a far centre; the upper landing leaves straight ahead."""
    inner, outer = stair.curve_radius_m - stair.width_m / 2.0, stair.curve_radius_m + stair.width_m / 2.0
    centre = (0.0, stair.curve_radius_m)
    step_rad = _curve_rad(stair)

    def at(radius: float, angle: float) -> Flat:
        return centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle)

    n_facets = max(1, math.ceil(math.degrees(step_rad) / _CURVE_DEG))
    plans: list[Footprint] = []
    for index in range(stair.n_risers):
        start = index * step_rad
        climb = (math.cos(start), math.sin(start))
        riser = (at(inner, start), at(outer, start))
        front = (shifted(riser[0], climb, -stair.overhang_m), shifted(riser[1], climb, -stair.overhang_m))
        left, right = (
            tuple(at(radius, start + step_rad * (facet + 1) / n_facets) for facet in range(n_facets))
            for radius in (inner, outer)
        )
        if index + 1 == stair.n_risers:
            far = stair.upper_landing_m
            left, right = (shifted(front[0], climb, far),), (shifted(front[1], climb, far),)
        plans.append(Footprint(climb, front, riser, left, right))
    return plans


def _curve_rad(stair: Stair) -> float:
    """Return the turn from step to step for which the arc through the middles of the nosings is a going long."""
    return stair.going_m / math.hypot(stair.curve_radius_m, stair.overhang_m)


def _measured(stair: Stair, steps: list[StepTruth]) -> tuple[StepTruth, ...]:
    """Return the steps with what is measured between them."""
    measured: list[StepTruth] = []
    for index, step in enumerate(steps):
        before = steps[index - 1] if index else None
        after = steps[index + 1] if index + 1 < len(steps) else None
        left, middle, right = (_rise_on(stair, before, step, share) for share in SHARES_FROM_LEFT)
        is_plain = step.shape == "straight" and not (before and _is_turning_landing(stair, before.step_id))
        goings: Three | None = None
        going = step.going_m
        if after is not None and going is not None:
            a, b, c = (_going_on(stair, step.plan, after.plan, share) for share in SHARES_FROM_LEFT)
            goings = (a, b, c)
            going = going if step.shape == "straight" else b
        measured.append(
            dataclasses.replace(
                step,
                rise_m=step.rise_m if is_plain else middle,
                going_m=going,
                rise_lcr_m=(left, middle, right),
                going_lcr_m=goings,
            )
        )
    for index, (step, after) in enumerate(itertools.pairwise(measured)):
        if step.going_m is not None:
            pitch = math.degrees(math.atan2(after.rise_m, step.going_m))
            measured[index] = dataclasses.replace(step, pitch_deg=pitch)
    return tuple(measured)


def _rise_on(stair: Stair, before: StepTruth | None, step: StepTruth, share: float) -> float:
    """Return the height of a nosing above the one below, on the line of climb through a share of its length."""
    x, y = along(step.plan.front, share)
    height = step.top(x, y)
    if before is None:
        return height
    if _is_turning_landing(stair, before.step_id):
        return height - before.top(*along(step.plan.riser, share))
    if stair.shape == "curved":
        return height - before.top(*along(before.plan.front, share))
    back_x, back_y = step.climb
    below = _meeting((x, y), (-back_x, -back_y), before.plan.front)
    return height - before.top(*shifted((x, y), (-back_x, -back_y), below))


def _going_on(stair: Stair, plan: Footprint, after: Footprint, share: float) -> float:
    """Return the distance to the next nosing from a share of this one's length: square to it, or along the arc."""
    if stair.shape == "curved":
        x, y = along(plan.front, share)
        side = -1.0 if stair.turn == "right" else 1.0
        return math.hypot(x, y - side * stair.curve_radius_m) * _curve_rad(stair)
    return _meeting(along(plan.front, share), square_to(plan.front), after.front)


def _meeting(start: Flat, direction: Flat, edge: tuple[Flat, Flat]) -> float:
    """Return how far along a direction the line through an edge is met; infinite where it hardly ever is."""
    normal = square_to(edge)
    closing = direction[0] * normal[0] + direction[1] * normal[1]
    apart = (edge[0][0] - start[0]) * normal[0] + (edge[0][1] - start[1]) * normal[1]
    return apart / closing if abs(closing) > _PARALLEL else math.inf


def _tread_depth(stair: Stair, k: int, plan: Footprint, going: float | None) -> float:
    if k == stair.n_risers:
        return stair.upper_landing_m
    if _is_turning_landing(stair, k):
        across = stair.width_m if stair.turn in ("left", "right") else stair.landing_depth_m
        return across + stair.overhang_m
    if _shape_of(stair, k) != "straight":
        return _meeting(plan.middle, plan.climb, plan.back)
    return (going or 0.0) + stair.overhang_m


def _twins(stair: Stair, steps: tuple[StepTruth, ...]) -> tuple[StepTruth, ...]:
    """Return the steps of the second staircase, on the left of the first."""
    aside = stair.width_m + stair.twin_gap_m
    n_flights = steps[-1].flight

    def place(point: Flat) -> Flat:
        return point[0], point[1] + aside

    def over(point: Point) -> Point:
        return (*place(point[:2]), point[2])

    return tuple(
        dataclasses.replace(
            step,
            step_id=step.step_id + len(steps),
            flight=step.flight + n_flights,
            plan=step.plan.mapped(place, lambda direction: direction),
            nosing=(over(step.nosing[0]), over(step.nosing[1])),
        )
        for step in steps
    )


def _shape_of(stair: Stair, k: int) -> Shape:
    if stair.shape in ("curved", "spiral"):
        return stair.shape
    is_winder = stair.shape == "winder" and 0 < k - stair.winder_after <= N_WINDERS
    return "winder" if is_winder else "straight"


def _is_turning_landing(stair: Stair, k: int) -> bool:
    return stair.turn != "none" and k == stair.landing_after and k > 0


def _middle_of_turn(landing: Footprint, after: Footprint) -> list[Flat]:
    """Return where one turns on a landing: ahead of either flight, in the middle of the landing's depth."""
    entry, leave = along(landing.riser, 0.5), along(after.riser, 0.5)
    far_x = landing.right[0][0]
    if abs(after.climb[1]) > 0.5:
        return [(leave[0], entry[1])]
    middle_x = (entry[0] + far_x) / 2.0
    return [(middle_x, entry[1]), (middle_x, leave[1])]


def _placed_at(origin: Flat, climb: Flat) -> Callable[[Footprint], Footprint]:
    """Return what moves a footprint that climbs along +x from the origin to another origin and direction."""

    def turn(direction: Flat) -> Flat:
        x, y = direction
        # Adding zero turns -0.0 into 0.0.
        return climb[0] * x - climb[1] * y + 0.0, climb[1] * x + climb[0] * y + 0.0

    def place(point: Flat) -> Flat:
        x, y = turn(point)
        return origin[0] + x, origin[1] + y

    return lambda plan: plan.mapped(place, turn)


def _mirror(point: Flat) -> Flat:
    return point[0], -point[1] + 0.0


def _is_straight(before: Flat, corner: Flat, after: Flat) -> bool:
    cross = (corner[0] - before[0]) * (after[1] - corner[1]) - (corner[1] - before[1]) * (after[0] - corner[0])
    return abs(cross) < 1e-12
