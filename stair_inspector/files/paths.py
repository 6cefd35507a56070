"""Where the project's own data lies: beside the package in a checkout or editable install, inside it in a wheel."""

from pathlib import Path

from stair_inspector.errors import ReadError

_PACKAGE = Path(__file__).resolve().parent.parent


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
