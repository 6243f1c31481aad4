# SPDX-License-Identifier: BSD-3-Clause
"""One trial: the operator follows the path with the robot, at 1 kHz, with or without a fixture.

    hand -> handle -> latency -> goal -> [ fixture, in the registered frame ] -> setpoint -> lag -> tip
      ^                                               |
      +------------------ force, latency -------------+

If the fixture stops the tip, a force pulls the handle towards the tip. It is proportional to the
distance between the two (section V-A of Li et al., 2020).

run_trial() is the loop in C++ (benchmarks/native/trial.h). run_in_python() is the same loop, to read and to test the
other against: both have the same operations in the same order, and bitwise identical results. All random numbers are
drawn beforehand, by draw().
"""
from __future__ import annotations

from dataclasses import dataclass
from math import exp, sqrt
from typing import NamedTuple, Protocol

import numpy as np

from .bone import Bone, BoneProperties
from .experiment import Array, dot
from .operator_model import Arm, Operator, Streams, tremor
from .planned_path import PlannedPath
from .rules.keepout_rules import KeepoutRule
from .rules.rule import Rule
from .set_up_errors import RigidMotion, SetUp

APPROACH = 1.0  # the hand moves down onto the path within this time [s]
NEAR_THE_END = 1.0  # a tip this close to the path's end has finished [mm]
START_HEIGHT = 3.0  # height at the start [mm]

#: Random numbers of a trial, by name.
Draws = dict[str, Array]


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

    @property
    def cycles(self) -> int:
        """The greatest number of cycles."""
        return int(self.time_limit / self.period)


class Seen(NamedTuple):
    """What the operator can see and feel in a cycle. Lengths are relative to the intended place along the path [mm]."""

    ahead: float  # of the intended place, along the heading of the path
    across: float
    depth: float  # below the path
    above: float  # height of the intended place during the approach
    push: float  # force of the fixture away from the bone [N]


class Hand(Protocol):
    """Decides where the tip should be. `along` is the intended place along the path [mm]."""

    along: float

    def aim(self, cycle: int, approach: int) -> tuple[float, float, float]:
        """Returns the intended place: along, across and below the path [mm]. Called once in each cycle."""
        ...

    def look(self, seen: Seen) -> None:
        """Looks at the tip at the end of the cycle."""
        ...


@dataclass(frozen=True)
class Trace:
    """The course of a trial, cycle by cycle, (n, 3) in mm or (n,), and the kerf at its end."""

    tip: Array  # the true position of the tip
    setpoint: Array  # as the fixture allowed it, in the registered frame
    goal: Array  # as the hand wanted it, in the registered frame
    force: Array  # (n,) of the fixture on the handle [N]
    power: Array  # (n,) of that force on the handle [mW]
    contact: Array  # (n,) of the tip on the bone [N]
    kerf: Array  # (points of the path, cells across), the cut depth; empty without bone [mm]
    begun: int  # the first cycle after the approach
    finished: bool  # the tip reached the path's end within the time limit
    registered: RigidMotion  # from the true frame to the registered anatomy


def draw(course: Course, operator: Operator, random: Streams) -> Draws:
    """Returns all random numbers of a trial: those of the hand, and `tremor`, (cycles, 3) at the tip [mm]."""
    size = operator.tremor * operator.motion_scale
    shake = tremor(random("tremor"), course.cycles, course.period, size)
    return operator.hand.draw(course, random) | {"tremor": shake}


def run_trial(
    course: Course, rule: Rule | None, operator: Operator, setup: SetUp, registered: RigidMotion, draws: Draws
) -> Trace:
    """Simulates one trial. Without a rule there is no fixture.

    Runs without Python's lock, except in rules that are written in Python: trials may run in parallel threads.
    """
    import keepout_trial

    if isinstance(rule, KeepoutRule):
        rule = rule.native()
    made = keepout_trial.run(course, rule, operator, setup, registered, registered.inverse(), draws)
    return Trace(**made, registered=registered)


def run_in_python(
    course: Course, rule: Rule | None, operator: Operator, setup: SetUp, registered: RigidMotion, draws: Draws
) -> Trace:
    """Like run_trial(), in Python."""
    path, period, most = course.path, course.period, course.cycles
    scale, shake = operator.motion_scale, draws["tremor"]
    hand: Hand = operator.hand.start(operator, course, draws, rule is not None)
    true_frame = registered.inverse()
    longest = min(course.radius, course.top_speed * period)
    delay = round(setup.latency / period)
    follow = 1.0 if setup.lag == 0.0 else 1.0 - exp(-period / setup.lag)
    bone = Bone(path, course.bone, setup.tip_stiffness) if course.bone else None
    heading = path.heading / sqrt(dot(path.heading, path.heading))

    start = path.place(0.0, 0.0, -START_HEIGHT)
    arm = Arm(operator, start / scale)
    intended = start / scale
    setpoint = robot = registered.moved(start)
    goals = np.tile(setpoint, (most, 1))
    tips, setpoints = np.empty((most, 3)), np.empty((most, 3))
    pulls, contacts, powers = np.zeros((most, 3)), np.zeros(most), np.zeros(most)
    approach = int(APPROACH / period)
    cycle, none, finished = 0, np.zeros(3), False

    for cycle in range(most):
        # The operator: the intended position.
        along, across, below = hand.aim(cycle, approach)
        above = max(0.0, 1.0 - cycle / approach) * START_HEIGHT
        place, up = path.at(along)
        meant = (place + across * path.across - (below - above) * up) / scale
        pull = pulls[cycle - delay] if cycle >= delay else none
        handle = arm.move(meant, (meant - intended) / period, pull, period)
        intended = meant

        # The robot: goal, fixture, setpoint, and the new position of the tip.
        goals[cycle] = registered.moved(scale * handle + shake[cycle])
        goal = goals[cycle - delay] if cycle >= delay else goals[0]
        desired = goal - setpoint
        length = sqrt(dot(desired, desired))
        if length > longest:
            desired = desired * (longest / length)
        if rule is None:
            setpoint = setpoint + desired
        else:
            setpoint = setpoint + rule.step(setpoint, desired)
            pulled = course.force_per_mm * (setpoint - goal)
            size = sqrt(dot(pulled, pulled))
            if size > course.greatest_force:
                pulled = pulled * (course.greatest_force / size)
            pulls[cycle] = true_frame.turned(pulled)
        powers[cycle] = dot(pull, arm.speed)
        robot = robot + follow * (setpoint - robot)
        tip = true_frame.moved(robot)
        if bone:
            tip, contacts[cycle] = bone.press(tip, period)
        tips[cycle], setpoints[cycle] = tip, setpoint

        # The operator sees the tip from above, and feels the fixture.
        offset = tip - place
        hand.look(Seen(dot(offset, heading), dot(offset, path.across), -dot(offset, up), above, dot(pull, up)))
        # At the end the hand waits for a tip that lags behind.
        if hand.along >= path.length and path.coordinates(tip)[0] >= path.length - NEAR_THE_END:
            finished = True
            break

    ran = cycle + 1
    return Trace(
        tip=tips[:ran],
        setpoint=setpoints[:ran],
        goal=goals[np.maximum(np.arange(ran) - delay, 0)],
        force=np.sqrt(pulls[:ran, 0] ** 2 + pulls[:ran, 1] ** 2 + pulls[:ran, 2] ** 2),
        power=powers[:ran],
        contact=contacts[:ran],
        kerf=bone.cut if bone else np.zeros((0, 0)),
        begun=min(approach, ran - 1),
        finished=finished,
        registered=registered,
    )
