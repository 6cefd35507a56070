"""Paths that a caller gives, and where the project's own data lies.

That is beside the package in a checkout or editable install, inside it in a wheel.
"""

import os
from pathlib import Path

from stair_inspector.errors import ConfigError, ReadError, brief

_PACKAGE = Path(__file__).resolve().parent.parent


def as_path(value: object, what: str) -> Path:
    """Return the path that a caller in Python gave; see :func:`path_text`."""
    return Path(path_text(value, what))


def path_text(value: object, what: str) -> str:
    """Return the text of a path or a name that a caller in Python gave.

    Raises
    ------
    ConfigError
        Neither a text nor a path; ``what`` says of what its path should be.
    """
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(text, str):
        raise ConfigError(f"got {brief(value)}; give the path of {what}")
    return text


def static_configs() -> Path:
    """Return the folder of presets, palettes and schemas."""
    return _data_folder("static_configs")


def sample_scans() -> Path:
    """Return the folder of the bundled simulated scans."""
    return _data_folder("sample_scans")


def _data_folder(name: str) -> Path:
    for parent in (_PACKAGE, _PACKAGE.parent):
        if (parent / name).is_dir():
            return parent / name
    raise ReadError(
        f"{name}: this folder is missing from the installation at {_PACKAGE}; install stair-inspector again"
    )
