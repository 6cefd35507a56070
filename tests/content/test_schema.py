"""The schema's file says of quantities what is declared."""

import copy
import json

from stair_inspector.content.schema import with_quantities
from stair_inspector.quantities import IN_FILES, quantity_of
from tests.write_schema import HOW, SCHEMA, written


def test_the_file_describes_every_quantity_as_declared():
    text = SCHEMA.read_text(encoding="utf-8")
    assert text == written(), HOW
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
