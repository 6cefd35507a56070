"""Files packed as a ZIP."""

import io
import zipfile
from collections.abc import Mapping
from datetime import datetime

_FIRST = (1980, 1, 1, 0, 0, 0)
_LAST = (2107, 12, 31, 23, 59, 58)
"""What a ZIP can say of the time of a file."""


def zip_bytes(files: Mapping[str, bytes], made_at: datetime) -> bytes:
    """Return files by their names as a ZIP that bears a time: the same input gives the same bytes."""
    moment = min(max(made_at.timetuple()[:6], _FIRST), _LAST)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name, moment), data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
