# SPDX-License-Identifier: BSD-3-Clause
"""The design of Li et al. (2020), repeated with simulated trials: two and two skulls (V-B), five and five traces (V-A).

A design draws as many different trials of a mode as Li et al. made. Its statistics are theirs: means, standard
deviations and extremes of pooled samples, and the pooled Student test, which treats the samples as independent. Over
many designs, a printed number has a place in the predictive distribution of the simulation. The test has a rate of
false alarms: the share of p below 0.05 if both sides are the same free hand.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from .comparison import Measure
from .experiment import Array, Row
from .hypothesis_tests import CONFIDENCE, UNKNOWN, Interval, jackknife_error
from .published import Summary

#: Designs of a predictive distribution. They share trials, so the number of trials limits what they show.
DESIGNS = 1000
#: Designs of a rate of false alarms. More, because the jackknife uses the designs without each trial.
TESTED_DESIGNS = 20_000

Numbers = NDArray[np.intp]


@dataclass(frozen=True)
class Pooled:
    """The pooled samples of each design, (designs,): their number, mean and standard deviation of n - 1."""

    n: Array
    mean: Array
    sd: Array


def draw(trials: int, of_each: int, designs: int, seeds: tuple[int, ...]) -> Numbers:
    """Returns (designs, of_each) numbers of different trials. The same seeds draw the same designs.

    Raises ValueError if there are fewer trials than a design needs.
    """
    if trials < of_each:
        raise ValueError(f"a design needs {of_each} trials, but there are {trials}")
    order = np.random.default_rng(seeds).random((designs, trials)).argsort(axis=1)
    return order[:, :of_each]


def samples(measure: Measure, rows: list[Row]) -> list[Array]:
    """Returns the values that Li et al. test, for each trial that has one."""
    of_trials = [measure.paper_values([row]) for row in rows]
    return [values for values in of_trials if len(values)]


def pooled(of_trials: list[Array], numbers: Numbers) -> Pooled:
    """Returns the pooled samples of the trials of each design. `numbers`: (designs, trials of a design)."""
    of_each = np.array([[len(values), values.sum(), values @ values] for values in of_trials])  # (trials, 3)
    n, total, squares = of_each[numbers].sum(axis=1).T
    mean = total / n
    variance = np.maximum(squares - n * mean**2, 0.0) / np.maximum(n - 1.0, 1.0)
    return Pooled(n, mean, np.sqrt(variance))


def student_p(a: Pooled | Summary, b: Pooled | Summary) -> Array:
    """Returns the p of the pooled two-sided Student test of each design, (designs,); () for printed summaries."""
    with np.errstate(invalid="ignore", divide="ignore"):
        p: Array = stats.ttest_ind_from_stats(a.mean, a.sd, a.n, b.mean, b.sd, b.n).pvalue
    return np.where(np.isnan(p), 1.0, p)  # without spread and difference


def false_alarms(of_trials: list[Array], of_each: int, seed: int) -> Interval:
    """Returns the share of designs of equal hands whose pooled test has p below 0.05, with its 95 % interval.

    The interval is normal, with the standard error of the jackknife over trials: the designs share them. All is NaN
    if there are no two disjoint sides, and the interval if a trial is in every design.
    """
    n = len(of_trials)
    if n < 2 * of_each:
        return UNKNOWN
    numbers = draw(n, 2 * of_each, TESTED_DESIGNS, (seed,))
    alarms = student_p(pooled(of_trials, numbers[:, :of_each]), pooled(of_trials, numbers[:, of_each:])) < 0.05
    rate = float(alarms.mean())
    without = [alarms[~(numbers == trial).any(axis=1)] for trial in range(n)]
    if not all(map(len, without)):
        return Interval(rate, UNKNOWN.low, UNKNOWN.high)
    wide = float(stats.norm.ppf(0.5 + CONFIDENCE / 2)) * jackknife_error([one.mean() for one in without])
    return Interval(rate, max(0.0, rate - wide), min(1.0, rate + wide))


@dataclass(frozen=True)
class Predicted:
    """A printed number beside the designs of the simulation: their median and central 95 %, and the number's place."""

    designs: Interval
    percentile: float  # percent of the designs below the number, ties counted half

    def text(self, printed: float) -> str:
        """Returns median and 95 % of the designs, and where the printed number falls."""
        where = {0.0: "below all", 100.0: "above all"}.get(self.percentile, f"at {self.percentile:.1f} %")
        return f"{self.designs.text()}; {printed:g} is {where}"


def predicted(printed: float, of_designs: Array) -> Predicted:
    """Returns the place of a printed number in the statistic of all designs, (designs,)."""
    low, middle, high = np.quantile(of_designs, [0.025, 0.5, 0.975])
    below = np.mean(of_designs < printed) + 0.5 * np.mean(of_designs == printed)
    return Predicted(Interval(float(middle), float(low), float(high)), 100.0 * float(below))
