"""Where every step lies: takes a Stair, gives the true measures of its steps.

Steps are first laid out as seen from above, as footprints, always turning left; a stair that turns right is the mirror
image. The stair frame: z up, the stair climbs along +x at its foot, the foot of the first riser is x = 0, the floor
z = 0, the middle of the width y = 0; so left, as seen when climbing, is +y at the foot.
"""

import dataclasses
import itertools
import math
from dataclasses import dataclass
from typing import Literal

from stair_inspector.geometry.arrays import Point
from stair_inspector.simulation.footprints import (
    PARALLEL,
    Flat,
    Footprint,
    along,
    curve_rad,
    footprints_of,
    shifted,
    square_to,
)
from stair_inspector.simulation.spec_texts import parse_errors, parse_steps
from stair_inspector.simulation.specs import N_WINDERS, Shape, Stair

Three = tuple[float, float, float]
SHARES_FROM_LEFT = (0.15, 0.5, 0.85)
"""Where rise and going are measured, as shares of the width counted from the left."""


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
    worn_m: float
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

    def nosing_top(self, x: float, y: float) -> float:
        """Return the height of the strip at the nosing, which may be worn, at x and y."""
        return self.top(x, y) - self.worn_m

    def top(self, x: float, y: float) -> float:
        """Return the height of the plane through the nosing, without dish, strip or wear, at x and y."""
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
    plans = footprints_of(stair)
    rise_errors = parse_errors("stair.rise_errors_m", stair.rise_errors_m, last, math.inf)
    going_errors = parse_errors("stair.going_errors_m", stair.going_errors_m, last, math.inf)
    falls = parse_errors("stair.fall_errors_deg", stair.fall_errors_deg, last, math.inf)
    cross_falls = parse_errors("stair.cross_fall_errors_deg", stair.cross_fall_errors_deg, last, math.inf)
    dishes = parse_errors("stair.dish_errors_m", stair.dish_errors_m, last, math.inf)
    worn = parse_errors("stair.wear_errors_m", stair.wear_errors_m, last, math.inf)
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
            worn_m=worn.get(k, 0.0),
            nosing=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            plan=plan,
            rise_lcr_m=(rise, rise, rise),
            going_lcr_m=None,
            pitch_deg=None,
            shape=shape,
            is_missing=k in missing,
        )
        left, right = ((x, y, step.nosing_top(x, y)) for x, y in plan.front)
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
                rise_m=step.rise_m - step.worn_m + (before.worn_m if before else 0.0) if is_plain else middle,
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
    height = step.nosing_top(x, y)
    if before is None:
        return height
    if _is_turning_landing(stair, before.step_id):
        return height - before.top(*along(step.plan.riser, share))
    if stair.shape == "curved":
        return height - before.nosing_top(*along(before.plan.front, share))
    back_x, back_y = step.climb
    below = _meeting((x, y), (-back_x, -back_y), before.plan.front)
    return height - before.nosing_top(*shifted((x, y), (-back_x, -back_y), below))


def _going_on(stair: Stair, plan: Footprint, after: Footprint, share: float) -> float:
    """Return the distance to the next nosing from a share of this one's length: square to it, or along the arc."""
    if stair.shape == "curved":
        x, y = along(plan.front, share)
        side = -1.0 if stair.turn == "right" else 1.0
        return math.hypot(x, y - side * stair.curve_radius_m) * curve_rad(stair)
    return _meeting(along(plan.front, share), square_to(plan.front), after.front)


def _meeting(start: Flat, direction: Flat, edge: tuple[Flat, Flat]) -> float:
    """Return how far along a direction the line through an edge is met; infinite where it hardly ever is."""
    normal = square_to(edge)
    closing = direction[0] * normal[0] + direction[1] * normal[1]
    apart = (edge[0][0] - start[0]) * normal[0] + (edge[0][1] - start[1]) * normal[1]
    return apart / closing if abs(closing) > PARALLEL else math.inf


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
