"""The process that reads E57 with the native library: what crashes, hangs or swells here takes nothing else with it.

Started by :mod:`stair_inspector.files.e57_process`, which describes what is said over the pipes. One file is read at a
time, in blocks: points are masked, turned spherical into cartesian, laid where the station's pose says, and sent.
"""

import json
import math
import os
import sys
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

BLOCK = 200_000
"""Points that are read at once."""
MOST_STATIONS = 1000
CPU_BYTES_PER_S = 200_000
"""Bytes of a file that may take a second; sound ones take a thousandth of that."""
_SPARE_BYTES = 512 * 2**20
_BYTES_PER_BYTE = 8
"""Memory that the library may take for a file: what it needs whatever the file, and so much for each byte."""
_NAME_CHARACTERS = 200
_XYZ = ("cartesianX", "cartesianY", "cartesianZ")
_RANGES = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
_INVALID: dict[tuple[str, ...], str] = {_XYZ: "cartesianInvalidState", _RANGES: "sphericalInvalidState"}
_INTENSITY = "intensity"
_RGB = ("colorRed", "colorGreen", "colorBlue")


class _Refused(Exception):
    """What is wrong with the file, as a sentence without its name."""


@dataclass(frozen=True, slots=True, eq=False)
class _Station:
    """An entry of data3D: its points in the file, and what its header says, checked.

    ``fields`` are the coordinates that are read, empty where there are none; ``turn`` (3, 3) and ``place`` (3,) the
    pose; ``steps`` (3,) of its coordinates in its own frame or None; ``limits`` (3, 2) of its colours or None;
    ``intensity`` the field of how strongly its points reflected, or None; ``refused`` says why it cannot be read, which
    matters only to who wants it.
    """

    node: Any
    name: str
    count: int
    fields: tuple[str, ...]
    invalid: str | None
    has_pose: bool
    turn: NDArray[np.float64]
    place: NDArray[np.float64]
    steps: NDArray[np.float64] | None
    limits: NDArray[np.float64] | None
    has_colors: bool
    invalid_color: str | None
    intensity: str | None = None
    refused: str = ""


def serve(orders: BinaryIO, answers: BinaryIO) -> None:
    """Answer orders until there are no more."""
    from pye57 import libe57

    opened: _File | None = None
    for line in orders:
        order = json.loads(line)
        try:
            if order["order"] == "open":
                _limit(order["n_bytes"])
                opened = None
                opened = _File(libe57, order["path"], order["n_bytes"])
                _say(answers, kind="stations", stations=[_told(each) for each in opened.stations])
            elif opened is not None:
                for number in order["stations"]:
                    opened.send(number, answers)
                _say(answers, kind="end")
        except _Refused as error:
            _say(answers, kind="refused", words=str(error))
        except MemoryError:
            _say(answers, kind="memory")
        except Exception as error:  # noqa: BLE001 - whatever the library throws, the process that waits must be told
            _say(answers, kind="damaged", words=f"{type(error).__name__}: {error}"[:500])


def _say(answers: BinaryIO, **what: object) -> None:
    answers.write(json.dumps(what).encode() + b"\n")
    answers.flush()


def _limit(n_bytes: int) -> None:
    """Let the system end this process where a damaged file makes the library run on or fill the memory."""
    try:
        import resource
    except ImportError:
        # Windows has none of these; the process that waits has a clock.
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    cpu_s = math.ceil(used.ru_utime + used.ru_stime + 1.0 + n_bytes / CPU_BYTES_PER_S)
    memory = resource.RLIM_INFINITY
    with suppress(OSError), open("/proc/self/statm", "rb") as stream:
        memory = int(stream.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
        memory += _SPARE_BYTES + _BYTES_PER_BYTE * n_bytes
    for kind, soft in ((resource.RLIMIT_CPU, cpu_s), (resource.RLIMIT_AS, memory)):
        hard = resource.getrlimit(kind)[1]
        is_within = hard == resource.RLIM_INFINITY or (soft != resource.RLIM_INFINITY and soft < hard)
        with suppress(OSError, ValueError):
            resource.setrlimit(kind, (soft if is_within else hard, hard))


def _told(station: _Station) -> dict[str, object]:
    """Return what the other process learns of a station before it asks for its points."""
    return {
        "name": station.name,
        "count": station.count if station.fields else 0,
        "refused": station.refused,
        "place": station.place.tolist() if station.has_pose else None,
        "steps": None if station.steps is None else station.steps.tolist(),
        "has_colors": station.limits is not None,
        "has_intensities": station.intensity is not None,
        "colors_unknown": station.has_colors and station.limits is None,
    }


class _File:
    """An open file. Its nodes must not outlive it, so it keeps them."""

    def __init__(self, library: Any, path: str, n_bytes: int) -> None:
        self._library = library
        self._file = library.ImageFile(path, "r")
        root = self._file.root()
        if not root.isDefined("data3D"):
            raise _Refused("is E57 without scans (data3D)")
        scans = root["data3D"]
        if not isinstance(scans, library.VectorNode):
            raise _Refused("is E57 whose data3D is no list of scans")
        n_scans = scans.childCount()
        if not 0 < n_scans <= MOST_STATIONS:
            raise _Refused(f"is E57 with {n_scans} scans, read are 1 to {MOST_STATIONS}")
        self.stations = [self._station_or_why_not(scans[k], k + 1) for k in range(n_scans)]
        n_points = sum(each.count for each in self.stations)
        if n_points > n_bytes:
            raise _Refused(f"states {n_points} points in {n_bytes} bytes, which cannot be")

    def _station_or_why_not(self, node: Any, number: int) -> _Station:
        name = f"scan {number}"
        if node.isDefined("name") and isinstance(node["name"], self._library.StringNode):
            name = node["name"].value()[:_NAME_CHARACTERS].strip() or name
        try:
            return self._station(node, name, number)
        except _Refused as error:
            turn, place = np.eye(3), np.zeros(3)
            return _Station(None, name, 0, (), None, False, turn, place, None, None, False, None, refused=str(error))

    def _station(self, node: Any, name: str, number: int) -> _Station:
        library = self._library
        if not node.isDefined("points") or not isinstance(node["points"], library.CompressedVectorNode):
            raise _Refused(f"its scan {number} has no list of points")
        points = node["points"]
        prototype = library.StructureNode(points.prototype())
        fields: tuple[str, ...] = next((names for names in (_XYZ, _RANGES) if all(map(prototype.isDefined, names))), ())
        invalid = _INVALID.get(fields, "")
        turn, place, has_pose = self._pose(node, number)
        has_colors = all(map(prototype.isDefined, _RGB))
        return _Station(
            node=points,
            name=name,
            count=points.childCount(),
            fields=fields,
            invalid=invalid if invalid and prototype.isDefined(invalid) else None,
            # Ranges are counted from the scanner.
            has_pose=has_pose or fields == _RANGES,
            turn=turn,
            place=place,
            steps=self._steps(prototype, turn) if fields == _XYZ else None,
            limits=self._color_limits(node, prototype) if has_colors else None,
            has_colors=has_colors,
            invalid_color="isColorInvalid" if prototype.isDefined("isColorInvalid") else None,
            intensity=_INTENSITY if prototype.isDefined(_INTENSITY) else None,
        )

    def _number(self, node: Any) -> float:
        """Return the value of a node that holds one number, NaN of others."""
        library = self._library
        if isinstance(node, library.ScaledIntegerNode):
            return float(node.scaledValue())
        return float(node.value()) if isinstance(node, (library.FloatNode, library.IntegerNode)) else math.nan

    def _numbers(self, node: Any, path: str, names: tuple[str, ...], default: tuple[float, ...]) -> list[float]:
        return [
            self._number(node[f"{path}/{name}"]) if node.isDefined(f"{path}/{name}") else missing
            for name, missing in zip(names, default, strict=True)
        ]

    def _pose(self, node: Any, number: int) -> tuple[NDArray[np.float64], NDArray[np.float64], bool]:
        """Return turn, place, and whether they say where the scanner stood: without a pose, or with none, nothing."""
        place = np.array(self._numbers(node, "pose/translation", ("x", "y", "z"), (0.0, 0.0, 0.0)))
        turned = np.array(self._numbers(node, "pose/rotation", ("w", "x", "y", "z"), (1.0, 0.0, 0.0, 0.0)))
        length = float(np.abs(turned).max())
        if not np.isfinite(place).all() or not np.isfinite(turned).all() or not 1e-3 < length < 1e3:
            raise _Refused(f"the pose of its scan {number} is no turn and shift")
        w, x, y, z = turned / float(np.linalg.norm(turned))
        turn = np.array(
            [
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
                [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
                [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
            ]
        )
        return turn, place, bool(place.any() or not np.array_equal(turn, np.eye(3)))

    def _steps(self, prototype: Any, turn: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Return the step of the coordinates along the axes after the turn: as wide as their rounding scatters."""
        own = np.zeros(3)
        for k, name in enumerate(_XYZ):
            node = prototype[name]
            if isinstance(node, self._library.ScaledIntegerNode):
                own[k] = abs(float(node.scale()))
            elif isinstance(node, self._library.IntegerNode):
                own[k] = 1.0
        if not own.any():
            return None
        if not np.isfinite(own).all() or own.max() > 1e6:
            raise _Refused(f"its coordinates have scales {own.tolist()}, which are no lengths")
        return np.asarray(np.sqrt(turn**2 @ own**2), dtype=np.float64)

    def _color_limits(self, node: Any, prototype: Any) -> NDArray[np.float64] | None:
        """Return the least and the greatest value (3, 2) of each colour; None where neither header nor type say it."""
        limits = np.zeros((3, 2))
        for k, name in enumerate(_RGB):
            stated = [f"{name}Minimum", f"{name}Maximum"]
            limits[k] = self._numbers(node, "colorLimits", tuple(stated), (math.nan, math.nan))
            if not _is_range(limits[k]) and isinstance(prototype[name], self._library.IntegerNode):
                limits[k] = float(prototype[name].minimum()), float(prototype[name].maximum())
        return limits if all(map(_is_range, limits)) else None

    def send(self, number: int, answers: BinaryIO) -> None:
        """Send the points of a station, block by block: where they lie in the file's frame, their colours, and more."""
        station = self.stations[number]
        colors = _RGB if station.limits is not None else ()
        marks = [name for name in (station.invalid, station.invalid_color if colors else None) if name]
        shine = [station.intensity] if station.intensity else []
        names = [*station.fields, *colors, *marks, *shine]
        block = min(BLOCK, station.count)
        values = {name: np.zeros(block) for name in names}
        buffers = self._library.VectorSourceDestBuffer()
        for name in names:
            buffers.append(self._library.SourceDestBuffer(self._file, name, values[name], block, True, True))
        reader = station.node.reader(buffers)
        n_read = 0
        while n_read < station.count:
            n = reader.read()
            if n == 0:
                raise _Refused(f"its scan {number + 1} states {station.count} points but {n_read} follow")
            n_read += n
            own = {name: column[:n] for name, column in values.items()}
            kept = np.flatnonzero(own[station.invalid] == 0.0) if station.invalid else np.arange(n)
            sent: list[NDArray[Any]] = [_places(station, own)[kept]]
            if station.limits is not None:
                sent.append(_bytes(own, station.limits, station.invalid_color)[kept])
            sent += [own[name][kept] for name in shine]
            _say(answers, kind="block", station=number, n=len(kept), n_invalid=n - len(kept))
            for array in sent:
                answers.write(np.ascontiguousarray(array).data)
        reader.close()


def _is_range(limits: NDArray[np.float64]) -> bool:
    return bool(np.isfinite(limits).all() and 0.0 < limits[1] - limits[0] < 1e12)


def _places(station: _Station, columns: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return where points (n, 3) lie in the file's frame."""
    first, second, third = (columns[name] for name in station.fields)
    with np.errstate(invalid="ignore", over="ignore"):
        if station.fields == _RANGES:
            level = first * np.cos(third)
            first, second, third = level * np.cos(second), level * np.sin(second), first * np.sin(third)
        # Summed by columns: a point has the same place whatever block it is in.
        turned = [row[0] * first + row[1] * second + row[2] * third for row in station.turn]
        return np.stack([along + shift for along, shift in zip(turned, station.place, strict=True)], axis=1)


def _bytes(
    columns: dict[str, NDArray[np.float64]], limits: NDArray[np.float64], invalid: str | None
) -> NDArray[np.uint8]:
    """Return colours (n, 3), 0 to 255; black where the file says that a point has none."""
    values = np.stack([columns[name] for name in _RGB], axis=1)
    low, high = limits.T
    with np.errstate(invalid="ignore", over="ignore"):
        scaled = np.nan_to_num(np.clip((values - low) / (high - low), 0.0, 1.0))
    if invalid is not None:
        scaled[columns[invalid] != 0.0] = 0.0
    colors: NDArray[np.uint8] = np.rint(255.0 * scaled).astype(np.uint8)
    return colors


def main() -> None:
    """Serve over standard input and output; what the library prints goes nowhere else than to the errors."""
    answers = os.fdopen(os.dup(1), "wb", buffering=1 << 20)
    os.dup2(2, 1)
    serve(sys.stdin.buffer, answers)


if __name__ == "__main__":
    main()
