# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from experiments.smoothness import sparc, spectral_arc_length

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
