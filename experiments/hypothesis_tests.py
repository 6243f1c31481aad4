# SPDX-License-Identifier: BSD-3-Clause
"""Tests if two modes differ, by how much, and how certain that is.

Trials of two modes are pairs: the trials with the same number share operator, tremor and registration. A sample has
one number for each trial. Values at every millimeter of one cut are not independent; a test that treats them as
independent gives p values that are too small. That test of Li et al. (2020) is published_design.student_p().
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import optimize, stats

from .experiment import Array

CONFIDENCE = 0.95
#: From this number of pairs on, the interval of an effect is a BCa bootstrap; below, it is exact for normal samples.
MANY_PAIRS = 15


@dataclass(frozen=True)
class Interval:
    """An estimate with its 95 % interval; NaN if unknown."""

    value: float
    low: float
    high: float

    def text(self, digits: int = 3) -> str:
        """Returns the estimate and its interval; `-` if the estimate is unknown."""
        if not np.isfinite(self.value):
            return "-"
        if not np.isfinite(self.low):
            return f"{self.value:.{digits}g}"
        return f"{self.value:.{digits}g} [{self.low:.{digits}g}, {self.high:.{digits}g}]"


UNKNOWN = Interval(float("nan"), float("nan"), float("nan"))


def signed_rank_p(differences: ArrayLike) -> float:
    """Returns the two-sided p of Wilcoxon's signed-rank test, exact also with ties.

    differences: (n,), one for each pair. Infinite differences share the largest rank, so a trial without a value can
    count as the worst (Lachin 1999, worst-rank scores). Zeros are omitted (Wilcoxon 1945). The p is twice the smaller
    tail of the sum of the positive ranks over all signs, at most 1. It is 1 if all differences are zero, and NaN if
    one is NaN.
    """
    values = np.asarray(differences, dtype=np.float64)
    if np.isnan(values).any():
        return float("nan")
    values = values[values != 0.0]
    twice = np.rint(2.0 * stats.rankdata(np.abs(values))).astype(int)  # ranks of ties are halves
    ways = np.ones(1)  # ways[s]: the share of signs with positive ranks of sum s / 2
    for rank in twice:
        longer = np.zeros(len(ways) + rank)
        longer[: len(ways)] += 0.5 * ways
        longer[rank:] += 0.5 * ways
        ways = longer
    positive = int(twice[values > 0.0].sum())
    return float(min(1.0, 2.0 * min(ways[: positive + 1].sum(), ways[positive:].sum())))


def mean_difference(differences: ArrayLike) -> Interval:
    """Returns the mean of (n,) differences of pairs with Student's interval; the interval is NaN for n < 2."""
    values = np.asarray(differences, dtype=np.float64)
    if len(values) < 2:
        return Interval(float(values.mean()), UNKNOWN.low, UNKNOWN.high) if len(values) else UNKNOWN
    mean, sd, n = float(values.mean()), float(values.std(ddof=1)), len(values)
    wide = float(stats.t.ppf(0.5 + CONFIDENCE / 2, n - 1)) * sd / np.sqrt(n)
    return Interval(mean, mean - wide, mean + wide)


def effect(differences: ArrayLike, seed: int, resamples: int = 5000) -> Interval:
    """Returns the mean of (n,) differences of pairs in their standard deviations: Hedges' g of pairs.

    The estimate has Hedges' correction 1 - 3 / (4 (n - 1) - 1) for small samples (Hedges 1981). Below MANY_PAIRS the
    interval is exact for normal differences. There, t = mean / (sd / sqrt(n)) is non-central t, and its parameter is
    sqrt(n) times the true effect (Hedges and Olkin 1985). From MANY_PAIRS on it is the BCa bootstrap of pairs
    (Efron 1987), which needs no normality; the same seed gives the same interval. All is NaN for n < 2 or without
    spread.
    """
    values = np.asarray(differences, dtype=np.float64)
    n = len(values)
    if n < 2 or np.ptp(values) <= 1e-12 * np.abs(values).max(initial=0.0):
        return UNKNOWN
    size = float(_effects(values))
    if n >= MANY_PAIRS:
        found = stats.bootstrap((values,), _effects, method="BCa", n_resamples=resamples,
                                confidence_level=CONFIDENCE, random_state=seed).confidence_interval
        return Interval(size, float(found.low), float(found.high))
    t = float(values.mean() / (values.std(ddof=1) / np.sqrt(n)))
    low, high = (_noncentrality(t, n - 1, p) / np.sqrt(n) for p in (0.5 + CONFIDENCE / 2, 0.5 - CONFIDENCE / 2))
    return Interval(size, low, high)


def _effects(differences: Array, axis: int = -1) -> Array:
    """Returns Hedges' g of pairs along an axis. Limited to a million, because some resamples have no spread."""
    n = differences.shape[axis]
    mean, spread = differences.mean(axis), differences.std(axis, ddof=1)
    correction = 1.0 - 3.0 / (4.0 * (n - 1) - 1.0)
    sizes: Array = correction * mean / np.maximum(spread, 1e-6 * np.abs(mean) + 1e-300)
    return sizes


def _noncentrality(t: float, dof: int, p: float) -> float:
    """Returns the parameter of the non-central t distribution whose distribution function at t is p."""

    def missing(parameter: float) -> float:
        with np.errstate(divide="ignore", invalid="ignore"):  # scipy takes the logarithm of 0 far in the tails
            return float(stats.nct.cdf(t, dof, parameter)) - p

    wide = 5.0 + 4.0 * abs(t)
    return float(optimize.brentq(missing, -wide, wide, xtol=1e-9))


def share(count: int, of: int) -> Interval:
    """Returns a share with the exact interval of Clopper and Pearson (1934); all is NaN of 0."""
    if of == 0:
        return UNKNOWN
    found = stats.binomtest(count, of).proportion_ci(CONFIDENCE, method="exact")
    return Interval(count / of, float(found.low), float(found.high))


def sign_p(more: int, less: int) -> float:
    """Returns the exact two-sided p of the sign test of pairs; for pairs of yes and no it is McNemar's test.

    more, less: pairs in which the first, or the second, has more. Returns 1 without such pairs.
    """
    return float(stats.binomtest(more, more + less).pvalue) if more + less else 1.0


def jackknife_error(without: ArrayLike) -> float:
    """Returns the standard error of a statistic of n trials from its (n,) values without each of them.

    Source: Efron and Stein 1981.
    """
    values = np.asarray(without, dtype=np.float64)
    return float(np.sqrt((len(values) - 1) * np.mean((values - values.mean()) ** 2)))


def holm(p_values: Sequence[float]) -> list[float]:
    """Returns the p values of a family of tests, each adjusted for the number of tests.

    If an adjusted p below 0.05 counts as significant, the family has a false finding with a probability of at most 5 %.
    Holm, "A simple sequentially rejective multiple test procedure", 1979.
    """
    order = np.argsort(p_values, kind="stable")
    adjusted = np.empty(len(order))
    adjusted[order] = np.maximum.accumulate(np.arange(len(order), 0, -1) * np.asarray(p_values)[order])
    return [float(p) for p in np.minimum(adjusted, 1.0)]


def p_text(p: float) -> str:
    """Returns `p = 0.012`, or `p < 1e-6`, or `no p`."""
    if not np.isfinite(p):
        return "no p"
    return "p < 1e-6" if p < 1e-6 else f"p = {p:.2g}"
