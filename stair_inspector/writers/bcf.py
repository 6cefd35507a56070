"""The findings as BCF 2.1: a ZIP with a topic for each, its camera, a picture of the place, and a pin's photograph.

https://github.com/buildingSMART/BCF-XML/tree/release_2_1; elements stand in the order of its schemas. A writer that is
kept for Python draws in a library of building models of 55 MB, hence this one.
"""

import math
import uuid
from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from stair_inspector.codes import Check
from stair_inspector.content.document import plain
from stair_inspector.content.finding_list import KIND_WORDS, ListedFinding, list_findings
from stair_inspector.content.pins import PinnedFindings
from stair_inspector.files.atomic import write_atomically
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Inspection, Scan
from stair_inspector.pictures.cameras import Pose, frame_view
from stair_inspector.pictures.display import choose_display
from stair_inspector.pictures.render import render_poses
from stair_inspector.pictures.segmentation import extent_of, is_left_hidden, view_from_local
from stair_inspector.writers.zips import zip_bytes

_FOV_DEG = 50.0
"""BCF 2.1 takes 45 to 60."""
_SIZE_PX = (640, 480)
_MOST_PICTURES = 60
_AROUND_M = 0.5
"""What is seen around a pin or a step, to every side."""
_OWN_IDS = uuid.UUID("6f0f2f0c-52a5-4d0b-9d57-3c6f3a1b7e55")
_PROGRAM = "stair_inspector"
_LONGEST_TITLE = 120
_POINTS_TO_FRAME = 20_000


def write_bcf(
    path: Path,
    scan: Scan,
    inspection: Inspection,
    check: Check | None,
    pinned: PinnedFindings | None,
    made_at: datetime,
) -> None:
    """Write a BCF file completely or not at all; as :func:`bcf_bytes`.

    Raises
    ------
    WriteError
        The file cannot be written; one that existed is untouched.
    """
    write_atomically(path, bcf_bytes(scan, inspection, check, pinned, made_at))


def bcf_bytes(
    scan: Scan, inspection: Inspection, check: Check | None, pinned: PinnedFindings | None, made_at: datetime
) -> bytes:
    """Return the findings as a BCF file.

    Parameters
    ----------
    scan, inspection
        The same scan that was inspected.
    check : Check, optional
        The same inspection held against a rule set.
    pinned : PinnedFindings, optional
        Pins of the inspector, and what was said of findings.
    made_at : datetime
        With its offset: the date of what the program found.
    """
    findings = list_findings(inspection, check, pinned or PinnedFindings())
    poses = _poses(findings, scan, inspection)
    pictures = render_poses(scan, inspection, poses[:_MOST_PICTURES], math.radians(_FOV_DEG), _SIZE_PX)
    files = {"bcf.version": _version()}
    for entry, pose in zip(findings, poses, strict=True):
        files |= _topic_files(entry, pose, next(pictures, None), inspection, made_at)
    return zip_bytes(files, made_at)


def topic_guid(entry: ListedFinding, inspection: Inspection) -> str:
    """Return the identity of a finding in other programs: the same in every file about the same scan."""
    return entry.key if entry.is_pin else str(uuid.uuid5(_OWN_IDS, f"{inspection.scan.sha256}/{entry.key}"))


def _topic_files(
    entry: ListedFinding, pose: Pose, picture: bytes | None, inspection: Inspection, made_at: datetime
) -> dict[str, bytes]:
    guid = topic_guid(entry, inspection)
    view_guid = str(uuid.uuid5(_OWN_IDS, f"view/{guid}"))
    files = {
        f"{guid}/markup.bcf": _markup(entry, guid, view_guid, inspection, made_at, has_picture=picture is not None),
        f"{guid}/viewpoint.bcfv": _viewpoint(view_guid, pose, inspection),
    }
    if picture is not None:
        files[f"{guid}/snapshot.png"] = picture
    if entry.photo is not None:
        files[f"{guid}/photo.jpg"] = entry.photo.data
    return files


def _markup(
    entry: ListedFinding,
    guid: str,
    view_guid: str,
    inspection: Inspection,
    made_at: datetime,
    *,
    has_picture: bool,
) -> bytes:
    root = ElementTree.Element("Markup")
    scan = _child(_child(root, "Header"), "File", isExternal="true")
    _child(scan, "Filename", inspection.scan.name)
    topic = _child(
        root,
        "Topic",
        Guid=guid,
        TopicType="Issue" if entry.kind in ("pin", "limit") else "Remark",
        TopicStatus="Closed" if entry.is_done else "Open",
    )
    now = made_at.isoformat(timespec="seconds")
    _child(topic, "Title", _title_of(entry))
    _child(topic, "Priority", entry.severity)
    _child(topic, "Index", str(entry.number))
    _child(topic, "Labels", KIND_WORDS[entry.kind])
    _child(topic, "CreationDate", entry.when if entry.is_pin and entry.when else now)
    _child(topic, "CreationAuthor", (entry.who if entry.is_pin else "") or _PROGRAM)
    if not entry.is_pin and entry.when:
        _child(topic, "ModifiedDate", entry.when)
        _child(topic, "ModifiedAuthor", entry.who or _PROGRAM)
    _child(topic, "Description", entry.text)
    if entry.photo is not None:
        photo = _child(topic, "DocumentReference", Guid=str(uuid.uuid5(_OWN_IDS, f"photo/{guid}")), isExternal="false")
        _child(photo, "ReferencedDocument", "photo.jpg")
        _child(photo, "Description", f"photograph of finding {entry.number}")
    if entry.remark:
        comment = _child(root, "Comment", Guid=str(uuid.uuid5(_OWN_IDS, f"remark/{guid}")))
        _child(comment, "Date", entry.when or now)
        _child(comment, "Author", entry.who or _PROGRAM)
        _child(comment, "Comment", entry.remark)
        _child(comment, "Viewpoint", Guid=view_guid)
    view = _child(root, "Viewpoints", Guid=view_guid)
    _child(view, "Viewpoint", "viewpoint.bcfv")
    if has_picture:
        _child(view, "Snapshot", "snapshot.png")
    return _xml(root)


def _viewpoint(guid: str, pose: Pose, inspection: Inspection) -> bytes:
    """Return a camera, metres and directions of the scan's own frame."""
    turn, origin = view_from_local(inspection), np.array(inspection.scan.origin_m)
    forward = pose.look_at - pose.position
    forward = forward / np.linalg.norm(forward)
    above = pose.up - (pose.up @ forward) * forward
    root = ElementTree.Element("VisualizationInfo", Guid=guid)
    camera = _child(root, "PerspectiveCamera")
    for name, vector in (
        ("CameraViewPoint", pose.position @ turn + origin),
        ("CameraDirection", forward @ turn),
        ("CameraUpVector", above / np.linalg.norm(above) @ turn),
    ):
        place = _child(camera, name)
        for axis, value in zip("XYZ", vector, strict=True):
            _child(place, axis, f"{value:.6f}")
    _child(camera, "FieldOfView", f"{_FOV_DEG:g}")
    return _xml(root)


def _poses(findings: Iterable[ListedFinding], scan: Scan, inspection: Inspection) -> list[Pose]:
    """Return a camera for each finding, in the coordinates of the view: near its place, or before the whole stair."""
    display = choose_display(scan, _POINTS_TO_FRAME)
    turn, origin = view_from_local(inspection), np.array(inspection.scan.origin_m)
    corners = {step.step_id: step.corners for step in inspection.steps}
    is_from_right = is_left_hidden(inspection, display)
    whole = np.concatenate(list(corners.values())) if corners else display.points
    aspect = _SIZE_PX[0] / _SIZE_PX[1]

    def pose_of(entry: ListedFinding) -> Pose:
        near: Sequence[Floats] = [corners[step_id] for step_id in entry.steps if step_id in corners]
        if entry.place_m is not None:
            near = [np.array([entry.place_m]) - origin]
        box = extent_of(whole @ turn.T)
        if near:
            places = np.concatenate(near) @ turn.T
            box = np.concatenate([place + _AROUND_M * _CORNERS for place in places])
        return frame_view("Home", box, aspect, np.eye(3), math.radians(_FOV_DEG), is_from_right=is_from_right)

    return [pose_of(entry) for entry in findings]


_CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def _title_of(entry: ListedFinding) -> str:
    title = " ".join(f"{entry.where}: {entry.text}".split())
    return title if len(title) <= _LONGEST_TITLE else f"{title[: _LONGEST_TITLE - 1].rstrip()}…"


def _version() -> bytes:
    root = ElementTree.Element("Version", VersionId="2.1")
    _child(root, "DetailedVersion", "2.1")
    return _xml(root)


def _child(parent: ElementTree.Element, name: str, text: str = "", **attributes: str) -> ElementTree.Element:
    """Add an element; what XML cannot hold of a text is written as an escape."""
    made = ElementTree.SubElement(parent, name, attributes)
    if text:
        made.text = plain(text)
    return made


def _xml(root: ElementTree.Element) -> bytes:
    data: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return data
