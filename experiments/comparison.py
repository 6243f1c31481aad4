# SPDX-License-Identifier: BSD-3-Clause
"""Compares modes by measures of their trials: means, paired tests, effects and box plots.

A trial counts once, and trials of two modes with the same number are a pair. An unfinished trial has no value; tests
rank it as the worst. Each test here is exploratory: its p is not adjusted. `published_numbers` has the primary tests.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import figures, hypothesis_tests, modes
from .experiment import Array, Figure, Findings, Row, Table
from .hypothesis_tests import Interval, p_text
from .published import Comparison
from .teleoperation import CORRIDOR

#: A rule may be called best if its setpoint is never this deep in its own frame [mm].
SOUND = 0.05

#: The rows of each mode that has rows, in the order of modes.MODES.
ByMode = dict[str, list[Row]]


@dataclass(frozen=True)
class Measure:
    """A member of the rows by which modes are compared."""

    member: str
    name: str
    unit: str
    published: Comparison | None = None  # with it, the measure is a primary end
    samples: str | None = None  # the member with the samples that Li et al. test
    higher_is_better: bool = False
    tested: bool = True  # False: always 0 without a fixture
    why: str = ""  # why the reproduction disagrees with Li et al., if it does

    @property
    def of_unit(self) -> str:
        return f" {self.unit}" if self.unit else ""

    @property
    def heading(self) -> str:
        return self.name + (f" [{self.unit}]" if self.unit else "")

    def values(self, rows: list[Row]) -> Array:
        """Returns the values of the trials that have one."""
        return np.array([row[self.member] for row in rows if row[self.member] is not None], dtype=np.float64)

    def paper_values(self, rows: list[Row]) -> Array:
        """Returns the values that Li et al. test: the absolute samples if there are any, else the trials."""
        if self.samples is None:
            return self.values(rows)
        known = [sample for row in rows for sample in row[self.samples] if sample is not None]
        return np.abs(np.array(known, dtype=np.float64))

    def text(self, rows: list[Row]) -> str:
        """Returns mean ± standard deviation of the trials with a value, and their number; `-` without any."""
        values = self.values(rows)
        if len(values) == 0:
            return "-, n = 0"
        spread = f" ± {values.std(ddof=1):.2f}" if len(values) > 1 else ""
        return f"{values.mean():.2f}{spread}, n = {len(values)}"


@dataclass(frozen=True)
class Against:
    """The comparison of a mode with a reference, by pairs of trials; differences are mode minus reference."""

    measure: Measure
    mode: str
    reference: str
    pairs: int  # all of them; those with two values have the difference and the effect
    valued: int
    p: float  # of the signed-rank test over all pairs, a trial without a value as the worst
    difference: Interval
    effect: Interval

    def text(self) -> str:
        """Returns the difference with its interval, the effect with its interval, and their number of pairs."""
        return (f"{self.difference.text()}{self.measure.of_unit}, g = {self.effect.text()}, "
                f"n = {self.valued} of {self.pairs} pairs")


def main_rows(rows: list[Row]) -> list[Row]:
    """Returns the trials with the usual operator and corridor, and with errors of the set-up."""
    return [row for row in rows if not row["changed"] and not row["ideal"] and row["corridor"] == CORRIDOR]


def rows_by_mode(rows: list[Row]) -> ByMode:
    """Returns the rows of each mode that has rows, in the order of modes.MODES."""
    return {mode: of for mode in modes.MODES if (of := [row for row in rows if row["mode"] == mode])}


def against(measure: Measure, mode: str, reference: str, by_mode: ByMode, seed: int) -> Against | None:
    """Compares a mode with a reference by a measure; None for fewer than two pairs, or if one of them has no values.

    No fixture has no chatter, for example, and a mode of which no trial ends has no duration.
    """
    here, there = ({row["number"]: row[measure.member] for row in by_mode.get(m, [])} for m in (mode, reference))
    pairs = [(here[number], there[number]) for number in here if number in there]
    if len(pairs) < 2 or any(all(value is None for value in side) for side in zip(*pairs)):
        return None
    worst = -np.inf if measure.higher_is_better else np.inf
    ranked = [0.0 if a is b is None else (worst if a is None else a) - (worst if b is None else b) for a, b in pairs]
    known = np.array([a - b for a, b in pairs if a is not None and b is not None], dtype=np.float64)
    return Against(measure, mode, reference, len(pairs), len(known), hypothesis_tests.signed_rank_p(ranked),
                   hypothesis_tests.mean_difference(known), hypothesis_tests.effect(known, seed))


def best(measure: Measure, by_mode: ByMode, seed: int) -> str:
    """Returns which fixture is best by a measure, as text: only if it beats the next one.

    Candidates finished all trials, with a setpoint never SOUND deep. The p is multiplied by the number of the other
    candidates, because the best is chosen after the trials.
    """
    means = {mode: float(measure.values(rows).mean()) for mode, rows in by_mode.items()
             if mode != modes.NO_FIXTURE and all(r["finished"] and r["deepest_registered_mm"] < SOUND for r in rows)}
    order = sorted(means, key=means.__getitem__, reverse=measure.higher_is_better)
    if len(order) < 2:
        return "fewer than two modes finished all trials without depth"
    told = [f"{figures.label(mode)} {means[mode]:.2f}{measure.of_unit}" for mode in order[:2]]
    test = against(measure, order[0], order[1], by_mode, seed)
    if test is None:
        return f"too few pairs: {told[0]}, {told[1]}"
    p = min(1.0, test.p * (len(order) - 1))
    if p < 0.05:
        return f"{told[0]}; next {told[1]} ({p_text(p)}, n = {test.pairs})"
    return f"none beats the next: {told[0]}, {told[1]} ({p_text(p)}, n = {test.pairs})"


def compare(
    experiment: str, rows: list[Row], measures: tuple[Measure, ...], seed: int, swept: tuple[str, ...]
) -> Findings:
    """Compares all modes with no fixture by all measures; adds a table of the sweeps with the members `swept`.

    Each row is a trial with `mode`, `number`, `changed`, `corridor` [mm] and `ideal`.
    """
    by_mode = rows_by_mode(main_rows(rows))
    return Findings(
        headline=_headline(by_mode),
        tables=[_means(by_mode, measures), _safety(by_mode), _tests_table(by_mode, measures, seed),
                _sweep_table(rows, swept)],
        figures=[_boxes(experiment, m, by_mode) for m in measures],
    )


def _means(by_mode: ByMode, measures: tuple[Measure, ...]) -> Table:
    return Table(
        "Means of trials, ± standard deviation",
        ["mode", "trials", "unfinished", *(m.heading for m in measures)],
        [[figures.label(mode), str(len(rows)), _unfinished(rows), *(m.text(rows) for m in measures)]
         for mode, rows in by_mode.items()],
        "n is the number of trials with a value. A trial that does not reach the end of the path has no duration and "
        "no smoothness, so a mean with a smaller n is of the survivors only.",
    )


def _greatest(rows: list[Row], *members: str) -> list[str]:
    return [f"{max(row[member] for row in rows):.3f}" for member in members]


def _crossings(rows: list[Row]) -> str:
    return str(sum(row["crossings"] for row in rows))


def _unfinished(rows: list[Row]) -> str:
    return f"{sum(not row['finished'] for row in rows)} of {len(rows)}"


def _safety(by_mode: ByMode) -> Table:
    return Table(
        "Penetration into the anatomy",
        ["mode", "trials", "setpoint passes through, registered frame", "deepest setpoint, registered frame [mm]",
         "deepest tip, true frame [mm]", "registration error [mm]", "tip deeper than that error [mm]"],
        [[figures.label(mode), str(len(rows)), _crossings(rows),
          *_greatest(rows, "deepest_registered_mm", "deepest_mm", "registration_error_mm", "beyond_registration_mm")]
         for mode, rows in by_mode.items()],
        "The fixture guards its setpoint in the registered frame. The tip in the true frame also has the "
        "error of registration. All distances are the greatest of all trials.",
    )


def _tests_table(by_mode: ByMode, measures: tuple[Measure, ...], seed: int) -> Table:
    found = [test for measure in measures if measure.tested for mode in by_mode
             if mode != modes.NO_FIXTURE and not (measure.published and mode == "certified")
             if (test := against(measure, mode, modes.NO_FIXTURE, by_mode, seed))]
    return Table(
        "Each fixture against no fixture: exploratory",
        ["measure", "mode", "pairs", "pairs with two values", "difference [95 %]", "Hedges' g of pairs [95 %]", "p"],
        [[test.measure.heading, figures.label(test.mode), str(test.pairs), str(test.valued), test.difference.text(),
          test.effect.text(), f"{test.p:.2g}"] for test in found],
        "Differences are fixture minus no fixture. p is of the signed-rank test over all pairs, with unfinished "
        f"trials as the worst. It is not adjusted for the {len(found)} tests, so they confirm no difference. "
        "The primary tests are in the table of the numbers of Li et al.",
    )


def _boxes(experiment: str, measure: Measure, by_mode: ByMode) -> Figure:
    fig, ax = figures.new(160, 70)
    groups = {mode: measure.values(rows) for mode, rows in by_mode.items()}
    figures.box_plot(ax, {m: v for m, v in groups.items() if len(v)}, measure.heading)
    fewer = [f"{figures.label(m)} {len(v)} of {len(by_mode[m])}" for m, v in groups.items() if len(v) < len(by_mode[m])]
    return Figure(
        f"{experiment}_{measure.member}",
        measure.name[0].upper() + measure.name[1:],
        "Each point is a trial. The boxes show quartiles."
        + (f" Trials with a value: {', '.join(fewer)}; all of the other modes." if fewer else ""),
        figures.svg(fig),
    )


def _headline(by_mode: ByMode) -> str:
    certified = by_mode["certified"]
    entered = sum(bool(r["crossings"] or r["deepest_registered_mm"] > 0.0) for r in certified)
    return (f"certified: {len(certified)} trials. In {entered} of them the setpoint entered the anatomy in the frame of "
            f"the fixture; {_unfinished(certified)} did not reach the end of the path.")


def _mean(values: list[float | None]) -> str:
    known = [value for value in values if value is not None]
    return f"{np.mean(known):.2f}, n = {len(known)}" if known else "-, n = 0"


def _sweep_table(rows: list[Row], members: tuple[str, ...]) -> Table:
    """Returns the means by changed number, corridor and errors of the set-up."""

    def kind(row: Row) -> tuple[int, bool, float, str]:
        return modes.MODES.index(row["mode"]), row["ideal"], row["corridor"], row["changed"]

    lines = []
    for of in sorted({kind(row) for row in rows}):
        here = [row for row in rows if kind(row) == of]
        mode, ideal, corridor, changed = of
        lines.append([
            figures.label(modes.MODES[mode]), changed or "-",
            "-" if modes.MODES[mode] == modes.NO_FIXTURE else f"{corridor:g}", "none" if ideal else "all",
            str(len(here)), _crossings(here), *_greatest(here, "deepest_registered_mm", "deepest_mm"),
            *(_mean([row[member] for row in here]) for member in members),
        ])
    return Table(
        "Other numbers, other corridors, and a set-up without errors",
        ["mode", "changed", "corridor ± [mm]", "errors of the set-up", "trials",
         "setpoint passes through", "deepest setpoint [mm]", "deepest tip [mm]",
         *(member.removesuffix("_mm").removesuffix("_s").replace("_", " ") for member in members)],
        lines,
        "All values are means of trials, but depths are the greatest of all trials.",
    )
