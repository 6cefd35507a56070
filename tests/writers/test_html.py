"""The HTML page: complete in itself, nothing loaded or run, every text escaped."""

import base64
import dataclasses
import hashlib
import re
from datetime import timedelta

from hypothesis import given
from hypothesis import strategies as st

from stair_inspector.content.document import Bullets, Column, Document, Facts, Figure, Paragraph, Section, Table
from stair_inspector.content.fields import ReportBasis, ReportFields
from stair_inspector.writers.html import html_bytes
from tests.codes.flights import even, inspection_of
from tests.writers.samples import (
    HOSTILE,
    MADE_AT,
    Page,
    checked,
    document,
    html,
    html_page,
    plain_document,
    scanned,
)

ALLOWED = {
    *("html", "head", "meta", "title", "style", "body", "main", "header", "footer", "section", "h1", "h2", "h3", "p"),
    *(
        "div",
        "span",
        "b",
        "small",
        "ul",
        "li",
        "dl",
        "dt",
        "dd",
        "table",
        "caption",
        "thead",
        "tbody",
        "tr",
        "th",
        "td",
    ),
    *("data", "figure", "figcaption", "img"),
}
TEXTS = st.text(st.characters(codec="utf-8"), min_size=1, max_size=80)


def made_of(text):
    table = Table("t", text, (Column(text), Column(text, text, 1)), ((text, 1.0),), text)
    blocks = (Paragraph(text), Bullets((text,)), Facts("f", text, ((text, text),)), table)
    figure = Figure(text, text, text, "png", b"", 1.0)
    return Document(text, ((text, text),), text, b"", text, MADE_AT, "a4", (), (Section("1", text, (*blocks, figure)),))


def test_nothing_is_loaded_and_no_script_can_run():
    page = Page(html())
    assert {tag for tag, _ in page.tags} <= ALLOWED
    for _, attributes in page.tags:
        assert not any(name.startswith("on") or name in ("href", "action", "srcset", "style") for name in attributes)
        assert attributes.get("src", "data:image/png;base64,").startswith("data:image/")


def test_the_policy_allows_pictures_from_within_and_this_very_style():
    data = html().decode()
    style = re.search(r"<style>(.*?)</style>", data, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    policy = next(
        attributes["content"]
        for tag, attributes in Page(html()).tags
        if tag == "meta" and attributes.get("http-equiv") == "Content-Security-Policy"
    )
    assert (
        policy == f"default-src 'none'; img-src data:; style-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'"
    )


def test_raw_and_segmented_stand_side_by_side_on_top():
    data = html().decode()
    front = data.split("<section>")[0]
    pair = re.search(r'<div class="pair">(.*?)</div>', front, re.DOTALL)[1]
    assert re.findall(r'<figure id="([a-z_]+)"', pair) == ["raw_home", "segmented_home"]


def test_every_picture_is_inside_with_words_for_those_who_do_not_see_it():
    images = [attributes for tag, attributes in Page(html()).tags if tag == "img"]
    figures = document().figures()
    assert [image["alt"] for image in images] == [figure.alt for figure in figures]
    for image, figure in zip(images, figures, strict=True):
        assert base64.b64decode(image["src"].split(",")[1]) == figure.data


@given(text=TEXTS)
def test_no_text_becomes_markup_wherever_it_stands(text):
    page = Page(html_bytes(made_of(text)))
    plain = Page(html_bytes(made_of("word")))
    assert [tag for tag, _ in page.tags] == [tag for tag, _ in plain.tags]
    assert [sorted(attributes) for _, attributes in page.tags] == [sorted(attributes) for _, attributes in plain.tags]
    # As HTML reads line ends and the one sign that it forbids.
    shown = text.replace("\r\n", "\n").replace("\r", "\n")
    assert "".join(page.words).replace("\r\n", "\n").replace("\r", "\n").count(shown) >= 8


def test_hostile_fields_are_shown_as_they_are():
    fields = ReportFields(**dict.fromkeys(ReportFields.__dataclass_fields__, HOSTILE))
    page = html_page(plain_document(scanned()[1], checked(), ReportBasis(fields=fields)))
    assert {tag for tag, _ in page.tags} <= ALLOWED
    assert page.text.count(HOSTILE) >= len(ReportFields.__dataclass_fields__)


def test_the_same_content_gives_the_same_bytes_and_the_date_is_all_that_differs():
    made = plain_document(scanned()[1], checked())
    later = dataclasses.replace(made, made_at=MADE_AT + timedelta(days=40))
    assert html_bytes(made) == html_bytes(made)
    assert html_bytes(made).replace(b"2026-11-22", b"2027-01-01") == html_bytes(later)


def test_sixty_steps_are_sixty_rows():
    page = html_page(plain_document(inspection_of(even(60))))
    assert [row[0] for row in page.tables["steps"][1:]] == [str(number) for number in range(1, 61)]


def test_a_missing_value_is_a_dash_and_an_empty_field_a_blank():
    page = html_page(plain_document(inspection_of(even(3))))
    assert page.tables["steps"][3][4] == "–"
    assert "None" not in page.text
    assert ("dd", {}) in page.tags
