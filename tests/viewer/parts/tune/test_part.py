"""The settings on a real page: each has its control, and what is written there is measured with and can be undone."""

import pytest

from stair_inspector.params import SETTINGS, Params
from tests.synthetic import CHANGES
from tests.viewer.wire_page import await_that


def test_every_setting_has_its_control_on_the_page_but_those_that_a_tool_of_the_scene_sets(page):
    controls = page.session.editor.controls._controls
    assert set(SETTINGS) - set(controls) == set(SETTINGS.at("scene")) == {"overrules.region", "station"}


@pytest.mark.parametrize("name", SETTINGS.at("more"))
def test_a_number_that_is_written_counts_at_once_and_can_be_undone(page, name):
    session, knob = page.session, SETTINGS.knob(name)
    before = session.editor.work.params
    assert before.value(name) == Params().value(name)
    control = session.editor.controls._controls[name]
    page._send(
        {"type": "GuiUpdateMessage", "uuid": control._impl.uuid, "updates": {"value": knob.shown(CHANGES[name])}}
    )
    await_that(lambda: session.editor.work.params == before.replaced(name, CHANGES[name]), "nothing was set")
    session.editor.undo()
    await_that(lambda: session.editor.work.params == before, "nothing was undone")
    assert control.value == knob.shown(before.value(name))
