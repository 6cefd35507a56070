"""What is written is what others read."""

import numpy as np

from stair_inspector.files.ply import ply_bytes
from tests.oracles import open3d_or_skip

POINTS = np.array([[0.1, -2.0, 3e-7], [5_800_000.123456789, 1 / 3, -1e9], [0.0, 0.0, 0.0]])
COLORS = np.array([[0, 128, 255], [1, 2, 3], [255, 0, 0]], dtype=np.uint8)


def test_header_and_body_to_the_byte():
    data = ply_bytes(np.array([[1.0, 2.0, 3.0]]), np.array([[7, 8, 9]], dtype=np.uint8))
    header = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\n"
        "property double x\nproperty double y\nproperty double z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    )
    assert data == header.encode() + np.array([1.0, 2.0, 3.0], "<f8").tobytes() + bytes([7, 8, 9])


def test_trimesh_reads_every_bit(tmp_path):
    import trimesh

    path = tmp_path / "cloud.ply"
    path.write_bytes(ply_bytes(POINTS, COLORS))
    cloud = trimesh.load(path, process=False)
    np.testing.assert_array_equal(cloud.vertices, POINTS)
    np.testing.assert_array_equal(cloud.colors[:, :3], COLORS)


def test_open3d_reads_every_bit(tmp_path):
    path = tmp_path / "cloud.ply"
    path.write_bytes(ply_bytes(POINTS, COLORS))
    cloud = open3d_or_skip().io.read_point_cloud(str(path))
    np.testing.assert_array_equal(np.asarray(cloud.points), POINTS)
    np.testing.assert_array_equal(np.rint(np.asarray(cloud.colors) * 255), COLORS)


def test_single_precision_without_colours():
    data = ply_bytes(POINTS, double=False)
    _, _, body = data.partition(b"end_header\n")
    np.testing.assert_array_equal(np.frombuffer(body, "<f4").reshape(-1, 3), POINTS.astype(np.float32))
    assert b"uchar" not in data


def test_an_empty_cloud_is_a_header():
    assert ply_bytes(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.uint8)).endswith(b"end_header\n")
