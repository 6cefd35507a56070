"""The scene drawn twice by one camera: raw cloud and segmentation in two halves, or on the two sides of a bar.

viser has one picture of a scene. Here its renderer is called twice for each frame, for two parts of the picture, with
other nodes hidden: what is seen in both turns together, and is framed alike. In halves each picture is that of the
whole scene moved by a quarter of its width, so what is pressed in one is told to viser as if it were pressed in the
whole. Labels are seen in the right one alone. ``window.__viserMutable`` and the store of
react-three-fiber behind its scene are private to viser, hence the exact version in ``pyproject.toml``.
"""

from typing import Literal

from stair_inspector.viewer.bridge.markup import page_script, text

Arrangement = Literal["one", "halves", "swipe"]
_TAG = (
    "position:absolute;top:var(--si-overlay-top,48px);padding:1px 10px;"
    "border-radius:9px;font-size:12px;background:var(--mantine-color-body);border:1px solid "
    "var(--mantine-color-default-border)"
)
_BAR = (
    "position:absolute;top:0;bottom:0;width:16px;margin-left:-8px;cursor:ew-resize;pointer-events:auto;"
    "touch-action:none;background:linear-gradient(var(--mantine-color-text),var(--mantine-color-text)) center/2px 100% "
    "no-repeat"
)


def two_views_html(arrangement: Arrangement, left: str, right: str, names: tuple[str, str]) -> str:
    """Return what makes the scene be drawn once or twice, with the names of both views over them.

    Parameters
    ----------
    arrangement : {"one", "halves", "swipe"}
        ``swipe`` parts one picture by a bar that can be dragged, or moved by the arrow keys.
    left, right : str
        Nodes that are seen on that side alone, with all below them.
    names : tuple of str
        Of the left and of the right view.
    """
    tags = "".join(
        f'<span data-view="{k}" data-testid="view-name" style="{_TAG}">{text(n)}</span>' for k, n in enumerate(names)
    )
    bar = (
        f'<div data-testid="swipe" role="separator" aria-orientation="vertical" aria-label="{text(names[0])} left, '
        f'{text(names[1].lower())} right" tabindex="0" style="{_BAR}"></div>'
        if arrangement == "swipe"
        else ""
    )
    shown = "" if arrangement == "one" else tags + bar
    script = page_script("two_views", arrangement, [left, right])
    return (
        f'<div data-testid="two-views" data-arrangement="{arrangement}" style="position:fixed;z-index:3;'
        f'overflow:hidden;pointer-events:none;color:var(--mantine-color-text)">{shown}{script}</div>'
    )
