"""What a page may send."""

import math

import msgspec
import pytest

from stair_inspector.viewer.bridge.doors.messages import is_accepted

UPDATE = {"type": "GuiUpdateMessage", "uuid": "a", "updates": {"value": [1.0, "b", None]}}
START = {
    "type": "FileTransferStartUpload",
    "source_component_uuid": "a",
    "transfer_uuid": "b",
    "filename": "stair.ply",
    "mime_type": "",
    "part_count": 1,
    "size_bytes": 10,
}


@pytest.mark.parametrize("message", [UPDATE, START, {"type": "CommandTriggerMessage", "uuid": "a"}])
def test_what_the_page_sends_is_accepted(message):
    assert is_accepted(msgspec.msgpack.encode(message))


@pytest.mark.parametrize(
    "message",
    [
        {"type": "RunJavascriptMessage", "source": "alert(1)"},
        {"type": "GuiFormDirtyMessage", "uuid": "a"},
        {"type": "ShareUrlRequest"},
        {"type": "NotificationShowMessage", "uuid": "a", "props": {}},
        {"type": "SetGuiPanelLabelMessage", "label": "a"},
        {"type": "_GuiUpdate"},
        {"type": "GuiUpdateMessage"},
        {"type": ["GuiUpdateMessage"]},
        {"uuid": "a"},
        UPDATE | {"uuid": 1},
        UPDATE | {"uuid": "a" * 201},
        UPDATE | {"updates": {"value": 1, "visible": False}},
        UPDATE | {"updates": {"_markdown": "a"}},
        UPDATE | {"updates": []},
        UPDATE | {"other": 1},
        START | {"size_bytes": -1},
        START | {"size_bytes": 1.5},
        START | {"part_count": "1"},
        START | {"filename": None},
        [],
        None,
        7,
        "text",
    ],
    ids=str,
)
def test_nothing_else_is_accepted(message):
    assert not is_accepted(msgspec.msgpack.encode(message))


@pytest.mark.parametrize("message", [b"", b"\xc1", b"\x81", b"\xa1\xff", b"\x91" * 100_000, b"\x81\xa4type\xa1\xff"])
def test_what_is_no_message_is_not_accepted(message):
    assert not is_accepted(message)


@pytest.mark.parametrize("pixels", [-1, 2_000_000, math.nan, math.inf, "600", True])
def test_a_picture_has_a_size(pixels):
    camera = {"type": "ViewerCameraMessage", "wxyz": (1.0, 0, 0, 0), "position": (0, 0, 0), "fov": 1, "near": 0.1}
    camera |= {"far": 10, "look_at": (0, 0, 0), "up_direction": (0, 0, 1), "image_height": 600, "image_width": 800.5}
    assert is_accepted(msgspec.msgpack.encode(camera))
    assert not is_accepted(msgspec.msgpack.encode(camera | {"image_height": pixels}))
    assert not is_accepted(msgspec.msgpack.encode(camera | {"position": (0, 0)}))
