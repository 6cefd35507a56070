"""Inspections of staircases whose every value is known, made by hand: nothing here is measured."""

import dataclasses
import itertools

import numpy as np

from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Flight, Measured, Statistics, Step
from tests.viewer.surveyed import surveyed

UP = np.array([0.0, 0.0, 1.0])
PARTS = (("noise", 0.0003), ("edge", 0.0002), ("up", 0.0001))
U = 0.0004
LANDING_M = 1.2
OVERHANG_M = 0.02
WIDTH_M = 1.0
TURNS = {"straight": (0.0,), "left": (0.0, 90.0), "right": (0.0, -90.0), "back": (0.0, 180.0), "none": (0.0, 0.0)}


def turned(vector, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1], 0.0])


def staircase(counts=(5,), turns=(0.0,), *, name="scan.ply", seed=1, missing_rise=(), missing_going=(), rotation=None):
    """A staircase of flights with so many steps each, whose last is a landing; ``turns`` are the flights' directions.

    Rises are about 170 mm and goings about 280 mm, no two alike. Steps in ``missing_rise`` and ``missing_going`` have
    none. ``rotation`` (3, 3) turns all of it in space.
    """
    rng = np.random.default_rng(seed)
    _, base, _ = surveyed()
    turn = np.eye(3) if rotation is None else rotation
    place, height, steps, flights = np.zeros(3), 0.0, [], []
    for flight_id, (count, degrees) in enumerate(zip(counts, turns, strict=True), 1):
        climb = turned([1.0, 0.0], degrees)
        left = np.cross(UP, climb)
        first = len(steps) + 1
        for k in range(count):
            is_landing = k == count - 1
            rise, going, width = 0.17 + rng.uniform(-0.003, 0.003), 0.28 + rng.uniform(-0.003, 0.003), WIDTH_M
            width += rng.uniform(-0.004, 0.004)
            height += rise
            middle = place + height * UP
            depth = LANDING_M if is_landing else going + OVERHANG_M
            corners = [middle + 0.5 * width * left, middle - 0.5 * width * left]
            corners += [corners[1] + depth * climb, corners[0] + depth * climb]
            step_id = len(steps) + 1
            steps.append(
                Step(
                    step_id=step_id,
                    plane=PlaneFit(turn @ np.mean(corners, axis=0), turn @ UP, 0.0005, 900),
                    corners=np.array(corners) @ turn.T,
                    nearest_ids=np.zeros(0, dtype=np.int64),
                    paper=base.steps[0].paper,
                    kind="landing" if is_landing else "tread",
                    flight=flight_id,
                    rise_m=None if step_id in missing_rise else Measured(rise, U, PARTS),
                    going_m=None if is_landing or step_id in missing_going else Measured(going, U, PARTS),
                    tread_depth_m=Measured(depth, U, PARTS),
                    width_m=Measured(width, 0.002, PARTS),
                    pitch_deg=None if is_landing else Measured(31.0, 0.1),
                    fall_deg=Measured(0.5, 0.1),
                    cross_fall_deg=Measured(0.0, 0.1),
                    coverage=0.9,
                    nosing=np.array(corners[:2]) @ turn.T,
                    line_points=np.array([middle + s * width * left for s in (0.35, 0.0, -0.35)]) @ turn.T,
                    climb=turn @ climb,
                )
            )
            place = place + (0.0 if is_landing else going) * climb
        flights.append(_flight(flight_id, steps[first - 1 :], turn @ climb))
        if flight_id < len(turns):
            place = place + _round_the_landing(climb, turned([1.0, 0.0], turns[flight_id]))
    return dataclasses.replace(
        base,
        scan=dataclasses.replace(base.scan, name=name, origin_m=(0.0, 0.0, 0.0)),
        up=dataclasses.replace(base.up, vector=turn @ UP),
        steps=tuple(steps),
        flights=tuple(flights),
        patches=(),
        patch_ids=None,
        notes=(),
    )


def _round_the_landing(climb, after):
    """From the middle of a landing's nosing to that of the next flight's first nosing."""
    if climb @ after > 0.5:
        return LANDING_M * climb
    if climb @ after < -0.5:
        return (WIDTH_M + 0.1) * np.cross(UP, climb)
    return LANDING_M / 2.0 * climb + WIDTH_M / 2.0 * after


def _flight(flight_id, steps, climb):
    return Flight(
        flight_id=flight_id,
        step_ids=tuple(step.step_id for step in steps),
        n_risers=len(steps),
        shape="straight",
        climb=climb,
        pitch_deg=Measured(31.2, 0.1),
        width_m=Measured(WIDTH_M, 0.001),
        rise=_statistics([(step.step_id, step.rise_m) for step in steps]),
        going=_statistics([(step.step_id, step.going_m) for step in steps]),
    )


def _statistics(values):
    known = [(step_id, value.value) for step_id, value in values if value is not None]
    if not known:
        return None
    numbers = [value for _, value in known]
    pairs = [(abs(b - a), (i, j)) for (i, a), (j, b) in itertools.pairwise(known) if j == i + 1]
    widest = max(pairs, default=(None, None))
    return Statistics(
        len(numbers), float(np.mean(numbers)), min(numbers), max(numbers), max(numbers) - min(numbers), *widest
    )
