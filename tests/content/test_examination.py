"""What was found about a scan is said alike everywhere, the gravest first."""

import dataclasses
import io

import openpyxl

from stair_inspector.content.document import Paragraph, Status, Table
from stair_inspector.content.examination import examination_lines, examination_table, examined
from stair_inspector.model import Observation
from stair_inspector.writers.html import html_bytes
from stair_inspector.writers.xlsx import xlsx_bytes
from tests.codes.flights import even, inspection_of
from tests.writers.samples import HOSTILE, Page, plain_document

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


def test_the_flag_of_an_info_is_the_other_way_to_take_the_scan_and_no_advice():
    read = Observation("unit_by_stair", "info", "read in inches", None, "--unit cm")
    assert list(examination_lines(of(read))) == ["info: read in inches; if that is wrong, measure with --unit cm"]
    assert examination_table(of(read)).rows[0][3] == "If that is wrong: the file is in centimetres"


def test_an_observation_takes_one_line_whatever_it_says():
    (line,) = examination_lines(of(dataclasses.replace(INFO, message="a\nb\x07", cure="")))
    assert line == "info: a b\\u0007"


def test_nothing_is_said_where_nothing_was_found():
    assert list(examination_lines(of())) == []


def test_the_table_of_the_report_says_cures_in_words():
    table = examination_table(of(INFO, DOUBT, ASKED))
    assert [row[0] for row in table.rows] == [
        Status("question", "bad"),
        Status("doubt", "close"),
        Status("info", "plain"),
    ]
    assert table.rows[0][1:] == ("Inches or centimetres", None, "The file is in inches")
    assert table.rows[1][3] == "Set m (points in reach) to 20"
    assert table.rows[2][1:] == ("The points lie on a lattice of 5 mm", 5.0, "Export the scan as it was made")


def test_the_report_begins_with_the_examination_and_a_sound_scan_has_none():
    front = plain_document(of(ASKED, DOUBT)).front
    assert isinstance(front[0], Paragraph)
    assert isinstance(front[1], Table)
    assert front[1].title == "Examination of the scan"
    assert "examination" not in {table.key for table in plain_document(of()).tables()}


def test_what_a_scan_says_of_itself_is_text_in_page_and_workbook():
    hostile = dataclasses.replace(DOUBT, message=HOSTILE, cure=HOSTILE)
    made = plain_document(of(hostile, INFO))
    page = Page(html_bytes(made))
    assert not [tag for tag, _ in page.tags if tag == "script"]
    assert HOSTILE in " ".join(page.words)
    book = openpyxl.load_workbook(io.BytesIO(xlsx_bytes(made)))
    assert [row[1] for row in book["Examination"].iter_rows(min_row=2, values_only=True)] == [
        HOSTILE,
        "The points lie on a lattice of 5 mm",
    ]
    about = [row for row in book["About"].iter_rows(values_only=True) if row[0] == "Examination of the scan"]
    assert about[0][1].startswith(f"doubt; {HOSTILE}")


def test_a_report_on_an_open_question_has_no_value():
    held = plain_document(of(ASKED))
    assert not {"steps", "flights", "evidence", "uniformity", "budget", "paper", "surfaces"} & {
        each.key for each in held.tables()
    }
    assert "A question about the scan has to be answered first; no value is given. Inches" in held.front[0].text
