# SPDX-License-Identifier: BSD-3-Clause
"""Tests if two modes differ, by how much, and how certain that is.

The p values of Li et al. (2020) are of Student's test, which assumes that both modes have the same variance. Welch's
test does not, and is the one to trust. A sample has one number for each trial. Values at every millimeter of one
cut are not independent; a test that treats them as independent gives p values that are too small.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from .experiment import Array


@dataclass(frozen=True)
class Summary:
    """The summary of a sample: mean, standard deviation (of n - 1), and size."""

    mean: float
    sd: float
    n: int

    @staticmethod
    def of(sample: ArrayLike) -> Summary:
        values = np.asarray(sample, dtype=np.float64)
        return Summary(float(values.mean()), float(values.std(ddof=1)), len(values))


@dataclass(frozen=True)
class MeanTest:
    """A test of equal means: the statistic, and the two-sided p."""

    t: float
    p: float


@dataclass(frozen=True)
class Effect:
    """Hedges' g, the difference a - b in standard deviations, and its interval. NaN if unknown."""

    g: float
    low: float
    high: float


def student(a: Summary, b: Summary) -> MeanTest:
    """Returns the pooled test: exact for normal samples with the same variance."""
    return _test(a, b, equal_var=True)


def welch(a: Summary, b: Summary) -> MeanTest:
    """Returns the test for variances that may differ, with the degrees of freedom of Welch and Satterthwaite."""
    return _test(a, b, equal_var=False)


def _test(a: Summary, b: Summary, *, equal_var: bool) -> MeanTest:
    if a.sd == b.sd == 0.0:  # without spread the means are equal or different for certain
        same = a.mean == b.mean
        return MeanTest(0.0 if same else float(np.copysign(np.inf, a.mean - b.mean)), float(same))
    found = stats.ttest_ind_from_stats(a.mean, a.sd, a.n, b.mean, b.sd, b.n, equal_var)
    return MeanTest(float(found.statistic), float(found.pvalue))


def hedges_g(a: Summary, b: Summary) -> float:
    """Returns (a - b) / pooled deviation, times the correction 1 - 3 / (4 dof - 1).

    The correction is needed because small samples exaggerate the effect. Returns NaN without spread. Source: Hedges,
    "Distribution theory for Glass's estimator of effect size", 1981.
    """
    if a.sd == b.sd == 0.0:
        return float("nan")
    squares = (a.n - 1) * a.sd**2 + (b.n - 1) * b.sd**2
    return float(_bounded_g(np.float64(a.mean - b.mean), squares, a.n + b.n - 2))


def _bounded_g(difference: Array, squares: Array, dof: int) -> Array:
    """Returns g from differences of means and sums of squares. Limited to a million, because some samples have no
    spread."""
    spread = np.maximum(np.sqrt(squares / dof), 1e-6 * np.abs(difference))
    g: Array = difference / np.where(difference == 0.0, 1.0, spread) * (1 - 3 / (4 * dof - 1))
    return g


def _hedges_g_along(a: Array, b: Array, axis: int = -1) -> Array:
    n, m = a.shape[axis], b.shape[axis]
    squares = (n - 1) * a.var(axis, ddof=1) + (m - 1) * b.var(axis, ddof=1)
    return _bounded_g(a.mean(axis) - b.mean(axis), squares, n + m - 2)


def effect(
    a: ArrayLike, b: ArrayLike, seed: int, confidence: float = 0.95, resamples: int = 10_000
) -> Effect:
    """Returns Hedges' g with the interval of the BCa bootstrap, which resamples each mode separately.

    Efron, "Better bootstrap confidence intervals", 1987: corrected for bias, and for a spread that changes with g.
    The interval is NaN for fewer than three trials of a mode. The same seed gives the same interval.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    g = hedges_g(Summary.of(a), Summary.of(b))
    if min(len(a), len(b)) < 3 or not np.isfinite(g):
        return Effect(g, float("nan"), float("nan"))
    interval = stats.bootstrap(
        (a, b), _hedges_g_along, method="BCa", n_resamples=resamples, confidence_level=confidence,
        random_state=seed,
    ).confidence_interval
    return Effect(g, float(interval.low), float(interval.high))


def holm(p_values: Sequence[float]) -> list[float]:
    """Returns the p values of a family of tests, each adjusted for the number of tests.

    If an adjusted p below 0.05 counts as significant, the family has a false finding with a probability of at most 5 %.
    Holm, "A simple sequentially rejective multiple test procedure", 1979.
    """
    order = np.argsort(p_values, kind="stable")
    adjusted = np.empty(len(order))
    adjusted[order] = np.maximum.accumulate(np.arange(len(order), 0, -1) * np.asarray(p_values)[order])
    return np.minimum(adjusted, 1.0).tolist()


def in_words(p_after_holm: float, size: Effect) -> str:
    """Returns p after Holm, and the effect with its interval, as text for a table."""
    p = "p < 1e-6" if p_after_holm < 1e-6 else f"p = {p_after_holm:.2g}"
    if not np.isfinite(size.g):
        return f"{p}, no spread"
    if not np.isfinite(size.low):
        return f"{p}, g = {size.g:.3g}"
    return f"{p}, g = {size.g:.3g} [{size.low:.3g}, {size.high:.3g}]"
