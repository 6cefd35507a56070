"""The schema's file says of quantities what is declared; after a change ``python -m tests.content.test_schema``."""

import copy
import json

from stair_inspector.content.schema import with_quantities
from stair_inspector.files.paths import static_configs
from stair_inspector.quantities import IN_FILES, quantity_of

SCHEMA = static_configs() / "schemas" / "inspection-1.schema.json"


def written(schema):
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def test_the_file_describes_every_quantity_as_declared():
    text = SCHEMA.read_text(encoding="utf-8")
    assert text == written(with_quantities(json.loads(text)))
    properties = json.loads(text)["$defs"]["step"]["properties"]
    assert {quantity.column for quantity in IN_FILES} <= set(properties)
    assert properties["going_m"]["description"] == quantity_of("going").definition


def test_a_quantity_that_is_no_more_goes_and_one_that_was_lost_comes_back():
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    changed = copy.deepcopy(schema)
    step = changed["$defs"]["step"]
    step["properties"]["shadow_m"] = {"$ref": "#/$defs/measured"}
    del step["properties"]["width_m"]
    assert with_quantities(changed) == schema


if __name__ == "__main__":
    SCHEMA.write_text(written(with_quantities(json.loads(SCHEMA.read_text(encoding="utf-8")))), encoding="utf-8")
