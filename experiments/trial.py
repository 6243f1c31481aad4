# SPDX-License-Identifier: BSD-3-Clause
"""One trial: the operator follows the path with the robot, at 1 kHz, with or without a fixture.

    hand -> handle -> latency -> goal -> [ fixture, in the registered frame ] -> setpoint -> lag -> tip
      ^                                               |
      +------------------ force, latency -------------+

If the fixture stops the tip, a force pulls the handle towards the tip. It is proportional to the
distance between the two (section V-A of Li et al., 2020).
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .bone import Bone, BoneProperties
from .operator_model import Arm, Operator, adjustments, slow_error, tremor
from .experiment import Array
from .planned_path import PlannedPath
from .rules.rule import Rule
from .set_up_errors import RigidMotion, SetUp

APPROACH = 1.0  # the hand moves down onto the path within this time [s]
NEAR_THE_END = 1.0  # a tip this close to the path's end has finished [mm]
START_HEIGHT = 3.0  # height at the start [mm]


@dataclass(frozen=True)
class Course:
    """The task: follow `path` at `speed`, `depth` below the outer surface."""

    path: PlannedPath
    depth: float  # [mm]
    speed: float  # speed of the operator if nothing slows it down [mm/s]
    bone: BoneProperties | None = None  # None: no bone
    force_per_mm: float = 0.3  # of the fixture on the handle [N/mm]
    greatest_force: float = 4.0  # greatest force on the handle [N]
    radius: float = 5.0  # of the motion sphere, as in Li et al. [mm]
    top_speed: float = 100.0  # of the setpoint [mm/s]
    period: float = 0.001  # of the control cycle [s]
    time_limit: float = 400.0  # [s]


@dataclass(frozen=True)
class Trace:
    """The course of a trial, cycle by cycle, (n, 3) in mm or (n,), and the kerf at each point of the path."""

    tip: Array  # the true position of the tip
    setpoint: Array  # as the fixture allowed it, in the registered frame
    goal: Array  # as the hand wanted it, in the registered frame
    force: Array  # (n,) of the fixture on the handle [N]
    power: Array  # (n,) of that force on the handle [mW]
    contact: Array  # (n,) of the tip on the bone [N]
    kerf: Array  # (points of the path,) [mm]
    begun: int  # the first cycle after the approach
    finished: bool  # the tip reached the path's end within the time limit
    registered: RigidMotion  # from the true frame to the registered anatomy


def run_trial(
    course: Course,
    rule: Rule | None,
    operator: Operator,
    setup: SetUp,
    registered: RigidMotion,
    random: np.random.Generator,
) -> Trace:
    """Simulates one trial. Without a rule there is no fixture, and the hand does not lean on one."""
    path, period = course.path, course.period
    if rule is None:
        operator = replace(operator, leaning=0.0)
    most = int(course.time_limit / period)
    amounts = np.array([operator.slow_across, operator.slow_in_depth])
    slow = slow_error(random, most, period, operator.slow_corner)[:, :2] * amounts
    slow = slow + random.standard_normal(2) * [operator.bias_across, operator.bias_in_depth]
    slow[:, 1] += adjustments(random, most, period, operator.adjusting)
    shake = tremor(random, most, period, operator.tremor)
    true_frame = registered.inverse()
    longest = min(course.radius, course.top_speed * period)
    delay = round(setup.latency / period)
    reaction = max(1, round(operator.reaction / period))
    follow = 1.0 if setup.lag == 0.0 else 1.0 - np.exp(-period / setup.lag)
    bone = Bone(path, course.bone, setup.tip_stiffness) if course.bone else None

    start = path.points[0] + START_HEIGHT * path.up[0]
    scale = operator.motion_scale
    arm = Arm(operator, start / scale)
    intended = start / scale
    setpoint = robot = registered(start)
    goals = np.tile(setpoint, (most, 1))
    tips, setpoints = np.empty((most, 3)), np.empty((most, 3))
    pulls, contacts, powers = np.zeros((most, 3)), np.zeros(most), np.zeros(most)
    seen = np.zeros(most)  # factor on the speed, from the deviation that the eye sees
    along, approach = 0.0, int(APPROACH / period)
    cycle, none, finished = 0, np.zeros(3), False

    for cycle in range(most):
        # The operator: the intended position, and the speed along the path.
        place, up = path.at(along)
        above = max(0.0, 1.0 - cycle / approach) * START_HEIGHT
        below = course.depth + operator.leaning + slow[cycle, 1] - above
        meant = (place + slow[cycle, 0] * path.across - below * up) / scale
        pull = pulls[cycle - delay] if cycle >= delay else none
        handle = arm.move(meant, (meant - intended) / period, pull, period)
        intended = meant
        if cycle >= approach:
            along += course.speed * period * (seen[cycle - reaction] if cycle >= reaction else 1.0)

        # The robot: goal, fixture, setpoint, and the new position of the tip.
        goals[cycle] = registered(scale * handle + shake[cycle])
        goal = goals[cycle - delay] if cycle >= delay else goals[0]
        desired = goal - setpoint
        length = np.sqrt(desired @ desired)
        if length > longest:
            desired = desired * (longest / length)
        if rule is None:
            setpoint = setpoint + desired
        else:
            setpoint = setpoint + rule.step(setpoint, desired)
            pulled = course.force_per_mm * (setpoint - goal)
            size = np.sqrt(pulled @ pulled)
            if size > course.greatest_force:
                pulled = pulled * (course.greatest_force / size)
            pulls[cycle] = true_frame.rotation @ pulled
        powers[cycle] = pull @ arm.speed
        robot = robot + follow * (setpoint - robot)
        tip = true_frame(robot)
        if bone:
            tip, contacts[cycle] = bone.press(tip, period)
        tips[cycle], setpoints[cycle] = tip, setpoint

        # The eye: the distance from the place on the path, seen from above, and the height above the intended depth.
        # A hand that feels a fixture assumes that it has reached the depth.
        offset = tip - place
        height = offset @ up
        aside_squared = offset @ offset - height * height
        feels = pull @ pull > operator.felt_force**2
        hanging = 0.0 if feels else max(0.0, height + below - operator.leaning)
        seen[cycle] = 1.0 / (1.0 + (aside_squared + hanging * hanging) / operator.tolerance**2)
        # At the end the hand waits for a tip that lags behind.
        if along >= path.length:
            finished = bool(path.depths(tip[None])[0][0] >= path.length - NEAR_THE_END)
            if finished:
                break

    ran = cycle + 1
    return Trace(
        tip=tips[:ran],
        setpoint=setpoints[:ran],
        goal=goals[np.maximum(np.arange(ran) - delay, 0)],
        force=np.linalg.norm(pulls[:ran], axis=1),
        power=powers[:ran],
        contact=contacts[:ran],
        kerf=bone.cut if bone else np.zeros(len(path.points)),
        begun=min(approach, ran - 1),
        finished=finished,
        registered=registered,
    )
