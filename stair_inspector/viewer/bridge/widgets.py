"""The controls of a page as its parts make them: with a guarded callback for what a person does, and with types.

What the server itself sets calls nothing back. Callbacks get the control's value of the moment in which they run, since
viser runs them on many threads at once; what a page sends may be of any kind and is checked by whoever takes it.
"""

from collections.abc import Callable
from typing import Protocol, TypeVar, cast

import viser

from stair_inspector.viewer.bridge.choices import Choice
from stair_inspector.viewer.bridge.handles import Handle, uuid_of
from stair_inspector.viewer.bridge.notices import Event, from_page, orders_from_page

Guard = Callable[[Callable[..., None]], Callable[..., None]]


Value = TypeVar("Value")


class Input(Handle, Protocol[Value]):
    """A control that holds a value which a person can change."""

    value: Value
    visible: bool

    @property
    def on_update(self) -> Callable[[Callable[[Event], None]], object]:
        """Attach what is called when the value has changed."""


Text = Input[str]
"""A field for a line, or for lines, of text."""
Checkbox = Input[bool]
"""A box that is ticked or not."""
Vector = Input[tuple[float, float, float]]
"""Three numbers."""


class Dropdown(Input[str], Protocol):
    """A menu of which one option is chosen."""

    options: tuple[str, ...]


class Slider(Input[float], Protocol):
    """A number between two ends."""

    min: float
    max: float


class Button(Handle, Protocol):
    """A button."""

    label: str
    visible: bool


class Buttons(Handle, Protocol):
    """A row of buttons; ``value`` is that of the one that was pressed last."""

    value: str
    visible: bool


class File(Protocol):
    """An uploaded file."""

    @property
    def name(self) -> str:
        """What it is called where it comes from."""

    @property
    def content(self) -> bytes:
        """Its bytes."""


class Upload(Handle, Protocol):
    """A button that opens the dialog of files."""

    value: File
    visible: bool


Made = TypeVar("Made", Text, Checkbox, Dropdown, Slider, Vector)


class Widgets:
    """Makes the controls of one page, each in the folder or tab that is open.

    Parameters
    ----------
    gui : viser.GuiApi
        Of the page.
    guard : callable
        Around every callback: see :meth:`~stair_inspector.viewer.bridge.notices.Notices.guard`.
    """

    def __init__(self, gui: viser.GuiApi, guard: Guard) -> None:
        self.gui = gui
        self._guard = guard

    def html(self, content: str = "") -> viser.GuiHtmlHandle:
        """Add a piece of HTML; every text in it that could come from a file is escaped by whoever makes it."""
        return self.gui.add_html(content)

    def folder(self, title: str, *, is_open: bool = True) -> viser.GuiFolderHandle:
        """Add a folder, to be filled in a ``with`` statement."""
        return self.gui.add_folder(title, expand_by_default=is_open)

    def form(self, title: str, on_submit: Callable[[], None]) -> viser.GuiFormHandle:
        """Add a closed folder whose fields count when it is submitted, as by Enter in one of them."""
        form = self.gui.add_form(title, expand_by_default=False)
        action = self._guard(on_submit)
        form.on_submit(lambda _: action())
        return form

    def text(
        self,
        label: str,
        value: str = "",
        *,
        hint: str | None = None,
        is_multiline: bool = False,
        on_change: Callable[[str], None] | None = None,
    ) -> Text:
        """Add a text field."""
        made = cast(Text, self.gui.add_text(label, value, multiline=is_multiline, hint=hint))
        return self._watched(made, on_change)

    def orders(self, label: str, on_order: Callable[[str], None]) -> str:
        """Add a hidden control into which buttons, rows and drawings of the page write; return its identity.

        Each order is read as it comes. See :func:`~stair_inspector.viewer.bridge.markup.write_script`.
        """
        hidden = self.gui.add_text(label, "", visible=False)
        hidden.on_update(orders_from_page(self._guard(on_order), lambda: hidden.value))
        return uuid_of(hidden)

    def checkbox(
        self,
        label: str,
        *,
        is_on: bool = False,
        hint: str | None = None,
        is_visible: bool = True,
        on_change: Callable[[bool], None] | None = None,
    ) -> Checkbox:
        """Add a box to tick."""
        made = cast(Checkbox, self.gui.add_checkbox(label, is_on, hint=hint, visible=is_visible))
        return self._watched(made, on_change)

    def dropdown(
        self,
        label: str,
        options: tuple[str, ...],
        *,
        chosen: str | None = None,
        hint: str | None = None,
        is_visible: bool = True,
        on_change: Callable[[str], None] | None = None,
    ) -> Dropdown:
        """Add a menu; its first option is chosen where none is named."""
        made = self.gui.add_dropdown(
            label, options, initial_value=options[0] if chosen is None else chosen, hint=hint, visible=is_visible
        )
        return self._watched(cast(Dropdown, made), on_change)

    def slider(
        self,
        label: str,
        ends: tuple[float, float],
        step: float,
        value: float,
        *,
        hint: str | None = None,
        on_change: Callable[[float], None] | None = None,
    ) -> Slider:
        """Add a slider."""
        made = self.gui.add_slider(label, ends[0], ends[1], step, value, hint=hint)
        return self._watched(cast(Slider, made), on_change)

    def vector(
        self,
        label: str,
        value: tuple[float, float, float],
        *,
        step: float,
        hint: str | None = None,
        on_change: Callable[[tuple[float, float, float]], None] | None = None,
    ) -> Vector:
        """Add three numbers."""
        return self._watched(cast(Vector, self.gui.add_vector3(label, value, step=step, hint=hint)), on_change)

    def button(
        self,
        label: str,
        action: Callable[[], None],
        *,
        icon: viser.IconName | None = None,
        hint: str | None = None,
        is_quiet: bool = False,
        is_visible: bool = True,
    ) -> Button:
        """Add a button; a quiet one is grey."""
        made = self.gui.add_button(label, icon=icon, hint=hint, color="gray" if is_quiet else None, visible=is_visible)
        guarded = self._guard(action)
        made.on_click(lambda _: guarded())
        return cast(Button, made)

    def buttons(
        self,
        label: str,
        options: tuple[str, ...],
        on_press: Callable[[str], None],
        *,
        hint: str | None = None,
        is_visible: bool = True,
    ) -> Buttons:
        """Add a row of buttons; ``on_press`` gets the words of the pressed one."""
        made = self.gui.add_button_group(label, options, hint=hint, visible=is_visible)
        made.on_click(from_page(self._guard(on_press), lambda: made.value))
        return cast(Buttons, made)

    def choice(
        self,
        label: str,
        options: tuple[str, ...],
        chosen: str,
        on_press: Callable[[str], None],
        *,
        hint: str | None = None,
    ) -> Choice:
        """Add a row of buttons of which one is on."""
        made = Choice(self.gui, label, options, chosen, hint)
        made.group.on_click(from_page(self._guard(on_press), lambda: made.group.value))
        return made

    def upload(
        self,
        label: str,
        types: str,
        on_file: Callable[[File], None],
        *,
        icon: viser.IconName,
        hint: str | None = None,
    ) -> Upload:
        """Add a button to upload files of the types, as endings that are separated by commas."""
        made = self.gui.add_upload_button(label, icon=icon, mime_type=types, hint=hint)
        guarded = self._guard(on_file)
        made.on_upload(lambda _: guarded(made.value))
        return cast(Upload, made)

    def _watched(self, made: Made, on_change: Callable[..., None] | None) -> Made:
        if on_change is not None:
            made.on_update(from_page(self._guard(on_change), lambda: made.value))
        return made


def offer(menu: Dropdown, options: tuple[str, ...], chosen: str | None = None) -> None:
    """Offer other options where they differ, and choose one: that of before, or the first, where ``chosen`` is none."""
    wanted = menu.value if chosen is None else chosen
    if tuple(menu.options) != options:
        menu.options = options
    menu.value = wanted if wanted in options else options[0]
