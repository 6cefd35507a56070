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
    "libusb-1.0.so.0": "libusb-1.0-0",
}


@cache
def load_open3d() -> Any:
    """Import Open3D and return the module, quiet about its own warnings.

    The wheels link libusb-1.0.so.0, which a fresh Debian lacks; the package libusb-package ships a library with that
    very soname, so loading it first satisfies the linker.

    Raises
    ------
    MissingLibrary
        A shared library of the operating system is missing; the message names the Debian packages.
    """
    if sys.platform == "linux":
        import libusb_package

        path = libusb_package.get_library_path()
        if path is not None:
            ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)
    try:
        import open3d
    except (ImportError, OSError) as error:
        raise MissingLibrary(_explain(str(error))) from error
    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    return open3d


def _explain(message: str) -> str:
    library = next((name for name in _DEBIAN_PACKAGES if name in message), None)
    if library is None:
        return f"open3d cannot be loaded ({message}); reinstall it with: pip install --force-reinstall open3d-cpu"
    # One package a run would make the user try three times: name all that the wheel links.
    return (
        f"open3d cannot be loaded because {library} is missing; on Debian or Ubuntu install it with: "
        "apt-get install libgl1 libegl1 libx11-6 libgomp1"
    )
