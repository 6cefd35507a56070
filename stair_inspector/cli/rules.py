"""``stair-inspector rules``: which rule sets there are, and what stands in one."""

from dataclasses import dataclass
from typing import Annotated

import tyro
from typing_extensions import Doc

from stair_inspector.cli.arguments import Debug, parse_arguments
from stair_inspector.cli.output import say
from stair_inspector.errors import ConfigError


@dataclass(frozen=True)
class ListRules:
    """List the rule sets that come with the program: id, grades of the records, edition, name, hash of the file."""

    show: Annotated[str, tyro.conf.arg(metavar="ID|FILE"), Doc("Print all records of one rule set instead.")] = ""
    toml: Annotated[
        str, tyro.conf.arg(metavar="ID"), Doc("Print the file of one rule set instead, to copy and change it.")
    ] = ""
    debug: Debug = False


def run(args: list[str]) -> int:
    """List the rule sets, or print one; return the exit code."""
    options = parse_arguments(ListRules, "rules", args, ListRules())
    if options.show and options.toml:
        raise ConfigError("rules: got --show and --toml; give one of them")
    from stair_inspector.files.rule_sets import find_rule_set, list_rule_sets, rule_set_path
    from stair_inspector.files.toml import read_toml_bytes
    from stair_inspector.writers.text import rule_set_text, rule_sets_text

    if options.toml:
        # Read as a rule set first: what is printed can be used.
        find_rule_set(options.toml)
        say(read_toml_bytes(rule_set_path(options.toml)).decode("utf-8").rstrip("\n"))
    elif options.show:
        say(rule_set_text(find_rule_set(options.show)))
    else:
        say(rule_sets_text(list_rule_sets()))
    return 0
