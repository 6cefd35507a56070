"""A choice of rules as the plain values of a project file, and back."""

from typing import Any, get_args

from stair_inspector.codes import Limit, RuleEdit
from stair_inspector.codes.rules import Side
from stair_inspector.codes.texts import check_id
from stair_inspector.errors import ConfigError, brief, is_one_line
from stair_inspector.files.chosen_rules import (
    MOST_EDITS,
    MOST_FILES,
    MOST_LEFT,
    MOST_OVERLAYS,
    ChosenRules,
    LeftEdits,
    RuleFile,
)
from stair_inspector.files.toml import as_table

_KEYS = ("set", "overlays", "decision", "edits", "files")
_LATER_KEYS = ("left",)
_EDIT_KEYS = ("rule", "side", "before", "after", "reason")


def chosen_to_dict(chosen: ChosenRules) -> dict[str, Any]:
    """Return a choice as the plain values of a project file."""
    values: dict[str, Any] = {
        "set": chosen.set_id,
        "overlays": list(chosen.overlay_ids),
        "decision": chosen.decision,
        "edits": [_edit_to_dict(edit) for edit in chosen.edits],
        "files": [{"name": file.name, "text": file.text} for file in chosen.files],
    }
    if chosen.left:
        values["left"] = [_left_to_dict(each) for each in chosen.left]
    return values


def chosen_from_dict(values: object, place: str = "rules") -> ChosenRules:
    """Return what :func:`chosen_to_dict` wrote.

    Raises
    ------
    ConfigError
        An unknown or missing key (the nearest known name is given), or a value that is not possible.
    """
    table = as_table(values, place, _KEYS, _LATER_KEYS)
    return ChosenRules(
        set_id=table["set"],
        overlay_ids=tuple(_list(table["overlays"], place, "overlays", MOST_OVERLAYS)),
        decision=table["decision"],
        edits=_to_edits(table["edits"], place),
        files=tuple(
            _to_file(entry, f"{place}: file {number}")
            for number, entry in enumerate(_list(table["files"], place, "files", MOST_FILES), 1)
        ),
        left=tuple(
            _to_left(entry, f"{place}: left {number}")
            for number, entry in enumerate(_list(table.get("left", []), place, "left", MOST_LEFT), 1)
        ),
    )


def _left_to_dict(left: LeftEdits) -> dict[str, Any]:
    values: dict[str, Any] = {"set": left.set_id, "edits": [_edit_to_dict(edit) for edit in left.edits]}
    if left.overlay_ids:
        values["overlays"] = list(left.overlay_ids)
    return values


def _edit_to_dict(edit: RuleEdit) -> dict[str, Any]:
    return {
        "rule": edit.rule_id,
        "side": edit.side,
        "before": _limit_to_dict(edit.before),
        "after": _limit_to_dict(edit.after),
        "reason": edit.reason,
    }


def _limit_to_dict(limit: Limit | None) -> dict[str, str] | None:
    return None if limit is None else {"written": limit.written, "unit": limit.unit}


def _to_limit(value: object, place: str) -> Limit | None:
    if value is None:
        return None
    table = as_table(value, place, ("written", "unit"))
    if not isinstance(table["written"], str) or not isinstance(table["unit"], str):
        raise ConfigError(f"{place}: got {brief(value)}; give two texts, as '7 3/4' and 'in'")
    try:
        return Limit.of(table["written"], table["unit"])
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _to_edits(value: object, place: str) -> tuple[RuleEdit, ...]:
    entries = _list(value, place, "edits", MOST_EDITS)
    return tuple(_to_edit(entry, f"{place}: edit {number}") for number, entry in enumerate(entries, 1))


def _to_left(value: object, place: str) -> LeftEdits:
    table = as_table(value, place, ("set", "edits"), ("overlays",))
    overlay_ids = tuple(_list(table.get("overlays", []), place, "overlays", MOST_OVERLAYS))
    return LeftEdits(table["set"], _to_edits(table["edits"], place), overlay_ids)


def _to_edit(value: object, place: str) -> RuleEdit:
    table = as_table(value, place, _EDIT_KEYS)
    check_id(f"{place}: rule", table["rule"])
    if table["side"] not in get_args(Side):
        raise ConfigError(f"{place}: side: got {brief(table['side'])}; give minimum or maximum")
    reason = table["reason"]
    if not isinstance(reason, str) or not reason.strip() or not is_one_line(reason):
        raise ConfigError(f"{place}: reason: got {brief(reason)}; give one line of text")
    before, after = (_to_limit(table[name], f"{place}: {name}") for name in ("before", "after"))
    return RuleEdit(table["rule"], table["side"], before, after, reason)


def _to_file(value: object, place: str) -> RuleFile:
    table = as_table(value, place, ("name", "text"))
    try:
        return RuleFile(table["name"], table["text"])
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _list(value: object, place: str, name: str, most: int) -> list[Any]:
    if not isinstance(value, list):
        raise ConfigError(f"{place}: {name}: got {brief(value)}; give a list")
    if len(value) > most:
        raise ConfigError(f"{place}: {len(value)} {name}; keep at most {most}")
    return value
