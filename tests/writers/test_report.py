"""A report written: all its files or none, the drawings beside it."""

import pytest

from stair_inspector.content.fields import ReportBasis
from stair_inspector.errors import WriteError
from stair_inspector.params import Params
from stair_inspector.pictures.report_views import RenderedView
from stair_inspector.pipeline import inspect
from stair_inspector.writers.report import DRAWING_SUFFIXES, SUFFIXES, drawing_bytes, make_report, write_report
from tests.writers.samples import BASIS, MADE_AT, checked, formats, scanned

pytestmark = pytest.mark.slow

VIEW = RenderedView("own/../view", "from the page <b>", b"\x89PNG", 0.5)


def test_a_report_is_five_files_of_the_same_content(tmp_path):
    scan, inspection = scanned()
    written = write_report(scan, inspection, tmp_path, "stair", BASIS, MADE_AT, checked(), length="full")
    suffixes = (*SUFFIXES, *DRAWING_SUFFIXES.values())
    assert written == [tmp_path / f"stair{suffix}" for suffix in suffixes]
    assert {path.name for path in tmp_path.iterdir()} == {path.name for path in written}
    for path, data in zip(written, [*formats().values(), *drawing_bytes(inspection, MADE_AT).values()], strict=True):
        assert path.read_bytes() == data


def test_without_nosings_there_are_no_drawings(tmp_path):
    scan, _ = scanned()
    inspection = inspect(scan, Params(method="paper"))
    written = write_report(scan, inspection, tmp_path, "stair", ReportBasis(), MADE_AT)
    assert [path.name for path in written] == ["stair_report.pdf", "stair_report.html", "stair_report.xlsx"]


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    scan, inspection = scanned()
    with pytest.raises(WriteError, match="cannot be written"):
        write_report(scan, inspection, tmp_path / "file", "stair", BASIS, MADE_AT, views=())


def test_views_of_the_page_take_the_place_of_rendered_ones():
    scan, inspection = scanned()
    figures = make_report(scan, inspection, BASIS, MADE_AT, views=(VIEW,)).figures()
    pictures = [figure for figure in figures if figure.kind == "png"]
    assert [(figure.data, figure.caption) for figure in pictures] == [(VIEW.png, VIEW.caption)]
