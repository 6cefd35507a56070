"""Placing the camera on the page: around what lies over the scene.

Coordinates of the view; see :mod:`stair_inspector.pictures.cameras`.
"""

import math
from dataclasses import dataclass

import numpy as np
import viser

from stair_inspector.geometry.arrays import Floats
from stair_inspector.pictures.cameras import Pose

_ABOVE_PX, _BELOW_PX, _ASIDE_PX = 46, 70, 12
"""What the toolbar above and the legend below cover of the scene, pixels."""
_LABEL_PX = 150
"""A dimension's label may run so far to the side of its step."""
_CLOSEST_M = 1.0
_SMALLEST_PX = 300
"""A scene smaller than this is used as it is."""


@dataclass(frozen=True, slots=True)
class FreePart:
    """The free rectangle of a picture: its shape, its upright angle of view, and how far its middle lies higher.

    ``raised`` is in half heights of the picture.
    """

    aspect: float
    fov_rad: float
    raised: float


def free_part(width: int, height: int, fov_rad: float, *, with_labels: bool = False) -> FreePart:
    """Return the part of a picture (pixels) that neither the toolbar nor the legend covers.

    Parameters
    ----------
    width, height : int
        Of the picture; where it has no size, that of a usual one.
    fov_rad : float
        Upright angle of view of the whole picture.
    with_labels : bool
        Leave room at both sides for the labels of a step.
    """
    if width <= 0 or height <= 0:
        width, height = 1500, 1000
    if min(width, height) < _SMALLEST_PX:
        return FreePart(width / height, fov_rad, 0.0)
    aside = _LABEL_PX if with_labels and width > 4 * _LABEL_PX else _ASIDE_PX
    free_height = height - _ABOVE_PX - _BELOW_PX
    angle = 2.0 * math.atan(math.tan(fov_rad / 2.0) * free_height / height)
    return FreePart((width - 2 * aside) / free_height, angle, (_BELOW_PX - _ABOVE_PX) / height)


def raised(pose: Pose, share: float) -> Pose:
    """Return the camera moved so that what it looks at stands higher by a share of the distance to it."""
    away = pose.position - pose.look_at
    distance = float(np.linalg.norm(away))
    right = np.cross(pose.up, away)
    down = np.cross(right, away)
    move = share * distance * down / np.linalg.norm(down)
    return Pose(pose.position + move, pose.look_at + move, pose.up)


def near_pose(pose: Pose, places: Floats, fov_rad: float) -> Pose:
    """Return a camera that looks at places (n, 3) from the side on which it stands now, near enough to see them."""
    middle = places.mean(axis=0)
    away = pose.position - pose.look_at
    reach = max(_CLOSEST_M, 2.5 * float(np.ptp(places, axis=0).max()))
    reach *= np.tan(0.35) / np.tan(fov_rad / 2.0)
    return Pose(middle + reach * away / np.linalg.norm(away), middle, pose.up)


def page_camera(client: viser.ClientHandle) -> tuple[Pose, float]:
    """Return where a page's camera stands now, and its upright angle of view."""
    camera = client.camera
    pose = Pose(np.array(camera.position), np.array(camera.look_at), np.array(camera.up_direction))
    return pose, float(camera.fov)


def place_camera(client: viser.ClientHandle, pose: Pose, fov_rad: float) -> None:
    """Put the page's camera somewhere, all at once."""
    camera = client.camera
    with client.atomic():
        camera.fov = fov_rad
        camera.up_direction = pose.up
        camera.position = pose.position
        # Setting the position drags the point looked at along.
        camera.look_at = pose.look_at
