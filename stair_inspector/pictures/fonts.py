"""The fonts that a report brings along: Source Sans 3, and the Noto Sans KR that was drawn to go with it."""

import functools
from importlib import resources

from stair_inspector.errors import MissingLibrary

_PACKAGES = ("fontpkg_source_sans_3", "pylopdf_fonts_ko")
_FILES = ("files/SourceSans3[wght].ttf", "NotoSansKR-Regular.otf")


@functools.cache
def font_folders() -> tuple[str, ...]:
    """Return the folders with the fonts, in the order in which they are tried.

    Raises
    ------
    MissingLibrary
        A package of fonts is not installed.
    """
    try:
        return tuple(str(resources.files(package)) for package in _PACKAGES)
    except ModuleNotFoundError as error:
        package = (error.name or "").replace("_", "-")
        raise MissingLibrary(f"{package} is not installed, a font of the report: pip install {package}") from error


def font_files() -> tuple[str, ...]:
    """Return the upright fonts themselves; errors as :func:`font_folders`."""
    return tuple(f"{folder}/{file}" for folder, file in zip(font_folders(), _FILES, strict=True))
