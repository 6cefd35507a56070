"""A shell completes commands, options and their values."""

import shutil
import subprocess

import pytest

from stair_inspector.cli import COMMANDS, main

bash = pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "script"
    with pytest.MonkeyPatch.context() as patch:
        said = []
        patch.setattr("stair_inspector.cli.completion.say", said.append)
        assert main(["completion"]) == 0
    path.write_text(said[0], encoding="utf-8")
    return path


def completed(script, *words):
    """What bash offers for the last of the words."""
    code = (
        'source "$1"; shift; COMP_WORDS=(stair-inspector "$@"); COMP_CWORD=$#; _stair_inspector; '
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "-c", code, "bash", str(script), *words], capture_output=True, text=True, cwd=script.parent, check=True
    )
    assert done.stderr == ""
    return set(done.stdout.split())


@bash
def test_commands_options_values_and_files_are_completed(script):
    assert set(COMMANDS) <= completed(script, "")
    assert completed(script, "me") == {"measure"}
    assert completed(script, "measure", "--levels.e") == {"--levels.eps-m"}
    assert completed(script, "measure", "scan.ply", "--levels.m") == {"--levels.min-points"}
    assert completed(script, "check", "--method", "") == {"survey", "paper"}
    assert completed(script, "simulate", "--stair.n-r") == {"--stair.n-risers"}
    assert completed(script, "measure", "scr") == {"script"}
    assert completed(script, "presets", "scr") == {"script"}


@bash
def test_only_the_program_itself_is_bound(script):
    done = subprocess.run(
        ["bash", "-c", 'source "$1"; complete -p', "bash", str(script)], capture_output=True, text=True, check=True
    )
    assert done.stdout == "complete -o filenames -F _stair_inspector stair-inspector\n"


def test_the_help_says_where_the_script_goes(capsys):
    assert main(["completion", "--help"]) == 0
    assert "bash-completion/completions/stair-inspector" in capsys.readouterr().out
    assert main(["completion", "zsh"]) == 2
    assert "this command has no options" in capsys.readouterr().err
