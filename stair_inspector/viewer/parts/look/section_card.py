"""A section as a large drawing in a window of its own, which can be made larger still and moved about in."""

from collections.abc import Callable

from stair_inspector.viewer.bridge.cards import Card
from stair_inspector.viewer.bridge.styles import wide_window
from stair_inspector.viewer.bridge.widgets import Widgets

ZOOMS = (1, 2, 4, 8)
"""How much larger than the window the drawing can be."""
WIDTH, TALLEST = 1160, 520
"""Of the drawing as large as the window, pixels."""
MOST_DOTS = 25_000
_LARGER, _SMALLER = "Larger", "Smaller"
_WIDE = wide_window("large-section", WIDTH + 80)


class SectionCard(Card):
    """The window; there is one at a time."""

    def __init__(self, widgets: Widgets) -> None:
        super().__init__(widgets.gui, "Section")
        self._widgets = widgets
        self._zoom = 0

    def open(self, draw: Callable[[int, int], str]) -> None:
        """Open the window with what ``draw(width, tallest)`` returns, which is called again for every size."""
        self.close()
        self._zoom = 0
        self.fill(lambda: self._add_plot(draw))

    def _add_plot(self, draw: Callable[[int, int], str]) -> None:
        plot = self._widgets.html()

        def show(option: str = "") -> None:
            self._zoom += {_LARGER: 1, _SMALLER: -1}.get(option, 0)
            self._zoom = min(max(self._zoom, 0), len(ZOOMS) - 1)
            factor = ZOOMS[self._zoom]
            plot.content = (
                f'{_WIDE}<div data-testid="large-section" data-zoom="{factor}" style="overflow:auto;max-height:70vh">'
                f'<div style="width:{100 * factor}%">{draw(WIDTH * factor, TALLEST * factor)}</div></div>'
            )

        self._widgets.buttons("Size", (_LARGER, _SMALLER), show, hint="The drawing can be scrolled.")
        show()
