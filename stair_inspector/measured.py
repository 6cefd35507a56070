"""Arithmetic with measured values: differences, sums, spreads and what is worked out from them, each with U (k = 2).

Lengths are metres, angles degrees, slopes tangents. The parts of an uncertainty (:mod:`stages.doubt`) are of two kinds:

- ``noise``, ``edge``, ``resolution``, ``layers`` and ``registration`` belong to single surfaces and nosings:
  independent from place to place, so they add as squares; two values that share a nosing share its part;
- ``up`` and ``scale`` are one error of the whole scan: they add with their signs, and cancel in a difference.
"""

import functools
import math
from collections.abc import Sequence
from statistics import NormalDist

from stair_inspector.model import COVERAGE_FACTOR, Flight, Measured, Step

OWN_PARTS = ("noise", "edge", "resolution", "layers", "registration")
"""Parts that are independent from nosing to nosing."""
COMMON_PARTS = ("up", "scale")
"""Parts that are one error of the whole scan."""
_ALL_ROUND = math.sqrt(-2.0 * math.log(0.05)) / 2.0
"""A circle that holds 95 % of a normal error in two directions, in expanded uncertainties (k = 2) of one."""


def usable(measured: Measured | None) -> Measured | None:
    """Return a value that can be judged: finite, with an uncertainty and parts that are finite and not negative.

    None for any other. A number that is none would pass every comparison with a limit on one side.
    """
    if measured is None or not math.isfinite(measured.value):
        return None
    doubts = (measured.u, *(part for _, part in measured.parts))
    return measured if all(math.isfinite(doubt) and doubt >= 0.0 for doubt in doubts) else None


def part_of(measured: Measured, name: str) -> float:
    """Return one part of an uncertainty, expanded (k = 2); 0 for a part without weight."""
    return dict(measured.parts).get(name, 0.0)


def combined(value: float, parts: dict[str, float]) -> Measured:
    """Return a value whose uncertainty is the root of the sum of the squares of expanded parts."""
    named = tuple((name, part) for name, part in parts.items() if part > 0.0)
    return Measured(value, math.sqrt(sum(part * part for _, part in named)), named)


def difference(upper: Measured, lower: Measured, share_a_nosing: bool) -> Measured:
    """Return the size of the difference between two values of one flight.

    What is one error of the whole scan cancels as far as it is the same in both. Rises and goings of neighbours share
    a nosing: if it is wrong by e, one is too long by e and the other too short, so that their difference is wrong by
    2 e. With n the noise of the shared nosing and a, b that of the two values, the difference has the variance
    a**2 + b**2 + 2 n**2. The values do not tell how large n is: at most as large as the smaller of both, which is what
    is taken. Where all nosings are alike that is 15 % more than the true uncertainty.

    Parameters
    ----------
    upper, lower : Measured
        Two rises, two goings, or two values of another quantity.
    share_a_nosing : bool
        Whether they end at one nosing with opposite signs: rises or goings of neighbouring steps.
    """
    parts = {}
    for name in OWN_PARTS:
        a, b = part_of(upper, name), part_of(lower, name)
        shared = min(a * a, b * b) if share_a_nosing else 0.0
        parts[name] = math.sqrt(a * a + b * b + 2.0 * shared)
    for name in COMMON_PARTS:
        parts[name] = abs(part_of(upper, name) - part_of(lower, name))
    # What has no parts, or others, is taken as independent.
    rest = [
        max(0.0, value.u**2 - sum(part_of(value, name) ** 2 for name in (*OWN_PARTS, *COMMON_PARTS)))
        for value in (upper, lower)
    ]
    parts["other"] = math.sqrt(sum(rest)) if sum(rest) > 1e-9 * (upper.u**2 + lower.u**2) else 0.0
    return combined(abs(upper.value - lower.value), parts)


def spread(values: Sequence[Measured], are_chained: bool) -> tuple[Measured, float, tuple[int, int]]:
    """Return the largest less the smallest of several values, its uncertainty upwards and downwards.

    The true spread is the difference of two of the values, of which pair is not known: it is at most the largest of all
    differences with their uncertainties. A value of large uncertainty counts although it lies between the extremes.
    Downwards the choice counts: of many noisy values the largest and the smallest
    are those with the luckiest noise, and an even flight shows a spread. There the part that is independent from
    nosing to nosing is widened from k = 2 for one pair to the 95 % point of the spread of n values.

    Parameters
    ----------
    values : sequence of Measured
        Two or more, from bottom to top.
    are_chained : bool
        Whether neighbours share a nosing (rises, goings).

    Returns
    -------
    measured : Measured
        The spread; ``u`` is how much larger it may be (k = 2). It has no parts: its own and that of others meet in it.
    u_down : float
        How much smaller it may be (95 %).
    positions : tuple of int
        Where in ``values`` the smallest and the largest are; the first and the last where all are alike.

    References
    ----------
    .. [1] J. W. Tukey, The Problem of Multiple Comparisons, 1953 (simultaneous intervals of all differences).
    """
    low = min(range(len(values)), key=lambda k: values[k].value)
    high = max(range(len(values)), key=lambda k: (values[k].value, k))
    found = difference(values[high], values[low], are_chained and abs(high - low) == 1)
    common = sum(part_of(found, name) ** 2 for name in COMMON_PARTS)
    own = max(0.0, found.u**2 - common)
    widened = max(1.0, spread_quantile(len(values)) / (COVERAGE_FACTOR * math.sqrt(2.0)))
    upwards = Measured(found.value, _largest_end(values, are_chained, found) - found.value)
    return upwards, math.sqrt(own * widened**2 + common), (low, high)


def _largest_end(values: Sequence[Measured], are_chained: bool, found: Measured) -> float:
    """Return the largest of all differences of two values, each with its uncertainty added."""
    largest = found.value + found.u
    for j, upper in enumerate(values):
        for i, lower in enumerate(values[:j]):
            # The uncertainty of a difference is at most the sum of both: most pairs need no closer look.
            if abs(upper.value - lower.value) + upper.u + lower.u > largest:
                pair = difference(upper, lower, are_chained and j - i == 1)
                largest = max(largest, pair.value + pair.u)
    return largest


def total(rises: Sequence[Measured]) -> Measured:
    """Return the sum of the rises of a flight: of the nosings only the first and the last count."""
    first, last = rises[0], rises[-1]
    parts = {
        name: math.sqrt((part_of(first, name) ** 2 + part_of(last, name) ** 2) / 2.0)
        for name in OWN_PARTS
        if name != "registration"
    }
    # From surface to surface registration may drift.
    parts["registration"] = math.sqrt(sum(part_of(rise, "registration") ** 2 for rise in rises))
    for name in COMMON_PARTS:
        parts[name] = sum(part_of(rise, name) for rise in rises)
    return combined(math.fsum(rise.value for rise in rises), parts)


@functools.cache
def spread_quantile(n: int) -> float:
    """Return the 95 % point of the spread of ``n`` values from one normal distribution, in its standard deviations."""
    normal = NormalDist()
    # The integral over the place of the smallest value; beyond six standard deviations nothing is left.
    step = 0.02
    places = [-6.0 + step * k for k in range(round(12.0 / step) + 1)]
    densities = [normal.pdf(place) * step for place in places]
    below = [normal.cdf(place) for place in places]

    def probability(width: float) -> float:
        return n * sum(
            density * (normal.cdf(place + width) - under) ** (n - 1)
            for place, density, under in zip(places, densities, below, strict=True)
        )

    low, high = 0.0, 12.0
    while high - low > 1e-4:
        middle = (low + high) / 2.0
        low, high = (middle, high) if probability(middle) < 0.95 else (low, middle)
    return high


def two_r_plus_g_of(step: Step, _: Step | None) -> Measured | None:
    """Return twice the rise to a step and its going."""
    rise, going = usable(step.rise_m), usable(step.going_m)
    if rise is None or going is None:
        return None
    return _weighted(2.0 * rise.value + going.value, (rise, 2.0), (going, 1.0))


def diagonal_of(step: Step, above: Step | None) -> Measured | None:
    """Return the distance from a step's nosing to the next one's; a tilt turns it and leaves its length."""
    going, rise = step.going_m, None if above is None or above.flight != step.flight else above.rise_m
    if going is None or rise is None:
        return None
    length = math.hypot(going.value, rise.value)
    return _weighted(length, (going, going.value / length), (rise, rise.value / length))


def _weighted(value: float, one: tuple[Measured, float], other: tuple[Measured, float]) -> Measured:
    """Return what grows with a rise and a going by these weights."""
    (a, by_a), (b, by_b) = one, other
    parts = {name: math.hypot(by_a * part_of(a, name), by_b * part_of(b, name)) for name in OWN_PARTS}
    # A tilt that makes the rises larger makes the goings smaller.
    parts["up"] = abs(by_a * part_of(a, "up") - by_b * part_of(b, "up"))
    parts["scale"] = by_a * part_of(a, "scale") + by_b * part_of(b, "scale")
    return combined(value, parts)


def steepest_slope_of(step: Step, _: Step | None) -> Measured | None:
    """Return the slope in the steepest direction, a tangent, from the slopes along and across the climb."""
    fall, cross_fall = usable(step.fall_deg), usable(step.cross_fall_deg)
    if fall is None or cross_fall is None:
        return None
    along, across = (math.tan(math.radians(angle.value)) for angle in (fall, cross_fall))
    slope = math.hypot(along, across)
    u_along, u_across = (
        math.radians(angle.u) * (1.0 + tangent * tangent) for angle, tangent in ((fall, along), (cross_fall, across))
    )
    if slope <= max(u_along, u_across):
        # Level within its uncertainty: the steepest direction may be any.
        return Measured(slope, _ALL_ROUND * max(u_along, u_across))
    return Measured(slope, math.hypot(along * u_along, across * u_across) / slope)


def rise_of_flight(flight: Flight, steps: Sequence[Step]) -> Measured | None:
    """Return the sum of a flight's rises; None where one is missing."""
    whole = len(steps) == flight.n_risers
    return _sum_of([step.rise_m for step in steps]) if whole else None


def run_of_flight(_: Flight, steps: Sequence[Step]) -> Measured | None:
    """Return the sum of a flight's goings, from its first nosing to its last; None where one is missing."""
    return _sum_of([step.going_m for step in steps[:-1]])


def _sum_of(values: Sequence[Measured | None]) -> Measured | None:
    known = [value for value in values if value is not None]
    return total(known) if known and len(known) == len(values) else None
