"""Inspections of flights whose every value is stated, and the values at which a rule turns; metres, degrees."""

import math
from dataclasses import replace

import numpy as np

from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import (
    Flight,
    HeightProfile,
    Inspection,
    Measured,
    Note,
    PaperValues,
    ScanSummary,
    Step,
    Up,
)
from stair_inspector.params import Params, UncertaintyParams

USUAL = {
    "rise": 0.165,
    "going": 0.29,
    "tread_depth": 0.31,
    "width": 1.6,
    "nosing_overhang": 0.02,
    "fall": 0.0,
    "cross_fall": 0.0,
}
"""Values that lie inside the limits of nearly every code."""
PITCH_DEG = 29.6


def measured(value, u, part="noise"):
    return Measured(value, u, ((part, u),) if u else ())


def step(step_id, kind="tread", u=0.0, flight=1, **values):
    """A step with the usual values, of which some are given: numbers, ``Measured`` or None."""
    values = {**USUAL, **values}
    made = {
        name: value if value is None or isinstance(value, Measured) else measured(value, u)
        for name, value in values.items()
    }
    if kind == "landing":
        made |= {"going": None, "tread_depth": None, "nosing_overhang": None}
    return Step(
        step_id=step_id,
        plane=PlaneFit(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.001, 100),
        corners=np.zeros((4, 3)),
        nearest_ids=np.zeros(0, dtype=np.int64),
        paper=PaperValues(),
        kind=kind,
        flight=flight,
        rise_m=made["rise"],
        going_m=made["going"],
        tread_depth_m=made["tread_depth"],
        width_m=made["width"],
        nosing_overhang_m=made["nosing_overhang"],
        fall_deg=made["fall"],
        cross_fall_deg=made["cross_fall"],
    )


def flight_of(steps, shape="straight", n_risers=None, pitch=None, flight_id=1):
    return Flight(
        flight_id=flight_id,
        step_ids=tuple(each.step_id for each in steps),
        n_risers=len(steps) if n_risers is None else n_risers,
        shape=shape,
        climb=np.array([1.0, 0.0, 0.0]),
        pitch_deg=measured(PITCH_DEG, 0.1) if pitch is None else pitch,
    )


def inspection_of(steps, flights=None, notes=(), registration_m=0.0):
    """An inspection with these steps, one flight of them all unless flights are given."""
    return Inspection(
        scan=ScanSummary("made.ply", "0" * 64, 0, 0, "m", (0.0, 0.0, 0.0)),
        params=Params(uncertainty=UncertaintyParams(registration_m=registration_m)),
        up=Up(np.array([0.0, 0.0, 1.0]), "given"),
        axes=None,
        levels=(),
        steps=tuple(steps),
        floor=None,
        floor_h_m=None,
        profile=HeightProfile(0.0, 0.01, np.zeros(1, dtype=np.int64)),
        labels=np.zeros(0, dtype=np.int32),
        notes=tuple(Note(code, "survey", message, step_id) for code, message, step_id in notes),
        flights=(flight_of(steps),) if flights is None else tuple(flights),
    )


def even(n=6, u=0.0, **values):
    """The steps of a flight whose values are all alike, its last step a landing."""
    return [step(k, "landing" if k == n else "tread", u, **values) for k in range(1, n + 1)]


def changed(steps, step_id, **values):
    """The steps with some fields of one of them exchanged."""
    return [replace(each, **values) if each.step_id == step_id else each for each in steps]


def holding(rule, value, u):
    """An inspection in which one place of a rule has a value and its uncertainty, SI, and all others are far inside.

    The uncertainty is that of the value the rule is about: of a spread upwards, between steps that are not neighbours.
    """
    if rule.statistic == "flight_range":
        return _spread(rule, value, u / math.sqrt(2.0), (2, 4))
    if rule.statistic == "adjacent_difference":
        # Rises and goings of neighbours share a nosing: at most twice the sum of the squares.
        return _spread(rule, value, u / 2.0, (2, 3))
    if rule.quantity == "n_risers":
        steps = even()
        return inspection_of(steps, [flight_of(steps, n_risers=round(value))])
    if rule.quantity == "pitch":
        steps = even()
        return inspection_of(steps, [flight_of(steps, pitch=measured(value, u))])
    usual = usual_of(rule)
    steps = even(**usual)
    landing = rule.quantity == "landing_slope"
    return inspection_of(changed(steps, 6 if landing else 3, **_fields(rule, value, u)))


def usual_of(rule):
    """Values of the other steps: inside the rule's own limits, and such that the rule applies to them."""
    usual = {}
    if rule.only_where is not None:
        usual[rule.only_where.quantity] = rule.only_where.below.value - 0.02
    name = rule.quantity
    if name in USUAL:
        low, high = (None if limit is None else limit.value for limit in (rule.minimum, rule.maximum))
        if low is not None and high is not None:
            usual[name] = (low + high) / 2.0
        elif rule.statistic == "each":
            # A limit of nothing has no multiple.
            usual[name] = (1.3 * low or 0.02) if high is None else (0.7 * high or -0.02)
    if name == "two_r_plus_g":
        usual |= {"rise": 0.17, "going": (rule.minimum.value + rule.maximum.value) / 2.0 - 0.34}
    return usual


def _fields(rule, value, u):
    if rule.quantity == "two_r_plus_g":
        return {"rise_m": Measured(0.17, 0.0), "going_m": measured(value - 0.34, u)}
    if rule.quantity in ("tread_slope", "landing_slope"):
        u_deg = math.degrees(u / (1.0 + value**2))
        return {"fall_deg": Measured(0.0, 0.0), "cross_fall_deg": measured(-math.degrees(math.atan(value)), u_deg)}
    return {f"{rule.quantity}_m": measured(value, u)}


def _spread(rule, value, u, places):
    """Two steps lie apart by a value, the others in the middle between them."""
    steps = even(u=u, **usual_of(rule))
    middle = getattr(steps[0], f"{rule.quantity}_m").value
    low, high = places
    name = f"{rule.quantity}_m"
    steps = changed(steps, low, **{name: measured(middle - value / 2.0, u)})
    return inspection_of(changed(steps, high, **{name: measured(middle + value / 2.0, u)}))
