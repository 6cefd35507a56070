"""Up and unit are decided by the stair that comes out, or asked for: over pitches, axes, units and kinds of stairs.

A file says neither. What is read of it is right, or a question is asked, or no staircase is found; nothing is measured
lying on its side, upside down or in another size.
"""

import dataclasses
import functools
import itertools
from dataclasses import dataclass, replace

import numpy as np
import pytest

from stair_inspector.overrules import NAMED_UP
from stair_inspector.params import KNOWN_UNITS, FloorParams, NormalsParams, Params
from stair_inspector.pipeline import inspect
from stair_inspector.simulation.scanner import scan as scan_building
from stair_inspector.simulation.scanner_specs import PROFILES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build
from stair_inspector.stages.orient import find_normals, find_up
from stair_inspector.stages.units import decide_unit
from stair_inspector.units import METRES_PER_UNIT
from tests.camera_views import View, turn_between
from tests.synthetic import make_scan, rotation

RIGHT_DEG = 5.0
NORMALS = NormalsParams(k=15)
TLS = replace(PROFILES["tls_good"], spacing_m=0.02, standoff_m=1.8, seed=3)
FOOT = replace(TLS, stations=1, sensor_height_m=1.5)
STAIR = Stair(n_risers=7, rise_m=0.172, going_m=0.288, width_m=1.1, overhang_m=0.02, floor_front_m=2.2)
SCANNED = {
    "straight": (STAIR, TLS),
    "between walls": (replace(STAIR, wall="both"), TLS),
    "with a landing": (replace(STAIR, n_risers=9, landing_after=4), TLS),
    "open risers": (replace(STAIR, open_risers=True), TLS),
    "from the foot": (replace(STAIR, n_risers=11), FOOT),
    "steep": (replace(STAIR, rise_m=0.2, going_m=0.23, n_risers=9, wall="left"), TLS),
    "flat": (replace(STAIR, rise_m=0.14, going_m=0.34), TLS),
}
VIEWED = {"camera before it": View(), "camera above it": View(from_above=True)}
KINDS = (*SCANNED, *VIEWED)
PITCHES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0)
AXES = tuple(NAMED_UP)
FEWEST_RIGHT = {"open risers": 0.45, "camera above it": 0.25}
"""Without risers there is no rhythm to tell the unit by; a camera above sees treads only where it looks down."""


@dataclass(frozen=True)
class Variant:
    """A kind of stair as a file may hold it: the sensor's pitch, the axis that is up when it is level, the unit."""

    kind: str
    pitch_deg: float
    axis: str
    unit: str

    def points_and_up(self):
        """Coordinates (n, 3) in the file's unit, and true up in its frame."""
        if self.kind in VIEWED:
            view = replace(VIEWED[self.kind], pitch_deg=self.pitch_deg, turned_to=self.axis)
            points, up = view.points_and_up()
        else:
            lean = rotation("x", self.pitch_deg) @ rotation("z", 20.0)
            turn = turn_between(np.array([0.0, 0.0, 1.0]), np.array(NAMED_UP[self.axis])) @ lean
            points, up = _scanned(self.kind) @ turn.T, turn[:, 2]
        return points / METRES_PER_UNIT[self.unit], up

    def verdict(self):
        """right, asked, wrong, or nothing: up or unit is wrong, and no flight is measured with it."""
        points, true_up = self.points_and_up()
        decided = decide_unit(points)
        scan = make_scan(points * METRES_PER_UNIT[decided.unit])
        scan = dataclasses.replace(scan, unit=decided.unit, notes=(decided.note,), observations=decided.observations)
        up = find_up(scan, find_normals(scan, NORMALS), "auto", FloorParams(), "survey")
        if any(found.level == "question" for found in (*decided.observations, *up.observations)):
            return "asked"
        if decided.unit == self.unit and up.vector @ true_up > np.cos(np.radians(RIGHT_DEG)):
            return "right"
        inspection = inspect(scan, Params(normals=NORMALS))
        if inspection.questions:
            return "asked"
        return "wrong" if inspection.flights else "nothing"


@functools.cache
def _scanned(kind):
    stair, scanner = SCANNED[kind]
    return scan_building(build(stair), scanner).points


def variants(one_in=1):
    """Every kind at every pitch along every axis; units take turns, so that each meets each.

    With two for ``one_in`` every axis has every other pitch; it still meets every unit, and all its neighbours have the
    pitches between.
    """
    products = itertools.product(enumerate(KINDS), enumerate(PITCHES_DEG), enumerate(AXES))
    for (k, kind), (p, pitch_deg), (a, axis) in products:
        if (k + p + a) % one_in == 0:
            yield Variant(kind, pitch_deg, axis, KNOWN_UNITS[(k + p + a) % len(KNOWN_UNITS)])


@pytest.mark.parametrize(
    "variant",
    [
        pytest.param(Variant("between walls", 0.0, "-y", "ft"), marks=pytest.mark.slow, id="between walls, ft"),
        Variant("camera before it", 10.0, "-y", "in"),
        Variant("straight", 30.0, "z", "mm"),
    ],
    ids=lambda variant: f"{variant.kind}, {variant.unit}",
)
def test_up_and_unit_are_those_of_the_stair(variant):
    assert variant.verdict() == "right"


def test_there_are_variants_of_every_axis_pitch_and_unit():
    for one_in in (1, 2):
        found = list(variants(one_in))
        assert len(set(found)) == len(found) >= 200 / one_in
        assert {(variant.axis, variant.unit) for variant in found} == set(itertools.product(AXES, KNOWN_UNITS))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_of_pitches_axes_and_units_none_is_wrong_without_a_question(kind):
    # Half of them where nearly all are right: what goes wrong there does so at many pitches.
    tried = variants(1 if kind in FEWEST_RIGHT else 2)
    found = {variant: variant.verdict() for variant in tried if variant.kind == kind}
    verdicts = list(found.values())
    print(kind, {name: verdicts.count(name) for name in ("right", "asked", "nothing", "wrong")})
    assert [variant for variant, verdict in found.items() if verdict == "wrong"] == []
    assert verdicts.count("right") >= FEWEST_RIGHT.get(kind, 0.9) * len(found)


@pytest.mark.slow
def test_a_very_steep_stair_stays_upright_and_its_limit_is_named_or_obeyed():
    steep = Stair(n_risers=8, rise_m=0.33, going_m=0.28, floor_front_m=2.2)
    scan = make_scan(scan_building(build(steep), TLS).points)
    params = Params(normals=NORMALS)
    found = inspect(scan, params.replaced("flights.max_rise_m", 0.5))
    assert found.questions == ()
    assert found.up.vector[2] > 0.999
    assert [step.rise_m.value for step in found.steps] == pytest.approx([0.33] * 8, abs=0.002)
    limited = inspect(scan, params)
    assert limited.up.vector[2] > 0.999
    assert limited.steps == ()
    (reason,) = [note.message for note in limited.notes if note.code == "no_staircase"]
    assert "flights.max_rise_m" in reason
    assert "--flights.max-rise-m" in reason
