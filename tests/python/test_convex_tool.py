# SPDX-License-Identifier: BSD-3-Clause
"""Tests convex tools and their descriptions as text."""

import os

import numpy as np
import pytest
from surfaces import command_replay, poses

import keepout
from keepout import ConvexTool, Status

command = os.environ.get("KEEPOUT_COMMAND")
corners = np.array([[0, 0, 0], [1, 0, 2], [-1, 0, 2], [0, 1, 2]], dtype=np.float32)

# Texts, and the tools that they describe.
tools = {
    "sphere:1.5": ConvexTool.sphere(1.5),
    "capsule:0,0,0:2.5,0,2.5:0.5": ConvexTool.capsule((0, 0, 0), [2.5, 0, 2.5], 0.5),
    "blade:4:2:0.5": ConvexTool.box((-1, -0.25, 0), (1, 0.25, 4)),
    "hull:0,0,0:1,0,2:-1,0,2:0,1,2:0.25": ConvexTool.hull(corners, radius=0.25),
}
phases = [part.name for part in keepout.narrow_phases()]


@pytest.mark.skipif(not command, reason="KEEPOUT_COMMAND names no program")
@pytest.mark.parametrize("phase", phases)
@pytest.mark.parametrize("text", tools)
def test_steps_are_those_of_the_command_bit_for_bit(text, phase, sphere_file, tmp_path):
    mesh = keepout.load_mesh(sphere_file)
    lines = poses(1.3 * mesh.vertices, 300 if phase == "exact" else 20, seed=8)
    motion, names, _ = command_replay(sphere_file, lines, tmp_path, "--tool", text, "--narrow-phase", phase)
    steps = keepout.MotionConstraint(mesh, tool=tools[text], narrow_phase=phase).replay(lines)
    np.testing.assert_array_equal(steps.motion, motion)
    assert [Status(s).name for s in steps.status] == names


@pytest.mark.parametrize("phase", phases)
@pytest.mark.parametrize("text", tools)
def test_a_loop_never_brings_the_tool_nearer_than_the_margin(text, phase, mesh):
    tool = tools[text].rotated([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    guard = keepout.MotionConstraint(mesh, tool=tool, narrow_phase=phase, margin=0.2)
    random = np.random.default_rng(9)
    tip = np.array([1.0, 2.0, 14.0])
    statuses, nearest = set(), []
    for cycle in range(200 if phase == "exact" else 25):
        aim = 3 * random.normal(size=3)  # somewhere inside
        step = guard.step(tip, 0.5 * (aim - tip) / np.linalg.norm(aim - tip))
        tip = tip + step.motion
        statuses.add(step.status)
        # Sampled points of the core bound the tool's distance from above, without a narrow phase.
        weights = random.dirichlet(np.full(len(tool.points), 0.3), size=50)
        core = tip + np.vstack([tool.points, weights @ tool.points])
        nearest.append(guard.index.distances(core).min() - tool.radius)
    assert min(nearest) > 0.2 - 1e-9 and Status.limited in statuses
    assert min(nearest) < 0.25, "it never came near"


def test_a_guard_tells_its_tool_and_a_text_is_the_tool_made_by_hand(mesh):
    for text, tool in tools.items():
        guard = keepout.MotionConstraint(mesh, tool=ConvexTool.of_text(text))
        np.testing.assert_array_equal(guard.tool.points, tool.points)
        assert guard.tool.radius == tool.radius and repr(tool) in repr(guard)
        assert guard.free_polytope((0, 0, 20), 1).status is keepout.Status.unsupported
    assert keepout.MotionConstraint(mesh).tool is None
