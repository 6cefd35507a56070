"""Which rules an inspector has chosen: a set by its id, overlays, the decision rule, limits changed by hand, own files.

It is part of a project, so that a report can be made again from it: a user's own rule files are kept whole, sets that
come with the program by their id alone.
"""

import dataclasses
import functools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import get_args

from stair_inspector.codes import Decision, Limit, Rule, RuleEdit, RuleSet, edited, overlaid
from stair_inspector.codes.limits import LIMIT_UNITS
from stair_inspector.codes.phrases import limit_words
from stair_inspector.codes.rules import Side
from stair_inspector.codes.texts import check_id
from stair_inspector.errors import ConfigError, brief, is_one_line
from stair_inspector.files.rule_sets import list_rule_sets, parse_rule_set
from stair_inspector.files.toml import check_keys

MOST_FILES = 20
MOST_OVERLAYS = 20
MOST_EDITS = 500
_LONGEST_NAME = 200
MOST_LEFT = 200


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
class LeftEdits:
    """Changes of the limits of a set that is not chosen now, oldest first; they come back with it.

    ``overlay_ids`` are the overlays of which some of the limits are; they come back too.
    """

    set_id: str
    edits: tuple[RuleEdit, ...]
    overlay_ids: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ChosenRules:
    """The rules that an inspection is held against.

    ``set_id`` is that of a full set, empty for no check; ``edits`` are changes of its limits and of its overlays',
    oldest first; ``files`` the user's own rule files, chosen or not; ``left`` what was changed of other sets.

    Raises
    ------
    ConfigError
        Not an id, an unknown decision rule, two own files of one id, changes of one set left twice or of the chosen
        one, or too many of anything. Whether the ids are known is said by :func:`rule_set_of`: another version of the
        program may have other sets.
    """

    set_id: str = ""
    overlay_ids: tuple[str, ...] = ()
    decision: Decision = "guarded"
    edits: tuple[RuleEdit, ...] = ()
    files: tuple[RuleFile, ...] = ()
    left: tuple[LeftEdits, ...] = ()

    def __post_init__(self) -> None:
        if self.set_id != "":
            check_id("rules: set", self.set_id)
        for overlay_id in self.overlay_ids:
            check_id("rules: overlay", overlay_id)
        if self.decision not in get_args(Decision):
            raise ConfigError(
                f"rules: decision: got {brief(self.decision)}; give one of {', '.join(get_args(Decision))}"
            )
        for each in self.left:
            for overlay_id in each.overlay_ids:
                check_id("rules: left: overlay", overlay_id)
            if len(each.overlay_ids) > MOST_OVERLAYS:
                raise ConfigError(f"rules: left: {len(each.overlay_ids)} overlays; keep at most {MOST_OVERLAYS}")
        limits = (("overlay_ids", MOST_OVERLAYS), ("edits", MOST_EDITS), ("files", MOST_FILES), ("left", MOST_LEFT))
        for name, most in limits:
            if len(getattr(self, name)) > most:
                raise ConfigError(f"rules: {len(getattr(self, name))} {name}; keep at most {most}")
        seen = {self.set_id}
        for each in self.left:
            check_id("rules: left: set", each.set_id)
            if each.set_id in seen or not 0 < len(each.edits) <= MOST_EDITS:
                raise ConfigError(
                    f"rules: left: the changes of {each.set_id} are none, too many, or there already; remove them"
                )
            seen.add(each.set_id)
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
        made = _edited_again(made, edit)
    return made


def is_usable(chosen: ChosenRules) -> bool:
    """Tell whether :func:`rule_set_of` can make the chosen rules."""
    try:
        rule_set_of(chosen)
    except ConfigError:
        return False
    return True


def with_set(chosen: ChosenRules, set_id: str, overlay_ids: tuple[str, ...] = ()) -> ChosenRules:
    """Return the choice with another full set, or none for an empty id, and these overlays.

    Changed limits stay with the set that is left, and the overlays whose limits they are. Those of the new one come
    back as far as they still fit it, each with its overlay.

    Raises
    ------
    ConfigError
        As :func:`rule_set_of`.
    """
    left = {each.set_id: each for each in chosen.left}
    if chosen.set_id and chosen.edits:
        left[chosen.set_id] = LeftEdits(chosen.set_id, chosen.edits, _edited_overlays(chosen))
    back = left.pop(set_id, LeftEdits(set_id, ()))
    bare = dataclasses.replace(chosen, set_id=set_id, overlay_ids=overlay_ids, edits=(), left=tuple(left.values()))
    own = tuple(each for each in back.overlay_ids if each in known_sets(chosen))
    missing = tuple(each for each in own if each not in overlay_ids)
    # The overlays of the changes come back; where they do not go with those that are laid now, in place of them.
    for laid in ((*overlay_ids, *missing), own) if missing else ():
        with_overlays = dataclasses.replace(bare, overlay_ids=laid)
        if is_usable(with_overlays):
            return with_fitting(with_overlays, back.edits)
    return with_fitting(bare, back.edits)


def with_fitting(chosen: ChosenRules, edits: Iterable[RuleEdit]) -> ChosenRules:
    """Return the choice with those of the changes that fit its rules: the rule is there, with the limit it had.

    Raises
    ------
    ConfigError
        As :func:`rule_set_of`.
    """
    made = rule_set_of(dataclasses.replace(chosen, edits=()))
    kept: list[RuleEdit] = []
    for edit in edits:
        if made is None:
            break
        try:
            made = _edited_again(made, edit)
        except ConfigError:
            continue
        kept.append(edit)
    return dataclasses.replace(chosen, edits=tuple(kept))


def n_edits(chosen: ChosenRules) -> int:
    """Return how many changes of limits a choice holds, those of sets that are not chosen too."""
    return len(chosen.edits) + sum(len(each.edits) for each in chosen.left)


def with_edit(chosen: ChosenRules, rule_id: str, side: Side, limit: Limit | None, reason: str) -> ChosenRules:
    """Return the choice with one limit changed.

    Raises
    ------
    ConfigError
        No set is chosen, the limit is what it was, none would be left, the minimum would be above the maximum, or as
        :func:`stair_inspector.codes.edited`.
    """
    made = rule_set_of(chosen)
    if made is None:
        raise ConfigError("edit a limit: choose a rule set first")
    rule = made.rule(rule_id)
    if limit_of(rule, side) == limit:
        raise ConfigError(f"edit a limit: the {side} of {rule_id} is {limit_words(limit)} already")
    _check_sides(rule, side, limit, is_reported=made.is_reported_in_file(rule_id))
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


@functools.cache
def _shipped() -> dict[str, RuleSet]:
    return {rule_set.set_id: rule_set for rule_set in list_rule_sets()}


@functools.lru_cache(maxsize=64)
def _parsed(name: str, text: str) -> RuleSet:
    return parse_rule_set(text.encode("utf-8"), name)


def _edited_again(rule_set: RuleSet, edit: RuleEdit) -> RuleSet:
    now = limit_of(rule_set.rule(edit.rule_id), edit.side)
    if now != edit.before:
        raise ConfigError(
            f"rules: the {edit.side} of {edit.rule_id} was {limit_words(edit.before)} when it was changed and is "
            f"{limit_words(now)} in {rule_set.file}; take that change back and make it again"
        )
    return edited(rule_set, edit.rule_id, edit.side, edit.after, edit.reason)


def _edited_overlays(chosen: ChosenRules) -> tuple[str, ...]:
    """Return the overlays of which a limit was changed; one that is not known may be such a one."""
    known = known_sets(chosen)
    changed = {edit.rule_id for edit in chosen.edits}
    return tuple(
        overlay_id
        for overlay_id in chosen.overlay_ids
        if overlay_id not in known or changed & {rule.rule_id for rule in known[overlay_id].rules}
    )


def _check_sides(rule: Rule, side: Side, limit: Limit | None, *, is_reported: bool) -> None:
    """Raise ConfigError for a limit that does not go with the rule's other one, in words for who changes one limit.

    A rule that the file has as reported only may be without any.
    """
    other_side: Side = "maximum" if side == "minimum" else "minimum"
    other = limit_of(rule, other_side)
    if limit is None and other is None and not is_reported:
        raise ConfigError(
            f"edit a limit: {rule.rule_id} would be left without any; give a {side}, or give the {other_side} first"
        )
    if limit is None or other is None or not {limit.unit, other.unit} <= set(LIMIT_UNITS[rule.quantity]):
        return
    is_crossed = limit.exact > other.exact if side == "minimum" else limit.exact < other.exact
    if is_crossed:
        relation = "above" if side == "minimum" else "below"
        raise ConfigError(
            f"edit a limit: a {side} of {limit.text} is {relation} the {other_side} of {rule.rule_id}, {other.text}; "
            f"give another {side}, or change the {other_side} first"
        )
