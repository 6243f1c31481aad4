# SPDX-License-Identifier: BSD-3-Clause
"""A hand that looks at the tip, moves, and corrects what it has seen.

One serial channel makes all decisions that need the eye. It makes one decision in each refractory period: about the
path (across it, and how far to go on) or about the depth, in turn. Each decision makes a submovement of minimum jerk.
Submovements add up. The hand knows what it has sent and not yet seen, and corrects only the rest. It corrects only
errors above a tolerance. It goes on along the path only if the last look at the depth showed no such error.

A hand that feels a fixture has no need to look at the depth. It looks at the path in each decision, and keeps the
force of the touch. With a fixture that it does not feel, it presses on until it does.

While it cuts, the command is at most the tolerance ahead of the tip that it sees: with the stiffness of the tip, 4 N/mm,
this limits the force to 2 N. Three surgeons pressed an ultrasonic blade with 1.91 N on average ("Ultrasonic tool to
cut human bone", Proc. IMechE H, doi 10.1177/09544119251399865, 2025, abstract). If the depth was right and two looks in
a row then show an error, the depth is in doubt. The hand lifts the tool out of the kerf, looks, and enters again.

Sources of the values. All were read as abstracts, except where stated.

refractory: van de Kamp, Gawthrop, Gollee, Loram (2013), "Refractoriness in sustained visuo-manual control", PLoS
    Computational Biology 9: 0.25 s for a system of order 0, which a robot that follows the hand is.
movement: "bell-shaped components lasting several-hundred milliseconds" in slow tracking (Sakaguchi, 2013,
    "Intermittent brain motor control observed in continuous tracking task"). Freund and Buedingen (1978, Experimental
    Brain Research 31): the duration does not depend on the amplitude. 0.5 s is ours, within that description.
noise: the force of a finger varies by 10.5 % of its amount with haptic feedback alone (Jones, 2000, "Perception and
    control of finger forces"). That motor noise is proportional to the command is from Harris and Wolpert (1998,
    "Signal-dependent noise determines motor planning", Nature 394; not read).
drift: unseen movements drift by 50 mm in 44 cycles of two movements of 150 mm (Patterson, Brown, Wagstaff, Sainburg,
    2017, PubMed Central PMC5607024): 3.8 % of the distance moved. The direction is constant in a trial.
tolerance: tracking has an error deadzone of 0.8 degrees at the eye (Miall, Weir, Stein, 1993, "Intermittency in human
    manual tracking tasks"). It is 0.53 mm if the image of 40 mm around the path fills 60 degrees; that image is ours.
sight_across: one of the 1,280 pixels of a camera (Li et al. used FLIR Blackfly S) that shows 60 mm; ours.
sight_in_depth: the same error in an image is worse in depth by distance over separation of the cameras. Existing
    stereo laparoscopes have a separation of 5 mm (Fishman, Ellis, Hasser, Stern, 2008, Surgical Endoscopy 22). The
    distance of 50 mm is ours.
lasting: the part of the variance of sight that is the same in each look at a place, because the view is the same; ours.
touch: 0.49 N, the force of a finger that explores a surface (Smith, Gosselin, Houde, 2002, "Deployment of fingertip
    forces in tactile exploration", Experimental Brain Research 147).
lift: height of a tool that leaves the kerf; ours.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from .experiment import interpolated

if TYPE_CHECKING:
    from .operator_model import Operator, Streams
    from .trial import Course, Draws, Seen

LOOKS = 256  # random numbers of this many decisions in each millimeter of the path; then they repeat


@dataclass(frozen=True)
class Intermittent:
    """The values of the hand. Lengths are at the tip."""

    refractory: float = 0.25  # from one decision to the next [s]
    movement: float = 0.5  # duration of a submovement [s]
    noise: float = 0.105  # standard deviation of each component of a submovement, relative to its length
    drift: float = 0.038  # error of each submovement in a direction of the trial, relative to its length
    sight_across: float = 0.05  # standard deviation of a look across the path [mm]
    sight_in_depth: float = 0.5  # and of a look at the depth
    lasting: float = 0.5  # part of the variance of sight that is constant at a place
    tolerance: float = 0.5  # smaller errors are not corrected [mm]
    touch: float = 0.49  # force with which the hand rests on a fixture [N]
    lift: float = 1.0  # height above the surface of a tool that leaves the kerf [mm]

    def draw(self, course: Course, random: Streams) -> Draws:
        """Returns the random numbers of decisions by the place along the path.

        `motor`: (millimeters, LOOKS, 3), errors of submovements. `sight`: (millimeters, LOOKS, 2), of looks across and
        in depth. `view`: (millimeters + 1, 2), the constant part of sight. All have a standard deviation of 1.
        `heading`: (3,), the unit direction of drift along, across and in depth.
        """
        millimeters = int(course.path.length) + 1
        hand, sight = random("hand"), random("sight")
        heading = hand.standard_normal(3)
        return {
            "heading": heading / np.sqrt(np.sum(heading**2)),
            "motor": hand.standard_normal((millimeters, LOOKS, 3)),
            "view": sight.standard_normal((millimeters + 1, 2)),
            "sight": sight.standard_normal((millimeters, LOOKS, 2)),
        }

    def start(self, operator: Operator, course: Course, draws: Draws, fixture: bool) -> IntermittentHand:
        """Returns a hand at the start of the path. With a fixture it presses until it feels it."""
        return IntermittentHand(self, operator, course, draws, fixture)


class IntermittentHand:
    """See trial.Hand. Vectors are along, across and below the path [mm]."""

    def __init__(self, hand: Intermittent, operator: Operator, course: Course, draws: Draws, fixture: bool) -> None:
        self.along = 0.0
        self._hand, self._course, self._draws, self._fixture = hand, course, draws, fixture
        self._felt = operator.felt_force
        self._reaction = max(1, round(operator.reaction / course.period))
        self._refractory = max(1, round(hand.refractory / course.period))
        self._movement = max(1, round(hand.movement / course.period))
        self._next = -1  # the cycle of the next decision
        self._looks = [0] * len(draws["motor"])  # decisions in each millimeter
        self._done = [0.0, 0.0, 0.0]  # the sum of finished submovements
        self._moves: list[tuple[int, list[float]]] = []  # the others: first cycle and length
        self._end = [0.0, 0.0, 0.0]  # the sum of all submovements
        self._aims: list[tuple[float, float, float]] = []  # in each cycle
        self._seen: list[Seen] = []
        self._turn_of_depth = True
        self._at_depth = False  # a look showed the wanted depth, since the tool entered
        self._misses = 0  # looks at the depth in a row that showed an error
        self._lifted = False

    def aim(self, cycle: int, approach: int) -> tuple[float, float, float]:
        """Returns the intended place: along, across and below the path [mm]."""
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
                share = part * part * part * (10.0 + part * (6.0 * part - 15.0))  # of minimum jerk
                for i in range(3):
                    out[i] += length[i] * share
        self._moves = left
        self.along = out[0]
        self._aims.append((out[0], out[1], out[2]))
        return out[0], out[1], out[2]

    def look(self, seen: Seen) -> None:
        """Stores what can be seen and felt in this cycle."""
        self._seen.append(seen)

    def _decide(self, cycle: int) -> None:
        """Makes one decision from what was seen a reaction ago, and starts its submovement."""
        hand, tolerance, cutting = self._hand, self._hand.tolerance, self._course.bone is not None
        then, aim = self._seen[cycle - self._reaction], self._aims[cycle - self._reaction]
        pending = [self._end[i] - aim[i] for i in range(3)]  # sent, and not yet seen
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
        # How far the command may still go ahead of the tip.
        room_along = tolerance - (self._end[0] - aim[0] - then.ahead) if cutting else tolerance
        room_below = tolerance - (self._end[2] - seen_depth) if cutting else tolerance

        feels = self._fixture and then.push > self._felt
        length = [0.0, 0.0, 0.0]
        wait = self._refractory
        if self._lifted:
            length[1] = -across if abs(across) > tolerance else 0.0
            length[2] = tolerance - self._end[2]  # down to the surface; the next decisions press on
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
                length[0] = max(0.0, min(self._course.speed * hand.refractory, room_along))
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
