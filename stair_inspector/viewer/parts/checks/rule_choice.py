"""Changing which rules a result is held against: each change refuses by itself what cannot be used."""

from collections.abc import Callable

from stair_inspector.errors import ConfigError
from stair_inspector.files.chosen_rules import ChosenRules
from stair_inspector.viewer.parts.checks.rule_menus import what_became
from stair_inspector.viewer.parts.part import Context
from stair_inspector.viewer.state.change import PageChange
from stair_inspector.viewer.state.work import Changes, Work


class RuleChoice:
    """The chosen rules of the work, with the limits that were changed."""

    def __init__(self, context: Context) -> None:
        self._desk = context.desk
        self._editor = context.editor

    @property
    def rules(self) -> ChosenRules:
        """The choice as it stands."""
        return self._editor.work.rules

    def change(self, words: str, change: Callable[[ChosenRules], ChosenRules]) -> None:
        """Change the choice; where that is refused, the menus say again what is kept."""

        def changed(work: Work) -> Changes:
            return {"rules": change(work.rules)}

        try:
            self._editor.edit(words, changed)
        except ConfigError:
            self._desk.changed(PageChange.WORK)
            raise

    def change_and_tell(self, words: str, change: Callable[[ChosenRules], ChosenRules]) -> None:
        """Change the choice, and say what became of changed limits and overlays that were not asked for."""
        before = self.rules
        self.change(words, change)
        told = what_became(before, self.rules)
        if told:
            self._desk.notices.tell("Changed limits and overlays", told)
