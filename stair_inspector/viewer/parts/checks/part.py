"""The Checks tab: which rules, what the check of the result comes to, and the marks of steps in the scene."""

import dataclasses

import viser

from stair_inspector.codes import Check
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules, with_fitting, with_set
from stair_inspector.units import Unit
from stair_inspector.viewer.bridge.shortcuts import Command
from stair_inspector.viewer.bridge.widgets import offer
from stair_inspector.viewer.parts.checks.checks_html import RULE, rules_html, steps_html
from stair_inspector.viewer.parts.checks.limits import LimitForm
from stair_inspector.viewer.parts.checks.own_rules import OwnRules
from stair_inspector.viewer.parts.checks.rule_choice import RuleChoice
from stair_inspector.viewer.parts.checks.rule_menus import (
    DECISION_OPTIONS,
    NO_OVERLAY,
    NO_RULES,
    chosen_label,
    id_of,
    labels_of,
    overlays_beside,
    rule_set_title,
    several_label,
)
from stair_inspector.viewer.parts.checks.summary_html import not_assessed_html, summary_html
from stair_inspector.viewer.parts.part import Context, PagePart
from stair_inspector.viewer.parts.table import pick_row
from stair_inspector.viewer.state.change import PageChange


class ChecksPart(PagePart):
    """Holds the result that is shown against the chosen rules, again at every result."""

    title = "Checks"
    icon = viser.Icon.CHECKLIST
    depends_on = frozenset(
        {
            PageChange.WORK,
            PageChange.RESULT,
            PageChange.SELECTION,
            PageChange.UNIT,
            PageChange.COLORS,
            PageChange.CLOUD,
            PageChange.THEME,
        }
    )

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._judge = context.judge
        self._choice = choice = RuleChoice(context)
        # The rule that is opened, by its number, and the set that it is one of.
        self._opened: int | None = None
        self._opened_of = (choice.rules.set_id, choice.rules.files)
        # What the results by rule were last drawn of: they may be many, and a choice of a step does not change them.
        self._drawn: tuple[Check | None, int | None, Unit] | None = None
        widgets = context.widgets
        self.rules = widgets.dropdown(
            "Rule set",
            (NO_RULES,),
            hint="By country, with edition and variant; own files are listed last. Ctrl+A and typing searches.",
            on_change=self.choose,
        )
        self.overlay = widgets.dropdown(
            "Overlay",
            (NO_OVERLAY,),
            hint="Rules to be held against beside those of the set.",
            on_change=self.choose_overlay,
        )
        self.decision = widgets.dropdown(
            "Decision rule",
            tuple(DECISION_OPTIONS),
            hint="Guarded: a value nearer to its limit than its uncertainty U is close. Simple: U is not heeded.",
            on_change=self.choose_decision,
        )
        self.summary = widgets.html()
        self.by_rule = widgets.html()
        self.by_step = widgets.html()
        self.limits = LimitForm(context, choice)
        self.own_rules = OwnRules(context, choice)
        self.not_assessed = widgets.html()
        self._orders = widgets.orders("Picked result", self.obey)

    def show(self, what: frozenset[PageChange]) -> None:
        """Show which rules are chosen, and what the check comes to."""
        if PageChange.WORK in what:
            self._show_menus()
            self.limits.show()
        self._show_results()

    def commands(self) -> tuple[Command, ...]:
        """Return the key that goes from step to step outside a limit."""
        return (Command("Next step outside a limit", self.next_outside, "N"),)

    def choose(self, label: str) -> None:
        """Choose the rule set of a label of the menu, or none; changed limits stay with the set that is left."""

        def changed(rules: ChosenRules) -> ChosenRules:
            if label == chosen_label(rules):
                return rules
            set_id = "" if label == NO_RULES else id_of(rules, label, "rule set")
            return with_set(rules, set_id, overlays_beside(rules, set_id))

        self._choice.change_and_tell(f"rules {label[:60]}", changed)

    def choose_overlay(self, label: str) -> None:
        """Lay the overlay of a label over the set, or none; changes of its limits go with it."""

        def changed(rules: ChosenRules) -> ChosenRules:
            if label == several_label(rules):
                return rules
            overlay_ids = () if label == NO_OVERLAY else (id_of(rules, label, "overlay"),)
            if overlay_ids and not rules.set_id:
                raise ConfigError("overlay: choose a rule set first")
            return with_fitting(dataclasses.replace(rules, overlay_ids=overlay_ids), rules.edits)

        self._choice.change_and_tell(f"overlay {label[:60]}", changed)

    def choose_decision(self, option: str) -> None:
        """Choose whether verdicts heed the uncertainty."""
        decision = next((known for words, known in DECISION_OPTIONS.items() if words == option), None)
        if decision is None:
            raise ConfigError(f"decision rule: got {str(option)[:40]!r}; choose one of the menu")
        self._choice.change(f"decision {decision}", lambda rules: dataclasses.replace(rules, decision=decision))

    def next_outside(self) -> None:
        """Choose the next step upwards that is outside a limit, after the last one the first."""
        desk = self._desk
        with desk.lock:
            marked = sorted(desk.marks)
            if not marked:
                raise ConfigError("next step outside a limit: there is none, or no rule set is chosen")
            here = desk.selected or 0
            desk.select(next((step_id for step_id in marked if step_id > here), marked[0]))

    def obey(self, message: str) -> None:
        """Do what a click on a row asks for: open its rule, or choose its step."""
        word, _, number = str(message).partition(":")[0].partition(" ")
        if word == RULE:
            self.open_rule(number)
        else:
            pick_row(self._desk, message)

    def open_rule(self, number: str) -> None:
        """Open the rule of a number, from 1, or close it; it becomes the one whose limit can be changed."""
        check = self._judge.check
        rules = check.rule_set.rules if check is not None else ()
        if not number.isdecimal() or len(number) > 6 or not 1 <= int(number) <= len(rules):
            raise ConfigError(f"rule: got {number[:40]!r}; choose a row of the list")
        with self._desk.lock, self._desk.client.atomic():
            self._opened = None if self._opened == int(number) else int(number)
            rule = rules[int(number) - 1]
            if rule.from_scan != "no":
                self.limits.open_rule(rule)
            self._show_results()

    def _show_results(self) -> None:
        desk, check = self._desk, self._judge.check
        rules = self._choice.rules
        if self._opened_of != (rules.set_id, rules.files):
            self._opened, self._opened_of = None, (rules.set_id, rules.files)
        self.summary.content = summary_html(check, self._judge.error, rule_set_title(rules, rules.set_id))
        if self._drawn is None or self._drawn[0] is not check or self._drawn[1:] != (self._opened, desk.unit):
            self._drawn = (check, self._opened, desk.unit)
            self.by_rule.content = rules_html(check, self._opened, self._orders, desk.unit)
        self.by_step.content = steps_html(desk.inspection, check, desk.selected, self._orders, desk.unit)
        self.not_assessed.content = not_assessed_html(check)
        if desk.shown is not None:
            desk.stage.show_marks(desk.marks, desk.palette)

    def _show_menus(self) -> None:
        rules = self._choice.rules
        sets, overlays = (tuple(labels_of(rules, is_overlay=is_overlay)) for is_overlay in (False, True))
        several, chosen = several_label(rules), chosen_label(rules)
        named = sets if chosen in (NO_RULES, *sets) else (chosen, *sets)
        offered = (*overlays, several) if several and several not in overlays else overlays
        for menu, options, value in (
            (self.rules, (NO_RULES, *named), chosen),
            (self.overlay, (NO_OVERLAY, *offered), several or NO_OVERLAY),
        ):
            offer(menu, options, value)
        self.decision.value = next(words for words, each in DECISION_OPTIONS.items() if each == rules.decision)
