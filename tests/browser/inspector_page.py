"""The page as a person uses it: what can be read on it and what can be done to it, by label and not by id."""

import io
import os
import shutil
import time

import numpy as np
from PIL import Image

from stair_inspector.content.note_words import note_sentence
from stair_inspector.content.remarks import on_page
from stair_inspector.viewer.bridge.tour import SEEN_KEY

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
ARGUMENTS = (
    "--no-sandbox",
    "--headless=new",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    # Without a graphics card the page around the scene is put together faster by the processor itself.
    "--disable-gpu-compositing",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
SETTLE_MS = 120_000
"""Longest wait for anything that a page should show; a busy machine may take minutes for what takes one second."""
THROTTLE_MS = 80
"""viser sends one edit of a panel in 50 ms and forgets the one before: two edits must be farther apart."""
PRESET = ("survey", "θ_th 15°", "ε_z 20 mm", "m 50 ", "α 95/5 ", "sides 99 ", "k 30 ", "axes auto", ") floor", "unit m")
"""What the page says of the settings that every page begins with."""
SCENE_SHARPNESS = 0.5
"""Pixels of the scene for one of the page: the scene is drawn by the processor, which takes most of its time."""
VIEW_PANEL = (40, 820)
"""Height and width of the corner that the toolbar over the scene takes up, pixels."""
OPENED = []
"""Every page that has not been closed yet."""
_KNOWN_NOISE = ("THREE.Clock",)
_READY = """([used, state]) => {
    const text = (id) => document.querySelector(`[data-testid=${id}]`)?.innerText ?? '';
    const now = document.querySelector('[data-testid=state]')?.dataset.state;
    return now === state && used.every((part) => text('used').includes(part));
}"""


def find_browser():
    """Path of a Chromium, or None."""
    named = os.environ.get("STAIR_INSPECTOR_BROWSER")
    found = [named] if named else [shutil.which(name) for name in BROWSERS]
    return next((path for path in found if path), None)


def rows_of(inspection):
    """What the side table must say of an inspection in the paper's columns: the floor's row, then one for each step."""
    floor = inspection.floor
    rows = []
    if floor is not None:
        rows = [["floor", _mm(inspection.floor_h_m), "", "", "", "", f"{floor.n_points:,}", _mm(floor.rms_m, 2)]]
    for step in inspection.steps:
        of = step.paper
        slope = "–" if of.theta_deg is None else f"{of.theta_deg:.2f}"
        lengths = [_mm(length) for length in (of.h_m, of.d_fb_m, of.d_ff_m, of.w_m)]
        rows.append([str(step.step_id), *lengths, slope, f"{step.plane.n_points:,}", _mm(step.plane.rms_m, 2)])
    if inspection.steps:
        return rows
    (why,) = [note.message for note in inspection.notes if note.code == "no_staircase"]
    return [*rows, [note_sentence(on_page(why))]]


def survey_rows_of(inspection):
    """What the rows of steps must say in the survey's columns: number, four lengths and the pitch, each with its u."""
    return [
        [
            str(step.step_id),
            *(_with_u(each, 1000.0) for each in (step.rise_m, step.going_m, step.tread_depth_m, step.width_m)),
            _with_u(step.pitch_deg, 1.0),
        ]
        for step in inspection.steps
    ]


def _mm(value_m, digits=1):
    return "–" if value_m is None else f"{1000.0 * value_m:.{digits}f}"


def _with_u(measured, scale):
    """Return ``(value, u)`` as shown, u within its last digit; None for a dash."""
    return None if measured is None else (round(scale * measured.value, 1), scale * measured.u)


def click_at_once(element):
    """Click without waiting for frames to be drawn, for what is not itself the subject of a test."""
    element.evaluate("(element) => element.click()")


def share_of(color, picture, within=6):
    """Share of the pixels within a few levels of a colour."""
    return float((np.abs(picture - np.array(color)).max(axis=2) <= within).mean())


def share_changed(before, after):
    """Share of the pixels that differ plainly between two pictures."""
    return float((np.abs(before - after).max(axis=2) > 24).mean())


class InspectorPage:
    """One browser page of the inspector, with a browser profile of its own."""

    def __init__(
        self, browser, address, width=1280, height=720, context=None, sharpness=SCENE_SHARPNESS, has_tour=False
    ):
        self.context = context or browser.new_context(
            viewport={"width": width, "height": height}, accept_downloads=True
        )
        self.page = self.context.new_page()
        if not has_tour:
            self.page.add_init_script(f"localStorage.setItem({SEEN_KEY!r}, 'seen')")
        OPENED.append(self)
        self.page.set_default_timeout(SETTLE_MS)
        self.problems = []
        self.is_scene_touched = False
        self.page.on("console", self._note_console)
        self.page.on("pageerror", lambda error: self.problems.append(f"page error: {error}"))
        self.page.goto(f"{address}&fixedDpr={sharpness}")

    def _note_console(self, message):
        if message.type == "error" and not any(known in message.text for known in _KNOWN_NOISE):
            self.problems.append(f"console: {message.text}")

    def open(self):
        """Wait for the first result and put viser's remark about software rendering away."""
        self.await_result()
        self.close_notifications()
        self.home = self.still_camera()
        # A tab has no content before it is opened, and keeps it afterwards.
        self.tab("Steps")
        self.page.get_by_label("Selected step").first.wait_for()
        self.tab("Tune")
        self.by_id("histogram").first.wait_for()
        return self

    def close(self):
        # A test may close its page before the fixture does.
        if self in OPENED:
            OPENED.remove(self)
        self.context.close()

    # Reading.

    def by_id(self, name):
        return self.page.locator(f"[data-testid={name}]")

    def text(self, name):
        return self.by_id(name).inner_text()

    def table(self):
        """Text of the cells, row by row, without the head."""
        return self.page.evaluate(
            "() => [...document.querySelectorAll('[data-testid=steps-table] tbody tr')]"
            ".map((row) => [...row.cells].map((cell) => cell.innerText.trim()))"
        )

    def survey_table(self):
        """The rows of steps in the survey's columns: number, then value and u of each quantity, None for a dash."""

        def read(cell):
            if cell == "–":
                return None
            value, u = cell.split("±")
            return float(value), float(u)

        rows = [cells for cells in self.table() if len(cells) == 8]
        return [[cells[0].split()[0], *(read(cell) for cell in cells[1:6])] for cells in rows]

    def await_columns(self, columns):
        self.page.locator(f"[data-testid=steps][data-columns={columns}]").wait_for(state="attached")

    def choose_columns(self, columns):
        """Show the survey's or the paper's columns."""
        click_at_once(self.by_id("table-view").get_by_role("button", name=columns.capitalize(), exact=True))
        self.await_columns(columns)

    def selected_rows(self):
        return [
            int(row.get_attribute("data-step"))
            for row in self.page.locator("[data-testid=step-row][aria-selected=true]").all()
        ]

    def scene(self):
        """Names of the nodes in the scene."""
        return set(self.page.evaluate("() => Object.keys(window.__viserSceneTree.getState())"))

    def notifications(self):
        return [item.inner_text() for item in self.page.locator(".mantine-Notification-root").all()]

    def is_stale(self):
        """Whether the table is drawn as that of other settings: grey in a dashed frame, and as dark as ever."""
        drawn = "(element) => { const s = getComputedStyle(element); return [s.filter, s.outlineStyle, s.opacity]; }"
        grey, frame, opacity = self.by_id("steps").evaluate(drawn)
        assert opacity == "1"
        assert (grey == "grayscale(1)") == (frame == "dashed")
        return frame == "dashed"

    def picture(self):
        """The scene as it is on the screen, (h, w, 3), black where the toolbar lies on it."""
        picture = np.array(Image.open(io.BytesIO(self.canvas.screenshot())).convert("RGB")).astype(int)
        picture[: VIEW_PANEL[0], : VIEW_PANEL[1]] = 0
        return picture

    def still_picture(self, unlike=None):
        """The scene once two pictures in a row are the same, and not like an earlier one."""
        before = self.picture()
        ends = time.monotonic() + SETTLE_MS / 1000.0
        while time.monotonic() < ends:
            self.page.wait_for_timeout(50)
            now = self.picture()
            if np.array_equal(before, now) and (unlike is None or share_changed(unlike, now) > 0.001):
                return now
            before = now
        raise AssertionError("the scene does not come to rest, or does not change")

    def camera(self):
        """Where the camera stands, metres."""
        return self.page.evaluate("() => window.__viserMutable.camera.position.toArray()")

    def still_camera(self):
        """Where the camera stands once the picture has got its shape."""
        seen = []
        ends = time.monotonic() + SETTLE_MS / 1000.0
        while time.monotonic() < ends:
            seen.append(self.camera())
            # On a busy machine the page may take half a second for its answer to a new shape.
            if seen[-4:] == [seen[-1]] * 4:
                return seen[-1]
            self.page.wait_for_timeout(250)
        raise AssertionError("the camera does not come to rest")

    def await_camera(self, position):
        from playwright.sync_api import TimeoutError

        try:
            self.page.wait_for_function(
                "(wanted) => window.__viserMutable.camera.position.toArray()"
                ".every((value, axis) => Math.abs(value - wanted[axis]) < 0.001)",
                arg=position,
            )
        except TimeoutError as error:
            raise AssertionError(f"waited for the camera at {position}, it is at {self.camera()}") from error

    @property
    def canvas(self):
        return self.page.locator("canvas[data-engine]")

    # Waiting.

    def await_result(self, *used, state="ready"):
        """Wait until the page is at rest and names these settings as used."""
        from playwright.sync_api import TimeoutError

        try:
            self.page.wait_for_function(_READY, arg=[list(used), state])
        except TimeoutError as error:
            seen = [self.by_id(name).all_inner_texts() for name in ("status", "used")]
            raise AssertionError(f"waited for {used} and {state}, the page says {seen}") from error

    def await_error(self):
        """Wait for the sentence of a failed run and return it."""
        self.by_id("error").wait_for()
        return self.text("error")

    def await_selection(self, *steps):
        """Wait until exactly these rows are emphasised."""
        self.page.wait_for_function(
            "(wanted) => JSON.stringify([...document.querySelectorAll('[data-testid=step-row][aria-selected=true]')]"
            ".map((row) => Number(row.dataset.step))) === JSON.stringify(wanted)",
            arg=list(steps),
        )

    def await_node(self, name, there=True):
        """Wait until the scene has a node of that name, or has it no longer."""
        self.page.wait_for_function(
            "([name, there]) => (name in window.__viserSceneTree.getState()) === there", arg=[name, there]
        )

    def await_notification(self, words):
        note = self.page.locator(".mantine-Notification-root", has_text=words)
        note.wait_for()
        return note.inner_text()

    # Doing.

    def tab(self, name):
        """Go to a tab of the panel, unless it is there."""
        tab = self.page.get_by_role("tab", name=name, exact=True)
        if tab.get_attribute("aria-selected") != "true":
            tab.click()

    def control(self, label):
        """The row of the control with a label."""
        name = self.page.get_by_text(label, exact=True).and_(self.page.locator("label")).first
        return self.page.locator(f'[id="{name.get_attribute("for")}"]')

    def uuid(self, label):
        return self.page.get_by_text(label, exact=True).and_(self.page.locator("label")).first.get_attribute("for")

    def press(self, label, key, times=1):
        self.tab("Tune")
        slider = self.control(label).get_by_role("slider")
        slider.focus()
        for _ in range(times):
            slider.press(key)
            self.page.wait_for_timeout(THROTTLE_MS)

    def type_number(self, label, number):
        """Write into the number box beside a slider, as typing does: without leaving the box."""
        self.tab("Tune")
        # The box is the slider's neighbour in the row.
        box = self.control(label).locator("xpath=ancestor::*[.//input[contains(@class,'NumberInput-input')]][1]")
        box.locator("input.mantine-NumberInput-input").first.fill(str(number))
        self.page.wait_for_timeout(THROTTLE_MS)

    def slider_value(self, label):
        self.tab("Tune")
        return float(self.control(label).get_by_role("slider").get_attribute("aria-valuenow"))

    def open_scan(self, label):
        """Open a scan of the list on the Scan tab."""
        self.tab("Scan")
        row = (
            "() => [...document.querySelectorAll('[data-testid=scan-row]')].find((row) => row.dataset.scan === wanted)"
        )
        self.page.wait_for_function(f"(wanted) => ({row})()", arg=label)
        self.page.evaluate(f"(wanted) => ({row})().click()", label)
        self.page.wait_for_timeout(THROTTLE_MS)

    def choose(self, label, option):
        self.page.get_by_label(label, exact=True).first.click()
        self.page.get_by_role("option", name=option, exact=True).click()
        self.page.wait_for_timeout(THROTTLE_MS)

    def hotkey(self, key):
        """Press a key that means a command: no field may have the focus."""
        self.page.evaluate("() => document.activeElement && document.activeElement.blur()")
        self.page.keyboard.press(key)

    def send(self, uuid, value):
        """Send a value as no control of the page would."""
        self.page.evaluate(
            "([uuid, value]) => window.__viserMutable.sendMessage({type: 'GuiUpdateMessage', uuid, updates: {value}})",
            [uuid, value],
        )
        self.page.wait_for_timeout(THROTTLE_MS)

    def show(self, button):
        """Press a button of the toolbar over the scene."""
        self.is_scene_touched = True
        self.by_id("toolbar").get_by_role("button", name=button, exact=True).click()

    def set_dark(self, is_dark):
        """Show the page dark, or light."""
        wanted = "dark" if is_dark else "light"
        scheme = "document.documentElement.dataset.mantineColorScheme"
        if self.page.evaluate(scheme) != wanted:
            click_at_once(self.by_id("toolbar").get_by_role("button", name=wanted.capitalize(), exact=True))
            self.page.wait_for_function(f"(wanted) => {scheme} === wanted", arg=wanted)

    def click_row(self, step):
        self.page.locator(f"[data-testid=step-row][data-step='{step}']").click()

    def tidy(self):
        """Undo what tests do: the preset's settings, the first scan, no step chosen, steps coloured, seen from home."""
        self.page.keyboard.press("Escape")
        self.close_notifications()
        self.tab("Tune")
        if not self.text("scan").startswith("stair.ply"):
            self.tab("Scan")
            self.open_scan("stair.ply")
            self.page.locator("[data-testid=scan]", has_text="stair.ply").wait_for()
            self.tab("Tune")
        # Only if it will show: a reset that is still under way would undo the next test's first edit.
        if not self.page.evaluate(_READY, [list(PRESET), "ready"]):
            self.hotkey("Shift+R")
        self.set_dark(False)
        # Home frames the steps that are shown: those of other settings would be framed elsewhere.
        self.await_result(*PRESET)
        if self.is_scene_touched:
            for name in ("Segmented", "Home"):
                click_at_once(self.by_id("toolbar").get_by_role("button", name=name, exact=True))
                self.page.wait_for_timeout(THROTTLE_MS)
            self.await_camera(self.home)
            self.is_scene_touched = False
        # What a tab holds can be read and clicked while another is shown, once it has been opened in this connection.
        # To show it takes half a second.
        if not self.page.get_by_label("Selected step").count():
            self.tab("Steps")
            self.page.get_by_label("Selected step").first.wait_for()
            self.tab("Tune")
        if self.page.get_by_label("Show rejected surfaces").is_checked():
            click_at_once(self.page.get_by_label("Show rejected surfaces"))
        if self.by_id("steps").get_attribute("data-columns") != "survey":
            self.choose_columns("survey")
        for step in self.selected_rows():
            click_at_once(self.page.locator(f"[data-testid=step-row][data-step='{step}']"))
        self.await_selection()
        # What is measured on the screen must be in sight.
        self.page.evaluate("() => [...document.querySelectorAll('*')].forEach((each) => { each.scrollTop = 0; })")

    def download(self, kind, timeout_ms=SETTLE_MS):
        """Name and content of an exported file."""
        self.tab("Export")
        with self.page.expect_download(timeout=timeout_ms) as waiting:
            # The head of a folder is a button too, to who cannot see it.
            self.page.get_by_role("button", name=kind, exact=True).and_(self.page.locator("button")).click()
        with open(waiting.value.path(), "rb") as stream:
            return waiting.value.suggested_filename, stream.read()

    def close_notifications(self):
        # In one go: one that closes by itself meanwhile is not waited for.
        self.page.wait_for_function(
            "() => { const notes = [...document.querySelectorAll('.mantine-Notification-root')];"
            " notes.forEach((note) => note.querySelector('button')?.click()); return notes.length === 0; }"
        )
