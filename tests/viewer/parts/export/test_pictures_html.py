"""Logo and photographs as the page shows them: small, and their captions never as markup."""

import base64
import io

from PIL import Image

from stair_inspector.content.images import read_logo, read_photo
from stair_inspector.viewer.bridge.markup import list_key
from stair_inspector.viewer.parts.export.pictures_html import logo_html, photos_html
from tests.viewer.parts.test_html import Page

HOSTILE = "<img src=x onerror=1>"


def picture(width, height, shade=2):
    stream = io.BytesIO()
    Image.new("RGB", (width, height), (1, shade, 3)).save(stream, "JPEG")
    return stream.getvalue()


def test_the_logo_is_shown_as_the_report_has_it():
    (shown,) = Page(logo_html(read_logo(picture(30, 10)))).of("img")
    assert shown["src"].startswith("data:image/png;base64,")
    assert "No logo" in Page(logo_html(None)).words


def test_photographs_are_listed_small_with_their_captions():
    photos = (read_photo(picture(1600, 800), HOSTILE), read_photo(picture(20, 40)))
    page = Page(photos_html(photos, "abc"))
    first, second = page.of("img")
    small = Image.open(io.BytesIO(base64.b64decode(first["src"].removeprefix("data:image/jpeg;base64,"))))
    assert small.size == (192, 96)
    assert (first["alt"], second["alt"]) == ("photograph 1", "photograph 2")
    assert f"1. {HOSTILE}" in page.words
    assert "without a caption" in page.words


def test_each_photograph_has_a_button_that_names_it_and_its_list():
    photos = (read_photo(picture(20, 40)), read_photo(picture(20, 40, 99)))
    buttons = Page(photos_html(photos, "abc")).of("button")
    assert [each["aria-label"] for each in buttons] == ["delete photograph 1", "delete photograph 2"]
    for number, button in enumerate(buttons, 1):
        assert f"photo {list_key(photos)} {number}" in button["onclick"]
    assert list_key(photos) != list_key(photos[::-1])


def test_without_a_photograph_it_says_where_they_would_stand():
    assert "No photograph yet; up to 12 stand in the report" in Page(photos_html((), "abc")).words
