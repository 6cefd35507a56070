"""An inspector's day on the page: tuning with undo, comparing, deciding, looking, measuring and taking away."""

import io
import json
import re
import tomllib
import zipfile

import numpy as np
import pytest
from PIL import Image

from stair_inspector import cli
from stair_inspector.files.project_files import parse_project
from stair_inspector.measured import difference
from stair_inspector.params import Params
from stair_inspector.pictures.cameras import VIEWS
from tests.browser.inspector_page import click_at_once, share_changed, survey_rows_of

SMALL, LARGE = (1280, 720), (2560, 1440)


in_both_windows = pytest.mark.parametrize(
    "page", [pytest.param(SMALL, id="small"), pytest.param(LARGE, id="large", marks=pytest.mark.slow)], indirect=True
)
"""For what is drawn in the scene or pointed at there: the slow run does it in a large window as well."""


@pytest.fixture
def page(page, request):
    """The shared page in a small window, unless the test asks for another."""
    if getattr(request, "param", SMALL) == SMALL:
        yield page
        return
    home = page.home
    page.page.set_viewport_size({"width": LARGE[0], "height": LARGE[1]})
    # The scene has another shape: the view is framed anew once the page has told so.
    page.page.wait_for_function(
        "(home) => Math.hypot(...window.__viserMutable.camera.position.toArray().map((v, k) => v - home[k])) > 0.001",
        arg=home,
    )
    page.home = page.still_camera()
    yield page
    page.page.set_viewport_size({"width": SMALL[0], "height": SMALL[1]})
    page.home, page.is_scene_touched = home, True


def open_folder(page, tab, title, probe):
    """Open a folder of a tab if what it holds cannot be seen, and wait until it lies still."""
    page.tab(tab)
    if not probe.is_visible():
        page.page.get_by_text(re.compile(f"^{title}")).first.click()
    probe.wait_for()
    # While a folder opens, what it holds moves: a click begins on a button and may end beside it.
    page.page.wait_for_function(
        "(element) => !element.closest('[style*=\"will-change\"]')", arg=probe.first.element_handle()
    )


def button(page, name):
    # The head of a folder is a button too, to who cannot see it.
    return page.page.get_by_role("button", name=name, exact=True).and_(page.page.locator("button"))


def row_input(page, label):
    """The field of a text control."""
    name = page.page.get_by_text(label, exact=True).and_(page.page.locator("label")).first
    return name.locator("xpath=ancestor::*[.//input][1]").locator("input").first


def upload(page, name, file_name, content):
    """Choose a file in the dialog that a button opens."""
    with page.page.expect_file_chooser() as waiting:
        button(page, name).click()
    waiting.value.set_files({"name": file_name, "mimeType": "application/octet-stream", "buffer": content})


def shift_click(page, x, y):
    """Click a place of the scene, shares of its width and height, with the Shift key held."""
    box = page.canvas.bounding_box()
    page.page.keyboard.down("Shift")
    page.canvas.click(position={"x": x * box["width"], "y": y * box["height"]})
    page.page.keyboard.up("Shift")


# Tuning.


@pytest.mark.slow
def test_every_change_can_be_undone_and_redone(page):
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94.5/5 %")
    # A drag is one change: it ends when nothing has moved for a while.
    page.page.wait_for_timeout(900)
    page.press("ε_z [mm]", "ArrowRight")
    page.await_result("ε_z 21 mm")
    assert "undo: ε_z 20 mm to 21 mm" in page.text("changes")
    button(page, "Undo").click()
    page.await_result("ε_z 20 mm", "α 94.5/5 %")
    page.hotkey("Control+z")
    page.await_result("ε_z 20 mm", "α 95/5 %")
    assert page.slider_value("paper's α_f [%]") == 95.0
    page.hotkey("Control+Shift+Z")
    page.await_result("α 94.5/5 %")
    page.hotkey("Control+z")
    page.await_result("α 95/5 %")


def test_a_number_that_is_written_measures_at_once_and_can_be_undone(page):
    open_folder(page, "Tune", "More settings", row_input(page, "fewest risers"))
    field = row_input(page, "fewest risers")
    assert field.input_value() == "2"
    # More than the stair has: nothing is left of it.
    field.fill("9")
    told = page.page.get_by_text("No staircase found: ").locator("visible=true")
    told.first.wait_for()
    assert "undo: fewest risers 2 to 9" in page.text("changes")
    button(page, "Undo").click()
    told.first.wait_for(state="detached")
    page.await_result("ε_z 20 mm")
    assert field.input_value() == "2"


@pytest.mark.slow
def test_a_preset_changes_the_settings_and_says_when_they_are_no_longer_its_own(page):
    page.choose("Preset", "Terrestrial laser scanner")
    # The preset states what such a scanner leaves uncertain.
    page.page.wait_for_function("() => document.querySelector('[data-testid=used]')?.innerText.includes('stated')")
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94.5/5 %")
    assert page.page.get_by_label("Preset", exact=True).first.input_value() == "(changed)"


@pytest.mark.slow
def test_a_preset_is_saved_as_a_file_and_loaded_again(page):
    page.press("ε_z [mm]", "ArrowRight", times=3)
    page.await_result("ε_z 23 mm")
    open_folder(page, "Tune", "Preset files", button(page, "Save preset"))
    with page.page.expect_download() as waiting:
        button(page, "Save preset").click()
    with open(waiting.value.path(), "rb") as stream:
        content = stream.read()
    assert waiting.value.suggested_filename == "my_settings.toml"
    assert tomllib.loads(content.decode())["levels"]["eps_m"] == 0.023
    page.press("ε_z [mm]", "Home")
    page.await_result("ε_z 1 mm")
    open_folder(page, "Tune", "Preset files", button(page, "Load preset"))
    upload(page, "Load preset", "mine.toml", content)
    page.await_result("ε_z 23 mm")
    upload(page, "Load preset", "bad.toml", b"[levels]\neps = 3\n")
    assert "did you mean 'eps_m'" in page.await_notification("Not done").replace('"', "'")


@pytest.mark.slow
def test_two_settings_are_compared_step_by_step(page):
    open_folder(page, "Tune", "Compare A / B", button(page, "Keep this result"))
    button(page, "Keep this result").click()
    page.by_id("comparison-table").wait_for()
    page.press("m", "End")
    page.await_result("m 5000")
    text = page.text("comparison")
    assert "A: run 1 · B: what is shown" in " ".join(text.split())
    assert "5000" in text
    assert page.page.get_by_label("Result A", exact=True).first.input_value() == "run 1"
    button(page, "Use its settings").click()
    page.await_result("m 50 ")
    button(page, "Forget it").click()
    page.by_id("comparison-table").wait_for(state="detached")


@pytest.mark.slow
def test_suggested_settings_come_with_reasons_and_find_the_steps(page):
    open_folder(page, "Tune", "Suggest settings", button(page, "Suggest from the scan"))
    button(page, "Suggest from the scan").click()
    items = page.by_id("suggestion").locator("li")
    items.first.wait_for()
    said = items.all_inner_texts()
    assert [item.split()[0] for item in said] == ["θ_th", "ε_z", "m"]
    assert min(len(item) for item in said) > 40
    button(page, "Use these settings").click()
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=changes]')?.innerText.includes('suggested')"
    )
    # Not the result of the settings before, which stays until the new one is there.
    page.await_result(*(" ".join(item.split()[:2]).rstrip("°:") for item in said))
    assert len(page.survey_table()) == 5


@pytest.mark.slow
def test_a_sweep_shows_the_plateau_and_can_be_stopped(page):
    open_folder(page, "Tune", "Sensitivity", button(page, "Sweep over its range"))
    button(page, "Sweep over its range").click()
    page.by_id("sweep").locator("svg").wait_for()
    button(page, "Stop the sweep").click()
    button(page, "Sweep over its range").wait_for()
    assert "ε_z" in page.text("sweep")


@in_both_windows
def test_dragging_over_the_histogram_chooses_eps_z(page):
    page.tab("Tune")
    box = page.by_id("histogram").locator("svg").bounding_box()
    y = box["y"] + box["height"] / 2
    page.page.mouse.move(box["x"] + 0.4 * box["width"], y)
    page.page.mouse.down()
    page.page.mouse.move(box["x"] + 0.43 * box["width"], y, steps=4)
    shown = page.by_id("histogram").locator("[data-reach-text]").text_content()
    wide = page.by_id("histogram").locator("[data-reach]").get_attribute("stroke-width")
    page.page.mouse.up()
    eps_mm = int(re.search(r"(\d+) mm", shown)[1])
    assert eps_mm not in (1, 20, 100)
    assert float(wide) > 5.0
    page.await_result(f"ε_z {eps_mm} mm")
    assert page.slider_value("ε_z [mm]") == eps_mm


# Steps.


@pytest.mark.slow
@in_both_windows
def test_arrow_keys_rows_and_scene_are_one_selection_and_the_card_has_its_pictures(page, measured):
    page.tab("Steps")
    for step in (1, 2, 3):
        page.page.keyboard.press("ArrowUp")
        page.await_selection(step)
    page.page.keyboard.press("ArrowDown")
    page.await_selection(2)
    page.await_node("/stair/segments/selected")
    assert "Step 2" in page.text("card")
    page.by_id("residual-map").locator("image").wait_for()
    assert page.by_id("profile").count() == 1
    page.page.keyboard.press("Escape")
    page.await_selection()


@pytest.mark.slow
def test_flights_fold_and_the_worst_neighbours_are_marked(page, measured):
    inspection = measured()
    flight, step_of = inspection.flights[0], {step.step_id: step for step in inspection.steps}
    for name, statistics in (("rise", flight.rise), ("going", flight.going)):
        lower, upper = (getattr(step_of[step_id], f"{name}_m") for step_id in statistics.at)
        told = difference(upper, lower, share_a_nosing=True)
        rows = page.by_id("steps").locator(f"[data-testid=step-row]:has([data-testid=worst-{name}])")
        wanted = list(statistics.at) if told.value > told.u else []
        assert [int(row.get_attribute("data-step")) for row in rows.all()] == wanted
    page.by_id("fold").first.click()
    page.page.wait_for_function("() => !document.querySelector('[data-testid=step-row]')")
    page.by_id("fold").first.click()
    page.page.wait_for_function("() => document.querySelectorAll('[data-testid=step-row]').length === 5")


@pytest.mark.slow
def test_a_verdict_has_a_reason_and_can_be_undone(page):
    page.click_row(5)
    page.await_selection(5)
    open_folder(page, "Steps", "Overrules", button(page, "Clear overrules"))
    row_input(page, "Reason").fill("a box on the floor")
    page.page.wait_for_timeout(100)
    click_at_once(button(page, "rejected"))
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=used]')?.innerText.includes('(a box on the floor)')"
    )
    page.await_result()
    assert len(page.survey_table()) == 4
    page.hotkey("Control+z")
    page.page.wait_for_function("() => !document.querySelector('[data-testid=used]')?.innerText.includes('overruled')")
    page.await_result()
    assert len(page.survey_table()) == 5


# Looking and measuring.


@pytest.mark.slow
@in_both_windows
def test_standard_views_the_chosen_step_and_the_orthographic_look(page):
    pictures = [page.still_picture()]
    for view in ("Along", "Side"):
        page.show(view)
        pictures.append(page.still_picture(unlike=pictures[-1]))
    page.click_row(3)
    page.await_selection(3)
    page.show("Step")
    pictures.append(page.still_picture(unlike=pictures[-1]))
    far = np.linalg.norm(page.camera())
    page.page.keyboard.press("o")
    page.page.wait_for_function("(far) => window.__viserMutable.camera.position.length() > 3 * far", arg=float(far))
    page.page.keyboard.press("o")
    page.page.keyboard.press("1")
    page.await_camera(page.home)


@pytest.mark.slow
@in_both_windows
def test_a_section_shows_a_slab_and_its_profile(page):
    whole = page.still_picture()
    page.is_scene_touched = True
    page.tab("Look")
    page.page.get_by_label("Section", exact=True).click()
    page.await_node("/stair/section/cloud")
    profile = page.page.locator("[data-testid=profile]:visible")
    profile.wait_for()
    assert "section along the stair, 40 mm thick, in its middle" in profile.inner_text()
    cut = page.still_picture(unlike=whole)
    assert share_changed(whole, cut) > 0.02
    button(page, "Enlarge").click()
    large = page.by_id("large-section")
    large.wait_for()
    width, height = page.page.viewport_size["width"], page.page.viewport_size["height"]
    box = large.bounding_box()
    assert box["width"] > min(1000, 0.7 * width)
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= width
    assert box["y"] + box["height"] <= height
    button(page, "Larger").click()
    page.page.wait_for_function("() => document.querySelector('[data-testid=large-section]')?.dataset.zoom === '2'")
    assert large.evaluate("(element) => element.scrollWidth > 1.9 * element.clientWidth")
    page.page.keyboard.press("Escape")
    large.wait_for(state="detached")
    button(page, "Across").click()
    page.page.wait_for_function(
        "() => [...document.querySelectorAll('[data-testid=profile]')].some((e) => e.innerText.includes('across'))"
    )
    click_at_once(button(page, "Across").locator("xpath=..").get_by_role("button", name="Along"))
    page.page.get_by_label("Section", exact=True).click()
    page.await_node("/stair/section/cloud", there=False)


@pytest.mark.slow
@in_both_windows
def test_points_and_distances_are_measured_listed_named_and_deleted(page, measured):
    inspection = measured()
    page.show("Top")
    page.page.wait_for_timeout(1200)
    page.tab("Look")
    button(page, "Distance").click()
    page.page.wait_for_timeout(150)
    shift_click(page, 0.5, 0.45)
    page.page.wait_for_function("() => document.querySelector('[data-testid=picked]')?.innerText.includes(') m')")
    place = [float(value) for value in re.findall(r"-?\d+\.\d{3}", page.text("picked"))[:3]]
    floor_z = inspection.levels[0].height_m
    assert floor_z - 0.1 < place[2] < floor_z + 1.5
    shift_click(page, 0.5, 0.6)
    rows = page.by_id("measurement-row")
    rows.first.wait_for()
    assert rows.count() == 1
    distance, level, upright = (float(value) for value in re.findall(r"(-?[\d.]+) mm", rows.first.inner_text()))
    assert distance == pytest.approx(np.hypot(level, upright), abs=0.11)
    page.await_node("/stair/measured/lines")
    page.hotkey("u")
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=measurement-row]')?.innerText.includes(' in')"
    )
    page.page.keyboard.press("u")
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=measurement-row]')?.innerText.includes(' mm')"
    )
    open_folder(page, "Look", "Rename", button(page, "Rename it"))
    row_input(page, "New name").fill("clear width <b>")
    page.page.wait_for_timeout(100)
    button(page, "Rename it").click()
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=measurement-row]')?.innerText.includes('clear width <b>')"
    )
    click_at_once(rows.first.locator("[data-order=delete]"))
    rows.first.wait_for(state="detached")
    page.await_node("/stair/measured/lines", there=False)
    page.hotkey("Control+z")
    rows.first.wait_for()
    click_at_once(rows.first.locator("[data-order=delete]"))
    rows.first.wait_for(state="detached")
    button(page, "Off").click()


@pytest.mark.slow
def test_inches_are_shown_with_fractions_and_change_no_number(page, measured):
    before = page.survey_table()
    assert len(before) == len(survey_rows_of(measured()))
    page.tab("Steps")
    page.show("in")
    page.page.wait_for_function(
        "() => document.querySelector('[data-testid=steps-table]')?.innerText.match(/\\d \\d+\\/(2|4|8|16)/)"
    )
    page.show("mm")
    page.page.wait_for_function("() => !document.querySelector('[data-testid=steps-table]')?.innerText.includes('/16')")
    assert page.survey_table() == before


@pytest.mark.slow
@in_both_windows
def test_colours_tell_height_normals_and_residuals_with_a_legend(page):
    pictures = {"Step": page.still_picture()}
    page.tab("Scan")
    for mode, words in (
        ("Height", "height"),
        ("Residual", "[mm]"),
        ("Normal", ""),
        ("Original", "colours of the scan"),
    ):
        page.choose("Colour by", mode)
        page.page.wait_for_function(
            "(words) => document.querySelector('[data-testid=color-legend]')?.innerText.includes(words)", arg=words
        )
        pictures[mode] = page.still_picture()
    names = list(pictures)
    for k, first in enumerate(names):
        for second in names[k + 1 :]:
            assert share_changed(pictures[first], pictures[second]) > 0.02, (first, second)
    page.choose("Colour by", "Step")
    page.page.wait_for_function("() => !document.querySelector('[data-testid=color-legend]')")
    page.page.get_by_label("Shade edges").click()
    assert share_changed(pictures["Step"], page.still_picture(unlike=pictures["Step"])) > 0.005
    page.page.get_by_label("Shade edges").click()


@pytest.mark.slow
def test_keys_are_listed_and_commands_are_found(page):
    page.hotkey("h")
    page.by_id("help").wait_for()
    card = page.text("help")
    assert [word for word in ("Ctrl+Z", "Shift+click", "Ctrl+K", "Section on or off") if word not in card] == []
    button(page, "Close").click()
    page.by_id("help").wait_for(state="detached")
    page.page.keyboard.press("Control+k")
    page.page.get_by_placeholder(re.compile("", re.I)).last.wait_for()
    page.page.keyboard.type("side by")
    page.page.get_by_text("Raw and steps side by side").wait_for()
    page.page.keyboard.press("Escape")


# The scan.


@pytest.mark.slow
@in_both_windows
def test_up_is_taken_from_the_treads_and_the_region_is_a_box_that_can_be_undone(page):
    page.tab("Scan")
    button(page, "Take the treads").click()
    page.await_notification("Up corrected")
    page.await_result(") given")
    page.hotkey("Control+z")
    page.await_result(") floor")
    open_folder(page, "Scan", "Region of interest", button(page, "Around the stair"))
    button(page, "Around the stair").click()
    page.page.wait_for_function("() => document.querySelector('[data-testid=used]')?.innerText.includes('region')")
    page.await_result()
    page.await_node("/stair/region/edges")
    page.await_node("/stair/region/high")
    assert len(page.survey_table()) == 5
    page.hotkey("Control+z")
    page.page.wait_for_function("() => !document.querySelector('[data-testid=used]')?.innerText.includes('region')")
    page.await_result()
    page.page.get_by_label("Show the box").click()
    page.await_node("/stair/region/edges", there=False)


@pytest.mark.slow
@in_both_windows
def test_up_from_three_floor_points(page):
    page.show("Top")
    page.page.wait_for_timeout(1200)
    page.tab("Scan")
    button(page, "Pick 3 floor points").click()
    page.page.wait_for_function("() => document.querySelector('[data-testid=up-hint]')?.innerText.includes('0 of 3')")
    # The floor in front of the stair fills the lower end of the view from above.
    picture = page.picture()
    rows, columns = np.nonzero(np.abs(picture - np.array((150, 152, 158))).max(axis=2) < 12)
    height, width = picture.shape[:2]
    low, high = np.percentile(rows, [30, 90])
    left, right = np.percentile(columns, [15, 85])
    for count, (x, y) in enumerate(((left, low), (right, low), ((left + right) / 2, high)), start=1):
        shift_click(page, x / width, y / height)
        if count < 3:
            page.page.wait_for_function(
                "(words) => document.querySelector('[data-testid=up-hint]')?.innerText.includes(words)",
                arg=f"{count} of 3",
            )
    page.await_result(") given")
    up = [float(value) for value in re.search(r"up \(([^)]*)\)", page.text("used"))[1].split(",")]
    assert up[2] > 0.995
    page.hotkey("Control+z")
    page.await_result(") floor")


@pytest.mark.slow
def test_an_uploaded_scan_is_measured_and_what_is_no_scan_is_refused(page, scans, measured):
    page.tab("Scan")
    # A second upload of the same name gets another one, and the server keeps those of all pages.
    name = f"my stair {page.page.viewport_size['width']}.ply"
    upload(page, "Upload a scan", name, scans[1].read_bytes())
    page.page.locator("[data-testid=scan]", has_text=name).wait_for()
    page.await_result()
    assert len(page.survey_table()) == 3
    page.close_notifications()
    upload(page, "Upload a scan", "virus.exe", b"MZ")
    assert "is no scan by its name" in page.await_notification("Not done")
    page.page.wait_for_timeout(300)
    assert page.page.get_by_text("uploaded successfully").count() == 0
    page.close_notifications()


# Taking away.


@pytest.mark.slow
@in_both_windows
def test_a_picture_has_its_legend_and_either_background(page):
    page.tab("Export")
    row_input(page, "Title").fill("Hall B")
    page.page.wait_for_timeout(150)
    page.choose("Size", "screen")
    sizes = set()
    for ground, alpha in (("White", 255), ("Transparent", 0)):
        page.choose("Background", ground)
        _, content = page.download("Screenshot PNG")
        image = Image.open(io.BytesIO(content)).convert("RGBA")
        pixels = np.asarray(image)
        assert pixels[2, 2, 3] == alpha
        assert (pixels[..., 3] > 0).mean() > 0.03
        sizes.add(image.size)
    assert len(sizes) == 1
    page.choose("Background", "White")
    page.choose("Size", "2 ×")
    row_input(page, "Title").fill("")


@pytest.mark.slow
@in_both_windows
def test_all_standard_views_are_one_zip(page):
    page.tab("Export")
    page.choose("Size", "screen")
    name, content = page.download("All views ZIP", timeout_ms=100_000)
    assert name == "stair_views.zip"
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert archive.namelist() == [f"stair_{view.lower()}.png" for view in VIEWS]
        pictures = [
            np.asarray(Image.open(io.BytesIO(archive.read(name))).convert("RGB")) for name in archive.namelist()
        ]
    assert all(picture.std() > 5 for picture in pictures)
    page.choose("Size", "2 ×")


@pytest.mark.slow
def test_the_project_reproduces_its_numbers_on_the_command_line(page, scans, tmp_path):
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94.5/5 %")
    name, content = page.download("Project file")
    assert name == "stair.stair.json"
    assert parse_project(content, name).params == Params().replaced("edges.front_percentile", 94.5)
    _, wanted = page.download("JSON")
    (tmp_path / name).write_bytes(content)
    assert cli.main(["measure", str(scans[0]), "--project", str(tmp_path / name), "-o", str(tmp_path / "out")]) == 0
    made = json.loads((tmp_path / "out" / "stair.json").read_text())
    wanted = json.loads(wanted)
    for key in ("settings", "steps", "flights", "up", "levels"):
        assert made[key] == wanted[key], key
    # Opened again, it brings its settings back; another scan's is refused.
    page.press("paper's α_f [%]", "ArrowLeft")
    page.await_result("α 94/5 %")
    page.tab("Export")
    upload(page, "Open project", name, content)
    page.await_result("α 94.5/5 %")
    other = json.loads(content)
    other["scan"]["sha256"] = "0" * 64
    upload(page, "Open project", "other.stair.json", json.dumps(other).encode())
    assert "is not the scan of the project" in page.await_notification("Not done")
