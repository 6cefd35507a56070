"""The residual map is the points' own distances in their own places."""

import numpy as np
import pytest

from stair_inspector.pictures.residuals import residual_map
from tests.synthetic import rotation
from tests.viewer.surveyed import GOING, WIDTH, bumped

TURNS = [np.eye(3), rotation("x", 75.0) @ rotation("y", -40.0)]


@pytest.mark.parametrize("turn", TURNS)
def test_a_bump_shows_where_it_is_seen_from_above_by_who_climbs(turn):
    scan, inspection, _ = bumped(turn)
    found = residual_map(scan, inspection, inspection.steps[1])
    rows, columns = found.residuals_m.shape
    # Front is below and left is on the left.
    front_left = found.residuals_m[rows // 2 + 1 :, : columns // 2 - 1]
    back_right = found.residuals_m[: rows // 2 - 1, columns // 2 + 1 :]
    assert np.nanmean(front_left) == pytest.approx(0.01, abs=0.0005)
    assert np.nanmean(back_right) == pytest.approx(0.0, abs=0.0005)
    assert columns * found.cell_m == pytest.approx(WIDTH, abs=2 * found.cell_m)
    assert rows * found.cell_m == pytest.approx(GOING, abs=2 * found.cell_m)


def test_the_mean_of_the_map_is_that_of_the_points():
    scan, inspection, _ = bumped(np.eye(3))
    step = inspection.steps[1]
    own = scan.points[inspection.labels == 2]
    distance = (own - step.plane.centroid) @ step.plane.normal
    found = residual_map(scan, inspection, step)
    row = ((own[:, 0].max() - own[:, 0]) / found.cell_m).astype(int)
    column = ((own[:, 1].max() - own[:, 1]) / found.cell_m).astype(int)
    for cell in {(3, 4), (0, 0), (int(row.max()), int(column.max()))}:
        inside = (row == cell[0]) & (column == cell[1])
        expected = distance[inside].mean() if inside.any() else np.nan
        assert found.residuals_m[cell] == pytest.approx(expected, abs=1e-9, nan_ok=True)
