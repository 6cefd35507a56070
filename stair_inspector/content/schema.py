"""What of the JSON's schema follows from the quantities: the other half of it is written by hand."""

from typing import Any

from stair_inspector.quantities import IN_FILES, ON_LINES, PAPER_QUANTITIES

_MEASURED, _ON_LINES = {"$ref": "#/$defs/measured"}, {"$ref": "#/$defs/lines"}


def with_quantities(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of an inspection with the quantities of its steps as they are declared.

    Parameters
    ----------
    schema : dict
        Any state of it; what it says of quantities is replaced.
    """
    step = schema["$defs"]["step"]
    properties: dict[str, Any] = {}
    for name, described in step["properties"].items():
        if described.get("$ref") in (_MEASURED["$ref"], _ON_LINES["$ref"]):
            continue
        properties[name] = described
        if name == "paper":
            properties[name] = _paper()
            properties |= {each.column: {**_MEASURED, "description": each.definition} for each in IN_FILES}
        elif name == "coverage":
            properties |= {each.lines_field: _ON_LINES for each in ON_LINES}
    changed = {**step, "properties": properties, "required": list(properties)}
    return {**schema, "$defs": {**schema["$defs"], "step": changed}}


def _paper() -> dict[str, Any]:
    properties = {
        each.column: {"type": ["number", "null"], "description": each.definition} for each in PAPER_QUANTITIES
    }
    return {"type": "object", "properties": properties, "required": list(properties)}
