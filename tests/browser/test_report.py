"""A report made from the page, read back: what was measured, judged and written stands in it."""

import io
import json
import re
import zipfile

import ezdxf
import openpyxl
import pypdf
import pytest
from PIL import Image

from stair_inspector.codes import check
from stair_inspector.content.images import read_logo
from stair_inspector.content.project_basis import basis_of
from stair_inspector.errors import ConfigError
from stair_inspector.files.project_files import parse_project
from stair_inspector.files.rule_sets import find_rule_set
from stair_inspector.viewer.parts.export import scene_views
from stair_inspector.writers.csv import csv_bytes
from tests.browser.inspector_page import THROTTLE_MS, click_at_once
from tests.browser.test_checks import NO_RULES, SHARED, choose_rules, label_of
from tests.browser.test_layout import check as check_layout
from tests.browser.test_workspace import LARGE, button, open_folder, row_input, upload

MAKING_MS = 120_000
"""Longest wait for a report: six views in software rendering."""
ENDINGS = (
    "_report.pdf",
    "_report.html",
    "_report.xlsx",
    "_plan.dxf",
    "_section.dxf",
    ".csv",
    ".json",
    ".manifest.json",
)
HOSTILE = "Hall <b>&</b> #panic() =1+1"
FIELDS = "Who, where, with what"


@pytest.fixture
def page(page):
    """The shared page; afterwards without rules and with an empty report."""
    yield page
    choose_rules(page, NO_RULES, "")
    page.tab("Export")
    if page.by_id("reading-row").count():
        click_at_once(page.by_id("reading-row").first.locator("[data-order=delete]"))
        page.by_id("reading-row").first.wait_for(state="detached")
    page.close_notifications()


def words_of(pdf):
    """All text of a PDF on one line."""
    text = " ".join(each.extract_text() for each in pypdf.PdfReader(io.BytesIO(pdf)).pages)
    return re.sub(r"\s+", " ", text.replace("\u200b", "").replace("\u00ad", ""))


def write(page, label, words):
    row_input(page, label).fill(words)
    page.page.wait_for_timeout(THROTTLE_MS)


def open_fields(page, group):
    # The table below the scene has a button of the same name.
    folder = page.page.locator("[data-dock-root]").get_by_text(group, exact=True).last
    open_folder(page, "Export", FIELDS, folder)
    field = {"Object": "Client", "Survey": "Firm"}[group]
    if not page.page.get_by_text(field, exact=True).and_(page.page.locator("label")).first.is_visible():
        folder.click()
    row_input(page, field).wait_for()


def add_reading(page, place, quantity, value):
    open_folder(page, "Export", "Readings by hand", button(page, "Add the reading"))
    page.choose("At", place)
    page.choose("What is read", quantity)
    write(page, "Reading", value)
    button(page, "Add the reading").click()


@pytest.mark.slow
def test_one_click_gives_every_file_with_what_was_measured_judged_and_written(page, measured):
    choose_rules(page, label_of(SHARED), SHARED)
    camera = page.still_camera()
    open_fields(page, "Object")
    write(page, "Client", HOSTILE)
    add_reading(page, "step 2", "rise", "171.5")
    page.by_id("reading-row").wait_for()
    inspection = measured()
    rise = inspection.steps[1].rise_m
    assert f"{171.5 - 1000.0 * rise.value:.1f}" in page.text("readings")
    page.tab("Export")
    button(page, "Full").click()
    name, content = page.download("Report", timeout_ms=MAKING_MS)
    assert name == "stair_report.zip"
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        files = {each: archive.read(each) for each in archive.namelist()}
    assert set(files) == {f"stair{ending}" for ending in ENDINGS}
    found = check(inspection, find_rule_set(SHARED))
    said = words_of(files["stair_report.pdf"])
    for step in inspection.steps:
        assert f"{1000.0 * step.rise_m.value:.1f} ± " in said
    for words in (inspection.scan.sha256, found.rule_set.sha256, found.rule_set.set_id, "171.5", "by hand"):
        assert words in said
    assert HOSTILE in said
    assert "drawn by the program" not in said
    assert len(pypdf.PdfReader(io.BytesIO(files["stair_report.pdf"])).pages[0].images) == 2
    # The same numbers everywhere.
    assert json.loads(files["stair.json"])["check"]["rule_set"]["id"] == SHARED
    assert files["stair.csv"] == csv_bytes(inspection)
    html = files["stair_report.html"].decode()
    assert "Hall &lt;b&gt;&amp;&lt;/b&gt;" in html
    assert "<b>&</b>" not in html
    book = openpyxl.load_workbook(io.BytesIO(files["stair_report.xlsx"]))
    numbers = [cell.value for sheet in book for row in sheet.iter_rows() for cell in row]
    assert any(isinstance(each, float) and abs(each - 1000.0 * rise.value) < 1e-4 for each in numbers)
    for kind in ("plan", "section"):
        drawing = ezdxf.read(io.StringIO(files[f"stair_{kind}.dxf"].decode()))
        assert not drawing.audit().errors
    # The scene is again as it was.
    page.await_node("/stair/segments/outside")
    page.await_camera(camera)


@pytest.mark.slow
def test_what_is_written_is_kept_in_the_project_undone_and_taken_up_again(page):
    open_fields(page, "Survey")
    write(page, "Firm", "Alder & Finch")
    add_reading(page, "flight 1", "total rise", "33 7/16")
    assert "is no number" not in "".join(page.notifications())
    page.by_id("reading-row").wait_for()
    name, content = page.download("Project file")
    basis = basis_of(parse_project(content, name))
    assert basis.fields.firm == "Alder & Finch"
    assert [(each.quantity, each.flight, each.value) for each in basis.readings] == [("flight_rise", 1, 0.0334375)]
    page.hotkey("Control+z")
    page.by_id("reading-row").wait_for(state="detached")
    page.hotkey("Control+z")
    page.page.wait_for_function("(input) => input.value === ''", arg=row_input(page, "Firm").element_handle())
    page.tab("Export")
    upload(page, "Open project", name, content)
    page.page.wait_for_function(
        "(input) => input.value === 'Alder & Finch'", arg=row_input(page, "Firm").element_handle()
    )
    page.hotkey("Control+z")
    add_reading(page, "step 1", "rise", "a lot")
    assert "is no number" in page.await_notification("Not done")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["PDF", "HTML", "XLSX", "Plan DXF", "Section DXF"])
def test_each_file_can_be_had_by_itself(page, kind):
    starts = {"PDF": b"%PDF", "HTML": b"<!doctype html>", "XLSX": b"PK", "Plan DXF": b"  0", "Section DXF": b"  0"}
    page.tab("Export")
    page.page.get_by_label("Views of this scene").uncheck()
    try:
        name, content = page.download(kind, timeout_ms=MAKING_MS)
    finally:
        page.page.get_by_label("Views of this scene").check()
    assert name.startswith("stair_")
    assert content[:15].lower().startswith(starts[kind].lower())


@pytest.mark.slow
def test_where_the_page_does_not_deliver_the_report_says_who_drew_its_views(page, monkeypatch):
    def silent(*_):
        raise ConfigError("screenshot: the page did not deliver the picture")

    monkeypatch.setattr(scene_views, "studio", silent)
    page.tab("Export")
    _, content = page.download("PDF", timeout_ms=MAKING_MS)
    said = words_of(content)
    assert "drawn by the program, not taken of the scene: the page did not deliver its pictures in time" in said
    assert "no rule set was applied" in said


@pytest.mark.slow
def test_making_can_be_cancelled_and_the_scene_comes_back(page):
    page.tab("Export")
    before = page.still_picture()
    button(page, "Report").click()
    page.page.get_by_role("button", name="Cancel", exact=True).first.click()
    assert "cancelled" in page.await_notification("Not done")
    page.await_result()
    page.close_notifications()
    page.page.wait_for_timeout(3000)
    after = page.still_picture()
    assert (abs(after - before).max(axis=2) > 24).mean() < 0.001


@pytest.mark.slow
def test_a_logo_is_shown_kept_and_removed_and_what_is_none_is_refused(page):
    stream = io.BytesIO()
    Image.new("RGB", (60, 20), (10, 90, 160)).save(stream, "PNG")
    open_folder(page, "Export", "Logo", button(page, "Load a logo"))
    upload(page, "Load a logo", "logo.png", b"not a picture")
    assert "is not a PNG or JPEG picture" in page.await_notification("Not done")
    page.close_notifications()
    upload(page, "Load a logo", "logo.png", stream.getvalue())
    page.by_id("logo").locator("img").wait_for()
    name, content = page.download("Project file")
    assert basis_of(parse_project(content, name)).logo == read_logo(stream.getvalue())
    button(page, "Remove the logo").click()
    page.by_id("logo").locator("img").wait_for(state="detached")


_BROKEN_WORDS = """(element) => {
    const broken = [];
    const walker = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
        for (const word of walker.currentNode.data.matchAll(/\\S+/g)) {
            const range = document.createRange();
            range.setStart(walker.currentNode, word.index);
            range.setEnd(walker.currentNode, word.index + word[0].length);
            if (range.getClientRects().length > 1) broken.push(word[0]);
        }
    }
    return broken;
}"""
"""Words of an element that stand on more than one line."""


@pytest.mark.slow
def test_readings_are_listed_without_a_break_in_a_word_or_figure_in_either_unit(open_page):
    page = open_page()
    add_reading(page, "step 2", "nosing overhang", "-1210.5")
    page.by_id("reading-row").first.wait_for()
    add_reading(page, "step 1", "rise", "171.5 mm")
    page.by_id("reading-row").nth(1).wait_for()
    add_reading(page, "flight 1", "total run", "1910")
    page.by_id("reading-row").nth(2).wait_for()
    for unit, words in (("mm", "1910.0 mm"), ("in", "75 3/16 in")):
        button(page, unit).first.click()
        page.page.wait_for_function(
            "(words) => document.querySelector('[data-testid=readings]').innerText.includes(words)", arg=words
        )
        assert page.by_id("readings").evaluate(_BROKEN_WORDS) == []
        cells = (
            page.by_id("reading-row")
            .locator("td")
            .evaluate_all("(cells) => cells.map((cell) => cell.scrollWidth <= cell.clientWidth)")
        )
        assert all(cells)


@pytest.mark.slow
def test_the_menus_offer_what_fits_the_place(page):
    open_folder(page, "Export", "Readings by hand", button(page, "Add the reading"))
    page.choose("At", "flight 1")
    page.choose("What is read", "pitch")
    page.choose("Unit", "deg")
    page.page.get_by_text("On the line", exact=True).wait_for(state="detached")
    page.choose("At", "step 1")
    page.choose("What is read", "rise")
    page.choose("Unit", "mm")
    page.choose("On the line", "left")
    page.choose("On the line", "centre")


@pytest.mark.slow
@pytest.mark.parametrize("size", [None, LARGE], ids=["small", "large"])
def test_the_tab_fits_light_and_dark_with_everything_open(open_page, size):
    page = open_page() if size is None else open_page(width=size[0], height=size[1])
    open_fields(page, "Object")
    add_reading(page, "step 2", "rise", "171.5")
    page.by_id("reading-row").wait_for()
    open_folder(page, "Export", "Seen on site", page.page.get_by_text("Headroom", exact=True))
    open_folder(page, "Export", "Logo", button(page, "Load a logo"))
    check_layout(page)
    page.tab("Export")
    wide, room = page.by_id("readings").evaluate("(element) => [element.scrollWidth, element.clientWidth]")
    assert wide <= room
    page.set_dark(True)
    check_layout(page)
