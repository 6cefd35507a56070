"""One inspector's page: its parts, the work on its scans, its last good result, and the thread that computes for it.

A walk from a slider to the pipeline and back, in this order:

1. ``bridge.controls.SettingControls`` made the slider, on the tab of a part. Moved by a person, it calls
   :meth:`stair_inspector.viewer.state.editor.Editor.submit`.
2. The editor reads all controls, keeps the settings as a change that can be undone, and has :meth:`Page._run` ask for
   a run. Its ``changed(HISTORY)`` lets the Tune tab say what can be undone now.
3. ``compute.runs.Runs`` computes the newest request on a thread of its own: it reads the scan by :meth:`Page._find`,
   calls :func:`stair_inspector.pipeline.inspect`, and tells what it is at to :meth:`Page._progress`.
4. :meth:`Page._done` puts the result on the desk and calls ``changed(RESULT)``; or :meth:`Page._failed` says why there
   is none, and the last good one stays.
5. :meth:`Page.changed` lets every part of :data:`PARTS` that depends on what has changed show itself, all in one.

What a part does by itself goes the same way from its own method: it changes the work through the editor, or what is
chosen and seen on the desk, and ``changed`` shows it wherever it is seen.
"""

import contextlib
from collections.abc import Callable, Mapping

import numpy as np
import viser

from stair_inspector.errors import ReadError
from stair_inspector.files.palettes import Palette
from stair_inspector.model import Inspection, Scan
from stair_inspector.params import FileReading
from stair_inspector.viewer.bridge.controls import SettingControls
from stair_inspector.viewer.bridge.handles import late_messages
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.bridge.shortcuts import Command, HelpCard, add_commands
from stair_inspector.viewer.bridge.widgets import Widgets
from stair_inspector.viewer.compute.jobs import Making
from stair_inspector.viewer.compute.runs import CANCELLED, Listener, Prepared, Progress, Request, Runs
from stair_inspector.viewer.compute.workshop import Workshop
from stair_inspector.viewer.parts.checks.part import ChecksPart
from stair_inspector.viewer.parts.desk import Desk, Shown
from stair_inspector.viewer.parts.docked.part import DockedPart
from stair_inspector.viewer.parts.drawing import SceneDrawing
from stair_inspector.viewer.parts.export.part import ExportPart
from stair_inspector.viewer.parts.findings.part import FindingsPart
from stair_inspector.viewer.parts.foot import Foot
from stair_inspector.viewer.parts.frame import Frame
from stair_inspector.viewer.parts.judge import Judge
from stair_inspector.viewer.parts.look.part import LookPart
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.scan.part import ScanPart
from stair_inspector.viewer.parts.scene_look import SceneLook
from stair_inspector.viewer.parts.second.part import SecondScanPart
from stair_inspector.viewer.parts.steps.part import StepsPart
from stair_inspector.viewer.parts.tune.part import TunePart
from stair_inspector.viewer.scene.stage import Stage
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.editor import Editor
from stair_inspector.viewer.state.keeper import Keeper
from stair_inspector.viewer.state.library import Library
from stair_inspector.viewer.state.opening import Opening
from stair_inspector.viewer.state.wishes import KeptWishes
from stair_inspector.viewer.state.work import Work

PARTS: tuple[type[PagePart], ...] = (
    SceneDrawing,
    Frame,
    DockedPart,
    ScanPart,
    TunePart,
    StepsPart,
    ChecksPart,
    FindingsPart,
    LookPart,
    SecondScanPart,
    ExportPart,
    Foot,
)
"""Every part, from the top of the panel to its foot; each that has a title is a tab. What lies over the drawing comes
after it."""


class Page:
    """The page of one connected browser.

    Parameters
    ----------
    client : viser.ClientHandle
        The browser.
    workshop : Workshop
        Shared with the other inspectors.
    library : Library
        The scans, and where projects are saved.
    started : Work
        What the work on a scan begins with; its settings are also those to reset to.
    palettes : mapping
        By name, colours of the page in its light and in its dark theme.
    kept : KeptWishes
        What pages that have gone were last at.
    end : callable
        Closes this page; called when its browser has come back while this page no longer answers.
    is_view_only : bool
        Whether it shows the saved work and changes nothing of it.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        workshop: Workshop,
        library: Library,
        started: Work,
        palettes: Mapping[str, tuple[Palette, Palette]],
        kept: KeptWishes,
        end: Callable[[], None],
        is_view_only: bool,
    ) -> None:
        notices = Notices(client)
        self.desk = Desk(client, notices, palettes, Stage(client), changed=self.changed)
        self.keeper = Keeper(library, self._on_saved, is_view_only=is_view_only)
        controls = SettingControls(client.gui, started.params, notices.guard(lambda: self.editor.submit()))
        self.editor = Editor(self.keeper, controls, started.params, self._run, self.changed, self._failed)
        self.opening = Opening(client, library, self.keeper, controls, notices, started, kept, end)
        listener = Listener(self._find, self._done, self._failed, self._progress)
        self.runs = Runs(workshop, listener, notices, f"stair-session-{client.client_id}")
        self.making = Making(self.show_making, lambda: self.desk.is_closed)
        self.look = SceneLook(self.desk)
        self.judge = Judge(self.desk, self.editor)
        self.parts: tuple[PagePart, ...] = ()
        try:
            self.opening.restore()
            self._make_parts(Widgets(client.gui, notices.guard), workshop)
            self.desk.status.waiting = "starting …"
            self.changed(*PageChange)
            self.editor.submit()
        except BaseException:
            self.close()
            raise

    def _make_parts(self, widgets: Widgets, workshop: Workshop) -> None:
        context = Context(
            widgets=widgets,
            desk=self.desk,
            look=self.look,
            judge=self.judge,
            editor=self.editor,
            keeper=self.keeper,
            opening=self.opening,
            workshop=workshop,
            making=self.making,
            runs=self.runs,
            help=HelpCard(widgets.gui),
            cancel=self.cancel,
            commands=self.commands,
            put_away=self.put_away,
        )
        tabs: viser.GuiTabGroupHandle | None = None
        for kind in PARTS:
            if kind.title and tabs is None:
                tabs = widgets.gui.add_tab_group()
            place = tabs.add_tab(kind.title, kind.icon) if kind.title and tabs is not None else contextlib.nullcontext()
            with place:
                self.parts = (*self.parts, kind(context))
        add_commands(widgets.gui, self.commands())

    def close(self) -> None:
        """Let go of everything; called when the page is gone."""
        self.desk.is_closed = self.desk.notices.is_closed = True
        self.runs.close()
        for part in self.parts:
            part.close()
        self.keeper.close()
        # The project is free by then: the page that comes back takes up the same one.
        self.opening.leave()

    # What the parts have together.

    def changed(self, *what: PageChange) -> None:
        """Let the parts that depend on a change show themselves, all at once."""
        with self.desk.lock, late_messages(self.desk.client), self.desk.client.atomic():
            if self.desk.is_closed:
                return
            changes = frozenset(what)
            if changes & {PageChange.WORK, PageChange.RESULT}:
                self.judge.judge()
            for part in self.parts:
                if part.depends_on & changes:
                    part.show(changes)

    def commands(self) -> tuple[Command, ...]:
        """Return the commands of all parts, each guarded."""
        guard = self.desk.notices.guard
        return tuple(
            Command(each.label, guard(each.action), each.key, each.modifier)
            for part in self.parts
            for each in part.commands()
        )

    def put_away(self) -> None:
        """Put the selection or the tool in use away."""
        for part in reversed(self.parts):
            if part.put_away():
                return

    def cancel(self) -> None:
        """Stop what is being computed or made for this page."""
        self.runs.cancel()
        self.making.cancel()
        for part in self.parts:
            part.cancel()

    # Runs: called on the thread that computes, but for the first.

    def _run(self) -> None:
        """Ask for a run with the present work; the keeper's lock is held."""
        self.runs.submit(Request(self.keeper.label, self.editor.work.params), self.keeper.scan)

    def _find(self, request: Request, read: Callable[[FileReading], Scan]) -> tuple[Request, Scan]:
        """Read a scan; work that was done on another state of the file is put aside."""
        try:
            scan = read(request.params.reading)
        except ReadError as error:
            self.opening.mark(request.label, error)
            raise
        self.opening.mark(request.label, None)
        if self.opening.is_of(request.label, scan.sha256):
            return request, scan
        self.changed(PageChange.WORK)
        with self.keeper.lock:
            bench = self.keeper.bench(request.label)
            params = bench.history.value.params if bench is not None else request.params
        return Request(request.label, params), read(params.reading)

    def _progress(self, progress: Progress) -> None:
        """Say what is being computed; the last good result stays, dimmed."""
        with self.desk.lock:
            if self.runs.is_busy():
                self.desk.status.running = progress
                self.changed(PageChange.STATUS)

    def _done(self, request: Request, scan: Scan, inspection: Inspection, prepared: Prepared) -> None:
        """Show a result, all of it at once."""
        desk, look, status = self.desk, self.look, self.desk.status
        with desk.lock:
            if desk.is_closed or request.label != self.keeper.label:
                return
            status.running = status.waiting = None
            before = desk.shown
            is_new_scan = before is None or before.scan is not scan
            look.know_normals(scan, prepared.normals)
            display = look.display(scan) if is_new_scan or before is None else before.display
            shown = Shown(request.label, scan, display, inspection)
            # If making a part of the page fails, the exports stay those of the result that is still shown.
            look.prepare(shown)
            desk.show(shown)
            desk.heights = prepared.heights
            # A run that was under way may end after a control was set to something impossible: that stays said.
            status.error = self.editor.refusal
            # While a slider moves, the next run waits already; dimming the table each time would flicker.
            if self.runs.has_waiting() and status.error is None:
                status.waiting = "measuring …"
            # The scene is turned upright only for another scan or another up: nothing jumps while a slider moves.
            is_turned = before is not None and not np.array_equal(before.inspection.up.vector, inspection.up.vector)
            self.changed(PageChange.RESULT, *((PageChange.SCAN,) if is_new_scan or is_turned else ()))
            if not self.runs.has_waiting():
                self.changed(PageChange.REST)

    def _failed(self, words: str) -> None:
        """Say why there is no result; the last good one stays."""
        desk, status = self.desk, self.desk.status
        with desk.lock:
            if words == CANCELLED and desk.shown is None:
                words = "cancelled before anything was measured. Press Run again, or choose another scan"
            status.running = status.waiting = None
            status.error = self.editor.refusal or " ".join(words.split())
            instead = self.opening.readable_instead()
            if instead is None:
                self.changed(PageChange.STATUS, PageChange.WORK)
                return
            desk.notices.tell("Another scan opened", f"{status.error}; {instead} is opened instead", is_failure=True)
            with self.keeper.lock:
                self.opening.open_instead(instead)
                self.desk.status.begin("opening …")
                self.editor.ask()
            self.changed(PageChange.RESULT, PageChange.SCAN, PageChange.WORK, PageChange.STATUS)

    # What is made and saved beside the runs.

    def show_making(self, words: str | None, percent: float) -> None:
        """Show how far the making of files is; None when it is over."""
        with self.desk.lock:
            self.desk.status.made = None if words is None else Progress(words, percent)
            self.changed(PageChange.STATUS)

    def _on_saved(self, words: str, is_failure: bool) -> None:
        # A page that is gone must not wait for whoever draws on it: its work is free for the next page only then.
        if self.desk.is_closed:
            return
        self.changed(PageChange.STATUS)
        if words:
            self.desk.notices.tell("Not saved" if is_failure else "Saved elsewhere", words, is_failure=is_failure)
