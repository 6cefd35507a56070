"""Keys and commands: one list makes the hotkeys, the palette (Ctrl+K) and the help card."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.viewer.bridge.cards import Card
from stair_inspector.viewer.bridge.markup import DIM, LINE, script_html, text
from stair_inspector.viewer.bridge.tour import tour_button_html


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
_OTHERS = (
    ("W A S D Q E", "move the camera"),
    ("← →", "turn the scene"),
    ("Drag", "turn the scene"),
    ("Right drag", "move it"),
    ("Wheel", "come nearer"),
    ("Click a tread", "choose the step"),
    ("Shift+click", "pick a point"),
)


_HEAD = "cursor:pointer;font-weight:600;padding:2px 0"
_WIDE_CARD = (
    "<style>.mantine-Modal-content:has([data-testid=help])"
    "{flex:0 0 auto !important;width:min(900px,calc(100vw - 40px));max-height:calc(100vh - 20px) !important}</style>"
)
"""viser's cards are narrow, and cut off in a small window."""


def keys_html() -> str:
    """Return what settles, within the browser, who a key is for: viser itself tells a page only of commands.

    Up and down choose a step, and must not turn viser's camera as well. On a slider, and to the sides on a row of tabs,
    the arrows are that control's alone. And a number beside a slider that is out of its range stays as it was written,
    with the sentence about it: the browser would put the nearest end of the range there, which nobody has chosen.
    """
    script = (
        "(()=>{if(window.__stairInspectorKeys)return;window.__stairInspectorKeys=true;"
        "document.body.addEventListener('keydown',e=>{if(e.key.startsWith('Arrow')&&e.target.closest("
        "/Left|Right/.test(e.key)?'[role=slider],[role=tablist]':'[role=slider]'))e.stopPropagation()});"
        "document.documentElement.addEventListener('keydown',e=>{"
        "if(e.key==='ArrowUp'||e.key==='ArrowDown')e.stopPropagation()});"
        "document.addEventListener('focusout',e=>{const s=e.target.matches('input.mantine-NumberInput-input')&&"
        "e.target.closest('.mantine-Flex-root')?.querySelector('[role=slider]');"
        "if(s&&e.target.value!==''&&(+e.target.value<+s.ariaValueMin||+e.target.value>+s.ariaValueMax))"
        "e.stopImmediatePropagation()},true)})()"
    )
    return script_html(script)


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


def help_html(commands: tuple[Command, ...], glossary: str) -> str:
    """Return the help card: the tour, what is measured (HTML), every key with what it does, and what the mouse does."""
    keys = [(key_words(command), command.label) for command in commands if command.key]
    keys.append(("Ctrl+K", "Find a command by its name"))
    rows = "".join(
        f'<div style="display:flex;gap:8px;border-bottom:1px solid {LINE};padding:1px 0;break-inside:avoid">'
        f'<kbd style="min-width:7em;font-family:inherit;font-weight:600;white-space:nowrap">{text(key)}</kbd>'
        f"<span>{text(words)}</span></div>"
        for key, words in (*keys, *_OTHERS)
    )
    return (
        f'{_WIDE_CARD}<div data-testid="help" style="font-size:12.5px;line-height:1.45">'
        f"{tour_button_html('Tour of the page')} "
        f'<span style="color:{DIM}">Rest on the name of a control to read what it does.</span>'
        f'<details style="margin:8px 0"><summary style="{_HEAD}">What is measured: drawing and glossary</summary>'
        f'{glossary}</details><details open><summary style="{_HEAD}">Keys and mouse</summary>'
        f'<div style="columns:17em;column-gap:24px">{rows}</div>'
        f'<div style="font-size:12px;color:{DIM};padding:8px 0">Keys do nothing while you type in a field.</div>'
        "</details></div>"
    )


class HelpCard(Card):
    """The help card of one page; there is at most one."""

    def __init__(self, gui: viser.GuiApi) -> None:
        super().__init__(gui, "Help")

    def switch(self, commands: tuple[Command, ...], glossary: str) -> None:
        """Open the card, or close it where it is open; ``glossary`` is HTML."""
        if not self.close():
            self.fill(lambda: self._gui.add_html(help_html(commands, glossary)))


def _calling(action: Callable[[], None]) -> Callable[[object], None]:
    return lambda _: action()
