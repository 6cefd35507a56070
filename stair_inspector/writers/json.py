"""An inspection as JSON."""

import json

from stair_inspector.codes import Check
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.content.records import inspection_to_dict
from stair_inspector.model import ComparedScan, Inspection


def json_bytes(
    inspection: Inspection,
    check: Check | None = None,
    pinned: PinnedFindings | None = None,
    compared: ComparedScan | None = None,
) -> bytes:
    """Return the inspection as JSON, schema ``stair-inspector/inspection-1``: SI, positions in the scan frame.

    A check against a rule set is its field ``check``, null without one; ``pinned`` are
    pins of the inspector and what was said of findings; what changed against a second scan is the field
    ``comparison``, schema ``stair-inspector/comparison-1``, null without one.
    """
    found = inspection_to_dict(inspection, check, pinned, compared)
    text = json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False)
    # A lone surrogate, as in a file name that is no UTF-8, cannot be encoded: it is written as an escape.
    return (text + "\n").encode("utf-8", errors="backslashreplace")
