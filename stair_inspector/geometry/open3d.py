"""The one door to Open3D: makes a plain ``pip install`` enough, or says which system package is missing."""

import ctypes
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


def check_system_libraries() -> None:
    """Check that the operating system has what the Open3D wheels link, without importing Open3D.

    Raises
    ------
    MissingLibrary
        At least one is missing; the message names all of them and their Debian packages.
    """
    if sys.platform != "linux":
        return
    missing = [name for name in _DEBIAN_PACKAGES if not _can_load(name)]
    if missing:
        packages = " ".join(_DEBIAN_PACKAGES[name] for name in missing)
        raise MissingLibrary(
            f"open3d cannot be loaded because this system lacks {', '.join(missing)}; on Debian or Ubuntu install: "
            f"apt-get install {packages}"
        )


@cache
def load_open3d() -> Any:
    """Import Open3D and return the module, quiet about its own warnings.

    The wheels link libusb-1.0.so.0, which a fresh Debian lacks; the package libusb-package ships a library with that
    very soname, so loading it first satisfies the linker.

    Raises
    ------
    MissingLibrary
        A shared library is missing, or the wheel is damaged.
    """
    check_system_libraries()
    if sys.platform == "linux":
        import libusb_package

        path = libusb_package.get_library_path()
        if path is not None:
            ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)
    try:
        import open3d
    except (ImportError, OSError) as error:
        raise MissingLibrary(f"open3d cannot be loaded ({error}); install stair-inspector again") from error
    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    return open3d


def _can_load(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True
