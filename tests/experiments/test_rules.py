# SPDX-License-Identifier: BSD-3-Clause
"""Tests the rules of the experiments in situations with a known result."""
import numpy as np
import pytest

import keepout

peers = pytest.importorskip("keepout_peers")

from experiments.modes import make_rule
from experiments.rules.closest_points_2007 import ClosestPoints2007
from experiments.rules.rule import Corridor, Task

MARGIN = 0.2
TURNING = ["all_faces", "paper", "certified", "closest_points_2007", "vector_field"]
SHORTENING = ["fcl_continuous", "bullet_sweep"]

#: The plane z = 0 for |x|, |y| <= 50, free above. CORNER adds a wall at x = 0 that is free for x > 0.
FLOOR = np.array([[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], dtype=float)
CORNER = np.array([[0, -50, 0], [50, -50, 0], [50, 50, 0], [0, 50, 0], [0, -50, 50], [0, 50, 50]],
                  dtype=float)
TWO_OF_A_QUAD = [(0, 1, 2), (0, 2, 3)]
#: CE5 of fixtures/src/counterexamples.cpp: the rule of Li et al. (2020) lets the tip pass through.
OCTAHEDRON = np.array([[4, 1, 0], [-3, 2, -2], [6, 4, 1], [1, -6, -2], [-6, 3, 4], [0, -2, -1]],
                      dtype=float)
OF_OCTAHEDRON = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4),
                 (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


def rule_on(mode, vertices, triangles, **task):
    mesh = keepout.Mesh(vertices, triangles)
    return make_rule(mode, Task(mesh, **({"margin": MARGIN} | task)), keepout.Index(mesh))


def corner_rule(mode):
    return rule_on(mode, CORNER, [*TWO_OF_A_QUAD, (0, 3, 5), (0, 5, 4)])


@pytest.mark.parametrize("mode", TURNING + SHORTENING)
def test_free_motion_is_not_changed(mode):
    rule = rule_on(mode, FLOOR, TWO_OF_A_QUAD)
    for desired in ([0.3, 0.1, -0.7], [0.0, -1.0, 0.0], [0.1, 0.0, 2.0]):
        assert np.array_equal(rule.step(np.array([1.0, 2.0, 1.0]), np.array(desired)), desired)


@pytest.mark.parametrize("mode", TURNING)
def test_a_motion_into_a_plane_slides_along_it(mode):
    rule = rule_on(mode, FLOOR, TWO_OF_A_QUAD)
    motion = rule.step(np.array([1.0, 2.0, 1.0]), np.array([0.3, 0.1, -2.0]))
    assert motion == pytest.approx([0.3, 0.1, -0.8], abs=1e-7)


@pytest.mark.parametrize("mode, gap", [("fcl_continuous", 0.1), ("bullet_sweep", 0.001)])
def test_a_library_stops_at_contact_and_does_not_turn(mode, gap):
    rule = rule_on(mode, FLOOR, TWO_OF_A_QUAD)
    desired = np.array([0.3, 0.1, -2.0])
    share = rule.step(np.array([1.0, 2.0, 1.0]), desired) / desired
    assert share == pytest.approx(np.full(3, share[0]))
    assert 0.4 - gap / 2.0 - 1e-9 <= share[0] <= 0.4 + 1e-12


@pytest.mark.parametrize("mode", TURNING + SHORTENING)
def test_a_plane_is_kept_out_of_in_closed_loop(mode):
    rule = rule_on(mode, FLOOR, TWO_OF_A_QUAD)
    judge = peers.Judge(FLOOR, TWO_OF_A_QUAD)
    random = np.random.default_rng(5)
    tips = [np.array([0.0, 0.0, 1.0])]
    for _ in range(200):
        desired = random.normal(scale=0.3, size=3) - [0.0, 0.0, 0.3]
        tips.append(tips[-1] + rule.step(tips[-1], desired))
    assert judge.least_distances(tips[:-1], tips[1:]).min() >= MARGIN - 1e-6
    assert tips[-1][2] < MARGIN + 0.2  # the tip was pressed against the plane


def test_closest_points_keep_both_faces_of_a_valley_and_one_nearest_point_does_not():
    tip, desired = np.array([0.5, 0.0, 0.4]), np.array([-2.0, 0.1, -2.0])
    assert corner_rule("closest_points_2007").step(tip, desired) == pytest.approx([-0.3, 0.1, -0.2])
    assert (tip + corner_rule("vector_field").step(tip, desired))[0] < 0.0  # through the wall


def test_a_point_on_an_edge_is_a_closest_point_only_if_its_triangles_agree():
    # Above the ridge, the closest point of both faces is on the edge. Beside it, one face has a nearer point.
    ridge = np.array([[0, -5, 0], [0, 5, 0], [-5, 0, -5], [5, 0, -5]], dtype=float)
    mesh = keepout.Mesh(ridge, [(0, 1, 2), (1, 0, 3)])
    rule = ClosestPoints2007(Task(mesh, margin=MARGIN), keepout.Index(mesh))
    over = rule.step(np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.5, -2.0]))
    assert over == pytest.approx([0.0, 0.5, -0.8])
    down = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)  # along the face at the right
    up = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    beside = rule.step(2.0 * down + 0.5 * up, -3.0 * down)
    assert beside == pytest.approx(-3.0 * down)  # a plane of the ridge would forbid this motion


@pytest.mark.parametrize("mode", ["closest_points_2007", "vector_field"])
def test_a_tip_that_is_too_near_is_led_out(mode):
    motion = rule_on(mode, FLOOR, TWO_OF_A_QUAD).step(np.array([1.0, 2.0, 0.1]), np.zeros(3))
    assert motion == pytest.approx([0.0, 0.0, 0.05])


@pytest.mark.parametrize("mode", ["closest_points_2007", "vector_field"])
def test_a_tip_that_got_in_is_led_out_again(mode):
    rule = rule_on(mode, FLOOR, TWO_OF_A_QUAD)
    tip = np.array([1.0, 2.0, -0.12])
    for _ in range(20):
        tip = tip + rule.step(tip, np.array([0.0, 0.0, -0.01]))
    assert tip == pytest.approx([1.0, 2.0, MARGIN])


@pytest.mark.parametrize("mode", TURNING[2:] + SHORTENING)
def test_the_corridor_is_kept_as_well(mode):
    corridor = Corridor(point=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), half_width=0.5)
    rule = rule_on(mode, FLOOR, TWO_OF_A_QUAD, corridor=corridor)
    motion = rule.step(np.array([0.0, 0.3, 3.0]), np.array([1.0, 1.0, -1.0]))
    assert motion == pytest.approx([1.0, 0.2, -1.0], abs=1e-7)


@pytest.mark.parametrize("mode, passes", [("paper", True), ("certified", False)])
def test_the_paper_s_rule_lets_a_counterexample_through(mode, passes):
    margin = 0.0 if mode == "paper" else 1e-3  # as in the publication
    rule = rule_on(mode, OCTAHEDRON, OF_OCTAHEDRON, margin=margin, radius=2.1)
    tip = np.array([3.5, -0.5, -0.75])
    end = tip + rule.step(tip, np.array([0.6382, 1.7526, 0.8442]))
    assert peers.Judge(OCTAHEDRON, OF_OCTAHEDRON).crossings([tip], [end])[0] == passes
