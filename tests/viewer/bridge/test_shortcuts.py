"""Keys: each has one meaning, and the help card lists them all."""

from stair_inspector.viewer.bridge.overlay import Tool, overlay_html, toolbar_html
from stair_inspector.viewer.bridge.reach_drag import drag_attributes
from stair_inspector.viewer.bridge.shortcuts import Command, help_html, key_words


def test_no_key_has_two_meanings_and_no_two_commands_the_same_name(session):
    keys = [(command.key, command.modifier) for command in session.commands() if command.key]
    assert len(set(keys)) == len(keys)
    labels = [command.label for command in session.commands()]
    assert len(set(labels)) == len(labels)


def test_the_help_card_lists_every_key_with_what_it_does(session):
    card = help_html(session.commands(), "")
    for command in session.commands():
        if command.key:
            assert f">{key_words(command)}</kbd>" in card
            assert command.label in card
    assert "Shift+click" in card


def test_keys_are_written_as_people_do():
    assert key_words(Command("", print, "Z", "cmd/ctrl+shift")) == "Ctrl+Shift+Z"
    assert key_words(Command("", print, "arrowup")) == "↑"
    assert key_words(Command("", print, "S")) == "S"


def test_what_lies_over_the_scene_is_escaped_and_stays_out_of_the_mouses_way():
    html = toolbar_html("id", ((Tool("<b>", '"x"', "it's"),),))
    assert "<b>" not in html
    assert "&quot;x&quot;" in html
    assert "pointer-events:none" in overlay_html("")


def test_a_drag_stays_within_the_range_of_eps_z():
    assert "Math.min(100,Math.max(1," in drag_attributes("id", 400.0, 5.0)
