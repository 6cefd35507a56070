"""``stair-inspector completion``: lets a shell complete commands and their options."""

import contextlib
import importlib
import io
import re

from stair_inspector.cli.arguments import is_answered
from stair_inspector.cli.output import say

_WITH_OPTIONS = ("view", "measure", "check", "compare", "verify", "rules", "simulate")
_WITHOUT = ("presets", "quantities", "completion")
_WORDS = """\
Prints what bash needs to complete commands, options and their values. For bash:

  mkdir -p ~/.local/share/bash-completion/completions
  stair-inspector completion > ~/.local/share/bash-completion/completions/stair-inspector

For zsh, in ~/.zshrc, with the script in a file of any name:

  autoload -U +X bashcompinit && bashcompinit && source FILE
"""
_DISPATCH = """\
_stair_inspector() {{
  local command="${{COMP_WORDS[1]}}"
  if [ "$COMP_CWORD" -le 1 ]; then
    COMPREPLY=($(compgen -W "{commands}" -- "$command") $(compgen -f -- "$command"))
    return
  fi
  COMPREPLY=()
  case "$command" in
    {cases}) "_tyro_stair_inspector_$command" ;;
  esac
  # Where no option fits, the word is a file.
  [ -n "${{COMPREPLY[*]}}" ] || COMPREPLY=($(compgen -f -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}
complete -o filenames -F _stair_inspector stair-inspector
"""


def run(args: list[str]) -> int:
    """Print the script; return the exit code."""
    if is_answered("completion", args, _WORDS.rstrip()):
        return 0
    cases, commands = "|".join(_WITH_OPTIONS), " ".join((*_WITH_OPTIONS, *_WITHOUT))
    say("\n".join([*map(_script_of, _WITH_OPTIONS), _DISPATCH.format(cases=cases, commands=commands)]))
    return 0


def _script_of(command: str) -> str:
    """Return tyro's functions for the options of one command, without the lines that bind them to its name."""
    written = io.StringIO()
    with contextlib.redirect_stdout(written), contextlib.suppress(SystemExit):
        importlib.import_module(f"stair_inspector.cli.{command}").run(["--tyro-print-completion", "bash"])
    functions, _, _ = written.getvalue().partition("\ncomplete -F ")
    return re.sub(r"^# AUTOMATICALLY.*\n", "", functions)
