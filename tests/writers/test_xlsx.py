"""The workbook, read back: numbers as numbers, units in the heads, texts never formulas."""

import dataclasses
import io
import zipfile
from datetime import timedelta

import openpyxl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stair_inspector.content.document import Column, Number, Table, plain
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.writers.xlsx import xlsx_bytes
from tests.codes.flights import even, inspection_of
from tests.writers.samples import HOSTILE, MADE_AT, checked, document, plain_document, scanned, workbook
from tests.writers.test_pdf import made_of

FORMULAS = [
    "=1+1",
    '=HYPERLINK("http://x.y")',
    "+1",
    "-1",
    "@SUM(A1)",
    "{=1}",
    "http://x.y/",
    "mailto:a@b.c",
    "12.5",
    "1e9",
]


@pytest.fixture(scope="module")
def book():
    return openpyxl.load_workbook(io.BytesIO(xlsx_bytes(document())))


def test_there_is_a_sheet_for_each_table_and_three_for_the_words(book):
    tables = [table.key.replace("_", " ").capitalize() for table in document().tables() if table.rows]
    assert book.sheetnames == ["About", "Fields", "Text", *tables]
    assert len(tables) >= 12


def test_the_first_sheet_lists_the_sheets_of_tables_that_are_there(book):
    listed = list(book["About"].iter_rows(min_row=4, values_only=True))
    assert [name for name, _ in listed] == book.sheetnames[3:]
    by_key = {table.key.replace("_", " ").capitalize(): table for table in document().tables()}
    for name, words in listed:
        table = by_key[name]
        assert words == (f"{table.title}. {table.note}" if table.note else table.title)
    assert any(not by_key[name].note for name, _ in listed)


def test_what_stands_for_a_table_without_rows_is_among_the_texts(book):
    assert "Overrules" not in book.sheetnames
    texts = list(book["Text"].iter_rows(min_row=2, values_only=True))
    (empty,) = [table for table in document().tables() if table.key == "overrules"]
    assert (empty.title, empty.empty) in texts


def test_numbers_are_numbers_and_heads_say_their_units(book):
    for table in document().tables():
        if not table.rows:
            continue
        head, *rows = book[table.key.replace("_", " ").capitalize()].iter_rows()
        assert [cell.value for cell in head] == [
            f"{column.name} ({column.unit})" if column.unit else column.name for column in table.columns
        ]
        for cells, row in zip(rows, table.rows, strict=True):
            for cell, value in zip(cells, row, strict=True):
                is_number = isinstance(value, (int, float, Number))
                assert (cell.data_type == "n" and cell.value is not None) == is_number


def test_a_length_is_shown_with_the_decimals_of_the_report(book):
    sheet = book["Steps"]
    assert sheet["C2"].number_format == "0.0"
    # Not rounded, but for what is below a nanometre.
    assert sheet["C2"].value == pytest.approx(1000.0 * scanned()[1].steps[0].rise_m.value, abs=1e-6)


def test_a_difference_that_is_zero_as_shown_is_a_blank_cell_in_every_format():
    column = Column("Difference", "mm", 2, is_difference=True)
    assert [column.text(each) for each in (0.0, -0.004, 0.006, -1.5, None)] == ["", "", "0.01", "−1.50", "–"]
    cell = workbook(made_of(Table("t", "Table", (column,), ((-0.004,),))))["T"]["A2"]
    # The number itself stays; the two conditions of the format are those above.
    assert (cell.value, cell.number_format) == (-0.004, '[>=0.005]0.00;[<=-0.005]-0.00;""')


@pytest.mark.parametrize("text", [*FORMULAS, HOSTILE])
def test_a_text_is_never_a_formula_a_link_or_a_number(text):
    table = Table("t", "Table", (Column("A"), Column(text)), ((text, text),))
    book = workbook(made_of(table))
    for cell in (book["T"]["A2"], book["T"]["B2"], book["T"]["B1"]):
        assert (cell.value, cell.data_type, cell.hyperlink) == (text, "s", None)
    fields = ReportFields(**dict.fromkeys(ReportFields.__dataclass_fields__, text))
    book = workbook(plain_document(scanned()[1], None, ReportBasis(fields=fields)))
    found = [cell for row in book["Fields"].iter_rows() for cell in row if cell.value == text]
    assert len(found) >= len(ReportFields.__dataclass_fields__) - 1
    assert {cell.data_type for cell in found} == {"s"}


@given(text=st.text(min_size=1, max_size=60))
@settings(max_examples=60)
def test_any_text_comes_back_as_the_report_shows_it(text):
    shown = plain(text)
    book = workbook(made_of(Table("t", "Table", (Column("A"),), ((shown,),))))
    value = book["T"]["A2"].value
    # A workbook's reader takes line ends as one kind.
    assert (value or "") == shown.replace("\r\n", "\n")


def test_sheets_of_one_name_are_told_apart():
    table = Table("a_key", "Table", (Column("A"),), (("x",),))
    again = dataclasses.replace(table, key="A_KEY")
    book = workbook(
        made_of(table, again, dataclasses.replace(table, key="text"), dataclasses.replace(table, key="[]:*"))
    )
    assert book.sheetnames[3:] == ["A key", "A key 2", "Text 2", "Table"]


def test_a_text_too_long_for_a_cell_says_how_much_is_missing():
    book = workbook(made_of(Table("t", "Table", (Column("A"),), (("x" * 40_000,),))))
    assert book["T"]["A2"].value == "x" * 32_000 + " [and 8000 more characters, see the report]"


def test_the_same_content_gives_the_same_bytes_and_the_date_is_all_that_differs():
    made = plain_document(scanned()[1], checked())
    later = dataclasses.replace(made, made_at=MADE_AT + timedelta(days=40))
    assert xlsx_bytes(made) == xlsx_bytes(made)
    before, after = (zipfile.ZipFile(io.BytesIO(xlsx_bytes(each))) for each in (made, later))
    assert before.namelist() == after.namelist()
    for name in before.namelist():
        assert before.read(name).replace(b"2026-11-22", b"2027-01-01") == after.read(name)


def test_sixty_steps_are_sixty_rows():
    sheet = workbook(plain_document(inspection_of(even(60))))["Steps"]
    assert [row[0] for row in sheet.iter_rows(min_row=2, values_only=True)] == list(range(1, 61))


def test_a_missing_value_is_an_empty_cell():
    sheet = workbook(plain_document(inspection_of(even(3))))["Steps"]
    assert sheet["E4"].value is None
    assert sheet["E1"].value == "Going (mm)"
