"""What is measured of a staircase: every quantity once, with its names, its definition, its unit and where it is shown.

Whoever shows, writes, judges or compares quantities reads them here. To add one of a step, add a :class:`Quantity` to
:data:`QUANTITIES`: it appears in the page's table, card and comparison, in JSON, CSV and its schema, in the report, in
the terminal and in what ``stair-inspector quantities`` prints.
"""

import itertools
from collections.abc import Iterable, Sequence
from typing import Literal, TypeGuard

from stair_inspector.measured import (
    diagonal_of,
    rise_of_flight,
    run_of_flight,
    steepest_slope_of,
    two_r_plus_g_of,
    usable,
)
from stair_inspector.model import CUT_BACK, CUT_SIDES, Measured, Step
from stair_inspector.quantity_types import NOTATIONS, PaperQuantity, Quantity, ReportPlace, SiUnit

RISE = Quantity(
    name="rise",
    definition="vertical, from the nosing below, or the floor or landing in front of the lowest riser, to this nosing, "
    "on the centre line",
    head="rise",
    code_term="riser height (US), rise (UK)",
    of_step=lambda step, _: step.rise_m,
    on_lines=lambda step: step.rise_lcr_m,
    statistics=lambda flight: flight.rise,
    rests_on="from_below",
    kinds=("tread", "landing"),
    is_chained=True,
    doubted_by=("nosing_unobserved",),
    lost_by=((0, "tread_missing"), (0, "rise_unobserved")),
    note_words=("rise",),
    place=ReportPlace("steps", 1),
)
GOING = Quantity(
    name="going",
    definition="horizontal, square to the edge, from this nosing to the next, on the centre line",
    head="going",
    code_term="tread depth (US), going (UK)",
    of_step=lambda step, _: step.going_m,
    on_lines=lambda step: step.going_lcr_m,
    statistics=lambda flight: flight.going,
    rests_on="to_next",
    is_chained=True,
    is_of_line=True,
    doubted_by=("nosing_unobserved",),
    lost_by=((1, "tread_missing"),),
    note_words=("going",),
    is_other_in_codes=True,
    place=ReportPlace("steps", 2),
)
WIDTH = Quantity(
    name="width",
    definition="between the side edges of the tread; not the clear width between handrails",
    words="tread width",
    head="width",
    code_term="width (US: clear width between handrails)",
    of_step=lambda step, _: step.width_m,
    of_flight=lambda flight, _: flight.width_m,
    doubted_by=("side_unobserved",),
    lost_by=((0, CUT_SIDES),),
    note_words=("width", "side"),
    is_other_in_codes=True,
    place=ReportPlace("steps", 5),
)
PITCH = Quantity(
    name="pitch",
    unit="deg",
    definition="angle of the line from this nosing to the next; of a flight, of the line fitted to all its nosings",
    head="pitch",
    code_term="pitch (UK)",
    of_step=lambda step, _: step.pitch_deg,
    of_flight=lambda flight, _: flight.pitch_deg,
    rests_on="to_next",
    is_of_line=True,
    note_words=("pitch", "going"),
    place=ReportPlace("steps", 7),
)

QUANTITIES: tuple[Quantity, ...] = (
    RISE,
    GOING,
    Quantity(
        name="tread_depth",
        definition="from the nosing to the face of the riser above, or to the tread's back edge",
        head="depth",
        of_step=lambda step, _: step.tread_depth_m,
        rests_on="nosing",
        is_of_line=True,
        doubted_by=("nosing_unobserved", "back_hidden"),
        lost_by=((0, "back_unobserved"), (0, CUT_BACK)),
        note_words=("depth", "back"),
        is_other_in_codes=True,
        place=ReportPlace("steps", 3),
    ),
    WIDTH,
    Quantity(
        name="nosing_overhang",
        definition="tread depth less going, square to the nosing above",
        label="overhang",
        words="nosing overhang",
        code_term="nosing projection (US), tread overlap (UK)",
        of_step=lambda step, _: step.nosing_overhang_m,
        made_of=("tread_depth", "going"),
        rests_on="to_next",
        may_be_negative=True,
        is_size=False,
        doubted_by=("back_hidden",),
        lost_by=((1, "tread_missing"), (0, "back_unobserved"), (0, CUT_BACK)),
        note_words=("overhang", "back", "depth"),
        place=ReportPlace("steps", 4),
    ),
    PITCH,
    Quantity(
        name="fall",
        unit="deg",
        definition="slope of the tread along the climb: positive where it falls towards its nosing",
        words="fall to the nosing",
        of_step=lambda step, _: step.fall_deg,
        may_be_negative=True,
        is_size=False,
        note_words=("fall",),
        is_limited=False,
        place=ReportPlace("evidence", 1),
    ),
    Quantity(
        name="cross_fall",
        unit="deg",
        definition="slope of the tread across the climb: positive where it is higher on the left, as one climbs",
        label="cross-fall",
        of_step=lambda step, _: step.cross_fall_deg,
        may_be_negative=True,
        is_size=False,
        note_words=("fall",),
        is_limited=False,
        place=ReportPlace("evidence", 2),
    ),
    Quantity(
        name="two_r_plus_g",
        definition="twice the rise to the step and its going",
        code_term="twice the rise plus the going (UK), 2R + G (AU)",
        label="2R + G",
        of_step=two_r_plus_g_of,
        made_of=("rise", "going"),
        rests_on="both",
        is_of_line=True,
        doubted_by=("nosing_unobserved",),
        lost_by=(*RISE.lost_by, *GOING.lost_by),
        is_in_files=False,
        is_on_card=False,
        is_read=False,
        place=ReportPlace("steps", 6),
    ),
    Quantity(
        name="diagonal",
        definition="from this nosing to the next, along the line between them",
        of_step=diagonal_of,
        rests_on="to_next",
        is_in_files=False,
        is_on_card=False,
        is_read=False,
        is_limited=False,
        place=ReportPlace("steps", 8),
    ),
    *(
        Quantity(
            name=f"{kind}_slope",
            unit="tangent",
            definition=f"slope of a {kind} in its steepest direction",
            label=f"slope of {kind}s",
            code_term=f"slope of the walking surface of {kind}s (US)",
            of_step=steepest_slope_of,
            made_of=("fall", "cross_fall"),
            is_size=False,
            kinds=(kind,),
            is_in_files=False,
            is_on_card=False,
            is_read=False,
            place=None,
        )
        for kind in ("tread", "landing")
    ),
    Quantity(
        name="flight_rise",
        definition="sum of a flight's rises",
        code_term="vertical rise of a flight (US)",
        label="total rise",
        of_flight=rise_of_flight,
    ),
    Quantity(
        name="flight_run",
        definition="sum of a flight's goings, from its first nosing to its last",
        label="total run",
        of_flight=run_of_flight,
        is_limited=False,
    ),
    Quantity(
        name="n_risers",
        unit="count",
        definition="number of risers of a flight, those of missing treads included",
        code_term="risers in a flight (AU)",
        label="number of risers",
        of_flight=lambda flight, _: Measured(float(flight.n_risers), 0.0),
        is_size=False,
        is_read=False,
    ),
)
"""Every quantity of a step or a flight, in the order of the files' columns."""

PAPER_QUANTITIES: tuple[PaperQuantity, ...] = (
    PaperQuantity(
        "h",
        "m",
        "h",
        "Height h",
        "height from this centroid to the next: (c_k+1 - c_k) · u",
        lambda paper: paper.h_m,
        survey="rise",
    ),
    PaperQuantity(
        "d_fb",
        "m",
        "d_FB",
        "Front to back d_FB",
        "depth front to back: f_k - b_k",
        lambda paper: paper.d_fb_m,
        survey="tread_depth",
    ),
    PaperQuantity(
        "d_ff",
        "m",
        "d_FF",
        "Front to front d_FF",
        "depth front to front: |f_k+1 - f_k|",
        lambda paper: paper.d_ff_m,
        survey="going",
    ),
    PaperQuantity("w", "m", "W", "Width W", "width between the side edges", lambda paper: paper.w_m, survey="width"),
    PaperQuantity(
        "theta",
        "deg",
        "θ",
        "Angle θ",
        "slope from this centroid to the next against the plane",
        lambda paper: paper.theta_deg,
        survey="pitch",
    ),
    PaperQuantity(
        "f", "m", "f", "Front edge f", "depth coordinate of the front edge", lambda paper: paper.f_m, is_shown=False
    ),
    PaperQuantity(
        "b", "m", "b", "Back edge b", "depth coordinate of the back edge", lambda paper: paper.b_m, is_shown=False
    ),
)
"""Every quantity of the paper's method, in the order of the files' columns."""

_BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}

OF_STEP = tuple(quantity for quantity in QUANTITIES if quantity.of_step is not None)
OF_FLIGHT = tuple(quantity for quantity in QUANTITIES if quantity.of_flight is not None)
IN_FILES = tuple(quantity for quantity in OF_STEP if quantity.is_in_files)
"""Quantities of a step that JSON and CSV hold."""
ON_CARD = tuple(quantity for quantity in OF_STEP if quantity.is_on_card)
"""Quantities of a step that its card shows."""
IN_TABLE = tuple(quantity for quantity in OF_STEP if quantity.head)
"""Quantities of a step that the narrow tables of page and terminal have room for."""
ON_LINES = tuple(quantity for quantity in OF_STEP if quantity.on_lines is not None)
"""Quantities of a step that are measured on three lines."""
COMPARED = tuple(quantity for quantity in QUANTITIES if quantity.statistics is not None)
"""Quantities of which a flight has statistics."""
LIMITED = tuple(quantity for quantity in QUANTITIES if quantity.is_limited)
"""Quantities that a rule set may limit."""
SHOWN_OF_PAPER = tuple(quantity for quantity in PAPER_QUANTITIES if quantity.is_shown)
SURVEY_VALUES = tuple(quantity.field for quantity in IN_FILES if quantity.field is not None)
"""The fields of :class:`Step` that hold a value with its uncertainty."""


def is_si_unit(word: str) -> TypeGuard[SiUnit]:
    """Tell whether a word is the unit that a quantity's name may end in."""
    return word in NOTATIONS


def quantity_of(name: str) -> Quantity:
    """Return the quantity of a name.

    Raises
    ------
    KeyError
        There is none.
    """
    return _BY_NAME[name]


def with_above(steps: Sequence[Step]) -> Iterable[tuple[Step, Step | None]]:
    """Return each step with the one above it, None for the last."""
    return itertools.zip_longest(steps, steps[1:])


def paper_value(step: Step, quantity: Quantity) -> float | None:
    """Return what the paper's method has for a quantity of the survey; None where it has nothing like it."""
    paper = next((each for each in PAPER_QUANTITIES if each.survey == quantity.name), None)
    return None if paper is None else paper.of_paper(step.paper)


def step_value(step: Step, name: str) -> Measured | None:
    """Return a quantity of one step, None where it was not measured or is not usable."""
    return usable(quantity_of(name).of(step))


def is_usable_at(step: Step, name: str) -> bool:
    """Tell whether all that a quantity of a step is made of is a number where it was measured."""
    values = [quantity_of(part).of(step) for part in (name, *quantity_of(name).made_of)]
    return all(value is None or usable(value) is not None for value in values)


def in_report(table: Literal["steps", "evidence"]) -> Iterable[Quantity]:
    """Return the quantities that a table of the report has columns for, from the left."""
    placed = [
        (quantity.place.order, quantity) for quantity in OF_STEP if quantity.place and quantity.place.table == table
    ]
    return (quantity for _, quantity in sorted(placed, key=lambda pair: pair[0]))
