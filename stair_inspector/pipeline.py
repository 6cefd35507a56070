"""The recipe: from a scan and settings to an inspection, and the memo that makes a slider re-run only what it must."""

import time
from collections.abc import Callable
from typing import Any, TypeVar, cast

from stair_inspector.model import Inspection, Scan
from stair_inspector.params import FloorParams, Params
from stair_inspector.stages import levels as find
from stair_inspector.stages import orient, paper, treads
from stair_inspector.stages.flights import find_chains
from stair_inspector.stages.nosings import find_shapes
from stair_inspector.stages.patches import split_levels
from stair_inspector.stages.plumb import refine_up
from stair_inspector.stages.rejects import apply_overrules
from stair_inspector.stages.survey import measure_survey
from stair_inspector.stages.verdict import conclude, conclude_survey

T = TypeVar("T")


class Memo:
    """One slot per stage: a stage whose inputs and settings are those of its last run is not run again.

    Inputs are compared by identity where they hold arrays (which have no ``==``) and by value where they are settings.
    ``heavy`` runs what takes seconds, for example in another process; ``on_stage`` is told each stage's name.
    """

    def __init__(self, heavy: Callable[..., Any] | None = None, on_stage: Callable[[str], None] | None = None) -> None:
        self._slots: dict[str, tuple[tuple[object, ...], Any]] = {}
        self._heavy = heavy
        self._on_stage = on_stage
        self.timings_s: dict[str, float] = {}

    def run(self, stage: str, function: Callable[..., T], *inputs: object, heavy: bool = False) -> T:
        """Return ``function(*inputs)``, from the stage's slot if its inputs have not changed."""
        slot = self._slots.get(stage)
        if slot is not None and slot[0] == inputs:
            return cast(T, slot[1])
        if self._on_stage is not None:
            self._on_stage(stage)
        began = time.perf_counter()
        result = self._heavy(function, *inputs) if heavy and self._heavy is not None else function(*inputs)
        self.timings_s[stage] = self.timings_s.get(stage, 0.0) + time.perf_counter() - began
        self._slots[stage] = (inputs, result)
        return result


def inspect(scan: Scan, params: Params, memo: Memo | None = None) -> Inspection:
    """Measure a staircase.

    Parameters
    ----------
    scan : Scan
        At least 50 distinct points.
    params : Params
        Every setting.
    memo : Memo, optional
        Keeps the stages' results from call to call; the result is the same with and without, but that ``timings_s``
        holds the stages that ran in this call.

    Raises
    ------
    CannotMeasure
        The scan is too small, has no floor, or falls into too many levels.
    ConfigError
        A setting does not fit the scan.
    """
    memo = memo or Memo()
    memo.timings_s = {}
    normals = memo.run("normals", orient.find_normals, scan, params.normals, heavy=True)
    # A given up needs neither floor nor method, so a change of them must not run everything again.
    is_auto = params.up == "auto"
    how = (params.floor, params.method) if is_auto else (FloorParams(), "survey")
    up = memo.run("up", orient.find_up, scan, normals, params.up, *how, heavy=is_auto)
    up = memo.run("plumb", refine_up, scan, normals, up) if is_auto and params.method == "survey" else up
    heights = memo.run("heights", orient.order_by_height, scan, normals, up, params.overrules.region)
    horizontal = memo.run("horizontal", find.select_horizontal, heights, params.horizontal)
    reach = memo.run("reach", find.find_height_reach, horizontal, params.levels.eps_m)
    levels = memo.run("levels", find.find_levels, horizontal, reach, params.levels)
    surfaces = memo.run("surfaces", treads.fit_surfaces, horizontal, levels)
    axes = memo.run("axes", treads.find_axes, horizontal, surfaces, params.axes.rule, params.method)
    steps: tuple[Any, ...] = ()
    if axes is not None:
        extents = memo.run("extents", treads.find_extents, horizontal, levels, axes)
        edges = memo.run("edges", treads.place_edges, extents, params.edges)
        nearest = memo.run("nearest", treads.find_nearest, horizontal, levels, surfaces, params.display)
        steps = memo.run("paper", paper.measure_steps, scan, up, surfaces, axes, edges, nearest)
    profile = memo.run("profile", find.profile_heights, horizontal)
    found = conclude(scan, params, up, axes, horizontal, levels, profile, surfaces, steps, dict(memo.timings_s))
    if params.method == "paper":
        return found
    patches = memo.run("patches", split_levels, horizontal, levels, params.patches, params.levels)
    forced = memo.run("overrules", apply_overrules, scan, horizontal, patches, params.overrules)
    chains = memo.run("flights", find_chains, patches, params.flights, params.patches.min_area_m2, forced)
    shapes = memo.run("nosings", find_shapes, heights, horizontal, patches, chains, params.survey.of_edges)
    how_sure = (params.survey, params.uncertainty, params.display)
    survey = memo.run("survey", measure_survey, horizontal, patches, chains, shapes, steps, up, forced, *how_sure)
    return conclude_survey(found, scan, horizontal, patches, chains, forced, survey, dict(memo.timings_s))
