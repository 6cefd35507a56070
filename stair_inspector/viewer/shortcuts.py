"""Keys and commands: one list makes the hotkeys, the palette (Ctrl+K) and the help card."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.viewer.markup import DIM, LINE, text


@dataclass(frozen=True, slots=True)
class Command:
    """What a key does; ``key`` and ``modifier`` as viser names them, an empty key for a command without one."""

    label: str
    action: Callable[[], None]
    key: str = ""
    modifier: str = ""


_KEY_WORDS = {
    "arrowup": "↑",
    "arrowdown": "↓",
    "escape": "Esc",
    "cmd/ctrl": "Ctrl",
    "cmd/ctrl+shift": "Ctrl+Shift",
    "shift": "Shift",
}
_MOUSE = (
    ("Drag", "turn the scene"),
    ("Right drag", "move it"),
    ("Wheel", "come nearer"),
    ("Click a tread", "choose the step"),
    ("Shift+click", "pick a point"),
)


def add_commands(gui: viser.GuiApi, commands: tuple[Command, ...]) -> None:
    """Register the commands; hotkeys do nothing while somebody types in a field."""
    for command in commands:
        key: Any = command.key or None
        modifier: Any = command.modifier or None
        handle = gui.add_command(command.label, hotkey=key, modifier=modifier)
        handle.on_trigger(_calling(command.action))


def key_words(command: Command) -> str:
    """Return a command's key as a person reads it: ``Ctrl+Z``."""
    key = _KEY_WORDS.get(command.key, command.key.upper())
    return f"{_KEY_WORDS.get(command.modifier, command.modifier)}+{key}" if command.modifier else key


def help_html(commands: tuple[Command, ...]) -> str:
    """Return the help card: every key with what it does, and what the mouse does."""
    keys = [(key_words(command), command.label) for command in commands if command.key]
    keys.append(("Ctrl+K", "Find a command by its name"))
    rows = "".join(
        f'<div style="display:flex;gap:8px;border-bottom:1px solid {LINE};padding:2px 0">'
        f'<kbd style="min-width:6.2em;font-family:inherit;font-weight:600">{text(key)}</kbd>'
        f"<span>{text(words)}</span></div>"
        for key, words in (*keys, *_MOUSE)
    )
    return (
        f'<div data-testid="help" style="font-size:12.5px;line-height:1.5;columns:2;column-gap:24px">{rows}</div>'
        f'<div style="font-size:12px;color:{DIM};padding-top:8px">Keys do nothing while you type in a field. '
        "θ_th, ε_z, m, α_f, α_b and k are the paper's symbols; rest on a control's name to read what it does.</div>"
    )


def show_help(gui: viser.GuiApi, commands: tuple[Command, ...]) -> None:
    """Open the help card."""
    with gui.add_modal("Keys and mouse") as modal:
        gui.add_html(help_html(commands))
        close = gui.add_button("Close", color="gray")
    close.on_click(lambda _: modal.close())


def _calling(action: Callable[[], None]) -> Callable[[Any], None]:
    return lambda _: action()
