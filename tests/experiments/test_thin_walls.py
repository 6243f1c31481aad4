# SPDX-License-Identifier: BSD-3-Clause
import keepout
import numpy as np
import pytest
from test_distance_field import BALL, box

from experiments import e5_distance_field as e5
from experiments.modes import make_rule
from experiments.rules import native
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


def test_pushes_close_to_each_other_are_at_one_wall():
    walls = walls_of(PLATE).where(slice(None))
    near = e5.Walls(*(np.repeat(each[:1], 3, axis=0) for each in (walls.front, walls.inwards)), walls.half[:3],
                    np.repeat(walls.middle[:1], 3, axis=0))
    near.front[:, 0] += [0.0, 2.0, 12.0]
    pushes = e5.pushes_at(TRUTH, near, np.random.default_rng(2), 3)
    order = np.argsort(pushes.starts[:, 0])
    assert pushes.wall[order[0]] == pushes.wall[order[1]] != pushes.wall[order[2]]
    np.testing.assert_allclose(np.linalg.norm(pushes.desired, axis=1), np.hypot(e5.PUSH, e5.SLIDE))


@pytest.mark.parametrize("cell, lost", [(1.0, True), (0.25, False)])
def test_a_plate_is_passed_if_the_field_does_not_see_it(cell, lost):
    pushes = e5.pushes_at(TRUTH, walls_of(PLATE), np.random.default_rng(2), 10)
    task = Task(PLATE.mesh, e5.MARGIN)
    found = e5.pushed(native.distance_field(task, cell=cell), TRUTH, pushes)
    assert found["loops"] == 10 and len(found["entered"]) == 10 * lost
    assert found["deepest"] == pytest.approx(0.3 * lost, abs=0.06)
    kept = e5.pushed(make_rule("certified", task), TRUTH, pushes)
    assert kept["entered"] == [] and kept["least_distance"] == pytest.approx(e5.MARGIN, abs=1e-6)
    assert kept["lost"] == pytest.approx(0.0, abs=1e-9)


def test_a_field_of_a_plate_aligned_with_it_has_no_error_near_its_middle_and_refuses_only_what_it_is_inflated_by():
    plate = box([-30, -30, -2], [30, 30, 0])
    field, truth = native.field_of(plate, 0.5, e5.MARGIN), e5.Truth(plate)
    points = np.random.default_rng(3).uniform([-5, -5, -0.4], [5, 5, 3], (2000, 3))
    found = e5.errors(field, truth, points)
    assert found["error_max"] < 1e-6
    assert found["error_points"] == np.sum(np.abs(points[:, 2]) < e5.MARGIN + field.error_bound)
    assert e5.refused_space(field, truth, points, e5.MARGIN) == pytest.approx(0.0, abs=1e-3)
    inflated = e5.refused_space(field, truth, points, e5.MARGIN + field.error_bound)
    assert inflated == pytest.approx(field.error_bound / (e5.NEAR - e5.MARGIN), abs=0.03)


def test_a_wall_counts_once():
    ours, theirs = {"entered": [1, 1, 1, 2, 3, 4, 5, 6]}, {"entered": [2]}
    # Five walls of one rule against none: 2 / 2^5. The wall where both let in as many does not count.
    assert e5.walls_test([ours], [theirs]) == pytest.approx(2.0 / 2**5)
    assert e5.walls_test([theirs], [ours]) == pytest.approx(2.0 / 2**5)
    assert e5.walls_test([ours, ours], [theirs, theirs]) == pytest.approx(2.0 / 2**10)
    assert e5.walls_test([ours], [ours]) == 1.0
