"""The report, its HTML page, its workbook and the JSON say the same numbers: all are read back and compared."""

import io
import json

import openpyxl
import pytest

from stair_inspector.writers.json import json_bytes
from tests.writers.samples import (
    Page,
    checked,
    document,
    formats,
    html_page,
    pdf_pages,
    plain_document,
    scanned,
    workbook,
)

pytestmark = pytest.mark.slow

COLUMNS = (
    ("Rise (mm)", "rise_m"),
    ("Going (mm)", "going_m"),
    ("Tread depth (mm)", "tread_depth_m"),
    ("Overhang (mm)", "nosing_overhang_m"),
    ("Width (mm)", "width_m"),
)
NAMES = ("defective_step", "long_landing", "ceiling_clutter")


def shown(value, digits):
    return "–" if value is None else f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−")


def shown_u(u):
    """As the README says of the table: digits that mean something."""
    return f"{u:.0f}" if u >= 9.95 or u == 0.0 else f"{u:.1f}" if u >= 0.095 else f"{max(u, 0.01):.2f}"


def shown_value(value, u):
    """Rounded to the place of its uncertainty; to a tenth of a millimetre where that is nothing."""
    return shown(value, len(shown_u(u).partition(".")[2]) if u else 1)


def json_of(name):
    return json.loads(json_bytes(scanned(name)[1]))


@pytest.fixture(scope="module", params=NAMES)
def name(request):
    return request.param


@pytest.fixture(scope="module")
def sheets(name):
    return openpyxl.load_workbook(io.BytesIO(formats(name)["_report.xlsx"]))


@pytest.fixture(scope="module")
def page(name):
    return Page(formats(name)["_report.html"])


@pytest.fixture(scope="module")
def pdf(name):
    return "\n".join(pdf_pages(formats(name)["_report.pdf"]))


def rows_of(sheet):
    head, *rows = sheet.iter_rows(values_only=True)
    return [dict(zip(head, row, strict=True)) for row in rows]


def test_every_dimension_of_every_step_is_that_of_the_json_in_the_workbook(name, sheets):
    rows = rows_of(sheets["Steps"])
    steps = json_of(name)["steps"]
    assert [row["Step"] for row in rows] == [step["id"] for step in steps]
    for row, step in zip(rows, steps, strict=True):
        for column, field in COLUMNS:
            value = step[field]
            u_column = f"U {column[0].lower()}{column[1:]}"
            if value is None:
                assert row[column] is None
                assert row[u_column] is None
            else:
                assert row[column] == pytest.approx(value["value"] * 1000.0, abs=1e-6)
                assert row[u_column] == pytest.approx(value["u"] * 1000.0, abs=1e-6)
        if step["pitch_deg"] is not None:
            assert row["Pitch (°)"] == pytest.approx(step["pitch_deg"]["value"], rel=1e-14)


def test_every_dimension_of_every_step_is_that_of_the_json_in_the_page(name, page):
    texts, values = page.tables["steps"][1:], page.values["steps"][1:]
    for text, value, step in zip(texts, values, json_of(name)["steps"], strict=True):
        assert value[0] == step["id"]
        for k, (_, field) in enumerate(COLUMNS):
            number = step[field]
            if number is None:
                assert (text[2 + 2 * k], text[3 + 2 * k]) == ("–", "")
                continue
            assert value[2 + 2 * k] == pytest.approx(number["value"] * 1000.0, abs=1e-6)
            assert text[2 + 2 * k] == shown_value(number["value"] * 1000.0, number["u"] * 1000.0)
            assert text[3 + 2 * k] == f"± {shown_u(number['u'] * 1000.0)}"


def test_every_dimension_of_every_step_is_that_of_the_json_in_the_pdf(name, pdf):
    lines = pdf.splitlines()
    for step in json_of(name)["steps"]:
        cells = [str(step["id"]), str(step["flight"])]
        for _, field in COLUMNS:
            value = step[field]
            cells.append(
                "–"
                if value is None
                else f"{shown_value(value['value'] * 1e3, value['u'] * 1e3)} ± {shown_u(value['u'] * 1e3)}"
            )
        start = " ".join(cells)
        assert sum(line.startswith(start) for line in lines) == 1, start


def test_the_statistics_of_every_flight_are_those_of_the_json_in_all_formats(name, sheets, page, pdf):
    rows = rows_of(sheets["Uniformity"])
    expected = [
        (flight["id"], quantity, flight[quantity])
        for flight in json_of(name)["flights"]
        for quantity in ("rise", "going")
        if flight[quantity]
    ]
    assert [(row["Flight"], row["Quantity"]) for row in rows] == [entry[:2] for entry in expected]
    shown_rows = page.tables["uniformity"][1:]
    for row, text, (_, _, statistics) in zip(rows, shown_rows, expected, strict=True):
        assert row["n"] == statistics["n"]
        for column, field in (("Mean (mm)", "mean"), ("Smallest (mm)", "min"), ("Range (mm)", "range")):
            assert row[column] == pytest.approx(statistics[field] * 1000.0, abs=1e-6)
        assert row["Between steps"] == "{} and {}".format(*statistics["at"])
        assert text[3] == shown(statistics["mean"] * 1000.0, 1)
        assert " ".join(text) in pdf


def test_every_cell_is_the_same_in_page_and_workbook(name, sheets, page):
    for table in document(name).tables():
        if not table.rows:
            continue
        sheet = list(sheets[table.key.replace("_", " ").capitalize()].iter_rows(min_row=2, values_only=True))
        assert len(sheet) == len(page.values[table.key]) - 1
        for cells, values, texts in zip(sheet, page.values[table.key][1:], page.tables[table.key][1:], strict=True):
            for cell, value, text in zip(cells, values, texts, strict=True):
                if isinstance(cell, (int, float)):
                    assert cell == pytest.approx(value, rel=1e-14)
                elif cell is None:
                    assert text in ("–", "")
                else:
                    assert value is None
                    assert text.removesuffix(cell) in ("", "✓ ", "✗ ", "≈ ", "– ")


def test_every_shown_number_of_the_page_is_in_the_pdf(name, page, pdf):
    words = set(" ".join(pdf.split()).split(" "))
    for key, values in page.values.items():
        for row, texts in zip(values, page.tables[key], strict=True):
            for value, text in zip(row, texts, strict=True):
                if value is not None and not text:
                    # A difference of zero is blank.
                    assert abs(value) < 0.05, key
                elif value is not None:
                    last = text.removeprefix("± ").replace("\u202f", " ").split(" ")
                    assert set(last) <= words, (key, text)


def test_every_finding_is_that_of_the_json(name, sheets):
    record = json.loads(json_bytes(scanned(name)[1], checked(name)))["check"]
    rules = {rule["id"]: rule for rule in record["rules"]}
    plain_verdicts = ("within", "reported", "not_assessed")
    told = [finding for finding in record["findings"] if finding["verdict"] not in plain_verdicts]
    rows = rows_of(sheets["Findings"]) if "Findings" in sheets.sheetnames else []
    assert len(rows) == len(told)
    for row, finding in zip(rows, told, strict=True):
        rule = rules[finding["rule"]]
        # Metres to millimetres, tangents to per cent.
        scale = {"m": 1000.0, "tangent": 100.0, "deg": 1.0, "count": 1.0}[rule["unit"]]
        assert row["Clause"] == rule["clause"]
        assert row["Result"].replace(", ", "_").replace(" ", "_") == finding["verdict"]
        for column, field in (("Measured", "value"), ("U", "u"), ("Margin", "margin")):
            value = finding[field]
            assert row[column] == (None if value is None else pytest.approx(value * scale, abs=1e-6))


def test_the_result_of_every_rule_is_the_gravest_finding_of_the_json(name, sheets, page):
    record = json.loads(json_bytes(scanned(name)[1], checked(name)))["check"]
    # The gravest first, as the README orders them.
    order = (
        *("outside", "outside_close", "not_measured", "not_judged", "within_close", "within", "reported"),
        "not_assessed",
    )
    expected = []
    for rule in record["rules"]:
        of_rule = [finding for finding in record["findings"] if finding["rule"] == rule["id"]]
        for flight in dict.fromkeys(finding["flight"] for finding in of_rule):
            here = [finding["verdict"] for finding in of_rule if finding["flight"] == flight]
            expected.append((rule["clause"], flight, min(here, key=order.index).replace("_close", ", close")))
    rows = rows_of(sheets["Rules"])
    assert [
        (row["Clause"], row["Flight"], row["Result"].replace(" ", "_").replace(",_", ", ")) for row in rows
    ] == expected
    shown_results = [row[-1].split(" ", 1)[1] for row in page.tables["rules"][1:]]
    assert shown_results == [row["Result"] for row in rows]


def test_the_rule_set_and_its_hash_are_in_every_format(name, sheets, page, pdf):
    rules = json.loads(json_bytes(scanned(name)[1], checked(name)))["check"]["rule_set"]
    cells = {cell for row in sheets["Fields"].iter_rows(values_only=True) for cell in row}
    for text in (rules["sha256"], rules["id"], rules["edition"]):
        assert text in cells
        assert text in page.text
        assert text in pdf


def test_the_hash_of_the_scan_is_in_every_format(name, sheets, page, pdf):
    digest = json_of(name)["scan"]["sha256"]
    assert digest in page.text
    assert digest in pdf
    assert digest in {cell for row in sheets["Fields"].iter_rows(values_only=True) for cell in row}


def test_every_sentence_is_in_every_format():
    made = plain_document(scanned()[1], checked())
    page = html_page(made).text
    sheet = {row[1] for row in workbook(made)["Text"].iter_rows(values_only=True)}
    assert len(sheet) > 20
    # On the page the title of a table without rows is a heading above the sentence.
    empty = {f"{table.title}: {table.empty}": f"{table.title} {table.empty}" for table in made.tables()}
    for sentence in sheet - {"Text"}:
        if ": " in sentence and sentence.split(": ")[1][:1].isdigit():
            # A key figure, whose number stands before its words on the page.
            continue
        assert " ".join(empty.get(sentence, sentence).split()) in page
