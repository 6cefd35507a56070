"""The bundled samples held against rule sets: golden findings, and every verdict against the truth beside the scan."""

import itertools
import math
import re
from functools import cache
from typing import Any

import pytest

from stair_inspector.codes import Check, Finding, Rule, Verdict, check, gravest, overlaid
from stair_inspector.content.document import SIGNS, Status, Table
from stair_inspector.content.rule_tables import by_step_table
from stair_inspector.content.tables import evidence_table, steps_table
from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets
from stair_inspector.model import Inspection
from stair_inspector.viewer.parts.checks.checks_html import steps_html
from stair_inspector.viewer.scene.step_marks import marks_of
from tests.test_samples import PRESETS_MARKED, survey_sample, truth_of

IN, CLOSE, OUT, OUT_CLOSE = Verdict.WITHIN, Verdict.WITHIN_CLOSE, Verdict.OUTSIDE, Verdict.OUTSIDE_CLOSE
NOT_JUDGED, REPORTED = Verdict.NOT_JUDGED, Verdict.REPORTED


@cache
def checked(name: str, set_id: str, decision: Any = "guarded") -> Check:
    base = overlaid(find_rule_set(set_id), find_rule_set("us-nfpa-101-uniformity")) if set_id == "us-irc-2024" else None
    return check(survey_sample(name), base or find_rule_set(set_id), decision)


def sides(result: Check, rule_id: str) -> list[int]:
    """Steps at which a rule's values lie outside."""
    return sorted({step for found in result.of_rule(rule_id) if found.verdict.is_outside for step in found.steps})


# --- golden --------------------------------------------------------------------------------------------------------


def test_the_even_stair_is_outside_nothing() -> None:
    result = checked("straight", "us-irc-2024")
    assert not result.is_outside
    golden = {rule.rule_id: gravest(result.of_rule(rule.rule_id)).verdict for rule in result.rule_set.rules}
    # Its goings of 280 mm lie 0.6 mm above the 11 in below which a nosing is required: too near to tell.
    nosing = {golden.pop("nosing"), golden.pop("nosing-uniformity")}
    assert nosing <= {REPORTED, NOT_JUDGED}
    # A tread wide enough is no clear width.
    assert golden.pop("width") is REPORTED
    assert set(golden.values()) <= {IN, CLOSE}
    assert golden["riser"] is golden["tread-depth"] is golden["riser-uniformity"] is IN


def test_the_defective_stair_is_outside_where_it_was_built_so() -> None:
    result = checked("defective_step", "us-irc-2024")
    assert result.is_outside
    # Riser 5 is 15 mm too high, tread 7 is 12 mm short, tread 3 falls by 3.43 degrees.
    assert sides(result, "riser-uniformity")[-1] == 5
    assert sides(result, "nfpa-101-riser-adjacent") == [4, 5, 6]
    assert 7 in sides(result, "tread-uniformity")
    assert sides(result, "nfpa-101-tread-adjacent") == [6, 7, 8]
    assert sides(result, "tread-slope") == [3]
    assert sides(result, "riser") == sides(result, "tread-depth") == sides(result, "width") == []
    clear = {found.rule.rule_id for found in result.findings if found.verdict is OUT}
    assert clear == {
        "riser-uniformity",
        "tread-slope",
        "nfpa-101-riser-adjacent",
        "nfpa-101-riser-uniformity",
        "nfpa-101-tread-adjacent",
    } | ({"tread-uniformity", "nfpa-101-tread-uniformity"} & clear)


@pytest.mark.slow
def test_a_handheld_scan_says_that_it_is_not_fit_for_neighbours() -> None:
    result = checked("handheld_noisy", "us-irc-2024")
    fits = {fit.rule_id: fit.is_fit for fit in result.fits}
    assert fits["riser"] is True
    assert fits["nfpa-101-riser-adjacent"] is False
    assert fits["nfpa-101-tread-adjacent"] is False


@pytest.mark.slow
def test_both_flights_of_the_landing_are_judged() -> None:
    result = checked("long_landing", "us-irc-2024")
    assert {found.flight for found in result.of_rule("riser-uniformity")} == {1, 2}
    assert len(result.of_rule("riser")) == 15
    # The landing between them is 1.25 m deep, and no tread.
    assert [found.steps for found in result.of_rule("tread-depth") if 8 in found.steps] == []


# --- against the truth ---------------------------------------------------------------------------------------------


def true_values(truth: dict[str, Any], found: Finding, rule: Rule) -> float | None:
    """The true value of what a finding is about, SI, worked out from the truth file alone; None where it is not."""
    steps = {step["id"]: step for step in truth["steps"]}
    flight = next(each["steps"] for each in truth["flights"] if each["id"] == found.flight)
    landing = flight[-1]
    treads = [number for number in flight if number != landing]

    def value(number: int) -> float:
        step = steps[number]
        if rule.quantity == "two_r_plus_g":
            return float(2.0 * step["rise_m"] + step["going_m"])
        if rule.quantity in ("tread_slope", "landing_slope"):
            return math.hypot(*(math.tan(math.radians(step[name])) for name in ("fall_deg", "cross_fall_deg")))
        return float(step[f"{rule.quantity}_m"])

    if rule.statistic == "each":
        return value(found.steps[0])
    if rule.statistic == "adjacent_difference":
        return abs(value(found.steps[1]) - value(found.steps[0]))
    if rule.statistic == "flight_range":
        numbers = flight if rule.quantity == "rise" else treads
        if rule.only_where is not None:
            return None
        values = [value(number) for number in numbers]
        return max(values) - min(values)
    if rule.quantity == "n_risers":
        return float(len(flight))
    if rule.quantity == "pitch":
        heights = list(itertools.accumulate(steps[number]["rise_m"] for number in flight))
        places = list(itertools.accumulate((steps[number]["going_m"] for number in treads), initial=0.0))
        # The line of best fit is that of equal steps here, or nearly: a step in ten off by 15 mm turns it by 0.3 deg.
        return math.degrees(math.atan2(heights[-1] - heights[0], places[-1]))
    return math.fsum(steps[number]["rise_m"] for number in flight)


@pytest.mark.parametrize("rule_set", list_rule_sets(), ids=lambda each: each.set_id)
@pytest.mark.parametrize("name", PRESETS_MARKED)
def test_no_clear_verdict_contradicts_the_truth(name: str, rule_set: Any) -> None:
    truth, result = truth_of(name), check(survey_sample(name), rule_set)
    n_held = 0
    for found in result.findings:
        rule = found.rule
        is_inside = rule.from_scan == "partly" and found.verdict is REPORTED and rule.severity != "report_only"
        if found.value is None or found.u is None:
            continue
        true = true_values(truth, found, rule)
        if true is None or (rule.quantity == "pitch" and name == "defective_step"):
            continue
        if found.limit is not None and abs(true - found.limit.value) < 1e-9:
            # Built to the limit exactly: what is measured lies about as far from it as U says, on either side.
            assert abs(found.value - true) <= 2.0 * found.u, (rule.rule_id, found.steps, found.value, found.u, true)
            n_held += 1
            continue
        if not (found.verdict in (IN, OUT) or is_inside) or (
            is_inside and (found.margin is None or found.margin < found.u)
        ):
            continue
        n_held += 1
        outside = (rule.minimum is not None and true < rule.minimum.value - 1e-9) or (
            rule.maximum is not None and true > rule.maximum.value + 1e-9
        )
        # One in twenty may be off by more than U; none of those here by as much as the rest of the way.
        assert (found.verdict is OUT) is outside, (rule.rule_id, found.steps, found.value, found.u, true)
    assert n_held >= 3


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS_MARKED)
def test_the_uncertainties_of_differences_and_spreads_hold_once_the_registration_is_stated(name: str) -> None:
    truth = truth_of(name)
    result = check(survey_sample(name, is_stated=True), find_rule_set("ca-9.8-private"))
    held = []
    for found in result.findings:
        true = true_values(truth, found, found.rule) if found.value is not None and found.u is not None else None
        if true is None or found.value is None or found.u is None:
            continue
        if found.rule.statistic == "adjacent_difference":
            held.append(abs(found.value - true) <= found.u)
        elif found.rule.statistic == "flight_range" and found.verdict.is_within:
            # That of a verdict within says how much larger the spread may be.
            held.append(true - found.value <= found.u)
    assert len(held) >= 13
    assert sum(held) >= 0.95 * len(held)


# --- the page and the report -----------------------------------------------------------------------------------------


def marked_on_page(inspection: Inspection, result: Check) -> dict[int, str]:
    """The sign that a step has in the page's results by step, where it has one."""
    rows = re.findall(r'data-of="(\d+)"(.*?)</tr>', steps_html(inspection, result, None, "pick"), re.DOTALL)
    signs = {int(step): re.search(r'data-testid="mark"[^>]*>(.)</b>', row) for step, row in rows}
    return {step: found[1] for step, found in signs.items() if found is not None}


def outside_in(table: Table) -> dict[int, str]:
    """The sign of the gravest verdict outside a limit that a row of the report's results by step has."""
    told = {}
    for row in table.rows:
        cells = [cell for cell in row if isinstance(cell, Status) and cell.words in (OUT.words, OUT_CLOSE.words)]
        if cells:
            told[int(str(row[0]))] = SIGNS["bad" if any(cell.words == OUT.words for cell in cells) else "close"]
    return told


def toned_in(table: Table) -> dict[int, str]:
    return {int(str(table.rows[row][0])): SIGNS[tone] for row, tone in table.tones}


def every_set() -> list[Any]:
    nfpa = find_rule_set("us-nfpa-101-uniformity")
    return [*list_rule_sets(), *(overlaid(each, nfpa) for each in list_rule_sets() if not each.is_overlay)]


@pytest.mark.parametrize("decision", ["guarded", "simple"])
@pytest.mark.parametrize("name", PRESETS_MARKED)
def test_the_report_calls_outside_the_steps_that_the_page_marks(name: str, decision: Any) -> None:
    inspection = survey_sample(name)
    for rule_set in every_set():
        result = check(inspection, rule_set, decision)
        marked = {step: mark.sign for step, mark in marks_of(inspection, result).items()}
        assert marked_on_page(inspection, result) == marked
        assert outside_in(by_step_table(inspection, result)) == marked, rule_set.set_id
        assert toned_in(steps_table(inspection, result)) == toned_in(evidence_table(inspection, result)) == marked
        # What is outside is so at a step, or is of a whole flight.
        beyond = [found for found in result.findings if found.verdict.is_outside and found.rule.severity == "limit"]
        assert bool(marked) is any(found.steps for found in beyond)
        assert result.is_outside is bool(beyond)


def test_the_report_says_which_steps_of_the_defective_stair_are_outside() -> None:
    inspection = survey_sample("defective_step")
    plainly = check(inspection, find_rule_set("us-irc-2024"))
    # The range of the flight's rises and that of its goings are outside, and they are at the two odd steps.
    assert set(outside_in(by_step_table(inspection, plainly))) == {3, 5, 7}
