"""Libraries that tests compare with, and that a system may lack."""

import pytest

from stair_inspector.errors import MissingLibrary
from stair_inspector.geometry.open3d import load_open3d, why_not_loadable

needs_open3d = pytest.mark.skipif(bool(why_not_loadable()), reason=f"without Open3D: {why_not_loadable()}")
"""Of tests whose numbers are Open3D's to the last bit."""


def open3d_or_skip():
    """Return Open3D; skip the test where it cannot be loaded, and say why."""
    try:
        return load_open3d()
    except MissingLibrary as error:
        pytest.skip(str(error))
