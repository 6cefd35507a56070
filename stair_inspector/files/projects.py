"""The inspector's work on one scan as one file: settings, measurements, views, runs, rules, report, findings, and more.

The scan itself is never written: a project names it by its SHA-256, so that its numbers cannot be taken from another.
"""

import dataclasses
import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stair_inspector.errors import ConfigError, ReadError, is_one_line
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.files.raw_cloud import excerpt
from stair_inspector.geometry.arrays import Point
from stair_inspector.params import Params

SUFFIX = ".stair.json"
"""How the name of a project file ends."""
_LONGEST_NAME = 200
_LONGEST_FILE_NAME = 4000
"""A file name has 255 bytes at most, but each that cannot be shown is written as an escape."""
RESERVED_NAMES = ("none", "what is shown")
"""What menus of measurements, views and runs say for none of them, and for a result that is no kept run."""
_MOST_ENTRIES = 500
"""Most measurements, views or runs of a project."""
_FARTHEST_M = 1e8
"""Coordinates of a map grid stay far below."""
_SHA256 = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True, slots=True)
class Measurement:
    """A picked point (one) or a distance (two points), metres in the scan's own frame."""

    name: str
    points_m: tuple[Point, ...]

    def __post_init__(self) -> None:
        _check_name(self.name, "a measurement's name")
        place = f"measurement {self.name!r}: points_m"
        if not isinstance(self.points_m, (list, tuple)) or len(self.points_m) not in (1, 2):
            raise ConfigError(f"{place}: give one point, or two for a distance")
        object.__setattr__(self, "points_m", tuple(point_from(point, place) for point in self.points_m))


@dataclass(frozen=True, slots=True)
class SavedView:
    """A camera: metres in the scan's own frame; ``up`` is a direction; ``fov_deg`` is the upright angle of view."""

    name: str
    position_m: Point
    look_at_m: Point
    up: Point
    fov_deg: float

    def __post_init__(self) -> None:
        _check_name(self.name, "a view's name")
        place = f"view {self.name!r}"
        for field in ("position_m", "look_at_m", "up"):
            object.__setattr__(self, field, point_from(getattr(self, field), f"{place}: {field}"))
        fov_deg = _to_number(self.fov_deg, f"{place}: fov_deg")
        if not 0.0 < fov_deg < 180.0:
            raise ConfigError(f"{place}: fov_deg: got {fov_deg:g}; give an angle between 0 and 180 degrees")
        object.__setattr__(self, "fov_deg", fov_deg)
        if self.position_m == self.look_at_m:
            raise ConfigError(f"{place}: look_at_m: is the camera's own place; give the point it looks at")
        if math.hypot(*self.up) < 1e-6:
            raise ConfigError(f"{place}: up: got {list(self.up)}; give a direction, such as [0, 0, 1]")


@dataclass(frozen=True, slots=True)
class KeptRun:
    """Settings that were kept under a name to compare them with others."""

    name: str
    params: Params

    def __post_init__(self) -> None:
        _check_name(self.name, "a run's name")


@dataclass(frozen=True, slots=True)
class SecondScan:
    """A second scan of the same stair: its path, the SHA-256 of its bytes when it was chosen, and which is earlier.

    ``is_earlier`` tells that it was made before the scan of the project.
    """

    file: str
    sha256: str
    is_earlier: bool

    def __post_init__(self) -> None:
        _check_name(_spelt(self.file), "second_scan.file", longest=_LONGEST_FILE_NAME)
        _check_sha256(self.sha256, "second_scan.sha256")
        if not isinstance(self.is_earlier, bool):
            raise ConfigError(f"second_scan.is_earlier: got {str(self.is_earlier)[:60]!r}; give true or false")

    @property
    def name(self) -> str:
        """The name of its file."""
        return Path(self.file).name or self.file

    @property
    def shown_name(self) -> str:
        """The name as a page can show it, whatever a project file says."""
        return excerpt(self.name, _LONGEST_NAME)


@dataclass(frozen=True, slots=True)
class Project:
    """Everything an inspector changed about one scan.

    ``scan_file`` is the scan's file name without folder; ``scan_sha256`` that of the file's bytes, as in
    :class:`~stair_inspector.model.Scan`; ``params`` holds method, unit, up, region and overrules with the rest.
    ``rules`` are those that the inspection is held against. ``report`` is what the user gave for the report,
    ``findings`` pins and what was said of findings of the program: plain values, which ``basis_of`` and ``pinned_of``
    of :mod:`stair_inspector.content.project_basis` read. ``second`` is the scan with which this one is compared.
    """

    scan_file: str
    scan_sha256: str
    params: Params = dataclasses.field(default_factory=Params)
    title: str = ""
    measurements: tuple[Measurement, ...] = ()
    views: tuple[SavedView, ...] = ()
    runs: tuple[KeptRun, ...] = ()
    rules: ChosenRules = dataclasses.field(default_factory=ChosenRules)
    report: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    findings: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    second: SecondScan | None = None

    def __post_init__(self) -> None:
        _check_name(_spelt(self.scan_file), "scan.file", longest=_LONGEST_FILE_NAME)
        if "/" in self.scan_file or self.scan_file in (".", ".."):
            raise ConfigError(f"scan.file: got {self.scan_file[:60]!r}; give the scan's file name without a folder")
        _check_sha256(self.scan_sha256, "scan.sha256")
        if self.second is not None and not isinstance(self.second, SecondScan):
            raise ConfigError(f"second_scan: got {str(self.second)[:60]!r}; give a SecondScan or None")
        check_title(self.title)
        for field, kind in (("measurements", Measurement), ("views", SavedView), ("runs", KeptRun)):
            entries = tuple(getattr(self, field))
            if not all(isinstance(entry, kind) for entry in entries):
                raise ConfigError(f"{field}: give values of {kind.__name__} only")
            check_entries(field, entries)
            object.__setattr__(self, field, entries)


def autosave_path(scan: Path, folder: Path | None = None) -> Path:
    """Return where the project of a scan is kept: ``STEM.stair.json`` beside the scan, or in ``folder``."""
    return (scan.parent if folder is None else folder) / f"{scan.stem}{SUFFIX}"


def check_scan(project: Project, sha256: str, scan: str, place: str) -> None:
    """Raise unless a scan is the one that a project was made on; ``scan`` and ``place`` name the two files.

    Raises
    ------
    ReadError
        The SHA-256 differs: overrules, measurements and views would point at places of another cloud.
    """
    if sha256 != project.scan_sha256:
        raise ReadError(
            f"{scan}: is not the scan of the project {place}, which was made on {project.scan_file} with SHA-256 "
            f"{project.scan_sha256[:12]}..., while this file has {sha256[:12]}...; give that scan, or another project"
        )


def check_title(title: Any) -> None:
    """Raise unless a title can stand on one line; it may be empty.

    Raises
    ------
    ConfigError
        It is too long or holds a control character.
    """
    _check_name(title, "title", may_be_empty=True)


def check_entries(field: str, entries: Sequence[Measurement | SavedView | KeptRun]) -> None:
    """Check that a project can hold these measurements, views or runs, and a menu can list them.

    Raises
    ------
    ConfigError
        There are too many, two have the same name, or one has a name that is a menu's own word.
    """
    check_length(field, entries)
    names = Counter(entry.name for entry in entries)
    reserved = next((name for name in names if name.lower() in RESERVED_NAMES), None)
    if reserved is not None:
        raise ConfigError(f"{field}: {reserved!r} is a word of the menu and cannot be a name; choose another")
    twice = next((name for name, count in names.items() if count > 1), None)
    if twice is not None:
        raise ConfigError(f"{field}: the name {twice[:60]!r} is taken; choose another")


def check_length(field: str, entries: Sequence[object]) -> None:
    """Raise ConfigError for a list that is longer than a project holds."""
    if len(entries) > _MOST_ENTRIES:
        raise ConfigError(f"{field}: got {len(entries)}; keep at most {_MOST_ENTRIES}, delete some")


def _check_name(text: Any, what: str, *, may_be_empty: bool = False, longest: int = _LONGEST_NAME) -> None:
    """Raise unless a text can stand on one line of a page, a report or a picture."""
    if not isinstance(text, str):
        raise ConfigError(f"{what}: got {str(text)[:60]!r}; give a text")
    if len(text) > longest:
        raise ConfigError(f"{what}: has {len(text)} characters; give at most {longest}")
    if not is_one_line(text):
        raise ConfigError(f"{what}: {text[:60]!r} holds a control character, such as a line break; give one line")
    if not text.strip() and not may_be_empty:
        raise ConfigError(f"{what}: is empty; give a name")


def _check_sha256(text: Any, what: str) -> None:
    if not isinstance(text, str) or not _SHA256.fullmatch(text):
        raise ConfigError(f"{what}: got {str(text)[:80]!r}; give 64 digits 0-9, a-f")


def _spelt(file_name: Any) -> Any:
    """Return a file name with an escape for each byte that is no text: such names exist, other names never have any."""
    return file_name.encode("utf-8", "backslashreplace").decode("utf-8") if isinstance(file_name, str) else file_name


def _to_number(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ConfigError(f"{place}: got {str(value)[:60]!r}; give a number")
    # Comparing, not converting: a whole number of 400 digits has no float.
    if not -_FARTHEST_M <= value <= _FARTHEST_M:
        raise ConfigError(f"{place}: got {str(value)[:60]}; give a number from {-_FARTHEST_M:g} to {_FARTHEST_M:g}")
    return float(value)


def point_from(values: Any, place: str) -> Point:
    """Return a place from a file: three numbers that can be coordinates in metres.

    Raises
    ------
    ConfigError
        They are none; ``place`` says which.
    """
    if not isinstance(values, (list, tuple)) or len(values) != 3:
        raise ConfigError(f"{place}: got {str(values)[:60]!r}; give three numbers, x, y and z")
    x, y, z = (_to_number(value, place) for value in values)
    return x, y, z
