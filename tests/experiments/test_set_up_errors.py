# SPDX-License-Identifier: BSD-3-Clause
"""Tests the errors of a registration against theory, the cutting of bone, and places along a path."""
import keepout
import numpy as np
import pytest
from experiments.bone import BoneProperties
from experiments.planned_path import PlannedPath
from experiments.set_up_errors import SetUp, fiducials_around, registered_from_true
from trial_in_python import Bone, coordinates, moved, place_at

UP = np.array([0.0, 0.0, 1.0])


def straight_path(length: float = 30.0, spacing: float = 0.05) -> PlannedPath:
    along = np.arange(0.0, length + spacing / 2, spacing)
    flat = np.zeros_like(along)
    return PlannedPath(
        np.stack([flat, along, flat], 1), np.tile(UP, (len(along), 1)), np.array([1.0, 0.0, 0.0]), spacing
    )


def test_registration_errs_as_target_error_predicts() -> None:
    place = np.array([10.0, 20.0, 30.0])
    fiducials = fiducials_around(place, UP)
    errors = []
    for seed in range(3000):
        registered = registered_from_true(SetUp(fle=0.65), fiducials, np.random.default_rng(seed))
        errors.append(registered(place) - place)
    fit = keepout.fit_rigid(fiducials, fiducials)
    predicted = np.sqrt(np.trace(keepout.target_error(fit, place, fle=0.65)))
    assert np.sqrt(np.mean(np.sum(np.square(errors), axis=1))) == pytest.approx(predicted, rel=0.05)


def test_a_registration_and_its_inverse_cancel() -> None:
    fiducials = fiducials_around(np.zeros(3), UP)
    registered = registered_from_true(SetUp(), fiducials, np.random.default_rng(1))
    points = np.random.default_rng(2).uniform(-50, 50, (20, 3))
    assert registered.inverse()(registered(points)) == pytest.approx(points, abs=1e-9)
    assert np.abs(registered(points) - points).max() > 0.01


def test_an_ideal_set_up_has_no_error() -> None:
    registered = registered_from_true(SetUp.ideal(), fiducials_around(np.zeros(3), UP), np.random.default_rng(1))
    points = np.random.default_rng(2).uniform(-50, 50, (20, 3))
    assert np.array_equal(registered(points), points)


def pressed(bone: Bone, place: tuple[float, float, float], cycles: int) -> tuple[np.ndarray, float]:
    """Returns the place of a tip, and its force, after pressing towards a place from 1 mm above it."""
    across, along, depth = place
    bone.press(np.array([across, along, 1.0]), 0.001)
    for _ in range(cycles):
        tip, force = bone.press(np.array([across, along, -depth]), 0.001)
    return tip, force


def test_bone_is_cut_as_fast_as_it_is_pressed() -> None:
    properties = BoneProperties(resistance=2.5)
    bone = Bone(straight_path(), properties, tip_stiffness=4.0)
    cut, depth, forces = [], 0.0, []
    for cycle in range(4000):
        depth = 0.0003 * cycle  # 0.3 mm/s
        tip, force = bone.press(np.array([0.0, 15.0, -depth]), 0.001)
        cut.append(-tip[2])
        forces.append(force)
    feed = (cut[-1] - cut[-1001]) / 1.0
    # The blade covers whole cells: 21 by 11, so slightly more than its length by its width.
    area = 21 * 11 * 0.05**2 / (properties.blade * properties.kerf)
    assert feed == pytest.approx(0.3, rel=0.01)
    assert forces[-1] == pytest.approx(properties.resistance * area * 0.3, rel=0.01)
    assert depth - cut[-1] == pytest.approx(forces[-1] / 4.0)


def test_behind_the_shell_the_tool_falls_through() -> None:
    bone = Bone(straight_path(), BoneProperties(), tip_stiffness=4.0)
    bone.press(np.array([0.0, 15.0, 1.0]), 0.001)
    held = []
    for _ in range(20000):
        tip, force = bone.press(np.array([0.0, 15.0, -3.0]), 0.001)
        held.append((-tip[2], force))
    cut = np.array([depth for depth, _ in held])
    through = int(np.argmax(cut > 2.0))
    before, after = cut[through - 1] - cut[through - 101], cut[through + 100] - cut[through]
    assert after > 5.0 * before
    assert cut[-1] == pytest.approx(3.0, abs=1e-6)


def test_the_walls_of_a_kerf_resist_in_proportion_to_the_depth_of_engagement() -> None:
    moved = []
    for depth in (0.5, 1.0):
        bone = Bone(straight_path(), BoneProperties(), tip_stiffness=4.0)
        pressed(bone, (0.0, 15.0, depth), 30_000)
        tip, _ = bone.press(np.array([0.02, 15.0, -depth]), 0.001)  # within its cell
        moved.append(tip[0])
    assert moved[0] == pytest.approx(2.0 * moved[1], rel=0.01)
    assert 0.0 < moved[1] < 0.001
    in_air, force = Bone(straight_path(), BoneProperties(), 4.0).press(np.array([0.02, 15.0, 0.5]), 0.001)
    assert in_air[0] == 0.02 and force == 0.0


def test_an_open_kerf_leads_the_blade_along_and_down_without_force() -> None:
    bone = Bone(straight_path(), BoneProperties(), tip_stiffness=4.0)
    pressed(bone, (0.0, 15.0, 1.0), 30_000)
    tip, force = pressed(bone, (0.0, 15.0, 0.9), 1)
    assert tip[2] == pytest.approx(-0.9) and force == pytest.approx(0.0, abs=1e-9)


def test_a_second_pass_beside_the_first_widens_the_cut() -> None:
    bone = Bone(straight_path(), BoneProperties(), tip_stiffness=4.0)
    widths = []
    for across in (0.0, 0.6):
        pressed(bone, (across, 15.0, 1.0), 30_000)
        columns = np.flatnonzero((bone.cut > 0.5).any(axis=0))
        widths.append((columns[-1] - columns[0] + 1) * 0.05)
    assert widths == pytest.approx([0.55, 1.15])


def test_places_are_told_by_along_across_and_depth() -> None:
    path = straight_path()
    along, across, depth = path.depths(np.array([[0.3, 12.0, -0.7], [-0.2, 40.0, 1.0]]))
    assert along == pytest.approx([12.0, 30.0], abs=path.spacing)
    assert across == pytest.approx([0.3, -0.2])
    assert depth == pytest.approx([0.7, -1.0])


def test_coordinates_and_places_are_inverse() -> None:
    y = np.arange(0.0, 30.01, 0.05)
    z = 0.01 * (y - 15.0) ** 2
    slope = 0.02 * (y - 15.0)
    up = np.stack([np.zeros_like(y), -slope, np.ones_like(y)], axis=1)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    path = PlannedPath(np.stack([np.zeros_like(y), y, z], axis=1), up, np.array([1.0, 0.0, 0.0]), 0.05)
    for given in ((10.0, 0.3, 0.0), (21.234, -0.5, 0.0)):
        assert coordinates(path, place_at(path, *given)) == pytest.approx(given, abs=1e-3)
    deep = place_at(path, 10.0, 0.2, 1.5)
    assert coordinates(path, deep)[1:] == pytest.approx((0.2, 1.5), abs=0.02)
    assert coordinates(path, np.array([0.0, -4.0, 1.0]))[0] == 0.0


def test_one_point_moves_like_many() -> None:
    registered = registered_from_true(SetUp(), fiducials_around(np.zeros(3), UP), np.random.default_rng(1))
    point = np.array([3.0, -2.0, 5.0])
    assert moved(registered, point) == pytest.approx(registered(point[None])[0], abs=1e-12)
