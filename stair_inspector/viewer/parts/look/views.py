"""The View tool: what is shown, from where, and views that are kept."""

import viser

from stair_inspector.errors import ConfigError, one_of
from stair_inspector.files.projects import SavedView
from stair_inspector.pictures.cameras import VIEWS, from_saved, to_saved
from stair_inspector.viewer.bridge.markup import DIM, LINE, list_key, read_order, text
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.scene.measurements import ORDERS, free_name, order_buttons
from stair_inspector.viewer.scene.stage import MODES

TARGETS = ("Chosen step", "Whole stair", "Whole scan")


class ViewTool:
    """Buttons for modes and standard views, and a list of the inspector's own views."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._look = context.look
        self._editor = context.editor
        widgets = context.widgets
        self._mode = widgets.choice(
            "Show",
            MODES,
            self._desk.stage.mode,
            self._look.choose_mode,
            hint="Raw cloud, coloured steps, both side by side, or both parted by a bar. Keys 7 to 0.",
        )
        hint = "Stand back from that side of the staircase. Keys 1 to 5."
        widgets.buttons("Camera", VIEWS, self._look.set_view, hint=hint)
        widgets.buttons("Look at", TARGETS, self.look_at, hint="Keys F and 1.")
        hint = "Parallels stay parallel. Key O."
        self._ortho = widgets.checkbox("Orthographic", hint=hint, on_change=self._look.set_ortho)
        with widgets.folder("My views", is_open=False):
            self._name = widgets.text("View name", hint="What the view is kept under.")
            widgets.button(
                "Keep this view", self.keep, icon=viser.Icon.BOOKMARK, hint="With the project, to go back to it. Key V."
            )
            self._list = widgets.html()
            self._orders = widgets.orders("View order", self.obey)

    def switch_ortho(self) -> None:
        """Switch the orthographic look on or off, and its box with it."""
        with self._desk.lock:
            self._look.set_ortho(not self._look.is_ortho)
            self._ortho.value = self._look.is_ortho

    def keep(self) -> None:
        """Keep where the camera stands, under a name.

        Raises
        ------
        ConfigError
            Another view has that name.
        """
        with self._desk.lock:
            shown = self._desk.result("keep view")
            known = {view.name for view in self._editor.work.views}
            name = " ".join(str(self._name.value).split()) or free_name("View", known)
            if name in known:
                raise ConfigError(f"keep view: the name {name[:60]!r} is taken; give another one")
            pose, fov_rad = self._look.camera()
            view = to_saved(name, pose, fov_rad, self._desk.stage.rotation, shown.scan.origin_m)
            self._editor.edit(f"kept view {name}", lambda work: {"views": (*work.views, view)})
            # A name that stays would be taken when the next view is kept.
            self._name.value = ""

    def obey(self, message: str) -> None:
        """Look as a kept view does, or forget it, as a button of the list asks."""
        order = read_order(message, ORDERS)
        with self._desk.lock:
            views = self._editor.work.views
            index = order.index_in(views, "kept views")
            if order.word == "delete":
                self._editor.change(f"forgot view {views[index].name}", views=views[:index] + views[index + 1 :])
                return
            shown = self._desk.result("go to view")
            pose, fov_rad = from_saved(views[index], self._desk.stage.rotation, shown.scan.origin_m)
            self._look.go_to(pose, fov_rad)

    def show(self) -> None:
        """Say what is shown, and list the kept views."""
        self._mode.show(self._desk.stage.mode)
        self._list.content = views_html(self._editor.work.views, self._orders)

    def look_at(self, option: str) -> None:
        """Look at the chosen step, the stair or everything."""
        one_of(option, TARGETS, "look at")
        with self._desk.lock:
            if option == TARGETS[0]:
                self._look.look_at_step()
            else:
                self._look.look("Home", is_whole=option == TARGETS[2])


def views_html(views: tuple[SavedView, ...], order_uuid: str) -> str:
    """Return the list of kept views, a row for each with buttons to look from there and to forget it."""
    key = list_key(views)
    rows = "".join(
        f'<div data-testid="view-row" style="display:flex;justify-content:space-between;border-bottom:1px solid {LINE};'
        f'padding:1px 0"><span style="overflow-wrap:anywhere">{text(view.name)}</span>'
        f'<span style="white-space:nowrap">{order_buttons(order_uuid, key, number, view.name)}</span></div>'
        for number, view in enumerate(views, start=1)
    )
    none = f'<span style="color:{DIM}">No view kept yet: turn the scene, then keep the view (key V).</span>'
    style = "font-size:12px;line-height:1.5;padding:0 12px 6px 9px"
    return f'<div data-testid="views" style="{style}">{rows or none}</div>'
