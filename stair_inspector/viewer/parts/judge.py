"""The result that is shown, held against the chosen rules: judged again whenever one of the two is another one."""

from stair_inspector.codes import Check, check
from stair_inspector.errors import ConfigError, StairError
from stair_inspector.files.chosen_rules import ChosenRules, rule_set_of
from stair_inspector.model import Inspection
from stair_inspector.viewer.parts.desk import Desk
from stair_inspector.viewer.scene.step_marks import marks_of
from stair_inspector.viewer.state.editor import Editor


class Judge:
    """Holds the check of the shown result. Callers hold the desk's lock.

    ``check`` is None where no rules are chosen, or where they cannot be used: ``error`` is the reason then, else empty.
    The marks of steps outside a limit are on the desk.
    """

    def __init__(self, desk: Desk, editor: Editor) -> None:
        self._desk = desk
        self._editor = editor
        self._judged: tuple[Inspection, ChosenRules] | None = None
        self.check: Check | None = None
        self.error = ""

    def judge(self) -> None:
        """Hold the present result against the chosen rules; what cannot be used is said and not applied."""
        inspection, rules = self._desk.inspection, self._editor.work.rules
        if self._judged is not None and self._judged[0] is inspection and self._judged[1] == rules:
            return
        self.check, self.error = None, ""
        try:
            made = rule_set_of(rules)
            if made is not None and inspection is not None:
                self.check = check(inspection, made, rules.decision)
        except StairError as error:
            self.error = str(error)
        self._judged = None if inspection is None else (inspection, rules)
        self._desk.marks = marks_of(inspection, self.check)

    def checked(self) -> Check | None:
        """Return the check of the result that is shown, for its files.

        Raises
        ------
        ConfigError
            Rules are chosen that cannot be used: a file without its check would say less than it seems to.
        """
        self.judge()
        if self.error:
            raise ConfigError(f"{self.error}; or choose no rule set")
        return self.check
