"""What does each step look like from above? Footprints of straight, turning, winding, spiral and curved stairs."""

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from stair_inspector.simulation.spec_texts import parse_errors
from stair_inspector.simulation.specs import N_WINDERS, Stair

Flat = tuple[float, float]
POST_RADIUS_M = 0.05
"""Radius of the post about which winder treads turn."""
_ARC_DEG = 6.0  # Longest facet of a spiral's outer edge.
_CURVE_DEG = 0.75  # The same of a curved stair's sides: 0.1 mm from the arc at a radius of 5 m.
_SAME_M = 1e-9  # Corners this near to each other are one.
PARALLEL = 0.05  # Sine of the angle below which a line is not followed to the next edge: it would meet it far away.


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


def footprints_of(stair: Stair) -> tuple[Footprint, ...]:
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
        to_far = (far_x - base[0]) / out[0] if out[0] > PARALLEL else math.inf
        to_near = (-half - base[1]) / out[1] if out[1] < -PARALLEL else math.inf
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
    ahead = stair.going_m - stair.overhang_m
    # The turn for which the line square to a nosing, from its middle, meets the next nosing at just the going.
    step_rad = math.atan2(ahead, middle) + math.asin(stair.overhang_m / math.hypot(middle, ahead))
    return _about(stair, stair.width_m / 2.0 + inner, (inner, outer), step_rad, _ARC_DEG)


def _curved(stair: Stair) -> list[Footprint]:
    """Return treads that turn left about a far centre; the upper landing leaves straight ahead."""
    radii = stair.curve_radius_m - stair.width_m / 2.0, stair.curve_radius_m + stair.width_m / 2.0
    return _about(stair, stair.curve_radius_m, radii, curve_rad(stair), _CURVE_DEG)


def _about(stair: Stair, centre_y: float, radii: Flat, step_rad: float, facet_deg: float) -> list[Footprint]:
    """Return treads between two radii that turn left about a centre beside the foot of the stair."""

    def at(radius: float, angle: float) -> Flat:
        return radius * math.sin(angle), centre_y - radius * math.cos(angle)

    n_facets = max(1, math.ceil(math.degrees(step_rad) / facet_deg))
    plans: list[Footprint] = []
    for index in range(stair.n_risers):
        start = index * step_rad
        climb = (math.cos(start), math.sin(start))
        riser = (at(radii[0], start), at(radii[1], start))
        front = (shifted(riser[0], climb, -stair.overhang_m), shifted(riser[1], climb, -stair.overhang_m))
        left, right = (
            tuple(at(radius, start + step_rad * (facet + 1) / n_facets) for facet in range(n_facets))
            for radius in radii
        )
        if stair.shape == "spiral":
            # The column is round, but what it hides of a tread is one piece.
            left = (at(radii[0], (index + 1) * step_rad),)
        if index + 1 == stair.n_risers:
            far = stair.upper_landing_m
            left, right = (shifted(front[0], climb, far),), (shifted(front[1], climb, far),)
        plans.append(Footprint(climb, front, riser, left, right))
    return plans


def curve_rad(stair: Stair) -> float:
    """Return the turn from step to step for which the arc through the middles of the nosings is a going long."""
    return stair.going_m / math.hypot(stair.curve_radius_m, stair.overhang_m)


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
