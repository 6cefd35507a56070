"""The pictures of a report with their captions, made without a display from the scan, the inspection and the check."""

from collections.abc import Sequence
from datetime import datetime

from stair_inspector.codes.findings import Check
from stair_inspector.content.document import Figure, plain
from stair_inspector.content.order import Pictures
from stair_inspector.drawings.sheets import plan_svgs, section_svgs
from stair_inspector.model import ComparedScan, Inspection, Scan
from stair_inspector.pictures.change_sheets import change_sheets
from stair_inspector.pictures.chart_limits import ChartedQuantity
from stair_inspector.pictures.nosing_charts import nosing_charts
from stair_inspector.pictures.report_views import RenderedView, is_residual_map, report_views
from stair_inspector.pictures.step_charts import step_charts

_ON_FRONT = 2
"""So many views of half the width stand on the first page: the raw and the segmented scan."""


def draw_pictures(
    scan: Scan,
    inspection: Inspection,
    check: Check | None,
    made_at: datetime,
    *,
    title: str = "",
    views: Sequence[RenderedView] | None = None,
    compared: ComparedScan | None = None,
) -> Pictures:
    """Return every picture of a report.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected; without a staircase there are only views of the scan.
    check : Check, optional
        Whose limits are drawn in the charts.
    made_at : datetime
        Its date and the ``title`` are burned into the views.
    views : sequence of RenderedView, optional
        Pictures of the scene, as the inspector's page takes them; by default they are rendered without a display. Those
        whose key begins with ``residuals`` stand with the steps.
    compared : ComparedScan, optional
        What changed against a second scan: a map of every tread.
    """
    if views is None:
        views = report_views(scan, inspection, f"{made_at:%Y-%m-%d}", title=title)
    residuals = [view for view in views if is_residual_map(view)]
    others = [view for view in views if view not in residuals]
    front = [view for view in others if view.share <= 0.5][:_ON_FRONT]
    return Pictures(
        front=_views(front),
        views=_views([view for view in others if view not in front]),
        bars=(*_bars(inspection, "rise", check), *_bars(inspection, "going", check)),
        nosing_lines=_nosing_lines(inspection),
        residuals=_views(residuals),
        changes=_changes(compared, f"{made_at:%Y-%m-%d}", title),
        drawings=(*_drawings("plan", plan_svgs(inspection)), *_drawings("section", section_svgs(inspection))),
    )


def _views(views: Sequence[RenderedView]) -> tuple[Figure, ...]:
    return tuple(
        Figure(view.key, plain(view.caption), plain(view.caption), "png", view.png, view.share) for view in views
    )


def _changes(compared: ComparedScan | None, date: str, title: str) -> tuple[Figure, ...]:
    if compared is None:
        return ()
    words = "Change of every tread along its normal, upwards positive; what lies off the rest of its tread is outlined"
    sheets = change_sheets(compared, date, title=title)
    return tuple(Figure(f"change_{number}", words, words, "png", sheet) for number, sheet in enumerate(sheets, 1))


def _bars(inspection: Inspection, quantity: ChartedQuantity, check: Check | None) -> tuple[Figure, ...]:
    limits = " with the limits of the rule set" if check is not None else ""
    words = f"{quantity.capitalize()} of every step{limits}; the scale does not begin at zero"
    return tuple(
        _drawn(f"{quantity}_{number}", words, f"bar chart of the {quantity} of every step in millimetres", drawn)
        for number, drawn in enumerate(step_charts(inspection, quantity, check), 1)
    )


def _nosing_lines(inspection: Inspection) -> tuple[Figure, ...]:
    return tuple(
        _drawn(
            f"nosing_line_{flight.flight_id}",
            f"Flight {flight.flight_id}: deviation of each nosing from the best-fit line of the nosings",
            f"deviation of the nosings of flight {flight.flight_id} from their best-fit line in millimetres",
            drawn,
        )
        for flight, drawn in nosing_charts(inspection)
    )


def _drawings(key: str, sheets: tuple[tuple[str, str], ...]) -> tuple[Figure, ...]:
    return tuple(
        _drawn(
            f"{key}_{number}", f"{plain(title)}; millimetres", f"{key} drawing with dimensions in millimetres", drawn
        )
        for number, (title, drawn) in enumerate(sheets, 1)
    )


def _drawn(key: str, caption: str, alt: str, drawn: str) -> Figure:
    return Figure(key, caption, alt, "svg", drawn.encode("utf-8"))
