"""What is the answer, and is there a staircase at all?"""

import dataclasses
import itertools
import math
from typing import Literal

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, freeze
from stair_inspector.model import (
    NON_STAIR_LABEL,
    Axes,
    Chains,
    Examination,
    HeightProfile,
    Horizontal,
    Inspection,
    Level,
    Levels,
    Normals,
    Note,
    Patch,
    Patches,
    Scan,
    ScanSummary,
    Step,
    Surfaces,
    Up,
)
from stair_inspector.params import Params
from stair_inspector.stages.causes import MERGED_M, why_no_flight
from stair_inspector.stages.impossible import take_out_cut
from stair_inspector.stages.paper import measure_h, review_steps
from stair_inspector.stages.rejects import Forced, explain_rejects
from stair_inspector.stages.survey import Survey, with_paper_values
from stair_inspector.stages.units import ask_unit

Kind = Literal["floor", "tread", "landing", "rejected"]
_TELLING: tuple[Kind, ...] = ("tread", "landing", "floor")
_FEWEST_TREADS = 3


def conclude(
    scan: Scan,
    params: Params,
    examined: Examination,
    normals: Normals,
    up: Up,
    axes: Axes | None,
    horizontal: Horizontal,
    levels: Levels,
    profile: HeightProfile,
    surfaces: Surfaces,
    steps: tuple[Step, ...],
    timings_s: dict[str, float],
) -> Inspection:
    """Put the paper's stages together with their notes, and say so if they are no staircase.

    Every cluster above the lowest stays a step, whatever it is.
    """
    planes = surfaces.planes
    found = _levels_of(scan, up, horizontal, levels, surfaces)
    notes = [*scan.notes, *normals.notes, *up.notes, *(axes.notes if axes is not None else ()), *review_steps(steps)]
    reason = why_no_staircase(surfaces, found, up)
    if reason is not None:
        notes.append(Note("no_staircase", "verdict", f"no staircase found: {reason}"))
    return Inspection(
        scan=_summary_of(scan),
        params=params,
        up=up,
        axes=axes,
        levels=found,
        steps=steps,
        floor=planes[0] if planes else None,
        floor_h_m=measure_h(planes[0], planes[1], up) if len(planes) > 1 else None,
        profile=dataclasses.replace(profile, low_m=profile.low_m + float(scan.origin_m @ up.vector)),
        labels=levels.labels,
        notes=tuple(notes),
        # The memo goes on counting in its own.
        timings_s=dict(timings_s),
        examination=(*examined.observations, *up.observations),
        paper_corners=tuple(step.corners for step in steps),
        moved=examined.moved,
        normals_by=normals.by,
    )


def conclude_survey(
    paper: Inspection,
    scan: Scan,
    horizontal: Horizontal,
    patches: Patches,
    chains: Chains,
    forced: Forced,
    survey: Survey,
    timings_s: dict[str, float],
) -> Inspection:
    """Put the survey in the place of the paper's steps: what every surface and height cluster is, or why it is none.

    Parameters
    ----------
    paper : Inspection
        As :func:`conclude` gives it.
    scan, horizontal, patches, chains, forced, survey
        Of the same scan.
    timings_s : dict
        Of the stages that ran, the survey's included.

    Returns
    -------
    Inspection
        Without steps, and with the reason in a note, where there is no staircase.
    """
    survey = with_paper_values(survey, patches, paper.steps)
    survey = take_out_cut(survey, scan, horizontal, patches, paper.params.overrules.region)
    named = _name_patches(paper, scan, patches, chains, forced, survey)
    patch_of_row = np.full(len(horizontal.point_ids), -1, dtype=np.int64)
    # One label more, at the end, for the points of no patch: the patch -1.
    label_of = np.full(len(named) + 1, NON_STAIR_LABEL, dtype=np.int16)
    for patch, surface in zip(named, patches.surfaces, strict=True):
        patch_of_row[surface.rows] = patch.patch_id
        if patch.kind != "rejected":
            label_of[patch.patch_id] = patch.step_id or 0
    patch_ids = np.full(horizontal.n_scan, -1, dtype=np.int64)
    patch_ids[horizontal.point_ids] = patch_of_row
    labels = label_of[patch_ids]
    notes = [*scan.notes, *(note for note in paper.notes if note.stage == "normals"), *paper.up.notes]
    if survey.steps:
        notes += [
            *(paper.axes.notes if paper.axes is not None else ()),
            *survey.notes,
            *_disagreement(survey, paper.up),
        ]
    else:
        reason = why_no_flight(scan, paper, horizontal, patches, chains, forced)
        notes.append(Note("no_staircase", "verdict", f"no staircase found: {reason}"))
    lowest = min((patch for patch in named if patch.kind == "floor"), key=lambda patch: patch.height_m, default=None)
    return dataclasses.replace(
        paper,
        axes=paper.axes if survey.steps else None,
        levels=_named_levels(paper.levels, named),
        steps=survey.steps,
        floor=None if lowest is None else lowest.plane,
        floor_h_m=paper.floor_h_m if survey.steps else None,
        labels=freeze(labels),
        notes=(*notes, *_unmet_overrules(named, forced)),
        # The memo goes on counting in its own.
        timings_s=dict(timings_s),
        flights=survey.flights,
        patches=named,
        patch_ids=freeze(patch_ids),
        examination=(*paper.examination, *survey.observations, *ask_unit(scan, survey.steps)),
    )


def _name_patches(
    paper: Inspection, scan: Scan, patches: Patches, chains: Chains, forced: Forced, survey: Survey
) -> tuple[Patch, ...]:
    """Return every surface with what it was taken for, or why it is no part of a staircase."""
    origin_z = float(scan.origin_m @ paper.up.vector)
    step_of = dict(zip(survey.surfaces, survey.steps, strict=True))
    # A piece of a tread belongs to that tread's step.
    step_of |= {
        number: step_of[surface.part_of]
        for number, surface in enumerate(patches.surfaces)
        if surface.part_of in step_of
    }
    bases = frozenset(chain.base for chain in chains.chains if chain.base is not None)
    floors = bases - step_of.keys() if survey.steps else _lowest_surface(patches, forced)
    floors |= {number for number, surface in enumerate(patches.surfaces) if surface.part_of in floors}
    taken = floors | step_of.keys()
    wanted = paper.params
    reasons = explain_rejects(patches, chains, forced, taken, wanted.patches.min_area_m2, wanted.flights)
    return tuple(
        Patch(
            patch_id=number,
            level_id=surface.level_id,
            height_m=surface.height_m + origin_z,
            area_m2=surface.area_m2,
            plane=surface.plane,
            kind="floor" if number in floors else step_of[number].kind if number in step_of else "rejected",
            step_id=step_of[number].step_id if number in step_of else None,
            reason=reasons.get(number),
        )
        for number, surface in enumerate(patches.surfaces)
    )


def _unmet_overrules(named: tuple[Patch, ...], forced: Forced) -> list[Note]:
    """Note every decision of the inspector that could not be followed."""
    notes = []
    for number, decided in sorted(forced.kinds.items()):
        is_now = named[number].kind
        if is_now != decided:
            message = f"patch {number} was to be a {decided} and is {is_now}: no flight reaches it, or one begins at it"
            notes.append(Note("overrule_unmet", "verdict", message))
    return notes


def _lowest_surface(patches: Patches, forced: Forced) -> frozenset[int]:
    """Return the largest surface of the lowest height cluster, which is the floor where there is no staircase."""
    unwanted = forced.those("rejected")
    own = [k for k, surface in enumerate(patches.surfaces) if surface.level_id == 0 and k not in unwanted]
    return frozenset(sorted(own, key=lambda number: -patches.surfaces[number].area_m2)[:1])


def _summary_of(scan: Scan) -> ScanSummary:
    return ScanSummary(
        name=scan.name,
        sha256=scan.sha256,
        n_points=scan.n_points,
        n_used=len(scan.points),
        unit=scan.unit,
        origin_m=(float(scan.origin_m[0]), float(scan.origin_m[1]), float(scan.origin_m[2])),
    )


def _levels_of(scan: Scan, up: Up, horizontal: Horizontal, levels: Levels, surfaces: Surfaces) -> tuple[Level, ...]:
    """Return the height clusters as the paper takes them: the lowest is the floor, the others are steps."""
    heights = horizontal.coordinates_m[2]
    origin_z = float(scan.origin_m @ up.vector)
    return tuple(
        Level(
            level_id=level_id,
            height_m=float(plane.centroid @ up.vector) + origin_z,
            low_m=float(heights[start]) + origin_z,
            high_m=float(heights[stop - 1]) + origin_z,
            n_points=plane.n_points,
            kind="floor" if level_id == 0 else "tread",
        )
        for level_id, (plane, start, stop) in enumerate(zip(surfaces.planes, levels.start, levels.stop, strict=True))
    )


def _named_levels(levels: tuple[Level, ...], patches: tuple[Patch, ...]) -> tuple[Level, ...]:
    """Return the height clusters with the kind of their most telling patch: a tread before a landing before a floor."""
    named = []
    for level in levels:
        own = [patch for patch in patches if patch.level_id == level.level_id]
        kinds = {patch.kind for patch in own}
        kind: Kind = next((kind for kind in _TELLING if kind in kinds), "rejected")
        reason = None
        if kind == "rejected":
            largest = max(own, key=lambda patch: patch.area_m2, default=None)
            reason = "its points are scattered and form no surface" if largest is None else largest.reason
        named.append(dataclasses.replace(level, kind=kind, reason=reason))
    return tuple(named)


def _disagreement(survey: Survey, up: Up) -> list[Note]:
    """Note where the treads on the whole are not square to up: either all fall the same way, or up is wrong."""
    normals = [step.plane.normal for step in survey.steps if step.plane.normal is not None and step.kind == "tread"]
    if len(normals) < _FEWEST_TREADS:
        return []
    middle = np.median(normals, axis=0)
    middle /= np.linalg.norm(middle)
    scatter_deg = float(np.median([_angle_deg(normal, middle) for normal in normals]))
    lean_deg = _angle_deg(middle, up.vector)
    if lean_deg <= max(priors.UNLEVEL_DEG, 3.0 * scatter_deg / math.sqrt(len(normals)), up.u_deg or 0.0):
        return []
    message = (
        f"the treads on the whole lean by {lean_deg:.2f}° from the horizontal of the up direction ({up.source}): "
        "either they are built so, or up is wrong by that much, which would move each rise by "
        f"{1000.0 * priors.USUAL_GOING_M * math.tan(math.radians(lean_deg)):.0f} mm"
    )
    return [Note("treads_lean", "verdict", message)]


def _angle_deg(a: Floats, b: Floats) -> float:
    return math.degrees(math.acos(min(1.0, abs(float(a @ b)))))


def why_no_staircase(surfaces: Surfaces, levels: tuple[Level, ...], up: Up) -> str | None:
    """Return why these levels cannot be a staircase, or None.

    Somewhere two risers must follow each other, of which one joins two steps whose centres are a going apart; the
    floor's centre may lie anywhere. Deliberately lenient: the paper's clusters may mix a tread with a table of the
    same height, which spoils some centres. A ramp cut into height bands fails, because its bands lean.
    """
    centroids = [plane.centroid for plane in surfaces.planes]
    if len(centroids) < 3:
        count = f"{len(centroids)} horizontal level{'' if len(centroids) == 1 else 's'}"
        advice = "check the up direction, then try a larger theta_th or a smaller m"
        tallest_m = max((level.high_m - level.low_m for level in levels), default=0.0)
        if tallest_m > MERGED_M:
            advice = (
                f"one spans {tallest_m * 1000.0:.0f} mm, so several have run together: lower eps_z or raise m, and "
                "check the up direction"
            )
        return f"{count}, where a staircase has at least a floor and two more; {advice}"
    moves = [above - below for below, above in itertools.pairwise(centroids)]
    rises = [float(move @ up.vector) for move in moves]
    goings = [math.hypot(*(move - rise * up.vector)) for move, rise in zip(moves, rises, strict=True)]
    is_riser = [priors.PAPER_RISE_M[0] <= rise <= priors.PAPER_RISE_M[1] for rise in rises]
    is_flat = [
        plane.normal is not None
        and float(plane.normal @ up.vector) >= math.cos(math.radians(priors.PAPER_STEEPEST_TREAD_DEG))
        for plane in surfaces.planes
    ]
    is_step = [
        is_riser[k]
        and is_flat[k]
        and is_flat[k + 1]
        and priors.PAPER_CENTRES_M[0] <= goings[k] <= priors.PAPER_CENTRES_M[1]
        for k in range(len(moves))
    ]
    # Move 0 is from the floor, so a step-to-step move is any later one.
    for k in range(1, len(moves)):
        if is_step[k] and any(
            is_riser[other] and max(rises[other], rises[k]) <= priors.PAPER_MOST_UNEVEN * min(rises[other], rises[k])
            for other in (k - 1, k + 1)
            if other < len(moves)
        ):
            return None
    seen = ", ".join(
        f"{rise * 1000.0:.0f}/{going * 1000.0:.0f}" for rise, going in zip(rises[:8], goings[:8], strict=True)
    )
    more = ", ..." if len(rises) > 8 else ""
    low, high = (1000.0 * rise for rise in priors.PAPER_RISE_M)
    near, far = (1000.0 * apart for apart in priors.PAPER_CENTRES_M)
    return (
        f"{len(centroids)} horizontal levels, but nowhere two similar rises in a row from {low:.0f} to {high:.0f} mm "
        f"between flat surfaces whose centres are a going "
        f"({near:.0f} to {far:.0f} mm) apart "
        f"(rise/distance in mm: {seen}{more}); check the up direction, eps_z and m"
    )
