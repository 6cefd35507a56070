"""The Checks tab: which rules, what the check comes to, and the limits that an inspector changes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from stair_inspector.viewer.bridge.notices import from_page
from stair_inspector.viewer.parts.checks.checks_html import (
    edits_html,
    not_assessed_html,
    rules_html,
    steps_html,
    summary_html,
)

NO_RULES = "none: measure only"
NO_OVERLAY = "none"
DECISION_OPTIONS = {"guarded: U counts": "guarded", "simple: the value alone": "simple"}
"""The decision rules by what the menu says; in full they stand with the result."""
SIDES = ("minimum", "maximum")
CHANGE = "Change the limit"
_NO_RULE = "no rule set chosen"


@dataclass(frozen=True)
class ChecksActions:
    """What the Checks tab calls."""

    on_rules: Callable[[str], None]
    on_overlay: Callable[[str], None]
    on_decision: Callable[[str], None]
    on_rule: Callable[[str], None]
    on_edit: Callable[[], None]
    on_revert: Callable[[], None]
    on_revert_all: Callable[[], None]
    on_own_file: Callable[[Any], None]
    on_copy: Callable[[], None]
    on_forget_file: Callable[[], None]


class ChecksTab:
    """The controls of the tab."""

    def __init__(self, gui: viser.GuiApi, actions: ChecksActions) -> None:
        self.rules: Any = gui.add_dropdown(
            "Rule set",
            (NO_RULES,),
            initial_value=NO_RULES,
            hint="By country, with edition and variant; own files are listed last. Ctrl+A and typing searches.",
        )
        self.rules.on_update(from_page(actions.on_rules, lambda: self.rules.value))
        self.overlay: Any = gui.add_dropdown(
            "Overlay", (NO_OVERLAY,), initial_value=NO_OVERLAY, hint="Rules to be held against beside those of the set."
        )
        self.overlay.on_update(from_page(actions.on_overlay, lambda: self.overlay.value))
        self.decision: Any = gui.add_dropdown(
            "Decision rule",
            tuple(DECISION_OPTIONS),
            initial_value=next(iter(DECISION_OPTIONS)),
            hint="Guarded: a value nearer to its limit than its uncertainty U is close. Simple: U is not heeded.",
        )
        self.decision.on_update(from_page(actions.on_decision, lambda: self.decision.value))
        self.summary = gui.add_html(summary_html(None, ""))
        self.by_rule = gui.add_html(rules_html(None, None, None))
        self.by_step = gui.add_html(steps_html(None, None, None, None))
        self._add_edits(gui, actions)
        self._add_own(gui, actions)
        self.not_assessed = gui.add_html(not_assessed_html(None))

    def offer_rules(self, sets: tuple[str, ...], chosen: str, overlays: tuple[str, ...], overlay: str) -> None:
        """List the rule sets and overlays, and show the chosen ones."""
        for menu, options, value in (
            (self.rules, (NO_RULES, *sets), chosen),
            (self.overlay, (NO_OVERLAY, *overlays), overlay),
        ):
            if tuple(menu.options) != options:
                menu.options = options
            menu.value = value

    def offer_limits(self, rules: tuple[str, ...], chosen: str) -> None:
        """List the rules whose limits can be changed."""
        options = rules or (_NO_RULE,)
        if tuple(self.rule.options) != options:
            self.rule.options = options
        self.rule.value = chosen if chosen in options else options[0]

    def _add_edits(self, gui: viser.GuiApi, actions: ChecksActions) -> None:
        with gui.add_folder("Change a limit", expand_by_default=False):
            self.rule: Any = gui.add_dropdown(
                "Rule", (_NO_RULE,), initial_value=_NO_RULE, hint="A click on a result chooses its rule."
            )
            self.rule.on_update(from_page(actions.on_rule, lambda: self.rule.value))
            self.side: Any = gui.add_dropdown("Side", SIDES, initial_value=SIDES[1])
            self.side.on_update(from_page(lambda: actions.on_rule(self.rule.value)))
            self.limit: Any = gui.add_text(
                "New limit", "", hint="With its unit: 7 3/4 in, 180 mm, 42°, 2 % or 1:48. Empty takes it away."
            )
            self.reason: Any = gui.add_text(
                "Why", "", hint="In one line; it is kept with the change and stands in the report."
            )
            self._change: Any = gui.add_button(CHANGE, icon=viser.Icon.PENCIL)
            self._change.on_click(lambda _: actions.on_edit())
            self.edits = gui.add_html(edits_html(()))
            self._revert: Any = gui.add_button("As in the file: this rule", icon=viser.Icon.RESTORE, color="gray")
            self._revert.on_click(lambda _: actions.on_revert())
            self._revert_all: Any = gui.add_button("As in the file: all rules", icon=viser.Icon.RESTORE, color="gray")
            self._revert_all.on_click(lambda _: actions.on_revert_all())

    def show_limit(self, written: str, *, is_there: bool = True) -> None:
        """Show the present limit of the chosen rule and side, and whether the button changes it or adds one."""
        self.limit.value = written
        self._change.label = CHANGE if is_there else f"Add a {self.side.value}: there is none"

    def show_reverts(self, *, has_edits: bool) -> None:
        """Offer to take changes back where there are some."""
        self._revert.visible = self._revert_all.visible = has_edits

    def _add_own(self, gui: viser.GuiApi, actions: ChecksActions) -> None:
        with gui.add_folder("Own rule file", expand_by_default=False):
            self.own: Any = gui.add_upload_button(
                "Load a rule file",
                icon=viser.Icon.FOLDER_OPEN,
                mime_type=".toml",
                hint="A TOML file as those of the program; it is kept in the project.",
            )
            self.own.on_upload(lambda _: actions.on_own_file(self.own.value))
            copy = gui.add_button(
                "Save the file of this set", icon=viser.Icon.DOWNLOAD, hint="To copy, change and load; without changes."
            )
            copy.on_click(lambda _: actions.on_copy())
            forget = gui.add_button("Forget this own set", icon=viser.Icon.TRASH, color="gray")
            forget.on_click(lambda _: actions.on_forget_file())
