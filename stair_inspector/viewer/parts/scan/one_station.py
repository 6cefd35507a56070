"""Measuring one station of a scan that holds several."""

from collections import Counter

from stair_inspector.errors import one_of
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
        label = next((label for label, station in options.items() if station == asked), None)
        if label is None:
            # It is named by its number, or the file that is shown does not have it.
            label = next((label for k, label in enumerate(options) if k and str(k) == asked.strip()), asked)
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

    def _options(self) -> dict[str, str]:
        """Return what the menu says of each station, and what names it in the settings: a name, or else a number."""
        shown = self._desk.shown
        stations = None if shown is None else shown.scan.stations
        names = () if stations is None else stations.names
        often = Counter(name.casefold() for name in names)
        options = {ALL: ""}
        for number, name in enumerate(names, start=1):
            is_clear = often[name.casefold()] == 1 and name == name.strip()
            options[f"{number}: {name[:_SHOWN_CHARACTERS]}"] = name if is_clear else str(number)
        return options
