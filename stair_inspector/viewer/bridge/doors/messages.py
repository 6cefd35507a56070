"""What a page may send: these types, with fields of these types, and nothing else.

viser takes over 100 types, most of which only a server has reason to send, and copies the fields of some as they come
into what every page gets.
"""

from typing import Annotated, Literal

import msgspec

_Id = Annotated[str, msgspec.Meta(max_length=200)]
_Name = Annotated[str, msgspec.Meta(max_length=1000)]
_Pixels = Annotated[float, msgspec.Meta(ge=0, le=1_000_000)]
_Vector = tuple[float, float, float]
_Quaternion = tuple[float, float, float, float]


class _Sent(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """A message of a page; its type is in the field of that name."""


class _Camera(_Sent, tag="ViewerCameraMessage"):
    wxyz: _Quaternion
    position: _Vector
    fov: float
    near: float
    far: float
    image_height: _Pixels
    image_width: _Pixels
    look_at: _Vector
    up_direction: _Vector


class _NewValue(msgspec.Struct, forbid_unknown_fields=True):
    """The value alone: viser would set any property of a control."""

    value: object


class _GuiUpdate(_Sent, tag="GuiUpdateMessage"):
    uuid: _Id
    updates: _NewValue


class _FormSubmit(_Sent, tag="GuiFormSubmitMessage"):
    uuid: _Id


class _CommandTrigger(_Sent, tag="CommandTriggerMessage"):
    uuid: _Id


class _ScenePointer(_Sent, tag="ScenePointerMessage"):
    event_type: Literal["click", "rect-select"]
    ray_origin: _Vector | None
    ray_direction: _Vector | None
    screen_pos: Annotated[list[tuple[float, float]], msgspec.Meta(max_length=2)]
    modifier: _Id | None


class _NodeClick(_Sent, tag="SceneNodeClickMessage"):
    name: _Name
    instance_index: int | None
    ray_origin: _Vector
    ray_direction: _Vector
    screen_pos: tuple[float, float]
    modifier: _Id | None
    owner: _Id = ""


class _GizmoMove(_Sent, tag="TransformControlsUpdateMessage"):
    name: _Name
    wxyz: _Quaternion
    position: _Vector
    owner: _Id = ""


class _GizmoStart(_Sent, tag="TransformControlsDragStartMessage"):
    name: _Name
    owner: _Id = ""


class _GizmoEnd(_Sent, tag="TransformControlsDragEndMessage"):
    name: _Name
    owner: _Id = ""


class _Stored(_Sent, tag="LocalStorageGetItemResponseMessage"):
    value: str | None
    error: str | None
    request_uuid: _Id


class _Render(_Sent, tag="GetRenderResponseMessage"):
    payload: bytes
    render_uuid: _Id


class _UploadStart(_Sent, tag="FileTransferStartUpload"):
    source_component_uuid: _Id
    transfer_uuid: _Id
    filename: _Name
    mime_type: _Name
    part_count: Annotated[int, msgspec.Meta(ge=0)]
    size_bytes: Annotated[int, msgspec.Meta(ge=0)]


class _UploadPart(_Sent, tag="FileTransferPart"):
    source_component_uuid: _Id | None
    transfer_uuid: _Id
    part_index: Annotated[int, msgspec.Meta(ge=0)]
    content: bytes


_DECODER = msgspec.msgpack.Decoder(
    _Camera
    | _GuiUpdate
    | _FormSubmit
    | _CommandTrigger
    | _ScenePointer
    | _NodeClick
    | _GizmoMove
    | _GizmoStart
    | _GizmoEnd
    | _Stored
    | _Render
    | _UploadStart
    | _UploadPart
)


def is_accepted(message: bytes) -> bool:
    """Return whether a message is one that the page sends, with fields of the right types."""
    try:
        _DECODER.decode(message)
    except (msgspec.MsgspecError, RecursionError, UnicodeDecodeError):
        return False
    return True
