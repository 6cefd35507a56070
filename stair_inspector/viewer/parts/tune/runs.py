"""The folder "Compare A / B" of the Tune tab: earlier results and kept runs beside the one that is shown."""

import itertools
from dataclasses import dataclass
from functools import partial

import viser

from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.projects import KeptRun
from stair_inspector.model import Inspection
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.viewer.bridge.markup import aside
from stair_inspector.viewer.bridge.widgets import Widgets, offer
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.compute.side_runs import SideJob, SideRuns
from stair_inspector.viewer.parts.desk import Shown
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.parts.tune.comparison import compare, comparison_html
from stair_inspector.viewer.parts.tune.run_history import MOST_RUNS, RunHistory

NO_RUN = "none"
AS_SHOWN = "what is shown"
"""What menus say for no result, and for the one that the page shows."""
_USE, _FORGET = "Use its settings", "Forget it"

_MOST_MADE = 3
"""Results kept beside the one that is shown: each holds some numbers for every point of the scan."""
_CANCELLED = "cancelled; choose another result, then this one again"


@dataclass(frozen=True, slots=True)
class _Choice:
    """A result that can be compared: its title in the menu, its settings, and where it is remembered."""

    title: str
    params: Params
    kept: KeptRun | None = None
    number: int | None = None

    @property
    def key(self) -> tuple[str, int]:
        return ("", self.number) if self.number is not None else (self.title, 0)


class RunComparison:
    """Compares two results; what is not known any more is measured again on a thread of its own."""

    def __init__(self, context: Context) -> None:
        self._desk = desk = context.desk
        self._editor = context.editor
        self._keeper = context.keeper
        self._workshop = context.workshop
        self._add_comparison(context.widgets)
        self._history = RunHistory()
        # Results, and sentences why there is none, by scan and settings.
        self._made: list[tuple[str, Params, Inspection]] = []
        self._refused: list[tuple[str, Params, str]] = []
        self._a: tuple[str, int] | None = None
        self._b: tuple[str, int] | None = None
        self._asked: tuple[str, Params] | None = None
        name = f"stair-compare-{desk.client.client_id}"
        self._runs = SideRuns(context.workshop, desk.notices, lambda: desk.is_closed, name)

    def _add_comparison(self, widgets: Widgets) -> None:
        with widgets.folder("Compare A / B", is_open=False):
            self.run_name = widgets.text("Name", "run 1", hint="What these settings are kept under.")
            widgets.button(
                "Keep this result",
                lambda: self.keep(self.run_name.value),
                icon=viser.Icon.PIN,
                hint="To compare others with it.",
            )
            self.menu_a = widgets.dropdown(
                "Result A",
                (NO_RUN,),
                hint="A kept run, or one of the last results by what was changed for it.",
                on_change=self.compare_with,
            )
            self.menu_b = widgets.dropdown(
                "Result B",
                (AS_SHOWN,),
                hint="Its numbers beside those of A, and the differences, step by step.",
                is_visible=False,
                on_change=self.compare_to,
            )
            self._tools = widgets.buttons(
                "With A",
                (_USE, _FORGET),
                lambda option: self.forget() if option == _FORGET else self.take_settings(),
                is_visible=False,
                hint="Of a kept run, both can be undone.",
            )
            self.comparison = widgets.html()

    def close(self) -> None:
        """End the thread."""
        self._runs.close()

    def cancel(self) -> None:
        """Stop what is being measured to be compared."""
        self._runs.stop()

    # Results to compare.

    def keep(self, name: object) -> None:
        """Keep the settings of the result that is shown, to compare others with it."""
        shown = self._desk.result("keep")
        run = KeptRun(" ".join(str(name).split()), shown.inspection.params)
        with self._desk.lock:
            self._remember(shown.inspection.scan.sha256, run.params, shown.inspection)
            self._a = (run.name, 0)
        self._editor.edit(
            f"kept run {run.name}",
            lambda work: {"runs": (*(each for each in work.runs if each.name != run.name), run)},
        )
        self.run_name.value = _next_name([each.name for each in self._editor.work.runs])

    def compare_with(self, title: str) -> None:
        """Choose result A, or none."""
        self._choose(title, NO_RUN, is_a=True)

    def compare_to(self, title: str) -> None:
        """Choose result B, or the one that is shown."""
        self._choose(title, AS_SHOWN, is_a=False)

    def take_settings(self) -> None:
        """Use the settings of result A."""
        choice = self._choice_a()
        self._editor.adjust(lambda _: choice.params, f"settings of {choice.title}")

    def forget(self) -> None:
        """Delete result A, kept by hand or not."""
        choice = self._choice_a()
        with self._desk.lock:
            self._a = None
            self._made = [made for made in self._made if made[1] != choice.params]
        if choice.kept is None:
            self._history.forget(choice.number or 0)
            self.show()
            return
        self._editor.edit(
            f"forgot run {choice.title}",
            lambda work: {"runs": tuple(each for each in work.runs if each.name != choice.title)},
        )
        self.run_name.value = _next_name([each.name for each in self._editor.work.runs])

    def show(self) -> None:
        """List the results, and show the differences between the chosen ones."""
        with self._desk.lock:
            shown = self._desk.shown
            if shown is not None:
                self._history.record(shown.inspection)
            choices = {choice.key: choice for choice in self._choices()}
            self._a, self._b = (key if key in choices else None for key in (self._a, self._b))
            a, b = (choices.get(key) if key is not None else None for key in (self._a, self._b))
            titles = tuple(choice.title for choice in choices.values())
            self._offer(titles, a.title if a is not None else NO_RUN, b.title if b is not None else AS_SHOWN)
            if a is None or shown is None:
                self.comparison.content = ""
                return
            self.comparison.content = self._comparison(shown, a, b)

    def _comparison(self, shown: Shown, a: _Choice, b: _Choice | None) -> str:
        """Return the differences, or why there are none yet; what is missing is asked for."""
        found: list[Inspection] = []
        for choice in (a, b):
            made = shown.inspection if choice is None else self._find(shown, choice.params)
            if isinstance(made, str) and choice is not None:
                return aside("comparison", f"{choice.title}: {made}")
            if made is None and choice is not None:
                self._ask(shown, choice.params)
                return aside("comparison", f"measuring {choice.title} …")
            if isinstance(made, Inspection):
                found.append(made)
        try:
            comparison = compare(found[0], found[1])
        except StairError as error:
            return aside("comparison", str(error))
        return comparison_html(comparison, a.title, "what is shown" if b is None else b.title, self._desk.unit)

    def _offer(self, titles: tuple[str, ...], a: str, b: str) -> None:
        """List the results that can be compared, and show the chosen ones."""
        for menu, nothing, chosen in ((self.menu_a, NO_RUN, a), (self.menu_b, AS_SHOWN, b)):
            offer(menu, (nothing, *titles), chosen)
        self._tools.visible = self.menu_b.visible = a != NO_RUN

    def _find(self, shown: Shown, params: Params) -> Inspection | str | None:
        """Return the result of settings on the present scan, why there is none, or None where it is not known yet."""
        if shown.inspection.params == params:
            return shown.inspection
        sha256 = shown.inspection.scan.sha256
        outcomes: list[tuple[str, Params, Inspection | str]] = [*self._made, *self._refused]
        return next((outcome for *known, outcome in outcomes if known == [sha256, params]), None)

    def _ask(self, shown: Shown, params: Params) -> None:
        """Have settings measured, unless that is under way; what was asked for before is given up."""
        wanted = (shown.inspection.scan.sha256, params)
        if self._asked == wanted:
            return
        self._asked = wanted
        self._runs.start(partial(self._measure, shown, params))

    def _measure(self, shown: Shown, params: Params, job: SideJob) -> None:
        sha256 = shown.inspection.scan.sha256
        # Of what nobody foresaw, which goes to the log.
        outcome: Inspection | str = "an internal error; the server's log has the details"
        try:
            scan = shown.scan
            if params.reading != shown.inspection.params.reading:
                # The same numbers of the file are other points.
                scan = self._workshop.read(self._keeper.scan, params.reading, job.is_wanted)
            if scan.sha256 != sha256:
                raise ConfigError(f"{shown.label} has changed since; press Run again")
            outcome = inspect(scan, params, job.memo)
        except Cancelled:
            outcome = _CANCELLED
        except StairError as error:
            outcome = str(error)
        finally:
            with self._desk.lock:
                # If it is not the last that was asked for, it was given up for that.
                if self._runs.is_last(job):
                    self._asked = None
                    self._remember(sha256, params, outcome)
                    if not self._desk.is_closed:
                        self.show()

    def _remember(self, sha256: str, params: Params, outcome: Inspection | str) -> None:
        if isinstance(outcome, str):
            self._refused = [*self._refused, (sha256, params, outcome)][-MOST_RUNS:]
        else:
            self._made = [*self._made, (sha256, params, outcome)][-_MOST_MADE:]

    def _choose(self, title: str, nothing: str, *, is_a: bool) -> None:
        with self._desk.lock:
            choice = next((choice for choice in self._choices() if choice.title == title), None)
            if choice is None and title != nothing:
                raise ConfigError(f"compare: got {str(title)[:40]!r}; choose one of the menu")
            if choice is not None:
                # Chosen anew, it is measured anew.
                self._refused = [each for each in self._refused if each[1] != choice.params]
            key = choice.key if choice is not None else None
            if is_a:
                self._a = key
            else:
                self._b = key
            self.show()

    def _choice_a(self) -> _Choice:
        with self._desk.lock:
            choice = next((choice for choice in self._choices() if choice.key == self._a), None)
        if choice is None:
            raise ConfigError("compare: choose result A first")
        return choice

    def _choices(self) -> tuple[_Choice, ...]:
        """Return what can be compared on the present scan, each with a title of its own: kept runs, then the last."""
        choices = [_Choice(run.name, run.params, kept=run) for run in self._editor.work.runs]
        taken = {NO_RUN, AS_SHOWN, *(choice.title for choice in choices)}
        shown = self._desk.shown
        for run in self._history.of(shown.inspection.scan.sha256) if shown is not None else ():
            title = run.title if run.title not in taken else f"{run.title} (history)"
            if title not in taken:
                taken.add(title)
                choices.append(_Choice(title, run.params, number=run.number))
        return tuple(choice for choice in choices if choice.title not in (NO_RUN, AS_SHOWN))


def _next_name(taken: list[str]) -> str:
    return next(name for number in itertools.count(1) if (name := f"run {number}") not in taken)
