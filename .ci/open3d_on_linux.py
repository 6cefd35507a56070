"""Adds Open3D to the dependencies of what is built on a Linux that can load its wheels for Python 3.13 and newer.

Those wheels, and all for ARM, ask for glibc 2.35, which no environment marker can tell. Where they are left out, the
program measures without Open3D.
"""

import platform
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_NEEDED_GLIBC = (2, 35)
ADDED = (
    "open3d-cpu>=0.20; sys_platform == 'linux' and platform_machine == 'x86_64' and python_version >= '3.13' and "
    "python_version < '3.15'",
    "open3d>=0.20; sys_platform == 'linux' and platform_machine == 'aarch64' and python_version < '3.15'",
    # Ships the libusb-1.0.so.0 that the open3d wheel links but does not bring.
    "libusb-package>=1.0.26; sys_platform == 'linux' and python_version < '3.15'",
)


def added_for(library: str, version: str) -> tuple[str, ...]:
    """Return the dependencies to add where this C library is, as ``platform.libc_ver`` names it."""
    numbers = [int(part) for part in version.split(".")[:2] if part.isdigit()]
    return ADDED if library == "glibc" and tuple(numbers) >= _NEEDED_GLIBC else ()


class Open3DOnLinux(BuildHookInterface):
    """Adds the dependencies; hatchling calls it for a wheel and for an editable installation."""

    PLUGIN_NAME = "open3d-on-linux"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add to what ``pyproject.toml`` lists."""
        build_data["dependencies"] += added_for(*platform.libc_ver())
