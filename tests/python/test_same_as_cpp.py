# SPDX-License-Identifier: BSD-3-Clause
"""Results in Python and C++ are bitwise identical."""

import json
import os
import subprocess

import numpy as np
import pytest
from surfaces import command_replay, poses, run

import keepout

loop = os.environ.get("KEEPOUT_CPP_LOOP")
command = os.environ.get("KEEPOUT_COMMAND")
needs_loop = pytest.mark.skipif(not loop, reason="KEEPOUT_CPP_LOOP names no program")
needs_command = pytest.mark.skipif(not command, reason="KEEPOUT_COMMAND names no program")

settings = {"tool_radius": 0.3, "margin": 0.2}  # as in cpp_loop


@pytest.fixture(params=["sphere_file", "skull_file"])
def surface(request):
    path = request.getfixturevalue(request.param)
    return path, keepout.load_mesh(path)


def cpp_steps(path, lines, memory, folder):
    lines.tofile(folder / "poses")
    subprocess.run([loop, path, folder / "poses", folder / "answers", memory, "1"], check=True)
    return np.fromfile(folder / "answers").reshape(-1, 5)


def assert_same(steps, answers):
    assert len(answers) > 1000
    np.testing.assert_array_equal(steps.motion.view(np.int64), answers[:, :3].copy().view(np.int64))
    np.testing.assert_array_equal(steps.status, answers[:, 3])
    np.testing.assert_array_equal(steps.planes, answers[:, 4])
    assert len(steps.counts()) > 2  # several statuses


@needs_loop
def test_a_batch_on_any_number_of_threads(surface, tmp_path):
    path, mesh = surface
    lines = poses(mesh.vertices, 2000)
    guard = keepout.MotionConstraint(mesh, **settings)
    answers = cpp_steps(path, lines, "anew", tmp_path)
    for threads in (1, 2, 5):
        assert_same(guard.steps(lines[:, :3], lines[:, 3:], threads=threads), answers)


@needs_loop
def test_single_steps_and_a_replay(surface, tmp_path):
    path, mesh = surface
    lines = poses(mesh.vertices, 2000, seed=2, spread=0.4)
    guard = keepout.MotionConstraint(mesh, **settings)
    answers = cpp_steps(path, lines, "remembering", tmp_path)
    assert_same(guard.replay(lines), answers)
    single = [guard.step(line[:3], line[3:]) for line in lines]
    motions = np.array([step.motion for step in single])
    np.testing.assert_array_equal(motions.view(np.int64), answers[:, :3].copy().view(np.int64))
    np.testing.assert_array_equal([int(step.status) for step in single], answers[:, 3])
    np.testing.assert_array_equal([len(step.planes) for step in single], answers[:, 4])


@needs_command
@pytest.mark.parametrize("closed_loop", [False, True])
def test_the_replay_of_the_command(sphere_file, closed_loop, tmp_path):
    mesh = keepout.load_mesh(sphere_file)
    lines = poses(mesh.vertices, 1500, seed=3)
    if closed_loop:
        turn = np.linspace(0, 20, len(lines))[:, None]
        goals = 9.5 * np.hstack([np.cos(turn), np.sin(turn), np.sin(3 * turn) / 2])
        lines = np.hstack([goals, np.broadcast_to([12.0, 0, 0], goals.shape)])
    flags = ["--closed-loop", "--max-step", "0.5"] if closed_loop else []
    motion, names, planes = command_replay(
        sphere_file, lines, tmp_path, "--tool-radius", "0.3", "--margin", "0.2", *flags)
    guard = keepout.MotionConstraint(mesh, **settings)
    steps = guard.replay(lines, closed_loop=closed_loop, max_step=0.5)
    np.testing.assert_array_equal(steps.motion, motion)
    assert [keepout.Status(s).name for s in steps.status] == names
    np.testing.assert_array_equal(steps.planes, planes)


@needs_command
def test_the_inspection_of_the_command(sphere_file):
    told = json.loads(run(command, "inspect", sphere_file, "--json", "--self-intersections"))
    found = keepout.load_mesh(sphere_file).inspect(self_intersections=True)
    for name in (name for name in dir(found) if not name.startswith("_") and name != "looks_like_metres"):
        value = getattr(found, name)
        if name in ("low", "high"):
            assert list(value) == told["bounds"][name]
        elif name == "places":
            assert not any(len(places) for places in value.values()) and not told["findings"]
        elif name != "unused_vertices":
            assert value == told[name], name
