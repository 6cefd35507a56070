"""Undo and redo: what an inspector gets back."""

import hypothesis.strategies as st
from hypothesis import given

from stair_inspector.viewer.state.history import History


def pushed(*values, **options):
    history = History("start", **options)
    for value in values:
        history.push(value, f"to {value}")
    return history


def test_a_new_history_has_nothing_to_undo():
    history = History(3)
    assert (history.value, history.can_undo, history.can_redo) == (3, False, False)
    assert (history.undo_label, history.redo_label) == ("", "")
    assert (history.undo(), history.redo()) == (3, 3)


def test_undo_walks_back_and_redo_forward_with_their_words():
    history = pushed("a", "b")
    assert (history.undo_label, history.undo()) == ("to b", "a")
    assert (history.undo_label, history.undo()) == ("to a", "start")
    assert (history.can_undo, history.undo_label, history.redo_label) == (False, "", "to a")
    assert (history.redo(), history.redo(), history.can_redo) == ("a", "b", False)


def test_a_change_after_an_undo_forgets_what_was_undone():
    history = pushed("a", "b")
    history.undo()
    history.push("c", "to c")
    assert not history.can_redo
    assert [history.undo(), history.undo(), history.can_undo] == ["a", "start", False]


def test_a_value_that_is_the_same_is_no_change_and_keeps_what_can_be_redone():
    history = pushed("a")
    history.undo()
    history.push("start", "nothing")
    assert (history.can_undo, history.redo_label) == (False, "to a")


def test_a_drag_is_undone_at_once():
    history = pushed("a")
    for value in ("b", "c", "d"):
        history.push(value, f"slider to {value}", merge_key="slider")
    assert history.undo_label == "slider to d"
    assert history.undo() == "a"


def test_a_drag_that_ends_where_it_began_is_nothing_to_undo():
    history = History(0)
    for value in (1, 0):
        history.push(value, str(value), merge_key="slider")
    assert (history.value, history.can_undo) == (0, False)


def test_two_drags_of_the_same_slider_are_two_changes_when_settled_between():
    history = History(0)
    history.push(1, "1", merge_key="slider")
    history.settle()
    history.push(2, "2", merge_key="slider")
    assert [history.undo(), history.undo()] == [1, 0]


def test_drags_of_two_sliders_are_two_changes():
    history = History(0)
    history.push(1, "1", merge_key="one")
    history.push(2, "2", merge_key="other")
    assert [history.undo(), history.undo()] == [1, 0]


def test_a_drag_after_an_undo_does_not_change_the_value_come_back_to():
    history = History(0)
    history.push(1, "1", merge_key="slider")
    history.push(2, "2", merge_key="other")
    history.undo()
    history.push(3, "3", merge_key="slider")
    assert [history.undo(), history.undo()] == [1, 0]


def test_the_oldest_changes_are_forgotten_beyond_the_limit():
    history = pushed(*"abcde", limit=2)
    assert [history.undo(), history.undo(), history.can_undo] == ["d", "c", False]


@given(st.lists(st.one_of(st.integers(0, 3), st.just("undo"), st.just("redo"))))
def test_it_walks_as_a_plain_list_would(actions):
    history = History(0)
    line, at = [0], 0
    for action in actions:
        if action == "undo":
            at = max(0, at - 1)
            assert history.undo() == line[at]
        elif action == "redo":
            at = min(len(line) - 1, at + 1)
            assert history.redo() == line[at]
        else:
            history.push(action, str(action))
            if action != line[at]:
                line = [*line[: at + 1], action]
                at += 1
        assert (history.value, history.can_undo, history.can_redo) == (line[at], at > 0, at + 1 < len(line))
