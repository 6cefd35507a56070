"""One inspector: a page, its settings, its last good result, and the thread that computes for it."""

import io
import logging
import threading
import uuid
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import viser
from PIL import Image

from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.exports import csv_bytes, debug_ply_bytes, json_bytes
from stair_inspector.files.palettes import Palette
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Scan, Step
from stair_inspector.params import Params
from stair_inspector.pipeline import Memo, inspect
from stair_inspector.viewer import html
from stair_inspector.viewer.cameras import FOV_RAD, VIEWS, View, frame_view
from stair_inspector.viewer.dimensions import dimensions_of
from stair_inspector.viewer.display import REJECTED_COLOR, Display, choose_display
from stair_inspector.viewer.markup import SURFACE
from stair_inspector.viewer.panel import NO_STEP, VERDICTS, Actions, Panel
from stair_inspector.viewer.scene import (
    HIGHLIGHT,
    MODES,
    Drawing,
    Stage,
    draw,
    ground_of,
    is_left_hidden,
    lift_of,
    points_of,
    view_from_local,
)
from stair_inspector.viewer.survey_html import MOST_REJECTED, card_html, rejected_html, rejected_of, step_of
from stair_inspector.viewer.worker import Newest, Workshop

logger = logging.getLogger(__name__)

_PATIENCE_S = 0.2
"""A run that takes no longer changes the page at once; a longer one is announced."""
_STORAGE_KEY = "stair_inspector.browser"
_KEPT_PER_BROWSER = 10
_KEPT_BROWSERS = 100
_LARGEST_DISC = 1.0 / 150.0
"""Largest diameter of a drawn point, as a share of the scan's diagonal: a wrong unit must not fill the screen."""
_RENDER_TIMEOUT_S = 60.0
_STAGE_WORDS = {
    "read": "reading the file",
    "normals": "estimating normals",
    "up": "looking for the floor",
    "heights": "sorting by height",
}
_STAGE_PERCENT = {"read": 5.0, "normals": 20.0, "up": 60.0, "heights": 92.0}
"""Where the bar stands when a stage begins."""


@dataclass(frozen=True, slots=True)
class Request:
    """What a run is asked for: a scan by its name in the menu, and settings."""

    label: str
    params: Params


class KeptRequests:
    """What closed pages last asked for, by browser: a reload or a dropped connection makes a browser a new client.

    Kept by the server and not by the browser, whose storage all its tabs share: each page that comes back takes up the
    wishes of one page that has gone, and never those of one that is still open.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._by_browser: OrderedDict[str, list[Request]] = OrderedDict()

    def leave(self, browser_id: str, request: Request) -> None:
        """Keep a closed page's request."""
        with self._lock:
            kept = self._by_browser.setdefault(browser_id, [])
            self._by_browser.move_to_end(browser_id)
            kept.append(request)
            del kept[:-_KEPT_PER_BROWSER]
            while len(self._by_browser) > _KEPT_BROWSERS:
                self._by_browser.popitem(last=False)

    def take_up(self, browser_id: str) -> Request | None:
        """Return the newest request kept for a browser, and forget it."""
        with self._lock:
            kept = self._by_browser.get(browser_id)
            return kept.pop() if kept else None


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """The last good result, with the scan it belongs to and what of it is drawn."""

    label: str
    scan: Scan
    display: Display
    inspection: Inspection


class Session:
    """The page of one connected browser.

    Parameters
    ----------
    client : viser.ClientHandle
        The browser.
    workshop : Workshop
        Shared with the other inspectors.
    scans : dict
        Files by their name in the scan menu.
    params : Params
        Settings to begin with and to reset to.
    palettes : tuple of Palette
        Colours of the page in its light and in its dark theme.
    kept : KeptRequests
        What pages that have gone last asked for.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        workshop: Workshop,
        scans: dict[str, Path],
        params: Params,
        palettes: tuple[Palette, Palette],
        kept: KeptRequests,
    ) -> None:
        self._client = client
        self._workshop = workshop
        self._scans = scans
        self._preset = params
        self._palettes = palettes
        self._palette = palettes[False]
        self._kept = kept
        self._browser_id: str | None = None
        self._lock = threading.RLock()
        # Held from reading the controls to handing the request over: viser runs callbacks on many threads, and one that
        # has read older values must not come last. Apart from the other lock, which is held while a page is redrawn.
        self._ask_lock = threading.Lock()
        self._asked: Request | None = None
        self._running: Scan | None = None
        self._shown: Shown | None = None
        # A step or a rejected surface is chosen, never both.
        self._selected: int | None = None
        self._selected_patch: int | None = None
        # None shows the survey's columns where there are any.
        self._columns: html.Columns | None = None
        self._with_rejected = False
        self._error: str | None = None
        # Why the controls, as they stand now, can not even be asked for.
        self._refusal: str | None = None
        self._stage: str | None = None
        self._is_closed = False
        self._wanted_label = next(iter(scans))
        self._stage_view = Stage(client)
        self._framed: tuple[View, float, Floats] | None = None
        client.gui.configure_theme(show_logo=False, show_share_button=False, brand_color=(24, 110, 160))
        actions = Actions(
            on_settings=self._guard(self._on_settings),
            on_reset=self._guard(self._on_reset),
            on_scan=self._guard(self._on_scan),
            on_mode=self._guard(self._on_mode),
            on_view=self._guard(self._on_view),
            on_theme=self._guard(self._on_theme),
            on_point_size=self._guard(self._on_point_size),
            on_select=self._guard(self._on_select),
            on_pick=self._guard(self._on_pick),
            on_download=self._guard(self._on_download),
            on_columns=self._guard(self._on_columns),
            on_rejected=self._guard(self._on_rejected),
            on_mark=self._guard(self._on_mark),
            on_clear_overrules=self._guard(self._on_clear_overrules),
        )
        self._panel = Panel(client, tuple(scans), params, actions)
        self._panel.legend.content = html.legend_html(self._palette)
        self._memo = Memo(heavy=workshop.heavy, on_stage=self._enter_stage)
        self._worker = Newest(self._run, name=f"stair-session-{client.client_id}")
        client.camera.on_update(lambda _: self._guard(self._on_camera)())
        try:
            self._restore()
            self._show_waiting()
            self._submit()
        except BaseException:
            self._worker.close()
            raise

    def close(self) -> None:
        """Let go of everything; called when the page is gone."""
        self._is_closed = True
        if self._browser_id is not None and self._asked is not None:
            self._kept.leave(self._browser_id, self._asked)
        self._worker.close()

    # What the page asks for. Each runs on one of viser's threads, guarded.

    def _on_settings(self) -> None:
        self._submit()

    def _on_reset(self) -> None:
        self._panel.load(self._preset)
        self._submit()

    def _on_scan(self, label: str) -> None:
        if label not in self._scans:
            raise ConfigError(
                f"scan: {str(label)[:60]!r} is none of the files that were opened; choose one of the menu"
            )
        self._submit(label)

    def _on_mode(self, mode: str) -> None:
        known = next((known for known in MODES if known == mode), None)
        if known is None:
            raise ConfigError(f"view: got {str(mode)[:40]!r}; give one of {', '.join(MODES)}")
        with self._lock:
            self._stage_view.set_mode(known)
            self._look("Home")

    def _on_view(self, view: str) -> None:
        known = next((known for known in VIEWS if known == view), None)
        if known is None:
            raise ConfigError(f"camera: got {str(view)[:40]!r}; give one of {', '.join(VIEWS)}")
        with self._lock:
            self._look(known)

    def _on_camera(self) -> None:
        """Frame the view again when the picture has another shape, unless somebody has turned it since.

        A page tells the shape of its whole window before the panel has taken its place at the side.
        """
        with self._lock:
            camera = self._client.camera
            if self._is_closed or self._framed is None:
                return
            view, aspect, position = self._framed
            if abs(camera.aspect - aspect) > 0.01 and np.allclose(camera.position, position, atol=1e-3):
                self._look(view)

    def _on_theme(self, is_dark: bool) -> None:
        with self._lock, self._client.atomic():
            self._palette = self._palettes[bool(is_dark)]
            self._client.gui.configure_theme(
                dark_mode=bool(is_dark), show_logo=False, show_share_button=False, brand_color=(24, 110, 160)
            )
            self._panel.legend.content = html.legend_html(self._palette)
            shown = self._shown
            if shown is None:
                return
            self._show_drawing(self._draw(shown))
            self._panel.histogram.content = html.histogram_html(shown.inspection, self._palette)
            self._show_selection()

    def _on_point_size(self, size_mm: float) -> None:
        if not 0.1 <= float(size_mm) <= 100.0:
            raise ConfigError(f"point size: got {size_mm!r}; give 0.1 to 100 mm")
        with self._lock:
            self._stage_view.set_point_size(float(size_mm) / 1000.0)

    def _on_select(self, option: str) -> None:
        self._select(*_read_choice(option))

    def _on_pick(self, message: str) -> None:
        chosen = _read_choice(str(message).partition(":")[0])
        # A second click on the same row puts the selection away.
        self._select(*((None, None) if chosen == (self._selected, self._selected_patch) else chosen))

    def _on_columns(self, option: str) -> None:
        columns = next((columns for columns in html.COLUMNS if columns == str(option).lower()), None)
        if columns is None:
            raise ConfigError(f"table: got {str(option)[:40]!r}; give one of {', '.join(html.COLUMNS)}")
        with self._lock, self._client.atomic():
            self._columns = columns
            self._show_selection()

    def _on_rejected(self, is_shown: bool) -> None:
        with self._lock, self._client.atomic():
            self._with_rejected = bool(is_shown)
            if not self._with_rejected:
                self._selected_patch = None
            if self._shown is not None:
                self._show_drawing(self._draw(self._shown))
            self._show_selection()

    def _on_mark(self, option: str) -> None:
        kind = next((kind for kind in VERDICTS if kind == option), None)
        if kind is None:
            raise ConfigError(f"mark as: got {str(option)[:40]!r}; give one of {', '.join(VERDICTS)}")
        with self._lock:
            place_m = self._chosen_place()
            # Its number may be another one's when the result is there.
            self._selected = self._selected_patch = None
        with self._ask_lock:
            self._panel.overrule(place_m, kind)
        self._submit()

    def _on_clear_overrules(self) -> None:
        with self._ask_lock:
            self._panel.clear_overrules()
        self._submit()

    def _on_download(self, kind: str) -> None:
        with self._lock:
            shown = self._shown
        if shown is None:
            raise ConfigError("export: there is no result yet; wait for the first one")
        # Two scans of the same name have the folder in their label.
        stem = Path(shown.label).with_suffix("").as_posix().replace("/", "_")
        make: dict[str, tuple[str, Callable[[], bytes]]] = {
            "CSV": (f"{stem}.csv", lambda: csv_bytes(shown.inspection)),
            "JSON": (f"{stem}.json", lambda: json_bytes(shown.inspection)),
            "Debug PLY": (f"{stem}_debug.ply", lambda: debug_ply_bytes(shown.scan, shown.inspection)),
            "Screenshot PNG": (f"{stem}.png", self._screenshot),
        }
        name, content = make[kind]
        self._client.send_file_download(name, content(), save_immediately=True)

    # Runs.

    def _submit(self, label: str | None = None) -> None:
        """Ask for a run with what the controls show now, of another scan if one is named."""
        with self._ask_lock:
            self._wanted_label = label or self._wanted_label
            try:
                request = Request(self._wanted_label, self._panel.read())
            except ConfigError as error:
                self._refusal = str(error)
            else:
                self._refusal = None
                self._asked = request
                self._worker.submit(request)
        if self._refusal is not None:
            self._fail(self._refusal)

    def _run(self, request: Request) -> None:
        """Compute and publish; the body of the session's thread. Never raises."""
        announce = threading.Timer(_PATIENCE_S, self._announce)
        announce.daemon = True
        self._stage, self._running = "read", None
        announce.start()
        try:
            scan = self._workshop.read(self._scans[request.label], request.params.unit)
            self._running = scan
            inspection = inspect(scan, request.params, self._memo)
            self._stage = None
            announce.cancel()
            self._publish(request, scan, inspection)
        except StairError as error:
            self._stage = None
            self._fail(str(error))
        except Exception:
            # The outermost frame of this thread: whatever went wrong, the page must go on and the log must have it.
            self._stage = None
            logger.log(self._gravity(), "an inspector's run failed", exc_info=True)
            if not self._is_closed:
                self._fail("an internal error stopped this run; the server's log has the details. Try other settings")
        finally:
            announce.cancel()

    def _enter_stage(self, stage: str) -> None:
        self._stage = stage
        if stage in _STAGE_WORDS and self._panel.progress.visible:
            self._announce()

    def _announce(self) -> None:
        """Say what is being computed; the last good result stays, dimmed."""
        with self._lock:
            stage = self._stage
            if stage is None or self._is_closed:
                return
            words = _STAGE_WORDS.get(stage, "measuring")
            running = self._running
            size = f" of {len(running.points):,} points" if running is not None and stage == "normals" else ""
            with self._client.atomic():
                self._panel.progress.visible = True
                self._panel.progress.value = _STAGE_PERCENT.get(stage, 95.0)
                self._show_status(busy=f"{words}{size} …", is_stale=self._shown is not None)

    def _fail(self, message: str) -> None:
        with self._lock:
            self._error = self._refusal or " ".join(message.split())
            with self._client.atomic():
                self._panel.progress.visible = False
                self._show_status(is_stale=self._shown is not None)

    def _notify(self, message: str) -> None:
        """Tell of an action that failed; the result shown is not concerned."""
        self._client.add_notification("Not done", " ".join(message.split()), color="red", auto_close_seconds=12.0)

    def _publish(self, request: Request, scan: Scan, inspection: Inspection) -> None:
        """Show a result, all of it at once."""
        with self._lock:
            if self._is_closed:
                return
            before = self._shown
            is_new_scan = before is None or before.scan is not scan
            if before is not None and is_new_scan and before.label == request.label and before.scan.unit == scan.unit:
                self._client.add_notification("File changed", f"{request.label} has changed and was read again.")
            display = choose_display(scan) if is_new_scan or before is None else before.display
            shown = Shown(request.label, scan, display, inspection)
            drawing = self._draw(shown)
            histogram = html.histogram_html(inspection, self._palette)
            details = html.details_html(inspection)
            # Only now: if making a part of the page fails, the exports stay those of the result that is still shown.
            self._shown = shown
            # A run that was under way may end after a control was set to something impossible: that stays said.
            self._error = self._refusal
            if step_of(inspection, self._selected) is None:
                self._selected = None
            # Surfaces are numbered anew by every run.
            self._selected_patch = None
            # The scene is turned upright only for another scan or another up: nothing jumps while a slider moves.
            is_new_view = (
                is_new_scan or before is None or not np.array_equal(before.inspection.up.vector, inspection.up.vector)
            )
            with self._client.atomic():
                if is_new_view:
                    size_m = max(0.002, 1.25 * display.spacing_m)
                    size_m = min(size_m, _LARGEST_DISC * float(np.linalg.norm(np.ptp(display.points, axis=0))))
                    self._stage_view.show_scan(display, view_from_local(inspection), size_m)
                    self._panel.show_point_size(size_m)
                    self._panel.header.content = html.header_html(request.label, len(scan.points), len(display.points))
                self._show_drawing(drawing)
                self._panel.progress.visible = False
                self._panel.histogram.content = histogram
                self._panel.details.content = details
                self._show_selection()
                # While a slider moves, the next run waits already; dimming the table each time would flicker.
                is_waiting = self._worker.has_waiting() and self._error is None
                self._show_status(busy="measuring …" if is_waiting else None, is_stale=self._error is not None)
                if is_new_view:
                    self._look("Home")

    # What the page shows. All callers hold the lock.

    def _show_waiting(self) -> None:
        with self._lock, self._client.atomic():
            self._panel.header.content = html.header_html(self._wanted_label, None, None)
            self._panel.table.content = html.table_html(None, self._palette, None, None)
            self._panel.histogram.content = html.histogram_html(None, self._palette)
            self._show_status(busy="starting …")

    def _show_status(self, *, busy: str | None = None, is_stale: bool = False) -> None:
        inspection = self._shown.inspection if self._shown is not None else None
        error = self._error if busy is None else None
        self._panel.state.content = html.state_html(inspection, busy=busy, error=error, is_stale=is_stale)

    def _draw(self, shown: Shown) -> Drawing:
        return draw(
            shown.inspection, shown.display, shown.scan.points, self._palette, with_rejected=self._with_rejected
        )

    def _show_drawing(self, drawing: Drawing) -> None:
        self._stage_view.show_drawing(drawing, self._palette, self._guard(self._select))

    def _select(self, step_id: int | None, patch_id: int | None = None) -> None:
        with self._lock:
            shown = self._shown
            if shown is None:
                return
            inspection = shown.inspection
            if step_id is not None and step_of(inspection, step_id) is None:
                raise ConfigError(f"step {step_id} does not exist; there are {len(inspection.steps)}")
            if patch_id is not None and patch_id not in {patch.patch_id for patch in rejected_of(inspection)}:
                raise ConfigError(f"{SURFACE} {patch_id} is none of the rejected ones")
            self._selected, self._selected_patch = step_id, patch_id
            with self._client.atomic():
                self._show_selection()

    def _show_selection(self) -> None:
        """Show the table and everything about the chosen step or surface."""
        shown = self._shown
        if shown is None:
            return
        inspection, panel = shown.inspection, self._panel
        step = step_of(inspection, self._selected)
        uuid = panel.picked._impl.uuid
        columns = html.columns_of(inspection, self._columns)
        is_survey = inspection.params.method == "survey"
        panel.show_survey_controls(is_survey)
        panel.table.content = html.table_html(inspection, self._palette, self._selected, uuid, columns)
        panel.card.content = card_html(inspection, self._selected, self._palette)
        panel.rejected.content = rejected_html(
            inspection, REJECTED_COLOR, self._selected_patch, uuid, is_shown=self._with_rejected and is_survey
        )
        rejected = rejected_of(inspection)[:MOST_REJECTED] if self._with_rejected else []
        chosen = NO_STEP if self._selected is None else str(self._selected)
        panel.offer_steps(
            (step.step_id for step in inspection.steps),
            (patch.patch_id for patch in rejected),
            chosen if self._selected_patch is None else f"{SURFACE} {self._selected_patch}",
        )
        self._show_chosen(shown, step)

    def _show_chosen(self, shown: Shown, step: Step | None) -> None:
        """Draw the chosen step with its dimensions, or the chosen surface, or nothing, over the segmentation."""
        inspection = shown.inspection
        corners, dimensions = None, None
        if step is not None:
            # The chosen step's points are drawn larger, and the lines over them must lie higher.
            lift_m = 2.0 * lift_of(shown.display.spacing_m, step.plane.rms_m)
            corners = step.corners + lift_m * inspection.up.vector
            dimensions = dimensions_of(inspection, step, lift_m)
        has_lines = dimensions is not None and len(dimensions.arrows) + len(dimensions.measuring) > 0
        self._stage_view.highlight(
            points_of(inspection, shown.display, self._selected, self._selected_patch),
            corners,
            ground_of(self._palette) if has_lines else HIGHLIGHT,
        )
        self._stage_view.show_dimensions(self._selected, dimensions, self._palette)

    def _chosen_place(self) -> tuple[float, float, float]:
        """Return the centroid of the chosen step's or surface's patch, metres in the scan frame."""
        inspection = self._shown.inspection if self._shown is not None else None
        step = step_of(inspection, self._selected)
        if inspection is None or (step is None and self._selected_patch is None):
            raise ConfigError("mark as: choose a step or a rejected surface first")
        if inspection.params.method == "paper":
            raise ConfigError("mark as: the paper's method takes no decisions; set the method to survey")
        own = [
            patch
            for patch in inspection.patches
            if patch.patch_id == self._selected_patch or (step is not None and patch.step_id == step.step_id)
        ]
        plane = max(own, key=lambda patch: patch.area_m2).plane if own else None
        if plane is None and step is not None:
            plane = step.plane
        if plane is None:
            raise ConfigError("mark as: the chosen surface is no longer there")
        x, y, z = (float(coordinate) for coordinate in plane.centroid + np.array(inspection.scan.origin_m))
        return (x, y, z)

    def _look(self, view: View) -> None:
        if self._shown is None:
            return
        # The view stays where it was turned for this scan; its axes may since have been found elsewhere.
        turn = self._stage_view.rotation @ view_from_local(self._shown.inspection).T
        camera = self._client.camera
        is_hidden = is_left_hidden(self._shown.inspection, self._shown.display)
        extent = self._stage_view.visible_extent()
        pose = frame_view(view, extent, camera.aspect, turn, is_from_right=is_hidden)
        with self._client.atomic():
            camera.fov = FOV_RAD
            camera.up_direction = pose.up
            camera.position = pose.position
            # Setting the position drags the point looked at along.
            camera.look_at = pose.look_at
        self._framed = (view, camera.aspect, pose.position)

    def _screenshot(self) -> bytes:
        """Return the present view as PNG on white, as large as the scene on the page.

        Raises
        ------
        ConfigError
            The page did not deliver the picture in time.
        """
        camera = self._client.camera
        # Not larger: points keep their size in pixels, and gaps would open between them.
        height, width = max(camera.image_height, 100), max(camera.image_width, 100)
        try:
            picture = self._client.get_render(height, width, transport_format="png", timeout=_RENDER_TIMEOUT_S)
        except (TimeoutError, RuntimeError) as error:
            raise ConfigError(
                "screenshot: the page did not deliver the picture; bring it to the front and try again"
            ) from error
        image = Image.fromarray(picture)
        paper = Image.new("RGBA", image.size, (255, 255, 255, 255))
        stream = io.BytesIO()
        Image.alpha_composite(paper, image.convert("RGBA")).convert("RGB").save(stream, "PNG")
        return stream.getvalue()

    def _restore(self) -> None:
        """Take up what a page of this browser, now closed, had asked of this same server."""
        storage = self._client.local_storage
        try:
            known = storage.get_item(_STORAGE_KEY, timeout=5.0)
        except (TimeoutError, RuntimeError):
            return
        self._browser_id = known if known and len(known) <= 64 else uuid.uuid4().hex
        storage.set_item(_STORAGE_KEY, self._browser_id)
        request = self._kept.take_up(self._browser_id)
        if request is not None:
            self._wanted_label = request.label
            self._panel.show_scan_name(request.label)
            self._panel.load(request.params)

    def _gravity(self) -> int:
        """Return the level at which an unforeseen failure is logged: once a page has gone, failing is what is left."""
        return logging.DEBUG if self._is_closed else logging.ERROR

    def _guard(self, action: Callable[..., None]) -> Callable[..., None]:
        """Wrap an action so that its failure is a sentence on the page, not a line in the server's log."""

        def guarded(*values: Any) -> None:
            try:
                action(*values)
            except StairError as error:
                if not self._is_closed:
                    self._notify(str(error))
            except Exception:
                # The outermost frame of a thread of viser's, which would only print it.
                logger.log(self._gravity(), "an action of a page failed", exc_info=True)
                if not self._is_closed:
                    self._notify("an internal error stopped this action; the server's log has the details")

        return guarded


def _read_choice(value: object) -> tuple[int | None, int | None]:
    """Return the step or the surface that an option of the menu or a row names; neither for none."""
    words = str(value).split(" ")
    if words == [NO_STEP]:
        return None, None
    try:
        number = int(words[-1])
    except ValueError as error:
        raise ConfigError(f"step: got {str(value)[:40]!r}; give a number") from error
    return (None, number) if words[0] == SURFACE else (number, None)
