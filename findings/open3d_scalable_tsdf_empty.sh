#!/usr/bin/env bash
# open3d 0.20.0: ScalableTSDFVolume, which fuses depth images to a surface, gives no surface at all.
#
# One depth image of a wall 1.5 m away, 320 x 240 pixels, integrated with 20 mm voxels: the mesh and the cloud of
# ScalableTSDFVolume are empty, without a word, with and without colours, whether the image is float32 metres or uint16
# millimetres. UniformTSDFVolume makes 10,710 triangles of the same image, and so does ScalableTSDFVolume of 0.19.0.
# So: fuse with the tensor class open3d.t.geometry.VoxelBlockGrid, or with UniformTSDFVolume where the room is small.
#
# Seen: "0.20.0 scalable 0, uniform 10710, grid 10752" and "0.19.0 scalable 10710, uniform 10710, grid 10752".
# Fails when a later run of these versions behaves otherwise.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for version in 0.20.0 0.19.0; do
    python3 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "open3d==$version" "numpy==2.3.5"
    "$folder/$version/bin/python" - <<'PYTHON'
import sys

import numpy as np
import open3d as o3d

HEIGHT, WIDTH = 240, 320
matrix = np.array([[280.0, 0.0, 159.5], [0.0, 280.0, 119.5], [0.0, 0.0, 1.0]])
depth = np.full((HEIGHT, WIDTH), 1.5, np.float32)
integration = o3d.pipelines.integration


def fused(volume, image, scale):
    picture = o3d.geometry.Image(np.zeros((HEIGHT, WIDTH, 3), np.uint8))
    both = o3d.geometry.RGBDImage.create_from_color_and_depth(
        picture, o3d.geometry.Image(image), depth_scale=scale, depth_trunc=4.0, convert_rgb_to_intensity=False
    )
    camera = o3d.camera.PinholeCameraIntrinsic(WIDTH, HEIGHT, 280.0, 280.0, 159.5, 119.5)
    volume.integrate(both, camera, np.eye(4))
    return len(volume.extract_triangle_mesh().triangles)


counts = []
for kind in (integration.TSDFVolumeColorType.NoColor, integration.TSDFVolumeColorType.RGB8):
    for image, scale in ((depth, 1.0), ((depth * 1000.0).astype(np.uint16), 1000.0)):
        counts.append(fused(integration.ScalableTSDFVolume(0.02, 0.08, kind), image, scale))
uniform = integration.UniformTSDFVolume(4.0, 200, 0.08, kind, origin=np.array([-2.0, -2.0, 0.0]))
n_uniform = fused(uniform, depth, 1.0)

core, geometry = o3d.core, o3d.t.geometry
grid = geometry.VoxelBlockGrid(("tsdf", "weight"), (core.float32, core.float32), ((1), (1)), voxel_size=0.02)
lens = core.Tensor(matrix), core.Tensor(np.eye(4))
tensor = geometry.Image(core.Tensor(depth))
grid.integrate(grid.compute_unique_block_coordinates(tensor, *lens, 1.0, 4.0), tensor, *lens, 1.0, 4.0)
n_grid = len(grid.extract_triangle_mesh(weight_threshold=0.5).triangle.indices)
print(f"{o3d.__version__} scalable {max(counts)}, uniform {n_uniform}, grid {n_grid}")
wanted = [0] * 4 if o3d.__version__ == "0.20.0" else [n_uniform] * 4
sys.exit(0 if counts == wanted and n_uniform > 1000 and n_grid > 1000 else "open3d behaves otherwise than was seen")
PYTHON
done
