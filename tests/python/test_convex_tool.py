# SPDX-License-Identifier: BSD-3-Clause
"""Convex tools by name."""

import csv
import os
import subprocess

import numpy as np
import pytest
from surfaces import poses

import keepout
from keepout import ConvexTool, Status

command = os.environ.get("KEEPOUT_COMMAND")
corners = np.array([[0, 0, 0], [1, 0, 2], [-1, 0, 2], [0, 1, 2]], dtype=np.float32)

# A text, and the tool that it is.
tools = {
    "sphere:1.5": ConvexTool.sphere(1.5),
    "capsule:0,0,0:2.5,0,2.5:0.5": ConvexTool.capsule((0, 0, 0), [2.5, 0, 2.5], 0.5),
    "box:-1,-0.5,-0.25:1,0.5,0.25": ConvexTool.box((-1, -0.5, -0.25), (1, 0.5, 0.25)),
    "blade:4:2:0.5": ConvexTool.box((-1, -0.25, 0), (1, 0.25, 4)),
    "hull:0,0,0:1,0,2:-1,0,2:0,1,2:0.25": ConvexTool.hull(corners, radius=0.25),
}
each_tool = pytest.mark.parametrize("text", tools)


@each_tool
def test_a_text_is_the_tool_made_by_hand(text):
    tool = ConvexTool.of_text(text)
    np.testing.assert_array_equal(tool.points, tools[text].points)
    assert tool.radius == tools[text].radius and f"of {len(tool.points)} points" in repr(tool)
    assert not tool.points.flags.writeable


@pytest.mark.skipif(not command, reason="KEEPOUT_COMMAND names no program")
@each_tool
def test_steps_are_those_of_the_command_bit_for_bit(text, sphere_file, tmp_path):
    mesh = keepout.load_mesh(sphere_file)
    lines = poses(1.3 * mesh.vertices, 300, seed=8)
    np.savetxt(tmp_path / "poses.txt", lines, fmt="%.17g")
    for part in keepout.narrow_phases():
        some = slice(None) if part.name == "exact" else slice(20)
        # fmt: off
        subprocess.run(
            [command, "replay", sphere_file, "--poses", tmp_path / "poses.txt", "--out",
             tmp_path / "steps.csv", "--tool", text, "--narrow-phase", part.name],
            check=True, capture_output=True)
        # fmt: on
        with open(tmp_path / "steps.csv", newline="") as file:
            rows = list(csv.DictReader(file))[some]
        guard = keepout.MotionConstraint(mesh, tool=tools[text], narrow_phase=part.name)
        steps = guard.replay(lines[some])
        motion = np.array([[float(row[axis]) for axis in ("ux", "uy", "uz")] for row in rows])
        np.testing.assert_array_equal(steps.motion, motion)
        assert [Status(s).name for s in steps.status] == [row["status"] for row in rows]
        single = [guard.step(line[:3], line[3:]).motion for line in lines[some]]
        np.testing.assert_array_equal(single, motion)


@pytest.mark.parametrize("part", [part.name for part in keepout.narrow_phases()])
@each_tool
def test_a_loop_never_brings_the_tool_nearer_than_the_margin(text, part, mesh):
    tool = tools[text]
    guard = keepout.MotionConstraint(mesh, tool=tool, narrow_phase=part, margin=0.2)
    triangles = mesh.vertices[mesh.triangles]
    random = np.random.default_rng(9)
    tip, aim = np.array([1.0, 2.0, 14.0]), np.zeros(3)
    statuses, nearest = set(), []
    for cycle in range(200 if part == "exact" else 25):
        if cycle % 20 == 0:
            aim = 3 * random.normal(size=3)  # somewhere inside
        desired = aim - tip
        step = guard.step(tip, 0.5 * desired / np.linalg.norm(desired))
        tip = tip + step.motion
        statuses.add(step.status)
        nearest.append(tool.separations(tip, triangles).min())
        # By points of the tool, of which none is nearer than the whole: they know no kernel.
        weights = random.dirichlet(np.full(len(tool.points), 0.3), size=50)
        core = tip + np.vstack([tool.points, weights @ tool.points])
        assert guard.index.distances(core).min() - tool.radius > 0.2 - 1e-9
    assert min(nearest) > 0.2 - 1e-9 and Status.limited in statuses
    assert min(nearest) < 0.2 + 1e-6, "it never came near"


def test_separations_are_signed_and_per_triangle():
    triangles = np.array([[[-9, -9, 0], [9, -9, 0], [0, 9, 0]], [[-9, -9, 5], [9, -9, 5], [0, 9, 5]]])
    tool = ConvexTool.capsule((0, 0, 0), (0, 0, 2), 0.5)
    np.testing.assert_allclose(tool.separations((0, 0, 1), triangles), [0.5, 1.5], rtol=1e-14)
    assert tool.separations((0, 0, -1), triangles)[0] < -0.5
    assert np.isnan(tool.separations((0, 0, np.nan), triangles)).all()
    assert tool.separations((0, 0, 0), np.zeros((0, 3, 3))).shape == (0,)
    upside_down = tool.rotated(np.diag([1, -1, -1]))
    np.testing.assert_allclose(upside_down.separations((0, 0, 4), triangles)[0], 1.5, rtol=1e-14)


def test_a_guard_tells_its_tool(mesh):
    guard = keepout.MotionConstraint(mesh, tool=tools["blade:4:2:0.5"])
    np.testing.assert_array_equal(guard.tool.points, tools["blade:4:2:0.5"].points)
    assert "tool=<keepout.ConvexTool of 8 points, radius 0>" in repr(guard)
    assert keepout.MotionConstraint(mesh).tool is None
    assert guard.free_polytope((0, 0, 20), 1).status == "whole_tool"


@pytest.mark.parametrize(
    "make, says",
    [
        (lambda: ConvexTool.sphere(-1), "radius of a convex tool"),
        (lambda: ConvexTool.sphere(np.nan), "radius of a convex tool"),
        (lambda: ConvexTool.capsule((0, 0), (0, 0, 1), 1), "start: expected"),
        (lambda: ConvexTool.box((0, 0, 0), (1, -1, 1)), "low: expected numbers that are not above"),
        (lambda: ConvexTool.hull(corners.T), r"points: expected numbers of shape \(n, 3\)"),
        (lambda: ConvexTool.hull(np.zeros((0, 3))), "1 to 64 points"),
        (lambda: ConvexTool.hull(np.random.rand(65, 3)), "1 to 64 points"),
        (lambda: ConvexTool.sphere(1).rotated(2 * np.eye(3)), "rotation"),
        (lambda: ConvexTool.of_text("spere:1"), "no tool 'spere'; write sphere:R"),
        (lambda: ConvexTool.sphere(1).separations((0, 0, 0), corners), r"triangles: .*\(m, 3, 3\)"),
    ],
)
def test_what_is_no_tool_is_told(make, says):
    with pytest.raises(keepout.Error, match=says):
        make()


@pytest.mark.parametrize(
    "settings, says",
    [
        ({"tool_radius": 0.5}, "leave tool_radius at 0"),
        ({"activation": "all_faces"}, "leave activation at 'certified'"),
        ({"narrow_phase": "exakt"}, "did you mean 'exact'"),
        ({"tool": None, "narrow_phase": "ccd_gjk"}, "is for a convex tool"),
    ],
)
def test_settings_that_contradict_each_other_are_told(mesh, settings, says):
    with pytest.raises(keepout.Error, match=says):
        keepout.MotionConstraint(mesh, **{"tool": ConvexTool.sphere(1), **settings})
    with pytest.raises(TypeError):
        keepout.MotionConstraint(mesh, tool="sphere:1")
