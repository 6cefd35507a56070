"""What is docked below the scene, as wide as it: the table of steps, in view from the first second on.

viser docks panels at the left and the right of the page only. Like the toolbar, this is made inside the panel and
moves itself out of it; the scene ends where it begins, so that nothing is covered. It keeps, while its content is
replaced at every result: how far it is scrolled, which row has the keyboard, which menu is open, how high it was drawn
and whether it is folded. Cells whose text is another one than before are marked for a moment.
"""

from stair_inspector.viewer.bridge.markup import LINE, page_script, press_attribute, text

_ID = "stair-inspector-dock"
_HEIGHT = "--si-dock"
_FOLDED = "stair-inspector-folded"
_LOWEST_PX = 60
_KEY_PX = 24
"""By how much an arrow key moves the upper edge."""
_SHARE = 0.37
"""Of the page's height, at most; until its upper edge is dragged."""
BODY = "dock-body"
"""``data-testid`` of what is scrolled, and put away when it is folded."""
_STYLE = (
    f"<style>[data-dock-root]>div:has(canvas[data-engine]){{bottom:var({_HEIGHT},0px)!important}}"
    f"#{_ID} [data-testid={BODY}]{{overflow:auto;overscroll-behavior:contain;"
    f"max-height:var({_HEIGHT}-most,max({100 * _SHARE:g}vh - 30px,{_LOWEST_PX}px))}}"
    f".{_FOLDED} #{_ID} [data-testid={BODY}]{{display:none}}"
    f".{_FOLDED} #{_ID} [data-testid=dock-fold]{{transform:rotate(-90deg)}}"
    f"#{_ID} th{{background:var(--mantine-color-body);z-index:1}}"
    f"#{_ID} [data-testid=dock-edge]::after{{content:'';position:absolute;left:50%;top:50%;width:36px;height:3px;"
    "margin:-1px 0 0 -18px;border-radius:2px;background:var(--mantine-color-dimmed);opacity:.6}"
    "@keyframes stair-inspector-changed{from{background:rgba(250,176,5,.55)}to{background:transparent}}</style>"
)


def docked_html(bar: str, body: str, same: str, label: str) -> str:
    """Return what is docked below the scene.

    Parameters
    ----------
    bar, body : str
        HTML of the line at its top, which stays when it is folded, and of what is scrolled below.
    same : str
        Of what the body tells: cells are compared with those of before only where this is the same.
    label : str
        Its name for screen readers.
    """
    fold = press_attribute(
        f"const r=document.documentElement.classList,f=r.toggle('{_FOLDED}');"
        "this.setAttribute('aria-expanded',!f);window.dispatchEvent(new Event('stair-inspector-dock'))"
    )
    return (
        f'<div data-testid="dock" role="region" aria-label="{text(label)}" data-same="{text(same)}" '
        'style="position:fixed;bottom:0;z-index:4;box-sizing:border-box;color:var(--mantine-color-text);'
        f'background:var(--mantine-color-body);border-top:1px solid {LINE}">{_handle()}'
        '<div style="display:flex;align-items:center;gap:8px;padding:0 10px 2px 6px;font-size:12px;min-height:26px">'
        f'<button type="button" data-testid="dock-fold" aria-label="Fold {text(label.lower())}" '
        f'title="Fold or unfold" aria-expanded="true" {fold} style="border:0;background:none;cursor:pointer;'
        f'color:inherit;padding:2px 4px">▾</button>{bar}</div>'
        f'<div data-testid="{BODY}" style="padding:0 4px 0 6px">{body}</div>{page_script("dock")}</div>{_STYLE}'
    )


def menu_html(testid: str, words: str, hint: str, entries: str) -> str:
    """Return a button of the bar that opens a list above it; it stays open while its content is replaced."""
    return (
        f'<details data-testid="{testid}" data-keep="{testid}" style="position:relative;flex:none">'
        f'<summary title="{text(hint)}" style="cursor:pointer;list-style:none;border:1px solid {LINE};'
        f'border-radius:5px;padding:2px 8px">{text(words)} ▴</summary>'
        f'<div style="position:absolute;bottom:100%;left:0;z-index:6;border:1px solid {LINE};border-radius:5px;'
        "background:var(--mantine-color-body);padding:4px;max-height:60vh;overflow:auto;white-space:nowrap;"
        f'box-shadow:0 2px 10px rgba(0,0,0,.25)">{entries}</div></details>'
    )


def _handle() -> str:
    """Return the upper edge, which can be dragged: how high the body may be is the page's own."""
    # On the window, not on the edge: a result that comes meanwhile, as after a tap, replaces the table with its edge.
    begin = (
        f"const w=window,b=this.parentElement.querySelector('[data-testid={BODY}]'),y=event.clientY,"
        f"p=event.pointerId,of=b.offsetHeight,move=e=>{{if(e.pointerId===p){{{_resize('of+y-e.clientY')}}}}},"
        "end=e=>{if(e.pointerId!==p)return;w.removeEventListener('pointermove',move);"
        "for(const k of ['pointerup','pointercancel'])w.removeEventListener(k,end)};"
        "w.addEventListener('pointermove',move);w.addEventListener('pointerup',end);"
        "w.addEventListener('pointercancel',end);event.preventDefault()"
    )
    step = f"b.offsetHeight+(event.key==='ArrowUp'?{_KEY_PX}:-{_KEY_PX})"
    by_key = (
        "if(/^Arrow(Up|Down)$/.test(event.key)){event.preventDefault();event.stopPropagation();"
        f"const b=this.parentElement.querySelector('[data-testid={BODY}]');{_resize(step)}}}"
    )
    return (
        '<div data-testid="dock-edge" data-key="dock-edge" role="separator" aria-orientation="horizontal" '
        f'aria-label="Height of the table" aria-valuenow="{100 * _SHARE:.0f}" tabindex="0" onkeydown="{text(by_key)}" '
        f'onpointerdown="{text(begin)}" style="position:absolute;top:-4px;left:0;right:0;height:8px;cursor:ns-resize;'
        'touch-action:none"></div>'
    )


def _resize(height: str) -> str:
    """Return the script that lets the body be so high, an expression in pixels."""
    return (
        f"const h=Math.min(Math.max({height},{_LOWEST_PX}),innerHeight*.75);"
        f"document.documentElement.style.setProperty('{_HEIGHT}-most',h+'px');"
        "window.dispatchEvent(new Event('stair-inspector-dock'))"
    )
