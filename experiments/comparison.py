# SPDX-License-Identifier: BSD-3-Clause
"""Compares modes with a free hand: means, tests, effects, box plots, and the published number beside each.

A trial counts once. Li et al. (2020) test samples 1 mm apart as if they were independent, which they are not. Their
test, on the samples, stands beside ours. Significant means p below 0.05 by Welch's test on trials, after Holm over
all comparisons of an experiment.
"""
from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace

import numpy as np

from . import figures, hypothesis_tests, modes
from .experiment import Array, Claim, Figure, Findings, Row, Table
from .hypothesis_tests import Effect, Summary
from .published import Comparison
from .teleoperation import CORRIDOR, TREMOR

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
    published: Comparison | None = None
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
        return np.array([row[self.member] for row in rows if row[self.member] is not None], dtype=np.float64)

    def paper_values(self, rows: list[Row]) -> Array:
        """Returns the values that Li et al. test: the absolute samples if there are any, else the trials."""
        if self.samples is None:
            return self.values(rows)
        told = [sample for row in rows for sample in row[self.samples] if sample is not None]
        return np.abs(np.array(told, dtype=np.float64))

    def text(self, values: Array) -> str:
        if len(values) == 0:
            return "-"
        spread = f" ± {values.std(ddof=1):.2f}" if len(values) > 1 else ""
        return f"{values.mean():.2f}{spread}"


@dataclass(frozen=True)
class Against:
    """The comparison of a mode with no fixture."""

    measure: Measure
    mode: str
    student: float  # p of the test of Li et al., on the values that they test
    welch: float  # p on trials
    effect: Effect
    holm: float = 1.0  # welch, after Holm over the experiment


def main_rows(rows: list[Row]) -> list[Row]:
    """Returns the trials with the usual tremor and corridor, and with errors of the set-up."""
    return [row for row in rows if row["tremor"] == TREMOR and not row["ideal"] and row["corridor"] == CORRIDOR]


def compare(
    experiment: str, rows: list[Row], measures: tuple[Measure, ...], seed: int, swept: tuple[str, ...]
) -> Findings:
    """Compares all modes with no fixture by all measures; adds a table of the sweeps with the members `swept`.

    Each row is a trial with `mode`, `tremor`, `corridor` [mm] and `ideal`.
    """
    main = main_rows(rows)
    by_mode = {mode: of for mode in modes.MODES if (of := [row for row in main if row["mode"] == mode])}
    against = _tests(by_mode, measures, seed)
    return Findings(
        headline=_headline(by_mode, against),
        claims=[_claim(m, by_mode, against) for m in measures if m.published],
        tables=[_means(by_mode, measures), _safety(by_mode), _tests_table(by_mode, against),
                _sweep_table(rows, swept)],
        figures=[_boxes(experiment, m, by_mode) for m in measures],
    )


def _tests(by_mode: ByMode, measures: tuple[Measure, ...], seed: int) -> list[Against]:
    found = []
    for measure in measures:
        free = by_mode[modes.NO_FIXTURE]
        for mode, held in by_mode.items():
            trials = measure.values(free), measure.values(held)
            if mode == modes.NO_FIXTURE or not measure.tested or min(map(len, trials)) < 2:
                continue
            student = hypothesis_tests.student(*(Summary.of(measure.paper_values(rows)) for rows in (free, held)))
            welch = hypothesis_tests.welch(*map(Summary.of, trials))
            effect = hypothesis_tests.effect(*trials, seed)
            found.append(Against(measure, mode, student.p, welch.p, effect))
    after = hypothesis_tests.holm([a.welch for a in found])
    return [replace(a, holm=p) for a, p in zip(found, after, strict=True)]


def _claim(measure: Measure, by_mode: ByMode, against: list[Against]) -> Claim:
    paper = measure.published
    assert paper is not None
    tests = {a.mode: a for a in against if a.measure is measure}
    unit = measure.of_unit

    def pair(mode: str) -> str:
        """Returns free hand and mode as Li et al. print them, of the values that they test."""
        free, held = (measure.text(measure.paper_values(by_mode[m])) for m in (modes.NO_FIXTURE, mode))
        tested = f", pooled p = {tests[mode].student:.2g}" if mode in tests else ""
        return f"{free} → {held}{unit}{tested}"

    means = {mode: measure.paper_values(by_mode[mode]).mean() for mode in _sound(by_mode)}
    sign = 1.0 if measure.higher_is_better else -1.0
    best = max(means, key=lambda mode: sign * means[mode], default=None)
    certified = tests.get("certified")
    return Claim(
        about=f"{paper.about} ({paper.section}), free hand → fixture",
        paper=f"{paper.free.mean:g} ± {paper.free.sd:g} → {paper.fixture.mean:g} ± "
        f"{paper.fixture.sd:g}{unit}, pooled p = {paper.p:.2g}",
        reproduction=pair("paper"),
        certified=pair("certified"),
        best=f"{figures.label(best)}: {means[best]:.2f}{unit}, of the modes that finished with a setpoint never {SOUND:g} mm deep"
        if best
        else f"none finished with a setpoint never {SOUND:g} mm deep",
        sure="certified against no fixture, trials: "
        + (hypothesis_tests.in_words(certified.holm, certified.effect) if certified else "too few"),
        note=measure.why,
    )


def _sound(by_mode: ByMode) -> list[str]:
    """Returns the fixtures whose trials all reached the path's end, with a setpoint never SOUND deep."""
    return [mode for mode, rows in by_mode.items() if mode != modes.NO_FIXTURE
            and all(row["finished"] and row["deepest_registered_mm"] < SOUND for row in rows)]


def _means(by_mode: ByMode, measures: tuple[Measure, ...]) -> Table:
    return Table(
        "Means of trials, ± standard deviation",
        ["mode", "trials", *(m.heading for m in measures)],
        [[figures.label(mode), str(len(rows)), *(m.text(m.values(rows)) for m in measures)]
         for mode, rows in by_mode.items()],
    )


def _greatest(rows: list[Row], *members: str) -> list[str]:
    return [f"{max(row[member] for row in rows):.3f}" for member in members]


def _crossings(rows: list[Row]) -> str:
    return str(sum(row["crossings"] for row in rows))


def _safety(by_mode: ByMode) -> Table:
    return Table(
        "Penetration into the anatomy",
        ["mode", "setpoint passes through, registered frame", "deepest setpoint, registered frame [mm]",
         "deepest tip, true frame [mm]", "registration error [mm]", "tip deeper than that error [mm]",
         "tip short of the path's end"],
        [[figures.label(mode), _crossings(rows),
          *_greatest(rows, "deepest_registered_mm", "deepest_mm", "registration_error_mm", "beyond_registration_mm"),
          str(sum(not row["finished"] for row in rows))] for mode, rows in by_mode.items()],
        "The fixture guards its setpoint in the registered frame. The tip in the true frame also has the "
        "error of registration. All distances are the greatest of all trials.",
    )


def _tests_table(by_mode: ByMode, against: list[Against]) -> Table:
    return Table(
        "Each fixture against no fixture",
        ["measure", "mode", "no fixture", "fixture", "Student, as the paper", "Welch, trials",
         "after Holm", "Hedges' g"],
        [[a.measure.name, figures.label(a.mode),
          *(a.measure.text(a.measure.values(by_mode[mode])) for mode in (modes.NO_FIXTURE, a.mode)),
          *(f"{p:.2g}" for p in (a.student, a.welch, a.holm)),
          hypothesis_tests.in_words(a.holm, a.effect).split(", ", 1)[1]] for a in against],
        f"The Holm correction is over these {len(against)} comparisons. g is positive if the value is greater without a "
        "fixture.",
    )


def _boxes(experiment: str, measure: Measure, by_mode: ByMode) -> Figure:
    fig, ax = figures.new(160, 70)
    groups = {mode: measure.values(rows) for mode, rows in by_mode.items()}
    figures.box_plot(ax, {m: v for m, v in groups.items() if len(v)}, textwrap.fill(measure.heading, 26))
    return Figure(
        f"{experiment}_{measure.member}",
        measure.name[0].upper() + measure.name[1:],
        "Each point is a trial. The boxes show quartiles.",
        figures.svg(fig),
    )


def _headline(by_mode: ByMode, against: list[Against]) -> str:
    certified = by_mode["certified"]
    entered = sum(bool(r["crossings"] or r["deepest_registered_mm"] > 0.0) for r in certified)

    def told(one: Against) -> str:
        free, held = (one.measure.values(by_mode[m]).mean() for m in (modes.NO_FIXTURE, one.mode))
        return f"{one.measure.name}, {free:.2f} to {held:.2f} (p = {one.holm:.1g})"

    sure = [told(a) for a in against if a.mode == "certified" and a.holm < 0.05]
    return (
        f"certified: {len(certified)} trials, {entered} of which entered in the frame of the fixture. Significant "
        f"differences from no fixture, after Holm: {'; '.join(sure) or 'none'}."
    )


def _mean(values: list[float | None]) -> str:
    told = [value for value in values if value is not None]
    return f"{np.mean(told):.2f}" if told else "-"


def _sweep_table(rows: list[Row], members: tuple[str, ...]) -> Table:
    """Returns the means by tremor, corridor and errors of the set-up."""

    def kind(row: Row) -> tuple[int, bool, float, float]:
        return modes.MODES.index(row["mode"]), row["ideal"], row["corridor"], row["tremor"]

    lines = []
    for of in sorted({kind(row) for row in rows}):
        here = [row for row in rows if kind(row) == of]
        mode, ideal, corridor, tremor = of
        lines.append([
            figures.label(modes.MODES[mode]), f"{1000 * tremor:.0f}",
            "-" if modes.MODES[mode] == modes.NO_FIXTURE else f"{corridor:g}", "none" if ideal else "all",
            str(len(here)), _crossings(here), *_greatest(here, "deepest_registered_mm", "deepest_mm"),
            *(_mean([row[member] for row in here]) for member in members),
        ])
    return Table(
        "Tremor, corridor, and a set-up without errors",
        ["mode", "tremor [µm]", "corridor ± [mm]", "errors of the set-up", "trials",
         "setpoint passes through", "deepest setpoint [mm]", "deepest tip [mm]",
         *(member.removesuffix("_mm").removesuffix("_s").replace("_", " ") for member in members)],
        lines,
        "All values are means of trials, but depths are the greatest of all trials.",
    )
