"""Why a surface is no step, one case for each sentence, and what the inspector's decisions mean in a scan."""

import dataclasses

import numpy as np
import pytest

from stair_inspector import priors
from stair_inspector.errors import ConfigError
from stair_inspector.model import Chains, Horizontal, Up
from stair_inspector.overrules import OverrulesParams
from stair_inspector.params import FlightsParams, PatchesParams
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.rejects import (
    Forced,
    apply_overrules,
    explain_rejects,
    lean_deg,
    may_be_step,
)
from tests.stages.rectangles import GOING, RISE, WIDTH, flight, floor, patches_of, rectangle
from tests.synthetic import make_scan, rotation

LEAST_AREA_M2 = PatchesParams.min_area_m2
NO_FORCE = Forced({})
LIMITS = FlightsParams()
STAIR = [floor(), *flight(5)]
"""The floor (0) and the steps (1 to 5), 0.85 m high."""
BESIDE = (2.0, 2.5)
"""A range of y well beside the stair, which reaches from 0 to 1."""


def reasons_of(surfaces, forced=NO_FORCE, limits=LIMITS):
    """The reasons for whatever the chaining itself leaves over."""
    patches = patches_of(surfaces)
    chains = find_chains(patches, limits, LEAST_AREA_M2, forced)
    bases = {chain.base for chain in chains.chains if chain.base is not None}
    taken = frozenset(bases.union(*(chain.steps for chain in chains.chains)))
    reasons = explain_rejects(patches, chains, forced, taken, LEAST_AREA_M2, limits)
    assert set(reasons) == set(range(len(surfaces))) - taken, "what is taken has no reason, all else has one"
    return reasons


def reason(surface, stair=STAIR, limits=LIMITS):
    """Why a surface that was added to the staircase is no step, the staircase itself being one."""
    reasons = reasons_of([*stair, surface], limits=limits)
    assert list(reasons) == [len(stair)]
    return reasons[len(stair)]


# reasons


def test_the_steps_and_the_floor_of_a_staircase_have_no_reason():
    assert reasons_of(STAIR) == {}


def test_a_surface_the_inspector_rejected_says_so_before_anything_else():
    reasons = reasons_of([*STAIR, floor((3.0, 3.1), BESIDE)], Forced({3: "rejected", 6: "rejected"}))
    assert reasons == {3: "rejected by the inspector", 6: "rejected by the inspector"}


@pytest.mark.parametrize(("depth", "is_small"), [(0.06, False), (0.04, True)])
def test_a_small_surface_is_less_than_a_tread(depth, is_small):
    # Half a metre long: 0.03 and 0.02 square metres.
    found = reason(rectangle((0.5, 0.5 + depth), (2.0, 2.5), 0.3))
    assert (found == "only 0.020 m² large, less than any tread (patches.min_area_m2 is 0.03)") == is_small


@pytest.mark.parametrize(("degrees", "leans"), [(11.0, False), (13.0, True)])
def test_a_leaning_surface_is_a_ramp(degrees, leans):
    slope = np.tan(np.radians(degrees)) * np.array([0.6, 0.8])
    found = reason(rectangle((0.0, 1.0), (2.0, 3.0), 0.4, slope=slope))
    assert (found == "leans by 13°: a ramp or a slanting object, not a tread") == leans


@pytest.mark.parametrize(("wide", "is_narrow"), [(0.12, False), (0.08, True)])
def test_a_narrow_surface_is_a_rail(wide, is_narrow):
    found = reason(rectangle((0.0, 1.5), (2.0, 2.0 + wide), 0.9))
    # Its outermost cells' middles lie a cell nearer together than its sides.
    assert (found == "only 60 mm wide: a railing, a ledge or a beam") == is_narrow


def test_without_any_step_nothing_follows():
    surfaces = [floor(), rectangle((1.0, 2.0), (0.0, 1.0), 0.74)]
    no_flight = "no second and third surface a riser apart follow it in plan, as the steps of a flight would"
    assert reasons_of(surfaces) == {0: no_flight, 1: no_flight}


def test_what_lies_under_a_step_is_a_slab_or_stands_below():
    found = reason(rectangle((3 * GOING, 5 * GOING), (0.0, WIDTH), 3 * RISE - 0.02))
    # It lies under steps 4 and 5; the nearest counts.
    assert found == "lies 190 mm under a step: the underside of a slab, or what stands below the stairs"


def test_a_surface_far_above_the_stairs_is_a_ceiling():
    over = rectangle((0.0, 5 * GOING), (0.0, WIDTH), 3.0)
    assert reason(over) == "2.15 m above the steps: a ceiling or the storey above"
    # Over the floor alone, it is the height above the floor that was measured.
    assert reason(rectangle((-0.8, 0.0), (0.0, WIDTH), 3.0)) == "3.00 m above the floor: a ceiling or the storey above"
    beside = rectangle((0.0, 2.0), BESIDE, 3.0)
    assert reason(beside) == "2.15 m above the steps: a ceiling or the storey above"


def test_a_surface_a_riser_above_the_last_step_is_no_ceiling_however_high_above_the_floor():
    stair = [floor((-0.8, 6.0), (-2.0, 2.0)), *flight(11)]
    # It touches the last step with a corner only.
    found = reason(rectangle((11 * GOING, 11 * GOING + 1.5), (1.04, 1.9), 12 * RISE), stair)
    assert found == (
        "lies 170 mm above the last step of a flight and beside it, but no edge was seen along which the flight goes "
        "on: a landing seen in part, or furniture"
    )


def test_what_a_riser_is_follows_the_limits_of_the_flights():
    stair = [floor((-0.8, 6.0), (-2.0, 2.0)), *flight(11)]
    above = rectangle((11 * GOING, 11 * GOING + 1.5), (1.04, 1.9), 11 * RISE + 0.4)
    assert reason(above, stair) == "2.27 m above the floor: a ceiling or the storey above"
    assert reason(above, stair, FlightsParams(max_rise_m=0.5)).startswith("lies 400 mm above the last step of a flight")


def test_a_floor_apart_at_the_height_of_the_first_is_floor_elsewhere():
    found = reason(rectangle((3.0, 5.0), (2.0, 4.0), 0.02))
    assert (
        found
        == "at the height of the floor at which the stairs begin, but apart from it: floor elsewhere, as next door"
    )


@pytest.mark.parametrize(("y", "height"), [((0.0, WIDTH), 0.74), ((0.2, 0.8), 0.45)])
def test_a_surface_that_stands_above_the_floor_is_furniture(y, height):
    found = reason(rectangle((-0.7, -0.2), y, height))
    assert found == f"stands {height:.2f} m above a step or the floor: a table, a seat or other furniture"


def test_of_what_furniture_stands_on_the_highest_counts():
    # Over the floor and over the first step.
    found = reason(rectangle((-0.3, GOING), (0.0, WIDTH), 0.74))
    assert found == "stands 0.57 m above a step or the floor: a table, a seat or other furniture"


def test_a_surface_at_the_height_of_a_step_elsewhere_is_furniture_or_another_room():
    found = reason(rectangle((3.0, 4.0), (2.0, 3.0), 3 * RISE + 0.03))
    assert found == "at the height of a step but apart from it: furniture or another room"


def test_what_fits_no_other_reason_has_no_step_beside_it():
    found = reason(rectangle((3.0, 4.0), (2.0, 3.0), 3 * RISE + 0.08))
    assert found == "no step of the stairs is a riser above or below it and beside it in plan"


def test_reasons_do_not_depend_on_the_order_of_the_surfaces():
    extra = [
        rectangle((-0.7, -0.2), (0.0, WIDTH), 0.74),
        rectangle((3.0, 4.0), (2.0, 3.0), 3 * RISE + 0.08),
        rectangle((3.0, 5.0), (4.0, 6.0), 0.02),
        rectangle((0.0, 5 * GOING), (0.0, WIDTH), 3.0),
    ]
    surfaces = [*STAIR, *extra]
    order = [6, 0, 1, 7, 2, 3, 9, 4, 8, 5]
    shuffled = reasons_of([surfaces[k] for k in order])
    assert {order[k]: text for k, text in shuffled.items()} == reasons_of(surfaces)


def test_no_surfaces_have_no_reasons():
    assert explain_rejects(patches_of([]), Chains(()), NO_FORCE, frozenset(), LEAST_AREA_M2, LIMITS) == {}


@pytest.mark.parametrize(("depth", "degrees", "may"), [(0.1, 11.9, True), (0.1, 12.1, False), (0.02, 0.0, False)])
def test_a_step_is_large_and_level_enough(depth, degrees, may):
    surface = rectangle((0.0, depth), (0.0, 0.4), 0.0, slope=(0.0, np.tan(np.radians(degrees))))
    assert lean_deg(surface) == pytest.approx(degrees)
    assert priors.STEEPEST_TREAD_DEG == 12.0
    assert may_be_step(surface, LEAST_AREA_M2) == may


# overrules

ORIGIN = (691_000.0, 5_335_000.0, 520.0)
TURN = rotation("z", 30.0) @ rotation("x", 90.0)
"""Level from scan: the scan's y axis points up."""


def overrule(force="", climb="auto", surfaces=STAIR):
    """What the settings mean for a staircase in a scan far from zero whose y axis points up."""
    horizontal = Horizontal(
        point_ids=np.zeros(0, dtype=np.int64),
        coordinates_m=np.zeros((3, 0)),
        level_from_scan=TURN,
        up=Up(TURN[2], "given"),
        n_scan=0,
    )
    scan = make_scan(np.zeros((0, 3)), origin_m=ORIGIN)
    return apply_overrules(scan, horizontal, patches_of(surfaces), OverrulesParams(force=force, climb=climb))


def place(level_m):
    """A place of the level frame in the scan's own coordinates, as the setting takes it."""
    return ",".join(repr(float(number)) for number in TURN.T @ np.array(level_m) + ORIGIN)


def test_nothing_is_decided_by_default():
    forced = overrule()
    assert (forced.kinds, forced.climb) == ({}, None)
    assert forced.those("rejected") == frozenset()


def test_a_level_means_all_of_its_surfaces():
    # The tread k and a table of its height are of the level k.
    forced = overrule("level:3=rejected", surfaces=[*STAIR, rectangle((3.0, 4.0), BESIDE, 3 * RISE, level_id=3)])
    assert forced.kinds == {3: "rejected", 6: "rejected"}
    assert forced.those("rejected") == {3, 6}
    assert forced.those("tread") == frozenset()


def test_a_patch_is_taken_by_its_number():
    assert overrule("patch:2=landing").kinds == {2: "landing"}


@pytest.mark.parametrize(
    ("where", "expected"),
    [
        pytest.param((2.5 * GOING, 0.5, 3 * RISE), 3, id="on a tread"),
        pytest.param((2.5 * GOING, 0.5, 3 * RISE + 0.05), 3, id="above it"),
        pytest.param((2.2 * GOING, 0.5, 3 * RISE - 0.14), 2, id="nearer to the one below and beside"),
        pytest.param((-0.4, 0.5, 0.01), 0, id="on the floor"),
    ],
)
def test_a_place_in_the_scan_frame_means_the_surface_nearest_to_it(where, expected):
    assert overrule(f"at:{place(where)}=tread").kinds == {expected: "tread"}


def test_a_place_far_from_every_surface_is_refused():
    with pytest.raises(ConfigError, match=r"^overrules.force: no surface lies within 0.5 m of .*; check the point$"):
        overrule(f"at:{place((50.0, 0.0, 0.9))}=tread")


def test_decisions_add_up_and_a_later_one_replaces_an_earlier_one():
    forced = overrule(f"level:2=rejected; patch:4=landing; at:{place((1.5 * GOING, 0.5, 2 * RISE))}=tread")
    assert forced.kinds == {2: "tread", 4: "landing"}
    assert overrule("patch:4=landing; level:4=rejected").kinds == {4: "rejected"}


@pytest.mark.parametrize(("force", "what"), [("patch:6=tread", "patch 6"), ("level:6=tread", "level 6")])
def test_an_unknown_number_is_refused_with_a_better_way(force, what):
    with pytest.raises(ConfigError) as error:
        overrule(force)
    assert str(error.value) == (
        f"overrules.force: there is no {what} with these settings; numbers change with them, so give the place "
        "instead, as at:x,y,z=kind"
    )


@pytest.mark.parametrize("force", ["patch:-1=tread", "level:-1=tread"])
def test_a_negative_number_is_unknown(force):
    with pytest.raises(ConfigError, match=r"overrules\.force: there is no (patch|level) -1 "):
        overrule(force)


def test_there_is_nothing_to_decide_where_there_is_no_surface():
    with pytest.raises(ConfigError) as error:
        overrule("at:0,0,0=tread", surfaces=[])
    assert str(error.value) == ("overrules.force: there is no surface to decide about; check theta_th, eps_z and m")


@pytest.mark.parametrize("lift", [0.0, 0.5, -2.0])
def test_a_given_climb_counts_in_plan(lift):
    # In plan 30 degrees from the level frame's x axis: the scan's x axis; its y axis is up.
    climb = overrule(climb=f"1,{lift},0").climb
    np.testing.assert_allclose(climb, [np.cos(np.radians(30.0)), np.sin(np.radians(30.0))], atol=1e-12)
    assert not climb.flags.writeable


@pytest.mark.parametrize("climb", ["y", "-y", "0.1,1,0.1"])
def test_an_upright_climb_is_refused(climb):
    with pytest.raises(ConfigError) as error:
        overrule(climb=climb)
    assert str(error.value) == f"overrules.climb: {climb} points up or down; give a direction in plan"


def test_what_is_decided_does_not_change_the_surfaces():
    surfaces = [dataclasses.replace(surface) for surface in STAIR]
    before = [surface.cells_m.copy() for surface in surfaces]
    overrule("level:1=rejected; patch:2=landing", climb="x", surfaces=surfaces)
    for surface, cells in zip(surfaces, before, strict=True):
        np.testing.assert_array_equal(surface.cells_m, cells)
