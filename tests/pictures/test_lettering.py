"""Words in pictures: drawn as wide as they say, wrapped inside their room, and never a letter that is a box."""

import time

import numpy as np
import pytest
from PIL import Image, ImageDraw

from stair_inspector.pictures import lettering
from stair_inspector.pictures.lettering import Lettering

INK = (10, 20, 30)
LETTERS = ("used: θ_th 15° · ε_z 20 mm → α 95/5 %", "계단 2층", "plain words", "±0.4 mm − 3 × 2 m²")


def pen_on(size=20, outline=0, ground=(255, 255, 255, 0)):
    image = Image.new("RGBA", (600, 80), ground)
    return image, Lettering(ImageDraw.Draw(image), size, INK, outline)


def without_fonts(monkeypatch):
    monkeypatch.setattr(lettering, "font_files", tuple)
    monkeypatch.setattr(lettering, "_FONTS", ("this-font-does-not-exist.ttf",))


@pytest.fixture(params=["fonts", "no fonts"])
def fonts(request, monkeypatch):
    if request.param == "no fonts":
        without_fonts(monkeypatch)
    return request.param


@pytest.mark.parametrize("words", LETTERS)
def test_the_ink_of_a_text_fills_the_width_it_says(fonts, words):
    image, pen = pen_on()
    pen.write(10, 20, words)
    inked = np.nonzero(np.asarray(image)[..., 3].any(axis=0))[0]
    assert inked[0] >= 9
    assert inked[-1] - 10 == pytest.approx(pen.width(words), abs=6)


def test_the_reports_own_fonts_have_what_is_written_here_and_no_font_of_the_machine_is_needed(monkeypatch):
    monkeypatch.setattr(lettering, "_FONTS", ())
    for words in LETTERS:
        font, written = lettering._fit(words, 20)
        assert written == words
        assert font.getname()[0] == ("Noto Sans KR" if "계" in words else "Source Sans 3")


def test_letters_are_of_regular_weight():
    image, pen = pen_on(size=40)
    pen.write(10, 10, "lllll")
    inked = np.asarray(image)[..., 3].astype(float)[30] / 255.0
    # A stem of Source Sans is 84 thousandths of the letters' size, one of its extra light 31.
    assert inked.sum() / 5 == pytest.approx(0.084 * 40, rel=0.15)


def test_a_letter_that_no_font_has_is_its_code_point_and_what_is_no_letter_is_a_space(monkeypatch):
    assert lettering._fit("a\nb\tc\ue123", 20)[1] == "a b c "
    without_fonts(monkeypatch)
    assert lettering._fit("\ua000 stair", 20)[1] == "<U+A000> stair"


def test_without_fonts_the_signs_of_the_settings_are_spelt(monkeypatch):
    without_fonts(monkeypatch)
    words = lettering._fit("θ_th 15° · ε_z ± 한", 20)[1]
    assert words == "theta_th 15° · eps_z ± <U+D55C>"


@pytest.mark.parametrize("width", [90, 200, 590])
def test_wrapped_lines_fit_and_lose_no_word(fonts, width):
    _, pen = pen_on()
    words = "used: survey " + "· a long setting of a run " * 4 + "x" * 70
    lines = pen.wrap(words, width)
    assert all(pen.width(line) <= width for line in lines)
    assert "".join("".join(lines).split()) == "".join(words.split())
    assert len(lines) > 1
    assert pen.wrap("", width) == []


def test_an_outline_keeps_letters_readable_on_a_dark_ground():
    image, pen = pen_on(outline=2, ground=(0, 0, 0, 255))
    pen.write(10, 20, "stair")
    pixels = np.asarray(image)[..., :3].reshape(-1, 3).astype(int)
    assert (pixels.sum(axis=1) > 700).sum() > 100
    assert (np.abs(pixels - INK).sum(axis=1) < 30).sum() > 50


def test_a_word_of_thousands_of_letters_is_cut_into_lines_at_once():
    pen = Lettering(ImageDraw.Draw(Image.new("RGB", (10, 10))), 12, (0, 0, 0))
    began = time.perf_counter()
    lines = pen.wrap("a" * 5000, 200.0)
    # Trying every length of every piece took more than a minute.
    assert time.perf_counter() - began < 10.0
    assert "".join(lines) == "a" * 5000
    assert max(map(pen.width, lines)) <= 200.0
    assert min(map(pen.width, lines[:-1])) > 180.0
