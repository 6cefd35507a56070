"""Drills: a change that should take one place is made in a copy of the package, and seen wherever it must appear."""

import subprocess
import sys

import pytest

from stair_inspector.files.ply import ply_bytes
from tests.package_copy import ROOT, copy_package, environment_of
from tests.synthetic import Stair
from tests.viewer.wire_page import OTHER, STAIR

NEW_QUANTITY = """
    Quantity(
        name="nosing_height",
        definition="height of the nosing on the centre line above the scan's zero",
        head="nosing",
        of_step=lambda step, _: None
        if step.line_points is None or step.rise_m is None
        else Measured(float(step.line_points[1][2]), step.rise_m.u),
    ),
"""
SEEN = """
import dataclasses, io, json, sys
from pathlib import Path

import openpyxl

import stair_inspector
from stair_inspector.content.fields import ReportBasis
from stair_inspector.content.order import build_document
from stair_inspector.content.readings import STEP_READINGS
from stair_inspector.content.schema import with_quantities
from stair_inspector.viewer.compute.sensitivity import SWEPT_QUANTITIES
from stair_inspector.viewer.parts.step_table_html import table_html
from stair_inspector.viewer.parts.steps.card_html import card_html
from stair_inspector.viewer.parts.tune.comparison import compare, comparison_html
from stair_inspector.writers.csv import csv_bytes
from stair_inspector.writers.html import html_bytes
from stair_inspector.writers.json import json_bytes
from stair_inspector.writers.text import inspection_text, quantities_text
from stair_inspector.writers.xlsx import xlsx_bytes
from tests.viewer.surveyed import PALETTE, surveyed
from tests.writers.samples import MADE_AT

assert Path(stair_inspector.__file__).parent.parent == Path(sys.argv[1])
inspection = surveyed()[1]
document = build_document(inspection, None, ReportBasis(), MADE_AT)
workbook = openpyxl.load_workbook(io.BytesIO(xlsx_bytes(document)))
schema = json.loads(Path(sys.argv[2]).read_text())
height_m = float(inspection.steps[1].line_points[1][2])
words = f"{1000.0 * height_m:.1f}"
told = json.loads(json_bytes(inspection))["steps"][1]["nosing_height_m"]
rows = csv_bytes(inspection).decode().splitlines()
cells = dict(zip(rows[0].split(","), rows[2].split(","), strict=True))
found = {
    "JSON": told["value"] == height_m and told["u"] > 0.0,
    "CSV": abs(float(cells["nosing_height_mm"]) - 1e3 * height_m) < 1e-6 and float(cells["nosing_height_u_mm"]) > 0.0,
    "schema": "nosing_height_m" in with_quantities(schema)["$defs"]["step"]["required"],
    "XLSX": "Nosing height (mm)" in [cell.value for cell in workbook["Steps"][1]],
    "report": "Nosing height" in html_bytes(document).decode() and words in html_bytes(document).decode(),
    "table": words in table_html(inspection, PALETTE, None, "pick", "survey"),
    "card": f"{words} ± " in card_html(inspection, 2, PALETTE) and "nosing height" in card_html(inspection, 2, PALETTE),
    "comparison": "nosing" in comparison_html(compare(inspection, inspection), "a", "b"),
    "sweep": "mean_nosing_height_m" in SWEPT_QUANTITIES,
    "terminal": "nosing_mm" in inspection_text(inspection) and f"{words} ± " in inspection_text(inspection),
    "help": "above the scan's zero" in quantities_text(),
    "hint": "Height of the nosing on the centre line" in table_html(inspection, PALETTE, None, "pick", "survey"),
    "readings": "nosing_height" in STEP_READINGS,
}
print([place for place, is_there in found.items() if not is_there])
"""


@pytest.mark.slow
def test_a_new_quantity_of_a_step_is_added_in_one_place_and_appears_everywhere(tmp_path):
    package = copy_package(tmp_path)
    file = package / "quantities.py"
    before = file.read_text(encoding="utf-8")
    start = '    Quantity(\n        name="two_r_plus_g",'
    assert before.count(start) == 1
    file.write_text(before.replace(start, NEW_QUANTITY.lstrip("\n") + start), encoding="utf-8")
    schema = tmp_path / "static_configs" / "schemas" / "inspection-1.schema.json"
    done = subprocess.run(
        [sys.executable, "-c", SEEN, str(tmp_path), str(schema)],
        env=environment_of(tmp_path, ROOT),
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr


NEW_PART = """
\"\"\"The Greeting tab: says how many steps there are.\"\"\"

import viser

from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.state.change import PageChange


class GreetingPart(PagePart):
    \"\"\"Greets whoever opens a scan.\"\"\"

    title = "Greeting"
    icon = viser.Icon.HAND_STOP
    depends_on = frozenset({PageChange.RESULT})

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self.words = context.widgets.html()

    def show(self, what: frozenset[PageChange]) -> None:
        inspection = self._desk.inspection
        self.words.content = f"Hello, {len(inspection.steps)} steps" if inspection is not None else "Hello"

    def commands(self) -> tuple[Command, ...]:
        return (Command("Say hello", lambda: self._desk.notices.tell("Greeting", "hello")),)
"""
SEEN_OF_PART = """
import sys
from pathlib import Path

import stair_inspector
from stair_inspector.viewer.compute import workshop
from tests.viewer.wire_page import WirePage, await_that, serve


# Computes in this process: to start another one takes seconds.
class Here:
    def run(self, function, *inputs, is_wanted=None):
        return function(*inputs)

    def close(self):
        pass


assert Path(stair_inspector.__file__).parent.parent == Path(sys.argv[1])
workshop.HeavyProcess = Here
app = serve(Path(sys.argv[1]))
page = WirePage(app)
n_steps = len(page.await_result().inspection.steps)
(part,) = [part for part in page.session.parts if part.title == "Greeting"]
{command.label: command.action for command in page.session.commands()}["Say hello"]()
await_that(lambda: "Greeting: hello" in page.told(), "its command does nothing")
print(part.words.content == f"Hello, {n_steps} steps" and n_steps > 0, page.tabs)
page.close()
app.stop()
"""


@pytest.mark.slow
def test_a_new_part_of_the_page_is_one_folder_and_one_line(tmp_path):
    package = copy_package(tmp_path)
    for name in (STAIR, OTHER):
        (tmp_path / name).write_bytes(ply_bytes(Stair(risers=True, noise=0.002).sample()[0]))
    folder = package / "viewer" / "parts" / "greeting"
    folder.mkdir()
    (folder / "__init__.py").write_text("", encoding="utf-8")
    (folder / "part.py").write_text(NEW_PART.lstrip("\n"), encoding="utf-8")
    file = package / "viewer" / "page.py"
    source = file.read_text(encoding="utf-8")
    assert source.count("    LookPart,\n") == 1
    source = source.replace("    LookPart,\n", "    LookPart,\n    GreetingPart,\n")
    # With the import that every name needs.
    name = "from stair_inspector.viewer.parts.judge import Judge\n"
    source = source.replace(name, f"from stair_inspector.viewer.parts.greeting.part import GreetingPart\n{name}")
    file.write_text(source, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", SEEN_OF_PART, str(tmp_path)],
        env=environment_of(tmp_path, ROOT),
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    tabs = ["Scan", "Tune", "Steps", "Checks", "Findings", "Look", "Greeting", "Compare", "Export"]
    assert (done.returncode, done.stdout.strip()) == (0, f"True {tabs}"), done.stderr
