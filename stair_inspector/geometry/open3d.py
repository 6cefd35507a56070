"""The one door to Open3D: makes a plain ``pip install`` enough, or says why the program does without it."""

import ctypes
import importlib.util
import sys
from functools import cache
from typing import Any

from stair_inspector.errors import MissingLibrary

_DEBIAN_PACKAGES = {
    "libGL.so.1": "libgl1",
    "libEGL.so.1": "libegl1",
    "libX11.so.6": "libx11-6",
    "libgomp.so.1": "libgomp1",
}
"""Libraries that the Open3D wheels link and do not bring, and the Debian packages that have them."""


def why_not_loadable() -> str:
    """Return why Open3D cannot be loaded, without importing it; empty where nothing is known that would keep it out."""
    try:
        is_installed = importlib.util.find_spec("open3d") is not None
    except (ImportError, ValueError):
        is_installed = False
    if not is_installed:
        return "it is not installed"
    if sys.platform != "linux":
        return ""
    missing = [name for name in _DEBIAN_PACKAGES if not _can_load(name)]
    if not missing:
        return ""
    packages = " ".join(_DEBIAN_PACKAGES[name] for name in missing)
    return f"this system lacks {', '.join(missing)} (on Debian and Ubuntu: apt-get install {packages})"


def find_open3d() -> Any:
    """Import Open3D and return the module, quiet about its own warnings; None where it cannot be loaded."""
    return _find()[0]


def why_without() -> str:
    """Return why :func:`find_open3d` finds nothing; empty where it finds it."""
    return _find()[1]


def load_open3d() -> Any:
    """Import Open3D and return the module, for those who cannot do without it.

    Raises
    ------
    MissingLibrary
        It is not installed, a shared library is missing, or the wheel is damaged.
    """
    found, reason = _find()
    if found is None:
        raise MissingLibrary(f"Open3D cannot be loaded: {reason}")
    return found


@cache
def _find() -> tuple[Any, str]:
    """Return Open3D and an empty text, or None and why.

    The wheels link libusb-1.0.so.0, which a fresh Debian lacks; the package libusb-package ships a library with that
    very soname, so loading it first satisfies the linker.
    """
    reason = why_not_loadable()
    if reason:
        return None, reason
    try:
        if sys.platform == "linux":
            import libusb_package

            path = libusb_package.get_library_path()
            if path is not None:
                ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)
        import open3d

        # A folder of that name is a module too, without any of this.
        open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    except (ImportError, OSError, AttributeError, RuntimeError) as error:
        return None, f"its import fails ({' '.join(str(error).split())[:200]})"
    return open3d, ""


def _can_load(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True
