"""Arguments that every command has, how they are read, and what is said where one is wrong."""

import contextlib
import io
import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, TypeVar

import tyro
from typing_extensions import Doc

from stair_inspector.errors import ConfigError, WriteError
from stair_inspector.files.settings import DEFAULT_PRESET, find_preset
from stair_inspector.overrules import NAMED_UP
from stair_inspector.params import Params

T = TypeVar("T")
Debug = Annotated[tyro.conf.FlagCreatePairsOff[bool], Doc("Show the traceback of an error, for a bug report.")]

_SIGNED_FLAGS = ("--up", "--overrules.climb", "--overrules.region", "--columns")
"""Flags whose value may begin with a minus sign."""


@dataclass(frozen=True)
class CommonOptions:
    """Options of every command that reads a scan."""

    preset: Annotated[
        str, Doc("Name of a preset (see: stair-inspector presets) or a TOML file; other flags change its values.")
    ] = "default"
    debug: Debug = False
    settings: Annotated[Params, tyro.conf.arg(name="")] = field(default_factory=Params)


def parse_arguments(kind: type[T], command: str, args: list[str], default: T) -> T:
    """Let tyro read the arguments; turn its boxed message into the one line that every error gets."""
    boxed = io.StringIO()
    try:
        with contextlib.redirect_stderr(boxed):
            return tyro.cli(
                kind,
                prog=f"stair-inspector {command}",
                args=_join_negative_directions(args),
                default=default,
                # Every option says what it is by `Doc`: to look for comments would parse the source again for each.
                config=(tyro.conf.OmitSubcommandPrefixes, tyro.conf.HelptextFromCommentsOff),
            )
    except SystemExit as leaving:
        if leaving.code in (0, None):
            raise
        refused = _refused_setting(leaving)
        text = _flatten(boxed.getvalue()) if refused is None else f"{refused}; see --help"
        raise ConfigError(f"{command}: {text}") from leaving


def preset_params(args: list[str]) -> Params:
    """Return the settings that the other flags change: those of the preset that is named, or of the default one."""
    name = value_of(args, "--preset")
    return find_preset(DEFAULT_PRESET if name is None else name).params


def value_of(args: list[str], flag: str) -> str | None:
    """Return the value of a flag that must be known before the others are read; the last one counts."""
    value = None
    for position, word in enumerate(args):
        if word == flag:
            value = args[position + 1] if position + 1 < len(args) else None
        elif word.startswith(f"{flag}="):
            value = word.partition("=")[2]
    return value


def check_folder(folder: Path, flag: str = "-o") -> None:
    """Raise before the work, not after it, when the folder that ``flag`` gave could not be written."""
    try:
        existing = next((parent for parent in (folder, *folder.parents) if parent.exists()), folder)
    except OSError as error:
        raise WriteError(f"{folder}: cannot be written ({error.strerror}); give another folder with {flag}") from error
    if not existing.is_dir():
        raise WriteError(f"{existing}: is a file, not a folder; give another folder with {flag}")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise WriteError(f"{existing}: cannot be written (permission denied); give another folder with {flag}")


def is_answered(command: str, args: list[str], words: str) -> bool:
    """Print the help of a command without options where that is asked for; refuse anything else."""
    if args and args[0] not in ("-h", "--help"):
        raise ConfigError(f"{command}: got {args[0][:60]!r}; this command has no options")
    if args:
        print(f"usage: stair-inspector {command}\n\n{words}")
    return bool(args)


def _refused_setting(leaving: SystemExit) -> ConfigError | None:
    """Return the error with which a setting refused its value: tyro's frame would break its long words."""
    cause: BaseException | None = leaving
    while cause is not None and not isinstance(cause, ConfigError):
        cause = cause.__cause__ or cause.__context__
    return cause


def _flatten(boxed: str) -> str:
    """Return tyro's message as one plain sentence: no frame, no colours, no copy of the help text."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", boxed)
    # Where stdout is not UTF-8, tyro draws its frame with dashes.
    plain = re.sub(r"[╭╮╰╯─│┌┐└┘├┤┬┴┼━┃]+|-{8,}", " ", plain)
    text = " ".join(plain.split())
    for pattern, replacement in (
        (r"\s*For full helptext,.*$", ""),
        (r"\s*Argument helptext:.*$", ""),
        (r"^(Value error|Parsing error|Unrecognized options|Invalid choice|Required options|Missing argument)\s+", ""),
        (r"^Error parsing settings\S*: ", ""),
        (r"^Error parsing (stair|scanner): ", ""),
        (r"^Error parsing (--\S+): ", r"\1: "),
        (r"^Missing from [\w -]+: (-\S+ [^\s,]+|\S+).*$", r"\1 is missing"),
        (r"^Missing value for argument '(\S+)'.*$", r"\1 needs a value"),
        (r"\s*Perhaps you meant: (--[\w.-]+).*$", r"; did you mean \1?"),
        (r"^Unrecognized options: ([^\s,;]+)[^;]*", r"unknown option \1"),
        (r"invalid literal for int\(\) with base 10: ('.*')", r"got \1; give a whole number"),
        (r"could not convert string to float: ('.*')", r"got \1; give a number"),
    ):
        text = re.sub(pattern, replacement, text)
    choice = re.fullmatch(r"invalid choice ('.*') for argument '(\S+)'\. Expected one of \((.*)\)\.?", text)
    if choice is not None:
        text = f"{choice[2]}: got {choice[1]}; give one of {choice[3].replace(chr(39), '')}"
    return text if text.endswith("?") else text.rstrip(".") + "; see --help"


def _join_negative_directions(args: list[str]) -> list[str]:
    """Write ``--up -x`` as ``--up=-x``: a word that begins with a dash would be taken for a flag."""
    joined: list[str] = []
    for word in args:
        is_negative = word in NAMED_UP or re.fullmatch(r"-[\d.][\d.,eE+-]*|-,.*", word) is not None
        if joined and joined[-1] in _SIGNED_FLAGS and word.startswith("-") and is_negative:
            joined[-1] = f"{joined[-1]}={word}"
        else:
            joined.append(word)
    return joined
