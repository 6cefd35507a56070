"""What passes the door is checked, contiguous and read-only; sums do not depend on the machine."""

import numpy as np
import pytest

from stair_inspector.errors import DegenerateGeometry
from stair_inspector.geometry.arrays import own, project, scatter_of


def test_a_writable_array_is_copied_and_its_owner_keeps_it():
    mine = np.zeros((4, 3))
    owned = own(mine, (4, 3), "points")
    mine[0, 0] = 9.0
    assert owned[0, 0] == 0.0
    assert not owned.flags.writeable
    assert mine.flags.writeable


def test_a_view_of_a_writable_array_is_copied():
    mine = np.zeros((4, 3))
    owned = own(mine[1:], (3, 3), "points")
    mine[1, 0] = 9.0
    assert owned[0, 0] == 0.0


def test_an_owned_array_is_passed_on_without_a_copy():
    owned = own([1.0, 2.0], (2,), "values")
    assert own(owned, (None,), "values") is owned


def test_columns_become_contiguous():
    assert own(np.zeros((3, 5)).T, (5, 3), "points").flags.c_contiguous


@pytest.mark.parametrize("shape", [(3,), (2, 3), (None, 2), (4, 3, 1)])
def test_a_wrong_shape_is_named(shape):
    with pytest.raises(DegenerateGeometry, match=r"normals: expected shape .*, got \(4, 3\)"):
        own(np.zeros((4, 3)), shape, "normals")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_not_finite_is_refused(bad):
    with pytest.raises(DegenerateGeometry, match="points: contains values that are not finite"):
        own([[0.0, bad, 0.0]], (None, 3), "points")


def test_projection_and_scatter_by_hand():
    rows = np.array([[1.0, 2.0], [3.0, 4.0]])
    np.testing.assert_array_equal(project(rows, np.array([10.0, 1.0])), [13.0, 24.0])
    np.testing.assert_array_equal(scatter_of(rows), [[5.0, 11.0], [11.0, 25.0]])
