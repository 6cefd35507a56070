"""The files of a comparison hold what was found, in the units that their names say."""

import csv
import io
import json
from datetime import datetime

import jsonschema
import numpy as np
import openpyxl
import pytest

from stair_inspector.content.comparisons import changes_table
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.order import build_document
from stair_inspector.files.paths import static_configs
from stair_inspector.model import ComparedScan
from stair_inspector.quantities import quantity_of
from stair_inspector.writers.comparison import (
    comparison_csv_bytes,
    comparison_files,
    comparison_json_bytes,
    comparison_text,
)
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.xlsx import xlsx_bytes
from tests.comparison.epochs import LAST, MOVED, SETTLED, WORN, compared, epoch


def test_the_json_follows_its_schema_and_holds_the_changes():
    schema = json.loads((static_configs() / "schemas" / "comparison-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    found = compared(True)
    document = json.loads(comparison_json_bytes(found))
    jsonschema.validate(document, schema)
    for step, record in zip(found.steps, document["steps"], strict=True):
        assert record["height_m"]["change"] == {"value": step.height.change.value, "u": step.height.change.u}
        for value in step.values:
            quantity = quantity_of(value.quantity)
            assert record[quantity.column]["is_changed"] == value.is_changed
            assert schema["$defs"]["step"]["properties"][quantity.column]["description"] == quantity.definition


def test_the_alignment_in_the_json_lays_the_later_scan_onto_the_earlier_one():
    laid = json.loads(comparison_json_bytes(compared(True)))["alignment"]
    place = np.array([0.3, 0.5, 0.3])
    moved = MOVED[:3, :3] @ place + MOVED[:3, 3]
    assert np.array(laid["turn"]) @ moved + laid["shift_m"] == pytest.approx(place, abs=0.002)
    assert epoch(1, is_moved=False)[0].origin_m == pytest.approx([0.0, 0.0, 0.0])


def test_the_csv_has_a_row_per_step_in_millimetres():
    found = compared(True)
    rows = list(csv.DictReader(io.StringIO(comparison_csv_bytes(found).decode())))
    assert [int(row["step_before"]) for row in rows] == list(range(1, LAST + 1))
    row, step = rows[SETTLED - 1], found.steps[SETTLED - 1]
    assert float(row["height_change_mm"]) == pytest.approx(1000.0 * step.height.change.value, abs=1e-5)
    assert row["height_is_changed"] == "True"
    rise = next(value for value in step.values if value.quantity == "rise")
    assert float(row["rise_after_mm"]) == pytest.approx(1000.0 * rise.after.value, abs=1e-5)
    assert float(row["rise_change_u_mm"]) == pytest.approx(1000.0 * rise.change.u, abs=1e-5)
    assert float(rows[WORN - 1]["worst_place_mm"]) < -1.0
    assert rows[SETTLED - 1]["worst_place_mm"] == ""


def test_the_table_stars_what_changed_and_nothing_else():
    found = compared(True)
    table = changes_table(found)
    place = [column.name for column in table.columns].index("Δ height")
    starred = [row[0] for row in table.rows if row[place].endswith("*")]
    assert starred == [str(k) for k in range(SETTLED, LAST + 1)]
    assert table.rows[SETTLED - 1][place].startswith("−4.0 ± ")
    text = comparison_text(found)
    assert all(note.message in text for note in found.notes)
    assert "*" not in "".join(str(cell) for row in changes_table(compared(False)).rows for cell in row)


def test_both_files_are_made():
    files = comparison_files(compared(True))
    assert list(files) == ["_comparison.json", "_comparison.csv"]
    assert files["_comparison.json"] == comparison_json_bytes(compared(True))


def test_the_json_of_an_inspection_holds_the_comparison_or_null():
    schema = json.loads((static_configs() / "schemas" / "inspection-1.schema.json").read_text(encoding="utf-8"))
    _, inspection = epoch(51, True)
    document = json.loads(json_bytes(inspection, compared=ComparedScan(compared(True), is_earlier=False)))
    jsonschema.validate(document, schema)
    assert document["comparison"] == json.loads(comparison_json_bytes(compared(True)))
    assert document["comparison"]["after"]["sha256"] == document["scan"]["sha256"]
    assert json.loads(json_bytes(inspection))["comparison"] is None


def test_the_workbook_has_the_changes_as_numbers():
    _, inspection = epoch(51, True)
    seen = ComparedScan(compared(True), is_earlier=False)
    document = build_document(inspection, None, ReportBasis(), datetime(2026, 1, 1), compared=seen)
    sheet = openpyxl.load_workbook(io.BytesIO(xlsx_bytes(document)))["Changes"]
    heads = [cell.value for cell in sheet[1]]
    cell = sheet.cell(SETTLED + 1, heads.index("Δ height (mm)") + 1)
    assert cell.value == pytest.approx(1000.0 * compared(True).steps[SETTLED - 1].height.change.value)
    assert sheet.cell(SETTLED + 1, cell.column + 1).number_format.endswith('" *"')
    assert "*" not in sheet.cell(2, cell.column + 1).number_format
