"""Rendered views: no display, a tread's colour where that tread is, a true scale, and hostile names that do no harm."""

import dataclasses
import io
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from stair_inspector.errors import ConfigError
from stair_inspector.files.palettes import read_palette
from stair_inspector.model import Scan
from stair_inspector.pictures.display import choose_display
from stair_inspector.pictures.picture_camera import PictureCamera, camera_of
from stair_inspector.pictures.ramps import DIVERGING
from stair_inspector.pictures.render import render_view
from stair_inspector.pictures.report_views import report_views
from stair_inspector.pictures.residual_sheets import residual_sheets
from stair_inspector.pictures.segmentation import view_from_local
from tests.synthetic import rotation
from tests.viewer.surveyed import GOING, RISE, WIDTH, surveyed

PALETTE = read_palette("page")
SIZE = (500, 400)
DATE = "2026-11-22"
TURN = rotation("x", 75.0) @ rotation("y", -40.0)


@pytest.fixture(scope="module")
def stair():
    scan, inspection, _ = surveyed()
    return scan, inspection


def opened(png):
    with Image.open(io.BytesIO(png)) as image:
        return np.asarray(image.convert("RGB"))


def view_part(png, size=SIZE):
    """The view itself: between the words above it and those below."""
    picture = opened(png)
    bare = np.asarray(picture)
    # The view begins where a picture without a title would: the head's height depends on the width alone.
    head = _head_rows(size[0])
    return bare[head : head + size[1]]


def _head_rows(width):
    from stair_inspector.pictures.picture import Caption, picture_png

    marker = np.full((10, width, 3), (1, 2, 3), dtype=np.uint8)
    picture = opened(picture_png(marker, Caption("T", "s", "v", DATE, ""), None, None, "White"))
    return int(np.nonzero((picture == (1, 2, 3)).all(axis=2).all(axis=1))[0][0])


def place_of(inspection, scan, view, point, size=SIZE):
    """The pixel of a point, by the camera that the view has."""
    turn = view_from_local(inspection)
    camera = camera_of(inspection, choose_display(scan), view, turn, size)
    (place,), _, _ = camera.look((turn @ point)[None])
    return round(float(place[1])), round(float(place[0]))


def hue_distance(color, wanted):
    """Shading scales a colour: compare directions."""
    a, b = np.asarray(color, dtype=float), np.asarray(wanted, dtype=float)
    return math.degrees(math.acos(min(1.0, a @ b / (np.linalg.norm(a) * np.linalg.norm(b)))))


@pytest.mark.parametrize("turn", [None, TURN], ids=["upright", "lying"])
@pytest.mark.parametrize("view", ["Home", "Top"])
def test_a_tread_has_its_colour_where_it_is(view, turn):
    scan, inspection, _ = surveyed(turn)
    pixels = view_part(render_view(scan, inspection, view, "Segmented", SIZE, DATE, title="T"))
    for step in inspection.steps:
        row, column = place_of(inspection, scan, view, step.corners.mean(axis=0))
        patch = pixels[row - 1 : row + 2, column - 1 : column + 2].reshape(-1, 3)
        assert hue_distance(np.median(patch, axis=0), PALETTE.of_step(step.step_id)) < 4.0


def test_the_side_view_shows_the_steps_one_above_the_other(stair):
    scan, inspection = stair
    pixels = view_part(render_view(scan, inspection, "Side", "Segmented", SIZE, DATE, title="T"))
    rows = []
    for step in inspection.steps:
        row, column = place_of(inspection, scan, "Side", step.corners.mean(axis=0))
        strip = pixels[row - 4 : row + 5, column - 2 : column + 3].reshape(-1, 3)
        assert min(hue_distance(color, PALETTE.of_step(step.step_id)) for color in strip) < 4.0
        rows.append(row)
    assert rows == sorted(rows, reverse=True)


def test_nosings_are_drawn_in_front_of_their_risers(stair):
    scan, inspection = stair
    pixels = view_part(render_view(scan, inspection, "Front", "Segmented", SIZE, DATE, title="T"))
    for step in inspection.steps:
        row, column = place_of(inspection, scan, "Front", 0.3 * step.nosing[0] + 0.7 * step.nosing[1])
        # Lifted off the surface by about a point, so that its points do not cover it.
        strip = pixels[row - 12 : row + 3, column]
        assert min(hue_distance(color, PALETTE.front_edge) for color in strip) < 10.0


def test_the_raw_view_has_the_scans_own_colours_and_nothing_drawn_on_it(stair):
    scan, inspection = stair
    half = (scan.points[:, 1] < WIDTH / 2.0)[:, None]
    colors = np.where(half, [[200, 30, 30]], [[30, 30, 200]]).astype(np.uint8)
    painted = dataclasses.replace(scan, colors=colors)
    pixels = view_part(render_view(painted, inspection, "Top", "Raw", SIZE, DATE, title="T"))
    for share, wanted in ((0.25, (200, 30, 30)), (0.75, (30, 30, 200))):
        point = np.array([1.5 * GOING, share * WIDTH, 2.0 * RISE])
        row, column = place_of(inspection, painted, "Top", point)
        assert hue_distance(pixels[row, column], wanted) < 2.0
    for step in inspection.steps:
        row, column = place_of(
            inspection, painted, "Top", step.nosing.mean(axis=0) + 0.1 * (step.nosing[0] - step.nosing[1])
        )
        strip = pixels[row - 8 : row + 3, column]
        assert max(hue_distance(color, (30, 30, 200)) for color in strip) < 10.0


def test_a_scan_without_colours_is_shown_by_height(stair):
    scan, inspection = stair
    pixels = view_part(render_view(scan, inspection, "Top", "Raw", SIZE, DATE, title="T"))
    low = pixels[place_of(inspection, scan, "Top", np.array([0.5 * GOING, WIDTH / 2.0, RISE]))]
    high = pixels[place_of(inspection, scan, "Top", np.array([4.5 * GOING, WIDTH / 2.0, 5.0 * RISE]))]
    # Viridis: dark violet below, yellow above.
    assert low[2] > low[1]
    assert high[1] > high[2] + 50


def test_what_hangs_over_the_stair_does_not_cover_it_from_above(stair):
    scan, inspection = stair
    rng = np.random.default_rng(3)
    ceiling = np.column_stack([rng.uniform(-1.0, 2.0, 20000), rng.uniform(-0.5, 1.5, 20000), np.full(20000, 3.2)])
    covered = Scan(
        np.concatenate([scan.points, ceiling - scan.points.mean(axis=0) * 0.0]),
        scan.origin_m,
        scan.name,
        scan.sha256,
        "m",
        len(scan.points) + len(ceiling),
    )
    labels = np.concatenate([inspection.labels, np.full(len(ceiling), -1, dtype=inspection.labels.dtype)])
    seen = dataclasses.replace(inspection, labels=labels, patch_ids=None)
    pixels = view_part(render_view(covered, seen, "Top", "Segmented", SIZE, DATE, title="T"))
    step = seen.steps[1]
    row, column = place_of(seen, covered, "Top", step.corners.mean(axis=0))
    assert hue_distance(pixels[row, column], PALETTE.of_step(2)) < 4.0


def test_the_scale_bar_is_as_long_as_it_says(stair):
    scan, inspection = stair
    turn = view_from_local(inspection)
    camera = camera_of(inspection, choose_display(scan), "Top", turn, SIZE)
    left, right = (camera.look((turn @ end)[None])[0][0] for end in inspection.steps[0].nosing)
    assert math.dist(left, right) == pytest.approx(WIDTH * camera.pixels_per_m, rel=1e-9)
    picture = opened(render_view(scan, inspection, "Top", "Segmented", SIZE, DATE, title="T"))
    below = picture[_head_rows(SIZE[0]) + SIZE[1] :]
    ink = (below == (24, 26, 30)).all(axis=2)
    longest = max(int(row.sum()) for row in ink[:, SIZE[0] // 2 :])
    lengths = [longest / camera.pixels_per_m, 0.5 * longest / camera.pixels_per_m]
    assert any(abs(length - wanted) < 0.02 for length in lengths for wanted in (0.1, 0.2, 0.5, 1.0))


def test_a_parallel_view_keeps_lengths_at_every_depth_and_home_does_not(stair):
    scan, inspection = stair
    turn = view_from_local(inspection)
    lengths = {}
    for view in ("Front", "Home"):
        camera = camera_of(inspection, choose_display(scan), view, turn, SIZE)
        ends = [camera.look(step.nosing @ turn.T)[0] for step in (inspection.steps[0], inspection.steps[4])]
        lengths[view] = [math.dist(*pair) for pair in ends]
    assert lengths["Front"][0] == pytest.approx(lengths["Front"][1], rel=1e-9)
    assert lengths["Home"][0] > 1.05 * lengths["Home"][1]


def test_what_is_behind_the_eye_is_not_drawn():
    from stair_inspector.pictures.cameras import Pose

    pose = Pose(np.array([0.0, -2.0, 0.0]), np.zeros(3), np.array([0.0, 0.0, 1.0]))
    camera = PictureCamera(pose, 100, 100, 50.0, is_parallel=False)
    places, depths, _ = camera.look(np.array([[0.0, -3.0, 0.0], [0.0, 1.0, 0.0]]))
    assert np.isnan(places[0]).all()
    assert np.isnan(depths[0])
    assert places[1].tolist() == [50.0, 50.0]


def test_the_report_has_all_views_and_the_residuals(stair):
    scan, inspection = stair
    views = report_views(scan, inspection, DATE, width=600)
    keys = [view.key for view in views]
    assert keys == ["raw_home", "segmented_home", "segmented_front", "segmented_top", "segmented_side", "residuals"]
    for view in views:
        assert opened(view.png).shape[1] == round(600 * view.share)
        assert view.caption
    assert [view.png for view in report_views(scan, inspection, DATE, width=600)] == [view.png for view in views]


def test_without_a_staircase_there_is_the_scan(stair):
    scan, inspection = stair
    bare = dataclasses.replace(inspection, steps=(), flights=())
    views = report_views(scan, bare, DATE, width=600)
    assert [view.key for view in views] == ["raw_home"]
    drawn = opened(views[0].png)
    assert np.mean((drawn != 255).any(axis=2)) > 0.05


@pytest.mark.parametrize("name", ["%s{}\x00\n.ply", "<b>계단</b>.ply", "a" * 3000, "\ud800"])
def test_a_hostile_name_is_only_written(stair, name):
    scan, inspection = stair
    named = dataclasses.replace(inspection, scan=dataclasses.replace(inspection.scan, name=name))
    picture = opened(render_view(scan, named, "Home", "Raw", (300, 200), DATE))
    assert picture.shape[1] == 300


def test_a_size_that_is_no_picture_is_refused(stair):
    scan, inspection = stair
    with pytest.raises(ConfigError, match=r"picture: width: got 100000; give 200 to 7680 pixels"):
        render_view(scan, inspection, "Home", "Raw", (100000, 300), DATE)


@pytest.mark.slow
def test_it_needs_no_display_and_no_browser():
    code = (
        "import sys; from tests.viewer.surveyed import surveyed;"
        "from stair_inspector.pictures.report_views import report_views;"
        "scan, inspection, _ = surveyed(); views = report_views(scan, inspection, '2026-11-22', width=600);"
        "assert len(views) == 6; loaded = set(sys.modules);"
        "assert not loaded & {'viser', 'playwright', 'matplotlib', 'OpenGL', 'pyglet'}, loaded"
    )
    bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run([sys.executable, "-c", code], env=bare, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_bump_on_a_tread_is_red_on_its_map_where_it_is(stair):
    scan, inspection = stair
    points = scan.points.copy()
    step = inspection.steps[1]
    own = inspection.labels == 2
    # A corner at the back on the right of the climber.
    is_bump = own & (points[:, 0] > 1.75 * GOING) & (points[:, 1] < 0.25 * WIDTH)
    points[is_bump, 2] += 0.008
    bumpy = dataclasses.replace(scan, points=points)
    width = 1000
    (sheet,) = residual_sheets(bumpy, inspection, DATE, width=width)
    picture = opened(sheet).astype(int)
    reddest = np.abs(picture - DIVERGING[-1]).sum(axis=2) < 60
    # Two columns of few steps: step 2 is on the right of the first row, seen from above with its back upwards.
    rows, columns = np.nonzero(reddest)
    found = np.column_stack([rows, columns])[rows < 0.2 * len(picture)]
    right_back = found[(found[:, 1] > 0.85 * width)]
    # Single cells elsewhere are noise.
    assert len(right_back) > 0.6 * len(found)
    filled = reddest[right_back[:, 0].min() : right_back[:, 0].max(), right_back[:, 1].min() : right_back[:, 1].max()]
    assert filled.mean() > 0.5
    assert step.step_id == 2


@pytest.mark.slow
def test_residuals_of_a_long_stair_take_more_than_one_sheet(stair):
    scan, inspection = stair
    many = dataclasses.replace(inspection, steps=inspection.steps[:4] * 30)
    sheets = residual_sheets(scan, many, DATE, width=600)
    assert len(sheets) > 1
    for sheet in sheets:
        height, width = opened(sheet).shape[:2]
        assert width == 600
        assert height < 1.45 * width
    views = report_views(scan, many, DATE, width=600)
    assert [view.key for view in views if view.key.startswith("residuals")] == [
        f"residuals_{k}" for k in range(1, len(sheets) + 1)
    ]
    assert residual_sheets(scan, dataclasses.replace(inspection, steps=()), DATE) == ()
