# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from experiments.smoothness import arc_length_bounds, sparc, spectral_arc_length

RATE = 100.0
TIME = np.arange(-1.0, 1.0, 1.0 / RATE)
BELL = np.exp(-5.0 * TIME**2)


def test_sparc_of_a_bell_is_what_its_authors_print():
    assert sparc(BELL, RATE) == pytest.approx(-1.41403, abs=5e-6)


def test_arc_length_of_a_bell_is_that_of_its_continuous_spectrum():
    # The spectrum of exp(-5 t^2) is exp(-(pi f)^2 / 5). The arc length is integrated on a fine grid.
    f = np.linspace(0.0, 20.0, 200_001)
    amplitude = np.exp(-((np.pi * f) ** 2) / 5.0)
    expected = -np.sum(np.hypot(np.diff(f) / 20.0, np.diff(amplitude)))
    assert spectral_arc_length(BELL, RATE) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("measure", [sparc, spectral_arc_length])
def test_neither_unit_nor_stretch_of_speed_matter_but_jerks_do(measure):
    smooth = measure(BELL, RATE)
    assert measure(1000.0 * BELL, RATE) == pytest.approx(smooth, rel=1e-12)
    assert measure(BELL + 0.3 * np.sin(2 * np.pi * 4.0 * TIME) ** 2, RATE) < smooth - 0.05


def test_only_the_fixed_cut_off_sees_tremor_above_ten_hertz():
    shaken = BELL + 0.1 * np.sin(2 * np.pi * 15.0 * TIME)
    assert sparc(shaken, RATE) == pytest.approx(sparc(BELL, RATE), abs=0.01)
    assert spectral_arc_length(shaken, RATE) < spectral_arc_length(BELL, RATE) - 0.1


@pytest.mark.parametrize("speed", [np.zeros(100), np.array([1.0]), np.array([1.0, np.nan])])
def test_what_has_no_smoothness_is_refused(speed):
    with pytest.raises(ValueError):
        sparc(speed, RATE)


def irregular(variation: float, band: float, duration: float, seed: int) -> np.ndarray:
    """Returns a speed with mean 1, and white noise of this standard deviation up to `band` Hz."""
    samples = round(duration * RATE)
    frequency = np.fft.rfftfreq(samples, 1 / RATE)
    within = (frequency > 0) & (frequency <= band)
    spectrum = np.zeros(len(frequency), dtype=complex)
    spectrum[within] = np.random.default_rng(seed).standard_normal((within.sum(), 2)).view(complex)[:, 0]
    noise = np.fft.irfft(spectrum, samples)
    return 1.0 + variation * noise / noise.std()


@pytest.mark.parametrize("duration", [10.0, 40.0, 160.0])
@pytest.mark.parametrize("variation, band", [(0.3, 20.0), (0.5, 8.0), (1.0, 5.0), (1.0, 20.0)])
def test_arc_length_grows_with_irregularity_and_with_the_root_of_time(variation, band, duration):
    lengths = [spectral_arc_length(irregular(variation, band, duration, seed), RATE) for seed in range(6)]
    most, least = arc_length_bounds(variation, band, duration)
    assert least < np.mean(lengths) < most


def test_a_constant_speed_has_the_arc_length_of_a_rectangle():
    # |sin(x) / x| falls from 1 to 0, and rises and falls once in each of the lobes, with the peak at tan x = x. The arc
    # is longer than the sum of these heights, by at most the width of the spectrum, which is 1.
    duration = 20.0
    x = (np.arange(1, int(20.0 * duration)) + 0.5) * np.pi
    x -= 1.0 / x
    heights = 1.0 + 2.0 * np.sum(np.abs(np.sin(x)) / x)
    length = spectral_arc_length(np.ones(2000), RATE)
    assert heights < -length < heights + 1.0
    assert arc_length_bounds(0.0, 20.0, duration)[1] == pytest.approx(length, rel=0.01)


def test_sparc_hardly_depends_on_time_if_the_irregularity_is_small():
    lengths = {d: [m(irregular(0.2, 8.0, d, 1), RATE) for m in (sparc, spectral_arc_length)] for d in (10.0, 160.0)}
    change = np.abs(np.subtract(lengths[160.0], lengths[10.0]))
    assert change[0] < 0.5 < 2.0 < change[1]
