"""Kept runs and sweeps: results beside the one that is shown, computed on a thread of their own."""

from collections.abc import Callable
from typing import Any

from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.projects import KeptRun
from stair_inspector.model import Inspection
from stair_inspector.pipeline import Memo, inspect
from stair_inspector.viewer.comparison import compare, comparison_html
from stair_inspector.viewer.controls import title_of_setting
from stair_inspector.viewer.desk import Desk, Editor, Shown
from stair_inspector.viewer.markup import DIM, text
from stair_inspector.viewer.panel import Panel
from stair_inspector.viewer.sensitivity import SWEPT_QUANTITIES, SWEPT_SETTINGS, Sweep, sweep
from stair_inspector.viewer.sensitivity_html import sweep_html
from stair_inspector.viewer.tabs.tune import NO_RUN
from stair_inspector.viewer.worker import Cancelled, Newest, Workshop


class Comparing:
    """The folders "Compare A / B" and "Sensitivity" of the Tune tab."""

    def __init__(self, desk: Desk, panel: Panel, editor: Editor, workshop: Workshop) -> None:
        self._desk = desk
        self._tab = panel.tune
        self._editor = editor
        self._workshop = workshop
        self._made: dict[str, Inspection] = {}
        self._chosen = ""
        self._is_stopped = False
        self._sweep: Sweep | None = None
        self._side: Newest[Callable[[], None]] = Newest(self._run, name=f"stair-side-{desk.client.client_id}")

    def close(self) -> None:
        """End the thread."""
        self._is_stopped = True
        self._side.close()

    # Kept runs.

    def keep(self, name: object) -> None:
        """Keep the settings of the result that is shown, to compare others with it."""
        shown = self._desk.result("keep")
        run = KeptRun(" ".join(str(name).split()), shown.inspection.params)
        kept = tuple(each for each in self._editor.work.runs if each.name != run.name)
        self._made[run.name] = shown.inspection
        self._chosen = run.name
        self._editor.change(f"kept run {run.name}", runs=(*kept, run))
        self._tab.run_name.value = _next_name([each.name for each in self._editor.work.runs])

    def compare_with(self, name: str) -> None:
        """Show the differences from a kept run, or none."""
        if name != NO_RUN and name not in {run.name for run in self._editor.work.runs}:
            raise ConfigError(f"compare with: got {str(name)[:40]!r}; choose one of the menu")
        self._chosen = "" if name == NO_RUN else name
        self.show()

    def take_settings(self) -> None:
        """Use the settings of the run that is compared with."""
        run = self._run_chosen()
        self._editor.apply(run.params, f"settings of run {run.name}")

    def forget(self) -> None:
        """Delete the run that is compared with."""
        run = self._run_chosen()
        self._chosen = ""
        runs = tuple(each for each in self._editor.work.runs if each is not run)
        self._editor.change(f"forgot run {run.name}", runs=runs)
        self._tab.run_name.value = _next_name([each.name for each in runs])

    def show(self) -> None:
        """List the kept runs, and show the differences from the chosen one."""
        with self._desk.lock:
            runs = {run.name: run for run in self._editor.work.runs}
            if self._chosen not in runs:
                self._chosen = ""
            self._tab.offer_runs(tuple(runs), self._chosen or NO_RUN)
            shown = self._desk.shown
            if not self._chosen or shown is None:
                self._tab.comparison.content = ""
                return
            run = runs[self._chosen]
            made = self._made.get(run.name)
            if made is None or made.params != run.params or made.scan.sha256 != shown.inspection.scan.sha256:
                self._tab.comparison.content = _said(f"measuring run {run.name} …")
                self._side.submit(lambda: self._measure(shown, run))
                return
            self._tab.comparison.content = comparison_html(
                compare(made, shown.inspection), run.name, "now", self._desk.unit
            )

    def _measure(self, shown: Shown, run: KeptRun) -> None:
        try:
            self._made[run.name] = inspect(shown.scan, run.params, self._memo())
        except StairError as error:
            words = f"run {run.name}: {error}"
            with self._desk.lock:
                self._tab.comparison.content = _said(words)
        else:
            self.show()

    def _run_chosen(self) -> KeptRun:
        run = next((run for run in self._editor.work.runs if run.name == self._chosen), None)
        if run is None:
            raise ConfigError("compare: choose a kept run first")
        return run

    # Sweeps.

    def sweep(self) -> None:
        """Measure at values over the whole range of the chosen setting."""
        shown = self._desk.result("sweep")
        name = next((key for key, title in sweep_titles().items() if title == self._tab.sweep_setting.value), None)
        if name is None:
            raise ConfigError("sweep: choose a setting of the menu")
        self._is_stopped = False
        self._tab.show_sweeping(True)
        self._side.submit(lambda: self._measure_sweep(shown, name))

    def stop_sweep(self) -> None:
        """End the sweep; what has been measured stays shown."""
        self._is_stopped = True

    def show_sweep(self) -> None:
        """Draw the sweep, as far as it has come, for the chosen quantity."""
        quantity = next(
            (key for key, title in SWEPT_QUANTITIES.items() if title == self._tab.sweep_quantity.value), None
        )
        if quantity is None:
            raise ConfigError("sweep: choose a quantity of the menu")
        with self._desk.lock:
            if self._sweep is not None:
                self._tab.sweep.content = sweep_html(self._sweep, quantity, self._desk.unit)

    def _measure_sweep(self, shown: Shown, name: str) -> None:
        def tell(found: Sweep) -> None:
            self._sweep = found
            self.show_sweep()

        try:
            tell(sweep(shown.scan, shown.inspection.params, name, self._memo(), self._is_sweep_wanted, tell))
        finally:
            self._tab.show_sweeping(False)

    def _is_sweep_wanted(self) -> bool:
        # Runs of the page itself come first: the sweep waits for nobody and is only stopped.
        return not (self._is_stopped or self._desk.is_closed)

    # The thread.

    def _memo(self) -> Memo:
        def heavy(function: Callable[..., Any], *inputs: object) -> Any:
            return self._workshop.heavy(function, *inputs, is_wanted=self._is_sweep_wanted)

        return Memo(heavy=heavy)

    def _run(self, job: Callable[[], None]) -> None:
        try:
            job()
        except Cancelled:
            return
        except StairError as error:
            self._desk.notices.tell("Not done", str(error), is_failure=True)
        except Exception:  # noqa: BLE001 - the outermost frame of this thread
            self._desk.notices.log("a comparison or a sweep failed")
            self._desk.notices.tell(
                "Not done", "an internal error stopped this; the server's log has the details", is_failure=True
            )


def sweep_titles() -> dict[str, str]:
    """Return the settings that can be swept, by dotted name, with their titles on the page."""
    return {name: title_of_setting(name) for name in SWEPT_SETTINGS}


def _next_name(taken: list[str]) -> str:
    letters = (chr(ord("A") + k) for k in range(26))
    return next((letter for letter in letters if letter not in taken), f"run {len(taken) + 1}")


def _said(words: str) -> str:
    return f'<div data-testid="comparison" style="font-size:12px;color:{DIM};padding:2px 9px 6px">{text(words)}</div>'
