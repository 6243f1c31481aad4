# SPDX-License-Identifier: BSD-3-Clause
"""Tests the CRTK session: a tip and a whole instrument between a teleoperation and a robot."""

import numpy as np
import pytest
from surfaces import at, psm, sphere

import keepout

mm = np.diag([1000.0, 1000.0, 1000.0, 1.0])
registration = np.array([[0, -1, 0, 30], [1, 0, 0, -20], [0, 0, 1, 5], [0, 0, 0, 1.0]])


def pose_of(tip):
    """Returns the pose of a tip of the mesh, in the robot's frame and in meters."""
    pose = np.eye(4)
    pose[:3, 3] = (np.linalg.inv(registration) @ [*tip, 1.0])[:3] / 1000
    return pose


def engaged(guard, start, **options):
    session = keepout.CrtkSession(guard, registration, **options)
    session.on_operating_state("ENABLED", True)
    session.on_setpoint_cp(start, 0.0)
    assert session.engage(0.0) == "guarded"
    return session


def test_a_tip_is_kept_out_and_the_hand_feels_it(guard):
    session = engaged(guard, pose_of((0, 0, 11.0)))
    np.testing.assert_array_equal(session.setpoint_cp, pose_of((0, 0, 11.0)))
    for cycle in range(1, 301):
        now = 0.001 * cycle
        session.on_measured_cp(session.setpoint_cp, now)
        session.on_servo_cp(pose_of((0, 0, 11.0 - 0.01 * cycle)), now)
        assert session.tick(now) == "guarded"
    tip = registration @ mm @ session.setpoint_cp @ [0, 0, 0, 1]
    distance = keepout.Index(guard.mesh).distances(tip[None, :3])[0]
    assert 0.5 - 1e-6 <= distance < 0.6
    assert session.step_status is keepout.Status.limited and "mesh" in session.limits
    assert session.servo_cf[2] == pytest.approx(1.0 * (tip[2] - 8.0), abs=1e-6)
    session.release()
    assert session.setpoint_cp is None and not session.engaged and session.servo_cf.tolist() == [0, 0, 0]
    assert session.operating_state == "PAUSED"


def test_the_guides_of_the_guard_hold(mesh):
    guard = keepout.MotionConstraint(mesh, tool_radius=0.3, margin=0.2)
    guard.set_guides(["corridor=slab:0,0,12:1,0,0:0.5"])
    session = engaged(guard, pose_of((0, 0, 12.0)), needs_feedback=False)
    for cycle in range(1, 201):
        session.on_servo_cp(pose_of((0.01 * cycle, 0, 12.0)), 0.001 * cycle)
        session.tick(0.001 * cycle)
    tip = registration @ mm @ session.setpoint_cp @ [0, 0, 0, 1]
    assert tip[0] == pytest.approx(0.5, abs=0.01)


def test_what_is_wrong_stops_the_tool_with_its_cause(guard):
    session = engaged(guard, pose_of((0, 0, 12.0)), frame="base")
    session.on_measured_cp(pose_of((0, 0, 12.0)), 0.001)
    goal = pose_of((0, 0, 12.1))
    unknown, far = goal.copy(), goal.copy()
    unknown[0, 3] = np.nan
    far[:3, 3] *= 1000
    for send, cause in (
        (lambda: session.on_servo_cp(unknown, 0.001), "invalid_pose"),
        (lambda: session.on_servo_cp(goal, 0.001, "camera"), "other_frame"),
        (lambda: session.on_servo_cp(goal, -1.0), "stale"),
        (lambda: session.on_servo_cp(far, 0.001), "too_far"),
        (lambda: session.on_servo_jp([0.0] * 6, 0.001), "wrong_command"),
        (lambda: session.on_contest(True), "contested"),
    ):
        send()
        assert session.tick(0.001) == cause == session.status
        np.testing.assert_array_equal(session.setpoint_cp, pose_of((0, 0, 12.0)))
        assert len(session.reason) > 20
    session.on_contest(False)
    session.on_operating_state("FAULT", True)
    assert session.tick(0.002) == "not_ready" and session.setpoint_cp is None
    assert session.operating_state == "FAULT" and "a tip: not_ready" in repr(session)


def test_an_instrument_sends_what_its_guard_sends():
    port, wrist, yaw = (0, (0, 0, 0)), (4, (0, 0, 0)), (5, (9.1, 0, 0))
    bodies = [keepout.Body("shaft", [port, wrist], 4.5), keepout.Body("wrist", [wrist, yaw], 3.0)]
    instrument = keepout.Instrument(psm(at(0, 0, 170)), bodies)
    ball = keepout.Mesh(*sphere(64, 50.0))
    guard = keepout.InstrumentGuard(ball, instrument, margin=0.5)
    session = keepout.CrtkSession(guard, np.eye(4))
    meters = np.array([1, 1, 0.001, 1, 1, 1])
    q = np.array([0, 0, 120.0, 0, 0, 0])
    session.on_operating_state("ENABLED", True)
    session.on_setpoint_js(q * meters, 0.0)
    assert session.engage(0.0) == "guarded"
    limited = 0
    for cycle in range(1, 201):
        now = 0.001 * cycle
        velocity = np.array([0.1, 0.0, 0.1, 0.2, 0.0, 0.0])
        session.on_measured_js(session.setpoint_jp, now)
        session.on_servo_jv(velocity, now)
        assert session.tick(now) == "guarded"
        step = guard.step(q, increment=velocity / meters * 0.001)
        q = q + step.increment
        limited += step.status is keepout.Status.limited
        np.testing.assert_allclose(session.setpoint_jp, q * meters, rtol=1e-13, atol=1e-15)
    assert limited > 20
    assert session.on_servo_jp([0.0] * 3, now) is None and session.tick(now) == "wrong_command"


def test_arguments_that_fit_nothing_are_named(guard, mesh):
    with pytest.raises(keepout.Error, match="guard.*MotionConstraint or InstrumentGuard.*Mesh"):
        keepout.CrtkSession(mesh, np.eye(4))
    with pytest.raises(keepout.Error, match="mesh_from_robot"):
        keepout.CrtkSession(guard, np.eye(3))
    with pytest.raises(keepout.Error, match="reflection"):
        keepout.CrtkSession(guard, np.diag([1, 1, -1, 1]))
    with pytest.raises(keepout.Error, match="robot_unit.*'m' or 'mm'.*'cm'"):
        keepout.CrtkSession(guard, np.eye(4), robot_unit="cm")
    with pytest.raises(keepout.Error, match="farthest_lag"):
        keepout.CrtkSession(guard, np.eye(4), farthest_lag=-1)
    session = keepout.CrtkSession(guard, np.eye(4))
    with pytest.raises(keepout.Error, match="state.*'ENABLED'.*'on'"):
        session.on_operating_state("on", True)
    for value in ([1, 2, 3], None):
        with pytest.raises(keepout.Error, match="pose"):
            session.on_servo_cp(value, 0.0)
    with pytest.raises(TypeError):
        session.on_contest(None)
    with pytest.raises(keepout.Error, match="top_speed"):
        keepout.CrtkSession(guard, np.eye(4), mesh_unit="m")


def test_a_message_that_raises_stops_the_tool(guard):
    session = engaged(guard, pose_of((0, 0, 12.0)))
    session.on_measured_cp(pose_of((0, 0, 12.0)), 0.001)
    for send in (
        lambda: session.on_servo_cp(np.eye(3), 0.001),
        lambda: session.on_servo_jp("six", 0.001),
        lambda: session.on_measured_cp(None, 0.001),
    ):
        with pytest.raises(keepout.Error):
            send()
        assert session.tick(0.001) == "invalid_pose"
    with pytest.raises(keepout.Error, match="state"):
        session.on_operating_state("UNKNOWN", True)
    assert session.tick(0.002) == "not_ready" and session.operating_state == "FAULT"
