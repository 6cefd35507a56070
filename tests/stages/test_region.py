"""Whether a face of the region of interest cuts through a step, on points as sparse as far from the scanner."""

from types import SimpleNamespace

import numpy as np
import pytest

from stair_inspector.model import Up
from stair_inspector.stages.region import note_region_cuts
from tests.synthetic import make_scan

UP = Up(np.array([0.0, 0.0, 1.0]), "given")
REGION = "-9,-9,-9,9,0.7,9"
"""Of a tread from y = 0 to 1 a part is left; what climbs along x has its left there."""


def tread(spacing_x, spacing_y, depth=0.28, width=1.0):
    """The points of a tread, which begins at x = 0, in rows."""
    x, y = np.arange(0.001, depth, spacing_x), np.arange(0.003, width, spacing_y)
    plan = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([plan, np.full(len(plan), 0.17)])


def sides_cut(points, spacing_m, keep=None):
    """The sides on which the region cuts the step that is all of the points within it."""
    inside = points[points[:, 1] <= 0.7] if keep is None else points[keep]
    step = SimpleNamespace(step_id=4, climb=np.array([1.0, 0.0, 0.0]))
    notes = note_region_cuts(make_scan(points), UP, REGION, [step], [inside], [spacing_m])
    assert all((note.code, note.step) == ("region_cuts", 4) for note in notes)
    return [note.message.split(" on its ")[1].split(":")[0] for note in notes]


@pytest.mark.parametrize(
    ("spacing_x", "spacing_y"), [(0.005, 0.005), (0.03, 0.02), (0.05, 0.03), (0.01, 0.06)], ids=str
)
def test_a_cut_is_seen_however_sparse_the_points(spacing_x, spacing_y):
    assert sides_cut(tread(spacing_x, spacing_y), np.sqrt(spacing_x * spacing_y)) == ["left"]


def test_a_cut_is_seen_where_only_a_strip_of_the_step_was():
    assert sides_cut(tread(0.015, 0.02, depth=0.05), 0.017) == ["left"]


@pytest.mark.parametrize("spacing_m", [0.005, 0.03])
def test_a_step_that_ends_at_the_face_by_itself_is_not_cut(spacing_m):
    assert sides_cut(tread(spacing_m, spacing_m, width=0.69), spacing_m) == []


def test_a_step_that_ends_well_inside_is_not_cut_by_what_lies_beyond():
    points = tread(0.01, 0.01)
    has_gap = points[(points[:, 1] < 0.6) | (points[:, 1] > 0.7)]
    assert sides_cut(has_gap, 0.01) == []


def test_a_corner_that_touches_the_face_is_no_edge():
    points = tread(0.005, 0.005)
    # Its side runs at 45 degrees and meets the face in a point.
    keep = points[:, 0] + points[:, 1] <= 0.71
    assert sides_cut(points, 0.005, keep) == []
