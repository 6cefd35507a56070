"""The recipe: from a scan and settings to an inspection."""

from dataclasses import replace

from stair_inspector.memo import Memo
from stair_inspector.model import NO_CHAINS, Inspection, Scan, Step
from stair_inspector.params import FloorParams, Params
from stair_inspector.stages import levels as find
from stair_inspector.stages import orient, paper, stations, treads
from stair_inspector.stages.bar_peaks import find_peaks
from stair_inspector.stages.bars import join_bars
from stair_inspector.stages.beyond import note_what_goes_on
from stair_inspector.stages.dither import spread_steps
from stair_inspector.stages.examine import examine, with_questions
from stair_inspector.stages.hopeless import is_too_coarse, with_cause
from stair_inspector.stages.impossible import take_out_impossible
from stair_inspector.stages.nosings import find_shapes
from stair_inspector.stages.patches import split_levels
from stair_inspector.stages.pieces import find_flights
from stair_inspector.stages.plumb import refine_up
from stair_inspector.stages.rejects import apply_overrules
from stair_inspector.stages.retry import say_tried, try_suggested
from stair_inspector.stages.sparse import Fitted, Sparse, find_sparse, follow_spacing
from stair_inspector.stages.survey import measure_survey
from stair_inspector.stages.verdict import conclude, conclude_survey
from stair_inspector.stages.withhold import withhold


@with_cause
def inspect(scan: Scan, params: Params, memo: Memo | None = None) -> Inspection:
    """Measure a staircase.

    Parameters
    ----------
    scan, params
        At least 50 distinct points; every setting.
    memo : Memo, optional
        Keeps the stages' results from call to call. It changes only ``timings_s``: those of the stages that ran.

    Raises
    ------
    CannotMeasure
        The scan is too small, has no floor, or falls into too many levels.
    ConfigError
        A setting does not fit the scan.
    """
    memo = memo or Memo()
    spent = memo.timings_s = {}
    examined = memo.run("examination", examine, scan)
    scan, examined = memo.run("stations", stations.join_stations, scan, examined, params.stations, params.method)
    normals = memo.run_heavy("normals", orient.find_normals, scan, params.normals)
    if params.up == "auto":
        usual, how = params.flights.at_least_usual, params.method
        up = memo.run_heavy("up", orient.find_up, scan, normals, params.up, params.floor, how, usual.max_rise_m)
        up = memo.run("plumb", refine_up, scan, normals, up, usual) if how == "survey" else up
    else:
        # A given up needs neither floor nor method, so a change of them must not run everything again.
        up = memo.run("up", orient.find_up, scan, normals, params.up, FloorParams(), "survey")
    heights = memo.run("heights", orient.order_by_height, scan, normals, up, params.overrules.region)
    spaced = memo.run("sparse", find_sparse, heights) if params.method == "survey" else Sparse(heights, False)
    heights, is_sparse = spaced.heights, spaced.is_sparse
    horizontal = memo.run("horizontal", find.select_horizontal, heights, params.horizontal)
    fitted = Fitted(params.levels, params.patches)
    fitted = memo.run("spacing", follow_spacing, horizontal, fitted.levels, fitted.patches) if is_sparse else fitted
    reach = memo.run("reach", find.find_height_reach, horizontal, params.levels.eps_m)
    levels = memo.run("levels", find.find_levels, horizontal, reach, fitted.levels)
    surfaces = memo.run("surfaces", treads.fit_surfaces, horizontal, levels)
    axes = memo.run("axes", treads.find_axes, horizontal, surfaces, params.axes.rule, params.method)
    steps: tuple[Step, ...] = ()
    if axes is not None:
        extents = memo.run("extents", treads.find_extents, horizontal, levels, axes)
        edges = memo.run("edges", treads.place_edges, extents, params.edges)
        nearest = memo.run("nearest", treads.find_nearest, horizontal, levels, surfaces, params.display)
        steps = memo.run("paper", paper.measure_steps, scan, up, surfaces, axes, edges, nearest)
    profile = memo.run("profile", find.profile_heights, horizontal)
    found = conclude(scan, params, examined, normals, up, axes, horizontal, levels, profile, surfaces, steps, spent)
    if params.method == "paper":
        return found
    found = replace(found, examination=with_questions((*found.examination, *fitted.observations), params.uncertainty))
    spread = memo.run("dither", spread_steps, scan, examined, heights, horizontal, levels)
    heights, horizontal, levels = spread.heights, spread.horizontal, spread.levels
    patches = memo.run("patches", split_levels, horizontal, levels, fitted.patches, fitted.levels)
    peaks, least_m2 = memo.run("peaks", find_peaks, heights, patches.cell_m), params.patches.min_area_m2
    horizontal, patches = memo.run("bars", join_bars, heights, peaks, horizontal, patches, least_m2)
    forced = memo.run("overrules", apply_overrules, scan, horizontal, patches, params.overrules)
    limits, chains, is_hopeless = params.flights, NO_CHAINS, is_too_coarse(found.examination, params.flights)
    if not is_hopeless:
        patches, chains = memo.run("flights", find_flights, heights, horizontal, patches, limits, least_m2, forced)
    lines, u, k, sight = params.survey, params.uncertainty, params.display, examined.sight
    edges_by, stepped, step_m = lines.of_edges, spread.is_stepped, float(examined.steps_m.max()) if is_sparse else None
    shapes = memo.run("nosings", find_shapes, heights, horizontal, patches, chains, edges_by, stepped, step_m, sight)
    survey = memo.run("survey", measure_survey, horizontal, patches, chains, shapes, up, forced, lines, u, k, examined)
    noted = note_what_goes_on(heights, chains, shapes, survey, scan, sight)
    survey = take_out_impossible(noted, limits, shapes, examined)
    concluded = conclude_survey(found, scan, horizontal, patches, chains, forced, survey, spent)
    if not concluded.steps and not is_hopeless:
        tried = memo.run("suggested", try_suggested, heights, is_sparse, params, forced)
        return withhold(say_tried(concluded, tried, spent))
    return withhold(concluded)
