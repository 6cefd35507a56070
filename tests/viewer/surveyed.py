"""An inspection with every value of the survey, made by hand from a measured one: nothing here is computed."""

import dataclasses
import functools

import numpy as np

from stair_inspector.files.palettes import read_palette
from stair_inspector.model import Flight, Measured, Note, Patch, Scan, Statistics
from stair_inspector.pictures.display import choose_display
from stair_inspector.pipeline import inspect
from tests.synthetic import Stair, exact_params, make_scan, motion

PALETTE = read_palette("page")
STAIR = Stair(noise=0.001, risers=True)
RISE, GOING, WIDTH, DEPTH = 0.17, 0.28, 1.0, 0.3
PARTS = (("noise", 0.0002), ("edge", 0.0003), ("up", 0.0001))
U = 0.0004


def survey(inspection, *, turn=None):
    """The inspection as a survey of the stair frame's exact geometry, one flight whose last step is a landing.

    ``turn`` (3, 3) is that of the stair. Step 3 has no going and a note says why; the last step has neither going nor
    pitch. The floor is patch 0, step k is patch k, and patches 6 and 7 are rejected: of the points of no level, every
    other one each.
    """
    turn = np.eye(3) if turn is None else turn
    n = len(inspection.steps)
    steps = [_step(step, turn, n) for step in inspection.steps]
    patch_ids = np.where(inspection.labels >= 0, inspection.labels, -1).astype(np.int64)
    loose = np.nonzero(inspection.labels < 0)[0]
    patch_ids[loose[::2]], patch_ids[loose[1::2]] = n + 1, n + 2
    patches = [Patch(0, 0, 0.0, 0.8, inspection.floor, "floor")]
    patches += [Patch(k, k, k * RISE, 0.28, steps[k - 1].plane, steps[k - 1].kind, k) for k in range(1, n + 1)]
    plane = steps[1].plane
    patches.append(Patch(n + 1, 2, 0.341, 0.12, plane, "rejected", reason="no step leads to it"))
    lower = dataclasses.replace(plane, centroid=plane.centroid - np.array([0.0, 0.0, 0.1]))
    patches.append(Patch(n + 2, 2, 0.24, 0.45, lower, "rejected", reason="a table <b>in the way</b>"))
    flight = Flight(
        flight_id=1,
        step_ids=tuple(range(1, n + 1)),
        n_risers=n,
        shape="straight",
        climb=turn @ np.array([1.0, 0.0, 0.0]),
        pitch_deg=Measured(31.2, 0.3),
        width_m=Measured(1.0, 0.001),
        rise=Statistics(n, 0.17, 0.168, 0.1712, 0.0032, 0.0031, (4, 5)),
        going=Statistics(n - 2, 0.28, 0.2795, 0.281, 0.0015, 0.0012, (1, 2)),
    )
    return dataclasses.replace(
        inspection,
        steps=tuple(steps),
        flights=(flight,),
        patches=tuple(patches),
        patch_ids=patch_ids,
        notes=(Note("going_hidden", "survey", "the nosing of step 4 is hidden", 3), Note("seen", "survey", "all seen")),
    )


def surveyed(turn=None):
    """The scan of the stair, perhaps turned, its survey and what of it is drawn; each is made once."""
    return _surveyed(None if turn is None else tuple(map(tuple, np.asarray(turn).tolist())))


@functools.cache
def _surveyed(rows):
    turn = None if rows is None else np.array(rows)
    stair = STAIR if turn is None else dataclasses.replace(STAIR, motion=motion(turn))
    points, normals = stair.sample()
    scan = make_scan(points, normals, origin_m=(100.0, 200.0, 300.0))
    paper = inspect(scan, exact_params(up=stair.up, method="paper"))
    inspection = dataclasses.replace(paper, params=exact_params(up=stair.up))
    return scan, survey(inspection, turn=turn), choose_display(scan)


def bumped(turn, height_m=0.01):
    """The stair with a bump on the front left quarter of step 2; its planes stay those of the even step."""
    scan, inspection, display = surveyed(turn)
    own = scan.points @ turn
    is_bump = (inspection.labels == 2) & (own[:, 0] < GOING * 1.5) & (own[:, 1] > WIDTH / 2.0)
    points = scan.points + np.where(is_bump[:, None], height_m * turn[:, 2], 0.0)
    bumpy = Scan(points, scan.origin_m, scan.name, scan.sha256, "m", scan.n_points)
    return bumpy, inspection, display


def _step(step, turn, n):
    k = step.step_id
    is_last = k == n

    def at(x, y):
        return turn @ np.array([x, y, k * RISE])

    front = (k - 1) * GOING
    has_going = not is_last and k != 3
    return dataclasses.replace(
        step,
        kind="landing" if is_last else "tread",
        flight=1,
        rise_m=Measured(RISE + 0.0001 * k, U, PARTS),
        going_m=Measured(GOING, U, PARTS) if has_going else None,
        tread_depth_m=Measured(DEPTH, 0.0123, PARTS),
        width_m=Measured(WIDTH, 0.00004),
        nosing_overhang_m=Measured(DEPTH - GOING, U, PARTS),
        pitch_deg=None if is_last else Measured(31.26, 0.12, (("noise", 0.1), ("up", 0.06))),
        fall_deg=Measured(0.0, 0.05),
        cross_fall_deg=Measured(-0.25, 0.05),
        coverage=0.87,
        rise_lcr_m=(RISE - 0.001, RISE, RISE + 0.001),
        going_lcr_m=(GOING, GOING, None) if has_going else None,
        nosing=np.array([at(front, WIDTH), at(front, 0.0)]),
        line_points=np.array([at(front, share * WIDTH) for share in (0.85, 0.5, 0.15)]),
        climb=turn @ np.array([1.0, 0.0, 0.0]),
    )
