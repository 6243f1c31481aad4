# SPDX-License-Identifier: BSD-3-Clause
"""Tests instruments: chains, bodies, and the guard that keeps them out of a mesh."""

import os
from pathlib import Path

import numpy as np
import pytest
from surfaces import at, psm, sphere

import keepout
from keepout import Body, Chain, Instrument, InstrumentGuard, Joint, Status, TableRow

robots = Path(__file__).resolve().parents[2] / "fixtures" / "robots"
wall = keepout.Mesh(
    [[-200, -200, 0], [200, -200, 0], [200, 200, 0], [-200, 200, 0]], [[0, 1, 2], [0, 2, 3]]
)
ball = keepout.Mesh(*sphere(64, 50.0))


def psm_guard(**options):
    """Returns a guard of a psm. At q[2] = 106.3, its tip is 10 mm above the top of a sphere of radius 50 mm."""
    port, wrist, yaw = (0, (0, 0, 0)), (4, (0, 0, 0)), (5, (9.1, 0, 0))
    bodies = [
        Body("shaft", [port, wrist], 4.5),
        Body("wrist", [wrist, yaw], 3.0),
        Body("jaws", [yaw, (6, (0, 10.2, 0))], 1.0),
    ]
    return InstrumentGuard(ball, Instrument(psm(at(0, 0, 170)), bodies), margin=0.5, **options)


def lever_guard(**options):
    """Returns a guard of a 60 mm shaft of radius 2 that one joint turns down to the wall, 20 mm below."""
    turn = Joint("turn", axis=(0, 1, 0), lower=-1, upper=1, velocity=2)
    chain = Chain([turn], base=at(0, 0, 20), flange=at(60, 0, 0))
    shaft = Body("shaft", [(1, (0, 0, 0)), (1, (60, 0, 0))], 2.0)
    return InstrumentGuard(wall, Instrument(chain, [shaft]), margin=0.5, band=0.01, **options)


def test_a_work_budget_that_ends_is_reported():
    guard = lever_guard(max_work_units=1)
    step = guard.step([0.28], increment=[0.01])
    assert step.status is Status.out_of_budget and "max_work_units" in step.reason
    assert not step.ok and step.increment.tolist() == [0.0] and "budget" in step.limits
    assert lever_guard().step([0.28], increment=[0.01]).ok


def test_an_arm_far_from_everything_is_told_what_limits_it():
    guard = lever_guard()
    for asked in ({"increment": [1.0]}, {"linear": (0, 0, 50)}):
        step = guard.step([0.0], **asked)
        assert step.status is Status.limited and step.limits == ("joint_velocity",), asked
        assert "triangle" not in step.reason and "plane" not in step.reason
    step = guard.step([-1.0], increment=[-0.001])
    assert step.status is Status.limited and step.limits == ("joint_position",)
    step = guard.step([-1.2], increment=[0.0])
    assert step.status is Status.free and step.limits == ("joints_outside",)
    assert "a joint starts outside its position limits" in step.reason


def test_the_shaft_stops_at_the_wall():
    down = {"linear": (0, 0, -0.1)}
    for asked in (down, {**down, "angular": (0, 0.002, 0)}, {"increment": [0.002]}):
        guard, q = lever_guard(), np.zeros(1)
        held = 0
        for _ in range(400):
            step = guard.step(q, **asked)
            assert step.ok and step.increment.shape == (1,) and abs(step.increment[0]) <= 0.002 + 1e-12
            held += step.status is Status.limited
            q = q + step.increment
        clearance = 20 - 60 * np.sin(q[0]) - 2
        assert 0.49 - 1e-9 <= clearance <= 0.5 + 1e-6, asked
        assert held > 100 and step.nearest == 0 and step.rows >= 1 and step.rounds >= 1
        np.testing.assert_allclose(step.distance, clearance, atol=1e-9)
        back = guard.step(q, increment=[-0.001])
        np.testing.assert_allclose(back.increment, [-0.001], atol=1e-12)


def test_joints_nearest_to_an_increment_are_weighed_and_keep_their_limits():
    axes = [Joint(n, kind="prismatic", axis=a, lower=-50, upper=50) for n, a in zip("xyz", np.eye(3))]
    chain = Chain(axes, base=at(0, 0, 10))
    guard = InstrumentGuard(wall, Instrument(chain, [Body("tip", [(3, (0, 0, 0))], 1.0)]), margin=0.5)
    free = guard.step([49.5, 0, 0], increment=[1, 2, -3], weights=[1, 2, 3])
    np.testing.assert_allclose(free.increment, [0.5, 2, -3], atol=1e-9)
    held = guard.step([0, 0, -8], linear=(0.2, 0, -1))
    assert held.status is Status.limited
    np.testing.assert_allclose(held.increment, [0.2, 0, -0.5], atol=0.004)
    close = guard.step([0, 0, -8.9], linear=(0, 0, 0))
    assert close.status is Status.recovering and close.increment[2] > 0
    np.testing.assert_allclose(close.distance, 0.1, atol=1e-9)
    bad = guard.step([0, np.nan, 0], linear=(0, 0, 0))
    assert bad.status is Status.invalid_input and list(bad.increment) == [0, 0, 0]
    assert not bad.ok and "finite" in bad.reason and bad.nearest is None and bad.distance is None


def test_what_is_proven_is_almost_all_that_is_clear():
    guard = lever_guard()
    clear = np.arcsin(17.51 / 60)
    for motion in (0.2, 0.4, 0.8):
        proof = guard.prove([0.0], [motion])
        true = min(1.0, clear / motion)
        assert true - 2 / 64 <= proof.fraction <= true + 1e-9, motion
        assert proof.is_clear == (motion < clear)
        assert proof.status is (Status.free if motion < clear else Status.limited)
    too_close = guard.prove([np.arcsin(17.7 / 60)], [0.0])
    assert not too_close.is_clear and too_close.status is Status.recovering
    np.testing.assert_allclose(too_close.distance, 0.3, atol=1e-9)
    assert guard.prove([np.nan], [0.0]).status is Status.invalid_input


def motions(count):
    random = np.random.default_rng(5)
    q = np.array([0, 0, 110.3, 0, 0, 0]) + random.normal(size=(count, 6)) * [0.1, 0.1, 5, 1, 0.5, 0.5]
    return q, random.normal(size=(count, 6)) * [0.05, 0.05, 10, 0.2, 0.2, 0.2]


def test_batches_are_single_proofs_bit_for_bit():
    guard = psm_guard()
    q, by = motions(300)
    whole = guard.proofs(q, by, threads=1)
    single = [guard.prove(*motion) for motion in zip(q, by)]
    np.testing.assert_array_equal(whole.fraction, [proof.fraction for proof in single])
    np.testing.assert_array_equal(whole.status, [proof.status for proof in single])
    distances = [np.nan if p.distance is None else p.distance for p in single]
    np.testing.assert_array_equal(whole.distance, distances)
    np.testing.assert_array_equal(whole.is_clear, [proof.is_clear for proof in single])
    assert 20 < whole.is_clear.sum() < 280 and len(set(whole.fraction)) > 10
    order = np.random.default_rng(6).permutation(len(q))
    for threads in (2, 5):
        other = guard.proofs(q[order], by[order], threads=threads)
        np.testing.assert_array_equal(other.fraction, whole.fraction[order])
        np.testing.assert_array_equal(other.distance, whole.distance[order])
    np.testing.assert_array_equal(guard.proofs(q).fraction, guard.proofs(q, np.zeros((300, 6))).fraction)
    one = guard.proofs(q[0], by)
    np.testing.assert_array_equal(one.fraction, guard.proofs(np.tile(q[0], (300, 1)), by).fraction)
    assert len(one) == 300 and len(guard.proofs(q[0])) == 1 and len(guard.proofs(q[:0])) == 0
    assert "300 motions" in repr(one)


def test_proofs_change_nothing_for_the_steps_and_options_something():
    guards, places = (psm_guard(), psm_guard()), []
    for index, guard in enumerate(guards):
        q = np.array([0, 0, 114.0, 0, 0, 0])
        for cycle in range(60):
            q = q + guard.step(q, (0.05, 0, -0.05)).increment
            if index == 1 and cycle % 10 == 0:
                guard.prove(q, [0, 0, 5.0, 0, 0, 0])
        places.append(q)
    np.testing.assert_array_equal(*places)
    guards[0].set_options(margin=2.0, recovery=0.2)
    assert guards[0].margin == 2.0 and guards[0].band == 0.002
    assert guards[0].step(places[0], (0, 0, 0)).status is Status.recovering
    assert guards[0].prove(places[0], np.zeros(6)).status is Status.recovering
    assert guards[1].proofs(places[0]).is_clear.all()
    guards[1].proofs(places[0])
    guards[1].set_options(margin=2.0)  # also after earlier proofs
    assert not guards[1].proofs(places[0]).is_clear.any()
    with pytest.raises(keepout.Error, match="band"):
        guards[1].set_options(margin=0.001)
    assert guards[1].margin == 2.0
    instrument = guards[0].instrument
    assert 0.002 < instrument.recommended_band(0.01) < 0.5
    for period in (-1, 0, np.nan, np.inf):
        with pytest.raises(keepout.Error, match="^period: expected a number above 0"):
            instrument.recommended_band(period)
    with pytest.raises(keepout.Error, match="^least: expected .*, got -1"):
        instrument.recommended_band(0.01, least=-1)


def test_chains_of_tables_and_files_are_the_same(tmp_path):
    q = motions(50)[0]
    chain = psm()
    poses = chain.forward_kinematics(q)
    assert poses.shape == (50, 4, 4) and len(chain) == 6
    np.testing.assert_array_equal(poses[7], chain.forward_kinematics(q[7]))
    np.testing.assert_allclose(psm(at(1, 2, 3)).forward_kinematics(q), at(1, 2, 3) @ poses, atol=1e-9)
    again = Chain(chain.joints, base=chain.base, flange=chain.flange)
    np.testing.assert_allclose(again.forward_kinematics(q), poses, atol=1e-9)
    assert np.isnan(chain.forward_kinematics([np.nan, 0, 0, 0, 0, 0])).all()
    assert (chain.joints[2].kind, chain.joints[2].upper) == ("prismatic", 240)
    try:
        read = keepout.read_chain(robots / "psm.urdf")
    except keepout.Error as error:
        assert "install liburdfdom-dev" in str(error)
        pytest.skip("this build reads no URDF")
    np.testing.assert_allclose(read.forward_kinematics(q), poses, atol=1e-9)
    assert [joint.name for joint in read.joints] == [joint.name for joint in chain.joints]
    metres = keepout.read_chain(robots / "psm.urdf", base="base", tip="tip", scale=1.0)
    assert metres.joints[2].upper == 0.24
    with pytest.raises(keepout.Error, match="no_such_link"):
        keepout.read_chain(robots / "psm.urdf", tip="no_such_link")
    os.mkfifo(tmp_path / "pipe.urdf")
    for path, says in ((tmp_path, "is a directory"), (tmp_path / "pipe.urdf", "is not a regular file"),
                       (tmp_path / "none.urdf", "cannot read it")):
        with pytest.raises(keepout.Error, match=f"{path.name}: {says}"):
            keepout.read_chain(path)


def test_a_robot_is_read_with_the_bodies_of_a_file_or_with_its_shapes(tmp_path):
    urdf = robots / "six_joint_arm.urdf"
    try:
        arm = keepout.read_robot(urdf, robots / "six_joint_arm.json")
    except keepout.Error as error:
        assert "install liburdfdom-dev" in str(error)
        pytest.skip("this build reads no URDF")
    assert [body.name for body in arm.bodies] == ["upper_arm", "forearm", "wrist", "holder", "bit"]
    np.testing.assert_array_equal(arm.chain.base[:3, 3], [0, 0, 200])
    chain = keepout.read_chain(urdf, base="base_link", tip="tip")
    q = np.array([0.1, -0.7, 1.4, 0.2, -0.8, 0.3])
    np.testing.assert_allclose(arm.chain.forward_kinematics(q), at(0, 0, 200) @ chain.forward_kinematics(q), atol=1e-9)
    # The place of the tip as a separate program computes it from the numbers in the file, with Rodrigues' formula.
    tip = arm.chain.forward_kinematics([0, -0.7, 1.4, 0, -0.87, 0])[:3, 3]
    np.testing.assert_allclose(tip, [0.468452940, 90.768517853, 200 + 891.884147131], atol=1e-8)
    with pytest.warns(UserWarning, match="link 'wrist_1' has no collision element"):
        shapes = keepout.read_robot(urdf, base="base_link", tip="tip")
    assert [body.name for body in shapes.bodies][-2:] == ["holder", "bit"]
    (tmp_path / "bad.json").write_text('{"bodies": [{"name": "a", "radius": 1}]}')
    with pytest.raises(keepout.Error, match="bad.json: .*did you mean \"radius_mm\""):
        keepout.read_robot(urdf, tmp_path / "bad.json")


@pytest.mark.parametrize(
    "wrong, says",
    [
        (lambda: Joint(kind="screw"), "kind: expected 'revolute' or 'prismatic', got 'screw'"),
        (lambda: Joint(origin=np.eye(3)), r"origin: .* \(4, 4\), got shape \(3, 3\)"),
        (lambda: Joint(origin=2 * np.eye(4)), "origin: .* last row"),
        (lambda: Chain([Joint("a", axis=(1, 1, 0))]), r"axis of joint 1 \('a'\)"),
        (lambda: Chain([Joint()], base=np.diag([1, 1, -1, 1])), "base .* rotation"),
        (lambda: psm().forward_kinematics(np.zeros((2, 5))), r"q: .* \(m, 6\) or \(6,\), got shape \(2, 5\)"),
        (lambda: keepout.chain_of_table([TableRow()], convention="craig"), "convention: .*'craig'"),
        (lambda: Body("b", [(1, (0, 0))], 1.0), r"points\[0\]\[1\]: .* \(3,\)"),
        (lambda: Body("b", [((0, 0, 0), 1)], 1.0), r"points\[0\]\[0\]: .* number of a link"),
        (lambda: Body("b", [7], 1.0), r"points\[0\]: .* pair"),
        (lambda: Instrument(psm(), [Body("b", [(7, (0, 0, 0))], 1.0)]), "body 1 .* link 7"),
        (lambda: Instrument(psm(), [Body("b", [(2**70, (0, 0, 0))], 1.0)]), "body 1 .* link"),
        (lambda: lever_guard(certified="never"), "certified: .*'never'"),
        (lambda: lever_guard(max_planes=-1), "max_planes: "),
        (lambda: lever_guard(index="grid"), "wide_bvh"),
        (lambda: lever_guard().step([0.0, 0.0], (0, 0, 0)), r"q: .* \(1,\), got shape \(2,\)"),
        (lambda: lever_guard().step([0.0], (0, 0)), "linear: "),
        (lambda: lever_guard().step([0.0]), "increment: expected either .* got neither"),
        (lambda: lever_guard().step([0.0], (0, 0, 0), increment=[0]), "increment: .* got both"),
        (lambda: lever_guard().step([0.0], (0, 0, 0), weights=[1]), "weights: "),
        (lambda: lever_guard().step([0.0], increment=[0, 1]), r"increment: .* \(1,\)"),
        (lambda: lever_guard().prove([0.0], None), "increment: .* None"),
        (lambda: lever_guard().proofs(np.zeros((3, 1)), np.zeros((2, 1))), "increments: .* 3, or one"),
        (lambda: lever_guard().proofs(np.zeros((3, 1)), threads=0), "threads: "),
    ],
)
def test_what_is_wrong_is_named(wrong, says):
    with pytest.raises(keepout.Error, match=says):
        wrong()


def test_a_mistyped_argument_is_told():
    with pytest.raises(TypeError, match="InstrumentGuard has no argument 'magrin'; did you mean 'margin'"):
        lever_guard(magrin=1.0)
