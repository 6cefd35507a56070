"""A legend on the page shows the colours it names, and words from a file stay words."""

import numpy as np

from stair_inspector.pictures.legends import Legend, Ramp, colors_on
from stair_inspector.viewer.scene.legends import colour_legend_html
from tests.viewer.parts.test_html import HOSTILE, Page

RAMP = Ramp(((0, 0, 0), (100, 200, 50), (255, 255, 255)), ((0.0, "−5"), (0.5, "0"), (1.0, "+5")))


def test_the_colours_of_a_scale_are_met_at_its_stops_and_mixed_between():
    colors = colors_on(RAMP.colors, np.array([0.0, 0.25, 0.5, 1.0, -3.0, 7.0]))
    assert colors.tolist() == [
        [0, 0, 0],
        [50, 100, 25],
        [100, 200, 50],
        [255, 255, 255],
        [0, 0, 0],
        [255, 255, 255],
    ]


def test_a_scale_is_a_gradient_through_its_colours_with_its_ticks_in_order():
    source = colour_legend_html(Legend("distance [mm]", (((1, 2, 3), "none"),), RAMP))
    page = Page(source)
    assert "linear-gradient(to right, rgb(0, 0, 0), rgb(100, 200, 50), rgb(255, 255, 255))" in source
    assert "rgb(1, 2, 3)" in source
    words = page.words
    assert words.index("distance [mm]") < words.index("−5") < words.index("+5") < words.index("none")


def test_words_that_could_come_from_a_file_are_escaped():
    page = Page(colour_legend_html(Legend(HOSTILE, (((1, 2, 3), HOSTILE),), Ramp(RAMP.colors, ((0.0, HOSTILE),)))))
    assert page.of("img") == page.of("script") == []
    assert page.words.count(HOSTILE) == 3
