# SPDX-License-Identifier: BSD-3-Clause
import keepout
import numpy as np
import pytest
from test_distance_field import BALL, box

from experiments import e5_distance_field as e5
from experiments.rules.signed_distance_field import SignedDistanceField, VoxelGrid
from experiments.rules.rule import Task

PLATE = keepout.Index(box([-30, -30, 0.2], [30, 30, 0.8]))
TRUTH = e5.Truth(PLATE.mesh)


def walls_of(index):
    return e5.walls_at(index, *e5.surface_points(index.mesh, np.random.default_rng(1), 400))


def test_a_plate_is_a_wall_as_thick_as_it_is_and_a_ball_is_none():
    walls = walls_of(PLATE)
    assert len(walls.half) > 350  # all except those at the rim
    assert walls.half == pytest.approx(0.3, abs=1e-4)
    assert walls.middle[:, 2] == pytest.approx(0.5, abs=1e-4)
    assert len(walls_of(keepout.Index(BALL)).half) == 0


def test_exact_distances_have_the_sign_of_the_side():
    points = np.array([[0, 0, 0.4], [0, 0, 1.0], [0, 0, 0.1]])
    assert TRUTH.distances(points) == pytest.approx([-0.2, 0.2, 0.1])
    turned = keepout.Mesh(PLATE.mesh.vertices, PLATE.mesh.triangles[:, ::-1])
    assert e5.Truth(turned).distances(points) == pytest.approx([0.2, -0.2, -0.1])


def test_a_way_through_a_plate_enters_though_both_its_ends_are_free():
    assert TRUTH.entered(np.array([[0, 0, 2.0], [0, 0, -1.0]]))
    assert TRUTH.entered(np.array([[0, 0, 2.0], [0, 0, 0.5]]))
    assert not TRUTH.entered(np.array([[0, 0, 2.0], [0, 0, 1.0]]))


@pytest.mark.parametrize("cell, lost", [(1.0, 1.0), (0.25, 0.0)])
def test_a_plate_is_lost_to_the_grid_that_does_not_see_it_and_passed(cell, lost):
    grid = VoxelGrid(PLATE.mesh, PLATE, cell, [-31, -31, -3], [31, 31, 3])
    assert e5.lost_walls(grid, walls_of(PLATE))["lost_4_cells"] == lost
    starts, wanted = e5.pushes_at(TRUTH, walls_of(PLATE), np.random.default_rng(2), 10)
    rule = SignedDistanceField(Task(PLATE.mesh), PLATE, cell, grid)
    found = e5.pushed(lambda: rule, TRUTH, starts, wanted)
    assert (found["entered"], found["passed"]) == (10 * lost, 10 * lost)
    assert found["deepest"] == pytest.approx(0.3 * lost, abs=0.06)
    certified = keepout.MotionConstraint(PLATE.mesh, index=PLATE, margin=0.2)

    class Certified:
        def step(self, tip, desired):
            return certified.step(tip, desired).motion

    kept = e5.pushed(Certified, TRUTH, starts, wanted)
    assert kept["entered"] == 0 and kept["least_distance"] == pytest.approx(0.2, abs=1e-6)


def test_a_grid_of_a_plate_aligned_with_it_has_no_error_near_its_middle():
    plate = keepout.Index(box([-30, -30, -2], [30, 30, 0]))
    grid = VoxelGrid(plate.mesh, plate, 0.5, [-6] * 3, [6] * 3)
    points = np.random.default_rng(3).uniform([-5, -5, -0.4], [5, 5, 3], (500, 3))
    found = e5.errors(grid, e5.Truth(plate.mesh), points)
    assert found["error_max"] < 1e-6
    assert found["error_points"] == np.sum(np.abs(points[:, 2]) < e5.NEAR)
