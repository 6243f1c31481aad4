# SPDX-License-Identifier: BSD-3-Clause
"""The loop of benchmarks/native/trial in Python: the same operations in the same order.

test_trial.py compares both loops bit by bit. Other tests use the parts: the bone, the arm and the hands. The headers in
benchmarks/native/trial describe all names.
"""
from __future__ import annotations

from math import exp, inf, sqrt
from typing import NamedTuple

import numpy as np

from experiments.bone import CELL, BoneProperties
from experiments.experiment import Array
from experiments.intermittent import LOOKS, Intermittent
from experiments.open_loop import SAMPLES, OpenLoop
from experiments.operator_model import Operator
from experiments.planned_path import PlannedPath
from experiments.rules.rule import Rule
from experiments.set_up_errors import RigidMotion, SetUp
from experiments.trial import APPROACH, NEAR_THE_END, START_HEIGHT, Course, Draws, Trace

HALF_WIDTH = 3.0
STALLED = 4

Coordinates = tuple[float, float, float]  # along, across and below a path


def dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def interpolated(samples: Array, place: float) -> tuple[float, float]:
    place = min(max(place, 0.0), len(samples) - 1.0)
    low = min(int(place), len(samples) - 2)
    share = place - low
    a, b = samples[low], samples[low + 1]
    return float((1.0 - share) * a[0] + share * b[0]), float((1.0 - share) * a[1] + share * b[1])


def turned(motion: RigidMotion, vector: Array) -> Array:
    return np.array([dot(row, vector) for row in motion.rotation])


def moved(motion: RigidMotion, point: Array) -> Array:
    return turned(motion, point) + motion.translation


def at(path: PlannedPath, along: float) -> tuple[Array, Array]:
    place = min(max(along / path.spacing, 0.0), len(path.points) - 1.0)
    low = min(int(place), len(path.points) - 2)
    share = place - low
    return (
        (1.0 - share) * path.points[low] + share * path.points[low + 1],
        (1.0 - share) * path.up[low] + share * path.up[low + 1],
    )


def coordinates(path: PlannedPath, place: Array) -> Coordinates:
    ahead = dot(place, path.heading)
    low = min(max(int(np.searchsorted(path.order, ahead)) - 1, 0), len(path.order) - 2)
    share = (ahead - path.order[low]) / (path.order[low + 1] - path.order[low])
    along = min(max((low + share) * path.spacing, 0.0), path.length)
    point, up = at(path, along)
    offset = place - point
    return along, dot(offset, path.across), -dot(offset, up)


def place_at(path: PlannedPath, along: float, across: float, below: float) -> Array:
    point, up = at(path, along)
    place: Array = point + across * path.across - below * up
    return place


class Bone:
    def __init__(self, path: PlannedPath, properties: BoneProperties, tip_stiffness: float) -> None:
        self.cut = np.zeros((len(path.points), 2 * round(HALF_WIDTH / CELL) + 1))
        self._path = path
        self._properties = properties
        self._stiffness = tip_stiffness
        self._half_blade = max(1, round(properties.blade / 2 / path.spacing))
        self._half_kerf = max(1, round(properties.kerf / 2 / CELL))
        self._specific = properties.resistance / (properties.blade * properties.kerf)
        self._tip: Coordinates | None = None

    def press(self, robot: Array, period: float) -> tuple[Array, float]:
        along, across, below = coordinates(self._path, robot)
        before = self._tip
        if before is None or below <= 0.0:
            self._tip = (along, across, below)
            return robot, 0.0
        row, column = self._cell(before[0], before[1])
        depth = before[2]
        beside = self._half_blade + 1 if along > before[0] else -self._half_blade - 1
        front = 0.0
        for cell in range(column - self._half_kerf, column + self._half_kerf + 1):
            front += self._bone(row + beside, cell, depth)
        tip_along = self._follow(before[0], along, front * CELL, period)
        beside = self._half_kerf + 1 if across > before[1] else -self._half_kerf - 1
        wall = 0.0
        for number in range(row - self._half_blade, row + self._half_blade + 1):
            wall += self._bone(number, column + beside, depth)
        tip_across = self._follow(before[1], across, wall * self._path.spacing, period)
        tip_below = self._sink(self._cell(tip_along, tip_across), depth, below, period)
        self._tip = (tip_along, tip_across, tip_below)
        tip = robot + (place_at(self._path, *self._tip) - place_at(self._path, along, across, below))
        stretched = tip - robot
        return tip, self._stiffness * sqrt(dot(stretched, stretched))

    def _cell(self, along: float, across: float) -> tuple[int, int]:
        column = int((across + HALF_WIDTH) / CELL + 0.5)
        most = self.cut.shape[1] - 2 - self._half_kerf
        return int(along / self._path.spacing + 0.5), min(max(column, self._half_kerf + 1), most)

    def _bone(self, row: int, column: int, depth: float) -> float:
        if not 0 <= row < len(self.cut):
            return 0.0
        cut, bone = float(self.cut[row, column]), self._properties
        hard = max(0.0, min(depth, bone.thickness) - min(cut, bone.thickness))
        soft = max(0.0, depth - max(cut, bone.thickness))
        return hard + bone.behind * soft

    def _follow(self, tip: float, robot: float, area: float, period: float) -> float:
        if area <= 0.0:
            return robot
        return robot - (robot - tip) * exp(-self._stiffness * period / (self._specific * area))

    def _sink(self, cell: tuple[int, int], depth: float, below: float, period: float) -> float:
        row, column = cell
        rows = slice(max(0, row - self._half_blade), min(len(self.cut), row + self._half_blade + 1))
        under = self.cut[rows, column - self._half_kerf : column + self._half_kerf + 1]
        bearing = int(np.count_nonzero(under <= depth))
        if below <= depth:
            depth = below
        elif bearing == 0:
            depth = min(below, float(under.min()))
        else:
            bone = self._properties
            area = bearing * (self._path.spacing * CELL) * (1.0 if depth < bone.thickness else bone.behind)
            depth = self._follow(depth, below, area, period)
        np.maximum(under, depth, out=under)
        return depth


class Arm:
    def __init__(self, operator: Operator, place: Array) -> None:
        self.place = place.copy()
        self.speed = np.zeros(3)
        self._operator = operator

    def move(self, intended: Array, intended_speed: Array, force: Array, period: float) -> Array:
        arm = self._operator
        mass = arm.mass / 1000.0
        pull = arm.stiffness * (intended - self.place) + arm.damping * intended_speed + force
        self.speed = (self.speed + pull * (period / mass)) / (1.0 + arm.damping * period / mass)
        self.place = self.place + self.speed * period
        return self.place


class Seen(NamedTuple):
    ahead: float
    across: float
    depth: float
    above: float
    push: float


class OpenLoopHand:
    def __init__(self, operator: Operator, course: Course, draws: Draws, fixture: bool) -> None:
        assert isinstance(operator.hand, OpenLoop)
        self.along = 0.0
        self._hand = operator.hand
        self._course = course
        self._felt = operator.felt_force
        self._reaction = max(1, round(operator.reaction / course.period))
        self._errors = draws["errors"]
        self._spacing = course.speed / SAMPLES
        self._lean = operator.hand.leaning if fixture else 0.0
        self._factors: list[float] = []

    def aim(self, cycle: int, approach: int) -> Coordinates:
        if cycle > approach:
            seen = self._factors[cycle - 1 - self._reaction] if cycle > self._reaction else 1.0
            self.along += self._course.speed * self._course.period * seen
        across, below = interpolated(self._errors, self.along / self._spacing)
        self._below = self._course.depth + below
        return self.along, across, self._below + self._lean

    def look(self, seen: Seen) -> None:
        aside_squared = seen.ahead * seen.ahead + seen.across * seen.across
        hanging = 0.0 if seen.push > self._felt else max(0.0, self._below - seen.depth - seen.above)
        tolerance = self._hand.tolerance
        self._factors.append(1.0 / (1.0 + (aside_squared + hanging * hanging) / (tolerance * tolerance)))


class IntermittentHand:
    def __init__(self, operator: Operator, course: Course, draws: Draws, fixture: bool) -> None:
        assert isinstance(operator.hand, Intermittent)
        self.along = 0.0
        self._hand, self._course, self._draws, self._fixture = operator.hand, course, draws, fixture
        self._felt = operator.felt_force
        self._reaction = max(1, round(operator.reaction / course.period))
        self._refractory = max(1, round(operator.hand.refractory / course.period))
        self._movement = max(1, round(operator.hand.movement / course.period))
        self._next = -1
        self._looks = [0] * len(draws["motor"])
        self._done = [0.0, 0.0, 0.0]
        self._moves: list[tuple[int, list[float]]] = []
        self._end = [0.0, 0.0, 0.0]
        self._aims: list[Coordinates] = []
        self._seen: list[Seen] = []
        self._turn_of_depth = True
        self._at_depth = self._lifted = False
        self._misses = self._stalled = 0

    def aim(self, cycle: int, approach: int) -> Coordinates:
        if self._next < 0:
            self._next = approach + self._refractory
        if cycle >= self._next:
            self._decide(cycle)
        out = list(self._done)
        left = []
        for start, length in self._moves:
            part = (cycle - start) / self._movement
            if part >= 1.0:
                for i in range(3):
                    self._done[i] += length[i]
                    out[i] += length[i]
            else:
                left.append((start, length))
                share = part * part * part * (10.0 + part * (6.0 * part - 15.0))
                for i in range(3):
                    out[i] += length[i] * share
        self._moves = left
        self.along = out[0]
        self._aims.append((out[0], out[1], out[2]))
        return self._aims[-1]

    def look(self, seen: Seen) -> None:
        self._seen.append(seen)

    def _decide(self, cycle: int) -> None:
        hand, tolerance, cutting = self._hand, self._hand.tolerance, self._course.bone is not None
        then, aim = self._seen[cycle - self._reaction], self._aims[cycle - self._reaction]
        pending = [self._end[i] - aim[i] for i in range(3)]
        place = min(max(self._end[0], 0.0), len(self._looks) - 1.0)
        millimeter = int(place)
        number = self._looks[millimeter] % LOOKS
        self._looks[millimeter] += 1
        sight, motor = self._draws["sight"][millimeter, number], self._draws["motor"][millimeter, number]
        view = interpolated(self._draws["view"], place)
        lasting, fresh = sqrt(hand.lasting), sqrt(1.0 - hand.lasting)
        seen_across = then.across + hand.sight_across * (lasting * view[0] + fresh * float(sight[0]))
        seen_depth = then.depth + hand.sight_in_depth * (lasting * view[1] + fresh * float(sight[1]))
        across = seen_across + pending[1]
        error = seen_depth + pending[2] - self._course.depth
        room_along = tolerance - (self._end[0] - aim[0] - then.ahead) if cutting else inf
        room_below = tolerance - (self._end[2] - seen_depth) if cutting else inf

        feels = self._fixture and then.push > self._felt
        length = [0.0, 0.0, 0.0]
        wait = self._refractory
        if self._lifted:
            length[1] = -across if abs(across) > tolerance else 0.0
            length[2] = tolerance - self._end[2]
            self._lifted = False
            wait = self._movement + self._reaction
        elif self._turn_of_depth and not feels:
            if self._fixture:
                length[2] = max(0.0, min(tolerance, room_below))
            elif abs(error) <= tolerance:
                self._at_depth, self._misses = True, 0
            else:
                self._misses += 1
                if cutting and self._at_depth and self._misses >= 2:
                    length[2] = -(self._end[2] + hand.lift)
                    self._lifted, self._at_depth, self._misses = True, False, 0
                    wait = self._movement + self._reaction
                else:
                    length[2] = min(-error, max(0.0, room_below))
        else:
            length[1] = -across if abs(across) > tolerance else 0.0
            goes_on = feels or (not self._fixture and self._at_depth and self._misses == 0)
            if goes_on and self._end[0] < self._course.path.length:
                pace = self._course.speed * hand.refractory
                self._stalled = self._stalled + 1 if room_along <= 0.0 else 0
                length[0] = pace if self._stalled >= STALLED else max(0.0, min(pace, room_along))
            if feels:
                push = then.push + self._course.force_per_mm * pending[2]
                length[2] = min(max((hand.touch - push) / self._course.force_per_mm, -tolerance), tolerance)
        self._turn_of_depth = not self._turn_of_depth
        self._next = cycle + wait
        size = sqrt(length[0] * length[0] + length[1] * length[1] + length[2] * length[2])
        if size > 0.0:
            for i in range(3):
                error = hand.noise * float(motor[i]) + hand.drift * float(self._draws["heading"][i])
                length[i] += size * error
                self._end[i] += length[i]
            self._moves.append((cycle, length))


def run_in_python(
    course: Course, rule: Rule | None, operator: Operator, setup: SetUp, registered: RigidMotion, draws: Draws
) -> Trace:
    """Like experiments.trial.run_trial()."""
    path, period, most = course.path, course.period, course.cycles
    scale, shake = operator.motion_scale, draws["tremor"]
    made = OpenLoopHand if isinstance(operator.hand, OpenLoop) else IntermittentHand
    hand = made(operator, course, draws, rule is not None)
    true_frame = registered.inverse()
    longest = min(course.radius, course.top_speed * period)
    delay = round(setup.latency / period)
    force_delay = max(1, delay)
    follow = 1.0 if setup.lag == 0.0 else 1.0 - exp(-period / setup.lag)
    bone = Bone(path, course.bone, setup.tip_stiffness) if course.bone else None
    heading = path.heading / sqrt(dot(path.heading, path.heading))

    start = place_at(path, 0.0, 0.0, -START_HEIGHT)
    arm = Arm(operator, start / scale)
    intended = start / scale
    setpoint = robot = moved(registered, start)
    goals = np.tile(setpoint, (most, 1))
    tips, setpoints = np.empty((most, 3)), np.empty((most, 3))
    pulls, contacts, powers = np.zeros((most, 3)), np.zeros(most), np.zeros(most)
    approach = int(APPROACH / period)
    cycle, none, finished = 0, np.zeros(3), False

    for cycle in range(most):
        along, across, below = hand.aim(cycle, approach)
        above = max(0.0, 1.0 - cycle / approach) * START_HEIGHT
        place, up = at(path, along)
        meant = (place + across * path.across - (below - above) * up) / scale
        pull = pulls[cycle - force_delay] if cycle >= force_delay else none
        handle = arm.move(meant, (meant - intended) / period, pull, period)
        intended = meant

        goals[cycle] = moved(registered, scale * handle + shake[cycle])
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
            pulls[cycle] = turned(true_frame, pulled)
        powers[cycle] = dot(pull, arm.speed)
        robot = robot + follow * (setpoint - robot)
        tip = moved(true_frame, robot)
        if bone:
            tip, contacts[cycle] = bone.press(tip, period)
        tips[cycle], setpoints[cycle] = tip, setpoint

        offset = tip - place
        hand.look(Seen(dot(offset, heading), dot(offset, path.across), -dot(offset, up), above, dot(pull, up)))
        if hand.along >= path.length and coordinates(path, tip)[0] >= path.length - NEAR_THE_END:
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
