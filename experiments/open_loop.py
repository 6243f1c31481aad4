# SPDX-License-Identifier: BSD-3-Clause
"""A hand that follows the path with errors, and does not correct them.

Its errors are functions of the place along the path:

A bias, constant in a trial: the error of stereo vision.
A slow error below 2 Hz. 98.9 % of the power of voluntary motion of eye surgeons is below 2 Hz (Riviere, Rader, Khosla,
"Characteristics of hand motion of eye surgeons", 1997).
Adjustments in depth, up and down from 0.5 to 2 Hz, because the eye is not sure of the depth. Li et al. (2020) argue
that a fixture makes motion smoother because it takes these away.

The frequencies are those of a hand that moves at the speed of the course. The hand moves slower if the eye sees the
tip beside the path or above the depth. The amounts of bias and slow error are fitted to the numbers of Li et al. for
cutting without a fixture. An operator that looks and corrects is in intermittent.py; this one is kept for comparison.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from .experiment import Array

if TYPE_CHECKING:
    from .operator_model import Streams
    from .trial import Course, Draws

SAMPLES = 50.0  # of the errors, in a second at the speed of the course


@dataclass(frozen=True)
class OpenLoop:
    """The errors at the tip in mm, across the path and along the tool's axis (in depth)."""

    bias_across: float = 0.2  # standard deviation from trial to trial [mm]
    bias_in_depth: float = 0.25
    slow_across: float = 0.28  # root mean square within a trial [mm]
    slow_in_depth: float = 0.6
    slow_corner: float = 0.03  # of the slow error's first-order spectrum, cut at 2 Hz [Hz]
    adjusting: float = 0.0  # root mean square, in depth, 0.5 to 2 Hz [mm]
    tolerance: float = 0.5  # deviation at which the hand moves at half speed [mm]
    leaning: float = 1.5  # distance that the hand aims beyond a fixture, to lean on it [mm]

    def draw(self, course: Course, random: Streams) -> Draws:
        """Returns the errors across and in depth along the path, `errors`: (places, 2) [mm]."""
        places = int(course.path.length / course.speed * SAMPLES) + 2
        hand = random("hand")
        errors = slow_error(hand, places, 1 / SAMPLES, self.slow_corner)
        errors = errors * [self.slow_across, self.slow_in_depth]
        errors += hand.standard_normal(2) * [self.bias_across, self.bias_in_depth]
        errors[:, 1] += adjustments(hand, places, 1 / SAMPLES, self.adjusting)
        return {"errors": errors, "samples": np.array(SAMPLES)}


def slow_error(random: np.random.Generator, cycles: int, period: float, corner: float) -> Array:
    """Returns (cycles, 2): first-order noise without power above 2 Hz, each column with an expected mean square of
    1."""
    settle = int(3.0 / (2 * np.pi * corner) / period)
    white = random.standard_normal((settle + cycles, 2))
    pole = np.exp(-2 * np.pi * corner * period)
    drift = signal.lfilter([np.sqrt(1 - pole**2)], [1, -pole], white, axis=0)
    low_pass = signal.butter(4, 2.0, fs=1 / period, output="sos")
    smooth: Array = signal.sosfiltfilt(low_pass, drift, axis=0)
    return smooth[settle:]


def adjustments(random: np.random.Generator, cycles: int, period: float, rms: float) -> Array:
    """Returns (cycles,) [mm]: band noise from 0.5 to 2 Hz with this root mean square."""
    band = signal.butter(3, [0.5, 2.0], "bandpass", fs=1 / period, output="sos")
    noise: Array = signal.sosfiltfilt(band, random.standard_normal(cycles))
    noise *= rms / np.sqrt(np.mean(noise**2))
    return noise
