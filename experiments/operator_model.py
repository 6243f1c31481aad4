# SPDX-License-Identifier: BSD-3-Clause
"""The operator: the intended motion, the errors of the hand, and an arm that feels the fixture's force.

The hand intends to follow a planned path. Its errors are:

A bias, constant in a trial: the error of stereo vision.
A slow error below 2 Hz: 98.9 % of the power of voluntary motion of eye surgeons is below 2 Hz.
Adjustments in depth, up and down from 0.5 to 2 Hz, because the eye is not sure of the depth. Li et al. (2020) argue
that a fixture makes motion smoother because it takes these away.
Physiological tremor from 8 to 12 Hz, of 0.05, 0.13 and 0.25 mm RMS, here of the robot's goal. Measured values are
0.049 mm (holding still) and 0.133 mm (actuating). Without sight of the tip it is 0.254 mm in the axis with most of it
(PubMed Central PMC3032442).

The source of the power and of the first two values of tremor is Riviere, Rader, Khosla, "Characteristics of hand
motion of eye surgeons", 1997.

The arm is a mass on a spring and a damper between the intended position and the handle, the usual form. Sources:
Speich, Shao, Goldfarb, "Modeling the human hand as it interacts with a telemanipulation system", Mechatronics 15,
2005. Fu and Cavusoglu, "Human arm-and-hand dynamics model with variability analyses for a stylus-based haptic
interface", IEEE SMC-B 42, 2012. The values are ours, of the order that such articles find for a light grip, near
critical damping.

The amounts of bias and slow error are not from the literature. They are fitted to the numbers of Li et al. for
cutting WITHOUT a fixture (`docs/experiments.md` has the table). All results with a fixture are then predictions, with
no parameter left to fit.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

from .experiment import Array


@dataclass(frozen=True)
class Operator:
    """The errors at the tip in mm, across the path and along the tool's axis (in depth)."""

    bias_across: float = 0.2  # standard deviation from trial to trial [mm]
    bias_in_depth: float = 0.25
    slow_across: float = 0.28  # root mean square within a trial [mm]
    slow_in_depth: float = 0.6
    slow_corner: float = 0.03  # of the slow error's first-order spectrum, cut at 2 Hz [Hz]
    adjusting: float = 0.0  # root mean square, in depth, 0.5 to 2 Hz [mm]
    tremor: float = 0.13  # root mean square of the vector, 8 to 12 Hz [mm]
    mass: float = 0.15  # of hand and handle [kg]
    stiffness: float = 0.4  # of the arm [N/mm]
    damping: float = 0.014  # of the arm [N s/mm]
    motion_scale: float = 1.0  # tip motion divided by hand motion
    reaction: float = 0.2  # delay between the deviation and the hand's change of speed [s]
    tolerance: float = 0.5  # deviation at which the hand moves at half speed [mm]
    felt_force: float = 0.1  # least force of a fixture that the hand notices [N]
    leaning: float = 1.5  # distance that the hand aims beyond a fixture, to lean on it [mm]


def slow_error(random: np.random.Generator, cycles: int, period: float, corner: float) -> Array:
    """Returns (cycles, 3): first-order noise without power above 2 Hz, each axis with an expected mean square of
    1."""
    settle = int(3.0 / (2 * np.pi * corner) / period)
    white = random.standard_normal((settle + cycles, 3))
    pole = np.exp(-2 * np.pi * corner * period)
    drift = signal.lfilter([np.sqrt(1 - pole**2)], [1, -pole], white, axis=0)
    low_pass = signal.butter(4, 2.0, fs=1 / period, output="sos")
    smooth: Array = signal.sosfiltfilt(low_pass, drift, axis=0)
    return smooth[settle:]


def adjustments(random: np.random.Generator, cycles: int, period: float, rms: float) -> Array:
    """Returns (cycles,) [mm]: band noise from 0.5 to 2 Hz with this root mean square."""
    return _band(random.standard_normal((cycles, 1)), 0.5, 2.0, period, rms)[:, 0]


def tremor(random: np.random.Generator, cycles: int, period: float, rms: float) -> Array:
    """Returns (cycles, 3) [mm]: band noise from 8 to 12 Hz; its vector has this root mean square."""
    return _band(random.standard_normal((cycles, 3)), 8.0, 12.0, period, rms)


def _band(white: Array, low: float, high: float, period: float, rms: float) -> Array:
    band = signal.butter(3, [low, high], "bandpass", fs=1 / period, output="sos")
    noise: Array = signal.sosfiltfilt(band, white, axis=0)
    return noise * (rms / np.sqrt(np.mean(np.sum(noise**2, axis=1))))


class Arm:
    """The mass, the spring and the damper. Positions and velocities are those of the handle [mm, mm/s]."""

    def __init__(self, operator: Operator, place: Array) -> None:
        self.place = place.copy()
        self.speed = np.zeros(3)
        self._operator = operator

    def move(self, intended: Array, intended_speed: Array, force: Array, period: float) -> Array:
        """Moves the handle for one cycle of `period` [s] under a `force` [N], and returns its position.

        Semi-implicit Euler: stable, because the damper acts on the velocity at the end of the cycle.
        """
        arm = self._operator
        mass = arm.mass / 1000.0  # in N s^2/mm, because lengths are in mm
        pull = arm.stiffness * (intended - self.place) + arm.damping * intended_speed + force
        self.speed = (self.speed + pull * (period / mass)) / (1.0 + arm.damping * period / mass)
        self.place = self.place + self.speed * period
        return self.place
