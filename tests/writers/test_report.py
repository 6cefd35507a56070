"""A report written: all its files or none, the drawings beside it."""

import pytest

from stair_inspector.content.fields import ReportBasis
from stair_inspector.params import Params
from stair_inspector.pictures.report_views import RenderedView
from stair_inspector.pipeline import inspect
from stair_inspector.writers.report import DRAWING_SUFFIXES, SUFFIXES, drawing_bytes, make_report, report_files
from tests.writers.samples import BASIS, MADE_AT, checked, formats, scanned

pytestmark = pytest.mark.slow

VIEW = RenderedView("own/../view", "from the page <b>", b"\x89PNG", 0.5)


def test_a_report_is_five_files_of_the_same_content():
    scan, inspection = scanned()
    made = report_files(scan, inspection, BASIS, MADE_AT, checked(), length="full")
    assert tuple(made) == (*SUFFIXES, *DRAWING_SUFFIXES.values())
    assert list(made.values()) == [*formats().values(), *drawing_bytes(inspection, MADE_AT).values()]


def test_without_nosings_there_are_no_drawings():
    scan, _ = scanned()
    inspection = inspect(scan, Params(method="paper"))
    made = report_files(scan, inspection, ReportBasis(), MADE_AT)
    assert tuple(made) == ("_report.pdf", "_report.html", "_report.xlsx")


def test_views_of_the_page_take_the_place_of_rendered_ones():
    scan, inspection = scanned()
    figures = make_report(scan, inspection, BASIS, MADE_AT, views=(VIEW,)).figures()
    pictures = [figure for figure in figures if figure.kind == "png"]
    assert [(figure.data, figure.caption) for figure in pictures] == [(VIEW.png, VIEW.caption)]
