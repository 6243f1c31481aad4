# SPDX-License-Identifier: BSD-3-Clause
"""Tests views without copies, lifetimes, and results that are written in place."""

import gc
import sys
import weakref

import numpy as np
import pytest
from surfaces import sphere

import keepout


def address(array):
    return array.__array_interface__["data"][0]


def test_arrays_of_a_mesh_are_its_own_memory():
    mesh = keepout.Mesh(*sphere())
    for name in ("vertices", "triangles", "normals"):
        first, second = getattr(mesh, name), getattr(mesh, name)
        assert np.shares_memory(first, second) and address(first) == address(second)
        assert not first.flags.writeable and first.base is mesh
        with pytest.raises(ValueError):
            first[0, 0] = 1
        with pytest.raises(ValueError):
            first.flags.writeable = True
    assert mesh.vertices.dtype == np.float64 and mesh.triangles.dtype == np.uint32


def test_a_view_outlives_its_mesh():
    mesh = keepout.Mesh(*sphere())
    expected = mesh.vertices.copy(), mesh.normals.copy()
    views = mesh.vertices, mesh.normals
    del mesh
    gc.collect()
    junk = [np.random.default_rng(i).normal(size=views[0].shape) for i in range(20)]
    np.testing.assert_array_equal(views[0], expected[0])
    np.testing.assert_array_equal(views[1], expected[1])
    assert len(junk) == 20


def test_what_is_given_is_copied():
    vertices, triangles = sphere()
    mesh = keepout.Mesh(vertices, triangles)
    kept = mesh.vertices.copy()
    vertices[:] = 7
    np.testing.assert_array_equal(mesh.vertices, kept)


def test_views_of_steps_outlive_everything(mesh):
    guard = keepout.MotionConstraint(mesh)
    step = guard.step((0.1, 0.2, 10.5), (0, 0, -1))
    normals, offsets, motion = step.planes.normals, step.planes.offsets, step.motion
    assert np.shares_memory(normals, step.planes.normals) and len(normals) > 0
    kept = normals.copy(), offsets.copy(), motion.copy()
    guard.step((0, 5.0, 14), (0, 0, -1))
    hits = guard.index.hits((0, 0, 10), 2.0)
    distances = hits.distances
    assert np.shares_memory(distances, hits.distances)
    polytope = guard.free_polytope((0, 0, 11), 2.0)
    faces = polytope.normals
    of_hits, of_polytope = distances.copy(), faces.copy()
    del step, guard, hits, polytope
    gc.collect()
    junk = [np.full(64, float(i)) for i in range(1000)]
    for now, before in zip((normals, offsets, motion), kept):
        np.testing.assert_array_equal(now, before)
    np.testing.assert_array_equal(distances, of_hits)
    np.testing.assert_array_equal(faces, of_polytope)
    assert len(junk) == 1000


def test_a_constraint_keeps_its_mesh():
    guard = keepout.MotionConstraint(keepout.Mesh(*sphere()))
    gc.collect()
    assert guard.step((0, 0, 10.5), (0, 0, -1)).ok and len(guard.mesh) > 0


def test_nothing_is_leaked(guard, outside):
    tips, desired = outside
    views = [sys.getrefcount(tips), sys.getrefcount(desired), sys.getrefcount(keepout.Status.free)]
    out = keepout.Steps.empty(len(tips))
    for _ in range(20):
        guard.steps(tips, desired, out=out)
        guard.step(tips[0], desired[0]).status
    gc.collect()
    now = [sys.getrefcount(tips), sys.getrefcount(desired), sys.getrefcount(keepout.Status.free)]
    assert now == views
    steps = guard.steps(tips, desired)
    motion = weakref.ref(steps.motion)
    del steps
    assert motion() is None


def test_results_are_written_where_they_are_wanted(guard, outside):
    tips, desired = outside
    out = keepout.Steps.empty(len(tips))
    where = address(out.motion)
    assert guard.steps(tips, desired, out=out) is out and address(out.motion) == where
    np.testing.assert_array_equal(out.motion, guard.steps(tips, desired).motion)
    # The caller may pass parts of arrays of their own.
    many = np.zeros((4, len(tips), 3))
    own = keepout.Steps(many[2], out.status, out.planes)
    guard.steps(tips, desired, out=own)
    np.testing.assert_array_equal(many[2], out.motion)
    assert not many[[0, 1, 3]].any()
    poses = np.hstack([tips, desired])
    assert guard.replay(poses, out=out) is out
    room = keepout.Simulation.empty(2, 5)
    hands = np.zeros((2, 5, 3))
    assert guard.simulate(tips[:2], hands, out=room) is room and room.tips.any()


def test_places_that_cannot_be_written_to(guard, outside):
    tips, desired = outside
    n = len(tips)
    good = keepout.Steps.empty(n)
    shared = np.zeros((n, 3))

    def refused(says, **arrays):
        names = ("motion", "status", "planes")
        given = {name: arrays.get(name, getattr(good, name)) for name in names}
        with pytest.raises(keepout.Error, match=says):
            guard.steps(tips, desired, out=keepout.Steps(**given))

    refused(r"out.motion: .* float64 of shape \(500, 3\), got shape", motion=np.zeros((n + 1, 3)))
    refused("out.motion: .* got dtype float32", motion=np.zeros((n, 3), np.float32))
    refused("out.status: .* got dtype int64", status=np.zeros(n, int))
    refused("out.status: .* got NoneType", status=None)
    refused("out.motion: .*C-contiguous", motion=np.zeros((3, n)).T)
    refused("out.motion: .*C-contiguous", motion=np.zeros((n, 6))[:, ::2])
    frozen = np.zeros((n, 3))
    frozen.flags.writeable = False
    refused("out.motion: .* read-only", motion=frozen)
    refused("out.motion: .* shares it", motion=tips)
    refused("out.planes: .* shares it", planes=shared.reshape(-1).view(np.uint32)[:n], motion=shared)
    with pytest.raises(keepout.Error, match="out.motion: "):
        guard.steps(tips, desired, out=np.zeros((n, 3)))
