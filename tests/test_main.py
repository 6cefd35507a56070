"""``python -m stair_inspector`` is the command line."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent


def run(*words):
    return subprocess.run([sys.executable, "-m", *words], cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_package_can_be_run_as_a_module():
    done = run("stair_inspector", "presets")
    assert done.returncode == 0
    assert "tls" in done.stdout
    assert done.stderr == ""


def test_the_module_leaves_with_the_commands_exit_code_and_name():
    done = run("stair_inspector", "measure", "nowhere.ply")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("stair-inspector: measure: -o DIR is missing")
