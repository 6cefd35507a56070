"""Findings as BCF 2.1: read back by another program, in the order that the schemas ask for, the same in every file."""

import dataclasses
import functools
import io
import re
import zipfile
from datetime import UTC, datetime
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from stair_inspector.content.finding_list import list_findings
from stair_inspector.content.pins import FindingDecision, Pin, PinnedFindings
from stair_inspector.content.step_places import middle_of
from stair_inspector.model import Note
from stair_inspector.writers import bcf as writer
from stair_inspector.writers.bcf import bcf_bytes, topic_guid
from tests.content.test_pins import PIN, WHEN, guid
from tests.oracles import module_or_skip
from tests.synthetic import exact_params
from tests.writers.samples import HOSTILE, MADE_AT, scanned

KEY = "note/step_blurred/step 2"
ORDER = {
    "Markup": ("Header", "Topic", "Comment", "Viewpoints"),
    "Header": ("File",),
    "File": ("Filename", "Date", "Reference"),
    "Topic": (
        "ReferenceLink",
        "Title",
        "Priority",
        "Index",
        "Labels",
        "CreationDate",
        "CreationAuthor",
        "ModifiedDate",
        "ModifiedAuthor",
        "DueDate",
        "AssignedTo",
        "Stage",
        "Description",
        "BimSnippet",
        "DocumentReference",
        "RelatedTopic",
    ),
    "DocumentReference": ("ReferencedDocument", "Description"),
    "Comment": ("Date", "Author", "Comment", "Viewpoint", "ModifiedDate", "ModifiedAuthor"),
    "Viewpoints": ("Viewpoint", "Snapshot", "Index"),
    "VisualizationInfo": ("Components", "OrthogonalCamera", "PerspectiveCamera", "Lines", "ClippingPlanes", "Bitmap"),
    "PerspectiveCamera": ("CameraViewPoint", "CameraDirection", "CameraUpVector", "FieldOfView"),
    **dict.fromkeys(("CameraViewPoint", "CameraDirection", "CameraUpVector"), ("X", "Y", "Z")),
    "Version": ("DetailedVersion",),
}
"""The children of each element, in the order of the sequences of markup.xsd, visinfo.xsd and version.xsd."""
NEEDED = {
    "Topic": ("Title", "CreationDate", "CreationAuthor"),
    "Comment": ("Date", "Author", "Comment"),
    "PerspectiveCamera": ORDER["PerspectiveCamera"],
}
GUID = re.compile("[a-fA-F0-9]{8}(-[a-fA-F0-9]{4}){3}-[a-fA-F0-9]{12}")


@functools.cache
def written():
    scan, inspection = scanned()
    inspection = dataclasses.replace(inspection, notes=(Note("step_blurred", "survey", "step 2 is blurred", 2),))
    pinned = PinnedFindings(
        (
            dataclasses.replace(PIN, place_m=middle_of(inspection, inspection.steps[2])),
            Pin(guid(2), HOSTILE, "minor", middle_of(inspection, inspection.steps[6])),
        ),
        (FindingDecision(KEY, "step 2", "blurred", "critical", True, f"seen {HOSTILE}", "J. Alder", WHEN),),
    )
    return inspection, pinned, bcf_bytes(scan, inspection, None, pinned, MADE_AT)


def test_a_time_before_the_first_and_after_the_last_that_a_zip_can_tell_is_the_next_one(monkeypatch):
    monkeypatch.setattr(writer, "_MOST_PICTURES", 0)
    scan, inspection = scanned()
    pinned = PinnedFindings((PIN,))
    for made_at, year in ((datetime.fromtimestamp(0, UTC), 1980), (datetime(2200, 1, 1, tzinfo=UTC), 2107)):
        with zipfile.ZipFile(io.BytesIO(bcf_bytes(scan, inspection, None, pinned, made_at))) as read:
            assert {member.date_time[0] for member in read.infolist()} == {year}
            assert read.testzip() is None


def archive():
    return zipfile.ZipFile(io.BytesIO(written()[2]))


@pytest.mark.slow
def test_another_reader_finds_every_topic_with_its_camera_picture_and_photograph(tmp_path):
    reader = module_or_skip("bcf.v2.bcfxml", "bcf-client")
    inspection, pinned, data = written()
    path = tmp_path / "findings.bcf"
    path.write_bytes(data)
    listed = list_findings(inspection, None, pinned)
    with reader.BcfXml(path) as read:
        assert read.version.version_id == "2.1"
        assert set(read.topics) == {topic_guid(entry, inspection) for entry in listed}
        on_step, at_point, note = (read.topics[topic_guid(entry, inspection)] for entry in listed)
        topic = on_step.topic
        assert (topic.topic_type, topic.topic_status, topic.priority) == ("Issue", "Closed", "critical")
        assert (topic.creation_author, str(topic.creation_date), topic.description) == ("J. Alder", WHEN, PIN.text)
        assert on_step.document_references == {"photo.jpg": PIN.photo.data}
        assert at_point.topic.description == HOSTILE
        assert at_point.topic.topic_status == "Open"
        assert (note.topic.topic_type, note.topic.modified_author) == ("Remark", "J. Alder")
        assert [each.comment for each in note.comments] == [f"seen {HOSTILE}"]
        for handler, entry in zip((on_step, at_point, note), listed, strict=True):
            (view,) = handler.viewpoints.values()
            picture = Image.open(io.BytesIO(view.snapshot))
            assert picture.size == (640, 480)
            assert len(np.unique(np.asarray(picture).reshape(-1, 3), axis=0)) > 100
            camera = view.visualization_info.perspective_camera
            place, direction, up = (
                np.array([each.x, each.y, each.z])
                for each in (camera.camera_view_point, camera.camera_direction, camera.camera_up_vector)
            )
            assert np.linalg.norm(direction) == pytest.approx(1.0, abs=1e-5)
            assert direction @ up == pytest.approx(0.0, abs=1e-5)
            target = entry.place_m or middle_of(inspection, inspection.steps[1])
            away = np.array(target) - place
            # It stands before the place and looks at it.
            assert away @ direction > 1.0
            assert np.linalg.norm(away - (away @ direction) * direction) < 0.2


def problems(element):
    """What of an element is not as the schemas ask."""
    names = [child.tag for child in element]
    if element.tag in ORDER and not (element.tag in ("Comment", "Viewpoint") and not names):
        known = ORDER[element.tag]
        places = [known.index(name) if name in known else -1 for name in names]
        if -1 in places or places != sorted(places):
            yield element.tag, names
        for name in NEEDED.get(element.tag, ()):
            if name not in names:
                yield element.tag, name
    if "Guid" in element.attrib and not GUID.fullmatch(element.attrib["Guid"]):
        yield element.tag, element.attrib
    for child in element:
        yield from problems(child)


def test_elements_stand_in_the_order_of_the_schemas():
    with archive() as read:
        documents = [name for name in read.namelist() if not name.endswith((".png", ".jpg"))]
        assert documents[0] == "bcf.version"
        assert len(documents) == 1 + 2 * 3
        found = {name: list(problems(ElementTree.fromstring(read.read(name)))) for name in documents}
    assert {name: wrong for name, wrong in found.items() if wrong} == {}
    wrong = ElementTree.fromstring("<Topic Guid='x'><CreationDate/><Title/></Topic>")
    assert len(list(problems(wrong))) == 3
    fov = ElementTree.fromstring(archive().read(documents[2])).find(".//FieldOfView").text
    assert 45.0 <= float(fov) <= 60.0


def test_the_same_findings_give_the_same_file():
    inspection, pinned, data = written()
    assert bcf_bytes(scanned()[0], inspection, None, pinned, MADE_AT) == data


def test_a_scan_without_a_staircase_and_more_findings_than_pictures(monkeypatch):
    monkeypatch.setattr(writer, "_MOST_PICTURES", 1)
    scan, inspection = scanned()
    empty = dataclasses.replace(inspection, steps=(), flights=(), axes=None, params=exact_params())
    pins = tuple(Pin(guid(k), "a", "minor", PIN.place_m) for k in (1, 2))
    with zipfile.ZipFile(io.BytesIO(bcf_bytes(scan, empty, None, PinnedFindings(pins), MADE_AT))) as read:
        assert [name for name in read.namelist() if name.endswith(".png")] == [f"{guid(1)}/snapshot.png"]
        assert f"{guid(2)}/viewpoint.bcfv" in read.namelist()


def test_what_xml_cannot_hold_is_written_out():
    inspection, _, _ = written()
    named = dataclasses.replace(inspection, scan=dataclasses.replace(inspection.scan, name="a\x07\udc80\uffff.ply"))
    with zipfile.ZipFile(io.BytesIO(bcf_bytes(scanned()[0], named, None, None, MADE_AT))) as read:
        markup = next(name for name in read.namelist() if name.endswith("markup.bcf"))
        found = ElementTree.fromstring(read.read(markup)).find(".//Filename").text
    assert found == r"a\u0007\udc80\uffff.ply"
