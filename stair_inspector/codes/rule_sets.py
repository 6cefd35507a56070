"""Rule sets: the rules of one edition of a code, what a user has changed of them, and overlays."""

from dataclasses import dataclass, replace
from typing import get_args

from stair_inspector.codes.limits import Limit
from stair_inspector.codes.rules import GRADES, Rule, RuleEdit, Side
from stair_inspector.codes.texts import check_id, check_member, check_plain_text
from stair_inspector.errors import ConfigError

OWN_FILE = "user's own file, not a set that comes with the program"
"""What is said of a rule set whose file the program does not bring."""


@dataclass(frozen=True, slots=True)
class RuleSet:
    """A rule set of one edition and variant.

    ``file`` and ``sha256`` (hex) are the name and the hash of the file it was read from; ``edits`` what was changed
    since, oldest first; ``overlays`` what was laid over it, in words. ``not_assessed`` are sentences on what the code
    limits and no scan shows. An overlay holds rules to be used beside those of a full set. ``is_shipped``
    tells that the file is one that comes with the program, byte for byte.
    """

    set_id: str
    name: str
    edition: str
    variant: str
    source: str
    rules: tuple[Rule, ...]
    not_assessed: tuple[str, ...] = ()
    file: str = ""
    sha256: str = ""
    edits: tuple[RuleEdit, ...] = ()
    overlays: tuple[str, ...] = ()
    is_overlay: bool = False
    is_shipped: bool = False

    def __post_init__(self) -> None:
        check_id("set id", self.set_id)
        for name in ("name", "edition", "source"):
            check_plain_text(f"rule set {self.set_id}: {name}", getattr(self, name))
        check_plain_text(f"rule set {self.set_id}: variant", self.variant, may_be_empty=True)
        check_plain_text(f"rule set {self.set_id}: the name of its file", self.file, may_be_empty=True)
        for text in self.not_assessed:
            check_plain_text(f"rule set {self.set_id}: not_assessed", text)
        if not self.rules:
            raise ConfigError(f"rule set {self.set_id}: has no rule; give at least one")
        seen: set[str] = set()
        for rule in self.rules:
            if rule.rule_id in seen:
                raise ConfigError(f"rule set {self.set_id}: rule {rule.rule_id} is there twice; rename or remove one")
            seen.add(rule.rule_id)

    @property
    def is_edited(self) -> bool:
        """Whether a user has changed a limit."""
        return bool(self.edits)

    @property
    def edited_words(self) -> str:
        """Whether a user has changed a limit, in words; of a file of the user's own that it is one."""
        answer = "yes" if self.is_edited else "no"
        return answer if self.is_shipped else f"{OWN_FILE}; limits edited afterwards: {answer}"

    @property
    def n_changed(self) -> int:
        """How many limits are other ones than those of the files."""
        sides = dict.fromkeys((edit.rule_id, edit.side) for edit in self.edits)
        return sum(self.edit_of(*side) is not None for side in sides)

    @property
    def grades(self) -> str:
        """The grades of its records, best first: ``P``, ``PS``, ``SG`` ..."""
        return "".join(grade for grade in GRADES if any(rule.grade == grade for rule in self.rules))

    @property
    def title(self) -> str:
        """Name, edition and variant in one line."""
        return ", ".join(part for part in (self.name, self.edition, self.variant) if part)

    def rule(self, rule_id: str) -> Rule:
        """Return the rule with this id.

        Raises
        ------
        ConfigError
            There is none.
        """
        for rule in self.rules:
            if rule.rule_id == rule_id:
                return rule
        known = ", ".join(rule.rule_id for rule in self.rules)
        raise ConfigError(f"rule set {self.set_id}: has no rule {rule_id[:80]!r}; its rules are {known}")

    def edit_of(self, rule_id: str, side: Side) -> RuleEdit | None:
        """Return what the changes of a limit come to: from the file's to the present one, with the last reason.

        None where the limit is that of the file, also after it was changed and changed back.
        """
        own = [edit for edit in self.edits if (edit.rule_id, edit.side) == (rule_id, side)]
        if not own or own[0].before == own[-1].after:
            return None
        return replace(own[-1], before=own[0].before)

    def is_changed(self, rule_id: str) -> bool:
        """Whether a limit of a rule is another one than that of the file."""
        return any(self.edit_of(rule_id, side) is not None for side in get_args(Side))

    def is_reported_in_file(self, rule_id: str) -> bool:
        """Whether the file has a rule as reported only, also where a user's limit has made it a judged one.

        Raises
        ------
        ConfigError
            There is no such rule.
        """
        rule = self.rule(rule_id)
        own = [edit for edit in self.edits if edit.rule_id == rule_id]
        return own[0].is_of_reported if own else rule.severity == "report_only"


def edited(rule_set: RuleSet, rule_id: str, side: Side, limit: Limit | None, reason: str) -> RuleSet:
    """Return the rule set with one limit changed and the change recorded.

    Changing a limit twice keeps both records, so that the list tells what happened. The same limit again is no edit.
    A rule that is reported only is judged, as a limit, while it has a limit of the user's: nobody gives one for less.

    Parameters
    ----------
    rule_set : RuleSet
    rule_id : str
    side : "minimum" or "maximum"
    limit : Limit or None
        The new one; None takes the limit away.
    reason : str
        Why, in the user's words.

    Raises
    ------
    ConfigError
        Unknown rule, no reason, a unit that does not fit, or minimum above maximum.
    """
    check_member("side", side, get_args(Side))
    rule = rule_set.rule(rule_id)
    check_plain_text(f"rule {rule_id}: reason", reason)
    before = rule.minimum if side == "minimum" else rule.maximum
    if before == limit:
        return rule_set
    is_of_reported = rule_set.is_reported_in_file(rule_id)
    after = replace(
        rule_set, edits=(*rule_set.edits, RuleEdit(rule_id, side, before, limit, reason, is_of_reported=is_of_reported))
    )
    severity = rule.severity
    if is_of_reported:
        changes = (after.edit_of(rule_id, each) for each in get_args(Side))
        is_judged = any(change is not None and change.after is not None for change in changes)
        severity = "limit" if is_judged else "report_only"
    minimum, maximum = (limit, rule.maximum) if side == "minimum" else (rule.minimum, limit)
    changed = replace(rule, minimum=minimum, maximum=maximum, severity=severity)
    return replace(after, rules=tuple(changed if each.rule_id == rule_id else each for each in rule_set.rules))


def overlaid(base: RuleSet, overlay: RuleSet) -> RuleSet:
    """Return the base with the overlay's rules beside its own.

    Raises
    ------
    ConfigError
        ``overlay`` is a full set, or both have a rule of one id.
    """
    if not overlay.is_overlay:
        raise ConfigError(f"rule set {overlay.set_id} is a full set, no overlay; check against it by itself")
    words = overlay.title + f" ({overlay.set_id}" + (f", SHA-256 {overlay.sha256})" if overlay.sha256 else ")")
    if not overlay.is_shipped:
        words += f", {OWN_FILE}"
    countries = [each.set_id.partition("-")[0] for each in (base, overlay)]
    if base.is_shipped and overlay.is_shipped and countries[0] != countries[1]:
        words += f": made for sets {countries[1]}-..., not for {base.set_id}; take it as advice of another country"
    return replace(
        base,
        rules=base.rules + overlay.rules,
        not_assessed=tuple(dict.fromkeys(base.not_assessed + overlay.not_assessed)),
        edits=base.edits + overlay.edits,
        overlays=(*base.overlays, words),
    )
