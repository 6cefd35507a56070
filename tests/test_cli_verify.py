"""``verify`` on the command line: what belongs together, what was changed, and the same bytes for the same input."""

import pytest

from tests.test_cli import UP_Z, run, stair_file  # noqa: F401 - fixtures


def test_results_are_verified_and_what_was_changed_is_named(run, stair_file, tmp_path):  # noqa: F811
    assert run("measure", stair_file, *UP_Z, "-o", tmp_path)[0] == 0
    code, out, err = run("verify", tmp_path, "--scan", stair_file)
    assert (code, err) == (0, "")
    first, second = out.splitlines()
    assert first.startswith("stair: 3 files of stair.ply belong together (stair_inspector ")
    assert second == f"{stair_file}: measured in stair"
    (tmp_path / "stair.csv").write_bytes(b"")
    code, out, err = run("verify", tmp_path, "--scan", tmp_path / "stair.csv")
    assert (code, err) == (1, "")
    assert out.startswith("stair: do not belong together; changed since: stair.csv (")
    assert out.endswith(f"{tmp_path / 'stair.csv'}: is no scan of these results\n")


def test_a_broken_manifest_leaves_the_others(run, stair_file, tmp_path):  # noqa: F811
    assert run("measure", stair_file, *UP_Z, "-o", tmp_path)[0] == 0
    (tmp_path / "broken.manifest.json").write_text("{")
    code, out, err = run("verify", tmp_path)
    assert code == 3
    assert out.startswith("stair: 3 files")
    assert err.startswith(f"stair-inspector: {tmp_path / 'broken.manifest.json'}: is no manifest of this program (")


@pytest.mark.slow
def test_with_a_stated_time_the_same_input_gives_the_same_bytes(run, stair_file, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")
    folders = tmp_path / "one", tmp_path / "two"
    for folder in folders:
        assert run("measure", stair_file, *UP_Z, "-o", folder, "--report")[0] == 0
    one, two = ({path.name: path.read_bytes() for path in folder.iterdir()} for folder in folders)
    assert len(one) == 9
    assert [name for name in one if one[name] != two.get(name)] == []
