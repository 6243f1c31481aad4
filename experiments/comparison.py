# SPDX-License-Identifier: BSD-3-Clause
"""Modes compared with a free hand: means, tests, effects, box plots, and the paper's number beside each.

A trial counts once. The paper tests samples 1 mm apart as if they were independent, which they are
not; its own test, on the samples, stands beside ours. Significant means below 0.05 after Holm over all
comparisons of an experiment, by Welch's test on trials.
"""
from __future__ import annotations

import textwrap
from dataclasses import dataclass

import numpy as np

from . import figures, hypothesis_tests, modes
from .experiment import Claim, Figure, Findings, Row, Table
from .hypothesis_tests import Effect, Summary
from .experiment import Array
from .published import Comparison


#: A rule whose setpoint is never so deep in its own frame may be called best [mm].
SOUND = 0.05


@dataclass(frozen=True)
class Measure:
    """A member of the rows that modes are compared by."""

    member: str
    name: str
    unit: str
    published: Comparison | None = None
    samples: str | None = None  # the member with the samples that the paper tests
    higher_is_better: bool = False
    tested: bool = True  # False: what is nothing without a fixture by construction
    why: str = ""  # where the reproduction disagrees with the paper: why

    def values(self, rows: list[Row], mode: str) -> Array:
        values = [row[self.member] for row in rows if row["mode"] == mode]
        return np.array([value for value in values if value is not None], dtype=np.float64)

    def paper_values(self, rows: list[Row], mode: str) -> Array:
        """What the paper tests: the samples where it has such, absolute; else the trials."""
        if self.samples is None:
            return self.values(rows, mode)
        samples = [row[self.samples] for row in rows if row["mode"] == mode]
        told = [sample for of_trial in samples for sample in of_trial if sample is not None]
        return np.abs(np.array(told, dtype=np.float64))

    def text(self, values: Array) -> str:
        if len(values) == 0:
            return "-"
        spread = f" ± {values.std(ddof=1):.2f}" if len(values) > 1 else ""
        return f"{values.mean():.2f}{spread}"


@dataclass(frozen=True)
class Against:
    """A mode against no fixture."""

    measure: Measure
    mode: str
    student: float  # p of the paper's test, on what the paper tests
    welch: float  # p on trials
    holm: float  # that, after Holm over the experiment
    effect: Effect


def compare(experiment: str, rows: list[Row], measures: tuple[Measure, ...], seed: int) -> Findings:
    """All modes with no fixture, by all measures. Rows: one a trial, with `mode`."""
    present = [mode for mode in modes.MODES if any(row["mode"] == mode for row in rows)]
    against = _tests(rows, measures, present, seed)
    return Findings(
        headline=_headline(rows, against),
        claims=[_claim(m, rows, present, against) for m in measures if m.published],
        tables=[_means(rows, measures, present), _safety(rows, present), _tests_table(rows, against)],
        figures=[_boxes(experiment, m, rows, present) for m in measures],
    )


def _tests(
    rows: list[Row], measures: tuple[Measure, ...], present: list[str], seed: int
) -> list[Against]:
    found = []
    for measure in measures:
        if not measure.tested:
            continue
        free = measure.values(rows, modes.NO_FIXTURE)
        for mode in present:
            values = measure.values(rows, mode)
            if mode == modes.NO_FIXTURE or min(len(free), len(values)) < 2:
                continue
            of_paper = [
                Summary.of(measure.paper_values(rows, which)) for which in (modes.NO_FIXTURE, mode)
            ]
            found.append(
                Against(
                    measure,
                    mode,
                    student=hypothesis_tests.student(*of_paper).p,
                    welch=hypothesis_tests.welch(Summary.of(free), Summary.of(values)).p,
                    holm=1.0,
                    effect=hypothesis_tests.effect(free, values, seed),
                )
            )
    after = hypothesis_tests.holm([a.welch for a in found])
    return [
        Against(a.measure, a.mode, a.student, a.welch, p, a.effect)
        for a, p in zip(found, after, strict=True)
    ]


def _claim(measure: Measure, rows: list[Row], present: list[str], against: list[Against]) -> Claim:
    paper = measure.published
    assert paper is not None
    unit = f" {measure.unit}" if measure.unit else ""

    def pair(mode: str) -> str:
        """Free hand and mode, as the paper prints them: of what it tests."""
        free, held = (measure.paper_values(rows, m) for m in (modes.NO_FIXTURE, mode))
        p = next((a.student for a in against if a.measure is measure and a.mode == mode), None)
        tested = "" if p is None else f", pooled p = {p:.2g}"
        return f"{measure.text(free)} → {measure.text(held)}{unit}{tested}"

    means = {mode: measure.paper_values(rows, mode).mean() for mode in _sound(rows, present)}
    means.pop(modes.NO_FIXTURE, None)
    sign = 1.0 if measure.higher_is_better else -1.0
    best = max(means, key=lambda mode: sign * means[mode], default=None)
    certified = next((a for a in against if a.measure is measure and a.mode == "certified"), None)
    return Claim(
        about=f"{paper.about} ({paper.section}), free hand → fixture",
        paper=f"{paper.free.mean:g} ± {paper.free.sd:g} → {paper.fixture.mean:g} ± "
        f"{paper.fixture.sd:g}{unit}, pooled p = {paper.p:.2g}",
        reproduction=pair("paper"),
        certified=pair("certified"),
        best=f"{figures.label(best)}: {means[best]:.2f}{unit}, of those that finished with a setpoint never {SOUND:g} mm deep"
        if best
        else f"none finished with a setpoint never {SOUND:g} mm deep",
        sure="certified against no fixture, trials: "
        + (hypothesis_tests.in_words(certified.holm, certified.effect) if certified else "too few"),
        note=measure.why,
    )


def _sound(rows: list[Row], present: list[str]) -> list[str]:
    """The modes whose trials all came to the path's end, with a setpoint that never was SOUND deep."""

    def is_sound(row: Row) -> bool:
        return bool(row["finished"]) and row["deepest_registered_mm"] < SOUND

    return [mode for mode in present if all(is_sound(row) for row in rows if row["mode"] == mode)]


def _means(rows: list[Row], measures: tuple[Measure, ...], present: list[str]) -> Table:
    return Table(
        "Means of trials, ± standard deviation",
        ["mode", "trials", *(m.name + (f" [{m.unit}]" if m.unit else "") for m in measures)],
        [
            [figures.label(mode), str(sum(row["mode"] == mode for row in rows))]
            + [m.text(m.values(rows, mode)) for m in measures]
            for mode in present
        ],
    )


def _safety(rows: list[Row], present: list[str]) -> Table:
    def greatest(mode: str, member: str) -> str:
        return f"{max(row[member] for row in rows if row['mode'] == mode):.3f}"

    def total(mode: str, member: str) -> int:
        return sum(row[member] for row in rows if row["mode"] == mode)

    return Table(
        "What came into the anatomy",
        ["mode", "setpoint passes through, registered frame", "deepest setpoint, registered frame [mm]",
         "deepest tip, true frame [mm]", "registration error [mm]", "tip deeper than that error [mm]",
         "tip short of the path's end"],
        [
            [
                figures.label(mode),
                str(total(mode, "crossings")),
                greatest(mode, "deepest_registered_mm"),
                greatest(mode, "deepest_mm"),
                greatest(mode, "registration_error_mm"),
                greatest(mode, "beyond_registration_mm"),
                str(sum(not row["finished"] for row in rows if row["mode"] == mode)),
            ]
            for mode in present
        ],
        "The fixture answers for its setpoint in the frame that it was told. What the tip does in the true "
        "frame is the registration's too: greatest values of all trials.",
    )


def _tests_table(rows: list[Row], against: list[Against]) -> Table:
    return Table(
        "Each fixture against no fixture",
        ["measure", "mode", "no fixture", "fixture", "Student, as the paper", "Welch, trials",
         "after Holm", "Hedges' g"],
        [
            [
                a.measure.name,
                figures.label(a.mode),
                a.measure.text(a.measure.values(rows, modes.NO_FIXTURE)),
                a.measure.text(a.measure.values(rows, a.mode)),
                f"{a.student:.2g}",
                f"{a.welch:.2g}",
                f"{a.holm:.2g}",
                hypothesis_tests.in_words(a.holm, a.effect).split(", ", 1)[1],
            ]
            for a in against
        ],
        f"Holm over these {len(against)} comparisons. g is positive where no fixture has more.",
    )


def _boxes(experiment: str, measure: Measure, rows: list[Row], present: list[str]) -> Figure:
    groups = {mode: measure.values(rows, mode) for mode in present}
    fig, ax = figures.new(160, 70)
    unit = f" [{measure.unit}]" if measure.unit else ""
    label = textwrap.fill(measure.name + unit, 26)
    figures.box_plot(ax, {m: v for m, v in groups.items() if len(v)}, label)
    return Figure(
        f"{experiment}_{measure.member}",
        measure.name[0].upper() + measure.name[1:],
        "A point is a trial; boxes are quartiles.",
        figures.svg(fig),
    )


def _headline(rows: list[Row], against: list[Against]) -> str:
    certified = [row for row in rows if row["mode"] == "certified"]
    entered = sum(bool(r["crossings"] or r["deepest_registered_mm"] > 0.0) for r in certified)
    sure = [a for a in against if a.mode == "certified" and a.holm < 0.05]

    def told(one: Against) -> str:
        free, held = (one.measure.values(rows, m).mean() for m in (modes.NO_FIXTURE, one.mode))
        return f"{one.measure.name}, {free:.2f} to {held:.2f} (p = {one.holm:.1g})"

    return (
        f"certified: {len(certified)} trials, {entered} of which entered in the frame of the fixture. Beside "
        f"no fixture, what differs after Holm: {'; '.join(map(told, sure)) or 'nothing for certain'}."
    )


def _mean(values: list[float | None]) -> str:
    told = [value for value in values if value is not None]
    return f"{np.mean(told):.2f}" if told else "-"


def sweep_table(rows: list[Row], members: tuple[str, ...]) -> Table:
    """By tremor, corridor and errors of the set-up; rows have `tremor`, `corridor` [mm] and `ideal`."""

    def kind(row: Row) -> tuple[int, bool, float, float]:
        return modes.MODES.index(row["mode"]), row["ideal"], row["corridor"], row["tremor"]

    lines = []
    for of in sorted({kind(row) for row in rows}):
        here = [row for row in rows if kind(row) == of]
        mode, ideal, corridor, tremor = of
        lines.append(
            [figures.label(modes.MODES[mode]), f"{1000 * tremor:.0f}"]
            + ["-" if modes.MODES[mode] == modes.NO_FIXTURE else f"{corridor:g}"]
            + ["none" if ideal else "all", str(len(here)), str(sum(r["crossings"] for r in here))]
            + [f"{max(r['deepest_registered_mm'] for r in here):.3f}"]
            + [f"{max(r['deepest_mm'] for r in here):.3f}"]
            + [_mean([row[member] for row in here]) for member in members]
        )
    return Table(
        "Tremor, corridor, and a set-up without errors",
        ["mode", "tremor [µm]", "corridor ± [mm]", "errors of the set-up", "trials",
         "setpoint passes through", "deepest setpoint [mm]", "deepest tip [mm]",
         *(member.removesuffix("_mm").removesuffix("_s").replace("_", " ") for member in members)],
        lines,
        "Means of trials; depths are the greatest.",
    )
