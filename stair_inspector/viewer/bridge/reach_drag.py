"""Dragging over the height histogram chooses eps_z: while it lasts, the browser itself draws how far the reach goes."""

from stair_inspector.declarations import Knob
from stair_inspector.params import SETTINGS
from stair_inspector.viewer.bridge.markup import text, write_script

REACH = "reach"
"""Word with which a drag is told to the server, before the reach in millimetres."""
_KNOB: Knob = SETTINGS.knob("levels.eps_m")
_LOWEST, _HIGHEST = _KNOB.shown(_KNOB.low), _KNOB.shown(_KNOB.high)
_SHORTEST = 3.0
"""A drag over less, in units of the drawing, is a click that was not quite still."""


def drag_attributes(pick_uuid: str, width: float, mm_per_unit: float) -> str:
    """Return the attributes that make an SVG drawing react to a drag.

    Parameters
    ----------
    pick_uuid : str
        Identity of the control that the reach is written to when the drag ends, as ``reach 23``.
    width : float
        Of the drawing, its own units.
    mm_per_unit : float
        Millimetres of height to a unit.
    """
    place = f"(event.clientX-this.getBoundingClientRect().left)*{width}/this.getBoundingClientRect().width"
    reach = f"Math.min({_HIGHEST:g},Math.max({_LOWEST:g},Math.round(Math.abs({place}-this._from)*{mm_per_unit:.6g})))"
    begin = f"this._from={place};this.setPointerCapture(event.pointerId)"
    move = (
        f"if(this._from!==undefined){{const e={reach},w=e/{mm_per_unit:.6g},"
        "b=this.querySelector('[data-reach]');b.setAttribute('x1',this._from);b.setAttribute('x2',this._from);b.setAttribute('stroke-width',2*w);"
        "b.setAttribute('opacity',0.35);this.querySelector('[data-reach-text]').textContent='ε_z '+e+' mm'}"
    )
    end = (
        f"if(this._from!==undefined&&Math.abs({place}-this._from)>{_SHORTEST:g}){{const e={reach};"
        + write_script(pick_uuid, f"'{REACH} '+e+':'+Date.now()")
        + "};this._from=undefined"
    )
    return (
        f' onpointerdown="{text(begin)}" onpointermove="{text(move)}" onpointerup="{text(end)}" '
        'style="cursor:ew-resize;touch-action:none;user-select:none"'
    )


def reach_mark(top: float, height: float) -> str:
    """Return the band that shows the reach while it is dragged; nothing is seen of it before."""
    return (
        f'<line data-reach="1" x1="0" x2="0" y1="{top:g}" y2="{top + height:g}" stroke="rgb(0, 170, 185)" opacity="0"/>'
    )
