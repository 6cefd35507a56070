"""A check in the JSON of its inspection: by the schema, and number for number what the check says."""

import json

import jsonschema
import pytest

from stair_inspector.codes import Limit, check, edited, overlaid
from stair_inspector.content.check_records import check_record
from stair_inspector.files.paths import static_configs
from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets
from stair_inspector.writers.json import json_bytes
from tests.codes.flights import changed, even, inspection_of, measured


@pytest.fixture(scope="module")
def validator():
    schema = json.loads((static_configs() / "schemas" / "inspection-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def uneven():
    steps = changed(even(u=0.0004), 3, rise_m=measured(0.18, 0.001), going_m=None)
    return inspection_of(changed(steps, 1, rise_m=None))


@pytest.mark.parametrize("rule_set", list_rule_sets(), ids=lambda each: each.set_id)
@pytest.mark.parametrize("inspection", [uneven(), inspection_of([], [])], ids=["uneven", "no staircase"])
def test_the_json_with_a_check_follows_the_schema(validator, rule_set, inspection):
    document = json.loads(json_bytes(inspection, check(inspection, rule_set)))
    validator.validate(document)
    assert json.loads(json_bytes(inspection))["check"] is None


def test_a_reported_rule_that_is_judged_by_a_users_limit_follows_the_schema(validator):
    own = edited(find_rule_set("us-osha-1910-25"), "riser-uniformity", "maximum", Limit.of("5", "mm"), "agreed")
    document = json.loads(json_bytes(uneven(), check(uneven(), own)))
    validator.validate(document)
    (record,) = [each for each in document["check"]["rules"] if each["id"] == "riser-uniformity"]
    assert (record["severity"], record["maximum"]["written"]) == ("limit", "5")


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("findings", 0, "verdict"), "fine"),
        (("findings", 0, "value"), "0.18"),
        (("findings", 0, "colour"), "red"),
        (("rules", 0, "unit"), "in"),
        (("rules", 0, "maximum", "value"), None),
        (("rule_set", "edits"), None),
        (("decision", "rule"), "kind"),
    ],
    ids=str,
)
def test_the_schema_refuses_another_check(validator, place, value):
    inspection = uneven()
    document = json.loads(json_bytes(inspection, check(inspection, find_rule_set("us-ibc-2024"))))
    *path, last = place
    inner = document["check"]
    for key in path:
        inner = inner[key]
    inner[last] = value
    assert not validator.is_valid(document)


def test_the_numbers_are_those_of_the_check():
    inspection = uneven()
    rule_set = overlaid(find_rule_set("us-ibc-2024"), find_rule_set("us-nfpa-101-uniformity"))
    rule_set = edited(rule_set, "riser", "maximum", Limit.of("7 1/2", "in"), "an amendment")
    result = check(inspection, rule_set)
    record = json.loads(json.dumps(check_record(result)))
    for found, entry in zip(result.findings, record["findings"], strict=True):
        assert entry["rule"] == found.rule.rule_id
        assert entry["verdict"] == found.verdict.value
        assert (entry["flight"], tuple(entry["steps"])) == (found.flight, found.steps)
        assert (entry["value"], entry["u"], entry["margin"]) == (found.value, found.u, found.margin)
        assert (entry["limit"] is None) == (found.limit is None)
        if found.limit is not None:
            assert getattr(found.rule, entry["limit"]) == found.limit
    for rule, entry in zip(rule_set.rules, record["rules"], strict=True):
        for side in ("minimum", "maximum"):
            limit = getattr(rule, side)
            expected = None if limit is None else {"written": limit.written, "unit": limit.unit, "value": limit.value}
            assert entry[side] == expected
    assert record["is_outside"] is result.is_outside
    assert record["rule_set"]["sha256"] == rule_set.sha256
    assert record["rule_set"]["overlays"] == list(rule_set.overlays)
    assert record["rule_set"]["edits"] == [
        {
            "rule": "riser",
            "side": "maximum",
            "before": {"written": "7", "unit": "in", "value": 0.1778},
            "after": {"written": "7 1/2", "unit": "in", "value": 0.1905},
            "reason": "an amendment",
        }
    ]


def test_every_number_has_its_unit():
    record = check_record(check(uneven(), find_rule_set("us-osha-1910-25")))
    assert {rule["id"]: rule["unit"] for rule in record["rules"]} == {
        "angle": "deg",
        "riser": "m",
        "tread-depth": "m",
        "width": "m",
        "riser-uniformity": "m",
        "tread-uniformity": "m",
    }
    units = {
        rule["quantity"]: rule["unit"] for rule in check_record(check(uneven(), find_rule_set("us-ibc-2024")))["rules"]
    }
    assert units["tread_slope"] == units["landing_slope"] == "tangent"
    assert units["other"] is None
    australia = check_record(check(uneven(), find_rule_set("au-ncc-2022-public")))
    assert [rule["unit"] for rule in australia["rules"] if rule["quantity"] == "n_risers"] == ["count"]
