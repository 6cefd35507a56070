"""The inspector's work on one scan as one file: settings, overrules, measurements, views, kept runs, rules and report.

The scan itself is never written: a project names it by its SHA-256, so that its numbers cannot be taken from another.
"""

import dataclasses
import json
import math
import re
import stat
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from stair_inspector import __version__
from stair_inspector.errors import ConfigError, ReadError, is_one_line
from stair_inspector.files.atomic import write_atomically
from stair_inspector.files.chosen_rules import ChosenRules, chosen_from_dict, chosen_to_dict
from stair_inspector.files.settings import params_from_dict, params_to_dict
from stair_inspector.files.toml import check_keys
from stair_inspector.geometry.arrays import Point
from stair_inspector.params import Params

T = TypeVar("T")

SCHEMA = "stair-inspector/project-1"
SUFFIX = ".stair.json"
"""How the name of a project file ends."""
LARGEST_BYTES = 20_000_000
"""A project is a few kilobytes, and some megabytes with the report's pictures; a larger file is something else."""

_KEYS = ("schema", "software", "title", "scan", "settings", "measurements", "views", "runs")
_LATER_KEYS = ("rules", "report")
"""Keys that files from before they existed do not have."""
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
        object.__setattr__(self, "points_m", tuple(_to_point(point, place) for point in self.points_m))


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
            object.__setattr__(self, field, _to_point(getattr(self, field), f"{place}: {field}"))
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
class Project:
    """Everything an inspector changed about one scan.

    ``scan_file`` is the scan's file name without folder; ``scan_sha256`` that of the file's bytes, as in
    :class:`~stair_inspector.model.Scan`; ``params`` holds method, unit, up, region and overrules with the rest.
    ``rules`` are those that the inspection is held against. ``report`` is what the user gave for the report as plain
    values, which :func:`stair_inspector.content.project_basis.basis_of` reads.
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

    def __post_init__(self) -> None:
        _check_name(_spelt(self.scan_file), "scan.file", longest=_LONGEST_FILE_NAME)
        if "/" in self.scan_file or self.scan_file in (".", ".."):
            raise ConfigError(f"scan.file: got {self.scan_file[:60]!r}; give the scan's file name without a folder")
        if not isinstance(self.scan_sha256, str) or not _SHA256.fullmatch(self.scan_sha256):
            raise ConfigError(f"scan.sha256: got {str(self.scan_sha256)[:80]!r}; give 64 digits 0-9, a-f")
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


def project_bytes(project: Project) -> bytes:
    """Return a project as JSON, schema ``stair-inspector/project-1``; :func:`parse_project` returns its equal.

    Raises
    ------
    ConfigError
        It has become larger than a project file may be.
    """
    values = {
        "schema": SCHEMA,
        "software": {"name": "stair_inspector", "version": __version__},
        "title": project.title,
        "scan": {"file": project.scan_file, "sha256": project.scan_sha256},
        "settings": params_to_dict(project.params),
        "measurements": [dataclasses.asdict(entry) for entry in project.measurements],
        "views": [dataclasses.asdict(entry) for entry in project.views],
        "runs": [{"name": run.name, "settings": params_to_dict(run.params)} for run in project.runs],
        "rules": chosen_to_dict(project.rules),
        "report": dict(project.report),
    }
    text = json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    # A lone surrogate, as in a file name that is no UTF-8, is written as the escape that JSON has for it.
    data = text.encode("utf-8", errors="backslashreplace")
    if len(data) > LARGEST_BYTES:
        raise ConfigError(
            f"the project has {len(data):,} bytes, more than the {LARGEST_BYTES:,} of a project file; delete kept runs "
            "or shorten the overrules"
        )
    return data


def save_project(path: Path, project: Project) -> bytes:
    """Write a project file completely or not at all, and return its bytes.

    Raises
    ------
    ConfigError
        As :func:`project_bytes`.
    WriteError
        The file cannot be written; one that existed is untouched.
    """
    data = project_bytes(project)
    write_atomically(path, data)
    return data


def read_project(path: Path) -> Project:
    """Read a project file.

    Raises
    ------
    ConfigError
        Missing, not to be opened, or as :func:`parse_project`; the sentence begins with the path.
    """
    try:
        # Opening a pipe would wait for ever.
        if not stat.S_ISREG(path.stat().st_mode):
            raise ConfigError(f"{path}: cannot be read (not a file); check the name")
        with path.open("rb") as stream:
            data = stream.read(LARGEST_BYTES + 1)
    except ConfigError:
        raise
    except (OSError, ValueError) as error:
        # A ValueError comes from a path with a zero byte.
        reason = (error.strerror if isinstance(error, OSError) else None) or "not a valid path"
        raise ConfigError(f"{path}: cannot be read ({reason}); check the name") from error
    return parse_project(data, str(path))


def parse_project(data: bytes, place: str) -> Project:
    """Read a project from the bytes of its file, as an upload gives them.

    Parameters
    ----------
    data : bytes
        The whole file.
    place : str
        Name of the file, for the messages.

    Raises
    ------
    ConfigError
        Too large, not JSON, of another schema, with an unknown or missing key (the nearest known name is given), or
        with a value that is not possible: one sentence that begins with ``place``. Settings that are not named have
        their defaults, as in a preset, and so have rules and report: a project from before they existed can still be
        read.
    """
    try:
        return _from_values(_parse_json(data))
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error
    except RecursionError as error:
        # What JSON's reader just manages may be too deep for the message that shows it.
        raise ConfigError(f"{place}: is no project file: nested too deeply; give another file") from error


def _parse_json(data: bytes) -> Any:
    if len(data) > LARGEST_BYTES:
        raise ConfigError(f"is larger than {LARGEST_BYTES // 1_000_000} MB, which no project file is; give another")
    try:
        return json.loads(data, object_pairs_hook=_without_repeats, parse_constant=_refuse_constant)
    except ConfigError:
        raise
    except (ValueError, RecursionError) as error:
        # No UTF-8 and numbers of thousands of digits are ValueErrors as well; deep nesting raises the other.
        raise ConfigError(f"is no project file: not valid JSON ({error}); give a file that ends in {SUFFIX}") from error


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        twice = Counter(name for name, _ in pairs).most_common(1)[0][0]
        raise ConfigError(f"the key {twice[:60]!r} stands twice in one table; keep one of them")
    return values


def _refuse_constant(name: str) -> Any:
    raise ConfigError(f"holds {name}, which is no number; mend that place")


def _from_values(values: Any) -> Project:
    if not isinstance(values, dict) or values.get("schema") != SCHEMA:
        found = repr(values.get("schema"))[:60] if isinstance(values, dict) else "none"
        raise ConfigError(f"is no project file: the schema is {found}, not {SCHEMA!r}; give another file")
    values = _check_table(values, "the project", _KEYS, _LATER_KEYS)
    scan = _check_table(values["scan"], "scan", ("file", "sha256"))
    return Project(
        scan_file=scan["file"],
        scan_sha256=scan["sha256"],
        params=_to_params(values["settings"], "settings"),
        title=values["title"],
        measurements=_read_list(values, "measurements", ("name", "points_m"), lambda v, _: Measurement(**v)),
        views=_read_list(values, "views", _names_of(SavedView), lambda v, _: SavedView(**v)),
        runs=_read_list(
            values, "runs", ("name", "settings"), lambda v, at: KeptRun(v["name"], _to_params(v["settings"], at))
        ),
        rules=chosen_from_dict(values["rules"]) if "rules" in values else ChosenRules(),
        report=_to_plain(values.get("report", {})),
    )


def _names_of(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in dataclasses.fields(kind))


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
    _check_length(field, entries)
    names = Counter(entry.name for entry in entries)
    reserved = next((name for name in names if name.lower() in RESERVED_NAMES), None)
    if reserved is not None:
        raise ConfigError(f"{field}: {reserved!r} is a word of the menu and cannot be a name; choose another")
    twice = next((name for name, count in names.items() if count > 1), None)
    if twice is not None:
        raise ConfigError(f"{field}: the name {twice[:60]!r} is taken; choose another")


def _check_length(field: str, entries: Sequence[object]) -> None:
    if len(entries) > _MOST_ENTRIES:
        raise ConfigError(f"{field}: got {len(entries)}; keep at most {_MOST_ENTRIES}, delete some")


def _read_list(
    values: dict[str, Any], field: str, keys: Iterable[str], make: Callable[[dict[str, Any], str], T]
) -> tuple[T, ...]:
    entries = values[field]
    if not isinstance(entries, list):
        raise ConfigError(f"{field}: got {str(entries)[:60]!r}; give a list")
    _check_length(field, entries)
    made = []
    for number, entry in enumerate(entries, start=1):
        place = f"{field}, entry {number}"
        try:
            made.append(make(_check_table(entry, "", keys), "settings"))
        except ConfigError as error:
            raise ConfigError(f"{place}: {str(error).removeprefix(': ')}") from error
    return tuple(made)


def _to_plain(values: Any) -> dict[str, Any]:
    if not isinstance(values, dict):
        raise ConfigError(f"report: got {str(values)[:60]!r}; give a table")
    return values


def _check_table(values: Any, place: str, keys: Iterable[str], may_be_missing: Iterable[str] = ()) -> dict[str, Any]:
    """Return a table that has these keys, of others at most those that may be missing."""
    keys = tuple(keys)
    if not isinstance(values, dict):
        raise ConfigError(f"{place}: got {str(values)[:60]!r}; give a table with {', '.join(keys)}")
    check_keys(place, values, (*keys, *may_be_missing))
    missing = [key for key in keys if key not in values]
    if missing:
        raise ConfigError(f"{place}: the key {missing[0]!r} is missing; give it, or another file")
    return values


def _to_params(values: Any, place: str) -> Params:
    if not isinstance(values, dict):
        raise ConfigError(f"{place}: got {str(values)[:60]!r}; give a table of settings")
    return params_from_dict(values, place)


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


def _to_point(values: Any, place: str) -> Point:
    if not isinstance(values, (list, tuple)) or len(values) != 3:
        raise ConfigError(f"{place}: got {str(values)[:60]!r}; give three numbers, x, y and z")
    x, y, z = (_to_number(value, place) for value in values)
    return x, y, z
