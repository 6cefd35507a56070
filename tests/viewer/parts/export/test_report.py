"""What an inspector writes for the report: kept as written, refused in a sentence, deleted where it was meant."""

import dataclasses
import io
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from stair_inspector.codes.limits import LENGTH_UNITS
from stair_inspector.content.cross_checks import readings_table
from stair_inspector.content.images import read_photo
from stair_inspector.content.readings import STEP_READINGS
from stair_inspector.content.texts import LONGEST_TEXT
from stair_inspector.errors import ConfigError
from stair_inspector.viewer.bridge.markup import list_key
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import OTHER, SETTLE_S, STAIR, await_that

RISE, TOTAL_RISE, FALL = "rise", "total rise", "fall to the nosing"


def write(page, control, value):
    """Set a control as a browser does."""
    page._send({"type": "GuiUpdateMessage", "uuid": control._impl.uuid, "updates": {"value": value}})


def choose(page, control, value):
    """Choose of a menu, and wait for what that changes of other menus, which happens on another thread."""
    if control.value == value:
        return
    own, failures, done = control._impl.update_cb, [], threading.Event()

    def call_them(event):
        try:
            for callback in own:
                callback(event)
        except Exception as error:  # noqa: BLE001 - whatever it is, it fails the test
            failures.append(error)
        finally:
            done.set()

    control._impl.update_cb = [call_them]
    try:
        write(page, control, value)
        assert done.wait(SETTLE_S), f"{value} was not chosen"
    finally:
        control._impl.update_cb = own
    assert (failures, control.value) == ([], value)


def add(page, place, quantity, value, u=""):
    folder = part_of(page.session, "export").report
    choose(page, folder.place, place)
    choose(page, folder.quantity, quantity)
    folder.value.value, folder.u.value = value, u
    part_of(page.session, "export").report.add_reading()


def readings(page):
    return page.session.editor.work.basis.readings


def told(page, words):
    await_that(lambda: any(words in each for each in page.told()), f"{words} is not said: {page.told()}")


def test_a_reading_counts_in_the_unit_that_is_written_with_it(page):
    folder = part_of(page.session, "export").report
    add(page, "step 2", RISE, "170.5")
    folder.unit.value = "in"
    add(page, "step 2", RISE, "7 9/16")
    add(page, "step 2", RISE, "170.5 mm", "1 mm")
    assert [reading.value for reading in readings(page)] == pytest.approx([0.1705, 0.1920875, 0.1705], rel=1e-12)
    assert readings(page)[2].u == pytest.approx(0.001)


@pytest.mark.parametrize(
    ("menu", "written", "u", "value_mm", "u_mm"),
    [
        ("mm", "6 3/4 in", "1/16", 171.45, 1.5875),
        ("in", "170.5 mm", "1", 170.5, 1.0),
        ("in", "170.5 mm", "1/16 in", 170.5, 1.5875),
        ("in", "170.5 mm", '1/16"', 170.5, 1.5875),
        ("in", "6 3/4", "1 mm", 171.45, 1.0),
        ("in", "6 3/4", "1/16", 171.45, 1.5875),
    ],
)
def test_u_is_in_the_unit_of_its_reading_unless_it_has_one_of_its_own(page, menu, written, u, value_mm, u_mm):
    choose(page, part_of(page.session, "export").report.unit, menu)
    add(page, "step 2", RISE, written, u)
    (reading,) = readings(page)
    assert 1000.0 * reading.value == pytest.approx(value_mm, rel=1e-9)
    assert 1000.0 * reading.u == pytest.approx(u_mm, rel=1e-9)


def test_u_of_a_slope_that_is_written_in_degrees_is_in_degrees(page):
    folder = part_of(page.session, "export").report
    choose(page, folder.place, "step 2")
    choose(page, folder.quantity, FALL)
    choose(page, folder.unit, "%")
    add(page, "step 2", FALL, "1.2°", "0.1")
    (reading,) = readings(page)
    assert (reading.value, reading.u) == pytest.approx((1.2, 0.1))


def test_the_place_of_a_reading_is_that_of_its_tread_in_the_scans_own_frame(page, monkeypatch):
    desk = page.session.desk
    inspection, origin = desk.inspection, (455123.0, 5412345.0, 310.0)
    on_a_map = dataclasses.replace(inspection, scan=dataclasses.replace(inspection.scan, origin_m=origin))
    monkeypatch.setattr(desk, "shown", dataclasses.replace(desk.shown, inspection=on_a_map))
    add(page, "step 2", RISE, "171", "1")
    (reading,) = readings(page)
    assert reading.at == pytest.approx(inspection.steps[1].plane.centroid + np.array(origin), abs=1e-6)
    (row,) = readings_table(on_a_map, page.session.editor.work.basis).rows
    assert row[0] == "step 2"


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ("-170", "reading: got -170 mm; give a number above 0"),
        ("0", "reading: got 0 mm; give a number above 0"),
        ("170,5", "reading: got '170,5'; write a point, not a comma"),
        ("", "reading: write what was read, such as 170.5"),
    ],
)
def test_a_reading_that_cannot_be_is_refused_as_it_was_written(page, written, words):
    with pytest.raises(ConfigError) as caught:
        add(page, "step 2", RISE, written)
    assert str(caught.value).startswith(words)
    assert readings(page) == ()


def test_the_menus_offer_what_can_be_read_at_the_place_and_in_which_units(page):
    folder = part_of(page.session, "export").report
    assert len(folder.quantity.options) == len(STEP_READINGS)
    assert folder.line.visible
    choose(page, folder.place, "flight 1")
    assert folder.quantity.options == (TOTAL_RISE, "total run", "tread width", "pitch")
    assert folder.quantity.value == TOTAL_RISE
    assert not folder.line.visible
    choose(page, folder.quantity, "pitch")
    assert folder.unit.options == ("deg", "%")
    choose(page, folder.place, "step 3")
    assert folder.quantity.value == "pitch"
    choose(page, folder.quantity, RISE)
    # The unit that was chosen for lengths is chosen again.
    assert (folder.unit.options, folder.unit.value) == (LENGTH_UNITS, "mm")
    assert folder.line.visible


def test_a_line_that_was_chosen_for_a_rise_does_not_stand_in_the_way_of_a_width(page):
    part_of(page.session, "export").report.line.value = "left"
    add(page, "step 2", "tread width", "1000")
    add(page, "flight 1", TOTAL_RISE, "660")
    assert [reading.line for reading in readings(page)] == ["centre", "centre"]


def test_a_second_click_on_a_cross_deletes_nothing_else(page):
    for value in ("171", "172", "173"):
        add(page, "step 2", RISE, value)
    key = list_key(readings(page))
    part_of(page.session, "export").report.obey(f"delete {key} 1:1")
    with pytest.raises(ConfigError, match="the list has changed since"):
        part_of(page.session, "export").report.obey(f"delete {key} 1:2")
    assert [reading.value for reading in readings(page)] == pytest.approx([0.172, 0.173])
    part_of(page.session, "export").report.obey(f"delete {list_key(readings(page))} 2:3")
    assert [reading.value for reading in readings(page)] == pytest.approx([0.172])


@pytest.mark.parametrize(
    "message", ["", "delete", "delete 1", "delete x 1:1", "drop 1 1", "delete 1 99999999", "x" * 99]
)
def test_a_hostile_order_is_a_sentence(page, message):
    add(page, "step 2", RISE, "171")
    for order in (message, f"delete {list_key(readings(page))}", f"delete {list_key(readings(page))} x"):
        with pytest.raises(ConfigError, match=r"^(list|readings): "):
            part_of(page.session, "export").report.obey(order)
    assert len(readings(page)) == 1


def test_a_button_of_the_list_deletes_its_reading(page):
    add(page, "step 2", RISE, "171")
    uuid, order = part_of(page.session, "export").report._orders, f"delete {list_key(readings(page))} 1:17"
    page._send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": order}})
    await_that(lambda: not readings(page), "the reading is still there")


def test_readings_are_listed_in_the_pages_unit_and_kept_in_millimetres(page):
    session = page.session
    add(page, "step 2", RISE, '7 9/16"')
    listed = part_of(session, "export").report.readings
    assert "192.1 mm" in listed.content
    session.desk.set_unit("in")
    assert "7 9/16 in" in listed.content
    assert "mm" not in listed.content
    assert readings_table(session.desk.inspection, session.editor.work.basis).rows[0][3].value == pytest.approx(
        192.0875
    )


def test_kept_readings_are_not_denied_while_their_scan_is_opened_again(page):
    session = page.session
    add(page, "step 2", RISE, "171")
    part_of(session, "scan").choose(OTHER)
    page.await_result(OTHER)
    with session.desk.lock:
        part_of(session, "scan").choose(STAIR)
        assert "1 reading is kept" in part_of(session, "export").report.readings.content
    page.await_result(STAIR)
    await_that(lambda: "171.0 mm" in part_of(session, "export").report.readings.content, "the reading is not listed")


def test_a_reading_is_kept_with_the_place_of_its_tread(page):
    add(page, "step 3", RISE, "165", "1")
    add(page, "flight 1", TOTAL_RISE, "660")
    step = next(step for step in page.session.desk.inspection.steps if step.step_id == 3)
    origin_m = page.session.desk.inspection.scan.origin_m
    assert readings(page)[0].at == pytest.approx(tuple(step.plane.centroid + np.array(origin_m)))
    assert readings(page)[1].at is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x" * (LONGEST_TEXT + 1), "Client: 4,001 characters; give at most 4,000"),
        ("Alder \u202ehcniF", "a mark that turns the direction of reading, '\\u202e'; take it out"),
        ("Alder\x07", "Client: holds a control character"),
    ],
)
def test_a_text_that_is_refused_goes_and_the_one_before_stands_again(page, text, words):
    control = part_of(page.session, "export").report._texts["fields", "client"]
    write(page, control, "Alder & Finch")
    await_that(lambda: page.session.editor.work.basis.fields.client == "Alder & Finch", "the text is not kept")
    write(page, control, text)
    told(page, words)
    await_that(lambda: control.value == "Alder & Finch", "the box shows what is not kept")
    assert page.session.editor.work.basis.fields.client == "Alder & Finch"


def test_a_title_that_turns_the_reading_is_refused(page):
    title = part_of(page.session, "export").title_field
    write(page, title, "Hall")
    await_that(lambda: page.session.editor.work.title == "Hall", "the title is not kept")
    write(page, title, "Hall \u202ehtuos")
    told(page, "Title: holds a control character, half a letter or a mark that turns the direction of reading")
    await_that(lambda: title.value == "Hall", "the box shows what is not kept")


def test_a_date_that_is_no_day_is_kept_and_remarked_on(page):
    texts = part_of(page.session, "export").report._texts
    write(page, texts["fields", "survey_date"], "32.13.2026")
    told(page, "Survey date: '32.13.2026' is no day of the calendar; it stays as it is written.")
    assert page.session.editor.work.basis.fields.survey_date == "32.13.2026"
    write(page, texts["fields", "survey_time"], "09:30")
    await_that(lambda: page.session.editor.work.basis.fields.survey_time == "09:30", "the time is not kept")
    assert not any("Survey time" in words for words in page.told())


def test_a_drawing_of_nothing_says_why(page, session, monkeypatch):
    session.editor.adjust(lambda params: params.replaced("method", "paper"))
    page.await_result()
    with pytest.raises(
        ConfigError, match=r"Plan DXF: the paper's method measures no nosings.*set the method to survey"
    ):
        part_of(session, "export").report.maker.make("Plan DXF")
    session.editor.adjust(lambda params: params.replaced("method", "survey"))
    shown = page.await_result()
    nothing = dataclasses.replace(shown.inspection, steps=(), flights=())
    monkeypatch.setattr(session.desk, "shown", dataclasses.replace(shown, inspection=nothing))
    with pytest.raises(ConfigError, match="Plan DXF: no step was found, so there is nothing to draw; see the notes"):
        part_of(session, "export").report.maker.make("Plan DXF")


def test_a_photograph_is_kept_with_its_caption_deleted_where_it_was_meant_and_refused_if_it_is_none(page):
    reporting, folder = part_of(page.session, "export").report, part_of(page.session, "export").report
    stream = io.BytesIO()
    Image.new("RGB", (3200, 1600), (10, 90, 160)).save(stream, "PNG")
    upload = SimpleNamespace(name="below.png", content=stream.getvalue())
    for caption in ("From below", ""):
        folder.caption.value = caption
        reporting.take_photo(upload)
    photos = page.session.editor.work.basis.photos
    assert photos == (read_photo(upload.content, "From below"), read_photo(upload.content))
    assert folder.photos.content.count("photo-row") == 2
    assert folder.caption.value == ""
    with pytest.raises(ConfigError, match=r"photograph 'x\.png': is not a PNG or JPEG"):
        reporting.take_photo(SimpleNamespace(name="x.png", content=b"none"))
    reporting.obey(f"photo {list_key(photos)} 1:1")
    assert page.session.editor.work.basis.photos == photos[1:]
    with pytest.raises(ConfigError, match="photos: the list has changed since"):
        reporting.obey(f"photo {list_key(photos)} 1:2")
    page.session.editor.undo()
    assert page.session.editor.work.basis.photos == photos
