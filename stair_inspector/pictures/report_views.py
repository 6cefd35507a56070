"""The rendered pictures of a report: which views, in which order, with their captions."""

from dataclasses import dataclass

from stair_inspector.model import Inspection, Scan
from stair_inspector.pictures.cameras import View
from stair_inspector.pictures.display import choose_display
from stair_inspector.pictures.render import MOST_POINTS, Subject, render_view
from stair_inspector.pictures.residual_sheets import residual_sheets
from stair_inspector.units import Unit

REPORT_WIDTH = 1500
"""Pixels of a picture across a page: 220 for each inch of paper."""
_RESIDUALS = "residuals"
_RESIDUAL_WORDS = "Residuals: distance of every step's surface from its own plane"


@dataclass(frozen=True, slots=True)
class RenderedView:
    """A picture for a report: PNG, what it shows in words, and the part of the page's width that it deserves."""

    key: str
    caption: str
    png: bytes
    share: float


def report_views(
    scan: Scan,
    inspection: Inspection,
    date: str,
    *,
    title: str = "",
    unit: Unit = "mm",
    width: int = REPORT_WIDTH,
) -> tuple[RenderedView, ...]:
    """Return the views of a report: raw and segmented beside each other, front, top, side, and the residuals.

    Without a staircase there is the raw scan alone.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    date, title : str
        Burned into every picture, beside the scan's name.
    unit : {"mm", "in"}
        Of the scale bar.
    width : int
        Of a picture as wide as the page, pixels.
    """
    wanted: list[tuple[Subject, View, float, str]] = [("Raw", "Home", 0.5, "the scan as it came, in its own colours")]
    if inspection.steps:
        wanted += [
            ("Segmented", "Home", 0.5, "floor, treads in turn from bottom to top, and the edges that were found"),
            ("Segmented", "Front", 0.5, "seen by who climbs, without perspective"),
            ("Segmented", "Top", 0.5, "from above, without perspective; what lies higher than the stair is left out"),
            ("Segmented", "Side", 1.0, "from the side, without perspective"),
        ]
    display = choose_display(scan, MOST_POINTS)
    views = tuple(
        RenderedView(
            key=f"{subject}_{view}".lower(),
            caption=f"{subject}, {view.lower()} view: {words}",
            png=render_view(
                scan,
                inspection,
                view,
                subject,
                (round(width * share), None),
                date,
                title=title,
                unit=unit,
                display=display,
                text_scale=1.0 / share,
            ),
            share=share,
        )
        for subject, view, share, words in wanted
    )
    return views + residual_views(scan, inspection, date, title=title, unit=unit, width=width)


def residual_views(
    scan: Scan, inspection: Inspection, date: str, *, title: str = "", unit: Unit = "mm", width: int = REPORT_WIDTH
) -> tuple[RenderedView, ...]:
    """Return the maps of the residuals of every tread, in as many pictures as they need; see :func:`report_views`."""
    sheets = residual_sheets(scan, inspection, date, title=title, unit=unit, width=width)
    return tuple(
        RenderedView(f"{_RESIDUALS}_{number}", f"{_RESIDUAL_WORDS} ({number} of {len(sheets)})", sheet, 1.0)
        if len(sheets) > 1
        else RenderedView(_RESIDUALS, _RESIDUAL_WORDS, sheet, 1.0)
        for number, sheet in enumerate(sheets, 1)
    )


def is_residual_map(view: RenderedView) -> bool:
    """Return whether a picture is one of :func:`residual_views`, of treads and not of a scene."""
    return view.key.startswith(_RESIDUALS)
