"""Where the camera stands: beside what lies over the scene."""

import numpy as np
import pytest

from stair_inspector.pictures.cameras import FOV_RAD, frame_view
from stair_inspector.viewer.scene.framing import free_part, raised

BOX = np.array([[x, y, z] for x in (-0.6, 0.6) for y in (0.0, 3.0) for z in (0.0, 1.7)])
TOOLBAR_PX, LEGEND_PX, LABEL_PX = 36, 66, 130


def pixels(pose, places, width, height, fov_rad=FOV_RAD):
    """Places in a picture, from its upper left corner: the plain rule of a pinhole camera."""
    away = pose.position - pose.look_at
    away /= np.linalg.norm(away)
    right = np.cross(pose.up, away)
    right /= np.linalg.norm(right)
    offset = places - pose.position
    scale = height / 2.0 / np.tan(fov_rad / 2.0) / -(offset @ away)
    return np.column_stack(
        [width / 2.0 + scale * (offset @ right), height / 2.0 - scale * (offset @ np.cross(away, right))]
    )


@pytest.mark.parametrize(("width", "height"), [(812, 720), (2092, 1440), (420, 900)])
@pytest.mark.parametrize("view", ["Home", "Front", "Side", "Top", "Along"])
@pytest.mark.parametrize("with_labels", [False, True])
def test_what_is_framed_lies_between_the_toolbar_and_the_legend(view, width, height, with_labels):
    free = free_part(width, height, FOV_RAD, with_labels=with_labels)
    pose = frame_view(view, BOX, free.aspect, np.eye(3), free.fov_rad)
    seen = pixels(raised(pose, free.raised * np.tan(FOV_RAD / 2.0)), BOX, width, height)
    aside = LABEL_PX if with_labels and width > 600 else 0
    assert seen[:, 0].min() >= aside
    assert seen[:, 0].max() <= width - aside
    assert seen[:, 1].min() >= TOOLBAR_PX
    assert seen[:, 1].max() <= height - LEGEND_PX


@pytest.mark.parametrize(("width", "height"), [(0, 0), (800, 0), (0, 600)])
def test_a_scene_without_a_size_is_framed_as_a_usual_one(width, height):
    assert free_part(width, height, FOV_RAD) == free_part(1500, 1000, FOV_RAD)


def test_a_very_small_scene_is_used_as_it_is():
    free = free_part(280, 140, FOV_RAD)
    assert (free.aspect, free.fov_rad, free.raised) == (2.0, FOV_RAD, 0.0)
