"""What the menus of the Checks tab say: rule sets, overlays and limits by label; and what becomes of a choice."""

from collections.abc import Iterable

from stair_inspector.codes import Decision, RuleSet
from stair_inspector.codes.rules import Rule
from stair_inspector.content.rule_tables import limited_words
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules, is_usable, known_sets, n_edits, rule_set_of

NO_RULES = "none: measure only"
NO_OVERLAY = "none"
DECISION_OPTIONS: dict[str, Decision] = {"guarded: U counts": "guarded", "simple: the value alone": "simple"}
"""The decision rules by what the menu says; in full they stand with the result."""
_GROUPS = {
    "us": "US",
    "uk": "UK",
    "ca": "Canada",
    "au": "Australia",
    "kr": "Korea",
    "jp": "Japan",
    "fr": "France",
    "iso": "ISO",
}
"""Where a set of the program holds, by the first part of its id, in the order of the menu."""
_OTHER, _OWN = "Other", "Own"
_UNUSABLE = "was changed, and cannot be used now"
"""What the menu of limits says of a rule whose change does not fit the rule set of this version."""


def id_of(rules: ChosenRules, label: str, what: str) -> str:
    """Return the id of the set, or of the overlay, of a label of the menu."""
    labels = labels_of(rules, is_overlay=what == "overlay")
    if label not in labels:
        raise ConfigError(f"{what}: got {str(label)[:60]!r}; choose one of the menu")
    return labels[label]


def labels_of(rules: ChosenRules, *, is_overlay: bool) -> dict[str, str]:
    """Return the ids of the sets, or of the overlays, by what the menu says, country by country."""
    own = {file.rule_set.set_id for file in rules.files}
    order = [*_GROUPS.values(), _OTHER, _OWN]
    found = [
        (_OWN if set_id in own else _GROUPS.get(set_id.partition("-")[0], _OTHER), set_id, each)
        for set_id, each in known_sets(rules).items()
        if each.is_overlay == is_overlay
    ]
    found.sort(key=lambda entry: (order.index(entry[0]), entry[1]))
    return {_label_of(group, set_id, each): set_id for group, set_id, each in found}


def _label_of(group: str, set_id: str, rule_set: RuleSet) -> str:
    """Return what the menu says of a set: first its id, short and unlike all others, since the field cuts long ends."""
    short = set_id.partition("-")[2] if group in _GROUPS.values() else set_id
    return f"{group} · {short} · {rule_set.title}"


def rule_label(rule: Rule) -> str:
    """Return what the menu of limits says of a rule."""
    return f"{rule.rule_id}: {limited_words(rule)}"


def rule_named(rules: ChosenRules, label: str) -> Rule | None:
    """Return the rule of a label of the menu of limits, None for none."""
    made = rule_set_of(rules)
    return next((rule for rule in made.rules if rule_label(rule) == label), None) if made is not None else None


def limit_labels(rules: ChosenRules) -> tuple[str, ...]:
    """Return the rules whose limits can be changed, or, of a set that cannot be made, those whose limits were."""
    if not is_usable(rules):
        return tuple(f"{rule_id}: {_UNUSABLE}" for rule_id in dict.fromkeys(edit.rule_id for edit in rules.edits))
    made = rule_set_of(rules)
    return tuple(rule_label(rule) for rule in made.rules if rule.from_scan != "no") if made is not None else ()


def chosen_label(rules: ChosenRules) -> str:
    """Return what the menu says of the chosen set; a project may name one that this version does not have."""
    if not rules.set_id:
        return NO_RULES
    labels = {set_id: label for label, set_id in labels_of(rules, is_overlay=False).items()}
    return labels.get(rules.set_id, f"{rules.set_id} (cannot be used)")


def what_became(before: ChosenRules, after: ChosenRules) -> str:
    """Return what became of changed limits and of an overlay with another choice of rules; empty for nothing."""
    words = []
    is_other = after.set_id != before.set_id
    left = next((each for each in after.left if each.set_id == before.set_id), None) if is_other else None
    kept = () if left is None else left.overlay_ids
    if left is not None:
        name = rule_set_title(before, before.set_id)
        under = f", with its overlay {_titles_of(before, kept)}," if kept else ""
        words.append(f"{name} keeps {_counted(len(left.edits))}{under} for when it is chosen again")
    if after.edits and is_other:
        words.append(f"in force again: {_counted(len(after.edits))} of {rule_set_title(after, after.set_id)}")
    laid = tuple(each for each in after.overlay_ids if each not in before.overlay_ids)
    if laid and is_other:
        words.append(f"laid again: the overlay {_titles_of(after, laid)}")
    n_gone = n_edits(before) - n_edits(after)
    if n_gone > 0:
        words.append(f"dropped: {_counted(n_gone)}, of rules that are gone or have another limit now; Ctrl+Z undoes it")
    if (before.set_id, before.files) != (after.set_id, after.files):
        known = known_sets(after)
        gone = [each for each in before.overlay_ids if each in known and each not in (*after.overlay_ids, *kept)]
        words += [f"the overlay {known[each].title} is not laid any more" for each in gone]
    return "; ".join(words)


def _titles_of(rules: ChosenRules, overlay_ids: Iterable[str]) -> str:
    return " and ".join(rule_set_title(rules, overlay_id) for overlay_id in overlay_ids)


def _counted(n_limits: int) -> str:
    return f"{n_limits} changed limit{'' if n_limits == 1 else 's'}"


def rule_set_title(rules: ChosenRules, set_id: str) -> str:
    """Return the title of a rule set or overlay; of one that this version does not have, its id."""
    known = known_sets(rules)
    return known[set_id].title if set_id in known else set_id


def several_label(rules: ChosenRules) -> str:
    """Return what the menu says of the chosen overlays; a project may name more than one."""
    labels = {overlay_id: label for label, overlay_id in labels_of(rules, is_overlay=True).items()}
    return " + ".join(labels.get(overlay_id, overlay_id) for overlay_id in rules.overlay_ids)


def overlays_beside(rules: ChosenRules, set_id: str) -> tuple[str, ...]:
    """Return the overlays that stay laid over another set: none where their rules contradict its own."""
    known = known_sets(rules)
    if not set_id or any(overlay_id not in known for overlay_id in rules.overlay_ids):
        return ()
    laid = {rule.rule_id for overlay_id in rules.overlay_ids for rule in known[overlay_id].rules}
    return () if laid & {rule.rule_id for rule in known[set_id].rules} else rules.overlay_ids
