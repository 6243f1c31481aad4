# SPDX-License-Identifier: BSD-3-Clause
"""Whether two modes differ, by how much, and how sure that is.

The paper's p values are of Student's test, which takes both modes to vary alike; Welch's does not, and
is what is to be believed. Samples are whole trials, one number each: what is measured every millimetre
of one cut is not independent, and counting it as if it were makes p values too small.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Summary:
    """What is left of a sample when it is printed: mean, standard deviation (of n - 1), and size."""

    mean: float
    sd: float
    n: int

    @staticmethod
    def of(sample: ArrayLike) -> Summary:
        values = np.asarray(sample, dtype=np.float64)
        return Summary(float(values.mean()), float(values.std(ddof=1)), len(values))


@dataclass(frozen=True)
class MeanTest:
    """Of the hypothesis that both means are equal: the statistic, its degrees of freedom, two-sided p."""

    t: float
    dof: float
    p: float


@dataclass(frozen=True)
class Effect:
    """Hedges' g and its interval: the difference a - b in standard deviations. NaN where unknown."""

    g: float
    low: float
    high: float


def student(a: Summary, b: Summary) -> MeanTest:
    """The pooled test: exact for normal samples of the same variance."""
    return _test(a.mean - b.mean, _pooled_sd(a, b) * np.sqrt(1 / a.n + 1 / b.n), a.n + b.n - 2)


def welch(a: Summary, b: Summary) -> MeanTest:
    """For variances that may differ, with the degrees of freedom of Welch and Satterthwaite."""
    in_a, in_b = a.sd**2 / a.n, b.sd**2 / b.n
    if in_a + in_b == 0.0:
        return _test(a.mean - b.mean, 0.0, a.n + b.n - 2)
    dof = (in_a + in_b) ** 2 / (in_a**2 / (a.n - 1) + in_b**2 / (b.n - 1))
    return _test(a.mean - b.mean, np.sqrt(in_a + in_b), dof)


def hedges_g(a: Summary, b: Summary) -> float:
    """(a - b) / pooled deviation, times the usual 1 - 3 / (4 dof - 1), as small samples exaggerate.

    Hedges, "Distribution theory for Glass's estimator of effect size", 1981. NaN without any spread.
    """
    spread = _pooled_sd(a, b)
    if spread == 0.0:
        return float("nan")
    return float((a.mean - b.mean) / spread * (1 - 3 / (4 * (a.n + b.n - 2) - 1)))


def effect(
    a: ArrayLike, b: ArrayLike, seed: int, confidence: float = 0.95, resamples: int = 10_000
) -> Effect:
    """Hedges' g with the interval of the BCa bootstrap, each mode resampled by itself.

    Efron, "Better bootstrap confidence intervals", 1987: corrected for bias, and for a spread that
    changes with g (by the jackknife over trials of both modes). Fewer than three trials of a mode are
    too few to resample: the interval is NaN then. The same seed gives the same interval.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    g = hedges_g(Summary.of(a), Summary.of(b))
    if min(len(a), len(b)) < 3 or not np.isfinite(g):
        return Effect(g, float("nan"), float("nan"))
    random = np.random.default_rng(seed)
    drawn_a = a[random.integers(0, len(a), (resamples, len(a)))]
    drawn_b = b[random.integers(0, len(b), (resamples, len(b)))]
    resampled = _hedges_g_of_rows(drawn_a, drawn_b)
    resampled = resampled[np.isfinite(resampled)]  # without those of no spread at all
    below = np.mean(resampled < g) + 0.5 * np.mean(resampled == g)
    bias = stats.norm.ppf(np.clip(below, 1 / resamples, 1 - 1 / resamples))
    acceleration = _acceleration(a, b)
    edges = []
    for quantile in ((1 - confidence) / 2, (1 + confidence) / 2):
        shifted = bias + stats.norm.ppf(quantile)
        edges.append(stats.norm.cdf(bias + shifted / (1 - acceleration * shifted)))
    low, high = np.quantile(resampled, edges)
    return Effect(g, float(low), float(high))


def holm(p_values: Sequence[float]) -> list[float]:
    """Each p as if it were the only one of its family: below 0.05 means 5 % for any error at all.

    Holm, "A simple sequentially rejective multiple test procedure", 1979.
    """
    adjusted = [1.0] * len(p_values)
    highest = 0.0
    for rank, which in enumerate(np.argsort(p_values, kind="stable")):
        highest = max(highest, min(1.0, (len(p_values) - rank) * p_values[which]))
        adjusted[which] = highest
    return adjusted


def in_words(p_after_holm: float, size: Effect) -> str:
    """For a table: p after Holm, and the effect with its interval."""
    p = "p < 1e-6" if p_after_holm < 1e-6 else f"p = {p_after_holm:.2g}"
    if not np.isfinite(size.g):
        return f"{p}, no spread"
    if not np.isfinite(size.low):
        return f"{p}, g = {size.g:.2f}"
    return f"{p}, g = {size.g:.2f} [{size.low:.2f}, {size.high:.2f}]"


def _test(difference: float, error: float, dof: float) -> MeanTest:
    if error == 0.0:  # no spread: equal for certain, or different for certain
        same = difference == 0.0
        return MeanTest(0.0 if same else float(np.copysign(np.inf, difference)), dof, float(same))
    t = float(difference / error)
    return MeanTest(t, float(dof), float(2 * stats.t.sf(abs(t), dof)))


def _pooled_sd(a: Summary, b: Summary) -> float:
    squares = (a.n - 1) * a.sd**2 + (b.n - 1) * b.sd**2
    return float(np.sqrt(squares / (a.n + b.n - 2)))


def _hedges_g_of_rows(a: Array, b: Array) -> Array:
    """Hedges' g for each row of resamples, (r, n_a) and (r, n_b)."""
    n_a, n_b = a.shape[1], b.shape[1]
    squares = (n_a - 1) * a.var(axis=1, ddof=1) + (n_b - 1) * b.var(axis=1, ddof=1)
    spread = np.sqrt(squares / (n_a + n_b - 2))
    difference = a.mean(axis=1) - b.mean(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        g: Array = difference / spread * (1 - 3 / (4 * (n_a + n_b - 2) - 1))
    return g


def _acceleration(a: Array, b: Array) -> float:
    """A sixth of the skewness of g's dependence on each trial, of two samples."""
    cubes = squares = 0.0
    for left_out_of_a, sample in ((True, a), (False, b)):
        left_out = [np.delete(sample, i) for i in range(len(sample))]
        without = np.array([
            hedges_g(*map(Summary.of, (rest, b) if left_out_of_a else (a, rest)))
            for rest in left_out
        ])
        influence = (len(sample) - 1) * (without.mean() - without)
        cubes += np.sum(influence**3) / len(sample) ** 3
        squares += np.sum(influence**2) / len(sample) ** 2
    return float(cubes / (6 * squares**1.5)) if np.isfinite(cubes) and squares > 0.0 else 0.0
