"""Names for screen readers, and keys, for those of viser's controls that have none.

Its sliders, number fields, rows of buttons and buttons with a sign alone say nothing to a screen reader, and its
folders open by the mouse only. A script names each by the label beside it, also those that appear later.
"""

from stair_inspector.viewer.bridge.markup import page_script


def names_html() -> str:
    """Return what names the controls of the page, once."""
    return page_script("names")
