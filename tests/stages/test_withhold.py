"""A question that is open: nothing with a number leaves the survey, and what is drawn stays."""

import csv
import dataclasses
import functools
import io

import numpy as np
import pytest

from stair_inspector.codes import Verdict, check
from stair_inspector.content.records import inspection_to_dict
from stair_inspector.content.verdicts import verdict_sentence
from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets
from stair_inspector.model import Observation
from stair_inspector.pipeline import inspect
from stair_inspector.quantities import SURVEY_VALUES
from stair_inspector.stages.withhold import withhold
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.debug_ply import debug_ply_bytes
from stair_inspector.writers.text import check_text
from tests.synthetic import Stair, exact_params

ASKED = Observation("unit_unsure", "question", "inches or centimetres: both fit", None, "--unit in")
DOUBT = Observation("layers", "doubt", "surfaces are double, 12 mm apart", 0.012, "register the stations again")
NUMBERS = ("rise_mm", "going_mm", "rms_mm", "width_mm", "coverage", "paper_h_mm", "paper_w_mm", "rise_left_mm")


@functools.cache
def scan_of(*observations):
    return dataclasses.replace(Stair(n_steps=5, noise=0.001).scan(), observations=observations)


@functools.cache
def inspected(*observations, method="survey"):
    return inspect(scan_of(*observations), exact_params(method=method))


def values_in(document):
    """Every value of steps and flights that is a quantity: their numbers, points and places are none."""
    told = []
    for step in document["steps"]:
        names = (*SURVEY_VALUES, "coverage", "rise_lcr_m", "going_lcr_m", "line_points_m", "rms_m")
        told += [step[name] for name in names] + list(step["paper"].values())
    for flight in document["flights"]:
        told += [flight[name] for name in ("pitch_deg", "width_m", "rise", "going", "radius_m")]
    return [*told, document["floor"]["rms_m"], document["floor"]["h_m"]]


def test_nothing_with_a_number_is_given_before_a_question_is_answered():
    held = inspection_to_dict(inspected(ASKED))
    assert len(held["steps"]) == 5
    assert values_in(held) == [None] * len(values_in(held))
    assert any(value is not None for value in values_in(inspection_to_dict(inspected())))
    assert [found["code"] for found in held["examination"]] == ["unit_unsure"]
    rows = list(csv.DictReader(io.StringIO(csv_bytes(inspected(ASKED)).decode())))
    assert {row[name] for row in rows for name in NUMBERS} == {""}


def test_what_is_drawn_stays():
    held, given = inspected(ASKED), inspected()
    for one, other in zip(held.steps, given.steps, strict=True):
        assert np.array_equal(one.corners, other.corners)
        assert np.array_equal(one.nosing, other.nosing)
    assert np.array_equal(held.labels, given.labels)
    assert [flight.n_risers for flight in held.flights] == [flight.n_risers for flight in given.flights]
    assert len(debug_ply_bytes(scan_of(ASKED), held)) < len(debug_ply_bytes(scan_of(), given))


def test_a_note_says_what_is_asked_and_what_answers_it():
    note = inspected(ASKED, DOUBT).notes[0]
    assert (note.code, note.step) == ("withheld", None)
    assert ASKED.message in note.message
    assert note.message.endswith("--unit in")
    assert sum(each.code == "withheld" for each in inspected(ASKED, DOUBT).notes) == 1


def drop_examination(document):
    """Take out of a document what the examination found, also where it is listed, and the times."""
    del document["timings_s"], document["examination"]
    listed = [found for found in document["findings"] if found["kind"] != "examination"]
    document["findings"] = [{**found, "number": number} for number, found in enumerate(listed, 1)]


def test_a_doubt_withholds_nothing_and_changes_nothing():
    doubted, given = (inspection_to_dict(inspected(*each)) for each in ((DOUBT,), ()))
    for document in (doubted, given):
        drop_examination(document)
    assert doubted == given
    assert withhold(inspected(DOUBT)) is inspected(DOUBT)


def test_the_papers_method_keeps_its_numbers():
    asked, given = (inspection_to_dict(inspected(*each, method="paper")) for each in ((ASKED,), ()))
    assert [found["code"] for found in asked["examination"]] == ["unit_unsure"]
    for document in (asked, given):
        drop_examination(document)
    assert asked == given


@pytest.mark.parametrize("set_id", [each.set_id for each in list_rule_sets()])
def test_no_rule_is_judged_before_a_question_is_answered(set_id):
    found = check(inspected(ASKED), find_rule_set(set_id))
    told = [each for each in found.findings if each.rule.from_scan != "no"]
    assert told
    assert {each.verdict for each in told} == {Verdict.NOT_JUDGED}
    assert all(ASKED.message in each.reason and each.value is None for each in told)
    assert not found.is_judged
    assert not found.is_outside
    assert "no value is given, which is no pass: a question about the scan has to be answered" in verdict_sentence(
        found
    )
    assert ASKED.message in check_text(found)


def test_what_a_later_version_measures_is_withheld_too():
    given = inspected(DOUBT)
    rise_m = given.steps[0].rise_m
    flights = [dataclasses.replace(flight, radius_m=rise_m) for flight in given.flights]
    asked = dataclasses.replace(given, flights=tuple(flights), examination=(ASKED,))
    assert [flight.radius_m for flight in withhold(asked).flights] == [None]
