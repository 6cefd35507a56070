"""What was found about a scan is said alike everywhere, the gravest first."""

import dataclasses

from stair_inspector.model import Observation
from stair_inspector.report.examination import examination_lines, examined
from tests.codes.flights import even, inspection_of

INFO = Observation("voxels", "info", "the points lie on a lattice of 5 mm", 0.005, "export the scan as it was made")
DOUBT = Observation("sparse", "doubt", "a tread has 40 points", None, "--levels.min-points 20")
ASKED = Observation("unit_unsure", "question", "inches or centimetres", None, "--unit in")
SILENT = Observation("far", "doubt", "far from the origin")


def of(*found):
    return dataclasses.replace(inspection_of(even()), examination=found)


def test_questions_stand_first_and_equals_as_they_were_found():
    assert examined(of(INFO, SILENT, DOUBT, ASKED)) == (ASKED, SILENT, DOUBT, INFO)


def test_a_line_has_the_level_as_a_word_and_the_cure_behind():
    assert list(examination_lines(of(INFO, DOUBT, ASKED, SILENT))) == [
        "question: inches or centimetres; answer it with --unit in",
        "doubt: a tread has 40 points; measure again with --levels.min-points 20",
        "doubt: far from the origin",
        "info: the points lie on a lattice of 5 mm; export the scan as it was made",
    ]


def test_an_observation_takes_one_line_whatever_it_says():
    (line,) = examination_lines(of(dataclasses.replace(INFO, message="a\nb\x07", cure="")))
    assert line == "info: a b\\u0007"


def test_nothing_is_said_where_nothing_was_found():
    assert list(examination_lines(of())) == []
