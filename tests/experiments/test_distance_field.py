# SPDX-License-Identifier: BSD-3-Clause
"""Tests the narrow band of distances, and the rules that use it."""
import keepout
import numpy as np
import pytest
import surfaces

peers = pytest.importorskip("keepout_peers")

from experiments.rules import native
from experiments.rules.rule import Corridor, Task


def box(low, high):
    return keepout.Mesh(*surfaces.box(low, high))


BALL = keepout.Mesh(*surfaces.sphere(128, 10.0))
PLATE = box([-20, -20, -4], [20, 20, 0])


def field_of(mesh, cell, band):
    return peers.DistanceField(native.terrain_of(mesh), cell, band)


def rule_of(mesh, cell, use, **task):
    return native.distance_field(Task(mesh, **task), cell=cell, use=use)


def around_the_ball(count, near=8.0, far=12.0):
    random = np.random.default_rng(2)
    radii = random.uniform(near, far, count)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return radii, directions


@pytest.mark.parametrize("cell", [0.25, 1.0])
def test_distances_and_gradients_of_a_ball_are_exact_to_second_order_of_a_cell(cell):
    field = field_of(BALL, cell, 5.0)
    radii, directions = around_the_ball(300)
    points = radii[:, None] * directions
    # The distance has curvature 1 / r in two directions, so the interpolation errs by at most cell^2 / 4 r. The
    # triangles of the ball are up to 0.02 mm inside the sphere.
    found = field.distances(points)
    assert np.abs(found - (radii - 10.0)).max() < cell**2 / (4 * 8.0) + 0.02
    assert np.abs(field.gradients(points) - directions).max() < cell * 0.35
    assert (found[radii < 9.9] < 0).all() and (found[radii > 10.1] > 0).all()


def test_the_gradient_is_that_of_the_interpolation():
    field = field_of(BALL, 1.0, 20.0)
    places = np.random.default_rng(3).uniform(-12, 12, (50, 3))
    places = np.floor(places) + 0.2 + 0.6 * (places - np.floor(places))  # not near a cell's side
    for axis in range(3):
        step = np.eye(3)[axis] * 1e-3
        difference = field.distances(places + step) - field.distances(places - step)
        assert field.gradients(places)[:, axis] == pytest.approx(difference / 2e-3, abs=1e-5)


@pytest.mark.parametrize("turned", [False, True])
def test_beyond_the_band_the_distance_is_the_band_with_the_sign_of_the_side(turned):
    triangles = BALL.triangles[:, ::-1] if turned else BALL.triangles
    field = field_of(keepout.Mesh(BALL.vertices, triangles), 0.5, 1.5)
    sign = -1.0 if turned else 1.0  # normals that point inwards: everything outside is solid
    points = np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 12.1, 0.0]])
    assert field.distances(points) == pytest.approx(sign * np.array([-1.5, 1.5, 1.5]))
    assert (field.gradients(points) == 0.0).all()


def test_the_order_of_reading_does_not_change_a_value():
    radii, directions = around_the_ball(200)
    points = radii[:, None] * directions
    whole, lazy = field_of(BALL, 0.5, 1.5), field_of(BALL, 0.5, 1.5)
    whole.sample([-12.0] * 3, [12.0] * 3)
    np.testing.assert_array_equal(whole.distances(points), lazy.distances(points[::-1])[::-1])


def test_memory_is_that_of_the_blocks_near_the_surface():
    field = field_of(BALL, 0.5, 1.5)
    assert field.sample([-14.0] * 3, [14.0] * 3) == field.memory_of_all()
    shell = 4.0 / 3.0 * np.pi * (11.5**3 - 8.5**3) / 0.5**3 * 4  # without the rest of each block
    assert shell < field.memory_of_all() < 6.0 * shell
    assert field.sample([40.0] * 3, [60.0] * 3) == 0


def test_no_distance_errs_by_more_than_the_bound_also_at_a_plate_thinner_than_a_cell():
    plate = box([-6, -6, 0.2], [6, 6, 0.3])
    field = field_of(plate, 1.0, 3.0)
    points = np.random.default_rng(4).uniform([-7, -7, -1.5], [7, 7, 2.0], (4000, 3))
    exact = native.terrain_of(plate).judge().distances(points)
    assert 0.3 < np.abs(field.distances(points) - exact).max() <= field.error_bound


def test_an_open_mesh_has_distances_without_sign():
    closed = box([-4, -4, -4], [4, 4, 4])
    opened = keepout.Mesh(closed.vertices, closed.triangles[2:])
    assert field_of(closed, 1.0, 3.0).is_signed and not field_of(opened, 1.0, 3.0).is_signed
    inside = np.random.default_rng(5).uniform(-3.5, 3.5, (50, 3))
    assert (field_of(closed, 1.0, 3.0).distances(inside) < 0.0).all()
    assert (field_of(opened, 1.0, 3.0).distances(inside) > 0.0).all()


@pytest.mark.parametrize("use, passes", [("plane", True), ("cut", True), ("sure", False)])
def test_a_plate_thinner_than_a_cell_is_lost_but_not_to_a_proof(use, passes):
    plate = box([-6, -6, 0.2], [6, 6, 0.8])  # between two layers of voxels
    field = native.field_of(plate, 1.0, 0.2)
    assert field.distances([[0.3, 0.4, 0.5]])[0] > 0.0
    rule = rule_of(plate, 1.0, use)
    tip = np.array([0.3, 0.4, 3.5])
    for _ in range(100):
        tip = tip + rule.step(tip, np.array([0.0, 0.0, -0.1]))
    assert tip[2] < 0.0 if passes else tip[2] > 0.8 + 0.2


def test_only_the_proof_keeps_the_margin_in_pushes_at_a_gear():
    """Every step of the inflated field is judged, from starts at its enlarged margin."""
    mesh = keepout.Mesh(*peers.named_mesh("gear"))
    terrain = native.terrain_of(mesh)
    field = native.field_of(mesh, 0.5, 0.2)
    judge, steps = terrain.judge(), 0
    for seed in range(14):
        route = peers.ROUTES[seed % 7]
        start = peers.start(terrain, route, 0.7, 2.0, seed)
        if field.distances([start])[0] < 0.2 + field.error_bound:
            continue
        found = peers.push(judge, rule_of(mesh, 0.5, "sure", radius=1.0), peers.PointPusher(terrain, route, 1.0, seed),
                           start, margin=0.2, cycles=200)
        assert found["clearance"] >= 0.2 - 1e-6
        steps += found["steps"]
    assert steps >= 1000


def test_a_plane_lets_the_tip_go_below_the_margin_and_a_cut_does_not():
    # Towards a rim that the gradient at the start does not show: a long motion ends in the material.
    tip, desired = np.array([-20.6, 0.1, 1.1]), np.array([1.5, 0.0, -1.5])
    field = native.field_of(PLATE, 0.25, 0.2)
    ends = {use: tip + rule_of(PLATE, 0.25, use, radius=3.0).step(tip, desired) for use in ("plane", "cut")}
    assert field.distances(ends["plane"][None])[0] < 0.0
    way = tip + np.linspace(0.0, 1.0, 500)[:, None] * (ends["cut"] - tip)
    assert field.distances(way).min() >= 0.2 - 1e-6
    assert ends["cut"][0] > tip[0] + 0.5  # it slides on


@pytest.mark.parametrize("use", ["plane", "cut"])
def test_the_rule_keeps_the_margin_off_a_plane_and_lets_the_tip_slide(use):
    rule = rule_of(PLATE, 0.5, use)
    tip = np.array([0.1, 0.1, 1.0])
    for _ in range(40):
        tip = tip + rule.step(tip, np.array([0.05, 0.0, -0.1]))
        assert tip[2] >= 0.2 - 1e-6
    assert tip == pytest.approx([0.1 + 40 * 0.05, 0.1, 0.2], abs=1e-5)


def test_the_corridor_is_kept_besides():
    rule = rule_of(PLATE, 0.5, "cut", corridor=Corridor((0, 0, 0), (0, 1, 0), 1.0))
    tip = np.array([0.1, 0.1, 1.0])
    for _ in range(40):
        tip = tip + rule.step(tip, np.array([0.0, 0.1, -0.1]))
    assert tip == pytest.approx([0.1, 1.0, 0.2], abs=1e-5)


def test_a_band_narrower_than_two_cells_is_refused():
    with pytest.raises(ValueError, match="band"):
        field_of(PLATE, 1.0, 1.5)
