"""A copy of the package, to change one place of it and see where that shows."""

import os
import shutil
from pathlib import Path

from stair_inspector.files.paths import static_configs

ROOT = Path(__file__).parent.parent


def copy_package(folder):
    """Copy package and configs into a folder and return the package's copy.

    With what Python has compiled of it, which stays good for each file that is not changed; but for the files that it
    is writing at the moment.
    """
    package = folder / "stair_inspector"
    shutil.copytree(ROOT / "stair_inspector", package, ignore=shutil.ignore_patterns("*.pyc.*"))
    shutil.copytree(static_configs(), folder / "static_configs")
    return package


def environment_of(folder, *more):
    """The environment of a process that imports the package from a folder, and the rest from ``more``."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(str(each) for each in (folder, *more))}
