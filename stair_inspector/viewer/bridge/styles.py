"""Styles of the page that viser has no setting for, found by the names that its client gives to what it draws."""

READABLE = (
    "<style>html{--mantine-color-dimmed:light-dark(#495057,#c1c2c5)!important;"
    "--mantine-color-gray-filled:light-dark(#596067,#495057)!important;"
    "--mantine-color-gray-filled-hover:light-dark(#495057,#5c636a)!important}"
    "[data-dock-tab][role=tab]{opacity:1!important}"
    ".mantine-Slider-markLabel{font-size:11px!important;color:var(--mantine-color-dimmed)!important}"
    ".mantine-Notification-description{color:var(--mantine-color-dimmed)!important}"
    "details[open]>summary{white-space:normal!important}"
    "[role=button]:focus-visible,[data-step]:focus-visible"
    "{outline:2px solid var(--mantine-primary-color-filled)}</style>"
)
"""viser's labels have a contrast of 3.3, its grey buttons too, and the ends of its sliders are written in 9 pixels.
Text needs 4.5 and 11 pixels."""
_FOLDER = ".mantine-Paper-root>.mantine-Paper-root:has(>.tabler-icon-chevron-down,>.tabler-icon-chevron-up)"
FOLDERS = (
    f"<style>.mantine-Paper-root:has(>{_FOLDER.partition('>')[2]})"
    "{padding:0!important;margin-top:6px!important;min-height:0!important;overflow:clip}"
    f"{_FOLDER}{{position:static!important;transform:none!important;width:auto!important;margin:0!important;"
    "padding:4px 8px!important;border:0!important;border-radius:0!important;font-weight:600!important;"
    "background:var(--mantine-color-default-hover)!important}"
    f"{_FOLDER}~div~div,{_FOLDER}>svg{{display:none!important}}"
    f"{_FOLDER}::before{{content:'▸' / '';display:inline-block;width:1.1em}}"
    f"{_FOLDER}:has(>.tabler-icon-chevron-up)::before{{content:'▾' / ''}}</style>"
)
"""viser's closed folder is an empty frame with words on its edge: here a row with an arrow, above what it holds."""
PHONE = (
    "<style>@media(max-width:36em){"
    '.mantine-Paper-root[style*="width: 20em"]{max-height:42%!important}'
    '[style*="width: 20em"]{width:100vw!important}'
    "[data-testid=dock-body]{max-height:var(--si-dock-most,26vh)!important}"
    "[data-testid=dock] td:first-child{position:sticky;left:0;background:var(--mantine-color-body)}"
    "[data-testid=toolbar],[data-testid=overlay] [data-testid=legend]"
    "{flex-wrap:nowrap!important;overflow-x:auto;scrollbar-width:none;pointer-events:auto}"
    '.mantine-Paper-root[style*="width: 20em"] .mantine-ScrollArea-scrollbar[data-orientation=horizontal]'
    "{display:none}"
    "[data-testid=toolbar]>span{flex:none}}"
    "@media(pointer:coarse){[data-testid=dock-edge]{top:-14px!important;height:24px!important}"
    "[data-testid=swipe]{width:36px!important;margin-left:-18px!important}}</style>"
)
"""Where viser's panel is a sheet at the foot of the window it is as wide as that, and stair and table stand above it.
What is dragged by a finger is wide enough for one."""
NARROW_TABS = (
    "<style>[data-dock-tab][role=tab]{padding:0 .5em!important}"
    "[data-dock-tab][role=tab]>div{display:none!important}</style>"
)
"""So that all tabs of the panel stand on one line: their words say what they are."""
CLEAR_OF_THE_SCROLLBAR = (
    "<style>.mantine-ScrollArea-viewport:has([data-testid=scan])>*{box-sizing:border-box;padding-right:8px}</style>"
)
"""viser draws it over the right end of the controls."""
OVERLAY_HEIGHT = "--si-overlay"
"""Before ``-top`` or ``-bottom``: how much of the scene's edge is covered, which the page itself measures."""
NOTICES_BELOW = (
    f"<style>.mantine-Notifications-root[data-position^=top]{{top:var({OVERLAY_HEIGHT}-top,48px)!important}}</style>"
)
"""viser's notices would cover the toolbar."""
RESULTS = "si-results"
"""Class of what belongs to the result that is shown."""
_FRAME = "outline:2px dashed var(--mantine-color-dimmed);outline-offset:-2px"
STALE_RESULTS = f"<style>.{RESULTS}{{filter:grayscale(1);{_FRAME}}}</style>"
"""Of a result that is not that of the present settings: grey and in a dashed frame, its words as dark as before. Not
part of any element's own style: what looks so need not be sent again."""


def wide_window(testid: str, width_px: int) -> str:
    """Return the style that makes a window wide: viser's own are as wide as a message.

    Parameters
    ----------
    testid : str
        ``data-testid`` of what the window holds.
    width_px : int
        Pixels; on a smaller page nearly all of its width.
    """
    return (
        f"<style>.mantine-Modal-content:has([data-testid={testid}])"
        f"{{flex:0 0 min({width_px}px,96vw)!important;max-width:96vw!important}}</style>"
    )
