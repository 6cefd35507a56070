"""Each dialect gives the points of the plain PLY, as exactly as it keeps them; where it keeps less, within u/3."""

import numpy as np
import pytest

from stair_inspector.errors import ReadError
from stair_inspector.files import raw_mesh
from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from tests.files.damage import check_form
from tests.files.dialect_writers import POINTS
from tests.files.dialects import DIALECTS
from tests.files.models import exported, stair_of_solids
from tests.files.test_las import sizes_of
from tests.oracles import needs_e57

COARSE = [name for name, each in DIALECTS.items() if each.coarse_m > 1e-9]
SOUND = [
    pytest.param(name, marks=needs_e57 if name == "E57" else ()) for name, each in DIALECTS.items() if not each.refused
]


def read(tmp_path, name):
    each = DIALECTS[name]
    content = each.make()
    path = tmp_path / f"a{each.suffix}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_scan(path, each.unit, columns=each.columns)


@pytest.mark.parametrize("name", SOUND)
def test_the_points_are_those_of_the_plain_ply(tmp_path, name):
    scan = read(tmp_path, name)
    found = scan.points + scan.origin_m
    assert found.shape == POINTS.shape
    if DIALECTS[name].is_sorted:
        found[np.lexsort(POINTS.T)] = found[np.lexsort(np.round(found, 6).T)]
    assert np.abs(found - POINTS).max() <= DIALECTS[name].coarse_m


@pytest.mark.parametrize("name", [name for name, each in DIALECTS.items() if each.refused])
def test_the_refusal_names_what_is_wrong(tmp_path, name):
    with pytest.raises(ReadError) as caught:
        read(tmp_path, name)
    check_form(tmp_path / f"a{DIALECTS[name].suffix}", str(caught.value))
    assert DIALECTS[name].refused in str(caught.value)


def test_there_are_many_dialects():
    assert len(DIALECTS) >= 60


@pytest.mark.slow
@pytest.mark.parametrize("name", COARSE)
def test_what_keeps_less_gives_the_values_of_the_plain_ply_within_a_third_of_u(tmp_path, name):
    (tmp_path / "plain.ply").write_bytes(ply_bytes(POINTS))
    plain, other = sizes_of(read_scan(tmp_path / "plain.ply", "m")), sizes_of(read(tmp_path, name))
    assert np.array_equal(np.isnan(plain), np.isnan(other))
    assert np.nanmax(np.abs(other - plain)[..., 0] / other[..., 1]) < 1.0 / 3.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.stl", "ascii.stl", "a.obj", "a.off", "a.glb"])
def test_a_mesh_in_any_format_gives_the_values_of_the_plain_ply_within_a_third_of_u(tmp_path, monkeypatch, name):
    monkeypatch.setattr(raw_mesh, "MOST_POINTS", 60_000)
    sizes = []
    for each in ("plain.ply", name):
        (tmp_path / each).write_bytes(exported(stair_of_solids(), each))
        sizes.append(sizes_of(read_scan(tmp_path / each, "m")))
    plain, other = sizes
    assert np.array_equal(np.isnan(plain), np.isnan(other))
    assert np.nanmax(np.abs(other - plain)[..., 0] / other[..., 1]) < 1.0 / 3.0
