"""The logo and the photographs of a report, as HTML."""

import base64
import io
from functools import lru_cache

from PIL import Image

from stair_inspector.content.fields import MOST_PHOTOS
from stair_inspector.content.images import Photo
from stair_inspector.viewer.bridge.markup import DIM, LINE, list_key, order_button, text

DELETE_PHOTO = "photo"
"""Word before the list's key and the number, from 1, of a photograph that is to go."""
_SMALL_PIXELS = (192, 144)
_STYLE = "font-size:12px;line-height:1.3;padding:2px 12px 6px 5px;overflow-wrap:break-word"
_FRAME = f"background:#fff;outline:1px solid {LINE}"


def logo_html(logo: bytes | None) -> str:
    """Return the logo as the report has it, or that there is none."""
    if logo is None:
        return f'<div data-testid="logo" style="{_STYLE};color:{DIM}">No logo.</div>'
    return (
        f'<div data-testid="logo" style="{_STYLE}"><img alt="logo" src="{_source(logo, "png")}" '
        f'style="max-width:100%;max-height:64px;{_FRAME}"></div>'
    )


def photos_html(photos: tuple[Photo, ...], order_uuid: str) -> str:
    """Return a row for each photograph: small, with its caption and a button to delete it.

    Parameters
    ----------
    photos : tuple of Photo
        In the order of the report.
    order_uuid : str
        Identity of the control that a button writes to.
    """
    if not photos:
        words = f"No photograph yet; up to {MOST_PHOTOS} stand in the report behind the views."
        return f'<div data-testid="photos" style="{_STYLE};color:{DIM}">{words}</div>'
    key = list_key(photos)
    rows = (
        f'<div data-testid="photo-row" style="display:flex;gap:8px;align-items:flex-start;padding:3px 0">'
        f'<img alt="photograph {number}" src="{_source(_small(photo.data), "jpeg")}" style="width:96px;{_FRAME}">'
        f'<span style="flex:1;min-width:0;overflow-wrap:anywhere">{number}. {text(photo.caption) or _NO_CAPTION}</span>'
        f"{order_button(order_uuid, DELETE_PHOTO, key, number, f'delete photograph {number}')}</div>"
        for number, photo in enumerate(photos, 1)
    )
    return f'<div data-testid="photos" style="{_STYLE}">{"".join(rows)}</div>'


_NO_CAPTION = f'<span style="color:{DIM}">without a caption</span>'


def _source(data: bytes, kind: str) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


@lru_cache(maxsize=10 * MOST_PHOTOS)
def _small(data: bytes) -> bytes:
    """Return a JPEG made small, for a page that need not load what the report prints."""
    stream = io.BytesIO()
    with Image.open(io.BytesIO(data)) as picture:
        picture.thumbnail(_SMALL_PIXELS)
        picture.convert("RGB").save(stream, "JPEG")
    return stream.getvalue()
