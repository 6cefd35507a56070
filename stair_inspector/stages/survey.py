"""What are the survey's numbers? Rise, going, depth, width and slopes from nosing to nosing, with uncertainties."""

from dataclasses import dataclass, replace

from stair_inspector.model import (
    Chains,
    Examination,
    Flight,
    Horizontal,
    Note,
    Observation,
    PaperValues,
    Patches,
    Step,
    StepShape,
    Up,
)
from stair_inspector.params import DisplayParams, SurveyParams
from stair_inspector.stages.block_layers import tell_layers
from stair_inspector.stages.climbs import flight_after
from stair_inspector.stages.examine import with_questions
from stair_inspector.stages.flight_values import flight_of, kinds_of
from stair_inspector.stages.parts import Common
from stair_inspector.stages.rejects import Forced
from stair_inspector.stages.side_shifts import with_side_shifts
from stair_inspector.stages.step_values import StepMeasurer
from stair_inspector.stages.treads import nearest_rows
from stair_inspector.stages.unobserved import notes_of_unobserved
from stair_inspector.stated_uncertainty import UncertaintyParams


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """All steps and flights; ``steps`` in the order of the flights, ``surfaces`` the patch of each.

    ``observations`` are of the scan as a whole, and first seen on its treads.
    """

    steps: tuple[Step, ...]
    flights: tuple[Flight, ...]
    surfaces: tuple[int, ...]
    notes: tuple[Note, ...]
    observations: tuple[Observation, ...] = ()


def measure_survey(
    horizontal: Horizontal,
    patches: Patches,
    chains: Chains,
    shapes: tuple[tuple[StepShape, ...], ...],
    up: Up,
    forced: Forced,
    params: SurveyParams,
    doubts: UncertaintyParams,
    display: DisplayParams,
    examined: Examination | None = None,
) -> Survey:
    """Measure every step of every flight (DESIGN: nosing to nosing, on three lines, with uncertainties).

    Parameters
    ----------
    horizontal, patches, chains, shapes
        Of one scan; level frame.
    up : Up
        With its uncertainty, if known.
    forced : Forced
        What the user has decided.
    params, doubts, display
        Measuring lines; what the user states about the scan; points kept around each centroid.
    examined : Examination, optional
        The steps of the coordinates and doubled surfaces, which no scatter of points shows; what stations
        looked through, where they are known.

    Returns
    -------
    Survey
        Steps counted from 1 in the order of the flights, positions in local scan axes, without the paper's values.
    """
    sight = None if examined is None or examined.sight is None else examined.sight.in_frame(horizontal.level_from_scan)
    observations: tuple[Observation, ...] = ()
    if examined is not None:
        told = tell_layers(shapes, chains, examined, horizontal.level_from_scan, doubts.registration_m)
        shapes, chains, examined = told.shapes, told.chains, told.examined
        observations = with_questions(told.observations, doubts)
    context = Common.of(up, doubts, horizontal.level_from_scan, examined)
    bases = frozenset(chain.base for chain in chains.chains)
    steps: list[Step] = []
    flights: list[Flight] = []
    notes: list[Note] = list(chains.notes)
    if chains.chains and not (doubts.registration_m or doubts.edge_m or doubts.up_deg):
        message = (
            "u holds what the scan itself shows; what registration, levelling and the rounding of edges add is not "
            "stated: choose the scanner's preset, or set uncertainty.*"
        )
        notes.append(Note("uncertainty_unstated", "survey", message))
    numbers: list[int] = []
    for flight_id, (chain, own_shapes) in enumerate(zip(chains.chains, shapes, strict=True), 1):
        first_id = len(steps) + 1
        after = flight_after(chains, flight_id - 1)
        next_shape = None if after is None else shapes[after][0]
        if sight is not None:
            own_shapes, aside = with_side_shifts(own_shapes, sight, flight_id)
            notes += aside
        measured = StepMeasurer(chain, own_shapes, next_shape, context, params).measure()
        kinds = kinds_of(chain, own_shapes, measured, bases, forced)
        for k, (values, shape, kind) in enumerate(zip(measured, own_shapes, kinds, strict=True)):
            surface = patches.surfaces[shape.surface]
            fit = surface.plane
            numbers.append(shape.surface)
            steps.append(
                replace(
                    values,
                    step_id=first_id + k,
                    plane=fit,
                    nearest_ids=nearest_rows(horizontal, surface.rows, fit.centroid, display.nearest_k),
                    kind=kind,
                    flight=flight_id,
                )
            )
        own_steps = steps[first_id - 1 :]
        flights.append(flight_of(flight_id, chain, own_shapes, own_steps, context))
        if flights[-1].radius_m is not None:
            message = (
                f"flight {flight_id} curves: its goings are measured along the arc through the middles of its nosings, "
                "and on the left and right along arcs about the same centre; a limit that a code puts on a walking "
                "line elsewhere cannot be judged on them"
            )
            notes.append(Note("curved", "survey", message))
        elif flights[-1].shape != "straight":
            message = (
                f"flight {flight_id} winds ({flights[-1].shape}): its steps are measured about their own nosings, in "
                "the middle of what was seen of them; codes measure on a walking line and cannot be judged on it"
            )
            notes.append(Note("winding", "survey", message))
        notes += notes_of_unobserved(chain, own_shapes, own_steps, sight)
    return Survey(tuple(steps), tuple(flights), tuple(numbers), tuple(notes), observations)


def with_paper_values(survey: Survey, patches: Patches, paper: tuple[Step, ...]) -> Survey:
    """Give every step the values that the paper's method has for its height cluster, besides its own.

    Parameters
    ----------
    survey, patches
        Of one scan.
    paper : tuple of Step
        The paper's steps, one for each height cluster above the lowest.
    """
    levels = (patches.surfaces[number].level_id for number in survey.surfaces)
    # To the paper the lowest height cluster is the floor and has no values of a step.
    values = (paper[level - 1].paper if level else PaperValues() for level in levels)
    steps = tuple(replace(step, paper=own) for step, own in zip(survey.steps, values, strict=True))
    return replace(survey, steps=steps)
