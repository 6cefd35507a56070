"""What an installation holds and asks for; away from the checkout it finds its own data."""

import email
import importlib.util
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

ROOT = Path(__file__).parents[1]
HOOK = ROOT / ".ci" / "open3d_on_linux.py"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel, opened."""
    folder = tmp_path_factory.mktemp("wheel")
    built = list(WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"]))
    with zipfile.ZipFile(built[0]) as opened:
        yield opened


@pytest.fixture(scope="module")
def hook():
    spec = importlib.util.spec_from_file_location("open3d_on_linux", HOOK)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_wheel_carries_two_samples_and_all_configs(wheel):
    names = wheel.namelist()
    samples = [name.rpartition("/")[2] for name in names if "/sample_scans/" in name]
    assert sorted(samples) == ["defective_step.ply", "defective_step.truth.json", "straight.ply", "straight.truth.json"]
    configs = {name.removeprefix("stair_inspector/") for name in names if "/static_configs/" in name}
    assert configs == {
        path.relative_to(ROOT).as_posix() for path in (ROOT / "static_configs").rglob("*") if path.is_file()
    }
    assert "stair_inspector/py.typed" in names
    assert sum(each.compress_size for each in wheel.infolist()) < 8_000_000


def test_a_wheel_says_what_it_is_and_asks_for_open3d_where_there_is_one(wheel, hook):
    place = next(name for name in wheel.namelist() if name.endswith(".dist-info/METADATA"))
    metadata = email.message_from_bytes(wheel.read(place))
    kinds = metadata.get_all("Classifier")
    assert {f"Programming Language :: Python :: 3.{minor}" for minor in range(11, 15)} <= set(kinds)
    assert "Typing :: Typed" in kinds
    assert "point-cloud" in metadata["Keywords"]
    asked = [each for each in metadata.get_all("Requires-Dist") if each.startswith("open3d")]
    # Each of them names the systems that have a wheel: elsewhere pip must not look for one.
    assert all("sys_platform ==" in each and "python_version <" in each for each in asked)
    assert any("platform_machine == 'x86_64' and python_version < '3.13'" in each.replace('"', "'") for each in asked)


@pytest.mark.parametrize(
    ("library", "version", "is_added"),
    [
        ("glibc", "2.35", True),
        ("glibc", "2.41", True),
        ("glibc", "3.0", True),
        ("glibc", "2.34", False),
        ("glibc", "2.9", False),
        ("glibc", "", False),
        ("", "", False),
        ("musl", "1.2.5", False),
    ],
)
def test_open3d_is_added_where_the_c_library_can_load_it(hook, library, version, is_added):
    assert hook.added_for(library, version) == (hook.ADDED if is_added else ())
    assert len(hook.ADDED) == 3


@pytest.mark.slow
def test_a_wheel_finds_its_presets_schemas_palettes_and_samples(tmp_path: Path) -> None:
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
        "straight.manifest.json",
        "straight_debug.ply",
    ]
