"""The folder of the Checks tab in which an inspector changes the limits of rules."""

import viser

from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rules import Rule, Side
from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import is_usable, limit_of, with_edit, without_edits
from stair_inspector.files.rule_sets import parse_limit
from stair_inspector.viewer.bridge.widgets import offer
from stair_inspector.viewer.parts.checks.rule_choice import RuleChoice
from stair_inspector.viewer.parts.checks.rule_menus import limit_labels, rule_label, rule_named
from stair_inspector.viewer.parts.checks.summary_html import edits_html
from stair_inspector.viewer.parts.part import Context

CHANGE = "Change the limit"
SIDES: dict[str, Side] = {"minimum": "minimum", "maximum": "maximum"}
_NO_RULE = "no rule set chosen"


class LimitForm:
    """The folder "Change a limit"."""

    def __init__(self, context: Context, choice: RuleChoice) -> None:
        self._desk = context.desk
        self._choice = choice
        # Which limit the field was last filled with: of which set, rule and side.
        self._filled: tuple[str, str, Side, Limit | None] | None = None
        widgets = context.widgets
        with widgets.folder("Change a limit", is_open=False):
            self.rule = widgets.dropdown(
                "Rule", (_NO_RULE,), hint="A click on a result chooses its rule.", on_change=self.choose_rule
            )
            self.side = widgets.dropdown(
                "Side",
                tuple(SIDES),
                chosen="maximum",
                hint="Which of the rule's limits is changed.",
                on_change=lambda _: self.choose_rule(self.rule.value),
            )
            self.limit = widgets.text(
                "New limit", hint="With its unit: 7 3/4 in, 180 mm, 42°, 2 % or 1:48. Empty takes it away."
            )
            self.reason = widgets.text("Why", hint="In one line; it is kept with the change and stands in the report.")
            self._change = widgets.button(
                CHANGE, self.edit, icon=viser.Icon.PENCIL, hint="Of this scan's check; marked as edited everywhere."
            )
            self.edits = widgets.html()
            self._reverts = tuple(
                widgets.button(
                    f"As in the file: {which}",
                    action,
                    icon=viser.Icon.RESTORE,
                    hint="Takes the changes of limits back.",
                    is_quiet=True,
                )
                for which, action in (("this rule", self.revert), ("all rules", self.revert_all))
            )

    def choose_rule(self, option: str) -> None:
        """Write the present limit of a rule into the field, to be changed: of the side that has one."""
        with self._desk.lock:
            # Rules that cannot be used have no limit to show; a row of theirs is chosen to take its change back.
            if is_usable(self._choice.rules):
                self._rule_named(option)
            self._show_limit()

    def open_rule(self, rule: Rule) -> None:
        """Choose the rule of a result that was opened; the desk is held."""
        self.rule.value = rule_label(rule)
        self._show_limit()

    def edit(self) -> None:
        """Change the limit that is chosen, with the reason that is written."""
        rule, side = self._rule_named(str(self.rule.value)), self._side()
        written = str(self.limit.value).strip()
        try:
            limit = parse_limit(written) if written else None
        except ConfigError as error:
            raise ConfigError(f"new limit: {error}") from error
        reason = " ".join(str(self.reason.value).split())
        if not reason:
            raise ConfigError("change a limit: write why, in one line; it stands with the change in every report")
        words = f"{side} of {rule.rule_id} {written or 'none'}"
        self._choice.change(words, lambda rules: with_edit(rules, rule.rule_id, side, limit, reason))
        self.reason.value = ""

    def revert(self) -> None:
        """Give the chosen rule the limits of its file again."""
        # By its id: the rule may be one of a set that cannot be made.
        rule_id = str(self.rule.value).partition(":")[0]
        self._choice.change(f"limits of {rule_id[:80]} as in the file", lambda rules: without_edits(rules, rule_id))

    def revert_all(self) -> None:
        """Give every rule the limits of its file again."""
        self._choice.change("all limits as in the files", without_edits)

    def show(self) -> None:
        """List the rules whose limits can be changed, and the changes; the desk is held."""
        rules = self._choice.rules
        options = limit_labels(rules) or (_NO_RULE,)
        offer(self.rule, options)
        self._show_limit()
        self.edits.content = edits_html(rules.edits)
        for button in self._reverts:
            button.visible = bool(rules.edits)

    def _show_limit(self) -> None:
        """Write the present limit of the chosen rule into the field, unless that is what was written there last."""
        rules = self._choice.rules
        rule = rule_named(rules, str(self.rule.value)) if is_usable(rules) else None
        if rule is None:
            self._filled = None
            self._fill("", is_there=True)
            return
        if self._filled is None or self._filled[:2] != (rules.set_id, rule.rule_id):
            with_limit = [words for words, side in SIDES.items() if limit_of(rule, side) is not None]
            if len(with_limit) == 1:
                self.side.value = with_limit[0]
        side = self._side()
        limit = limit_of(rule, side)
        present = (rules.set_id, rule.rule_id, side, limit)
        if present != self._filled:
            self._filled = present
            self._fill("" if limit is None else limit.as_written, is_there=limit is not None)

    def _fill(self, written: str, *, is_there: bool) -> None:
        """Show the present limit, and whether the button changes it or adds one."""
        self.limit.value = written
        self._change.label = CHANGE if is_there else f"Add a {self.side.value}: there is none"

    def _rule_named(self, label: str) -> Rule:
        rule = rule_named(self._choice.rules, label)
        if rule is None:
            raise ConfigError("change a limit: choose a rule set and a rule first")
        return rule

    def _side(self) -> Side:
        return SIDES.get(str(self.side.value), "maximum")
