"""A project as a file: written completely or not at all, read with every mistake named."""

import dataclasses
import json
import stat
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

from stair_inspector import __version__
from stair_inspector.errors import ConfigError
from stair_inspector.files.atomic import write_atomically
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.files.chosen_rules_values import chosen_from_dict, chosen_to_dict
from stair_inspector.files.projects import SUFFIX, KeptRun, Measurement, Project, SavedView, SecondScan, check_length
from stair_inspector.files.settings import params_from_dict, params_to_dict
from stair_inspector.files.toml import as_table
from stair_inspector.params import Params

T = TypeVar("T")
SCHEMA = "stair-inspector/project-1"
LARGEST_BYTES = 20_000_000
"""A project is a few kilobytes, and some megabytes with the report's pictures; a larger file is something else."""
_KEYS = ("schema", "software", "title", "scan", "settings", "measurements", "views", "runs")
_LATER_KEYS = ("rules", "report", "findings", "second_scan")
"""Keys that files from before they existed do not have."""


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
        "findings": dict(project.findings),
        "second_scan": None if project.second is None else dataclasses.asdict(project.second),
    }
    text = json.dumps(values, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    # A lone surrogate, as in a file name that is no UTF-8, is written as the escape that JSON has for it.
    data = text.encode("utf-8", errors="backslashreplace")
    if len(data) > LARGEST_BYTES:
        raise ConfigError(
            f"the project has {len(data):,} bytes, more than the {LARGEST_BYTES:,} of a project file; delete "
            "photographs or kept runs, or shorten the overrules"
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
        their defaults, as in a preset, and so have rules, report, findings and the second scan: a project from before
        they existed can still be read.
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
    values = as_table(values, "the project", _KEYS, _LATER_KEYS)
    scan = as_table(values["scan"], "scan", ("file", "sha256"))
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
        report=_to_plain(values.get("report", {}), "report"),
        findings=_to_plain(values.get("findings", {}), "findings"),
        second=_to_second(values.get("second_scan")),
    )


def _names_of(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in dataclasses.fields(kind))


def _read_list(
    values: dict[str, Any], field: str, keys: Iterable[str], make: Callable[[dict[str, Any], str], T]
) -> tuple[T, ...]:
    entries = values[field]
    if not isinstance(entries, list):
        raise ConfigError(f"{field}: got {str(entries)[:60]!r}; give a list")
    check_length(field, entries)
    made = []
    for number, entry in enumerate(entries, start=1):
        place = f"{field}, entry {number}"
        try:
            made.append(make(as_table(entry, "", keys), "settings"))
        except ConfigError as error:
            raise ConfigError(f"{place}: {str(error).removeprefix(': ')}") from error
    return tuple(made)


def _to_second(values: Any) -> SecondScan | None:
    return None if values is None else SecondScan(**as_table(values, "second_scan", _names_of(SecondScan)))


def _to_plain(values: Any, place: str) -> dict[str, Any]:
    if not isinstance(values, dict):
        raise ConfigError(f"{place}: got {str(values)[:60]!r}; give a table")
    return values


def _to_params(values: Any, place: str) -> Params:
    if not isinstance(values, dict):
        raise ConfigError(f"{place}: got {str(values)[:60]!r}; give a table of settings")
    return params_from_dict(values, place)
