"""Writes settings and quantities into the schema of the JSON: ``python -m tests.write_schema``, after one was added."""

import json

from stair_inspector.content.schema import with_quantities
from stair_inspector.files.paths import static_configs
from stair_inspector.files.settings import settings_schema

SCHEMA = static_configs() / "schemas" / "inspection-1.schema.json"
HOW = "run: python -m tests.write_schema"


def written() -> str:
    """Return the text of the schema's file with the settings and quantities as they are declared."""
    schema = with_quantities(json.loads(SCHEMA.read_text(encoding="utf-8")))
    schema["properties"]["settings"] = settings_schema()
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SCHEMA.write_text(written(), encoding="utf-8")
