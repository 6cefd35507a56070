"""What lies over the scene: a toolbar along its upper edge and the legend in its lower left corner.

viser can put nothing there. Both are made inside the panel, and move themselves out of it as soon as they are there: so
they stay when the panel is folded away, and follow the scene when it is docked elsewhere. The toolbar's buttons write
what they ask for into a hidden control; see markup.order_script for the hook.
"""

import json
from dataclasses import dataclass
from typing import Literal

from stair_inspector.viewer.bridge.markup import LINE, order_script, script_html, text
from stair_inspector.viewer.bridge.styles import NOTICES_BELOW, OVERLAY_HEIGHT

_GAP = 10
"""From the edges of the scene, pixels."""


@dataclass(frozen=True, slots=True)
class Tool:
    """A button of the toolbar: its words, what it explains, and the order that it writes.

    ``is_on`` says of one of several whether it is the chosen one; None for a button that only does something.
    """

    words: str
    hint: str
    order: str
    is_on: bool | None = None


def toolbar_html(orders_uuid: str, groups: tuple[tuple[Tool, ...], ...]) -> str:
    """Return the toolbar: groups of buttons in one row, which write to the control of that identity."""
    made = "".join(
        '<span style="display:inline-flex;border-radius:5px;overflow:hidden;'
        f'border:1px solid {LINE};background:var(--mantine-color-body)">'
        f"{''.join(_button(orders_uuid, tool) for tool in group)}</span>"
        for group in groups
    )
    return (
        '<div data-testid="toolbar" role="toolbar" aria-label="Views" style="position:fixed;z-index:5;display:flex;'
        f'flex-wrap:wrap;gap:8px;color:var(--mantine-color-text)">{made}{_lift("top", 900)}</div>{NOTICES_BELOW}'
    )


def overlay_html(content: str) -> str:
    """Return content that lies in the lower left corner of the scene; the mouse goes through it."""
    return (
        '<div data-testid="overlay" style="position:fixed;z-index:4;pointer-events:none;border-radius:5px;'
        f"border:1px solid {LINE};color:var(--mantine-color-text);"
        'background:color-mix(in srgb, var(--mantine-color-body) 94%, transparent)">'
        f"{content}{_lift('bottom', 1200)}</div>"
    )


def _lift(edge: Literal["top", "bottom"], widest: int) -> str:
    """Return the clear picture that moves its parent over the scene, to one edge of it, and keeps it there."""
    place = {"top": f"r.top+{_GAP}", "bottom": f"innerHeight-r.bottom+{_GAP}"}[edge]
    name = json.dumps(f"stair-inspector-{edge}")
    script = (
        f"(i=>{{const e=i.parentElement,place=()=>{{if(!e.isConnected)return clearInterval(timer);"
        "const c=document.querySelector('canvas[data-engine]');if(!c)return;const r=c.getBoundingClientRect();"
        f"e.style.left=r.left+{_GAP}+'px';e.style.maxWidth=Math.min({widest},r.width-{2 * _GAP})+'px';"
        f"e.style.{edge}={place}+'px';"
        f"document.documentElement.style.setProperty('{OVERLAY_HEIGHT}-{edge}',e.offsetHeight+{2 * _GAP}+'px')}};"
        f"document.getElementById({name})?.remove();e.id={name};document.body.appendChild(e);"
        "const timer=setInterval(place,300);place()})(this)"
    )
    return script_html(script)


def _button(orders_uuid: str, tool: Tool) -> str:
    script = order_script(orders_uuid, tool.order)
    state = "" if tool.is_on is None else f' aria-pressed="{"true" if tool.is_on else "false"}"'
    colors = (
        "background:var(--mantine-primary-color-filled);color:#fff" if tool.is_on else "background:none;color:inherit"
    )
    return (
        f'<button type="button" title="{text(tool.hint)}" onclick="{text(script)}"{state} style="border:0;'
        f'cursor:pointer;{colors};font:inherit;font-size:12px;padding:3px 8px">{text(tool.words)}</button>'
    )
