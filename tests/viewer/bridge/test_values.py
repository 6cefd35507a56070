"""What a page sends for a control."""

import math

import pytest

from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.bridge.values import fits
from tests.viewer.parts_of import part_of
from tests.viewer.wire_page import WirePage, await_that

ODD = (None, "abc", [], [1, 2], {"a": 1}, b"x", math.nan, True, 2**63, ["a", "b", "c"], [1.0, None, 2.0])


@pytest.mark.parametrize(
    ("known", "good", "bad"),
    [
        (True, [False], [0, 1.0, "true", None]),
        (5, [6, 6.5], [True, "6", None, math.nan, math.inf, [6]]),
        (0.5, [1, 0.25, math.nan], [False, "0.5", None, [0.5]]),
        ("a", ["", "b"], [1, None, b"b", ["b"]]),
        ((1.0, 2.0, 3.0), [[1, 2, 3.5], (0.0, 0.0, 0.0)], [[1, 2], [1, 2, "3"], [1, 2, None], 3, "abc", {}]),
        (None, [], [None, 1, "a"]),
    ],
)
def test_a_value_is_of_the_kind_of_the_one_before(known, good, bad):
    assert [fits(known, sent) for sent in good] == [True] * len(good)
    assert [fits(known, sent) for sent in bad] == [False] * len(bad)


def test_no_control_fails_over_what_it_is_sent(app, capfd):
    page = WirePage(app)
    try:
        controls = page.session.editor.controls._controls
        some = [*controls.values(), part_of(page.session, "export").title_field, part_of(page.session, "scan").upload]
        before = page.session.editor.work
        for control in some:
            for value in ODD:
                if not fits(control._impl.value, value):
                    page._send({"type": "GuiUpdateMessage", "uuid": uuid_of(control), "updates": {"value": value}})
        assert page.session.opening._is_answering()
        assert page.session.editor.work == before
        # What follows is heard.
        title = part_of(page.session, "export").title_field
        page._send({"type": "GuiUpdateMessage", "uuid": uuid_of(title), "updates": {"value": "Hall"}})
        await_that(lambda: page.session.editor.work.title == "Hall", "the title is not taken")
    finally:
        page.close()
    assert "Traceback" not in "".join(capfd.readouterr())
