"""The list of scans: what a row says of a scan that was opened, was not, asks something, or cannot be read."""

import io

import numpy as np
from PIL import Image

from stair_inspector.pictures.render import render_thumbnail
from stair_inspector.viewer.parts.scan.scan_list import ListedScan, scan_list_html
from tests.viewer.surveyed import surveyed

ROWS = (
    ListedScan("a.ply", "saved", 1234567, "all within limits", "good", "2026-01-02", b"png"),
    ListedScan("<b>.ply", date="2026-01-03"),
    ListedScan("c.ply", "cannot be read", why="c.ply: ends early; copy it again"),
)


def test_a_row_says_what_is_known_of_its_scan_and_no_more():
    source = scan_list_html(ROWS, "a.ply", "pick")
    opened, fresh, broken = source.split("<li ")[1:]
    for words in ("1,234,567 points", "saved", "all within limits", "2026-01-02", "base64,cG5n"):
        assert words in opened
    assert [part.count('aria-current="true"') for part in (opened, fresh, broken)] == [1, 0, 0]
    assert "not opened" in fresh
    assert "points" not in fresh
    assert '<img alt="" width' not in fresh
    assert "<b>.ply" not in source
    assert "c.ply: ends early; copy it again" in broken


def test_a_field_to_find_scans_is_there_where_they_are_many():
    assert "scan-filter" not in scan_list_html(ROWS, "", "pick").split("<img")[0]
    many = tuple(ListedScan(f"{number}.ply") for number in range(9))
    assert 'data-testid="scan-filter"' in scan_list_html(many, "", "pick")


def test_a_small_picture_shows_the_steps():
    scan, inspection, _ = surveyed()
    picture = Image.open(io.BytesIO(render_thumbnail(scan, inspection, (64, 48))))
    assert picture.size == (128, 96)
    pixels = np.asarray(picture.convert("RGB")).reshape(-1, 3)
    assert 0.05 < float((pixels < 250).any(axis=1).mean()) < 0.95
    assert len(np.unique(pixels // 32, axis=0)) > 8
