"""How the scan's points are drawn: coloured by what, shaded, how large and how many."""

from stair_inspector.pictures.coloring import COLOR_MODES
from stair_inspector.viewer.compute.threads import Newest
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.state.change import PageChange


class PointsFolder:
    """The folder "Points" of the Scan tab."""

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._look = look = context.look
        # Sending another number of points takes longer than a slider's next event.
        redraw = desk.notices.guard(self._draw_others)
        self._redraws: Newest[None] = Newest(lambda _: redraw(), name=f"stair-points-{desk.client.client_id}")
        widgets = context.widgets
        with widgets.folder("Points"):
            self._color = widgets.dropdown(
                "Colour by",
                COLOR_MODES,
                hint="Of the segmented cloud, by intensity of the raw one too; see the legend.",
                on_change=look.set_color,
            )
            widgets.dropdown(
                "Colours of steps",
                tuple(desk.palettes),
                hint="'distinct' are as different for colour-blind eyes as for others.",
                on_change=desk.set_palette,
            )
            widgets.checkbox(
                "Shade edges",
                hint="Light from the lower left, and darker creases, as the normals say.",
                on_change=look.set_shading,
            )
            self._size = widgets.slider(
                "Point size [mm]",
                (0.5, 50.0),
                0.5,
                5.0,
                hint="Diameter of the drawn points.",
                on_change=look.set_point_size,
            )
            widgets.slider(
                "Points drawn [%]",
                (1, 100),
                1,
                100,
                hint="The measurement always uses all of them.",
                on_change=self.set_density,
            )

    def close(self) -> None:
        """End the thread."""
        self._redraws.close()

    def show(self) -> None:
        """Say what the colours tell, and set the point size to the scene's, as near as the slider's range allows."""
        self._color.value = self._look.color_mode
        if self._desk.shown is None:
            return
        size_mm = round(self._desk.stage.point_size_m * 1000.0, 1)
        self._size.value = min(self._size.max, max(self._size.min, size_mm))

    def set_density(self, percent: float) -> None:
        """Draw so many of the points."""
        self._look.set_percent(percent)
        self._redraws.submit(None)

    def _draw_others(self) -> None:
        with self._desk.lock:
            shown = self._desk.shown
            if shown is not None:
                self._desk.shown = shown.drawn_as(self._look.display(shown.scan))
                self._desk.changed(PageChange.CLOUD)
