"""The pose of a PTX station, which its head states twice: as the scanner's place and axes, and as a matrix.

By the format the matrix is what lays the points, and its rows are the axes and the place. Some programs fill in only
one of the two. Where both say something and not the same, nothing tells which of them is true.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stair_inspector.errors import ReadError
from stair_inspector.files.number_rows import number_table
from stair_inspector.files.raw_cloud import READ_STAGE, excerpt
from stair_inspector.geometry.arrays import Floats
from stair_inspector.model import Note

HEAD_LINES = 8
_RIGID = 1e-3
"""How far the axes of a pose may be from unit vectors square to each other, as few decimals leave them."""
_STRETCH = 2e-5
"""A matrix that stretches by less changes a distance of five metres by less than 0.1 mm."""
_SAME_AXES, _SAME_PLACE = 0.01, 0.01
"""How far axes written with few decimals, and places, may differ that mean the same; a unit of a last digit besides."""
_FARTHEST, _ROUNDING = 1e12, 1e-12
_SHOWN = 8


@dataclass(frozen=True, slots=True, eq=False)
class PtxPose:
    """Where a station lies: points @ ``turn`` + ``shift``.

    ``place`` (3,) of its scanner, NaN where it is not certain; by ``stretch`` its matrix made distances longer;
    ``silent`` is '' where place and axes are the matrix, or which of the two says nothing: ``head`` or ``matrix``.
    """

    turn: Floats
    shift: Floats
    place: Floats
    stretch: float
    silent: str


def pose_of(lines: Sequence[Sequence[bytes]], station: int) -> PtxPose:
    """Return the pose that the eight lines behind the counts of a station state.

    Raises
    ------
    ReadError
        They are not numbers, the matrix is no turn and shift, or place and axes contradict it.
    """
    head = number_table(lines[:4], 3, f"line of the head of station {station}, after its two counts, no.", "scan")
    matrix = number_table(lines[4:], 4, f"line of the matrix of station {station}, no.", "scan")
    turn, shift = matrix[:3, :3], matrix[3, :3]
    if (
        not (np.isfinite(matrix).all() and np.abs(matrix).max() < _FARTHEST)
        or np.abs(matrix[:, 3] - (0.0, 0.0, 0.0, 1.0)).max() > 1e-9
        or np.abs(turn @ turn.T - np.eye(3)).max() > _RIGID
        or np.linalg.det(turn) < 0.0
    ):
        raise ReadError(
            f"the matrix of its station {station} ('{excerpt(b' '.join(lines[4]))}' ...) is no turn and shift, with "
            "the shift in its last row; export the scan again"
        )
    left, stretches, right = np.linalg.svd(turn)
    stretch = float(stretches[np.abs(stretches - 1.0).argmax()])
    digits = np.array([max(map(_last_digit, words)) for words in zip(lines[0][:3], lines[7][:3], strict=True)])
    silent = _silent(head, turn, shift, digits)
    if silent is None:
        raise ReadError(
            f"the head of its station {station} contradicts itself: its lines 3 to 6, the scanner's place "
            f"('{excerpt(b' '.join(lines[0]))}') and axes, are not the rows of its matrix; export the scan again, or "
            "as E57"
        )
    place = np.full(3, np.nan) if silent == "matrix" else shift
    if np.abs(stretches - 1.0).max() > _ROUNDING:
        turn = left @ right
    return PtxPose(turn, shift, place, stretch, silent)


def _silent(head: Floats, turn: Floats, shift: Floats, digits: Floats) -> str | None:
    """Return what :class:`PtxPose` keeps of how the two agree, None where they contradict each other."""
    if not (np.isfinite(head).all() and np.abs(head).max() < _FARTHEST):
        return None
    place, axes = head[0], head[1:]
    is_same_place = bool((np.abs(place - shift) <= _SAME_PLACE + digits).all())
    is_same_turn = bool(np.abs(axes - turn).max() <= _SAME_AXES)
    if is_same_place and is_same_turn:
        return ""
    if not shift.any() and np.array_equal(turn, np.eye(3)):
        return "matrix"
    is_plain = not axes.any() or np.array_equal(axes, np.eye(3))
    return "head" if (is_same_turn or is_plain) and (is_same_place or not place.any()) else None


def _last_digit(word: bytes) -> float:
    """Return what one in the last digit of a number is worth."""
    mantissa, _, exponent = word.lower().partition(b"e")
    power = int(exponent) if 0 < len(exponent) < 4 else 0
    return float(10.0 ** (power - len(mantissa.partition(b".")[2])))


def pose_notes(poses: Sequence[PtxPose], chosen: Sequence[int]) -> list[Note]:
    """Return what is to be silent of the poses of the stations that were chosen, by their places in the file."""
    found = (
        (
            "pose_in_matrix_only",
            [pose.silent == "head" for pose in poses],
            "the scanner's place or axes say nothing: its points lie where the matrix says",
        ),
        (
            "pose_in_head_only",
            [pose.silent == "matrix" for pose in poses],
            "the matrix says nothing, but the scanner's place or axes do: its points lie as they are written; look "
            "whether the stations fit together",
        ),
        (
            "pose_stretches",
            [abs(pose.stretch - 1.0) > _STRETCH for pose in poses],
            f"the matrix stretches, by up to {max((p.stretch for p in poses), key=lambda by: abs(by - 1.0)):.5f}: "
            "it was made a turn, so that lengths stay",
        ),
    )
    notes = []
    for code, are, words in found:
        which = [k for k, is_one in zip(chosen, are, strict=True) if is_one]
        if which:
            notes.append(Note(code, READ_STAGE, f"in the head of {_named(which)} {words}"))
    return notes


def _named(stations: Sequence[int]) -> str:
    numbers = ", ".join(str(k + 1) for k in stations[:_SHOWN])
    more = f" and {len(stations) - _SHOWN} more" if len(stations) > _SHOWN else ""
    return f"station{'s' if len(stations) > 1 else ''} {numbers}{more}"
