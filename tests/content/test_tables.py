"""The tables: what they compute beyond the inspection is held against numbers worked out by hand."""

import dataclasses
import math
import statistics

import numpy as np
import pytest

from stair_inspector.codes import Limit, check, edited
from stair_inspector.content import cells, cross_checks, grounds, rule_tables, tables, values
from stair_inspector.content.document import Column, Number, Status, plain
from stair_inspector.content.fields import Checklist, ReportBasis
from stair_inspector.content.readings import TapeReading
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.geometry.fits import PlaneFit
from stair_inspector.model import Measured, Patch, Statistics
from stair_inspector.quantities import quantity_of
from tests.codes.flights import changed, even, flight_of, inspection_of, measured, step
from tests.writers.samples import scanned

UP = np.array([0.0, 0.0, 1.0])


def rows_of(table):
    names = [column.name for column in table.columns]
    return [dict(zip(names, row, strict=True)) for row in table.rows]


def standing(steps):
    """Steps with planes and nosings where their rises and goings put them; climbing along x."""
    found, x, z = [], 0.0, 0.0
    for each in steps:
        z += each.rise_m.value
        line = np.array([[x, 0.3, z], [x, 0.0, z], [x, -0.3, z]])
        plane = PlaneFit(np.array([x + 0.15, 0.0, z]), UP, 0.001, 100)
        found.append(dataclasses.replace(each, line_points=line, plane=plane))
        x += 0.0 if each.going_m is None else each.going_m.value
    return found


def floor(height=0.0, normal=UP):
    return Patch(0, 0, height, 1.0, PlaneFit(np.array([-0.5, 0.0, height]), normal, 0.001, 900), "floor")


def closed(steps, *patches):
    return dataclasses.replace(inspection_of(steps), patches=patches)


def test_a_flight_that_closes_says_so():
    (row,) = rows_of(cross_checks.closure_table(closed(standing(even(6, u=0.0004)), floor())))
    assert row["Sum of rises"] == pytest.approx(6 * 165.0)
    assert row["Plane to plane"] == pytest.approx(6 * 165.0)
    assert row["Difference"] == pytest.approx(0.0, abs=1e-6)
    assert row["Result"] == Status("closes within U", "good")


def test_what_both_heights_of_a_closure_share_does_not_excuse_a_difference():
    rises = (("noise", 0.0003), ("edge", 0.0004), ("registration", 0.0012), ("up", 0.01), ("scale", 0.02))
    steps = [dataclasses.replace(each, rise_m=Measured(each.rise_m.value, 0.023, rises)) for each in standing(even(6))]
    (near,) = rows_of(cross_checks.closure_table(closed(steps, floor(0.0017))))
    (far,) = rows_of(cross_checks.closure_table(closed(steps, floor(0.0019))))
    assert (
        near["U of the difference"]
        == far["U of the difference"]
        == pytest.approx(math.sqrt(0.3**2 + 0.4**2 + 2 * 1.2**2))
    )
    assert near["Result"] == Status("closes within U", "good")
    assert far["Result"] == Status("differs by more than U", "close")
    assert "nosings in between cancel" in cross_checks.closure_table(closed(steps, floor())).note


def test_planes_that_say_otherwise_than_the_rises_are_seen():
    (row,) = rows_of(cross_checks.closure_table(closed(standing(even(6, u=0.0004)), floor(0.003))))
    assert row["Difference"] == pytest.approx(3.0)
    assert row["Result"].tone == "close"


@pytest.mark.parametrize(
    ("height_mm", "difference", "u", "words"),
    [
        (0.1315, "0.132", "0.129", "differs by more than U"),
        (0.1285, "0.13", "0.13", "closes within U"),
        (0.4, "0.40", "0.13", "differs by more than U"),
        (-0.12915, "−0.12915", "0.12910", "differs by more than U"),
        (-0.12, "−0.12", "0.13", "closes within U"),
    ],
)
def test_a_closure_shows_the_digits_on_which_its_result_hangs(height_mm, difference, u, words):
    steps = standing(even(6))
    rise = Measured(0.165, 0.0001291, (("noise", 0.0001291 / math.sqrt(2.0)),))
    steps = [dataclasses.replace(each, rise_m=rise) for each in steps]
    u_m = cross_checks.closure_table(closed(steps, floor())).rows[0][5] / 1000.0
    rise = Measured(0.165, rise.u * 0.0001291 / u_m, (("noise", rise.parts[0][1] * 0.0001291 / u_m),))
    steps = [dataclasses.replace(each, rise_m=rise) for each in steps]
    table = cross_checks.closure_table(closed(steps, floor(height_mm / 1000.0)))
    shown = [column.text(cell) for column, cell in zip(table.columns, table.rows[0], strict=True)]
    assert shown[4:6] == [difference, u]
    assert shown[6].endswith(words)


def test_a_floor_that_slopes_is_taken_at_the_foot():
    slope = 0.02
    normal = np.array([-slope, 0.0, 1.0]) / math.hypot(1.0, slope)
    # Its middle, half a metre before the foot, lies 10 mm lower.
    ground = Patch(0, 0, -0.01, 1.0, PlaneFit(np.array([-0.5, 0.0, -0.01]), normal, 0.001, 900), "floor")
    (row,) = rows_of(cross_checks.closure_table(closed(standing(even(3)), ground)))
    assert row["Difference"] == pytest.approx(0.0, abs=1e-6)


def test_a_floor_far_from_the_foot_closes_nothing():
    (row,) = rows_of(cross_checks.closure_table(closed(standing(even(3)), floor(-2.0))))
    assert (row["Plane to plane"], row["Difference"]) == (None, None)
    assert row["Result"].words.startswith("not possible: the surface at its foot")


def test_a_missing_rise_leaves_no_sum():
    steps = changed(standing(even(4)), 3, rise_m=None)
    (row,) = rows_of(cross_checks.closure_table(closed(steps, floor())))
    assert row["Sum of rises"] is None
    assert row["Result"].words == "not possible: a rise was not measured"


@pytest.mark.parametrize("name", ["straight", "defective_step"])
def test_scans_of_known_stairs_close(name):
    (row,) = rows_of(cross_checks.closure_table(scanned(name)[1]))
    # Far less than the uncertainty of the total rise, which an error of the vertical makes large.
    assert 0.1 < row["U of the difference"] < 0.5
    assert row["Result"].words == "closes within U"


def test_registration_adds_to_the_closure_at_the_two_ends_alone():
    for n in (3, 9):
        rise = Measured(0.165, 0.0002, (("registration", 0.0002),))
        (row,) = rows_of(
            cross_checks.closure_table(closed(standing([step(k, rise=rise) for k in range(1, n + 1)]), floor()))
        )
        assert row["U of the difference"] == pytest.approx(0.2 * math.sqrt(2.0), abs=0.006)


@pytest.mark.slow
def test_stations_that_lie_farther_apart_than_was_stated_do_not_close():
    # 2 mm from station to station, of which the settings know nothing.
    for row in rows_of(cross_checks.closure_table(scanned("long_landing")[1])):
        assert 0.5 < row["Difference"] < 1.0
        assert row["Result"].words == "differs by more than U"


def test_the_sum_of_rises_is_known_as_well_as_its_two_ends():
    # One nosing has 1/sqrt(2) of the noise of a rise; the nosings between drop out.
    total = values.flight_value(inspection_of(even(10, u=0.0004)), flight_of(even(10)), "flight_rise")
    assert total.value == pytest.approx(1.65)
    assert total.u == pytest.approx(0.0004)


def test_the_run_goes_from_the_first_nosing_to_the_last():
    steps = even(5)
    run = values.flight_value(inspection_of(steps), flight_of(steps), "flight_run")
    assert run.value == pytest.approx(4 * 0.29)
    lost = changed(steps, 2, going_m=None)
    assert values.flight_value(inspection_of(lost), flight_of(lost), "flight_run") is None


def test_the_diagonal_is_that_of_a_right_triangle_and_a_tilt_does_not_change_it():
    u = 0.001
    low = step(1, rise=0.16, going=Measured(0.4, 0.3 * u, (("up", 0.3 * u),)))
    high = step(2, rise=Measured(0.3, 0.4 * u, (("up", 0.4 * u),)))
    diagonal = quantity_of("diagonal").of(low, high)
    assert diagonal.value == pytest.approx(0.5)
    assert diagonal.u == pytest.approx(0.0, abs=1e-12)
    noisy = quantity_of("diagonal").of(step(1, going=measured(0.4, u)), step(2, rise=measured(0.3, u)))
    assert noisy.u == pytest.approx(u)


def test_the_diagonal_ends_with_its_flight():
    assert quantity_of("diagonal").of(step(1), step(2, flight=2)) is None
    assert quantity_of("diagonal").of(step(1), None) is None


def test_the_standard_deviation_is_that_of_the_values():
    rises = (0.16, 0.17, 0.19)
    steps = [step(k, "landing" if k == 3 else "tread", rise=rise) for k, rise in enumerate(rises, 1)]
    flight = dataclasses.replace(flight_of(steps), rise=Statistics(3, sum(rises) / 3, 0.16, 0.19, 0.03, 0.02, (2, 3)))
    (row,) = rows_of(tables.uniformity_table(inspection_of(steps, [flight])))
    assert row["SD"] == pytest.approx(1000.0 * statistics.stdev(rises))
    assert row["Largest difference of neighbours"] == pytest.approx(20.0)
    assert row["Between steps"] == "2 and 3"


@pytest.mark.parametrize(
    ("reading", "scan", "difference", "tone"),
    [
        (TapeReading("rise", 0.166, step=2, u=0.001), 165.0, 1.0, "good"),
        (TapeReading("rise", 0.168, step=2, u=0.001), 165.0, 3.0, "bad"),
        (TapeReading("rise", 0.165, step=2), 165.0, 0.0, "plain"),
        (TapeReading("rise", 0.168, step=2), 165.0, 3.0, "plain"),
        (TapeReading("fall", -0.3, step=2, u=1.0), 0.0, -0.3, "good"),
        (TapeReading("pitch", 29.6, flight=1, u=0.1), 29.6, 0.0, "good"),
        (TapeReading("flight_rise", 0.826, flight=1, u=0.002), 825.0, 1.0, "good"),
        (TapeReading("rise", 0.168, step=9), None, None, "plain"),
        (TapeReading("width", 1.0, flight=3), None, None, "plain"),
        (TapeReading("rise", 0.168, step=2, line="left"), None, None, "plain"),
    ],
)
def test_readings_by_hand_stand_beside_the_scan_with_their_difference(reading, scan, difference, tone):
    inspection = inspection_of(even(5, u=0.0004))
    (row,) = rows_of(cross_checks.readings_table(inspection, ReportBasis(readings=(reading,))))
    assert (row["Scan"] and row["Scan"].value) == (None if scan is None else pytest.approx(scan))
    assert (row["Difference"] and row["Difference"].value) == (
        None if difference is None else pytest.approx(difference, abs=1e-6)
    )
    assert row["Result"].tone == tone


def test_a_reading_agrees_within_the_root_of_the_squares_of_both_u():
    inspection = inspection_of(even(5, u=0.0004))
    for off_m, tone in ((0.00049, "good"), (0.00051, "bad")):
        basis = ReportBasis(readings=(TapeReading("rise", 0.165 + off_m, step=2, u=0.0003),))
        (row,) = rows_of(cross_checks.readings_table(inspection, basis))
        assert row["Result"].tone == tone


def test_a_reading_on_the_left_line_is_compared_there():
    steps = changed(even(3, u=0.0004), 2, rise_lcr_m=(0.163, 0.165, 0.167))
    reading = TapeReading("rise", 0.1632, step=2, line="left", u=0.0001)
    table = cross_checks.readings_table(inspection_of(steps), ReportBasis(readings=(reading,)))
    (row,) = rows_of(table)
    assert row["Scan"].value == pytest.approx(163.0)
    assert row["Place"] == "step 2, left"
    assert row["Result"].tone == "good"
    # Whose uncertainty stands there is said, and only where there is such a line.
    assert "that of the centre line stands there" in table.note
    centre = TapeReading("rise", 0.165, step=2)
    assert "centre line" not in cross_checks.readings_table(inspection_of(steps), ReportBasis(readings=(centre,))).note


def placed(steps):
    """The steps one behind the other, each 0.28 m further and 0.17 m higher, in a scan whose origin is elsewhere."""
    made = []
    for n, each in enumerate(steps, 1):
        centroid = np.array([0.28 * n, 0.0, 0.17 * n])
        corners = centroid + np.array([[-0.14, 0.5, 0.0], [-0.14, -0.5, 0.0], [0.14, -0.5, 0.0], [0.14, 0.5, 0.0]])
        made.append(
            dataclasses.replace(each, plane=dataclasses.replace(each.plane, centroid=centroid), corners=corners)
        )
    inspection = inspection_of(made)
    return dataclasses.replace(inspection, scan=dataclasses.replace(inspection.scan, origin_m=(1000.0, 0.0, 50.0)))


def reading_at(step_id, of_height=0.0, aside=0.0):
    place = (1000.0 + 0.28 * step_id, aside, 50.0 + 0.17 * step_id + of_height)
    return ReportBasis(readings=(TapeReading("rise", 0.165, step=step_id, u=0.001, at=place),))


def test_a_reading_stays_with_its_tread_when_the_steps_are_numbered_anew():
    inspection = placed(changed(even(5, u=0.0004), 4, rise_m=measured(0.18, 0.0004)))
    (row,) = rows_of(cross_checks.readings_table(inspection, reading_at(3)))
    assert (row["Place"], row["Result"].tone) == ("step 3", "good")
    # The first step is gone: what was the third is now the second, and the third is another tread.
    steps = [dataclasses.replace(each, step_id=each.step_id - 1) for each in inspection.steps[1:]]
    table = cross_checks.readings_table(dataclasses.replace(inspection, steps=tuple(steps)), reading_at(3))
    (row,) = rows_of(table)
    assert (row["Place"], row["Scan"].value) == ("step 2 (was 3)", pytest.approx(165.0))
    assert row["Result"] == Status("agrees", "good")


@pytest.mark.parametrize("moved", [{"of_height": 0.08}, {"aside": 0.45}, {"of_height": -0.08, "aside": -0.3}])
def test_a_tread_that_is_seen_a_little_elsewhere_is_the_same(moved):
    (row,) = rows_of(cross_checks.readings_table(placed(even(5, u=0.0004)), reading_at(3, **moved)))
    assert row["Place"] == "step 3"


@pytest.mark.parametrize(
    "moved", [{"of_height": 5.0}, {"aside": 0.8}, {"of_height": 1.0}, {"of_height": 0.09}, {"of_height": -0.09}]
)
def test_a_reading_of_a_tread_that_is_gone_is_compared_with_none(moved):
    inspection = placed(even(5, u=0.0004))
    # No other tread is near: a place too high or too low is on none.
    inspection = dataclasses.replace(inspection, steps=inspection.steps[2:3])
    table = cross_checks.readings_table(inspection, reading_at(3, **moved))
    (row,) = rows_of(table)
    assert (row["Place"], row["Scan"], row["Difference"]) == ("former step 3", None, None)
    assert row["Result"] == Status("its step is no longer in the result", "close")
    assert table.tones == ((0, "close"),)


@pytest.mark.parametrize(
    ("reading", "is_far"),
    [
        (TapeReading("rise", 0.184, step=2), True),
        (TapeReading("rise", 0.0072, step=2), True),
        (TapeReading("rise", 0.18, step=2), False),
        (TapeReading("nosing_overhang", 0.05, step=2), False),
    ],
)
def test_a_reading_without_u_that_is_far_from_the_scan_says_what_to_check(reading, is_far):
    table = cross_checks.readings_table(inspection_of(even(3, u=0.0001)), ReportBasis(readings=(reading,)))
    (row,) = rows_of(table)
    far = Status("far from the scan: check place and unit; U of the reading not stated", "close")
    assert row["Result"] == (far if is_far else Status("U of the reading not stated", "plain"))


def test_a_reading_without_an_uncertainty_is_not_taken_as_exact():
    reading = TapeReading("rise", 0.1653, step=2)
    (row,) = rows_of(cross_checks.readings_table(inspection_of(even(3, u=0.0001)), ReportBasis(readings=(reading,))))
    assert row["Difference"].value == pytest.approx(0.3)
    assert row["Result"] == Status("U of the reading not stated", "plain")


def test_the_budget_names_the_step_with_the_largest_uncertainty_and_its_parts():
    steps = changed(even(4, u=0.0002), 3, rise_m=Measured(0.165, 0.0005, (("noise", 0.0004), ("up", 0.0003))))
    row = rows_of(grounds.budget_table(inspection_of(steps)))[0]
    assert (row["Quantity"], row["Largest at step"]) == ("rise", 3)
    assert row["Largest U"] == pytest.approx(0.5)
    assert row["Smallest U"] == pytest.approx(0.2)
    assert (row["Noise"], row["Up"], row["Edge"]) == (pytest.approx(0.4), pytest.approx(0.3), None)


def test_flags_name_what_lies_outside_and_the_notes_of_a_step():
    steps = changed(even(4), 2, rise_m=measured(0.2, 0.0001))
    inspection = inspection_of(steps, notes=[("a", "first", None), ("b", "second", 2)])
    found = check(inspection, find_rule_set("us-ibc-2021"))
    rows = rows_of(tables.evidence_table(inspection, found))
    assert rows[1]["Flags"] == "✗ rise, ✗ range of rise, N2"
    assert rows[0]["Flags"] == ""
    assert tables.steps_table(inspection, found).tones == ((1, "bad"),)


@pytest.mark.parametrize(
    ("numbers", "words"), [((3,), "3"), ((4, 3), "3 and 4"), ((1, 2, 3, 7), "1–3, 7"), ((1, 3, 5), "1, 3, 5"), ((), "")]
)
def test_step_numbers_are_listed_as_people_do(numbers, words):
    assert cells.numbers_of(numbers) == words


def test_fitness_that_rests_on_a_registration_nobody_stated_cannot_be_said():
    steps = even(4, u=0.0005)
    for registration_m, said in ((0.0, "cannot be said"), (0.0001, "fit")):
        inspection = inspection_of(steps, registration_m=registration_m)
        rows = rows_of(rule_tables.fits_table(check(inspection, find_rule_set("us-nfpa-101-uniformity"))))
        assert {row["Fit for this check?"].words for row in rows} == {said}


def test_edits_of_a_rule_set_are_listed_with_reason():
    rules = edited(find_rule_set("us-ibc-2021"), "riser", "maximum", Limit.of("7 1/2", "in"), "city amendment")
    (row,) = rows_of(rule_tables.edits_table(check(inspection_of(even(3)), rules)))
    assert row == {
        "Rule": "riser",
        "Side": "maximum",
        "Before": "7 in (177.8 mm)",
        "After": "7 1/2 in (190.5 mm)",
        "Reason": "city amendment",
    }


def test_what_was_not_seen_on_site_is_not_assessed():
    rows = rows_of(rule_tables.checklist_table(Checklist(lighting="200 lx at noon")))
    seen = {row["Item"]: row["Seen on site"] for row in rows}
    assert seen["Lighting and its switches"] == "200 lx at noon"
    assert seen["Headroom"] == Status("not assessed", "plain")
    assert len(rows) == len(Checklist.__dataclass_fields__)


@pytest.mark.parametrize(
    ("column", "cell", "words"),
    [
        (Column("a", "mm", 1), 170.05, "170.1"),
        (Column("a", "mm", 1), -0.04, "0.0"),
        (Column("a", "mm", 1), -3.25, "−3.2"),
        (Column("a", digits=0), 1_234_567, "1\u202f234\u202f567"),
        (Column("a", digits=0), 1234, "1234"),
        (Column("a", "mm", 1), 12_345.6, "12345.6"),
        (Column("a", "mm", 1, is_u=True), 0.004, "0.01"),
        (Column("a", "mm", 1), None, "–"),
        (Column("a"), "text", "text"),
        (Column("a", digits=0), Number(2.345, 2), "2.35"),
        (Column("a"), Status("outside", "bad"), "✗ outside"),
    ],
)
def test_a_cell_is_shown_the_same_everywhere(column, cell, words):
    assert column.text(cell) == words


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("단높이 200 mm", "단높이 200 mm"),
        ("a\x07b", "a\\u0007b"),
        ("photo\u202egpj.exe", "photo\\u202egpj.exe"),
        ("\udcff.ply", "\\udcff.ply"),
        ("two\nlines", "two\nlines"),
        ("\U000e0041", "\\U000e0041"),
    ],
)
def test_what_cannot_be_seen_is_spelt_out(text, shown):
    assert plain(text) == shown
