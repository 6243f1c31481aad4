# SPDX-License-Identifier: BSD-3-Clause
"""A hand that looks at the tip, moves, and corrects what it has seen.

One serial channel makes all decisions that need the eye. It makes one decision in each refractory period: about the
path (across it, and how far to go on) or about the depth, in turn. Each decision makes a submovement of minimum jerk.
Submovements add up. The hand knows what it has sent and not yet seen, and corrects only the rest. It corrects only
errors above a tolerance. It goes on along the path only if the last look at the depth showed no such error.

A hand that feels a fixture has no need to look at the depth. It looks at the path in each decision, and keeps the
force of the touch. With a fixture that it does not feel, it presses on until it does.

While it cuts, the command is at most the tolerance ahead of the tip that it sees. The stiffness of the tip is 4 N/mm,
so this limits the force to 2 N. Three surgeons pressed an ultrasonic blade with 1.91 N on average ("Ultrasonic tool to
cut human bone", Proc. IMechE H, doi 10.1177/09544119251399865, 2025, abstract). A hand whose tip has not followed for
four decisions (ours) pulls on: a fixture may hold the tip. If the depth was right and two looks in a row then show an
error, the depth is in doubt. The hand lifts the tool out of the kerf, looks, and enters again.

Sources of the values. All were read as abstracts, except where stated.

refractory: 0.25 s for a system of order 0, which a robot that follows the hand is. Source: van de Kamp, Gawthrop,
    Gollee, Loram (2013), "Refractoriness in sustained visuo-manual control", PLoS Computational Biology 9.

movement: slow tracking has "bell-shaped components lasting several-hundred milliseconds". Source: Sakaguchi (2013),
    "Intermittent brain motor control observed in continuous tracking task". The duration does not depend on the
    amplitude (Freund and Buedingen, 1978, Experimental Brain Research 31). 0.5 s is ours.

noise: the force of a finger varies by 10.5 % of its amount with haptic feedback alone. Source: Jones (2000),
    "Perception and control of finger forces". Harris and Wolpert (1998, Nature 394, not read) have the principle that
    motor noise is proportional to the command.

drift: unseen movements drift by 50 mm in 44 cycles of two movements of 150 mm, which is 3.8 % of the distance moved.
    Source: Patterson, Brown, Wagstaff, Sainburg (2017), PubMed Central PMC5607024. The direction is constant in a
    trial.

tolerance: tracking has an error deadzone of 0.8 degrees at the eye. Source: Miall, Weir, Stein (1993), "Intermittency
    in human manual tracking tasks". It is 0.53 mm if an image of 40 mm fills 60 degrees. That image is ours.

sight_across: a pixel of a camera with 1,280 pixels that shows 60 mm; ours. Li et al. (2020) used FLIR Blackfly S.

sight_in_depth: the error in depth of the same error in an image is larger, by distance over separation of the cameras.
    Stereo laparoscopes have a separation of 5 mm (Fishman, Ellis, Hasser, Stern, 2008, Surgical Endoscopy 22). The
    distance of 50 mm is ours.

lasting: a part of the error of sight is the same in each look at a place, because the view is the same; ours.

touch: 0.49 N, the force of a finger that explores a surface. Source: Smith, Gosselin, Houde (2002), "Deployment of
    fingertip forces in tactile exploration", Experimental Brain Research 147.

lift: height of a tool that leaves the kerf; ours.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .operator_model import Streams
    from .trial import Course, Draws

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
