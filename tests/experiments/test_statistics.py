# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from scipy import stats

from experiments import published
from experiments.hypothesis_tests import (
    Summary, effect, hedges_g, holm, in_words, student, welch)


@pytest.mark.parametrize("comparison, p", [
    (published.SAL, 1.93e-4),
    (published.DURATION, 0.068),
    (published.PATH_DEVIATION, 7e-7),
    (published.PENETRATION_DEPTH, 3e-8),
])
def test_student_of_what_the_paper_prints(comparison, p):
    digits = 0.5 if comparison is not published.SAL else 0.005
    assert student(comparison.free, comparison.fixture).p == pytest.approx(
        p, abs=digits * 10 ** np.floor(np.log10(p)))


def test_welch_of_the_paper_s_arc_lengths_is_ten_times_less_sure():
    assert welch(published.SAL.free, published.SAL.fixture).p == pytest.approx(2.2e-3, abs=5e-5)


@pytest.mark.parametrize("comparison", [published.SAL, published.DURATION])
def test_the_paper_used_student_s_test(comparison):
    assert student(comparison.free, comparison.fixture).p == pytest.approx(comparison.p, rel=0.02)


@pytest.mark.parametrize("equal, ours", [(True, student), (False, welch)])
def test_samples_give_what_scipy_gives(equal, ours):
    random = np.random.default_rng(3)
    a, b = random.normal(0.0, 1.0, 7), random.normal(1.0, 3.0, 12)
    expected = stats.ttest_ind(a, b, equal_var=equal)
    found = ours(Summary.of(a), Summary.of(b))
    assert (found.t, found.p) == pytest.approx((expected.statistic, expected.pvalue), rel=1e-12)


def test_without_spread_the_means_decide():
    assert student(Summary(1.0, 0.0, 3), Summary(1.0, 0.0, 3)).p == 1.0
    assert welch(Summary(2.0, 0.0, 3), Summary(1.0, 0.0, 3)).p == 0.0


def test_holm_worked_by_hand():
    # The 4 adjusted values are 0.005 * 4, 0.01 * 3, 0.03 * 2, and 0.04 * 1, raised to the value before it.
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.6, 0.9]) == [1.0, 1.0]


def test_hedges_g_worked_by_hand():
    # The means differ by 1, the pooled deviation is sqrt((4 + 16) / 2), and 8 degrees of freedom give 1 - 3 / 31.
    g = hedges_g(Summary(3.0, 2.0, 5), Summary(2.0, 4.0, 5))
    assert g == pytest.approx((28 / 31) / np.sqrt(10))


def test_an_interval_is_that_of_its_seed_and_turns_with_the_sides():
    random = np.random.default_rng(5)
    a, b = random.normal(0.0, 1.0, 12), random.normal(1.5, 2.0, 10)
    size = effect(a, b, seed=1)
    assert size == effect(a, b, seed=1) != effect(a, b, seed=2)
    assert size.low < size.g < size.high
    turned = effect(b, a, seed=1)
    assert turned.g == -size.g
    assert (turned.low, turned.high) == pytest.approx((-size.high, -size.low), abs=0.1)


def test_intervals_hold_the_truth_as_often_as_they_say():
    random = np.random.default_rng(6)
    held = 0
    for trial in range(300):
        a, b = random.normal(1.0, 1.0, 20), random.normal(0.0, 1.0, 20)
        size = effect(a, b, seed=trial, resamples=1000)
        held += size.low <= 1.0 <= size.high
    assert 0.91 <= held / 300 <= 0.99


def test_what_cannot_be_resampled_is_said_so():
    size = effect(published.DURATIONS_FREE, published.DURATIONS_FIXTURE, seed=1)
    assert np.isnan(size.low) and np.isnan(size.high)
    assert np.isfinite(size.g) and in_words(0.068, size) == f"p = 0.068, g = {size.g:.3g}"
    assert in_words(1.0, effect([1, 1, 1], [1, 1, 1], seed=1)) == "p = 1, no spread"
