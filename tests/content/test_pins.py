"""Pins and what is said of findings: kept in a project as they are, or refused with one sentence."""

import dataclasses
import io
import json

import pytest
from PIL import Image

from stair_inspector.content import pins
from stair_inspector.content.images import Photo
from stair_inspector.content.pin_values import pinned_to_dict
from stair_inspector.content.pins import FindingDecision, Pin, PinnedFindings, read_pin_photo
from stair_inspector.content.project_basis import pinned_of
from stair_inspector.errors import ConfigError
from stair_inspector.files.project_files import parse_project, project_bytes
from stair_inspector.files.projects import Project

SHA = "0123456789abcdef" * 4
GUID = "01234567-89ab-cdef-0123-456789abcdef"
WHEN = "2026-11-30T09:30:00+01:00"


def guid(number):
    return f"{number:08x}{GUID[8:]}"


def photo(size=(1400, 700)):
    stream = io.BytesIO()
    Image.new("RGB", size, (10, 90, 160)).save(stream, "PNG")
    return read_pin_photo(stream.getvalue(), "photo")


PIN = Pin(GUID, "Crack\nin the <b>nosing</b> 계단", "critical", (1.0, -2.5, 0.34), 3, True, "J. Alder", WHEN, photo())
KEPT = PinnedFindings(
    (PIN, Pin(guid(1), "loose", "info", (500_000.25, 5_400_000.5, 100.0))),
    (
        FindingDecision(
            "rule/us-ibc-2021/riser/flight 1/step 5", "step 5", "192.9 mm", "minor", True, "agreed", "J", WHEN
        ),
    ),
)


def project_with(values):
    return parse_project(project_bytes(Project("a.ply", SHA, findings=values)), "a.stair.json")


@pytest.mark.parametrize("kept", [KEPT, PinnedFindings()], ids=["full", "empty"])
def test_findings_come_back_from_a_project_file(kept):
    assert pinned_of(project_with(pinned_to_dict(kept))) == kept


def test_a_project_from_before_there_were_findings_has_none():
    values = json.loads(project_bytes(Project("a.ply", SHA)))
    del values["findings"]
    assert pinned_of(parse_project(json.dumps(values).encode(), "a")) == PinnedFindings()


def test_a_photograph_is_made_small_and_keeps_nothing_that_hides_in_it():
    assert Image.open(io.BytesIO(photo().data)).size == (1000, 500)
    with pytest.raises(ConfigError, match=r"photo: is not a PNG or JPEG picture that can be read"):
        read_pin_photo(b"GIF89a", "photo")


PLAIN = {"guid": GUID, "text": "a", "severity": "minor", "place_m": [0, 0, 0]}


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"pinz": []}, "a.stair.json: findings: unknown key 'pinz'; did you mean 'pins'?"),
        ({"pins": {}}, "findings: pins: got {}; give a list"),
        ({"pins": [3]}, "findings: pin 1: got 3; give a table"),
        ({"pins": [{**PLAIN, "guid": "../../x"}]}, "findings: pin 1: pin: guid: got '../../x'"),
        ({"pins": [{**PLAIN, "text": " "}]}, "pin 1: a pin's text: is empty"),
        ({"pins": [{**PLAIN, "text": "a\u0000b"}]}, "holds a control character"),
        ({"pins": [{**PLAIN, "text": "a" * 1001}]}, "1,001 characters; give at most 1,000"),
        ({"pins": [{**PLAIN, "severity": ["info"]}]}, "pin: severity: got \"['info']\""),
        ({"pins": [{**PLAIN, "place_m": [0, 0, 1e300]}]}, "pin: place_m: got 1e+300"),
        ({"pins": [{**PLAIN, "step": 0}]}, "pin: step: got 0"),
        ({"pins": [{**PLAIN, "is_done": 1}]}, "pin: is_done: got 1; give true or false"),
        ({"pins": [{**PLAIN, "who": "a\nb"}]}, "pin: who: holds a line break"),
        ({"pins": [{**PLAIN, "made_at": "2026-02-30"}]}, "got the time '2026-02-30'"),
        ({"pins": [{**PLAIN, "photo_base64": "?"}]}, "pin 1: photo: is no picture in base64"),
        ({"pins": [{**PLAIN, "photo_base64": "R0lGODlh"}]}, "is no photograph as this program keeps them"),
        ({"pins": [PLAIN, PLAIN]}, f"findings: {GUID!r} stands twice"),
        ({"pins": [PLAIN] * 201}, "pins: got 201; keep at most 200"),
        ({"pins": [{**PLAIN, "photo_base64": "?"}] * 61}, "got 61 photographs; keep at most 60"),
        ({"decisions": [{"key": ""}]}, "decision 1: finding: key: is empty"),
        ({"decisions": [{"kee": "a"}]}, "decision 1: unknown key 'kee'"),
        ({"decisions": [{"key": "a" * 251}]}, "finding: key: 251 characters"),
    ],
)
def test_a_hostile_project_is_one_sentence(values, words):
    with pytest.raises(ConfigError) as caught:
        pinned_of(project_with(values), "a.stair.json")
    said = str(caught.value)
    assert words in said or words in said.replace(chr(34), chr(39))
    assert said.startswith("a.stair.json: ")
    assert "\n" not in said


def test_photographs_are_bounded_in_their_bytes(monkeypatch):
    monkeypatch.setattr(pins, "MOST_PIN_PHOTO_BYTES", 100)
    with pytest.raises(ConfigError, match=r"those of all pins have 0\.0 MB together; keep at most 0 MB"):
        PinnedFindings((dataclasses.replace(PIN, photo=Photo(b"x" * 101)),))


def test_a_pin_is_put_in_its_place_and_taken_away():
    changed = dataclasses.replace(PIN, is_done=False)
    assert KEPT.with_pin(changed).pins == (changed, KEPT.pins[1])
    assert KEPT.without(GUID).pins == KEPT.pins[1:]
    new = Pin(guid(2), "new", "minor", (0.0, 0.0, 0.0))
    assert KEPT.with_pin(new).pins[-1] == new


def test_what_says_nothing_of_a_finding_is_not_kept():
    key = KEPT.decisions[0].key
    assert KEPT.with_decision(FindingDecision(key, "step 5", "192.9 mm", who="J", decided_at=WHEN)).decisions == ()
    assert KEPT.without(key).decisions == ()
    other = FindingDecision("note/a/scan", remark="seen")
    assert KEPT.with_decision(other).decisions == (*KEPT.decisions, other)
