# SPDX-License-Identifier: BSD-3-Clause
"""How smooth a motion is, from its speed alone: how long a curve the speed's spectrum draws.

A smooth motion's spectrum falls once and stays low; each jerk adds a hump, and length. Both
measures are negative, have no unit, and are larger (nearer to zero) for what is smoother. Neither
depends on how fast or how far the motion goes; both on how long it takes: more happens then.
"""
from __future__ import annotations

import numpy as np

from .experiment import Array

#: The spectrum is sampled this many doublings finer than the speed's own length asks for, by zeros
#: after its end: then the sum over samples is the integral to about four digits.
PADDING = 4


def spectral_arc_length(speed: Array, rate: float, cut_off: float = 20.0) -> float:
    """SAL as the paper has it (V-A), from 0 to the fixed `cut_off` [Hz].

    Of `speed`, (n,) in any unit, sampled at `rate` [Hz]. The spectrum is normalised by its value
    at 0, the distance that was moved. Balasubramanian, Melendez-Calderon, Burdet, "A robust and
    sensitive metric for quantifying movement smoothness", IEEE TBME 59, 2012.
    """
    frequency, amplitude = _spectrum(speed, rate, cut_off)
    return _minus_length(frequency, amplitude)


def sparc(speed: Array, rate: float, cut_off: float = 10.0, threshold: float = 0.05) -> float:
    """The same, up to where the spectrum falls below `threshold` for good; at most to `cut_off`.

    So it is not lengthened by noise, nor by a band in which nothing happens. Balasubramanian,
    Melendez-Calderon, Roby-Brami, Burdet, "On the analysis of movement smoothness", Journal of
    NeuroEngineering and Rehabilitation 12, 2015.
    """
    frequency, amplitude = _spectrum(speed, rate, cut_off)
    last = int(np.flatnonzero(amplitude >= threshold)[-1])
    return _minus_length(frequency[: last + 1], amplitude[: last + 1])


def _spectrum(speed: Array, rate: float, cut_off: float) -> tuple[Array, Array]:
    """Frequencies [Hz] up to `cut_off`, and amplitudes there, of which the first is 1."""
    speed = np.asarray(speed, dtype=np.float64)
    if speed.ndim != 1 or len(speed) < 2 or not np.all(np.isfinite(speed)):
        raise ValueError("a speed is a row of finite numbers, two at least")
    samples = 2 ** (int(np.ceil(np.log2(len(speed)))) + PADDING)
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    amplitude = np.abs(np.fft.rfft(speed, samples))
    if amplitude[0] == 0.0:
        raise ValueError("nothing has moved: its smoothness has no meaning")
    kept = frequency <= cut_off
    return frequency[kept], amplitude[kept] / amplitude[0]


def _minus_length(frequency: Array, amplitude: Array) -> float:
    """Of the polyline of these points, with the frequencies scaled to a width of 1."""
    across = np.diff(frequency) / (frequency[-1] - frequency[0])
    return -float(np.sum(np.hypot(across, np.diff(amplitude))))
