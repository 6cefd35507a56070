"""Libraries that tests compare with, and that a system may lack: CI lacks none of them."""

import importlib
import importlib.metadata
import importlib.util
import os
from typing import NoReturn

import pytest
from packaging.requirements import Requirement

from stair_inspector.errors import MissingLibrary
from stair_inspector.geometry.open3d import load_open3d, why_not_loadable

IN_CI = bool(os.environ.get("CI"))
needs_open3d = pytest.mark.skipif(
    bool(why_not_loadable()) and not IN_CI, reason=f"without Open3D: {why_not_loadable()}"
)
"""Of tests whose numbers are Open3D's to the last bit."""


def _is_asked_for(package: str, extra: str = "") -> bool:
    """Return whether the project asks for a package on this system, perhaps only with an extra."""
    wanted = map(Requirement, importlib.metadata.requires("stair-inspector") or ())
    named = [each for each in wanted if each.name == package]
    # A name that is written wrongly would skip its tests for good, in CI too.
    assert named, f"{package} is no dependency of the project"
    return any(not each.marker or each.marker.evaluate({"extra": extra}) for each in named)


HAS_NO_E57 = importlib.util.find_spec("pye57") is None and not _is_asked_for("pye57")
needs_e57 = pytest.mark.skipif(HAS_NO_E57, reason="pye57 has no wheel for this system")


def missing(what: str) -> NoReturn:
    """Skip a test for what a system lacks; in CI, which installs it, the test fails."""
    if IN_CI:
        pytest.fail(f"CI has all that tests need: {what}")
    pytest.skip(what)


def module_or_skip(name: str, package: str):
    """Return a module that tests compare with; skip where the project does not ask for its package on this system."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        if _is_asked_for(package, "dev"):
            missing(f"{package} cannot be loaded: {error}")
        pytest.skip(f"{package} has no wheel for this system")


def open3d_or_skip():
    """Return Open3D; skip the test where it cannot be loaded, and say why."""
    try:
        return load_open3d()
    except MissingLibrary as error:
        missing(str(error))
