"""A mesh as phones make it, its depth images fused to a surface on a grid: what u holds of it."""

import numpy as np
import pytest
import trimesh

from stair_inspector.files.ply import ply_bytes
from stair_inspector.files.scans import read_scan
from stair_inspector.params import Params
from stair_inspector.pipeline import inspect
from stair_inspector.stages.examine import examine
from tests.files.models import box, exported, stair_of_solids
from tests.oracles import open3d_or_skip

SIZES = {"rise_m": 0.175, "going_m": 0.28, "width_m": 1.0}


def fused(mesh, voxel_m, seed=0, noise_m=0.004):
    """The mesh that Open3D fuses from depth images of 320 x 240 pixels along a walk up the stair."""
    o3d = open3d_or_skip()
    core, geometry = o3d.core, o3d.t.geometry
    rng = np.random.default_rng(seed)
    scene = geometry.RaycastingScene()
    scene.add_triangles(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
    grid = geometry.VoxelBlockGrid(
        ("tsdf", "weight"), (core.float32, core.float32), ((1), (1)), voxel_size=voxel_m, block_count=20_000
    )
    camera = np.array([[280.0, 0.0, 159.5], [0.0, 280.0, 119.5], [0.0, 0.0, 1.0]])
    for along in np.linspace(-1.3, 1.1, 10):
        for aside in (-0.6, 0.2, 0.8, 1.6):
            eye = np.array([along, aside, 1.5 + max(0.0, 0.625 * along)]) + rng.normal(0.0, 0.05, 3)
            target = np.array([along + 1.0, 0.5, max(0.0, 0.625 * (along + 0.9))])
            ahead = (target - eye) / np.linalg.norm(target - eye)
            right = np.cross(ahead, [0.0, 0.0, 1.0])
            right /= np.linalg.norm(right)
            pose = np.eye(4)
            pose[:3, :3] = [right, np.cross(ahead, right), ahead]
            pose[:3, 3] = -pose[:3, :3] @ eye
            lenses = [core.Tensor(camera), core.Tensor(pose)]
            depth = scene.cast_rays(scene.create_rays_pinhole(*lenses, 320, 240))["t_hit"].numpy()
            depth = np.where(np.isfinite(depth), depth, 0.0)
            blotches = rng.normal(size=(12, 16)).repeat(20, axis=0).repeat(20, axis=1)
            depth += noise_m * (depth / 1.5) * (0.7 * blotches + 0.7 * rng.normal(size=depth.shape))
            image = geometry.Image(core.Tensor(np.where(depth > 3.5, 0.0, depth).astype(np.float32)))
            blocks = grid.compute_unique_block_coordinates(image, *lenses, 1.0, 3.5)
            grid.integrate(blocks, image, *lenses, 1.0, 3.5)
    made = grid.extract_triangle_mesh(weight_threshold=2.0).to_legacy()
    return trimesh.Trimesh(np.asarray(made.vertices), np.asarray(made.triangles), process=False)


def floor_and_stair():
    """A free stair on a large floor."""
    return trimesh.util.concatenate([stair_of_solids(), box((-1.6, -1.5, -0.1), (2.5, 2.5, 0.0))])


@pytest.mark.slow
@pytest.mark.parametrize("voxel_m", [0.01, 0.015, 0.025])
def test_u_holds_what_a_fused_mesh_has_rounded(tmp_path, voxel_m):
    mesh = fused(floor_and_stair(), voxel_m)
    (tmp_path / "phone.ply").write_bytes(exported(mesh, "phone.ply"))
    scan = read_scan(tmp_path / "phone.ply", "m")
    assert scan.facet_m == pytest.approx(voxel_m, rel=0.1)
    steps = inspect(scan, Params()).steps
    assert len(steps) == 5
    values = [(getattr(step, name), true) for step in steps for name, true in SIZES.items() if getattr(step, name)]
    assert len(values) == 14
    errors = np.array([(abs(value.value - true), value.u) for value, true in values])
    # 95 % of 14 are 13.
    assert (errors[:, 0] <= errors[:, 1]).sum() >= 13
    # Rises stay of use: k = 2, two levels.
    assert max(step.rise_m.u for step in steps) < 0.003


def test_a_scanned_mesh_is_said_and_neither_a_model_nor_a_cloud(tmp_path):
    rng = np.random.default_rng(1)
    model = stair_of_solids(2)
    fine = model.subdivide_to_size(0.15)
    fine.vertices += rng.normal(0.0, 0.002, fine.vertices.shape)
    (tmp_path / "scanned.ply").write_bytes(exported(fine, "scanned.ply"))
    (tmp_path / "model.ply").write_bytes(exported(model, "model.ply"))
    (tmp_path / "cloud.ply").write_bytes(ply_bytes(np.asarray(fine.vertices)))
    found = {name: examine(read_scan(tmp_path / f"{name}.ply", "m")) for name in ("scanned", "model", "cloud")}
    assert found["model"].facet_m is None
    assert found["cloud"].facet_m is None
    edges = np.linalg.norm(np.diff(fine.vertices[fine.edges_unique], axis=1)[:, 0], axis=1)
    assert found["scanned"].facet_m == pytest.approx(np.median(edges), rel=0.2)
    said = [each for each in found["scanned"].observations if each.code == "mesh_scanned"]
    assert [each.size_m for each in said] == [found["scanned"].facet_m]
    assert "a scanned mesh, its corners about" in said[0].message
