"""Measuring one station of a scan that holds several."""

from stair_inspector.errors import ReadError, one_of
from stair_inspector.files.raw_stations import asked_as, find_station
from stair_inspector.viewer.bridge.widgets import offer
from stair_inspector.viewer.parts.part import Context

ALL = "all together"
_SHOWN_CHARACTERS = 40


class StationMenu:
    """The menu of a scan's stations; there where it has several, or where one is asked for."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor
        self.menu = context.widgets.dropdown(
            "Which station",
            (ALL,),
            hint="Measures what one station saw, for itself. All stations are taken together where none is chosen.",
            is_visible=False,
            on_change=self.choose,
        )

    def show(self) -> None:
        """Offer the stations of the scan that is shown, with the one that is asked for."""
        options, asked = self._options(), self._editor.work.params.station
        label = ALL
        if asked:
            try:
                label = list(options)[1 + find_station(self._names(), asked)]
            except ReadError:
                # The file that is shown does not have it.
                label = asked
                options.setdefault(label, asked)
        self.menu.visible = len(options) > 2 or asked != ""
        offer(self.menu, tuple(options), label)

    def choose(self, label: str) -> None:
        """Read the scan again, with one station alone or with all."""
        with self._desk.lock:
            # What is asked for is offered, too, where the scan does not have it.
            station = self._options().get(one_of(label, self.menu.options, "station"), label)
            if station == self._editor.work.params.station:
                return
            self._editor.adjust(
                lambda params: params.replaced("station", station), f"station {label}" if station else "all stations"
            )

    def _names(self) -> tuple[str, ...]:
        shown = self._desk.shown
        return () if shown is None or shown.scan.stations is None else shown.scan.stations.names

    def _options(self) -> dict[str, str]:
        """Return what the menu says of each station, and what names it in the settings."""
        names = self._names()
        labels = [f"{number}: {name[:_SHOWN_CHARACTERS]}" for number, name in enumerate(names, start=1)]
        return {ALL: ""} | dict(zip(labels, asked_as(names), strict=True))
