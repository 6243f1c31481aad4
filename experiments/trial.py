# SPDX-License-Identifier: BSD-3-Clause
"""One trial: the operator follows the path with the robot, at 1 kHz, with or without a fixture.

    hand -> handle -> latency -> goal -> [ fixture, in the registered frame ] -> setpoint -> lag -> tip
      ^                                               |
      +------------------ force, latency -------------+

If the fixture stops the tip, a force pulls the handle towards the tip. It is proportional to the
distance between the two (section V-A of Li et al., 2020).

The loop is C++: benchmarks/native/trial. A loop in Python (tests/experiments/trial_in_python.py) has the same operations
in the same order. A test compares both: the results are bitwise identical. draw() draws all random numbers beforehand.
"""
from __future__ import annotations

from dataclasses import dataclass

import keepout_peers

from .bone import BoneProperties
from .experiment import Array
from .operator_model import Operator, Streams, tremor
from .planned_path import PlannedPath
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
    made = keepout_peers.run_trial(course, rule, operator, setup, registered, registered.inverse(), draws)
    return Trace(**made, registered=registered)
