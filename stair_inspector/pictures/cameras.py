"""Where the camera stands for each view.

Coordinates of the view: x to the right of someone who climbs, y along the climb, z up.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.files.projects import SavedView
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Step

View = Literal["Home", "Front", "Side", "Top", "Along"]

VIEWS: tuple[View, ...] = ("Home", "Front", "Side", "Top", "Along")
FOV_RAD = math.radians(40.0)
ORTHO_FOV_RAD = math.radians(5.0)
"""So narrow that lines that run away from the eye look parallel; viser has no orthographic camera."""
USUAL_PITCH_DEG = 32.0

_FROM: dict[View, tuple[float, float, float]] = {
    # From the lower left along the climb, high enough for treads and risers both to show.
    "Home": (-0.62, -1.0, 0.62),
    "Front": (0.0, -1.0, 0.0),
    "Side": (1.0, 0.0, 0.0),
    "Top": (0.0, 0.0, 1.0),
}
_MARGIN = 1.1
_NEAREST_M = 0.01
_NEAR_SHARE = 0.02
"""The near plane's share of the distance: far enough for an exact depth, near enough to look closely from here."""
_BELOW_STEP_M, _ABOVE_STEP_M = 0.2, 0.1
_STEEPER_DEG = 14.0


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A camera: ``position``, ``look_at`` and ``up`` (3,) each, in the coordinates of the view."""

    position: Floats
    look_at: Floats
    up: Floats


def frame_view(
    view: View,
    corners: Floats,
    aspect: float,
    turn: Floats,
    fov_rad: float = FOV_RAD,
    is_from_right: bool = False,
    pitch_deg: float = USUAL_PITCH_DEG,
) -> Pose:
    """Place a camera so that a box fills the picture.

    Parameters
    ----------
    view : {"Home", "Front", "Side", "Top", "Along"}
        Direction of view. "Along" looks from the head of the stair down its flight, a little more steeply than its
        pitch, so that every nosing shows, close to the next.
    corners : (n, 3)
        Points that must be visible, metres.
    aspect : float
        Width over height of the picture.
    turn : (3, 3)
        Rotation from the staircase's own right, climb and up to the coordinates of ``corners``.
    fov_rad : float
        Vertical field of view.
    is_from_right : bool
        Whether to stand on the other side of the stair, where a wall on its left would be in the way.
    pitch_deg : float
        Pitch of the stair, for the view along it.
    """
    pitch = math.radians(min(max(pitch_deg, 0.0) + _STEEPER_DEG, 85.0))
    towards = (0.0, math.cos(pitch), math.sin(pitch)) if view == "Along" else _FROM[view]
    side = np.array([-1.0 if is_from_right else 1.0, 1.0, 1.0])
    backwards = turn @ (side * np.array(towards) / np.linalg.norm(towards))
    # Seen from above, the climb points up in the picture.
    up = turn @ np.array([0.0, 1.0, 0.0] if view == "Top" else [0.0, 0.0, 1.0])
    return frame_from(backwards, up, corners, aspect, fov_rad)


def frame_from(backwards: Floats, up: Floats, corners: Floats, aspect: float, fov_rad: float = FOV_RAD) -> Pose:
    """Place a camera in a direction so that a box fills the picture; a section is seen so from its ``facing`` side.

    Parameters
    ----------
    backwards, up : (3,)
        Unit vectors from the box towards the camera, and upwards in the picture; not parallel.
    corners, aspect, fov_rad
        As for :func:`frame_view`.
    """
    right = np.cross(up, backwards)
    right /= np.linalg.norm(right)
    image_up = np.cross(backwards, right)
    target = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
    offset = corners - target
    tan_v = math.tan(fov_rad / 2.0)
    tan_h = tan_v * max(aspect, 0.1)
    needed = np.maximum(np.abs(offset @ right) / tan_h, np.abs(offset @ image_up) / tan_v) + offset @ backwards
    distance = max(float(needed.max()) * _MARGIN, 0.1)
    return Pose(target + distance * backwards, target, up)


def with_fov(pose: Pose, from_rad: float, to_rad: float) -> Pose:
    """Return the camera moved so that, with another angle of view, the point looked at keeps its size."""
    factor = math.tan(from_rad / 2.0) / math.tan(to_rad / 2.0)
    return Pose(pose.look_at + factor * (pose.position - pose.look_at), pose.look_at, pose.up)


def clip_range(pose: Pose, corners: Floats) -> tuple[float, float]:
    """Return the distances of the near and far planes, metres: the corners (n, 3) lie between with room to spare."""
    distance = float(np.linalg.norm(pose.position - pose.look_at))
    farthest = float(np.linalg.norm(corners - pose.position, axis=1).max(initial=distance))
    return max(_NEAREST_M, _NEAR_SHARE * distance), 20.0 * max(farthest, 1.0)


def step_frame(step: Step, up: Floats, climb: Floats, rotation: Floats) -> tuple[Floats, Floats]:
    """Return what :func:`frame_view` needs to look at one step: the corners (8, 3) of a box around it, and its turn.

    Parameters
    ----------
    step : Step
        With its riser and a little of what lies on it, it fills the picture.
    up : (3,)
        Upwards, local.
    climb : (3,)
        Direction of the stair, local, for a step that has none of its own.
    rotation : (3, 3)
        From local to the view, ``Stage.rotation``.
    """
    own = step.climb if step.climb is not None else climb
    below = step.rise_m.value if step.rise_m is not None else _BELOW_STEP_M
    corners = np.vstack([step.corners - below * up, step.corners + _ABOVE_STEP_M * up])
    axes = np.column_stack([np.cross(own, up), own, up])
    return corners @ rotation.T, rotation @ axes


def to_saved(name: str, pose: Pose, fov_rad: float, rotation: Floats, origin_m: Floats) -> SavedView:
    """Return a camera of the view as it is kept in a project: metres and directions of the scan's own frame.

    Raises
    ------
    ConfigError
        The name is none, or the camera is at the very point it looks at.
    """
    position, look_at = (place @ rotation + origin_m for place in (pose.position, pose.look_at))
    x, y, z = (_triple(values) for values in (position, look_at, pose.up @ rotation))
    return SavedView(name, x, y, z, math.degrees(fov_rad))


def from_saved(view: SavedView, rotation: Floats, origin_m: Floats) -> tuple[Pose, float]:
    """Return the camera of a saved view, in the coordinates of the view, and its upright angle of view in radians."""
    position, look_at = (rotation @ (np.array(place) - origin_m) for place in (view.position_m, view.look_at_m))
    up = rotation @ np.array(view.up)
    return Pose(position, look_at, up / np.linalg.norm(up)), math.radians(view.fov_deg)


def _triple(values: Floats) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return (x, y, z)
