"""What viser takes from the nodes of a scene: quaternions, and the light of lines."""

import numpy as np

from stair_inspector.viewer.scene.nodes import _linear, quaternion
from tests.synthetic import rotation
from tests.viewer.surveyed import PALETTE


def test_the_quaternion_is_that_of_the_rotation():
    turn = rotation("x", 20.0) @ rotation("z", 50.0)
    w, x, y, z = quaternion(turn)
    point = np.array([1.0, 2.0, 3.0])
    axis = np.array([x, y, z])
    spun = point + 2.0 * np.cross(axis, np.cross(axis, point) + w * point)
    np.testing.assert_allclose(spun, turn @ point, atol=1e-12)


def test_the_browser_turns_the_light_of_a_line_back_into_its_colour():
    colors = np.array([PALETTE.front_edge, PALETTE.side_edge, (0, 128, 255)], dtype=np.uint8)
    light = _linear(colors) / 255.0
    shown = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    # Half a step of the light is up to three of the colour in this range.
    np.testing.assert_allclose(255.0 * shown, colors, atol=3.0)
