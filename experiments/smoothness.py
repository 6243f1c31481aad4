# SPDX-License-Identifier: BSD-3-Clause
"""The smoothness of a motion, from its speed alone: the arc length of the speed's spectrum.

The spectrum of a smooth motion falls once and stays low; each jerk adds a hump, and length. Both measures are
negative and have no unit; nearer to zero is smoother. They do not depend on the speed or distance of the motion.

The spectral arc length depends on the duration of the motion: see arc_length_bounds(). SPARC depends on it less, and is
the control: if only the arc length differs between two motions, they may differ in time alone.
"""
from __future__ import annotations

import numpy as np
from scipy import signal

from .experiment import Array

#: Zeros after the end make the samples of the spectrum finer, by this many doublings. The sum over samples then
#: equals the integral to about four digits.
PADDING = 4


def spectral_arc_length(speed: Array, rate: float, cut_off: float = 20.0) -> float:
    """Returns the SAL of Li et al. (2020) (V-A), from 0 to the fixed `cut_off` [Hz].

    `speed`: (n,) in any unit, sampled at `rate` [Hz]. The spectrum is normalized by its value at 0, the distance
    moved. Balasubramanian, Melendez-Calderon, Burdet, "A robust and sensitive metric for quantifying movement
    smoothness", IEEE TBME 59, 2012.
    """
    frequency, amplitude = _spectrum(speed, rate, cut_off)
    return _minus_length(frequency, amplitude)


def sparc(speed: Array, rate: float, cut_off: float = 10.0, threshold: float = 0.05) -> float:
    """Like spectral_arc_length(), up to where the spectrum falls below `threshold` for good; at most to `cut_off`.

    So neither noise nor an empty band makes it longer. Balasubramanian, Melendez-Calderon, Roby-Brami, Burdet, "On
    the analysis of movement smoothness", Journal of NeuroEngineering and Rehabilitation 12, 2015.
    """
    frequency, amplitude = _spectrum(speed, rate, cut_off)
    last = int(np.flatnonzero(amplitude >= threshold)[-1])
    return _minus_length(frequency[: last + 1], amplitude[: last + 1])


def arc_length_bounds(variation: float, band: float, duration: float, cut_off: float = 20.0) -> tuple[float, float]:
    """Returns the expected spectral arc length of an irregular speed: the greater and the lesser bound, both negative.

    The speed begins and ends abruptly, lasts `duration` [s], and has a standard deviation of `variation` times its
    mean. Its irregularity is white noise up to `band` [Hz], at most `cut_off`. Both bounds grow in size with
    n = variation sqrt(pi band duration / 6). They are 1 + n, with a fall of the spectrum from 1 to 0, and the arc
    length of a constant speed plus n.

    Derivation of n: the noise has a complex Gaussian spectrum with E|V|^2 = variation^2 / (2 band duration), relative
    to V(0). The derivative of the envelope of such a process is Gaussian (Rice, 1945, "Mathematical analysis of
    random noise", section 3.7; not read). Its standard deviation is 2 pi duration sqrt(E|V|^2 / 24). The integral of
    its mean size, sqrt(2 / pi) times that, up to `band` is n.
    """
    noise = float(variation * np.sqrt(np.pi * band * duration / 6.0))
    rate = 5.0 * cut_off
    return -(1.0 + noise), spectral_arc_length(np.ones(round(duration * rate)), rate, cut_off) - noise


def _spectrum(speed: Array, rate: float, cut_off: float) -> tuple[Array, Array]:
    """Returns frequencies [Hz] up to `cut_off`, and amplitudes there; the first amplitude is 1."""
    speed = np.asarray(speed, dtype=np.float64)
    if speed.ndim != 1 or len(speed) < 2 or not np.all(np.isfinite(speed)):
        raise ValueError("a speed must be a row of finite numbers, at least two")
    step = rate / 2 ** (int(np.ceil(np.log2(len(speed)))) + PADDING)
    count = int(cut_off / step) + 1
    amplitude = np.abs(signal.zoom_fft(speed, [0.0, count * step], count, fs=rate))
    if amplitude[0] == 0.0:
        raise ValueError("the speed is 0 everywhere, so it has no smoothness")
    return np.arange(count) * step, amplitude / amplitude[0]


def _minus_length(frequency: Array, amplitude: Array) -> float:
    """Returns minus the length of the polyline of these points, with the frequencies scaled to a width of 1."""
    across = np.diff(frequency) / (frequency[-1] - frequency[0])
    return -float(np.sum(np.hypot(across, np.diff(amplitude))))
