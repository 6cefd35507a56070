"""Rule sets as TOML: those that come with the program, and a user's own."""

import functools
import hashlib
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

from stair_inspector.codes.limits import UNITS, Limit
from stair_inspector.codes.rule_sets import RuleSet
from stair_inspector.codes.rules import Condition, Rule
from stair_inspector.codes.texts import is_plain_line
from stair_inspector.errors import ConfigError, brief
from stair_inspector.files.paths import static_configs
from stair_inspector.files.toml import check_keys, parse_toml, read_toml_bytes
from stair_inspector.files.typed import split_typed

_SET_KEYS = ("id", "name", "edition", "variant", "source", "overlay", "not_assessed", "rules")
_RULE_KEYS = tuple("id" if item.name == "rule_id" else item.name for item in fields(Rule))
_OPTIONAL = ("variant", "overlay", "not_assessed", "minimum", "maximum", "applies", "note", "only_where")
_LIMIT = re.compile(r"[0-9][0-9 ./]*")
_COMMA = re.compile(r"(?<=[0-9]),(?=[0-9])")
_MOST_RULES = 1000
_MOST_BYTES = 300_000


def read_rule_set(path: Path) -> RuleSet:
    """Read a rule set; its file's name and SHA-256 go with it.

    Raises
    ------
    ConfigError
        Unreadable, no TOML, an unknown key (the nearest known name is given), a missing one, a limit that is none, or
        two rules of one id.
    """
    _check_name(str(path))
    return parse_rule_set(read_toml_bytes(path), str(path))


def parse_rule_set(data: bytes, place: str) -> RuleSet:
    """Read a rule set from the bytes of its file, as an upload gives them; ``place`` is its name, for the messages.

    Raises
    ------
    ConfigError
        As :func:`read_rule_set`, a file larger than 300 kB, or the id of a set that comes with the program in a file
        that is not that set's.
    """
    _check_name(place)
    if len(data) > _MOST_BYTES:
        raise ConfigError(f"{place}: larger than {_MOST_BYTES // 1000} kB, which no rule file is")
    values = parse_toml(data, place)
    check_keys(place, values, _SET_KEYS)
    _check_present(place, values, _SET_KEYS)
    records = values["rules"]
    if not isinstance(records, list) or not all(isinstance(record, dict) for record in records):
        raise ConfigError(f"{place}: rules: got {brief(records)}; write each rule as a table [[rules]]")
    if len(records) > _MOST_RULES:
        raise ConfigError(f"{place}: holds {len(records)} rules; the most are {_MOST_RULES}")
    not_assessed = values.get("not_assessed", [])
    if not isinstance(not_assessed, list):
        raise ConfigError(f"{place}: not_assessed: got {brief(not_assessed)}; give a list of texts in quotes")
    is_overlay = values.get("overlay", False)
    if not isinstance(is_overlay, bool):
        raise ConfigError(f"{place}: overlay: got {brief(is_overlay)}; give true or false")
    sha256 = hashlib.sha256(data).hexdigest()
    shipped = _shipped_hashes()
    if isinstance(values["id"], str) and shipped.get(values["id"], sha256) != sha256:
        raise ConfigError(
            f"{place}: the id {values['id']!r} is that of a set that comes with the program; give the file another id"
        )
    rules = tuple(_to_rule(f"{place}: rule {number}", record) for number, record in enumerate(records, 1))
    try:
        return RuleSet(
            set_id=values["id"],
            name=values["name"],
            edition=values["edition"],
            variant=values.get("variant", ""),
            source=values["source"],
            rules=rules,
            not_assessed=tuple(not_assessed),
            file=Path(place).name,
            sha256=sha256,
            is_overlay=is_overlay,
            is_shipped=values["id"] in shipped,
        )
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error


def list_rule_sets() -> list[RuleSet]:
    """Return the rule sets that come with the program, by id."""
    return [read_rule_set(path) for _, path in sorted(_shipped().items())]


def find_rule_set(name_or_file: str) -> RuleSet:
    """Return the rule set with this id, or the one in this TOML file.

    Raises
    ------
    ConfigError
        Neither a known id nor a readable rule file; the nearest known id is named.
    """
    return read_rule_set(rule_set_path(name_or_file))


def rule_set_path(name_or_file: str) -> Path:
    """Return the file of the rule set with this id, or the file that is named.

    Raises
    ------
    ConfigError
        No known id, and no name of a TOML file.
    """
    if name_or_file.lower().endswith(".toml") or "/" in name_or_file or "\\" in name_or_file:
        return Path(name_or_file)
    known = _shipped()
    check_keys("rules", [name_or_file], known, what="rule set")
    return known[name_or_file]


def parse_limit(text: str) -> Limit:
    """Return a limit from its words: ``7 3/4 in``, ``26 cm``, ``42 deg`` or ``42°``, ``2 %``, ``1:48``, ``18``.

    ``7¾"`` is 7 3/4 in as well.

    Raises
    ------
    ConfigError
        It is no number with a known unit.
    """
    if not isinstance(text, str):
        raise ConfigError(f"got {brief(text)}; write the limit in quotes with its unit, as '7 3/4 in'")
    number, unit = split_typed(text)
    if number.startswith("1:") and not unit:
        return Limit.of(number, "slope")
    if _COMMA.search(number) is not None:
        raise ConfigError(
            f"got {brief(text)}; write decimals with a point, as '180.5 mm', and thousands without a sign"
        )
    if _LIMIT.fullmatch(number) is None:
        raise ConfigError(
            f"got {brief(text)}; write the limit with its unit, as '7 3/4 in', '26 cm', '42 deg' or '1:48'"
        )
    unit = unit or "count"
    if unit == "count" and not number.isdecimal():
        raise ConfigError(f"got {brief(text)}; add a unit, as '{number[:40]} in' or '180 mm'")
    if unit not in UNITS or unit == "slope":
        check_keys("unit", [unit], [known for known in UNITS if known not in ("slope", "count")], what="unit")
    return Limit.of(number, unit)


def _shipped() -> dict[str, Path]:
    return {path.stem: path for path in (static_configs() / "codes").glob("*.toml")}


@functools.cache
def _shipped_hashes() -> dict[str, str]:
    """Return the SHA-256 of the file of each set that comes with the program, by id."""
    return {set_id: hashlib.sha256(path.read_bytes()).hexdigest() for set_id, path in _shipped().items()}


def _check_name(name: str) -> None:
    """Raise ConfigError for a name that a terminal or a report would show as another."""
    if not is_plain_line(name):
        raise ConfigError(f"rule file {ascii(name)[:200]}: its name holds a control character; rename the file")


def _check_present(place: str, values: dict[str, Any], keys: tuple[str, ...]) -> None:
    for key in keys:
        if key not in values and key not in _OPTIONAL:
            raise ConfigError(f"{place}: {key} is missing; add it")


def _to_rule(place: str, record: dict[str, Any]) -> Rule:
    # The name tells more than the number, once it is known to be one.
    if isinstance(record.get("id"), str):
        place = f"{place} ({record['id'][:80]!r})"
    check_keys(place, record, _RULE_KEYS)
    _check_present(place, record, _RULE_KEYS)
    try:
        return Rule(
            rule_id=record["id"],
            clause=record["clause"],
            term=record["term"],
            quantity=record["quantity"],
            statistic=record["statistic"],
            minimum=_to_limit("minimum", record),
            maximum=_to_limit("maximum", record),
            severity=record["severity"],
            from_scan=record["from_scan"],
            grade=record["grade"],
            applies=record.get("applies", ""),
            note=record.get("note", ""),
            only_where=_to_condition(place, record.get("only_where")),
        )
    except ConfigError as error:
        text = str(error)
        raise ConfigError(text if text.startswith(place) else f"{place}: {text}") from error


def _to_limit(key: str, record: dict[str, Any]) -> Limit | None:
    if key not in record:
        return None
    try:
        return parse_limit(record[key])
    except ConfigError as error:
        raise ConfigError(f"{key}: {error}") from error


def _to_condition(place: str, value: Any) -> Condition | None:
    if value is None:
        return None
    if not isinstance(value, dict):
        raise ConfigError(f"only_where: got {brief(value)}; write it as {{ quantity = 'going', below = '11 in' }}")
    check_keys(f"{place}: only_where", value, ("quantity", "below"))
    _check_present(f"{place}: only_where", value, ("quantity", "below"))
    try:
        return Condition(value["quantity"], parse_limit(value["below"]))
    except ConfigError as error:
        text = str(error)
        raise ConfigError(text if text.startswith("only_where") else f"only_where: {text}") from error
