"""The Compare tab: a second scan of the stair, what changed against it, and the maps of treads."""

from collections.abc import Callable
from dataclasses import replace

import viser

from stair_inspector.content.remarks import on_page
from stair_inspector.errors import StairError, one_of
from stair_inspector.files.projects import SecondScan
from stair_inspector.model import ComparedScan, Inspection
from stair_inspector.viewer.bridge.markup import aside, text
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.bridge.widgets import File, offer
from stair_inspector.viewer.compute.heavy_process import Cancelled
from stair_inspector.viewer.compute.side_runs import SideJob, SideRuns
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.second.changes_html import changes_html, maps_html, words_html
from stair_inspector.viewer.parts.second.comparing import ChangedScanError, SecondMeasured
from stair_inspector.viewer.parts.table import pick_row
from stair_inspector.viewer.scene.step_marks import tone_css
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.library import upload_types

NO_SCAN = "none"
_SIDES = ("Earlier", "Later")
_MAPS = ("Chosen step", "All steps")
_INTRODUCTION = (
    "A second scan of this stair, from another date or from before or after works, is laid onto this one on what did "
    "not move: every change is told with its U, and shown on the treads."
)
_CANCELLED = "cancelled; compare anew, or end the comparison"


class SecondScanPart(PagePart):
    """Chooses a second scan, compares it whenever a result is at rest, and shows what changed."""

    title = "Compare"
    icon = viser.Icon.ARROWS_DIFF
    depends_on = frozenset(
        {
            PageChange.WORK,
            PageChange.RESULT,
            PageChange.SCAN,
            PageChange.SELECTION,
            PageChange.UNIT,
            PageChange.COMPARED,
            PageChange.COLORS,
            PageChange.STATUS,
            PageChange.REST,
        }
    )

    def __init__(self, context: Context) -> None:
        self._context = context
        self._desk = desk = context.desk
        self._editor = context.editor
        self._look = context.look
        self._measured = SecondMeasured(context.opening, context.workshop)
        self._runs = SideRuns(
            context.workshop, desk.notices, lambda: desk.is_closed, f"stair-second-{desk.client.client_id}"
        )
        # What is being compared, or was: of which result, with what; and what is said of it.
        self._asked: tuple[Inspection, SecondScan] | None = None
        self._choosing = self._doing = self._error = ""
        self._is_changed_file = self._is_cancelled = False
        self._side, self._maps = _SIDES[0], _MAPS[0]
        widgets = context.widgets
        self.introduction = widgets.html(aside("compare-words", _INTRODUCTION))
        self.scan = widgets.dropdown(
            "Second scan", (NO_SCAN,), hint="Of the same stair; it may lie anywhere.", on_change=self.choose
        )
        # An upload button cannot be hidden, a folder can.
        self.from_file = widgets.folder("From a file")
        with self.from_file:
            self.upload = widgets.upload(
                "Upload a second scan",
                upload_types(),
                self.take_upload,
                icon=viser.Icon.UPLOAD,
                hint="Kept until the server ends; only this browser sees it.",
            )
        self.side = widgets.choice(
            "It is the", _SIDES, self._side, self.set_side, hint="A change is the later value less the earlier one."
        )
        self.end = widgets.button(
            "End the comparison",
            self.end_comparison,
            icon=viser.Icon.X,
            hint="The second scan is left out of page and report again.",
            is_quiet=True,
            is_visible=False,
        )
        self.state = widgets.html()
        self.again = widgets.button(
            "Compare anew",
            self.compare_anew,
            icon=viser.Icon.REFRESH,
            hint="Once more, with the second scan's file as it is now.",
            is_quiet=True,
            is_visible=False,
        )
        self.words = widgets.html()
        self._picked = widgets.orders("Picked change", lambda message: pick_row(desk, message))
        self.colored = widgets.checkbox(
            "Colour the treads by the change",
            hint="In the scene, with a legend in millimetres.",
            is_visible=False,
            on_change=self.set_colored,
        )
        self.maps = widgets.choice("Maps", _MAPS, self._maps, self.set_maps, hint="Seen from above, nosing below.")
        self.map = widgets.html()
        self.table = widgets.html()

    def show(self, what: frozenset[PageChange]) -> None:
        """Compare what has come to rest, and show what is known."""
        if what & {PageChange.WORK, PageChange.RESULT, PageChange.SCAN, PageChange.REST}:
            self._follow(is_at_rest=PageChange.REST in what or not self._context.runs.is_busy())
        if what - {PageChange.REST}:
            self._show_choice()
        if what - {PageChange.REST, PageChange.STATUS}:
            self._show_changes()

    def commands(self) -> tuple[Command, ...]:
        """Return what the palette can do with a second scan."""
        return (Command("End the comparison with the second scan", self.end_comparison),)

    def cancel(self) -> None:
        """Stop what is read, measured or compared."""
        self._is_cancelled = bool(self._doing)
        self._runs.stop()

    def close(self) -> None:
        """End the thread."""
        self._runs.close()

    # What a person does.

    def choose(self, option: str) -> None:
        """Compare with a scan of the list, or with none."""
        if option == NO_SCAN:
            self.end_comparison()
            return
        self._open(one_of(option, self._labels(), "second scan"))

    def take_upload(self, file: File) -> None:
        """Compare with an uploaded scan."""
        self._open(self._context.opening.keep_upload(file))

    def set_side(self, option: str) -> None:
        """Say whether the second scan is the earlier or the later one."""
        side = one_of(option, _SIDES, "second scan")
        with self._desk.lock:
            self._side = side
            self.side.show(side)
            second = self._editor.work.second
            if second is not None:
                self._editor.change(
                    f"the second scan is the {side.lower()} one", second=replace(second, is_earlier=side == _SIDES[0])
                )

    def set_maps(self, option: str) -> None:
        """Show the map of the chosen step, or all."""
        with self._desk.lock:
            self._maps = one_of(option, _MAPS, "maps")
            self._show_changes()

    def set_colored(self, is_on: bool) -> None:
        """Colour the treads in the scene by the change, or the steps as before."""
        self._look.set_color("Change" if is_on else "Step")

    def compare_anew(self) -> None:
        """Compare once more, with the second scan's file as it is now."""
        with self._desk.lock:
            second = self._editor.work.second
            label = self._context.opening.label_of(second) if second is not None else None
            if label is not None and self._is_changed_file:
                self._open(label)
                return
            self._asked = None
            self._follow(is_at_rest=True)
            self._show_choice()

    def end_comparison(self) -> None:
        """Compare with nothing any more; can be undone."""
        with self._desk.lock:
            self._runs.stop()
            self._choosing = self._error = ""
            second = self._editor.work.second
            if second is not None:
                self._editor.change(f"ended the comparison with {second.shown_name}", second=None)
            else:
                self._show_choice()

    # What is computed: the jobs run on a thread of their own.

    def _open(self, label: str) -> None:
        """Read a scan, and take it as the second one."""
        with self._desk.lock:
            shown = self._desk.result("compare")
            self._choosing, self._error = label, ""
            is_earlier = self._side == _SIDES[0]

            def work(job: SideJob) -> None:
                self._say(job, f"reading {label} …")
                second = self._measured.chosen(label, shown, job, is_earlier=is_earlier)
                with self._desk.lock:
                    if not (job.is_wanted() and self._desk.shown is not None and self._desk.shown.scan is shown.scan):
                        return
                    # The same file again is compared anew.
                    self._asked, self._choosing = None, ""
                    if second == self._editor.work.second:
                        self._follow(is_at_rest=True)
                    else:
                        self._editor.change(f"second scan {label}", second=second)

            self._start(work)

    def _follow(self, *, is_at_rest: bool) -> None:
        """Compare the result that is shown with the second scan that was chosen; the desk is held."""
        desk, second, shown = self._desk, self._editor.work.second, self._desk.shown
        if second is None or shown is None:
            if self._asked is not None:
                self._runs.stop()
                self._asked, self._error = None, ""
            self._is_changed_file = False
            desk.compared, desk.uncompared = None, ""
            if second is None and self._look.color_mode == "Change":
                self._look.set_color("Step")
            return
        self._side = _SIDES[0 if second.is_earlier else 1]
        if self._asked is not None and self._asked[0] is shown.inspection and self._asked[1] == second:
            return
        made = "is still being made; wait for it, or end it under Compare"
        desk.compared, desk.uncompared = None, f"the comparison with {second.shown_name} {made}"
        if not is_at_rest:
            # The next result will be compared; what is being compared is of one that is no longer shown.
            self._runs.stop()
            return
        is_first = self._asked is None or self._asked[1] != second
        self._asked, self._error, self._is_changed_file = (shown.inspection, second), "", False

        def work(job: SideJob) -> None:
            compared = self._measured.compare(second, shown, job, lambda words: self._say(job, words))
            self._take(job, shown.inspection, compared, is_first=is_first)

        self._start(work)

    def _start(self, work: Callable[[SideJob], None]) -> None:
        def told(job: SideJob) -> None:
            words = "an internal error stopped this; the server's log has the details"
            try:
                work(job)
                words = ""
            except Cancelled:
                # What another result or the end of the comparison has stopped needs no words.
                words = _CANCELLED if self._is_cancelled else ""
            except StairError as error:
                words = str(error)
                self._is_changed_file = isinstance(error, ChangedScanError)
            finally:
                self._end(job, words)

        self._doing, self._is_cancelled = "waiting for the scan …", False
        self._runs.start(told)

    def _say(self, job: SideJob, words: str) -> None:
        with self._desk.lock:
            if job.is_wanted():
                self._doing = words
                self._desk.changed(PageChange.COMPARED)

    def _take(self, job: SideJob, inspection: Inspection, compared: ComparedScan, *, is_first: bool) -> None:
        desk = self._desk
        with desk.lock:
            if not job.is_wanted() or desk.inspection is not inspection:
                return
            desk.compared, desk.uncompared = compared, ""
            self._doing = self._error = ""
            if is_first:
                self._look.color_mode = "Change"
            desk.changed(PageChange.COMPARED, PageChange.COLORS)

    def _end(self, job: SideJob, words: str) -> None:
        """Say that nothing is done any more, and why there is no comparison."""
        with self._desk.lock:
            if not self._runs.is_last(job) or self._desk.is_closed:
                return
            self._doing = self._choosing = ""
            self._error = on_page(" ".join(words.split()))
            if self._error and self._editor.work.second is not None:
                name = self._editor.work.second.shown_name
                self._desk.uncompared = f"there is no comparison with {name}; see why under Compare, or end it there"
                if self._error != _CANCELLED:
                    self._desk.notices.tell("Not compared", self._error, is_failure=True)
            self._desk.changed(PageChange.COMPARED)

    # What is shown; the desk is held.

    def _labels(self) -> tuple[str, ...]:
        present = self._context.keeper.label
        return tuple(label for label in self._context.opening.labels() if label != present)

    def _show_choice(self) -> None:
        """Show which scan is chosen, what is being done, and what can be done."""
        second, labels = self._editor.work.second, self._labels()
        chosen = self._choosing or NO_SCAN
        if second is not None and not self._choosing:
            chosen = self._context.opening.label_of(second) or second.shown_name
            labels = labels if chosen in (NO_SCAN, *labels) else (*labels, chosen)
        offer(self.scan, (NO_SCAN, *labels), chosen)
        self.side.show(self._side)
        self.introduction.visible = self.from_file.visible = second is None and not self._choosing
        self.end.visible = second is not None or bool(self._choosing)
        self.again.visible = second is not None and bool(self._error)
        self.state.content = _state_html(self._doing, self._error)

    def _show_changes(self) -> None:
        """Show what changed, and the maps."""
        desk = self._desk
        compared = desk.compared
        self.maps.show(self._maps)
        self.maps.group.visible = self.colored.visible = compared is not None
        self.colored.value = self._look.color_mode == "Change"
        if compared is None:
            self.words.content = self.map.content = self.table.content = ""
            return
        self.words.content = words_html(compared)
        self.table.content = changes_html(compared, desk.selected, self._picked, desk.unit)
        self.map.content = maps_html(compared, desk.selected, is_all=self._maps == _MAPS[1])


def _state_html(doing: str, error: str) -> str:
    if doing:
        return f'<div data-testid="compare-state" data-state="busy" role="status" style="{_LINE}">{text(doing)}</div>'
    if error:
        return (
            f'<div data-testid="compare-state" data-state="error" role="alert" '
            f'style="{_LINE};color:{tone_css("bad")}">{text(error)}</div>'
        )
    return '<div data-testid="compare-state" data-state="ready"></div>'


_LINE = "font-size:12px;padding:2px 9px 6px;overflow-wrap:anywhere"
