"""Every control says what it does where one rests on its name, and what every report asks for is near."""


def test_every_control_has_a_hint(session):
    unsaid = []
    for handle in session.desk.client.gui._gui_input_handle_from_uuid.values():
        shown = handle._impl.props
        # A hidden text is where buttons of the page write to.
        is_order = type(handle).__name__ == "GuiTextHandle" and not handle.visible
        if not is_order and not getattr(shown, "hint", "of another kind"):
            unsaid.append(shown.label)
    assert unsaid == []


def test_client_and_site_are_two_clicks_away(session):
    texts = session.desk.client.gui._gui_input_handle_from_uuid.values()
    folders = session.desk.client.gui._container_handle_from_uuid
    for name in ("Client", "Site"):
        (field,) = (handle for handle in texts if handle._impl.props.label == name)
        own = folders[field._impl.parent_container_id]
        around = folders[own._impl.parent_container_id]
        # The tab, and the folder that holds the groups: that of the two is open in it.
        assert (own._impl.props.expand_by_default, around._impl.props.expand_by_default) == (True, False)
