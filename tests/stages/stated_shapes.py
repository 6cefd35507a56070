"""Steps whose planes, edges and doubts are stated: what the values of a flight are worked out from; metres."""

import dataclasses
import math

import numpy as np

from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.model import Chain, LocalPlane, StepShape, Up
from stair_inspector.params import UncertaintyParams
from stair_inspector.stages.parts import Common

RISE, GOING, DEPTH, WIDTH = 0.17, 0.28, 0.31, 1.2
NOTHING_STATED = UncertaintyParams(
    registration_m=0.0, edge_m=0.0, side_m=0.0, slope_deg=0.0, scale_percent=0.0, up_deg=0.0
)
NOTHING_KNOWN = Common.of(Up(np.array([0.0, 0.0, 1.0]), "given"), NOTHING_STATED, np.eye(3), None)
"""A scan of which the user states nothing, in a frame that is level, along the axes."""


def common(**values):
    return dataclasses.replace(NOTHING_KNOWN, **values)


def edge(middle_m, noise_m=0.0, slope=0.0, along_m=0.0, slope_noise=0.0):
    return EdgeLine(middle_m, slope, along_m, noise_m, slope_noise, 1.0, "face")


def plane(z0_m, slope=(0.0, 0.0), deviations=(0.0, 0.0, 0.0), **values):
    """A plane without noise of single points; ``deviations`` are those of its height and its two slopes."""
    sampled = {"sigma_m": 0.0, "spacing_m": 0.0, "misfit_m": 0.0, "n_points": 1000, **values}
    return LocalPlane(z0_m, slope, np.diag(np.square(deviations)), **sampled)


def shape(k, **values):
    """The k-th step, from 0, of an even straight flight along x; its nosing is at the origin of its frame."""
    made = {
        "surface": k + 1,
        "origin_m": np.array([k * GOING, 0.0]),
        "climb": np.array([1.0, 0.0]),
        "plane": plane((k + 1) * RISE),
        "extent": (0.01, DEPTH, -WIDTH / 2.0, WIDTH / 2.0),
        "front": edge(0.0),
        "back": edge(DEPTH),
        "left": edge(WIDTH / 2.0),
        "right": edge(-WIDTH / 2.0),
        "foot": plane(0.0) if k == 0 else None,
        "back_limits": None,
        "coverage": 1.0,
        "line_range": (-WIDTH / 2.0, WIDTH / 2.0),
        "nosing_offsets": (0.0, 0.0, 0.0),
        "nosing_noise": (0.0, 0.0, 0.0),
        **values,
    }
    return StepShape(**made)


def chain_of(shapes, base=0, n_missing=None):
    return Chain(
        base=base,
        steps=tuple(each.surface for each in shapes),
        climbs=np.array([each.climb for each in shapes]),
        middles=np.array([each.origin_m for each in shapes]),
        lengths_m=(WIDTH,) * len(shapes),
        n_missing=(0,) * len(shapes) if n_missing is None else n_missing,
    )


def turned(k, turn_rad, place_m, **values):
    """The k-th step of a flight that turns: at a place (2,) of the plan, climbing at this angle from x to y."""
    climb = np.array([math.cos(turn_rad), math.sin(turn_rad)])
    return shape(k, climb=climb, origin_m=np.asarray(place_m, dtype=np.float64), **values)
