"""What is asked about up, where the stair and what is around it leave two answers?"""

import math

import numpy as np

from stair_inspector import priors
from stair_inspector.geometry.arrays import Floats, project
from stair_inspector.geometry.plan import cell_keys
from stair_inspector.model import Observation
from stair_inspector.overrules import NAMED_UP
from stair_inspector.stages.camera_frames import looks_down_deg, view_of
from stair_inspector.stages.readings import PLAN_CELL_M, SURE, Reading
from stair_inspector.stages.thinned import Thinned

_LOOKS_STEEPLY_DEG = 55.0
_NAME_DEG = 2.0
BESIDE_LEVEL_M = 0.05
_NEARLY_ALL, _SEEN_THROUGH = 0.9, 0.25


def question_of(readings: list[Reading]) -> Observation | None:
    """Return the question which way is up, where two readings fit about equally well."""
    if len(readings) < 2 or readings[0].weight - readings[1].weight >= SURE:
        return None
    first, second = readings[:2]
    texts = [
        f"up along {name_of(each.up)}, rise {1000.0 * each.lattice.rise_m:.0f} mm and going "
        f"{1000.0 * each.lattice.going_m:.0f} mm"
        for each in (first, second)
    ]
    return Observation(
        "up_unsure",
        "question",
        f"the stair can be read in two ways: {texts[0]}; or {texts[1]}",
        cure=f"--up={name_of(first.up)} or --up={name_of(second.up)}",
    )


def question_of_camera(points: Floats, up: Floats) -> Observation | None:
    """Return the question which way is up, where a camera's view shows no rhythm and would look straight down or up.

    Parameters
    ----------
    points : (n, 3)
        Taken from the origin.
    up : (3,)
        What would be taken.
    """
    if looks_down_deg(points, up) <= _LOOKS_STEEPLY_DEG:
        return None
    # A camera that is held upright has its frame's vertical square to where it looks.
    across = "xyz"[int(np.argmin(np.maximum(np.abs(view_of(points)), np.abs(up))))]
    return Observation(
        "up_unsure",
        "question",
        f"a camera took this scan, and with up along {name_of(up)} it would have looked straight up or down; treads "
        "and risers may have changed places",
        cure=f"--up={across} or --up=-{across} or --up={name_of(up)}",
    )


def question_of_side(scan: Thinned, up: Floats, height_m: float) -> Observation | None:
    """Return the question which side is up, where all lies below the largest level surface, as floors lie upside down.

    Parameters
    ----------
    scan : Thinned
        In which treads follow each other and no riser shows, as with open risers.
    up : (3,)
        What would be taken.
    height_m : float
        Where that surface is along it.
    """
    heights = project(scan.points.T, up) - height_m
    is_level = scan.face(up)
    n_below, n_above = (int(np.count_nonzero(way * heights > BESIDE_LEVEL_M)) for way in (-1.0, 1.0))
    if n_below < _NEARLY_ALL * (n_below + n_above):
        return None
    # A ceiling or a landing leaves headroom over treads; a floor is seen through them.
    is_at = is_level & (np.abs(heights) <= BESIDE_LEVEL_M)
    is_next = is_level & (heights < -BESIDE_LEVEL_M) & (heights >= -priors.HEADROOM_M / 2.0)
    side = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    cells = cell_keys((scan.points @ np.stack([side, np.cross(up, side)]).T).T, PLAN_CELL_M)
    if not is_next.any() or float(np.isin(cells[is_next], cells[is_at]).mean()) < _SEEN_THROUGH:
        return None
    names = name_of(up), name_of(-up)
    return Observation(
        "up_unsure",
        "question",
        f"no risers tell which side of the treads is up: with up along {names[0]} nearly everything lies below the "
        f"largest level surface; along {names[1]} it is the floor",
        cure=f"--up={names[1]} or --up={names[0]}",
    )


def name_of(up: Floats) -> str:
    """Return a direction as ``--up`` takes it: the name of an axis, or three numbers."""
    for name, axis in NAMED_UP.items():
        if float(np.dot(axis, up)) >= math.cos(math.radians(_NAME_DEG)):
            return name
    return ",".join(f"{component + 0.0:.3f}" for component in np.round(up, 3))
