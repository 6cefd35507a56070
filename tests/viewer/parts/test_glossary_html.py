"""The glossary says what the quantities are in the words of their declarations, and the drawing has their labels."""

from stair_inspector.quantities import IN_TABLE, QUANTITIES, SHOWN_OF_PAPER, quantity_of
from stair_inspector.viewer.bridge.markup import hint_of, text
from stair_inspector.viewer.parts.glossary_html import glossary_html


def test_every_quantity_is_defined_once():
    source = glossary_html()
    for each in (*QUANTITIES, *SHOWN_OF_PAPER):
        assert f"> {text(hint_of(each))}" in source, each.name
    names = [part.partition("</dt>")[0].rpartition(">")[2] for part in source.split("<dt")[1:]]
    assert len(set(names)) == len(names)


def test_the_drawing_has_the_labels_of_the_quantities():
    source = glossary_html()
    drawing = source[: source.index("</svg>")]
    for each in (*IN_TABLE, quantity_of("nosing_overhang")):
        assert f">{each.label}</text>" in drawing
    assert 'role="img"' in drawing
