# SPDX-License-Identifier: BSD-3-Clause
"""Compares the judge of the experiments with the exact distances of a box."""
import keepout
import numpy as np
import pytest
import surfaces

peers = pytest.importorskip("keepout_peers")

CORNERS, TRIANGLES = surfaces.box(-1.0, 1.0)


def box_distance(points):
    """Returns the signed distance of points from the box with corners at -1 and 1; below 0 inside."""
    beyond = np.abs(points) - 1.0
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
    return outside + np.minimum(beyond.max(axis=-1), 0.0)


@pytest.fixture
def judge():
    return peers.Terrain(CORNERS, TRIANGLES).judge()


@pytest.fixture
def motions():
    random = np.random.default_rng(3)
    starts = random.uniform(-2.0, 2.0, (400, 3))
    return starts, starts + random.normal(scale=0.8, size=(400, 3))


def test_distances_have_the_sign_of_the_side(judge, motions):
    points = np.vstack(motions)
    assert judge.closed
    assert judge.distances(points) == pytest.approx(box_distance(points), abs=1e-12)


def test_an_open_mesh_has_no_inside(motions):
    judge = peers.Terrain(CORNERS, TRIANGLES[:-2]).judge()
    assert not judge.closed
    assert (judge.distances(motions[0]) >= 0.0).all()


def test_motions_that_touch_cross(judge, motions):
    starts, ends = motions
    sides = (np.array([-1.0, 1.0])[:, None, None] - starts) / (ends - starts)  # fractions at the planes of the box
    enters, leaves = sides.min(axis=0).max(axis=1), sides.max(axis=0).min(axis=1)
    meets_box = (enters <= leaves) & (enters <= 1.0) & (leaves >= 0.0)
    stays_inside = (box_distance(starts) < 0.0) & (box_distance(ends) < 0.0)
    assert stays_inside.any() and 0 < meets_box.sum() < len(starts)
    assert np.array_equal(judge.crossings(starts, ends), meets_box & ~stays_inside)


def test_the_best_step_slides_at_the_margin(judge):
    motion, cost, bound = judge.best_step([0.0, 0.0, 1.5], [0.3, 0.0, -1.0], 0.2)
    assert motion == pytest.approx([0.3, 0.0, -0.3], abs=1e-5)
    assert cost == pytest.approx(0.7, abs=1e-5)
    assert bound <= cost
    free, cost, _ = judge.best_step([0.0, 0.0, 1.5], [0.3, 0.0, 1.0], 0.2)
    assert np.array_equal(free, [0.3, 0.0, 1.0]) and cost == 0.0


def test_what_makes_no_sense_is_refused(judge):
    with pytest.raises(ValueError, match="finite"):
        judge.distances([[0.0, 0.0, np.nan]])
    with pytest.raises(ValueError, match="each start"):
        judge.crossings(np.zeros((2, 3)), np.zeros((1, 3)))
    with pytest.raises(ValueError, match="on the mesh"):
        judge.best_step([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], 0.2)


def test_errors_of_keepout_stay_its_own(tmp_path):
    with pytest.raises(keepout.Error):
        keepout.load_mesh(tmp_path / "missing.stl")
