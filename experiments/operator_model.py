# SPDX-License-Identifier: BSD-3-Clause
"""The operator: a hand that decides where to move, the tremor, and an arm that feels the fixture's force.

`Operator.hand` chooses the hand: `intermittent.Intermittent` looks and corrects, `open_loop.OpenLoop` does not. All
other values are common to both.

Tremor: 0.182 mm RMS at the tip of a hand-held instrument during retinal surgery. Source: Riviere and Jensen (2000), "A
    study of instrument motion in retinal microsurgery", abstract. Its band is 8 to 12 Hz (PubMed Central PMC3989364,
    introduction). The robot multiplies it by the motion scale.

Motion scale: 0.2, the default of the research kit (jhu-dvrk/sawIntuitiveResearchKit, TeleOperationPSM::Scale).

Reaction: 0.14 s, the delay of feedback in a model of manual tracking. Source: van de Kamp, Gawthrop, Gollee, Loram
    (2013), "Refractoriness in sustained visuo-manual control", PLoS Computational Biology 9, figure 8.

Least force that the hand notices: 0.04 N, the mean over wrist, elbow and shoulder in motion. Source: Feyzabadi et al.
    (2013), "Human force discrimination during active arm motion for force feedback design", abstract.

The arm is a mass on a spring and a damper between the intended position and the handle, the usual form. Sources:
Speich, Shao, Goldfarb, "Modeling the human hand as it interacts with a telemanipulation system", Mechatronics 15,
2005. Fu and Cavusoglu, "Human arm-and-hand dynamics model with variability analyses for a stylus-based haptic
interface", IEEE SMC-B 42, 2012. The values are ours, of the order that such articles find for a light grip, near
critical damping.
"""
from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .experiment import Array
from .intermittent import Intermittent
from .open_loop import OpenLoop

#: Returns the random numbers of a trial for one purpose, such as "tremor". See streams().
Streams = Callable[[str], np.random.Generator]


def streams(*seeds: int) -> Streams:
    """Returns the random numbers of a trial: a generator for each purpose.

    Each purpose has numbers of its own, and no mode is part of the seeds. So all modes meet the same hand, tremor,
    registration and sight, and trials of two modes are pairs.
    """
    return lambda purpose: np.random.default_rng([*seeds, zlib.crc32(purpose.encode())])


@dataclass(frozen=True)
class Operator:
    """The hand, the tremor and the arm. Lengths are at the tip, except for `tremor`, which is at the hand."""

    hand: Intermittent | OpenLoop = field(default_factory=Intermittent)
    tremor: float = 0.182  # root mean square of the vector at the hand, 8 to 12 Hz [mm]
    motion_scale: float = 0.2  # tip motion divided by hand motion
    reaction: float = 0.14  # delay between an event at the tip and the decision that it causes [s]
    felt_force: float = 0.04  # least force of a fixture that the hand notices [N]
    mass: float = 0.15  # of hand and handle [kg]
    stiffness: float = 0.4  # of the arm [N/mm]
    damping: float = 0.014  # of the arm [N s/mm]


def tremor(random: np.random.Generator, cycles: int, period: float, rms: float) -> Array:
    """Returns (cycles, 3) [mm]: noise from 8 to 12 Hz whose vector has the root mean square `rms`.

    The spectrum is flat within the band and 0 outside.
    """
    frequency = np.fft.rfftfreq(cycles, period)
    within = (frequency >= 8.0) & (frequency <= 12.0)
    spectrum = np.zeros((len(frequency), 3), dtype=np.complex128)
    spectrum[within] = random.standard_normal((int(within.sum()), 6)).view(np.complex128)
    noise: Array = np.fft.irfft(spectrum, cycles, axis=0)
    size = np.sqrt(np.mean(np.sum(noise**2, axis=1)))
    if size > 0.0:
        noise *= rms / size
    return noise
