"""Takes pictures with the inspector's own page: the camera goes where the picture is taken, and afterwards back.

The page sizes points and labels for its own camera and window; a picture from elsewhere would have letters as large as
steps. Never in an asynchronous callback: the page's answer is waited for.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from stair_inspector.errors import ConfigError
from stair_inspector.geometry.arrays import Colors
from stair_inspector.pictures.cameras import Pose
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.scene.framing import page_camera, place_camera
from stair_inspector.viewer.scene.nodes import quaternion

_TIMEOUT_S = 60.0
_FRAMES = 3
_FENCE = "stair_inspector.fence"
"""Nothing is kept under this name: asking for it returns when the page has done what it was told before."""


@contextmanager
def studio(
    desk: Desk, width: int, height: int, timeout_s: float = _TIMEOUT_S
) -> Iterator[Callable[[Pose, float], Colors]]:
    """Lend the page's camera for pictures of a size, and put it back whatever happens.

    Yields
    ------
    callable
        Of a camera and its upright angle of view, radians; returns the pixels (height, width, 4), transparent where
        nothing is. Raises ConfigError where the page does not deliver, as when it is closed or hidden.
    """
    client, stage = desk.client, desk.stage
    before, fov_rad = page_camera(client)
    # A scan that is shown anew takes the old points away.
    with desk.lock:
        # Points are drawn in pixels of the window: in a larger picture gaps would open between them.
        stage.magnify(height / max(client.camera.image_height, 1))

    def render(pose: Pose, fov: float) -> Colors:
        try:
            place_camera(client, pose, fov)
            # Points and labels are sized in the frame after the one in which the camera moves.
            for _ in range(_FRAMES):
                client.local_storage.get_item(_FENCE, timeout=timeout_s)
            pixels = client.get_render(
                height,
                width,
                wxyz=camera_wxyz(pose),
                position=pose.position,
                fov=fov,
                transport_format="png",
                timeout=timeout_s,
            )
        except (TimeoutError, RuntimeError) as error:
            raise ConfigError(
                "screenshot: the page did not deliver the picture; bring it to the front and try again"
            ) from error
        return np.asarray(pixels, dtype=np.uint8)

    try:
        yield render
    finally:
        try:
            with desk.lock:
                stage.magnify(1.0)
        finally:
            place_camera(client, before, fov_rad)


_LEAST_SINE = 1e-9


def camera_wxyz(pose: Pose) -> tuple[float, float, float, float]:
    """Return the orientation of a camera as viser takes it: x to the right in the picture, y down, z into it.

    Raises
    ------
    ConfigError
        The camera looks nowhere, or straight along its upward direction: a page may send any numbers.
    """
    forward = pose.look_at - pose.position
    right = np.cross(forward, pose.up)
    # A comparison with something that is no number is False.
    if not np.linalg.norm(right) > _LEAST_SINE * np.linalg.norm(forward) * np.linalg.norm(pose.up):
        raise ConfigError("picture: the camera looks nowhere, or straight along its own upward direction; turn it")
    forward = forward / np.linalg.norm(forward)
    right /= np.linalg.norm(right)
    return quaternion(np.column_stack([right, np.cross(forward, right), forward]))
