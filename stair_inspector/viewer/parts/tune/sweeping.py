"""The folder "Sensitivity" of the Tune tab: a setting is swept over its range, and a quantity drawn against it."""

import viser

from stair_inspector.errors import ConfigError
from stair_inspector.params import SETTINGS
from stair_inspector.viewer.compute.sensitivity import SWEPT_QUANTITIES, Sweep, sweep
from stair_inspector.viewer.compute.side_runs import SideJob, SideRuns
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.tune.sensitivity_html import sweep_html


class SweepTool:
    """Sweeps on a thread of its own: a sweep takes a minute, and must not be dropped for a comparison."""

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._sweep: tuple[str, Sweep] | None = None
        widgets = context.widgets
        with widgets.folder("Sensitivity", is_open=False):
            self.setting = widgets.dropdown(
                "Setting", tuple(sweep_titles().values()), hint="Which is moved; all others stay."
            )
            self.quantity = widgets.dropdown(
                "Quantity",
                tuple(SWEPT_QUANTITIES.values()),
                hint="What is drawn over the setting.",
                on_change=lambda _: self.draw(),
            )
            self._start = widgets.button(
                "Sweep over its range",
                self.start,
                icon=viser.Icon.CHART_LINE,
                hint="Measures at values over the whole range: a good setting lies on a plateau.",
            )
            self.stop = widgets.button(
                "Stop the sweep",
                self.cancel,
                icon=viser.Icon.PLAYER_STOP,
                hint="What was measured so far stays.",
                is_quiet=True,
                is_visible=False,
            )
            self.swept = widgets.html()
        name = f"stair-sweep-{desk.client.client_id}"
        self._runs = SideRuns(context.workshop, desk.notices, lambda: desk.is_closed, name)

    def start(self) -> None:
        """Measure at values over the whole range of the chosen setting."""
        shown = self._desk.result("sweep")
        name = next((key for key, title in sweep_titles().items() if title == self.setting.value), None)
        if name is None:
            raise ConfigError("sweep: choose a setting of the menu")
        with self._desk.lock:
            self._show_sweeping(True)
            self._runs.start(lambda job: self._measure(shown, name, job))

    def cancel(self) -> None:
        """End the sweep; what has been measured stays shown."""
        self._runs.stop()

    def close(self) -> None:
        """End the thread."""
        self._runs.close()

    def draw(self) -> None:
        """Draw the sweep, as far as it has come, for the chosen quantity."""
        if self._quantity() is None:
            raise ConfigError("sweep: choose a quantity of the menu")
        self.show()

    def show(self) -> None:
        """Draw the sweep of the scan that is shown, in the present unit; another scan's is dropped, and stopped."""
        with self._desk.lock:
            if self._sweep is None:
                return
            swept, found = self._sweep
            shown, quantity = self._desk.shown, self._quantity()
            if shown is None or swept != shown.inspection.scan.sha256:
                self._runs.stop()
                self._sweep = None
                self.swept.content = ""
            elif quantity is not None:
                self.swept.content = sweep_html(found, quantity, self._desk.unit)

    def _quantity(self) -> str | None:
        return next((key for key, title in SWEPT_QUANTITIES.items() if title == self.quantity.value), None)

    def _show_sweeping(self, is_sweeping: bool) -> None:
        """Offer to stop the sweep while it runs, and to start one otherwise."""
        self._start.visible, self.stop.visible = not is_sweeping, is_sweeping

    def _measure(self, shown: Shown, name: str, job: SideJob) -> None:
        sha256 = shown.inspection.scan.sha256

        def is_wanted() -> bool:
            now = self._desk.shown
            return job.is_wanted() and now is not None and now.inspection.scan.sha256 == sha256

        def tell(found: Sweep) -> None:
            with self._desk.lock:
                if is_wanted():
                    self._sweep = (sha256, found)
                    self.show()

        try:
            tell(sweep(shown.scan, shown.inspection.params, name, job.memo, is_wanted, tell))
        finally:
            with self._desk.lock:
                if self._runs.is_last(job) and not self._desk.is_closed:
                    self._show_sweeping(False)


def sweep_titles() -> dict[str, str]:
    """Return the settings that can be swept, by dotted name, with their titles on the page."""
    return {name: SETTINGS.setting(name).called for name in SETTINGS.swept()}
