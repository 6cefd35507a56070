"""One inspector: a page, the work on its scans, its last good result, and the thread that computes for it."""

import dataclasses
from collections.abc import Callable
from typing import Any, Unpack

import numpy as np
import viser

from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import Palette
from stair_inspector.model import Inspection, Scan
from stair_inspector.params import Params, Unit
from stair_inspector.viewer import html
from stair_inspector.viewer.comparing import Comparing, sweep_titles
from stair_inspector.viewer.controls import words_of_change
from stair_inspector.viewer.deciding import Deciding
from stair_inspector.viewer.desk import Desk, Shown
from stair_inspector.viewer.exporting import Exporting
from stair_inspector.viewer.library import Library
from stair_inspector.viewer.looking import Looking
from stair_inspector.viewer.notices import Notices
from stair_inspector.viewer.opening import Opening
from stair_inspector.viewer.panel import Offers, Panel
from stair_inspector.viewer.reach_drag import REACH
from stair_inspector.viewer.results import Results
from stair_inspector.viewer.runs import CANCELLED, Listener, Prepared, Progress, Request, Runs
from stair_inspector.viewer.scene import Stage, view_from_local
from stair_inspector.viewer.toolbar import add_toolbar
from stair_inspector.viewer.tools.region import RegionTool
from stair_inspector.viewer.tools.upright import UprightTool
from stair_inspector.viewer.tuning import Tuning, known_presets
from stair_inspector.viewer.wiring import actions_of, add_keys
from stair_inspector.viewer.work import Changes, Keeper, KeptWishes, Work
from stair_inspector.viewer.worker import Newest, Workshop

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
    params : Params
        Settings to begin with and to reset to.
    palettes : tuple of Palette
        Colours of the page in its light and in its dark theme.
    kept : KeptWishes
        What pages that have gone were last at.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        workshop: Workshop,
        library: Library,
        params: Params,
        palettes: tuple[Palette, Palette],
        kept: KeptWishes,
    ) -> None:
        self._client = client
        self._library = library
        self._started = params
        self._error: str | None = None
        # Why the controls, as they stand now, can not even be asked for.
        self._refusal: str | None = None
        self._theme()
        self.notices = Notices(client)
        self.desk = Desk(client, self.notices, palettes, Stage(client))
        self.keeper = Keeper(library, self._on_saved)
        self.looking = Looking(self.desk)
        # Sending another number of points takes longer than a slider's next event.
        redraw = self.notices.guard(lambda: self.redraw(is_new_cloud=True))
        self._redraws: Newest[None] = Newest(lambda _: redraw(), name=f"stair-points-{client.client_id}")
        offers = Offers(library.labels(), tuple(known_presets(params)), tuple(sweep_titles().values()))
        self.panel = Panel(client, offers, params, actions_of(self))
        self.opening = Opening(client, library, self.keeper, self.panel, self.notices, params, kept)
        self.results = Results(self.desk, self.panel)
        self.tuning = Tuning(self.desk, self.panel, self, params)
        self.comparing = Comparing(self.desk, self.panel, self, workshop)
        self.deciding = Deciding(self.desk, self.panel, self.results, self.keeper, self)
        self.exporting = Exporting(self.desk, self.panel, self.looking, self.keeper, self, self.show_making)
        self.region = RegionTool(self.desk, self.panel.scan, self.panel.controls, self)
        self.upright = UprightTool(self.desk, self, self._say_up)
        self.toolbar = add_toolbar(client.gui, self.panel, self.desk, self.looking, self.results, self)
        self.upright.borrow = self.toolbar.measure.lend
        listener = Listener(self._find, self._done, self._failed, self._progress)
        self.runs = Runs(workshop, listener, self.notices, f"stair-session-{client.client_id}")
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
            self._end_threads()
            raise

    def close(self) -> None:
        """Let go of everything; called when the page is gone."""
        self.desk.is_closed = self.notices.is_closed = True
        self._end_threads()
        # The project is free by then: the page that comes back takes up the same one.
        self.opening.leave()

    def _end_threads(self) -> None:
        for part in (self.runs, self.comparing, self.toolbar.section, self._redraws, self.keeper):
            part.close()

    # The work: what may be changed, and how it is taken back. See desk.Editor.

    @property
    def work(self) -> Work:
        """The work as it stands."""
        return self.keeper.work

    def apply(self, params: Params, words: str) -> None:
        """Set the controls to other settings and run."""
        with self.keeper.lock:
            self.take_up(dataclasses.replace(self.work, params=params), words)

    def take_up(self, work: Work, words: str) -> None:
        """Go on with other work, all in one change, and run."""
        with self.keeper.lock:
            self.panel.controls.load(work.params)
            self.keeper.replace(work, words)
            self._ask(work.params)
        self._show_work()

    def change(self, words: str, **fields: Unpack[Changes]) -> None:
        """Change other parts of the work, and show them."""
        self.keeper.change(words, "", **fields)
        self._show_work()

    def undo(self) -> None:
        """Take the last change back."""
        self._step(self.keeper.undo, can=self.keeper.history.can_undo, words="undo")

    def redo(self) -> None:
        """Do again what was taken back."""
        self._step(self.keeper.redo, can=self.keeper.history.can_redo, words="redo")

    def reset(self) -> None:
        """Go back to the settings that the server was started with."""
        self.apply(self._started, "reset to preset")

    def submit(self) -> None:
        """Ask for a run with what the controls show now."""
        with self.keeper.lock:
            try:
                params = self.panel.controls.read()
            except ConfigError as error:
                self._refusal = str(error)
            else:
                self.keeper.change(*words_of_change(self.work.params, params), params=params)
                self._ask(params)
            refusal = self._refusal
        if refusal is not None:
            self._failed(refusal)
        else:
            self._show_changes()

    def pick(self, message: str) -> None:
        """Do what a click on a row, or a drag over the histogram, asks for."""
        word, _, value = str(message).partition(":")[0].partition(" ")
        if word != REACH:
            self.results.pick(message)
            return
        if not value.isdecimal() or len(value) > 6:
            raise ConfigError(f"ε_z: got {value[:40]!r}; give a whole number of millimetres")
        params = self.work.params.replaced("levels.eps_m", int(value) / 1000.0)
        self.apply(params, words_of_change(self.work.params, params)[0])

    def cancel(self) -> None:
        """Stop what is being computed or made for this page."""
        self.runs.cancel()
        self.exporting.cancel()
        self.comparing.stop_sweep()

    def _step(self, step: Callable[[], Work], *, can: bool, words: str) -> None:
        if not can:
            raise ConfigError(f"{words}: there is nothing to {words}")
        with self.keeper.lock:
            work = step()
            self.panel.controls.load(work.params)
            self._ask(work.params)
        self._show_work()

    def _ask(self, params: Params) -> None:
        """Hand a wish to the thread that computes; the keeper's lock is held."""
        self._refusal = None
        label = self.keeper.label
        self.runs.submit(Request(label, params), self._library.path(label))

    # Scans.

    def choose_scan(self, label: str) -> None:
        """Open another scan."""
        with self.keeper.lock:
            if not self.opening.choose(label):
                return
            self._ask(self.work.params)
        self.desk.selected = self.desk.selected_patch = None
        self._show_work()

    def take_upload(self, file: Any) -> None:
        """Open an uploaded scan."""
        self.choose_scan(self.opening.keep_upload(file))

    # Runs: called on the thread that computes.

    def _find(self, request: Request, read: Callable[[Unit], Scan]) -> tuple[Request, Scan]:
        """Read a scan; saved work that turns out to be another file's is put aside."""
        scan = read(request.params.unit)
        if self.opening.is_of(request.label, scan.sha256):
            return request, scan
        self._show_work()
        params = self.work.params
        return Request(request.label, params), read(params.unit)

    def _done(self, request: Request, scan: Scan, inspection: Inspection, prepared: Prepared) -> None:
        """Show a result, all of it at once."""
        desk = self.desk
        with desk.lock:
            if desk.is_closed or request.label != self.keeper.label:
                return
            before = desk.shown
            is_new_scan = before is None or before.scan is not scan
            if before is not None and is_new_scan and before.label == request.label and before.scan.unit == scan.unit:
                self.notices.tell("File changed", f"{request.label} has changed and was read again")
            self.looking.know_normals(scan, prepared.normals)
            display = self.looking.display(scan) if is_new_scan or before is None else before.display
            shown = Shown(request.label, scan, display, inspection)
            drawing = self.looking.drawing(shown, with_rejected=self.results.with_rejected)
            # Only now: if making a part of the page fails, the exports stay those of the result that is still shown.
            desk.shown = shown
            # A run that was under way may end after a control was set to something impossible: that stays said.
            self._error = self._refusal
            self.results.renew()
            self.keeper.know_scan(request.label, scan.sha256)
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
                self.results.show_selection(with_pictures=False)
                self._show_legend()
                self.tuning.know_heights(prepared.heights)
                self.show_runs()
                if is_new_view:
                    self.toolbar.show()
                    self.region.show()
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
            self._error = self._refusal or " ".join(words.split())
            with self._client.atomic():
                self._show_status(is_stale=self.desk.shown is not None)

    def _progress(self, progress: Progress) -> None:
        """Say what is being computed; the last good result stays, dimmed."""
        with self.desk.lock:
            if self.desk.is_closed or not self.runs.is_busy():
                return
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

    def _show_work(self) -> None:
        """Show everything about the work that is no setting."""
        with self.desk.lock, self._client.atomic():
            self._show_changes()
            self.opening.show()
            self.panel.export.title.value = self.work.title
            self.toolbar.views.show()
            if self.desk.shown is not None and self.desk.shown.label == self.keeper.label:
                self.toolbar.measure.show()
                self.region.show()
            self.show_runs()
            self.exporting.show_saved(None, "")

    def _show_changes(self) -> None:
        history = self.keeper.history
        self.panel.tune.show_changes(history.undo_label, history.redo_label)
        self.tuning.show_preset()

    def _show_legend(self) -> None:
        self.panel.show_legend(self.desk.palette, self.looking.legend, self.looking.color_mode)

    def show_making(self, words: str | None, percent: float) -> None:
        """Show how far the making of files is; None when it is over."""
        with self.desk.lock:
            if words is not None:
                self._show_status(busy=words, percent=percent)
            else:
                self._show_status(is_stale=self._error is not None)

    def _show_status(self, *, busy: str | None = None, is_stale: bool = False, percent: float | None = None) -> None:
        error = self._error if busy is None else None
        self.panel.run.visible = error is not None and self._refusal is None
        self.panel.state.content = html.state_html(
            self.desk.inspection,
            busy=busy,
            error=error,
            is_stale=is_stale,
            percent=percent,
            cancel_uuid=self.panel.cancel._impl.uuid,
        )

    def _on_saved(self, path: Any, error: str) -> None:
        if not self.desk.is_closed:
            self.exporting.show_saved(path, error)
            if error:
                self.notices.tell("Not saved", error, is_failure=True)

    def _say_up(self, content: str) -> None:
        self.panel.scan.up_hint.content = content
