"""Orders from the rows of lists: only what a row sends, and only for the list that it stood in."""

import pytest

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.bridge.markup import list_key, read_order

WORDS = ("show", "delete")


@pytest.mark.parametrize(
    "message",
    [
        "",
        None,
        "delete",
        "delete 1:1",
        "delete x 1:1",
        "delete 1 x:1",
        "drop 1 1:2",
        "delete -1 1:2",
        "delete 1 -1:2",
        "delete ² 1:1",
        "delete 1 99999999999",
        "delete 99999999999 1",
        "delete 1 1 1",
        "x" * 99,
    ],
)
def test_an_order_that_no_row_sends_is_refused(message):
    with pytest.raises(ConfigError, match="choose one of its rows"):
        read_order(message, WORDS)


def test_an_order_is_for_one_state_of_its_list():
    entries = ("a", "b", "c")
    order = read_order(f"show {list_key(entries)} 3:1763800000000", WORDS)
    assert (order.word, order.index_in(entries, "letters")) == ("show", 2)
    for other in (("a", "c"), ("c", "b", "a"), ("a", "b", "c", "d"), ()):
        with pytest.raises(ConfigError, match="letters: the list has changed since; choose the row once more"):
            order.index_in(other, "letters")


@pytest.mark.parametrize("number", [0, 4])
def test_a_row_that_the_list_has_not_is_none(number):
    entries = ("a", "b", "c")
    with pytest.raises(ConfigError, match="choose the row once more"):
        read_order(f"delete {list_key(entries)} {number}:1", WORDS).index_in(entries, "letters")
