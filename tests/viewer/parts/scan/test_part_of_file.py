"""A box of the file that is written on the page is read alone."""

import pytest

from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import await_that


@pytest.mark.slow
def test_a_part_of_the_file_is_read_and_can_be_undone(page):
    session = page.session
    tool, field = part_of(session, "scan").part_of_file, session.editor.controls._controls["crop"]
    scan = session.desk.shown.scan
    low, high = scan.points.min(axis=0) + scan.origin_m - 1.0, scan.points.max(axis=0) + scan.origin_m
    # The lower half of the stair.
    high[2] = (low[2] + 1.0 + high[2]) / 2.0
    field.value = ",".join(f"{value:.4f}" for value in (*low, *high))
    tool.apply()
    await_that(lambda: len(session.desk.shown.scan.points) < len(scan.points), "the part was not read")
    part = session.desk.shown.scan
    assert (part.points + part.origin_m).max(axis=0)[2] <= high[2]
    assert part.sha256 == scan.sha256
    session.editor.undo()
    await_that(lambda: len(session.desk.shown.scan.points) == len(scan.points), "the whole was not read again")


def test_an_impossible_box_goes_back(page):
    session = page.session
    tool, field = part_of(session, "scan").part_of_file, session.editor.controls._controls["crop"]
    field.value = "1,2,3"
    tool.apply()
    assert "crop: got '1,2,3'; give xmin,ymin,zmin" in session.editor.refusal
    assert session.editor.work.params.crop == ""
