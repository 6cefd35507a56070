"""The DXF files, read back: no audit errors, millimetres, layers, dimension entities that measure what was measured."""

import dataclasses
import functools
import io
import re
from datetime import UTC, datetime, timedelta

import ezdxf
import numpy as np
import pytest
from ezdxf import bbox
from hypothesis import given, settings
from hypothesis import strategies as st

from stair_inspector import __version__
from stair_inspector.content.document import plain
from stair_inspector.writers.dxf import dxf_files, dxf_text
from tests.content.staircases import staircase
from tests.drawings.test_drawings import EACH_SHAPE, SHAPES, values

MADE_AT = datetime(2026, 11, 22, 15, 4, 5, tzinfo=UTC)
LAYERS = {"rise": "STAIR-DIM-RISE", "going": "STAIR-DIM-GOING", "width": "STAIR-DIM-WIDTH"}


@functools.cache
def files_of(inspection):
    """The files of one of the shapes, written once for all tests that read them."""
    return dxf_files(inspection, MADE_AT)


def read(data):
    return ezdxf.read(io.StringIO(data.decode("utf-8")))


def dimensions(document, layer):
    return document.modelspace().query(f'DIMENSION[layer=="{layer}"]')


def drawn_text(dimension):
    """The words in the block that a CAD program shows."""
    texts = [
        entity.plain_text() if entity.dxftype() == "MTEXT" else entity.dxf.text
        for entity in dimension.get_geometry_block().query("TEXT MTEXT")
    ]
    assert len(texts) == 1
    return texts[0]


@EACH_SHAPE
def test_both_files_open_without_errors_in_millimetres(inspection):
    files = files_of(inspection)
    assert sorted(files) == ["plan", "section"]
    for data in files.values():
        document = read(data)
        auditor = document.audit()
        assert (auditor.errors, auditor.fixes) == ([], [])
        assert document.dxfversion >= "AC1024"
        assert document.units == ezdxf.units.MM
        assert document.header["$MEASUREMENT"] == 1
        assert {entity.dxf.layer for entity in document.modelspace()} <= {
            layer.dxf.name for layer in document.layers if layer.dxf.name.startswith("STAIR-")
        }
        assert len(document.modelspace().query("POINT")) == 0


@EACH_SHAPE
@pytest.mark.parametrize(("key", "names"), [("plan", ("going", "width")), ("section", ("rise", "going"))])
def test_dimension_entities_measure_and_show_the_values_of_the_inspection(inspection, key, names):
    document = read(files_of(inspection)[key])
    for name in names:
        found = dimensions(document, LAYERS[name])
        expected = values(inspection, name)
        measured = [dimension.get_measurement() for dimension in found]
        np.testing.assert_allclose(sorted(measured), expected, atol=1e-6)
        assert [drawn_text(dimension) for dimension in found] == [f"{value:.1f}" for value in measured]
        # The text is the measurement: nothing was typed over it.
        assert {dimension.dxf.text for dimension in found} <= {"", "<>"}


def test_texts_of_dimensions_are_never_upside_down():
    for data in files_of(SHAPES["back"]).values():
        for dimension in read(data).modelspace().query("DIMENSION"):
            for text in dimension.get_geometry_block().query("TEXT MTEXT"):
                turn = text.dxf.rotation if text.dxftype() == "TEXT" else text.get_rotation()
                turn = (turn + 180.0) % 360.0 - 180.0
                assert -89.5 < turn <= 90.5


def test_what_was_not_measured_is_a_text_and_no_dimension():
    inspection = staircase((6,), missing_rise=(3,), missing_going=(2,))
    document = read(dxf_files(inspection, MADE_AT)["section"])
    said = [entity.dxf.text for entity in document.modelspace().query('TEXT[layer=="STAIR-NOT-MEASURED"]')]
    assert sorted(said) == ["n. m.", "rise not measured"]
    assert len(dimensions(document, LAYERS["rise"])) == 5
    assert len(dimensions(document, LAYERS["going"])) == 4


def test_the_drawing_has_the_size_of_the_stair():
    inspection = SHAPES["straight"]
    document = read(dxf_files(inspection, MADE_AT)["section"])
    nosings = document.modelspace().query('LWPOLYLINE[layer=="STAIR-NOSING"]')
    extents = bbox.extents(nosings)
    rise = sum(step.rise_m.value for step in inspection.steps) * 1000.0
    run = sum(step.going_m.value for step in inspection.steps[:-1]) * 1000.0
    # A landing falls by half a degree over its depth.
    assert extents.size.y == pytest.approx(rise + 1200.0 * np.tan(np.radians(0.5)), abs=0.01)
    assert extents.size.x == pytest.approx(run + 1200.0 + 450.0, abs=0.01)


def test_without_a_staircase_there_is_no_file():
    bare = dataclasses.replace(SHAPES["straight"], steps=(), flights=())
    assert dxf_files(bare, MADE_AT) == {}


def test_the_same_stair_gives_the_same_bytes_but_for_the_date():
    first, again = (dxf_files(SHAPES["left"], MADE_AT) for _ in range(2))
    assert first == again
    later = dxf_files(SHAPES["left"], MADE_AT + timedelta(days=400))
    dates = re.compile(r"2026-11-22|2027-12-27|\d{7}\.\d{9}|\{[0-9A-F-]{36}\}|T15:04:05")
    for key in first:
        assert first[key] != later[key]
        plain = [dates.sub("", data.decode("utf-8")) for data in (first[key], later[key])]
        assert plain[0] == plain[1]
    assert b"2026-11-22" in first["plan"]


def test_the_classes_stand_in_one_order_in_every_process():
    text = dxf_files(SHAPES["left"], MADE_AT)["plan"].decode("utf-8")
    names = re.findall(r"  0\nCLASS\n +1\n([^\n]+)\n", text)
    assert len(names) > 5
    assert names == sorted(names)


@pytest.mark.parametrize(
    "name",
    [
        "%%c%%u.ply",
        "a^Jb^I.ply",
        "\\P{\\C1;x}.ply",
        "\\U+0041.ply",
        "계단 <b>.ply",
        "  0\nEOF\n  0\nSECTION",
        "\ud800.ply",
    ],
)
def test_a_hostile_name_is_text_and_nothing_else(name):
    document = read(dxf_files(staircase((3,), name=name), MADE_AT)["plan"])
    assert document.audit().errors == []
    titles = document.modelspace().query('TEXT[layer=="STAIR-TITLE"]')
    # Title, name, two notes, and the two ends of the scale bar.
    assert len(titles) == 6
    shown = titles[1].plain_text()
    # What a CAD program shows is the name, with what cannot be seen spelt out, and its codes broken up by a blank.
    spelt = plain(name).replace("\n", " ")
    assert shown.replace(" ", "").startswith(spelt.replace(" ", ""))
    assert shown.endswith(f", 2026-11-22, stair_inspector {__version__}")


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=40))
def test_a_text_stays_on_its_line_and_has_no_codes(text):
    shown = dxf_text(text)
    assert not re.search(r"[\x00-\x1f\x7f]|%%|\\U\+|\\M\+|\^(?! )", shown)


def test_the_scale_bar_is_a_metre_of_the_drawing():
    space = read(dxf_files(SHAPES["straight"], MADE_AT)["plan"]).modelspace()
    lines = space.query('LINE[layer=="STAIR-TITLE"]')
    level = [line for line in lines if line.dxf.start.y == pytest.approx(line.dxf.end.y)]
    assert [abs(line.dxf.end.x - line.dxf.start.x) for line in level] == [pytest.approx(1000.0)]
    assert "1000 mm" in [text.dxf.text for text in space.query("TEXT")]
