"""An installation from a wheel, away from the checkout, finds its own data."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_a_wheel_holds_presets_schemas_palettes_and_samples(tmp_path: Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", str(tmp_path / "site"), str(ROOT)],
        check=True,
        capture_output=True,
    )
    code = (
        "from stair_inspector.cli import main\n"
        "from stair_inspector.files.paths import sample_scans, static_configs\n"
        "print(static_configs()); print(sample_scans())\n"
        "raise SystemExit(main(['measure', str(sample_scans() / 'straight.ply'), '-o', 'out', '--preset', 'tls']))"
    )
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=elsewhere,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "site")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    folders = done.stdout.splitlines()[:2]
    assert folders == [str(tmp_path / "site" / "stair_inspector" / name) for name in ("static_configs", "sample_scans")]
    assert sorted(path.name for path in (elsewhere / "out").iterdir()) == [
        "straight.csv",
        "straight.json",
        "straight_debug.ply",
    ]
