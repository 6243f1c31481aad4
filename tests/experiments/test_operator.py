# SPDX-License-Identifier: BSD-3-Clause
"""Tests the model of the operator: the bands and sizes of errors, and the compliance of the arm."""
import numpy as np
import pytest
from experiments.operator_model import Arm, Operator, adjustments, slow_error, tremor

PERIOD = 0.001


def power_within(signal: np.ndarray, low: float, high: float) -> float:
    """Returns the fraction of the power from `low` to `high` Hz."""
    spectrum = np.abs(np.fft.rfft(signal, axis=0)) ** 2
    frequency = np.fft.rfftfreq(len(signal), PERIOD)
    return float(spectrum[(frequency >= low) & (frequency <= high)].sum() / spectrum.sum())


@pytest.mark.parametrize("rms", [0.05, 0.13, 0.25])
def test_tremor_has_its_amount_and_its_band(rms: float) -> None:
    shake = tremor(np.random.default_rng(1), 60_000, PERIOD, rms)
    assert np.sqrt(np.mean(np.sum(shake**2, axis=1))) == pytest.approx(rms)
    assert power_within(shake, 7.0, 13.0) > 0.98
    assert power_within(shake, 0.0, 5.0) < 1e-3


def test_slow_errors_are_below_two_hertz_and_of_unit_size() -> None:
    errors = slow_error(np.random.default_rng(2), 2_000_000, PERIOD, 0.03)
    assert power_within(errors, 0.0, 2.2) > 0.999
    assert np.mean(errors**2) == pytest.approx(1.0, abs=0.15)


def test_adjustments_are_from_half_a_hertz_to_two() -> None:
    errors = adjustments(np.random.default_rng(3), 200_000, PERIOD, 0.4)
    assert power_within(errors, 0.25, 4.0) > 0.95
    assert power_within(errors, 4.0, 500.0) < 0.001
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(0.4)


def test_the_arm_gives_way_by_force_over_stiffness() -> None:
    operator = Operator()
    arm = Arm(operator, np.zeros(3))
    force = np.array([0.0, 0.0, 0.5])
    for _ in range(3000):
        arm.move(np.zeros(3), np.zeros(3), force, PERIOD)
    assert arm.place == pytest.approx(force / operator.stiffness, abs=1e-9)


def test_the_arm_swings_as_mass_spring_and_damper_do() -> None:
    operator = Operator(damping=0.0)
    arm = Arm(operator, np.array([1.0, 0.0, 0.0]))
    places = [arm.move(np.zeros(3), np.zeros(3), np.zeros(3), PERIOD)[0] for _ in range(5000)]
    turns = np.count_nonzero(np.diff(np.sign(places)))
    natural = np.sqrt(operator.stiffness * 1000.0 / operator.mass) / (2 * np.pi)
    assert turns / 2 / 5.0 == pytest.approx(natural, rel=0.02)
