"""What changed as HTML: marked where it changed, escaped, with the numbers of the scan that is open."""

import dataclasses
import re

import pytest

from stair_inspector.content.comparisons import change_text
from stair_inspector.model import ComparedScan, Measured
from stair_inspector.viewer.parts.second.changes_html import changes_html, maps_html, words_html
from tests.comparison.epochs import LAST, SETTLED, TURNED, WORN, compared

SEEN = ComparedScan(compared(True), is_earlier=True)


def cells(html):
    """(step, quantity, whether it is marked as changed) of every cell."""
    found = []
    for row in re.findall(r'<tr data-testid="change-row" data-step="(\d+)".*?</tr>', html, re.S):
        body = re.search(rf'<tr data-testid="change-row" data-step="{row}".*?</tr>', html, re.S)[0]
        found += [
            (int(row), quantity, changed == "true")
            for quantity, changed in re.findall(r'data-quantity="(\w+)" data-changed="(\w+)"', body)
        ]
    return found


def test_what_changed_is_marked_and_nothing_else():
    changed = {(step, quantity) for step, quantity, is_changed in cells(changes_html(SEEN, None, "u")) if is_changed}
    heights = {(step, "height") for step in range(SETTLED, LAST + 1)}
    rises = {(WORN, "rise"), (WORN + 1, "rise"), (SETTLED, "rise")}
    assert changed == heights | rises | {(TURNED, "cross_fall"), (SETTLED - 1, "pitch")}
    same = ComparedScan(compared(False), is_earlier=True)
    assert not any(is_changed for *_, is_changed in cells(changes_html(same, None, "u")))


def test_values_have_their_sign_and_u_in_the_unit_of_the_page():
    html = changes_html(SEEN, SETTLED, "u")
    height = re.findall(rf'data-step="{SETTLED}".*?data-quantity="height"[^>]*>(.*?)</td>', html, re.S)[0]
    assert height.startswith("−4.0 *<div")
    assert "± 0.2" in height
    assert html.count("background:rgba(0, 214, 230") == 1
    inches = changes_html(SEEN, SETTLED, "u", "in")
    assert re.findall(rf'data-step="{SETTLED}".*?data-quantity="height"[^>]*>(.*?)</td>', inches, re.S)[0].startswith(
        "−0.15"
    )


def test_steps_have_the_number_of_the_open_scan_and_that_of_the_other_beside_it():
    steps = tuple(dataclasses.replace(step, after_id=step.before_id + 1) for step in compared(True).steps)
    seen = ComparedScan(dataclasses.replace(compared(True), steps=steps), is_earlier=False)
    html = changes_html(seen, None, "u")
    assert re.findall(r'data-testid="change-row" data-step="(\d+)"', html) == [str(k) for k in range(2, LAST + 2)]
    assert html.count("(1)") == 1


def test_names_of_files_are_escaped():
    found = dataclasses.replace(
        compared(True), after=dataclasses.replace(compared(True).after, name="<img src=x onerror=alert(1)>.ply")
    )
    seen = ComparedScan(found, is_earlier=False)
    for html in (words_html(seen), changes_html(seen, None, "u"), maps_html(seen, None, is_all=True)):
        assert "<img src=x" not in html


@pytest.mark.parametrize("is_all", [True, False])
def test_a_tread_that_was_not_seen_in_both_has_words_instead_of_a_map(is_all):
    steps = tuple(
        dataclasses.replace(step, deviations=None) if step.before_id == 1 else step for step in compared(True).steps
    )
    seen = ComparedScan(dataclasses.replace(compared(True), steps=steps), is_earlier=True)
    html = maps_html(seen, 1, is_all=is_all)
    assert "step 1: not seen in both scans" in html
    assert html.count("<img") == (LAST - 1 if is_all else 0)
    assert "the outlined place lies −2.5 ± 1.7 mm off the rest" in maps_html(seen, WORN, is_all=False)


def test_a_change_that_is_zero_as_shown_is_blank_before_its_u():
    first = SEEN.found.steps[0]
    height = dataclasses.replace(first.height, change=Measured(-0.00001, 0.0004), is_changed=False)
    steps = (dataclasses.replace(first, height=height), *SEEN.found.steps[1:])
    html = changes_html(ComparedScan(dataclasses.replace(SEEN.found, steps=steps), is_earlier=True), None, "u")
    shown = re.findall(r'data-step="1".*?data-quantity="height"[^>]*>(.*?)</td>', html, re.S)[0]
    assert re.sub("<.*?>", "", shown) == "± 0.4"
    assert change_text(height) == "± 0.4"
    assert change_text(dataclasses.replace(height, change=Measured(0.0012, 0.0004))) == "+1.2 ± 0.4"
