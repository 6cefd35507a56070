"""Rays without Open3D: each against every triangle, and a scan against that of Open3D."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.simulation import rays
from stair_inspector.simulation.ray_tiles import TiledRays
from stair_inspector.simulation.scanner import scan
from stair_inspector.simulation.scanner_specs import PROFILES
from stair_inspector.simulation.specs import Stair
from stair_inspector.simulation.staircase import build
from tests.oracles import open3d_or_skip


def directions_of(rows, columns, low_deg, high_deg):
    elevation = np.radians(np.linspace(low_deg, high_deg, rows))[:, None]
    azimuth = np.radians(np.linspace(-180.0, 180.0, columns))[None, :]
    return np.stack(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation) + 0.0 * azimuth],
        axis=2,
    )


def hit_slowly(corners, ray):
    """Solve for each triangle where the ray meets its plane, and whether that is inside."""
    nearest, found = np.inf, -1
    for number, (a, b, c) in enumerate(corners):
        matrix = np.column_stack([a - b, a - c, ray])
        if abs(np.linalg.det(matrix)) > 1e-12:
            u, v, t = np.linalg.solve(matrix, a)
            if u >= 0.0 and v >= 0.0 and u + v <= 1.0 and 0.0 < t < nearest:
                nearest, found = t, number
    return found


def test_every_ray_hits_what_it_hits_when_all_triangles_are_asked():
    rng = np.random.default_rng(6)
    corners = rng.uniform(-2.0, 2.0, (40, 1, 3)) + rng.uniform(-1.0, 1.0, (40, 3, 3))
    directions = directions_of(21, 37, -85.0, 90.0)
    hits = TiledRays(corners + 10.0).first_hits((10.0, 10.0, 10.0), directions)
    expected = [[hit_slowly(corners, ray) for ray in row] for row in directions]
    np.testing.assert_array_equal(hits, expected)
    assert 0.2 < (hits >= 0).mean() < 1.0


def test_no_triangle_is_hit_where_none_is_in_sight():
    behind = np.array([[[-5.0, -1.0, -1.0], [-5.0, 1.0, -1.0], [-5.0, 0.0, 1.0]]])
    ahead = directions_of(4, 9, -10.0, 10.0)[:, 3:6]
    assert (TiledRays(behind).first_hits((0.0, 0.0, 0.0), ahead) == -1).all()


def test_a_scan_is_that_of_open3d_but_for_single_rays(monkeypatch):
    open3d_or_skip()
    building = build(Stair(n_risers=4))
    scanner = replace(PROFILES["tls_good"], azimuth_step_deg=0.5, elevation_step_deg=0.5)
    by_open3d = scan(building, scanner)
    monkeypatch.setattr(rays, "find_open3d", lambda: None)
    without = scan(building, scanner)
    assert len(without.points) == pytest.approx(len(by_open3d.points), abs=5)
    assert len(by_open3d.points) > 3000
    if len(without.points) == len(by_open3d.points):
        np.testing.assert_allclose(without.points, by_open3d.points, atol=1e-9)
