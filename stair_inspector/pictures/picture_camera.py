"""The camera of a rendered view: where it stands, what it frames, and where points lie in its picture."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection
from stair_inspector.pictures.cameras import FOV_RAD, ORTHO_FOV_RAD, Pose, View, frame_view
from stair_inspector.pictures.display import Display
from stair_inspector.pictures.picture import check_size, scale_of
from stair_inspector.pictures.segmentation import extent_of, is_left_hidden

_AROUND_M = 0.45
"""How much of the stair's surroundings is framed, to every side."""
_LOWEST_ASPECT, _HIGHEST_ASPECT = 0.8, 3.2


@dataclass(frozen=True, slots=True, eq=False)
class PictureCamera:
    """A camera whose picture has whole pixels; ``is_parallel`` for a view without perspective, true to scale.

    Without ``has_edges`` the treads are seen end on, and lines would hide them.
    """

    pose: Pose
    width: int
    height: int
    pixels_per_m: float
    is_parallel: bool
    has_edges: bool = True

    def look(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return where points (n, 3) of the view lie: pixels (n, 2), depths (n,) and pixels per metre (n,)."""
        backwards = self.pose.position - self.pose.look_at
        distance = float(np.linalg.norm(backwards))
        backwards = backwards / distance
        right = np.cross(self.pose.up, backwards)
        right /= np.linalg.norm(right)
        above = np.cross(backwards, right)
        offset = points - self.pose.look_at
        depth = distance - offset @ backwards
        # What lies behind the eye has no place in the picture.
        scale = np.full(len(points), self.pixels_per_m)
        if not self.is_parallel:
            ahead = np.where(depth > 1e-3, depth, np.nan)
            scale = self.pixels_per_m * distance / ahead
        x = self.width / 2.0 + (offset @ right) * scale
        y = self.height / 2.0 - (offset @ above) * scale
        return np.column_stack([x, y]), np.where(np.isfinite(scale), depth, np.nan), scale


def camera_of(
    inspection: Inspection, display: Display, view: View, turn: Floats, size_px: tuple[int, int | None]
) -> PictureCamera:
    """Return the camera of a view, in a picture of that width and height, or as tall as what is seen."""
    corners = _framed(inspection, display, turn)
    is_parallel = view != "Home"
    fov_rad = ORTHO_FOV_RAD if is_parallel else FOV_RAD
    pitches = [flight.pitch_deg.value for flight in inspection.flights if flight.pitch_deg is not None]

    def pose_for(aspect: float) -> Pose:
        hidden = view == "Home" and is_left_hidden(inspection, display)
        pitch_deg = pitches[0] if pitches else 0.0
        return frame_view(view, corners, aspect, np.eye(3), fov_rad, is_from_right=hidden, pitch_deg=pitch_deg)

    width, height = size_px
    if height is None:
        # As tall as what is seen: no paper is wasted.
        trial = PictureCamera(pose_for(1.0), 1000, 1000, _pixels_per_m(pose_for(1.0), fov_rad, 1000), is_parallel)
        seen = np.ptp(trial.look(corners)[0], axis=0)
        aspect = float(np.clip(seen[0] / max(seen[1], 1e-9), _LOWEST_ASPECT, _HIGHEST_ASPECT))
        height = round(width / aspect)
    width, height = check_size(width, height)
    pose = pose_for(width / height)
    return PictureCamera(pose, width, height, _pixels_per_m(pose, fov_rad, height), is_parallel, view != "Side")


def _pixels_per_m(pose: Pose, fov_rad: float, height: int) -> float:
    return scale_of(pose, fov_rad, height, "mm").pixels_per_m


def _framed(inspection: Inspection, display: Display, turn: Floats) -> Floats:
    """Return the corners (8, 3) of the box that must be seen: the stair and a little around it, or all of the scan."""
    whole = extent_of(display.points @ turn.T)
    if not inspection.steps:
        return whole
    stair = np.concatenate([step.corners for step in inspection.steps]) @ turn.T
    low = np.maximum(stair.min(axis=0) - _AROUND_M, whole.min(axis=0))
    high = np.minimum(stair.max(axis=0) + _AROUND_M, whole.max(axis=0))
    # A scan that ends at the stair does not cut it.
    low, high = np.minimum(low, stair.min(axis=0)), np.maximum(high, stair.max(axis=0))
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
