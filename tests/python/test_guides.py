# SPDX-License-Identifier: BSD-3-Clause
"""Tests guides: regions for a tip, an axis or a shaft, beside a mesh."""

import math

import numpy as np
import pytest
from surfaces import at, box, psm

import keepout

TIP = (0.0, 10.2, 0.0)  # of the instrument below, on link 6


cube = keepout.Mesh(*box(-10, 10))


def instrument():
    """Returns an instrument whose shaft passes through a port, 150 above the origin of the cube."""
    chain = psm(at(0, 0, 150), at(*TIP))
    shaft = keepout.Body("shaft", [(0, (0, 0, 0)), (4, (0, 0, 0))], 4.5)
    cutter = keepout.Body("cutter", [(5, (9.1, 0, 0)), (6, TIP)], 1.0)
    return keepout.Instrument(chain, [shaft, cutter])


def test_corridor_and_mesh_hold_at_once():
    guard = keepout.MotionConstraint(cube, radius=5, tool_radius=1, margin=0.2)
    tip = np.array([0.0, 0.0, 14.0])
    corridor = keepout.Region.slab(tip, (1, 0, 0), 1.0)
    guard.set_guides([keepout.Guide.point("corridor", corridor)])
    random = np.random.default_rng(1)
    held = 0
    for _ in range(500):
        step = guard.step(tip, random.uniform(-0.5, 0.5, 3) + (0.2, 0, -0.2))
        assert step.ok, step.reason
        tip = tip + step.motion
        assert corridor.excess(tip) <= 0.002 + 1e-9
        assert tip[2] >= 11.2 - 1e-9
        held += step.guides[0].limits
    assert held > 50
    guard.set_guides([])
    assert guard.step(tip, (0.5, 0, 0)).guides == []


def test_what_contradicts_gives_way_and_says_so():
    guard = keepout.MotionConstraint(cube, radius=5, margin=0.2)
    left = keepout.Region.half_space((-1, 0, 0), (-1, 0, 0))
    right = keepout.Region.half_space((1, 0, 0), (1, 0, 0))
    guard.set_guides([keepout.Guide.point("left", left), keepout.Guide.point("right", right)])
    step = guard.step((0, 0, 15), (0.3, 0.3, 0))
    assert step.status == keepout.Status.recovering
    assert step.relaxation == "guides"
    assert all(guide.relaxed for guide in step.guides)
    assert step.motion[0] == pytest.approx(0.0, abs=1e-7)
    assert step.motion[1] == pytest.approx(0.3, abs=1e-7)
    assert "relaxed" in repr(step.guides[0])


def test_of_a_tip_are_regions_alone_and_hold_in_batches():
    guard = keepout.MotionConstraint(cube, radius=5, margin=0.2)
    with pytest.raises(keepout.Error, match="is for a link of an instrument.*a guide of a point without a link"):
        guard.set_guides([keepout.Guide.axis("axis", 6, (0, 1, 0), (0, 0, 1), 0.2)])
    corridor = keepout.Region.slab((0, 0, 15), (1, 0, 0), 1.0)
    tips = np.tile((0.0, 0.0, 15.0), (20, 1))
    desired = np.tile((3.0, 0.0, 0.0), (20, 1))
    free = guard.steps(tips, desired, threads=2).motion
    guard.set_guides([keepout.Guide.point("corridor", corridor)])
    guided = guard.steps(tips, desired, threads=2).motion
    assert np.all(free[:, 0] == 3.0)
    assert np.all(np.abs(guided[:, 0] - 1.0) <= 0.002)
    step = guard.step(tips[0], desired[0])
    assert step.limits == ("guide",) and np.array_equal(step.motion, guided[0])


def test_a_text_is_the_guide_that_it_describes():
    tip, desired = (0.0, 0.0, 15.0), (3.0, 1.0, -0.5)
    corridor = keepout.Guide.point("corridor", keepout.Region.slab((0, 0, 15), (1, 0, 0), 1.0))
    steps = []
    for guides in (["corridor=slab:0,0,15:1,0,0:1", "ball:0,0,15:4"],
                   (corridor, keepout.Guide.of_text("ball:0,0,15:4"))):
        guard = keepout.MotionConstraint(cube, tool="sphere:1", margin=0.2)
        guard.set_guides(guides)
        steps.append(guard.step(tip, desired))
    assert steps[0].limits == ("guide",) and [state.limits for state in steps[0].guides] == [True, False]
    np.testing.assert_array_equal(steps[0].motion, steps[1].motion)
    guide = keepout.Guide.of_text("corridor=slab:0,0,15:1,0,0:1")
    assert guide.name == "corridor" and guide.kind == "point"
    assert guide.region.excess((3, 0, 0)) == corridor.region.excess((3, 0, 0)) == 2.0
    assert repr(guide) == "<keepout.Guide 'corridor' of a point>"
    # Guides of an instrument. A rejected text changes nothing.
    arm = keepout.InstrumentGuard(cube, instrument(), check_sides=False)
    at = arm.instrument.chain.forward_kinematics([0.0, 0.0, 60.0, 0.0, 0.0, 0.0])[:3, 3]
    near = "near=point:6:0,10.2,0:ball:{},{},{}:1".format(*at)
    arm.set_guides([near])
    with pytest.raises(keepout.Error, match="link 7"):
        arm.set_guides([near.replace(":6:", ":7:")])
    by = (0.0, 0.0, 4.0, 0.0, 0.0, 0.0)
    assert arm.prove((0.0, 0.0, 60.0, 0.0, 0.0, 0.0), by).fraction == pytest.approx(0.25, abs=1 / 64 + 1e-9)


def test_tip_axis_and_trocar_are_kept_on_the_way():
    guard = keepout.InstrumentGuard(cube, instrument(), period=0.02, check_sides=False)
    chain = guard.instrument.chain
    q = np.array([0.1, -0.1, 60.0, 0.2, 0.1, -0.2])
    pose = chain.forward_kinematics(q)
    tip = pose[:3, 3]
    axis = pose[:3, 1]
    guides = [
        keepout.Guide.point("tube", 6, TIP, keepout.Region.tube(tip, (0, 0, 1), 2.0)),
        keepout.Guide.axis("axis", 6, (0, 1, 0), axis, 0.2),
    ]
    guard.set_guides(guides)
    random = np.random.default_rng(2)
    held = np.zeros(2)
    for cycle in range(600):
        way = 1.0 if cycle // 100 % 2 else -1.0
        step = guard.step(
            q, linear=way * random.uniform(0, 1, 3), angular=random.uniform(-0.05, 0.05, 3)
        )
        assert step.ok, step.reason
        for share in (0.5, 1.0):
            at = chain.forward_kinematics(q + share * step.increment)
            assert guides[0].region.excess(at[:3, 3]) <= 0.002 + 1e-8
            angle = math.acos(min(1.0, at[:3, 1] @ axis))
            assert angle <= 0.2 + 0.0003
        q = q + step.increment
        held += [state.limits for state in step.guides]
    assert (held > 20).all(), held


def test_a_proof_ends_where_a_guide_is_left():
    guard = keepout.InstrumentGuard(cube, instrument(), check_sides=False)
    q = np.array([0.0, 0.0, 60.0, 0.0, 0.0, 0.0])
    by = np.array([0.0, 0.0, 4.0, 0.0, 0.0, 0.0])
    assert guard.prove(q, by).is_clear
    tip = guard.instrument.chain.forward_kinematics(q)[:3, 3]
    guard.set_guides([keepout.Guide.point("near", 6, TIP, keepout.Region.ball(tip, 1.0))])
    assert guard.prove(q, by).fraction == pytest.approx(0.25, abs=1 / 64 + 1e-9)
    assert guard.proofs(q, by).fraction[0] == pytest.approx(0.25, abs=1 / 64 + 1e-9)


def test_orientation_and_remote_center():
    guard = keepout.InstrumentGuard(cube, instrument(), period=0.02, check_sides=False)
    chain = guard.instrument.chain
    q = np.array([0.1, 0.1, 80.0, 0.0, 0.2, 0.1])
    start = chain.forward_kinematics(q)[:3, :3]
    guides = keepout.Guide.orientation("hand", 6, start, 0.1)
    assert [guide.name for guide in guides] == ["hand x", "hand y", "hand z"]
    guides.append(
        keepout.Guide.remote_center("port", (0, (0, 0, 0)), (4, (0, 0, 0)), (0, 0, 150), 0.5)
    )
    guard.set_guides(guides)
    for _ in range(200):
        step = guard.step(q, angular=(0.02, 0.03, 0.01))
        assert step.ok, step.reason
        q = q + step.increment
    turn = start.T @ chain.forward_kinematics(q)[:3, :3]
    angle = math.acos(min(1.0, (np.trace(turn) - 1) / 2))
    assert angle < 0.1 + 0.001
    assert angle > 0.05
