"""The View tool: what is shown, from where, and views that are kept."""

from typing import Any

import viser

from stair_inspector.errors import ConfigError
from stair_inspector.viewer.cameras import VIEWS, from_saved, to_saved
from stair_inspector.viewer.desk import Desk, Editor
from stair_inspector.viewer.looking import Looking
from stair_inspector.viewer.notices import from_page
from stair_inspector.viewer.scene import MODES

_NO_VIEW = "none"


class ViewTool:
    """Buttons for modes and standard views, and a list of the inspector's own views."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, looking: Looking, editor: Editor) -> None:
        self._desk = desk
        self._looking = looking
        self._editor = editor
        guard = desk.notices.guard
        mode = gui.add_button_group("Show", MODES, hint="Raw cloud, coloured steps, or both side by side.")
        mode.on_click(from_page(guard(self.set_mode), lambda: mode.value))
        view = gui.add_button_group("Camera", VIEWS, hint="Stand back from that side of the staircase. Keys 1 to 5.")
        view.on_click(from_page(guard(self.set_view), lambda: view.value))
        step = gui.add_button_group("Look at", ("Chosen step", "Whole stair"), hint="Keys S and 1.")
        step.on_click(from_page(guard(self._look_at), lambda: step.value))
        self.control_uuids: tuple[str, str, str] = (mode._impl.uuid, view._impl.uuid, step._impl.uuid)
        """Of the groups for modes, views and targets; the toolbar over the scene writes into them."""
        self._ortho: Any = gui.add_checkbox("Orthographic", False, hint="Parallels stay parallel. Key O.")
        self._ortho.on_update(from_page(guard(self.set_ortho), lambda: self._ortho.value))
        with gui.add_folder("My views", expand_by_default=False):
            self._name: Any = gui.add_text("View name", "", hint="What the view is kept under.")
            keep = gui.add_button("Keep this view", icon=viser.Icon.BOOKMARK)
            keep.on_click(lambda _: guard(self.keep)())
            self._kept: Any = gui.add_dropdown("Go to", (_NO_VIEW,), initial_value=_NO_VIEW)
            self._kept.on_update(from_page(guard(self.go_to), lambda: self._kept.value))
            forget = gui.add_button("Forget that view", icon=viser.Icon.TRASH, color="gray")
            forget.on_click(lambda _: guard(self.forget)())

    def set_mode(self, option: str) -> None:
        """Show the raw cloud, the steps, or both."""
        with self._desk.lock:
            self._looking.set_mode(option)

    def set_view(self, option: str) -> None:
        """Look from a standard side."""
        with self._desk.lock:
            self._looking.set_view(option)

    def look_at_step(self) -> None:
        """Look at the chosen step."""
        with self._desk.lock:
            self._looking.look_at_step()

    def set_ortho(self, is_ortho: bool) -> None:
        """Switch the orthographic look."""
        with self._desk.lock:
            self._looking.set_ortho(is_ortho)

    def switch_ortho(self) -> None:
        """Switch the orthographic look on or off, and its box with it."""
        with self._desk.lock:
            self._looking.set_ortho(not self._looking.is_ortho)
            self._ortho.value = self._looking.is_ortho

    def keep(self) -> None:
        """Keep where the camera stands, under a name."""
        with self._desk.lock:
            shown = self._desk.result("keep view")
            known = [view.name for view in self._editor.work.views]
            name = str(self._name.value).strip() or f"View {len(known) + 1}"
            fov_rad = float(self._desk.client.camera.fov)
            view = to_saved(name, self._looking.pose(), fov_rad, self._desk.stage.rotation, shown.scan.origin_m)
            kept = tuple(each for each in self._editor.work.views if each.name != name)
            self._editor.change(f"kept view {name}", views=(*kept, view))

    def go_to(self, name: str) -> None:
        """Look as a kept view does."""
        with self._desk.lock:
            view = next((view for view in self._editor.work.views if view.name == name), None)
            if view is None:
                if name == _NO_VIEW:
                    return
                raise ConfigError(f"view: got {str(name)[:40]!r}; choose one of the menu")
            shown = self._desk.result("go to view")
            pose, fov_rad = from_saved(view, self._desk.stage.rotation, shown.scan.origin_m)
            self._looking.go_to(pose, fov_rad)

    def forget(self) -> None:
        """Delete the kept view that is chosen."""
        with self._desk.lock:
            name = self._kept.value
            kept = tuple(view for view in self._editor.work.views if view.name != name)
            if len(kept) == len(self._editor.work.views):
                raise ConfigError("forget view: choose a kept view first")
            self._editor.change(f"forgot view {name}", views=kept)

    def show(self) -> None:
        """List the kept views."""
        options = (_NO_VIEW, *(view.name for view in self._editor.work.views))
        if tuple(self._kept.options) != options:
            self._kept.options = options
            self._kept.value = options[-1]

    def _look_at(self, option: str) -> None:
        if option == "Chosen step":
            self.look_at_step()
        else:
            self.set_view("Home")
