"""What goes in and out: scans to choose from, files to download."""

import csv
import io
import json

import jsonschema
import numpy as np
import pytest
import trimesh
from PIL import Image

from stair_inspector.files.palettes import read_palette
from stair_inspector.files.paths import static_configs
from tests.browser.conftest import HOSTILE_NAME
from tests.browser.inspector_page import SCENE_SHARPNESS, rows_of


def shown(value, scale=1.0, digits=1):
    return "–" if value in (None, "") else f"{scale * float(value):.{digits}f}"


def step_rows(page):
    return [row for row in page.table() if row[0] != "floor"]


def test_the_csv_says_what_the_table_says(page):
    page.choose_columns("paper")
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94.5/5 %")
    name, content = page.download("CSV")
    assert name == "stair.csv"
    rows = list(csv.DictReader(io.StringIO(content.decode("utf-8-sig"))))
    table = step_rows(page)
    assert len(rows) == len(table) == 5
    for row, cells in zip(rows, table, strict=True):
        lengths = [shown(row[name]) for name in ("paper_h_mm", "paper_d_fb_mm", "paper_d_ff_mm", "paper_w_mm")]
        assert [row["step"], *lengths, shown(row["paper_theta_deg"], digits=2)] == cells[:6]


@pytest.mark.slow
def test_the_json_is_valid_and_says_what_the_table_says(page):
    page.choose_columns("paper")
    name, content = page.download("JSON")
    assert name == "stair.json"
    document = json.loads(content)
    schema = json.loads((static_configs() / "schemas" / "inspection-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.validate(document, schema)
    table = step_rows(page)
    for step, cells in zip(document["steps"], table, strict=True):
        paper = step["paper"]
        lengths = [shown(paper[name], 1000.0) for name in ("h_m", "d_fb_m", "d_ff_m", "w_m")]
        assert [str(step["id"]), *lengths, shown(paper["theta_deg"], digits=2)] == cells[:6]


@pytest.mark.slow
def test_the_debug_ply_opens_and_has_all_points(page, measured):
    name, content = page.download("Debug PLY")
    assert name == "stair_debug.ply"
    cloud = trimesh.load(io.BytesIO(content), file_type="ply")
    inspection = measured()
    assert len(cloud.vertices) >= inspection.scan.n_used
    scan_colors = np.asarray(cloud.colors)[: inspection.scan.n_used, :3]
    for step in inspection.steps:
        own = scan_colors[inspection.labels == step.step_id]
        # The points around the centre are drawn in a colour of their own.
        in_color = (own == np.array(read_palette("paper").of_step(step.step_id))).all(axis=1)
        assert in_color.sum() == step.plane.n_points - len(step.nearest_ids)


@pytest.mark.slow
def test_the_screenshot_opens_and_shows_the_steps(page):
    page.show("Home")
    name, content = page.download("Screenshot PNG")
    assert name == "stair.png"
    image = Image.open(io.BytesIO(content))
    box = page.canvas.bounding_box()
    assert image.format == "PNG"
    # Twice as large as the scene is drawn, and what is written on it stands above and below.
    assert image.width == pytest.approx(2 * SCENE_SHARPNESS * box["width"], abs=3)
    assert image.height > 2 * SCENE_SHARPNESS * box["height"]
    pixels = np.asarray(image.convert("RGB")).astype(int)
    for color in read_palette("page").steps[:5]:
        assert (np.abs(pixels - np.array(color)).max(axis=2) <= 6).mean() > 0.0005, color
    assert (pixels[:5] == 255).all(), "the paper is white"


def test_another_scan_is_measured_and_its_name_is_text_even_if_it_looks_like_html(page, measured):
    page.choose_columns("paper")
    page.tab("Scan")
    page.open_scan(HOSTILE_NAME)
    page.page.locator("[data-testid=scan]", has_text="<img").wait_for()
    page.await_result()
    assert page.table() == rows_of(measured(index=3))
    assert len(step_rows(page)) == 3
    assert page.text("scan").startswith(HOSTILE_NAME)
    assert page.by_id("scan").locator("img").count() == 0
    assert page.page.evaluate("() => window.struck") is None
    # The browser makes a file name of it that the system allows.
    name, content = page.download("JSON")
    assert name.endswith(".json")
    assert json.loads(content)["scan"]["file"] == HOSTILE_NAME


@pytest.mark.slow
def test_a_broken_scan_is_a_sentence_and_the_good_one_works_again(page, measured):
    page.choose_columns("paper")
    page.tab("Scan")
    page.open_scan("broken.ply")
    sentence = page.await_error()
    assert "broken.ply" in sentence
    assert len(sentence) < 400
    # Nothing of the first scan is left: what is done on the page is done to the one that is named.
    assert page.text("scan").startswith("broken.ply")
    assert step_rows(page) == []
    assert "/stair/raw" not in page.scene()
    page.open_scan("stair.ply")
    page.await_result("θ_th 15°")
    assert not page.is_stale()
    assert page.table() == rows_of(measured())


@pytest.mark.slow
def test_scans_are_opened_from_their_list_by_mouse_and_by_key(page):
    page.tab("Scan")
    row = page.page.locator("[data-testid=scan-row][data-scan='stair.ply']")
    row.locator("img").wait_for()
    assert row.get_attribute("aria-current") == "true"
    assert "points" in row.inner_text()
    row.focus()
    row.press("ArrowDown")
    page.page.keyboard.press("Enter")
    page.page.locator("[data-testid=scan]", has_text="other.ply").wait_for()
    page.await_result()
    page.page.locator("[data-testid=scan-row][data-scan='other.ply'][data-state=measured]").wait_for()
    assert page.page.evaluate("() => document.activeElement.dataset.scan") == "other.ply"
    # What was found out about the first stays.
    assert "points" in row.inner_text()
