# SPDX-License-Identifier: BSD-3-Clause
"""Tests the hypothesis tests and intervals against printed numbers, scipy, hand calculations and simulations."""
import itertools

import numpy as np
import pytest
from scipy import stats

from experiments import published
from experiments.hypothesis_tests import (
    MANY_PAIRS, effect, holm, jackknife_error, mean_difference, p_text, share, signed_rank_p)
from experiments.published import Summary
from experiments.published_design import student_p


@pytest.mark.parametrize("comparison, p", [
    (published.SAL, 1.93e-4),
    (published.DURATION, 0.068),
    (published.PATH_DEVIATION, 7e-7),
    (published.PENETRATION_DEPTH, 3e-8),
])
def test_student_of_what_the_paper_prints(comparison, p):
    digits = 0.5 if comparison is not published.SAL else 0.005
    assert student_p(comparison.free, comparison.fixture) == pytest.approx(
        p, abs=digits * 10 ** np.floor(np.log10(p)))


@pytest.mark.parametrize("comparison", [published.SAL, published.DURATION])
def test_the_paper_used_student_s_test(comparison):
    assert student_p(comparison.free, comparison.fixture) == pytest.approx(comparison.p, rel=0.02)


def test_without_spread_the_means_decide():
    assert student_p(Summary(1.0, 0.0, 3), Summary(1.0, 0.0, 3)) == 1.0
    assert student_p(Summary(2.0, 0.0, 3), Summary(1.0, 0.0, 3)) == 0.0


def test_signed_ranks_without_ties_give_the_exact_p_of_scipy():
    random = np.random.default_rng(4)
    for n in (3, 8, 20, 40):
        differences = random.normal(0.4, 1.0, n)
        expected = stats.wilcoxon(differences, mode="exact").pvalue
        assert signed_rank_p(differences) == pytest.approx(expected, rel=1e-12)


def test_signed_ranks_with_ties_and_infinities_give_the_p_of_all_signs():
    differences = np.array([np.inf, np.inf, -np.inf, 0.5, -0.5, 0.2, 0.0, 0.7])
    ranks = np.array([6.0, 6.0, 6.0, 2.5, 2.5, 1.0, 4.0])  # without the zero, worked by hand
    sums = np.array([ranks @ np.array(signs) for signs in itertools.product((0, 1), repeat=7)])
    positive = 6.0 + 6.0 + 2.5 + 1.0 + 4.0
    expected = 2 * min(np.mean(sums <= positive), np.mean(sums >= positive))
    assert signed_rank_p(differences) == pytest.approx(expected, rel=1e-12)


def test_signed_ranks_of_equal_trials_are_no_evidence():
    assert signed_rank_p(np.zeros(5)) == signed_rank_p([]) == 1.0
    assert np.isnan(signed_rank_p([1.0, np.nan]))
    assert signed_rank_p([1.0] * 5) == 2 / 2**5


def test_holm_worked_by_hand():
    # The 4 adjusted values are 0.005 * 4, 0.01 * 3, 0.03 * 2, and 0.04 * 1, raised to the value before it.
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.6, 0.9]) == [1.0, 1.0]


def test_an_effect_worked_by_hand():
    # The mean is 2, the deviation 1, and 2 degrees of freedom give 1 - 3 / 7.
    size = effect([1.0, 2.0, 3.0], seed=1)
    assert size.value == pytest.approx(2.0 * 4.0 / 7.0)
    t = 2.0 * np.sqrt(3.0)
    for bound, p in ((size.low, 0.975), (size.high, 0.025)):
        assert stats.nct.cdf(t, 2, bound * np.sqrt(3.0)) == pytest.approx(p, abs=1e-8)


def test_an_interval_turns_with_the_sides_and_many_pairs_are_resampled_by_seed():
    random = np.random.default_rng(5)
    few, many = random.normal(1.0, 1.0, MANY_PAIRS - 1), random.normal(1.0, 1.0, MANY_PAIRS)
    size, turned = effect(few, seed=1), effect(-few, seed=2)
    assert (turned.value, turned.low, turned.high) == pytest.approx((-size.value, -size.high, -size.low))
    assert effect(many, seed=1) == effect(many, seed=1) != effect(many, seed=2)


def test_a_difference_has_the_interval_of_scipy():
    differences = np.array([0.2, 0.5, -0.1, 0.4])
    found = mean_difference(differences)
    low, high = stats.t.interval(0.95, 3, differences.mean(), stats.sem(differences))
    assert (found.low, found.high) == pytest.approx((low, high))


def coverage(n: int, true: float, families: int, resamples: int) -> float:
    """Returns the share of synthetic families of n pairs whose interval contains the true effect."""
    random = np.random.default_rng([n, round(100 * true)])
    held = 0
    for seed in range(families):
        size = effect(random.normal(true, 1.0, n), seed, resamples)
        held += size.low <= true <= size.high
    return held / families


@pytest.mark.parametrize("n, true", [(4, 0.8), (6, 3.0), (MANY_PAIRS - 1, 1.0)])
def test_exact_intervals_contain_the_truth_in_95_of_100_of_1000_families(n: int, true: float) -> None:
    # Four standard errors of a share of 0.95 in 1,000.
    assert coverage(n, true, 1000, 0) == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / 1000))


@pytest.mark.parametrize("n, true", [(MANY_PAIRS, 0.8), (40, 0.8)])
def test_bootstrap_intervals_contain_the_truth_in_at_least_90_of_100_of_1000_families(n: int, true: float) -> None:
    assert 0.90 <= coverage(n, true, 1000, 400) <= 0.98


def test_eight_true_null_hypotheses_have_a_finding_in_at_most_5_of_100_families() -> None:
    # Four ends that are correlated, in 12 trials, each against two modes that share a pair member.
    random, families, n = np.random.default_rng(9), 1000, 12
    false = 0
    for _ in range(families):
        common = random.normal(size=(n, 1, 1))
        values = 0.7 * common + random.normal(size=(n, 3, 4))
        against = (values[:, :1] - values[:, 1:]).reshape(n, 8)
        false += min(holm([signed_rank_p(one) for one in against.T])) < 0.05
    assert false / families <= 0.05 + 3 * np.sqrt(0.05 * 0.95 / families)


def test_shares_have_exact_bounds():
    nothing = share(0, 380)
    assert (nothing.value, nothing.low) == (0.0, 0.0)
    assert (1.0 - nothing.high) ** 380 == pytest.approx(0.025)
    assert np.isnan(share(0, 0).value)


def test_the_jackknife_of_a_mean_is_its_standard_error():
    values = np.random.default_rng(7).normal(size=9)
    without = [np.delete(values, i).mean() for i in range(9)]
    assert jackknife_error(without) == pytest.approx(stats.sem(values))


def test_what_cannot_be_estimated_is_unknown():
    assert effect([1.0], 1).text() == effect([2.0, 2.0], 1).text() == "-"
    assert mean_difference([0.5]).text() == "0.5"
    assert p_text(1e-9) == "p < 1e-6" and p_text(0.0123) == "p = 0.012" and p_text(float("nan")) == "no p"
