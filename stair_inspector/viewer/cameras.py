"""Where the camera stands for each view.

Coordinates of the view: x to the right of someone who climbs, y along the climb, z up.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stair_inspector.geometry.arrays import Floats

View = Literal["Home", "Front", "Side", "Top"]

VIEWS: tuple[View, ...] = ("Home", "Front", "Side", "Top")
FOV_RAD = math.radians(40.0)

_FROM: dict[View, tuple[float, float, float]] = {
    # From the lower left along the climb, high enough for treads and risers both to show.
    "Home": (-0.62, -1.0, 0.62),
    "Front": (0.0, -1.0, 0.0),
    "Side": (1.0, 0.0, 0.0),
    "Top": (0.0, 0.0, 1.0),
}
_MARGIN = 1.1


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A camera: ``position``, ``look_at`` and ``up`` (3,) each, in the coordinates of the view."""

    position: Floats
    look_at: Floats
    up: Floats


def frame_view(
    view: View, corners: Floats, aspect: float, turn: Floats, fov_rad: float = FOV_RAD, is_from_right: bool = False
) -> Pose:
    """Place a camera so that a box fills the picture.

    Parameters
    ----------
    view : {"Home", "Front", "Side", "Top"}
        Direction of view.
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
    """
    side = np.array([-1.0 if is_from_right else 1.0, 1.0, 1.0])
    backwards = turn @ (side * np.array(_FROM[view]) / np.linalg.norm(_FROM[view]))
    # Seen from above, the climb points up in the picture.
    up = turn @ np.array([0.0, 1.0, 0.0] if view == "Top" else [0.0, 0.0, 1.0])
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
