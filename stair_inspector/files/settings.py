"""Settings as TOML and as JSON, and the presets that come with the program."""

import dataclasses
import inspect
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from stair_inspector.declarations import fields_of
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.paths import static_configs
from stair_inspector.files.toml import check_keys, parse_toml, read_toml
from stair_inspector.params import GROUPS, SETTINGS, Params

DEFAULT_PRESET = "default"
_OWN_KEYS = ("title", "description")
_JSON_TYPES: dict[type, str] = {int: "integer", float: "number", str: "string"}


@dataclass(frozen=True, slots=True)
class Preset:
    """A named set of settings with a sentence that says when to take it."""

    name: str
    title: str
    description: str
    params: Params


def params_to_dict(params: Params) -> dict[str, Any]:
    """Return every setting, grouped by stage, as plain values."""
    return dataclasses.asdict(params)


def settings_schema() -> dict[str, Any]:
    """Return the JSON schema of what :func:`params_to_dict` gives: the ``settings`` of an inspection's JSON."""
    tables: dict[str, Any] = {name: {} for name in fields_of(Params)}
    for name, declared in SETTINGS.items():
        group, _, field_name = name.rpartition(".")
        kind = declared.kind
        allowed = {"enum": list(get_args(kind))} if get_origin(kind) is Literal else {"type": _JSON_TYPES[kind]}
        values = {**allowed, "description": SETTINGS.setting(name).documentation}
        if group:
            tables[group][field_name] = values
        else:
            tables[name] = values
    for group, kind in GROUPS.items():
        tables[group] = {**_object_schema(tables[group]), "description": inspect.getdoc(kind)}
    return _object_schema(tables)


def _object_schema(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(properties)}


def params_from_dict(values: dict[str, Any], place: str) -> Params:
    """Build settings from a table such as TOML gives; what is not named keeps its default.

    Parameters
    ----------
    values : dict
        Settings by name, and one table per group.
    place : str
        File name for the messages.

    Raises
    ------
    ConfigError
        Unknown group or key (the nearest known name is given), wrong type, or out of range.
    """
    check_keys(place, values, fields_of(Params))
    chosen: dict[str, Any] = {}
    try:
        for name, value in values.items():
            if name not in GROUPS:
                chosen[name] = value
                continue
            if not isinstance(value, dict):
                raise ConfigError(f"{name}: got {brief(value)}; give a table [{name}]")
            check_keys(f"{place}: [{name}]", value, fields_of(GROUPS[name]))
            chosen[name] = GROUPS[name](**value)
        return Params(**chosen)
    except ConfigError as error:
        text = str(error)
        raise ConfigError(text if text.startswith(place) else f"{place}: {text}") from error


def read_preset(path: Path) -> Preset:
    """Read a preset file.

    Raises
    ------
    ConfigError
        As :func:`params_from_dict`, and for a file that is no TOML.
    """
    return _to_preset(read_toml(path), path.stem, str(path))


def parse_preset(data: bytes, name: str) -> Preset:
    """Read a preset from the bytes of its file, as an upload gives them; ``name`` is the file's.

    Raises
    ------
    ConfigError
        As :func:`read_preset`; the sentence begins with the name.
    """
    return _to_preset(parse_toml(data, name), Path(name).stem, name)


def preset_bytes(params: Params, title: str, description: str = "") -> bytes:
    """Return settings as a preset file, which reads back equal.

    Every setting is named, so that none changes where a later version has another default. Overrules belong to one
    scan: who saves a preset for other scans leaves them out of ``params``.

    Raises
    ------
    ConfigError
        A text cannot be written as UTF-8.
    """
    lines = [f"{key} = {_toml_value(text)}" for key, text in zip(_OWN_KEYS, (title, description), strict=True) if text]
    tables = []
    for name, value in params_to_dict(params).items():
        if isinstance(value, dict):
            tables += ["", f"[{name}]", *(f"{key} = {_toml_value(entry)}" for key, entry in value.items())]
        else:
            lines.append(f"{name} = {_toml_value(value)}")
    try:
        return ("\n".join([*lines, *tables]) + "\n").encode("utf-8")
    except UnicodeEncodeError as error:
        broken = str(error.object)[error.start : error.end]
        raise ConfigError(
            f"the preset: {broken!r} cannot be written as text; change the title or the reason"
        ) from error


def _toml_value(value: str | float) -> str:
    if isinstance(value, str):
        # JSON's escapes are those of TOML, which has one character more to escape.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)


def _to_preset(values: dict[str, Any], name: str, place: str) -> Preset:
    texts = {}
    for key in _OWN_KEYS:
        text = values.pop(key, "")
        if not isinstance(text, str):
            raise ConfigError(f"{place}: {key}: got {brief(text)}; give a text in quotes")
        texts[key] = text
    # A misspelt title must not be reported as a misspelt setting.
    check_keys(place, values, [*fields_of(Params), *_OWN_KEYS])
    return Preset(name, texts["title"] or name, texts["description"], params_from_dict(values, place))


def list_presets() -> list[Preset]:
    """Return the presets that come with the program, the default first, then by name."""
    files = sorted(
        (static_configs() / "presets").glob("*.toml"), key=lambda path: (path.stem != DEFAULT_PRESET, path.stem)
    )
    return [read_preset(path) for path in files]


def find_preset(name_or_file: str) -> Preset:
    """Return the preset with this name, or the one in this TOML file.

    Raises
    ------
    ConfigError
        Neither a known name nor a readable file; the known names are listed.
    """
    if name_or_file.lower().endswith(".toml") or "/" in name_or_file or "\\" in name_or_file:
        return read_preset(Path(name_or_file))
    known = {path.stem: path for path in (static_configs() / "presets").glob("*.toml")}
    if name_or_file not in known:
        check_keys("--preset", [name_or_file], known, what="preset")
    return read_preset(known[name_or_file])


def settings_beside(params: Params, own: Params) -> Params:
    """Return the settings of one scan for another, which has unit, columns, up and overrules of its own."""
    return dataclasses.replace(params, up=own.up, overrules=own.overrules, **own.reading._asdict())
