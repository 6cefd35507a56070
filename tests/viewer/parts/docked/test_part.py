"""The table below the scene: what its clicks ask for, and that no message from a page breaks it."""

import pytest

from stair_inspector.errors import ConfigError
from tests.viewer.parts_of import part_of


def heads_of(docked):
    return [part.partition('"')[0] for part in docked.html.content.split('data-head="')[1:]]


def test_clicks_choose_columns_order_view_rows_and_folds(page, session):
    docked = part_of(session, "docked")
    page.await_result()
    assert 'data-columns="survey"' in docked.html.content
    assert heads_of(docked)[-2:] == ["rms", "coverage"]
    docked.obey("column survey fall:1")
    assert "fall" in heads_of(docked)
    docked.obey("column survey coverage:2")
    assert "coverage" not in heads_of(docked)
    docked.obey("sort survey rms:3")
    assert 'data-head="rms" aria-sort="descending"' in docked.html.content
    assert 'data-testid="flight-row"' not in docked.html.content
    docked.obey("sort survey rms:4")
    docked.obey("sort survey rms:5")
    docked.obey("flight 1:6")
    assert 'data-testid="step-row"' not in docked.html.content
    docked.obey("flight 1:7")
    docked.obey("2:8")
    assert session.desk.selected == 2
    docked.obey("view paper:9")
    assert 'data-columns="paper"' in docked.html.content
    # What was chosen of the survey's columns is there again.
    docked.obey("view survey:10")
    assert "fall" in heads_of(docked)


@pytest.mark.parametrize(
    "message", ["view x:1", "column:1", "column survey:1", "sort x rise:1", "sort survey <b>:1", ""]
)
def test_what_no_click_sends_is_a_sentence(page, session, message):
    docked = part_of(session, "docked")
    before = docked.html.content
    with pytest.raises(ConfigError, match="got "):
        docked.obey(message)
    assert docked.html.content == before


def test_a_column_that_is_none_is_refused_with_all_of_them(session):
    docked = part_of(session, "docked")
    for message in ("sort survey x:1", "column survey x:1"):
        with pytest.raises(ConfigError, match=r"got 'x'; give one of .*rise.*, rms, coverage, points"):
            docked.obey(message)
