"""The logo and the photographs given for a report: checked, made small, without what cameras hide in them."""

import io
import warnings
from dataclasses import dataclass
from typing import Literal

from stair_inspector.content.texts import require_text
from stair_inspector.errors import ConfigError

LARGEST_IMAGE_BYTES = 20_000_000
_LARGEST_IMAGE_PIXELS = 60_000_000
_LOGO_PIXELS = (1200, 600)
_PHOTO_PIXELS = (1600, 1600)
"""What a picture is made smaller to: enough for print at the size at which the report shows it."""
_PHOTO_QUALITY = 85
_START_OF_SCAN, _END_OF_JPEG = b"\xff\xda", b"\xff\xd9"
"""Marks of a JPEG; the picture between them has neither."""


@dataclass(frozen=True, slots=True)
class Photo:
    """A photograph of the site with its caption: ``data`` are the bytes of a JPEG or PNG (:func:`read_photo`)."""

    data: bytes
    caption: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "caption", require_text(self.caption, "a photo's caption"))


def read_logo(data: bytes, place: str = "logo") -> bytes:
    """Return a logo as PNG, made small enough for the head of a page.

    Raises
    ------
    ConfigError
        Not a PNG or JPEG, damaged, or too large.
    """
    return _redrawn(data, place, _LOGO_PIXELS, "PNG")


def read_photo(
    data: bytes, caption: str = "", place: str = "photo", most_pixels: tuple[int, int] = _PHOTO_PIXELS
) -> Photo:
    """Return a photograph as JPEG, upright, without the place and time that cameras hide in it, and made smaller.

    Raises
    ------
    ConfigError
        Not a PNG or JPEG, damaged, or too large.
    """
    return Photo(_redrawn(data, place, most_pixels, "JPEG"), caption)


def photo_as_kept(data: bytes, caption: str, place: str) -> Photo:
    """Return a photograph of a project: as it is where it was redrawn before, since each time would cost some of it."""
    return Photo(data, caption) if _is_redrawn(data) else read_photo(data, caption, place)


def kept_photo(data: bytes, place: str) -> Photo:
    """Return a photograph of a project that is only taken as :func:`read_photo` made it: many are opened quickly.

    Raises
    ------
    ConfigError
        It is another picture, or damaged.
    """
    if not _is_redrawn(data):
        raise ConfigError(f"{place}: is no photograph as this program keeps them; take it out and add it on the page")
    return Photo(data)


def _is_redrawn(data: bytes) -> bool:
    """Return whether a picture is a JPEG as :func:`read_photo` makes them, sound, small enough and nothing hidden."""
    from PIL import Image, JpegImagePlugin

    if len(data) > LARGEST_IMAGE_BYTES:
        return False
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(data), formats=("JPEG",)) as picture:
                assert isinstance(picture, JpegImagePlugin.JpegImageFile)
                has_room = all(2 <= size <= most for size, most in zip(picture.size, _PHOTO_PIXELS, strict=True))
                # Places and times, comments and profiles stand in segments of their own, or behind the picture's end.
                ends = data.find(_END_OF_JPEG, data.find(_START_OF_SCAN)) + len(_END_OF_JPEG)
                is_bare = [name for name, _ in picture.applist] == ["APP0"] and ends == len(data)
                if not has_room or not is_bare or picture.mode != "RGB":
                    return False
                picture.load()
    except (OSError, ValueError, SyntaxError, Warning, Image.DecompressionBombError):
        return False
    return True


def _redrawn(data: bytes, place: str, most_pixels: tuple[int, int], kind: Literal["PNG", "JPEG"]) -> bytes:
    from PIL import Image, ImageOps

    if len(data) > LARGEST_IMAGE_BYTES:
        raise ConfigError(f"{place}: larger than {LARGEST_IMAGE_BYTES // 1_000_000} MB; give a smaller picture")
    try:
        with warnings.catch_warnings():
            # Pillow only warns of a picture that would fill the memory.
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
                if picture.width * picture.height > _LARGEST_IMAGE_PIXELS:
                    raise ConfigError(f"{place}: {picture.width} x {picture.height} pixels; give a smaller picture")
                upright = ImageOps.exif_transpose(picture)
                drawn = upright.convert("RGBA" if kind == "PNG" else "RGB")
    except ConfigError:
        raise
    except (OSError, ValueError, SyntaxError, Warning, Image.DecompressionBombError) as error:
        raise ConfigError(f"{place}: is not a PNG or JPEG picture that can be read; give another file") from error
    if min(drawn.size) < 2:
        raise ConfigError(f"{place}: {drawn.width} x {drawn.height} pixels; give a larger picture")
    drawn.thumbnail(most_pixels)
    # It would be written again.
    drawn.info.pop("comment", None)
    stream = io.BytesIO()
    drawn.save(stream, kind, quality=_PHOTO_QUALITY, optimize=True)
    return stream.getvalue()
