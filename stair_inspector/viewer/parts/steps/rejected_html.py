"""The list of rejected surfaces, as HTML."""

from stair_inspector.files.palettes import Rgb
from stair_inspector.model import Inspection
from stair_inspector.pictures.coloring import rejected_of
from stair_inspector.pictures.segmentation import MOST_REJECTED, SURFACE
from stair_inspector.viewer.bridge.markup import DIM, chip, row_start, table_head, text
from stair_inspector.viewer.parts.survey_html import CELL

_REJECTED_COLUMNS = (
    ("surface", "", "Number of the surface, and its colour in the scene"),
    ("height", "m", "Mean height in the scan's frame"),
    ("area", "m²", "Area in plan"),
    ("reason", "", "Why it is no step"),
)


def rejected_html(
    inspection: Inspection | None, color: Rgb, selected: int | None, pick_uuid: str, *, is_shown: bool
) -> str:
    """Return the list of rejected surfaces with the reason of each, the largest first.

    Parameters
    ----------
    inspection : Inspection, optional
        None is an empty list.
    color : Rgb
        Of rejected surfaces in the scene.
    selected : int, optional
        Surface whose row is emphasised.
    pick_uuid : str
        Identity of the control that a click on a row writes to.
    is_shown : bool
        False for an empty list.
    """
    if inspection is None or not is_shown:
        return '<div data-testid="rejected"></div>'
    patches = rejected_of(inspection)
    rows = "".join(
        f"{row_start(pick_uuid, patch.patch_id, SURFACE, is_selected=patch.patch_id == selected)}"
        f'<td style="{CELL}">{chip(color)} {patch.patch_id}</td><td style="{CELL}">{patch.height_m:.3f}</td>'
        f'<td style="{CELL}">{patch.area_m2:.2f}</td>'
        f'<td style="padding:2px 4px 2px 8px;font-weight:400">{text(patch.reason or "no reason given")}</td></tr>'
        for patch in patches[:MOST_REJECTED]
    )
    n_more = len(patches) - MOST_REJECTED
    more = f'<div style="color:{DIM};padding:2px 5px">and {n_more} smaller ones</div>' if n_more > 0 else ""
    words = "No surface was rejected." if inspection.patches else "This result has no surfaces to reject."
    none = "" if patches else f'<div style="color:{DIM};padding:2px 9px">{words}</div>'
    head = table_head(_REJECTED_COLUMNS, ("reason",)) if patches else ""
    return (
        '<div data-testid="rejected" class="si-results" style="font-size:11.5px;line-height:1.3;padding:0 12px 6px 0">'
        '<table data-testid="rejected-table" style="border-collapse:collapse;width:100%;'
        f'font-variant-numeric:tabular-nums">{head}<tbody>{rows}</tbody></table>{none}{more}</div>'
    )
