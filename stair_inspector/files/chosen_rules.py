"""Which rules an inspector has chosen: a set by its id, overlays, the decision rule, limits changed by hand, own files.

It is part of a project, so that a report can be made again from it: a user's own rule files are kept whole, sets that
come with the program by their id alone.
"""

import dataclasses
import functools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, get_args

from stair_inspector.codes import Decision, Limit, Rule, RuleEdit, RuleSet, edited, overlaid
from stair_inspector.codes.rules import Side, check_id
from stair_inspector.errors import ConfigError
from stair_inspector.files.rule_sets import list_rule_sets, parse_rule_set
from stair_inspector.files.toml import check_keys
from stair_inspector.params import brief, is_one_line

_MOST_FILES = 20
_MOST_OVERLAYS = 20
_MOST_EDITS = 500
_LONGEST_NAME = 200
_KEYS = ("set", "overlays", "decision", "edits", "files")
_EDIT_KEYS = ("rule", "side", "before", "after", "reason")


@dataclass(frozen=True, slots=True)
class RuleFile:
    """A user's own rule file: its name without a folder, and its text.

    Raises
    ------
    ConfigError
        Not a rule set; the sentence begins with the name.
    """

    name: str
    text: str

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not 0 < len(self.name) <= _LONGEST_NAME or not is_one_line(self.name):
            raise ConfigError(f"rule file: got the name {brief(self.name)}; give one line of letters")
        if not isinstance(self.text, str):
            raise ConfigError(f"{self.name}: got {brief(self.text)}; give the text of a rule file")
        try:
            self.text.encode("utf-8")
        except UnicodeEncodeError as error:
            raise ConfigError(f"{self.name}: holds half a letter; give a text file") from error
        if self.rule_set.set_id in _shipped():
            raise ConfigError(
                f"{self.name}: the id {self.rule_set.set_id!r} is that of a set that comes with the program; give the "
                "file another id"
            )

    @classmethod
    def of(cls, name: str, data: bytes) -> "RuleFile":
        """Return the rule file with these bytes, as an upload gives them.

        Raises
        ------
        ConfigError
            As the class, or no text.
        """
        # Only the name: what a browser sends is never a path.
        name = name.replace("\\", "/").rpartition("/")[2][-_LONGEST_NAME:]
        try:
            return cls(name, data.decode("utf-8"))
        except UnicodeDecodeError as error:
            raise ConfigError(f"{name}: is not a text file; give a TOML file") from error

    @property
    def rule_set(self) -> RuleSet:
        """The rule set in the file."""
        return _parsed(self.name, self.text)


@dataclass(frozen=True, slots=True)
class ChosenRules:
    """The rules that an inspection is held against.

    ``set_id`` is that of a full set, empty for no check; ``edits`` are changes of its limits and of its overlays',
    oldest first; ``files`` the user's own rule files, chosen or not.

    Raises
    ------
    ConfigError
        Not an id, an unknown decision rule, two own files of one id, or too many of anything. Whether the ids are
        known is said by :func:`rule_set_of`: another version of the program may have other sets.
    """

    set_id: str = ""
    overlay_ids: tuple[str, ...] = ()
    decision: Decision = "guarded"
    edits: tuple[RuleEdit, ...] = ()
    files: tuple[RuleFile, ...] = ()

    def __post_init__(self) -> None:
        if self.set_id != "":
            check_id("rules: set", self.set_id)
        for overlay_id in self.overlay_ids:
            check_id("rules: overlay", overlay_id)
        if self.decision not in get_args(Decision):
            raise ConfigError(
                f"rules: decision: got {brief(self.decision)}; give one of {', '.join(get_args(Decision))}"
            )
        for name, most in (("overlay_ids", _MOST_OVERLAYS), ("edits", _MOST_EDITS), ("files", _MOST_FILES)):
            if len(getattr(self, name)) > most:
                raise ConfigError(f"rules: {len(getattr(self, name))} {name}; keep at most {most}")
        own = [file.rule_set.set_id for file in self.files]
        twice = next((set_id for set_id in own if own.count(set_id) > 1), None)
        if twice is not None:
            raise ConfigError(f"rules: two own files have the id {twice!r}; give one of them another id")


def known_sets(chosen: ChosenRules) -> dict[str, RuleSet]:
    """Return every set that can be chosen, overlays too, by id: those of the program, then the user's own."""
    return {**_shipped(), **{file.rule_set.set_id: file.rule_set for file in chosen.files}}


def rule_set_of(chosen: ChosenRules) -> RuleSet | None:
    """Return the chosen rule set with its overlays and edits; None where none is chosen.

    Raises
    ------
    ConfigError
        An id that is not known (the nearest known one is named), an overlay that is none, or a limit that was another
        one when it was changed.
    """
    if not chosen.set_id:
        return None
    known = known_sets(chosen)
    check_keys("rules", [chosen.set_id, *chosen.overlay_ids], known, what="rule set")
    made = known[chosen.set_id]
    if made.is_overlay:
        raise ConfigError(f"rules: {chosen.set_id} is an overlay; choose a full set, and lay it over that")
    for overlay_id in chosen.overlay_ids:
        made = overlaid(made, known[overlay_id])
    for edit in chosen.edits:
        now = limit_of(made.rule(edit.rule_id), edit.side)
        if now != edit.before:
            raise ConfigError(
                f"rules: the {edit.side} of {edit.rule_id} was {_words(edit.before)} when it was changed and is "
                f"{_words(now)} in {made.file}; take that change back and make it again"
            )
        made = edited(made, edit.rule_id, edit.side, edit.after, edit.reason)
    return made


def with_edit(chosen: ChosenRules, rule_id: str, side: Side, limit: Limit | None, reason: str) -> ChosenRules:
    """Return the choice with one limit changed.

    Raises
    ------
    ConfigError
        No set is chosen, the limit is what it was, or as :func:`stair_inspector.codes.edited`.
    """
    made = rule_set_of(chosen)
    if made is None:
        raise ConfigError("edit a limit: choose a rule set first")
    if limit_of(made.rule(rule_id), side) == limit:
        raise ConfigError(f"edit a limit: the {side} of {rule_id} is {_words(limit)} already")
    return dataclasses.replace(chosen, edits=edited(made, rule_id, side, limit, reason).edits)


def without_edits(chosen: ChosenRules, rule_id: str | None = None) -> ChosenRules:
    """Return the choice with the limits of a rule, or of all rules, as the files have them.

    Raises
    ------
    ConfigError
        Nothing was changed, or what stays changed contradicts the limit that comes back.
    """
    kept = tuple(edit for edit in chosen.edits if rule_id is not None and edit.rule_id != rule_id)
    if len(kept) == len(chosen.edits):
        raise ConfigError("take back: no limit of this rule was changed" if rule_id else "take back: nothing to revert")
    return dataclasses.replace(chosen, edits=kept)


def limit_of(rule: Rule, side: Side) -> Limit | None:
    """Return a rule's minimum or maximum."""
    return rule.minimum if side == "minimum" else rule.maximum


def chosen_to_dict(chosen: ChosenRules) -> dict[str, Any]:
    """Return a choice as the plain values of a project file."""
    return {
        "set": chosen.set_id,
        "overlays": list(chosen.overlay_ids),
        "decision": chosen.decision,
        "edits": [
            {
                "rule": edit.rule_id,
                "side": edit.side,
                "before": _limit_to_dict(edit.before),
                "after": _limit_to_dict(edit.after),
                "reason": edit.reason,
            }
            for edit in chosen.edits
        ],
        "files": [{"name": file.name, "text": file.text} for file in chosen.files],
    }


def chosen_from_dict(values: object, place: str = "rules") -> ChosenRules:
    """Return what :func:`chosen_to_dict` wrote.

    Raises
    ------
    ConfigError
        An unknown or missing key (the nearest known name is given), or a value that is not possible.
    """
    table = _table(values, place, _KEYS)
    overlays, edits, files = (_list(table[name], f"{place}: {name}") for name in ("overlays", "edits", "files"))
    for name, entries, most in (("edits", edits, _MOST_EDITS), ("files", files, _MOST_FILES)):
        if len(entries) > most:
            raise ConfigError(f"{place}: {len(entries)} {name}; keep at most {most}")
    return ChosenRules(
        set_id=table["set"],
        overlay_ids=tuple(overlays),
        decision=table["decision"],
        edits=tuple(_to_edit(entry, f"{place}: edit {number}") for number, entry in enumerate(edits, 1)),
        files=tuple(_to_file(entry, f"{place}: file {number}") for number, entry in enumerate(files, 1)),
    )


@functools.cache
def _shipped() -> dict[str, RuleSet]:
    return {rule_set.set_id: rule_set for rule_set in list_rule_sets()}


@functools.lru_cache(maxsize=64)
def _parsed(name: str, text: str) -> RuleSet:
    return parse_rule_set(text.encode("utf-8"), name)


def _words(limit: Limit | None) -> str:
    return "no limit" if limit is None else limit.text


def _limit_to_dict(limit: Limit | None) -> dict[str, str] | None:
    return None if limit is None else {"written": limit.written, "unit": limit.unit}


def _to_limit(value: object, place: str) -> Limit | None:
    if value is None:
        return None
    table = _table(value, place, ("written", "unit"))
    if not isinstance(table["written"], str) or not isinstance(table["unit"], str):
        raise ConfigError(f"{place}: got {brief(value)}; give two texts, as '7 3/4' and 'in'")
    try:
        return Limit.of(table["written"], table["unit"])
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _to_edit(value: object, place: str) -> RuleEdit:
    table = _table(value, place, _EDIT_KEYS)
    check_id(f"{place}: rule", table["rule"])
    if table["side"] not in get_args(Side):
        raise ConfigError(f"{place}: side: got {brief(table['side'])}; give minimum or maximum")
    reason = table["reason"]
    if not isinstance(reason, str) or not reason.strip() or not is_one_line(reason):
        raise ConfigError(f"{place}: reason: got {brief(reason)}; give one line of text")
    before, after = (_to_limit(table[name], f"{place}: {name}") for name in ("before", "after"))
    return RuleEdit(table["rule"], table["side"], before, after, reason)


def _to_file(value: object, place: str) -> RuleFile:
    table = _table(value, place, ("name", "text"))
    try:
        return RuleFile(table["name"], table["text"])
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def _table(value: object, place: str, keys: Iterable[str]) -> dict[str, Any]:
    """Return a table that has exactly these keys."""
    if not isinstance(value, dict):
        raise ConfigError(f"{place}: got {brief(value)}; give a table with {', '.join(keys)}")
    check_keys(place, value, keys)
    missing = [key for key in keys if key not in value]
    if missing:
        raise ConfigError(f"{place}: the key {missing[0]!r} is missing; give it, or another file")
    return value


def _list(value: object, place: str) -> list[Any]:
    if not isinstance(value, list):
        raise ConfigError(f"{place}: got {brief(value)}; give a list")
    return value
