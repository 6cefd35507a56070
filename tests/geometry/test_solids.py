"""What of overlapping solids lies inside another one, and which way is out of each."""

import numpy as np
import pytest

from stair_inspector.geometry import solids
from stair_inspector.geometry.solids import find_hidden, find_parts, is_front, outward_normals
from tests.files.models import box, stair_of_solids
from tests.geometry.test_triangles import sampled
from tests.oracles import open3d_or_skip

BOXES = (((0, 0, 0), (3, 1, 2)), ((2, -0.5, 0.5), (5, 0.5, 1.5)), ((4, 0.2, -3), (4.5, 0.3, 3)))


@pytest.fixture(params=["rays", "crossings"])
def _either_way(request, monkeypatch):
    """Tell an inside by Open3D, and without it."""
    if request.param == "rays":
        open3d_or_skip()
    else:
        monkeypatch.setattr(solids, "find_open3d", lambda: None)


def corners_of(*boxes):
    return np.concatenate([np.array(box(*bounds).triangles) for bounds in boxes])


def on_faces(corners, n_each=60):
    """Points on triangles, and the triangle of each."""
    on = np.repeat(np.arange(len(corners)), n_each)
    shares = np.random.default_rng(1).dirichlet(np.ones(3), len(on))
    return np.einsum("nc,ncd->nd", shares, corners[on]), on


@pytest.mark.usefixtures("_either_way")
@pytest.mark.parametrize(("scale", "shift"), [(1.0, np.zeros(3)), (7.0, np.array([400.0, -300.0, 50.0]))])
def test_of_each_solid_what_lies_inside_another_is_hidden_wherever_they_stand(scale, shift):
    corners = corners_of(*BOXES)
    points, on = on_faces(corners)
    inside = np.zeros(len(points), dtype=bool)
    for number, (low, high) in enumerate(BOXES):
        is_in = ((points > low) & (points < high)).all(axis=1)
        inside |= is_in & (on // 12 != number)
    assert 0.05 < inside.mean() < 0.4
    near = [np.abs(points - corner).min(axis=1) < 1e-3 for bounds in BOXES for corner in bounds]
    is_told = ~np.any(near, axis=0) | (np.count_nonzero(near, axis=0) == 1)
    parts = find_parts(scale * corners + shift)
    hidden = find_hidden(parts, scale * points + shift, on)
    np.testing.assert_array_equal(hidden[is_told], inside[is_told])


@pytest.mark.usefixtures("_either_way")
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_normals_point_out_of_each_solid_wherever_it_stands(order):
    corners = corners_of(*BOXES)
    middles = np.repeat([np.mean(bounds, axis=0) for bounds in BOXES], 12, axis=0)
    outwards = corners.mean(axis=1) - middles
    far = (7.0 * corners + [400.0, -300.0, 50.0])[:, order]
    normals, is_outward = outward_normals(far, find_parts(far))
    assert is_outward.all()
    assert ((normals * outwards).sum(axis=1) > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-9)


@pytest.mark.parametrize("second", [((1, 1, 0), (2, 2, 1)), ((1, 0, 0), (2, 1, 2)), ((1, 1, 1), (2, 2, 2))])
def test_solids_that_touch_in_an_edge_a_face_or_a_corner_stay_two(second):
    parts = find_parts(corners_of(((0, 0, 0), (1, 1, 1)), second))
    assert [solid.number for solid in parts.solids] == [0, 1]
    assert parts.part_of.tolist() == [0] * 12 + [1] * 12
    np.testing.assert_array_equal(parts.solids[1].low, second[0])
    np.testing.assert_array_equal(parts.solids[1].high, second[1])


def test_what_has_a_hole_is_a_part_and_no_solid():
    corners = corners_of(*BOXES)
    parts = find_parts(np.delete(corners, 15, axis=0))
    assert parts.part_of.max() == 2
    assert [solid.number for solid in parts.solids] == [0, 2]


def test_of_a_model_of_too_many_solids_it_is_not_known_what_is_hidden_nor_what_is_out(monkeypatch):
    monkeypatch.setattr(solids, "_MOST_SOLIDS", len(BOXES) - 1)
    corners = corners_of(*BOXES)
    parts = find_parts(corners)
    assert parts.solids is None
    assert find_hidden(parts, *on_faces(corners)) is None
    normals, is_outward = outward_normals(corners, parts)
    assert not is_outward.any()
    # Always the same one of two opposite ways, so that a board's faces have opposite ones.
    np.testing.assert_array_equal(outward_normals(corners[:, ::-1], parts)[0], normals)
    np.testing.assert_array_equal(is_front(normals), is_front(-normals) ^ True)


def test_points_that_are_too_many_to_ask_for_are_those_near_solids_of_which_they_are_no_part(monkeypatch):
    corners = corners_of(*BOXES[:2])
    points, on = on_faces(corners)
    n_near = 0
    for number, (low, high) in enumerate(BOXES[:2]):
        n_near += int(((points > low) & (points < high)).all(axis=1)[on // 12 != number].sum())
    monkeypatch.setattr(solids, "_MOST_ASKED", n_near)
    assert find_hidden(find_parts(corners), points, on) is not None
    monkeypatch.setattr(solids, "_MOST_ASKED", n_near - 1)
    assert find_hidden(find_parts(corners), points, on) is None


def test_what_lies_inside_an_overlapping_solid_is_hidden():
    model = stair_of_solids(n_steps=3)
    corners = np.array(model.triangles)
    parts = find_parts(corners)
    assert len(parts.solids) == 4
    points, on = sampled(corners)
    hidden = find_hidden(parts, points, on)
    x, y, z = points.T
    inner = (y > 0.01) & (y < 0.99) & (x < 0.83)
    first_top = inner & (np.abs(z - 0.175) < 1e-9)
    assert hidden[first_top & (x > 0.285)].all()
    assert not hidden[first_top & (x < 0.275)].any()
    assert not hidden[inner & (np.abs(z - 3 * 0.175) < 1e-9)].any()


def test_a_room_hides_nothing_that_stands_in_it():
    corners = np.concatenate([box((0, 0, 0), (5, 5, 3)).triangles, box((1, 1, 0.2), (2, 2, 1)).triangles])
    points, on = sampled(corners, 0.05)
    assert not find_hidden(find_parts(corners), points, on).any()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0)])
def test_normals_point_out_of_solids_however_their_faces_are_wound(order):
    solid = box((0, 0, 0), (1, 2, 0.04))
    corners = np.array(solid.triangles)[:, order]
    normals, is_outward = outward_normals(corners, find_parts(corners))
    assert is_outward.all()
    assert np.allclose(normals, solid.face_normals)
    open_normals, is_known = outward_normals(corners[1:], find_parts(corners[1:]))
    assert not is_known.any()
    assert np.allclose(np.abs(open_normals), np.abs(solid.face_normals[1:]))
