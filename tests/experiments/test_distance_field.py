# SPDX-License-Identifier: BSD-3-Clause
import keepout
import numpy as np
import pytest
import surfaces

from experiments.rules.rule import Corridor, Task
from experiments.rules.signed_distance_field import SignedDistanceField, VoxelGrid
from experiments.sides import lattice_is_solid


def box(low, high):
    return keepout.Mesh(*surfaces.box(low, high))


BALL = keepout.Mesh(*surfaces.sphere(128, 10.0))


def grid_of(mesh, cell, low, high):
    return VoxelGrid(mesh, keepout.Index(mesh), cell, low, high)


def test_sides_of_a_ball_also_on_lines_through_its_vertices_and_edges():
    places = np.indices((25, 25, 25)).reshape(3, -1).T - 12.0  # the axes pass through vertices
    far = np.linalg.norm(places, axis=1)
    sure = (far < 9.9) | (far > 10.0 + 1e-9)
    solid = lattice_is_solid(BALL, np.full(3, -12.0), 1.0, (25, 25, 25)).ravel()
    np.testing.assert_array_equal(solid[sure], far[sure] < 10.0)


def test_a_mesh_inside_out_is_solid_all_around():
    turned = keepout.Mesh(BALL.vertices, BALL.triangles[:, ::-1])
    lattice = (np.full(3, -12.1), 0.7, (35, 35, 35))
    np.testing.assert_array_equal(lattice_is_solid(turned, *lattice), ~lattice_is_solid(BALL, *lattice))


def test_parts_that_overlap_stay_solid():
    one, other = box([0, 0, 0], [4, 4, 4]), box([2, 2, 2], [6, 6, 6])
    both = keepout.Mesh(
        np.vstack([one.vertices, other.vertices]), np.vstack([one.triangles, other.triangles + 8]))
    solid = lattice_is_solid(both, np.ones(3), 2.0, (3, 3, 3))
    assert solid[0, 0, 0] and solid[1, 1, 1] and solid[2, 2, 2] and not solid[0, 0, 2]


@pytest.mark.parametrize("cell", [1.0, 0.5])
def test_distances_of_a_ball_err_by_the_square_of_the_cell(cell):
    grid = grid_of(BALL, cell, [-13] * 3, [13] * 3)
    random = np.random.default_rng(2)
    far = random.uniform(8.0, 12.0, 300)
    directions = random.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = np.array([grid.look(*p) for p in far[:, None] * directions])
    # The distance has curvature 1 / r in two directions, so the interpolation errs by at most cell^2 / 4 r. The
    # triangles of the ball are up to 0.02 mm inside the sphere.
    assert np.abs(found[:, 0] - (far - 10.0)).max() < cell**2 / (4 * 8.0) + 0.02
    assert np.abs(found[:, 1:] - directions).max() < cell * 0.35
    assert (found[far < 9.9, 0] < 0).all() and (found[far > 10.1, 0] > 0).all()


def test_the_gradient_is_that_of_the_interpolation():
    grid = grid_of(BALL, 1.0, [-13] * 3, [13] * 3)
    for place in np.random.default_rng(3).uniform(-12, 12, (50, 3)):
        place = np.floor(place) + 0.2 + 0.6 * (place - np.floor(place))  # not near a cell's side
        for axis in range(3):
            step = np.eye(3)[axis] * 1e-3
            difference = grid.look(*(place + step))[0] - grid.look(*(place - step))[0]
            assert grid.look(*place)[1 + axis] == pytest.approx(difference / 2e-3, abs=1e-6)


@pytest.mark.parametrize("thickness, seen", [(0.6, False), (2.5, True)])
def test_a_plate_thinner_than_a_cell_is_lost(thickness, seen):
    plate = box([-20, -20, 0.2], [20, 20, 0.2 + thickness])  # 0.2 above a layer of voxels
    grid = grid_of(plate, 1.0, [-5] * 3, [5] * 3)
    assert (grid.distances(np.array([[0.3, 0.4, 0.2 + 0.5 * thickness]]))[0] < 0.0) == seen
    rule = SignedDistanceField(Task(plate), keepout.Index(plate), 1.0, grid)
    tip = np.array([0.3, 0.4, 3.5])
    for _ in range(100):
        tip = tip + rule.step(tip, np.array([0.0, 0.0, -0.1]))
    # The tip stays above the thick plate, and passes through the thin one.
    assert tip[2] > 2.7 if seen else tip[2] < 0.0


def test_an_open_mesh_has_distances_without_sign():
    closed = box([-4, -4, -4], [4, 4, 4])
    opened = keepout.Mesh(closed.vertices, closed.triangles[2:])
    assert grid_of(closed, 1.0, [-6] * 3, [6] * 3).is_signed
    grid = grid_of(opened, 1.0, [-6] * 3, [6] * 3)
    assert not grid.is_signed and (grid.values >= 0.0).all()


def test_outside_of_the_grid_every_motion_is_free():
    mesh = box([-4, -4, -4], [4, 4, 4])
    rule = SignedDistanceField(Task(mesh), keepout.Index(mesh), 0.5)
    desired = np.array([-100.0, 0.0, 0.0])
    np.testing.assert_array_equal(rule.step(np.array([50.0, 0.0, 0.0]), desired), desired)


def test_the_rule_keeps_the_margin_off_a_plane_and_lets_the_tip_slide():
    mesh = box([-40, -40, -4], [40, 40, 0])
    grid = grid_of(mesh, 0.5, [-4] * 3, [4] * 3)
    rule = SignedDistanceField(Task(mesh, margin=0.2), keepout.Index(mesh), 0.5, grid)
    tip = np.array([0.1, 0.1, 1.0])
    for _ in range(40):
        tip = tip + rule.step(tip, np.array([0.05, 0.0, -0.1]))
        assert tip[2] >= 0.2 - 1e-6
    assert tip == pytest.approx([0.1 + 40 * 0.05, 0.1, 0.2], abs=1e-5)


def test_the_corridor_is_kept_besides():
    mesh = box([-40, -40, -4], [40, 40, 0])
    corridor = Corridor((0, 0, 0), (0, 1, 0), 1.0)
    rule = SignedDistanceField(Task(mesh, corridor=corridor), keepout.Index(mesh), 0.5)
    assert rule.grid.values.shape[1] == 2 * (1 + 5) * 2 + 1  # the corridor's width, and around it
    tip = np.array([0.1, 0.1, 1.0])
    for _ in range(40):
        tip = tip + rule.step(tip, np.array([0.0, 0.1, -0.1]))
    assert tip == pytest.approx([0.1, 1.0, 0.2], abs=1e-5)


def test_trials_share_a_grid():
    mesh = box([-4, -4, -4], [4, 4, 4])
    index, task = keepout.Index(mesh), Task(mesh)
    grid = SignedDistanceField(task, index, 1.0).grid
    assert SignedDistanceField(task, index, 1.0).grid is grid
    assert SignedDistanceField(task, index, 0.5).grid is not grid


def test_a_box_too_large_is_refused():
    mesh = box([-4, -4, -4], [4, 4, 4])
    with pytest.raises(ValueError):
        grid_of(mesh, 0.001, [-4] * 3, [4] * 3)
