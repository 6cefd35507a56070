"""What are the values of a flight? Its shape, pitch, width, and the statistics of its steps."""

import itertools
import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import own
from stair_inspector.geometry.plan import turn_deg
from stair_inspector.model import Arc, Chain, Flight, Measured, Statistics, Step, StepShape
from stair_inspector.stages.climbs import find_climbs, straight_climb
from stair_inspector.stages.doubt import expanded
from stair_inspector.stages.parts import Common
from stair_inspector.stages.rejects import Forced

_OWN = ("noise", "resolution", "layers")
"""Parts that every nosing has for itself."""


def kinds_of(
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


def flight_of(
    flight_id: int, chain: Chain, shapes: tuple[StepShape, ...], steps: Sequence[Step], context: Common
) -> Flight:
    """Return the values of one flight from those of its steps."""
    climb = find_climbs(chain, shapes)[0]
    return Flight(
        flight_id=flight_id,
        step_ids=tuple(step.step_id for step in steps),
        n_risers=sum(chain.n_missing) + len(steps) - (1 if chain.base is None else 0),
        shape=_shape_name(chain, shapes),
        climb=own(context.scan_from_level[:, :2] @ climb, (3,), "climb"),
        pitch_deg=_best_pitch(chain, shapes, steps, context),
        width_m=mean_width_of(steps),
        rise=statistics_of([(step.step_id, step.rise_m) for step in steps]),
        going=statistics_of([(step.step_id, step.going_m) for step in steps if step.kind == "tread"]),
        radius_m=_radius_of(shapes[0].arc, context),
    )


def mean_width_of(steps: Sequence[Step]) -> Measured | None:
    """Return the mean width of a flight's treads, or of its landing where that is all; None where none has one."""
    treads = [step for step in steps if step.kind == "tread"] or list(steps)
    return _mean_of([step.width_m for step in treads if step.width_m is not None])


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
