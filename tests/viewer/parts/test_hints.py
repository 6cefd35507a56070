"""Every control says what it does where one rests on its name."""


def test_every_control_has_a_hint(session):
    unsaid = []
    for handle in session.desk.client.gui._gui_input_handle_from_uuid.values():
        shown = handle._impl.props
        # A hidden text is where buttons of the page write to.
        is_order = type(handle).__name__ == "GuiTextHandle" and not handle.visible
        if not is_order and not getattr(shown, "hint", "of another kind"):
            unsaid.append(shown.label)
    assert unsaid == []
