"""What is said about a scan before it is measured."""

from dataclasses import replace

import numpy as np
import pytest

from stair_inspector.model import Observation
from stair_inspector.params import UncertaintyParams
from stair_inspector.stages.examine import examine, size_text, with_questions
from tests.stages.test_coordinate_steps import POINTS, UTM, as_float32, scan_of, voxels
from tests.synthetic import Stair, make_scan, rotation

ABOVE = np.array([0.0, 0.0, 0.02])


def said(points, unit="m"):
    return examine(scan_of(points, unit)).observations


def only(points, unit="m"):
    (found,) = said(points, unit)
    assert found.level == "doubt"
    assert found.cure
    return found


@pytest.mark.parametrize("points", [POINTS, POINTS + UTM, as_float32(POINTS)], ids=["near", "utm", "float32"])
def test_nothing_is_said_about_a_sound_scan(points):
    assert said(points) == ()


def test_a_step_far_below_the_noise_is_known_and_not_worth_a_word():
    examined = examine(scan_of(POINTS.round(4)))
    assert examined.observations == ()
    np.testing.assert_allclose(examined.steps_m, 1e-4, rtol=1e-6)


def test_rounded_coordinates():
    found = only(POINTS.round(2))
    assert (found.code, found.size_m) == ("coordinates_rounded", pytest.approx(0.01))
    assert found.message == "the coordinates are rounded to 10 mm; stations less than 30 mm apart cannot be told in it"
    assert "0.0001" in found.cure


def test_a_size_is_said_in_the_unit_of_the_file_too_where_that_is_not_metric():
    assert only(np.round(POINTS / 0.0254 * 16.0) / 16.0, "in").message.endswith("rounded to 1.59 mm (0.0625 in)")


def test_steps_that_differ_are_said_for_each_axis():
    found = only(as_float32(POINTS + UTM))
    assert (found.code, found.size_m) == ("float32_far_from_zero", 0.5)
    assert "resolve only 31.2 mm in x, 0.5 m in y" in found.message
    assert "double" in found.cure
    assert "shift" in found.cure


def test_a_lattice_upright_and_turned():
    centres = voxels(POINTS, 0.02)
    found = only(centres)
    assert (found.code, found.size_m) == ("points_on_lattice", pytest.approx(0.02))
    assert "voxels" in found.message
    turned = only(centres @ rotation("z", 20.0).T)
    assert (turned.code, turned.size_m) == ("points_on_lattice", pytest.approx(0.02))
    assert "20 mm, turned against the axes" in turned.message


def test_a_lattice_that_holds_each_cell_once_is_told_from_rounded_points():
    points = np.random.default_rng(4).uniform(0.0, [2.0, 1.0, 0.001], (40_000, 3))
    points[:, 2] += 0.2 * points[:, 0]
    cells, repeats = np.unique(np.rint(points / 0.02), axis=0, return_counts=True)
    voxels = make_scan(cells * 0.02)
    assert examine(voxels).is_thinned
    assert not examine(replace(voxels, repeats=repeats)).is_thinned
    assert not examine(make_scan(points)).is_thinned


def test_the_share_is_said_where_only_some_points_lie_on_it():
    mixed = POINTS.copy()
    mixed[: len(mixed) // 2] = mixed[: len(mixed) // 2].round(3)
    assert only(mixed).message == "the coordinates of 50% of the points are rounded to 1 mm"


@pytest.mark.parametrize(
    ("size_m", "text"), [(0.0994, "99.4 mm"), (0.1, "0.1 m"), (0.004, "4 mm"), (1.25, "1.25 m"), (3320.0, "3,320 m")]
)
def test_lengths_as_sentences_name_them(size_m, text):
    assert size_text(size_m) == text


def test_doubled_surfaces_are_said_with_their_distance():
    other = Stair(n_steps=5, spacing=0.012, noise=0.002, risers=True, floor_depth=1.2, seed=9).sample()[0]
    points = np.concatenate([POINTS, other + 0.75 * ABOVE])
    found = only(points)
    assert (found.code, found.size_m) == ("surfaces_doubled", pytest.approx(0.015, abs=5e-4))
    assert found.message.startswith("surfaces are double, 1")
    assert "register" in found.cure
    assert np.linalg.norm(examine(scan_of(points)).layers_m, axis=1).max() == found.size_m
    assert examine(scan_of(POINTS)).layers_m.shape == (0, 3)


def test_a_copy_is_said_once_and_not_as_doubled_surfaces_too():
    found = only(np.concatenate([POINTS, POINTS + ABOVE]))
    assert (found.code, found.size_m) == ("cloud_copied", pytest.approx(0.02))
    assert found.message == "the cloud holds itself twice, shifted by 20 mm"
    assert np.abs(examine(scan_of(np.concatenate([POINTS, POINTS + ABOVE]))).layers_m) == pytest.approx(
        np.array([ABOVE]), abs=5e-4
    )


def test_a_mirror_image_is_said_with_its_axis():
    found = only(np.concatenate([POINTS, POINTS * [-1.0, 1.0, 1.0]]))
    assert found.code == "cloud_mirrored"
    assert "across x = 0" in found.message
    codes = [found.code for found in said(np.concatenate([POINTS, POINTS * [-1.0, 1.0, 1.0]]).round(3))]
    assert codes == ["coordinates_rounded", "cloud_mirrored"]


@pytest.mark.parametrize(("spacing", "is_sparse"), [(0.03, False), (0.045, False), (0.07, True)])
def test_too_few_points_for_a_tread(spacing, is_sparse):
    points = Stair(n_steps=8, spacing=spacing, noise=0.002, width=2.0, floor_depth=4.0, risers=True).sample()[0]
    found = said(points)
    assert [observation.code for observation in found] == ["points_sparse"] * is_sparse
    if is_sparse:
        assert found[0].size_m == pytest.approx(spacing, rel=0.2)
        assert "where 100 are needed" in found[0].message


def doubled(apart_m):
    return Observation(
        "surfaces_doubled", "doubt", f"surfaces are double, {apart_m:g} m apart", apart_m, "register again"
    )


@pytest.mark.parametrize(
    ("apart_m", "registration_m", "level"),
    [(0.0149, 0.0, "doubt"), (0.015, 0.0, "question"), (0.02, 0.0099, "question"), (0.02, 0.01, "doubt")],
)
def test_surfaces_that_are_double_by_much_are_asked_about_until_the_registration_is_stated(
    apart_m, registration_m, level
):
    stated = UncertaintyParams(registration_m=registration_m)
    (found,) = with_questions((doubled(apart_m),), stated)
    assert found.level == level
    # What answers it is a flag that does.
    if level == "question":
        value = float(found.cure.split()[1].rstrip(","))
        assert found.cure.startswith("--uncertainty.registration-m ")
        assert with_questions((doubled(apart_m),), UncertaintyParams(registration_m=value))[0].level == "doubt"


def test_a_copy_beside_itself_is_asked_about_and_one_farther_off_is_not():
    for size_m, level in ((0.018, "question"), (0.3, "question"), (0.5, "doubt"), (6.0, "doubt")):
        copy = Observation("cloud_copied", "doubt", "twice", size_m, "take it out")
        (found,) = with_questions((copy,), UncertaintyParams())
        assert (found.level, "take it out" in found.cure) == (level, True)


def test_nothing_else_is_asked_about():
    others = (Observation("cloud_copied", "doubt", "twice", 0.5), Observation("surfaces_doubled", "doubt", "unknown"))
    assert with_questions(others, UncertaintyParams()) == others
