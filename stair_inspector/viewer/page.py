"""One inspector: a page, the work on its scans, its last good result, and the thread that computes for it."""

import contextlib
import dataclasses
from collections.abc import Callable
from typing import Any, Unpack

import numpy as np
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import Palette
from stair_inspector.model import Inspection, Scan
from stair_inspector.params import Params, ScanUnit
from stair_inspector.pictures.segmentation import view_from_local
from stair_inspector.viewer.bridge.controls import words_of_change
from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.bridge.notices import Notices
from stair_inspector.viewer.bridge.reach_drag import REACH
from stair_inspector.viewer.bridge.shortcuts import HelpCard
from stair_inspector.viewer.compute.jobs import Making
from stair_inspector.viewer.compute.runs import CANCELLED, Listener, Prepared, Progress, Request, Runs
from stair_inspector.viewer.compute.worker import Newest, Workshop
from stair_inspector.viewer.parts.checks.check import Checking
from stair_inspector.viewer.parts.checks.checks_html import RULE
from stair_inspector.viewer.parts.desk import Desk, Shown
from stair_inspector.viewer.parts.export.files import Exporting
from stair_inspector.viewer.parts.export.report import Reporting
from stair_inspector.viewer.parts.export.scene_views import SceneViews
from stair_inspector.viewer.parts.look.look import Looking
from stair_inspector.viewer.parts.look.toolbar import add_toolbar
from stair_inspector.viewer.parts.panel import Offers, Panel
from stair_inspector.viewer.parts.scan.opening import Opening
from stair_inspector.viewer.parts.scan.region import RegionTool
from stair_inspector.viewer.parts.scan.upright import UprightTool
from stair_inspector.viewer.parts.steps import html
from stair_inspector.viewer.parts.steps.examination_html import CURE
from stair_inspector.viewer.parts.steps.results import Results
from stair_inspector.viewer.parts.steps.settling import Settling
from stair_inspector.viewer.parts.steps.verdicts import Deciding
from stair_inspector.viewer.parts.tune.paper_edges import PaperEdges
from stair_inspector.viewer.parts.tune.presets import Tuning, known_presets
from stair_inspector.viewer.parts.tune.runs import Comparing, sweep_titles
from stair_inspector.viewer.scene.stage import Stage
from stair_inspector.viewer.state.library import Library
from stair_inspector.viewer.state.work import Changes, Keeper, KeptWishes, Work
from stair_inspector.viewer.wiring import actions_of, add_keys

_BRAND = (24, 110, 160)


class Session:
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
    palettes : tuple of Palette
        Colours of the page in its light and in its dark theme.
    kept : KeptWishes
        What pages that have gone were last at.
    end : callable
        Closes this page; called when its browser has come back while this page no longer answers.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        workshop: Workshop,
        library: Library,
        started: Work,
        palettes: tuple[Palette, Palette],
        kept: KeptWishes,
        end: Callable[[], None],
    ) -> None:
        self._client = client
        self._started = params = started.params
        self._error: str | None = None
        # Why the controls, as they stand now, can not even be asked for.
        self._refusal: str | None = None
        # What a run and what the making of a file told last; both have the same line on the page.
        self._running: Progress | None = None
        self._made: Progress | None = None
        self._theme()
        self.notices = Notices(client)
        self.desk = Desk(client, self.notices, palettes, Stage(client))
        self.keeper = Keeper(library, self._on_saved)
        self.help = HelpCard(client.gui)
        self.looking = Looking(self.desk)
        # Sending another number of points takes longer than a slider's next event.
        redraw = self.notices.guard(lambda: self.redraw(is_new_cloud=True))
        self._redraws: Newest[None] = Newest(lambda _: redraw(), name=f"stair-points-{client.client_id}")
        offers = Offers(library.labels(), tuple(known_presets(params)), tuple(sweep_titles().values()))
        self.panel = Panel(client, offers, params, actions_of(self))
        self.opening = Opening(client, library, self.keeper, self.panel, self.notices, started, kept, end)
        self.results = Results(self.desk, self.panel)
        self.checking = Checking(self.desk, self.panel, self.results, self)
        self.paper_edges = PaperEdges(self.desk, self._show_legend)
        self.making = Making(self.show_making, lambda: self.desk.is_closed)
        self.tuning = Tuning(self.desk, self.panel, self, params, self.making)
        self.comparing = Comparing(self.desk, self.panel, self, workshop, lambda: self.keeper.scan)
        self.deciding = Deciding(self.desk, self.panel, self.results, self.keeper, self)
        self.exporting = Exporting(
            self.desk, self.panel, self.looking, self.keeper, self, self.making, self.checking.checked
        )
        views = SceneViews(self.desk, self.looking, self.results, self.redraw)
        self.reporting = Reporting(
            self.desk, self.panel, self.checking, self.keeper, self, views, self.making, self._show_changes
        )
        self.region = RegionTool(self.desk, self.panel.scan, self.panel.controls, self)
        self.upright = UprightTool(self.desk, self, self._say_up)
        self.toolbar = add_toolbar(client.gui, self.panel, self.desk, self.looking, self.results, self)
        self.upright.borrow = self.toolbar.measure.lend
        listener = Listener(self._find, self._done, self._failed, self._progress)
        self.runs = Runs(workshop, listener, self.notices, f"stair-session-{client.client_id}")
        self.settling = Settling(self.desk, workshop, self.runs.is_busy, self._show_unsettled)
        add_keys(self)
        client.camera.on_update(lambda _: self.notices.guard(self._on_camera)())
        try:
            self.opening.restore()
            self._show_legend()
            self.panel.show_waiting(self.keeper.label, self.desk.palette)
            self._show_status(busy="starting …")
            self._show_work()
            self.submit()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Let go of everything; called when the page is gone."""
        self.desk.is_closed = self.notices.is_closed = True
        self._end_threads()
        # The project is free by then: the page that comes back takes up the same one.
        self.opening.leave()

    def _end_threads(self) -> None:
        for part in (
            self.runs,
            self.settling,
            self.comparing,
            self.toolbar.section,
            self._redraws,
            self.paper_edges,
            self.keeper,
        ):
            part.close()

    # The work: what may be changed, and how it is taken back. See desk.Editor.

    @property
    def work(self) -> Work:
        """The work as it stands."""
        return self.keeper.work

    # Whoever holds both locks took the desk's first: nothing here may show anything while it holds the keeper's.

    def adjust(self, change: Callable[[Params], Params], words: str = "") -> None:
        """Change the settings as they stand at that moment, set the controls to them, and run."""
        with self.keeper.lock:
            with contextlib.suppress(ConfigError):
                # A control that was moved just now has not been asked for yet; it must not jump back.
                self._read_controls()
            before = self.work
            params = change(before.params)
            self._go_on(dataclasses.replace(before, params=params), words or words_of_change(before.params, params)[0])
        self._show_work()

    def take_up(self, work: Work, words: str) -> None:
        """Go on with other work, all in one change, and run."""
        with self.keeper.lock:
            self._go_on(work, words)
        self._show_work()

    def edit(self, words: str, change: Callable[[Work], Changes], merge_key: str = "") -> None:
        """Change other parts of the work, as it stands at that moment, and show them."""
        with self.keeper.lock:
            self.keeper.change(words, merge_key, **change(self.work))
        self._show_work()

    def change(self, words: str, **fields: Unpack[Changes]) -> None:
        """Change other parts of the work, whatever they are now, and show them."""
        self.edit(words, lambda _: fields)

    def undo(self) -> None:
        """Take the last change back."""
        self._step(self.keeper.undo, can=self.keeper.history.can_undo, words="undo")

    def redo(self) -> None:
        """Do again what was taken back."""
        self._step(self.keeper.redo, can=self.keeper.history.can_redo, words="redo")

    def reset(self) -> None:
        """Go back to the settings that the server was started with."""
        self.adjust(lambda _: self._started, "reset to preset")

    def submit(self) -> None:
        """Ask for a run with what the controls show now."""
        names = ""
        with self.keeper.lock:
            try:
                names = self._read_controls()
            except ConfigError as error:
                self._refusal = str(error)
            else:
                self._ask()
            refusal = self._refusal
        self.paper_edges.changed(names)
        if refusal is not None:
            self._failed(refusal)
        else:
            self._show_changes()

    def pick(self, message: str) -> None:
        """Do what a click on a row, or a drag over the histogram, asks for."""
        word, _, value = str(message).partition(":")[0].partition(" ")
        if word == RULE:
            self.checking.pick(value)
            return
        if word == CURE:
            self.deciding.take_cure(message)
            return
        if word != REACH:
            self.results.pick(message)
            return
        if not value.isdecimal() or len(value) > 6:
            raise ConfigError(f"ε_z: got {value[:40]!r}; give a whole number of millimetres")
        self.adjust(lambda params: params.replaced("levels.eps_m", int(value) / 1000.0))

    def cancel(self) -> None:
        """Stop what is being computed or made for this page."""
        self.runs.cancel()
        self.making.cancel()
        self.comparing.cancel()

    def _step(self, step: Callable[[], Work], *, can: bool, words: str) -> None:
        if not can:
            raise ConfigError(f"{words}: there is nothing to {words}")
        with self.keeper.lock:
            work = step()
            self.panel.controls.load(work.params)
            self._ask()
        self._show_work()

    # The keeper's lock is held.

    def _read_controls(self) -> str:
        """Take the settings that the controls show into the work; return the names of those that have changed."""
        params = self.panel.controls.read()
        words, names = words_of_change(self.work.params, params)
        self.keeper.change(words, names, params=params)
        return names

    def _go_on(self, work: Work, words: str) -> None:
        self.panel.controls.load(work.params)
        self.keeper.replace(work, words)
        self._ask()

    def _ask(self) -> None:
        """Hand a wish to the thread that computes."""
        self._refusal = None
        self.runs.submit(Request(self.keeper.label, self.work.params), self.keeper.scan)

    # Scans.

    def choose_scan(self, label: str) -> None:
        """Open another scan. The page is empty until it is measured: what is done counts for it alone."""
        with self.desk.lock, self._client.atomic():
            with self.keeper.lock:
                if not self.opening.choose(label):
                    return
                self._put_away()
                self._ask()
            self._show_work()
            self._show_status(busy="opening …")

    def take_upload(self, file: Any) -> None:
        """Open an uploaded scan."""
        self.choose_scan(self.opening.keep_upload(file))

    # Runs: called on the thread that computes.

    def _find(self, request: Request, read: Callable[[ScanUnit], Scan]) -> tuple[Request, Scan]:
        """Read a scan; work that was done on another state of the file is put aside."""
        scan = read(request.params.unit)
        if self.opening.is_of(request.label, scan.sha256):
            return request, scan
        self._show_work()
        with self.keeper.lock:
            bench = self.keeper.bench(request.label)
            params = bench.history.value.params if bench is not None else request.params
        return Request(request.label, params), read(params.unit)

    def _done(self, request: Request, scan: Scan, inspection: Inspection, prepared: Prepared) -> None:
        """Show a result, all of it at once."""
        desk = self.desk
        with desk.lock:
            self._running = None
            if desk.is_closed or request.label != self.keeper.label:
                return
            before = desk.shown
            is_new_scan = before is None or before.scan is not scan
            self.looking.know_normals(scan, prepared.normals)
            display = self.looking.display(scan) if is_new_scan or before is None else before.display
            shown = Shown(request.label, scan, display, inspection)
            drawing = self.looking.drawing(shown, with_rejected=self.results.with_rejected)
            # Only now: if making a part of the page fails, the exports stay those of the result that is still shown.
            desk.shown = shown
            # A run that was under way may end after a control was set to something impossible: that stays said.
            self._error = self._refusal
            self.results.renew()
            self.settling.renew()
            # The scene is turned upright only for another scan or another up: nothing jumps while a slider moves.
            is_new_view = (
                is_new_scan or before is None or not np.array_equal(before.inspection.up.vector, inspection.up.vector)
            )
            with self._client.atomic():
                if is_new_view:
                    self._show_scan(shown)
                desk.stage.show_drawing(drawing, desk.palette, self.notices.guard(self.results.select))
                self.results.show_histogram()
                self.results.show_details()
                self.checking.show()
                self.reporting.show_readings()
                self.paper_edges.draw()
                self._show_legend()
                self.tuning.know_heights(prepared.heights)
                self.show_runs()
                if is_new_view:
                    self.toolbar.show()
                    self.region.show()
                    self.upright.show()
                else:
                    self.toolbar.section.show()
                # While a slider moves, the next run waits already; dimming the table each time would flicker.
                is_waiting = self.runs.has_waiting() and self._error is None
                self._show_status(busy="measuring …" if is_waiting else None, is_stale=self._error is not None)
                if is_new_view:
                    self.looking.look("Home")
            if not self.runs.has_waiting():
                self.results.show_pictures()

    def _failed(self, words: str) -> None:
        with self.desk.lock:
            if words == CANCELLED and self.desk.shown is None:
                words = "cancelled before anything was measured. Press Run again, or choose another scan"
            self._running = None
            self._error = self._refusal or " ".join(words.split())
            with self._client.atomic():
                self._show_status(is_stale=self.desk.shown is not None)

    def _progress(self, progress: Progress) -> None:
        """Say what is being computed; the last good result stays, dimmed."""
        with self.desk.lock:
            if self.desk.is_closed or not self.runs.is_busy():
                return
            self._running = progress
            with self._client.atomic():
                self._show_status(busy=progress.words, is_stale=self.desk.shown is not None, percent=progress.percent)

    # What the page shows.

    def show_runs(self) -> None:
        """Show the kept runs, and the comparison with the chosen one."""
        self.comparing.show()

    def redraw(self, *, is_new_cloud: bool = False) -> None:
        """Draw the present result again, in other colours or with other points."""
        desk = self.desk
        with desk.lock, self._client.atomic():
            shown = desk.shown
            if shown is None:
                return
            if is_new_cloud:
                shown = desk.shown = dataclasses.replace(shown, display=self.looking.display(shown.scan))
                self._show_scan(shown)
            drawing = self.looking.drawing(shown, with_rejected=self.results.with_rejected)
            desk.stage.show_drawing(drawing, desk.palette, self.notices.guard(self.results.select))
            self.results.show_selection()
            self._show_legend()
            self.toolbar.show()
            if is_new_cloud:
                self.region.show()

    def set_density(self, percent: float) -> None:
        """Draw so many of the points."""
        self.looking.set_percent(percent)
        self._redraws.submit(None)

    def set_rejected(self, is_shown: bool) -> None:
        """Show or hide the rejected surfaces."""
        with self.desk.lock:
            self.results.with_rejected = bool(is_shown)
            if not is_shown:
                self.desk.selected_patch = None
            self.redraw()

    def set_theme(self, is_dark: bool) -> None:
        """Switch between the light and the dark theme."""
        with self.desk.lock, self._client.atomic():
            self.desk.is_dark = bool(is_dark)
            self._theme()
            self.redraw()
            self.results.show_histogram()
            self._show_legend()

    def set_unit(self, option: str) -> None:
        """Write lengths in millimetres or in inches."""
        with self.desk.lock:
            self.results.set_unit(option)
            self.toolbar.show()
            self.show_runs()
            self.reporting.show_readings()

    def _on_camera(self) -> None:
        with self.desk.lock:
            if not self.desk.is_closed:
                self.looking.reframe()

    def _theme(self) -> None:
        is_dark = hasattr(self, "desk") and self.desk.is_dark
        self._client.gui.configure_theme(
            dark_mode=is_dark, show_logo=False, show_share_button=False, brand_color=_BRAND
        )

    def _show_scan(self, shown: Shown) -> None:
        self.region.clear()
        size_m = self.looking.point_size_of(shown.display)
        self.desk.stage.show_scan(shown.display, view_from_local(shown.inspection), size_m)
        self.panel.scan.show_point_size(size_m)
        self.panel.header.content = html.header_html(shown.label, len(shown.scan.points), len(shown.display.points))

    def _put_away(self) -> None:
        """Clear the page of a result that belongs to a scan which is no longer open."""
        desk = self.desk
        desk.shown = desk.selected = desk.selected_patch = self._running = self._error = None
        self.region.clear()
        desk.stage.clear()
        self.toolbar.section.show()
        self.upright.show()
        self.panel.show_waiting(self.keeper.label, desk.palette)
        self.results.put_away()

    def _show_work(self) -> None:
        """Show everything about the work that is no setting."""
        with self.desk.lock, self._client.atomic():
            self.paper_edges.put_away()
            self._show_changes()
            self.opening.show()
            self.panel.export.title.value = self.work.title
            self.toolbar.views.show()
            self.checking.show()
            self.reporting.show()
            self._show_legend()
            self.toolbar.measure.show()
            self.region.show()
            self.show_runs()
            self.exporting.show_saved()

    def _show_changes(self) -> None:
        history = self.keeper.history
        self.panel.tune.show_changes(history.undo_label, history.redo_label)
        self.tuning.show_preset()

    def _show_legend(self) -> None:
        with_paper = self.paper_edges.is_drawn
        marks, looking = self.results.marks, self.looking
        self.panel.show_legend(self.desk.palette, looking.legend, looking.color_mode, marks, with_paper=with_paper)

    def show_making(self, words: str | None, percent: float) -> None:
        """Show how far the making of files is; None when it is over."""
        with self.desk.lock:
            self._made = None if words is None else Progress(words, percent)
            if not self.desk.is_closed:
                is_stale = self._error is not None or self._running is not None
                self._show_status(is_stale=is_stale and self.desk.shown is not None)

    def _show_status(self, *, busy: str | None = None, is_stale: bool = False, percent: float | None = None) -> None:
        going_on = self._made or self._running
        if busy is None and going_on is not None:
            busy, percent = going_on.words, going_on.percent
        error = self._error if busy is None else None
        self.panel.run.visible = error is not None and self._refusal is None
        self.panel.state.content = html.state_html(
            self.desk.marked,
            busy=busy,
            error=error,
            is_stale=is_stale,
            percent=percent,
            cancel_uuid=uuid_of(self.panel.cancel),
        )

    def _show_unsettled(self) -> None:
        """Show which values hang on the settings; the desk is held."""
        self.results.show_details()
        self.results.show_selection(with_pictures=False)
        self._show_status(is_stale=self._error is not None)

    def _on_saved(self, words: str, is_failure: bool) -> None:
        if not self.desk.is_closed:
            self.exporting.show_saved()
            if words:
                self.notices.tell("Not saved" if is_failure else "Saved elsewhere", words, is_failure=is_failure)

    def _say_up(self, content: str) -> None:
        self.panel.scan.up_hint.content = content
