"""What is the answer, and is there a staircase at all?"""

import dataclasses
import itertools
import math

from stair_inspector.model import (
    Axes,
    HeightProfile,
    Horizontal,
    Inspection,
    Level,
    Levels,
    Note,
    Scan,
    ScanSummary,
    Step,
    Surfaces,
    Up,
)
from stair_inspector.params import Params
from stair_inspector.stages.paper import measure_h, review_steps

_LOWEST_RISE_M = 0.06
_HIGHEST_RISE_M = 0.35
"""Far outside every code's limits (100 to 241 mm): a bad staircase is what an inspector looks for."""
_MOST_UNEVEN = 1.7
"""Ratio of two rises that follow each other above which they are shelves, not steps."""
_MERGED_M = 0.1
"""A level whose points spread over more than this is several that ran together."""
_SHORTEST_GOING_M = 0.15
_LONGEST_GOING_M = 0.9
"""Distance of two centres: from the narrowest tread to half a tread and half a landing."""
_STEEPEST_TREAD_DEG = 8.0
"""A surface that leans more is a piece of a ramp; treads of a badly levelled scan lean up to 5 degrees."""


def conclude(
    scan: Scan,
    params: Params,
    up: Up,
    axes: Axes | None,
    horizontal: Horizontal,
    levels: Levels,
    profile: HeightProfile,
    surfaces: Surfaces,
    steps: tuple[Step, ...],
    timings_s: dict[str, float],
) -> Inspection:
    """Put the stages' results together with their notes, and say so if they are no staircase.

    With the paper's method every cluster above the lowest stays a step, whatever it is; with the survey's the steps
    of a scan without a staircase are empty and the levels are rejected with the reason.
    """
    planes = surfaces.planes
    heights = horizontal.coordinates_m[2]
    origin_z = float(scan.origin_m @ up.vector)
    found = tuple(
        Level(
            level_id=level_id,
            height_m=float(plane.centroid @ up.vector) + origin_z,
            low_m=float(heights[start]) + origin_z,
            high_m=float(heights[stop - 1]) + origin_z,
            n_points=plane.n_points,
            kind="floor" if level_id == 0 else "tread",
        )
        for level_id, (plane, start, stop) in enumerate(zip(planes, levels.start, levels.stop, strict=True))
    )
    floor_h_m = measure_h(planes[0], planes[1], up) if len(planes) > 1 else None
    notes = [*scan.notes, *up.notes, *(axes.notes if axes is not None else ())]
    reason = why_no_staircase(surfaces, found, up)
    if reason is None or params.method == "paper":
        notes += review_steps(steps)
    if reason is not None:
        notes.append(Note("no_staircase", "verdict", f"no staircase found: {reason}"))
        if params.method != "paper":
            steps = ()
            axes, floor_h_m = None, None
            found = tuple(
                level if level.kind == "floor" else dataclasses.replace(level, kind="rejected", reason=reason)
                for level in found
            )
    return Inspection(
        scan=ScanSummary(
            name=scan.name,
            sha256=scan.sha256,
            n_points=scan.n_points,
            n_used=len(scan.points),
            unit=scan.unit,
            origin_m=(float(scan.origin_m[0]), float(scan.origin_m[1]), float(scan.origin_m[2])),
        ),
        params=params,
        up=up,
        axes=axes,
        levels=found,
        steps=steps,
        floor=planes[0] if planes else None,
        floor_h_m=floor_h_m,
        profile=dataclasses.replace(profile, low_m=profile.low_m + origin_z),
        labels=levels.labels,
        notes=tuple(notes),
        timings_s=timings_s,
    )


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
        if tallest_m > _MERGED_M:
            advice = (
                f"one spans {tallest_m * 1000.0:.0f} mm, so several have run together: lower eps_z or raise m, and "
                "check the up direction"
            )
        return f"{count}, where a staircase has at least a floor and two more; {advice}"
    moves = [above - below for below, above in itertools.pairwise(centroids)]
    rises = [float(move @ up.vector) for move in moves]
    goings = [math.hypot(*(move - rise * up.vector)) for move, rise in zip(moves, rises, strict=True)]
    is_riser = [_LOWEST_RISE_M <= rise <= _HIGHEST_RISE_M for rise in rises]
    is_flat = [
        plane.normal is not None and float(plane.normal @ up.vector) >= math.cos(math.radians(_STEEPEST_TREAD_DEG))
        for plane in surfaces.planes
    ]
    is_step = [
        is_riser[k] and is_flat[k] and is_flat[k + 1] and _SHORTEST_GOING_M <= goings[k] <= _LONGEST_GOING_M
        for k in range(len(moves))
    ]
    # Move 0 is from the floor, so a step-to-step move is any later one.
    for k in range(1, len(moves)):
        if is_step[k] and any(
            is_riser[other] and max(rises[other], rises[k]) <= _MOST_UNEVEN * min(rises[other], rises[k])
            for other in (k - 1, k + 1)
            if other < len(moves)
        ):
            return None
    seen = ", ".join(
        f"{rise * 1000.0:.0f}/{going * 1000.0:.0f}" for rise, going in zip(rises[:8], goings[:8], strict=True)
    )
    more = ", ..." if len(rises) > 8 else ""
    low, high = _LOWEST_RISE_M * 1000.0, _HIGHEST_RISE_M * 1000.0
    return (
        f"{len(centroids)} horizontal levels, but nowhere two similar rises in a row from {low:.0f} to {high:.0f} mm "
        f"between flat surfaces whose centres are a going "
        f"({_SHORTEST_GOING_M * 1000.0:.0f} to {_LONGEST_GOING_M * 1000.0:.0f} mm) apart "
        f"(rise/distance in mm: {seen}{more}); check the up direction, eps_z and m"
    )
