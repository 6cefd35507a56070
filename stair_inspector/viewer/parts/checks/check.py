"""The present result held against the chosen rules, again at every result: the Checks tab and the marks of steps."""

import dataclasses
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from stair_inspector.codes import Check, Decision, RuleSet, check
from stair_inspector.codes.rules import Limit, Rule, Side
from stair_inspector.content.rule_tables import limited_words
from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.chosen_rules import (
    ChosenRules,
    RuleFile,
    is_usable,
    known_sets,
    limit_of,
    n_edits,
    rule_set_of,
    with_edit,
    with_fitting,
    with_set,
    without_edits,
)
from stair_inspector.files.rule_sets import parse_limit, rule_set_path
from stair_inspector.files.toml import read_toml_bytes
from stair_inspector.model import Inspection
from stair_inspector.units import Unit
from stair_inspector.viewer.bridge.handles import uuid_of
from stair_inspector.viewer.parts.checks.checks_html import (
    edits_html,
    not_assessed_html,
    rules_html,
    steps_html,
    summary_html,
)
from stair_inspector.viewer.parts.checks.tab import DECISION_OPTIONS, NO_OVERLAY, NO_RULES, SIDES
from stair_inspector.viewer.parts.desk import Desk, Editor
from stair_inspector.viewer.parts.panel import Panel
from stair_inspector.viewer.parts.steps.results import Results
from stair_inspector.viewer.scene.step_marks import marks_of
from stair_inspector.viewer.state.work import Changes, Work

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
_SIDES: dict[str, Side] = {SIDES[0]: "minimum", SIDES[1]: "maximum"}
_OTHER, _OWN = "Other", "Own"
_UNUSABLE = "was changed, and cannot be used now"
"""What the menu of limits says of a rule whose change does not fit the rule set of this version."""


class Checking:
    """The Checks tab. ``check`` is that of the result that is shown, None where no rules are chosen."""

    def __init__(self, desk: Desk, panel: Panel, results: Results, editor: Editor) -> None:
        self._desk = desk
        self._panel = panel
        self._results = results
        self._editor = editor
        self._opened: int | None = None
        self._error = ""
        self._judged: tuple[Inspection, ChosenRules] | None = None
        # What the results by rule were last drawn of: they may be many, and a choice of a step does not change them.
        self._drawn: tuple[Check | None, int | None, Unit] | None = None
        # Which limit the field was last filled with: of which set, rule and side.
        self._filled: tuple[str, str, Side, Limit | None] | None = None
        self.check: Check | None = None
        results.on_shown = self._show_results

    # What a person does.

    def choose(self, label: str) -> None:
        """Choose the rule set of a label of the menu, or none; changed limits stay with the set that is left."""

        def changed(rules: ChosenRules) -> ChosenRules:
            if label == _chosen_label(rules):
                return rules
            set_id = "" if label == NO_RULES else _id_of(rules, label, "rule set")
            return with_set(rules, set_id, _overlays_of(rules, set_id))

        self._opened = None
        self._change_and_tell(f"rules {label[:60]}", changed)

    def choose_overlay(self, label: str) -> None:
        """Lay the overlay of a label over the set, or none; changes of its limits go with it."""

        def changed(rules: ChosenRules) -> ChosenRules:
            if label == _several(rules):
                return rules
            overlay_ids = () if label == NO_OVERLAY else (_id_of(rules, label, "overlay"),)
            if overlay_ids and not rules.set_id:
                raise ConfigError("overlay: choose a rule set first")
            return with_fitting(dataclasses.replace(rules, overlay_ids=overlay_ids), rules.edits)

        self._change_and_tell(f"overlay {label[:60]}", changed)

    def choose_decision(self, option: str) -> None:
        """Choose whether verdicts heed the uncertainty."""
        decision: Decision | None = next((known for words, known in _decisions() if words == option), None)
        if decision is None:
            raise ConfigError(f"decision rule: got {str(option)[:40]!r}; choose one of the menu")
        self._change(f"decision {decision}", lambda rules: dataclasses.replace(rules, decision=decision))

    def choose_rule(self, option: str) -> None:
        """Write the present limit of a rule into the field, to be changed: of the side that has one."""
        with self._desk.lock:
            # Rules that cannot be used have no limit to show; a row of theirs is chosen to take its change back.
            if is_usable(self._editor.work.rules):
                self._rule_named(option)
            self._show_limit()

    def edit(self) -> None:
        """Change the limit that is chosen, with the reason that is written."""
        tab = self._panel.checks
        rule, side = self._rule_named(str(tab.rule.value)), self._side()
        written = str(tab.limit.value).strip()
        try:
            limit = parse_limit(written) if written else None
        except ConfigError as error:
            raise ConfigError(f"new limit: {error}") from error
        reason = " ".join(str(tab.reason.value).split())
        if not reason:
            raise ConfigError("change a limit: write why, in one line; it stands with the change in every report")
        words = f"{side} of {rule.rule_id} {written or 'none'}"
        self._change(words, lambda rules: with_edit(rules, rule.rule_id, side, limit, reason))
        tab.reason.value = ""

    def revert(self) -> None:
        """Give the chosen rule the limits of its file again."""
        # By its id: the rule may be one of a set that cannot be made.
        rule_id = str(self._panel.checks.rule.value).partition(":")[0]
        self._change(f"limits of {rule_id[:80]} as in the file", lambda rules: without_edits(rules, rule_id))

    def revert_all(self) -> None:
        """Give every rule the limits of its file again."""
        self._change("all limits as in the files", without_edits)

    def take_file(self, upload: Any) -> None:
        """Keep a user's own rule file and choose its set; a file of the same id takes the place of the old one."""
        file = RuleFile.of(str(upload.name), upload.content)
        new = file.rule_set

        def changed(rules: ChosenRules) -> ChosenRules:
            files = (*(each for each in rules.files if each.rule_set.set_id != new.set_id), file)
            newer = dataclasses.replace(rules, files=files)
            if not new.is_overlay:
                return with_set(newer, new.set_id, _overlays_of(newer, new.set_id))
            overlay_ids = (new.set_id,) if rules.set_id else ()
            return with_fitting(dataclasses.replace(newer, overlay_ids=overlay_ids), rules.edits)

        self._opened = None
        self._change_and_tell(f"rule file {file.name[:40]}", changed)

    def forget_file(self) -> None:
        """Take the chosen own set, or else the chosen own overlay, out of the project."""

        def changed(rules: ChosenRules) -> ChosenRules:
            own = {file.rule_set.set_id for file in rules.files}
            gone = next((set_id for set_id in (rules.set_id, *rules.overlay_ids) if set_id in own), None)
            if gone is None:
                raise ConfigError("forget: the chosen set comes with the program; choose an own one first")
            files = tuple(file for file in rules.files if file.rule_set.set_id != gone)
            if gone == rules.set_id:
                return dataclasses.replace(rules, set_id="", overlay_ids=(), edits=(), files=files)
            overlay_ids = tuple(overlay_id for overlay_id in rules.overlay_ids if overlay_id != gone)
            return with_fitting(dataclasses.replace(rules, overlay_ids=overlay_ids, files=files), rules.edits)

        self._opened = None
        self._change_and_tell("forgot an own rule file", changed)

    def save_copy(self) -> None:
        """Send the file of the chosen set, as it is without changes."""
        rules = self._editor.work.rules
        if not rules.set_id:
            raise ConfigError("save the file: choose a rule set first")
        own = next((file for file in rules.files if file.rule_set.set_id == rules.set_id), None)
        data = own.text.encode("utf-8") if own is not None else read_toml_bytes(rule_set_path(rules.set_id))
        name = own.name if own is not None else f"{rules.set_id}.toml"
        self._desk.client.send_file_download(Path(name).name, data, save_immediately=True)

    def next_outside(self) -> None:
        """Choose the next step upwards that is outside a limit, after the last one the first."""
        with self._desk.lock:
            marked = sorted(self._results.marks)
            if not marked:
                raise ConfigError("next step outside a limit: there is none, or no rule set is chosen")
            here = self._desk.selected or 0
            self._results.select(next((step_id for step_id in marked if step_id > here), marked[0]))

    def pick(self, number: str) -> None:
        """Open the rule of a number, from 1, or close it; it becomes the one whose limit can be changed."""
        rules = self.check.rule_set.rules if self.check is not None else ()
        if not number.isdecimal() or len(number) > 6 or not 1 <= int(number) <= len(rules):
            raise ConfigError(f"rule: got {number[:40]!r}; choose a row of the list")
        with self._desk.lock, self._desk.client.atomic():
            self._opened = None if self._opened == int(number) else int(number)
            rule = rules[int(number) - 1]
            if rule.from_scan != "no":
                self._panel.checks.rule.value = _rule_label(rule)
                self._show_limit()
            self._show_results()

    def checked(self) -> Check | None:
        """Return the check of the result that is shown, for its files; the caller holds the desk's lock.

        Raises
        ------
        ConfigError
            Rules are chosen that cannot be used: a file without its check would say less than it seems to.
        """
        self.judge()
        if self._error:
            raise ConfigError(f"{self._error}; or choose no rule set")
        return self.check

    # What the page shows. Callers hold the desk's lock.

    def judge(self) -> None:
        """Hold the present result against the chosen rules; what cannot be used is said and not applied."""
        inspection, rules = self._desk.inspection, self._editor.work.rules
        if self._judged is not None and self._judged[0] is inspection and self._judged[1] == rules:
            return
        self.check, self._error = None, ""
        try:
            made = rule_set_of(rules)
            if made is not None and inspection is not None:
                self.check = check(inspection, made, rules.decision)
        except StairError as error:
            self._error = str(error)
        self._judged = None if inspection is None else (inspection, rules)
        self._results.marks = marks_of(inspection, self.check)

    def show(self) -> None:
        """Show which rules are chosen, and judge again."""
        self.judge()
        self._show_menus()
        self._results.show_selection(with_pictures=False)
        if self._desk.shown is None:
            self._show_results()

    def _show_results(self) -> None:
        desk, tab = self._desk, self._panel.checks
        uuid = uuid_of(self._panel.picked)
        tab.summary.content = summary_html(self.check, self._error)
        if self._drawn is None or self._drawn[0] is not self.check or self._drawn[1:] != (self._opened, desk.unit):
            self._drawn = (self.check, self._opened, desk.unit)
            tab.by_rule.content = rules_html(self.check, self._opened, uuid, desk.unit)
        tab.by_step.content = steps_html(desk.inspection, self.check, desk.selected, uuid, desk.unit)
        tab.not_assessed.content = not_assessed_html(self.check)
        tab.edits.content = edits_html(self._editor.work.rules.edits)
        if desk.shown is not None:
            desk.stage.show_marks(self._results.marks)

    def _show_menus(self) -> None:
        tab, rules = self._panel.checks, self._editor.work.rules
        sets, overlays = (_labels(rules, is_overlay=is_overlay) for is_overlay in (False, True))
        several = _several(rules)
        offered = (*overlays, several) if several and several not in overlays else tuple(overlays)
        chosen = _chosen_label(rules)
        named = tuple(sets) if chosen in (NO_RULES, *sets) else (chosen, *sets)
        tab.offer_rules(named, chosen, offered, several or NO_OVERLAY)
        tab.decision.value = next(words for words, decision in _decisions() if decision == rules.decision)
        tab.offer_limits(_limit_labels(rules), str(tab.rule.value))
        self._show_limit()
        tab.show_reverts(has_edits=bool(rules.edits))

    def _show_limit(self) -> None:
        """Write the present limit of the chosen rule into the field, unless that is what was written there last."""
        tab, rules = self._panel.checks, self._editor.work.rules
        rule = _rule_of(rules, str(tab.rule.value)) if is_usable(rules) else None
        if rule is None:
            self._filled = None
            tab.show_limit("")
            return
        if self._filled is None or self._filled[:2] != (rules.set_id, rule.rule_id):
            with_limit = [words for words, side in _SIDES.items() if limit_of(rule, side) is not None]
            if len(with_limit) == 1:
                tab.side.value = with_limit[0]
        side = self._side()
        limit = limit_of(rule, side)
        present = (rules.set_id, rule.rule_id, side, limit)
        if present != self._filled:
            self._filled = present
            tab.show_limit("" if limit is None else limit.as_written, is_there=limit is not None)

    def _change_and_tell(self, words: str, change: Callable[[ChosenRules], ChosenRules]) -> None:
        """Change the choice, and say what became of changed limits and overlays that were not asked for."""
        before = self._editor.work.rules
        self._change(words, change)
        told = _what_became(before, self._editor.work.rules)
        if told:
            self._desk.notices.tell("Changed limits and overlays", told)

    def _change(self, words: str, change: Callable[[ChosenRules], ChosenRules]) -> None:
        """Change the choice; each change refuses by itself what cannot be used."""

        def changed(work: Work) -> Changes:
            return {"rules": change(work.rules)}

        try:
            self._editor.edit(words, changed)
        except ConfigError:
            # The menus have what was asked for, and not what is kept.
            with self._desk.lock:
                self._show_menus()
            raise

    def _rule_named(self, label: str) -> Rule:
        rule = _rule_of(self._editor.work.rules, label)
        if rule is None:
            raise ConfigError("change a limit: choose a rule set and a rule first")
        return rule

    def _side(self) -> Side:
        return _SIDES.get(str(self._panel.checks.side.value), "maximum")


def _id_of(rules: ChosenRules, label: str, what: str) -> str:
    labels = _labels(rules, is_overlay=what == "overlay")
    if label not in labels:
        raise ConfigError(f"{what}: got {str(label)[:60]!r}; choose one of the menu")
    return labels[label]


def _labels(rules: ChosenRules, *, is_overlay: bool) -> dict[str, str]:
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


def _rule_label(rule: Rule) -> str:
    return f"{rule.rule_id}: {limited_words(rule)}"


def _rule_of(rules: ChosenRules, label: str) -> Rule | None:
    made = rule_set_of(rules)
    return next((rule for rule in made.rules if _rule_label(rule) == label), None) if made is not None else None


def _limit_labels(rules: ChosenRules) -> tuple[str, ...]:
    """Return the rules whose limits can be changed, or, of a set that cannot be made, those whose limits were."""
    if not is_usable(rules):
        return tuple(f"{rule_id}: {_UNUSABLE}" for rule_id in dict.fromkeys(edit.rule_id for edit in rules.edits))
    made = rule_set_of(rules)
    return tuple(_rule_label(rule) for rule in made.rules if rule.from_scan != "no") if made is not None else ()


def _chosen_label(rules: ChosenRules) -> str:
    """Return what the menu says of the chosen set; a project may name one that this version does not have."""
    if not rules.set_id:
        return NO_RULES
    labels = {set_id: label for label, set_id in _labels(rules, is_overlay=False).items()}
    return labels.get(rules.set_id, f"{rules.set_id} (cannot be used)")


def _what_became(before: ChosenRules, after: ChosenRules) -> str:
    """Return what became of changed limits and of an overlay with another choice of rules; empty for nothing."""
    words = []
    is_other = after.set_id != before.set_id
    left = next((each for each in after.left if each.set_id == before.set_id), None) if is_other else None
    kept = () if left is None else left.overlay_ids
    if left is not None:
        name = _title_of(before, before.set_id)
        under = f", with its overlay {_titles_of(before, kept)}," if kept else ""
        words.append(f"{name} keeps {_counted(len(left.edits))}{under} for when it is chosen again")
    if after.edits and is_other:
        words.append(f"in force again: {_counted(len(after.edits))} of {_title_of(after, after.set_id)}")
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
    return " and ".join(_title_of(rules, overlay_id) for overlay_id in overlay_ids)


def _counted(n_limits: int) -> str:
    return f"{n_limits} changed limit{'' if n_limits == 1 else 's'}"


def _title_of(rules: ChosenRules, set_id: str) -> str:
    known = known_sets(rules)
    return known[set_id].title if set_id in known else set_id


def _several(rules: ChosenRules) -> str:
    """Return what the menu says of the chosen overlays; a project may name more than one."""
    labels = {overlay_id: label for label, overlay_id in _labels(rules, is_overlay=True).items()}
    return " + ".join(labels.get(overlay_id, overlay_id) for overlay_id in rules.overlay_ids)


def _overlays_of(rules: ChosenRules, set_id: str) -> tuple[str, ...]:
    """Return the overlays that stay laid over another set: none where their rules contradict its own."""
    known = known_sets(rules)
    if not set_id or any(overlay_id not in known for overlay_id in rules.overlay_ids):
        return ()
    laid = {rule.rule_id for overlay_id in rules.overlay_ids for rule in known[overlay_id].rules}
    return () if laid & {rule.rule_id for rule in known[set_id].rules} else rules.overlay_ids


def _decisions() -> tuple[tuple[str, Decision], ...]:
    return tuple(
        (words, "simple" if decision == "simple" else "guarded") for words, decision in DECISION_OPTIONS.items()
    )
