"""The files of a comparison hold what was found, in the units that their names say."""

import csv
import io
import json

import jsonschema
import numpy as np
import pytest

from stair_inspector.content.comparisons import changes_table
from stair_inspector.files.paths import static_configs
from stair_inspector.quantities import quantity_of
from stair_inspector.writers.comparison import (
    comparison_csv_bytes,
    comparison_json_bytes,
    comparison_text,
    write_comparison,
)
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


def test_both_files_are_written(tmp_path):
    paths = write_comparison(compared(True), tmp_path / "results", "earlier", "later")
    assert [path.name for path in paths] == ["earlier_later_comparison.json", "earlier_later_comparison.csv"]
    assert paths[0].read_bytes() == comparison_json_bytes(compared(True))
