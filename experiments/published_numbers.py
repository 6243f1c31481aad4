# SPDX-License-Identifier: BSD-3-Clause
"""Every number of section V of Li et al. (2020) beside the simulation, and the primary tests of E3 and E4.

The primary ends are the four that Li et al. test: spectral arc length, cutting path deviation, absolute penetration
depth and duration. Each is tested for certified against no fixture and against the rule of Li et al., by signed ranks
of pairs of trials. Holm's correction is over these eight tests; a missing one counts as p = 1. All other tests of E3
and E4 are exploratory. `published_design` repeats the design of Li et al. with the simulated trials.
"""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from . import e3_path_tracing, e4_cutting, figures, hypothesis_tests, modes, published_design
from .comparison import Against, ByMode, Measure, against, best, main_rows, rows_by_mode
from .experiment import Array, Claim, Figure, Findings, Row, Scale, Table
from .hypothesis_tests import p_text
from .published import EXTREMES
from .published_design import DESIGNS, Predicted

NAME = "published_numbers"
TITLE = "The numbers of Li et al. (section V)"
FROM = (e3_path_tracing, e4_cutting)

REFERENCES = (modes.NO_FIXTURE, "paper")
#: The fixtures whose designs a number with a fixture is compared with.
FIXTURES = ("paper", "certified")


@dataclass(frozen=True)
class Primary:
    """A primary test, with its p after Holm over the eight."""

    test: Against
    holm: float

    @property
    def is_better(self) -> bool:
        """True if the mean difference favors the mode over the reference."""
        return (self.test.difference.value > 0.0) == self.test.measure.higher_is_better


@dataclass(frozen=True)
class Printed:
    """A printed number, and its place in the designs of each mode that it is compared with."""

    about: str
    unit: str
    number: float
    with_fixture: bool
    places: dict[str, Predicted]


def findings(rows: dict[str, list[Row]], scale: Scale) -> Findings:
    """Returns the primary tests and the place of each printed number, from the rows of E3 and E4 by name."""
    ends = [(measure, rows_by_mode(main_rows(rows.get(e.NAME, [])))) for e in FROM for measure in e.MEASURES
            if measure.published and rows.get(e.NAME)]
    primary = _primary_tests(ends, scale.seed)
    printed = [one for measure, by_mode in ends for one in _of_end(measure, by_mode, scale.seed)]
    if e4_cutting.NAME in rows:
        printed += _extremes(rows_by_mode(main_rows(rows[e4_cutting.NAME])), scale.seed)
    claims = [_claim(measure, by_mode, primary, printed, scale.seed) for measure, by_mode in ends]
    claims += [_claim_of_extreme(about, printed) for about in dict.fromkeys(
        one.about for one in printed if one.about in {extreme.about for extreme in EXTREMES})]
    return Findings(
        _headline(primary), claims,
        [_tests_table(primary), _false_alarm_table(ends, scale.seed), _printed_table(printed)],
        [_figure(printed)] if any(one.places for one in printed) else [])


def _primary_tests(ends: list[tuple[Measure, ByMode]], seed: int) -> list[Primary]:
    found = [test for measure, by_mode in ends for reference in REFERENCES
             if (test := against(measure, "certified", reference, by_mode, seed))]
    eight = len(REFERENCES) * sum(measure.published is not None for e in FROM for measure in e.MEASURES)
    adjusted = hypothesis_tests.holm([test.p for test in found] + [1.0] * (eight - len(found)))
    return [Primary(test, p) for test, p in zip(found, adjusted)]


def _of_end(measure: Measure, by_mode: ByMode, seed: int) -> Iterator[Printed]:
    """Yields mean, standard deviation and the difference of the means, as printed, with their places."""
    paper = measure.published
    assert paper is not None
    pooled = {mode: published_design.pooled(of, published_design.draw(len(of), paper.trials, DESIGNS, (seed, side)))
              for side, mode in enumerate((modes.NO_FIXTURE, *FIXTURES))
              if len(of := published_design.samples(measure, by_mode.get(mode, []))) > paper.trials}

    def places(of_mode: dict[str, Array], number: float) -> dict[str, Predicted]:
        return {mode: published_design.predicted(number, values) for mode, values in of_mode.items()}

    for side, compared in ((paper.free, (modes.NO_FIXTURE,)), (paper.fixture, FIXTURES)):
        here = {mode: pooled[mode] for mode in compared if mode in pooled}
        fixed = side is paper.fixture
        yield Printed(f"{paper.about}, mean", paper.unit, side.mean, fixed,
                      places({mode: p.mean for mode, p in here.items()}, side.mean))
        yield Printed(f"{paper.about}, standard deviation", paper.unit, side.sd, fixed,
                      places({mode: p.sd for mode, p in here.items()}, side.sd))
    free = pooled.get(modes.NO_FIXTURE)
    gains = {mode: pooled[mode].mean - free.mean for mode in FIXTURES if free and mode in pooled}
    gain = round(paper.fixture.mean - paper.free.mean, 6)
    yield Printed(f"{paper.about}, fixture minus free hand", paper.unit, gain, True, places(gains, gain))


def _extremes(by_mode: ByMode, seed: int) -> Iterator[Printed]:
    """Yields the largest samples of two trials, as printed, with their places."""
    for extreme in EXTREMES:
        for number, compared in ((extreme.free, (modes.NO_FIXTURE,)), (extreme.fixture, FIXTURES)):
            places = {}
            for mode in compared:
                largest = [max(extreme.sign * sample for sample in row[extreme.member] if sample is not None)
                           for row in by_mode.get(mode, []) if any(s is not None for s in row[extreme.member])]
                if len(largest) > 2:
                    designs = published_design.draw(len(largest), 2, DESIGNS, (seed,))
                    places[mode] = published_design.predicted(number, np.array(largest)[designs].max(axis=1))
            yield Printed(extreme.about, "mm", number, compared == FIXTURES, places)


def _claim(measure: Measure, by_mode: ByMode, primary: list[Primary], printed: list[Printed], seed: int) -> Claim:
    paper = measure.published
    assert paper is not None
    unit = measure.of_unit
    gain = next(one for one in printed if one.about == f"{paper.about}, fixture minus free hand")

    def pair(mode: str) -> str:
        """Returns free hand and mode as Li et al. print them, of the values that they test."""
        told = []
        for side in (modes.NO_FIXTURE, mode):
            rows = by_mode.get(side, [])
            values = measure.paper_values(rows)
            used = len(published_design.samples(measure, rows))
            told.append(f"{values.mean():.2f} ± {values.std(ddof=1):.2f} (n = {used} of {len(rows)} trials)"
                        if len(values) > 1 else f"- (n = {used} of {len(rows)} trials)")
        place = gain.places.get(mode)
        where = f"; difference: {place.text(gain.number)} of designs" if place else ""
        return f"{told[0]} → {told[1]}{unit}{where}"

    tests = [f"Certified minus {figures.label(one.test.reference)}: {one.test.text()}, {p_text(one.holm)}"
             for one in primary if one.test.measure is measure]
    return Claim(
        about=f"{paper.about} ({paper.section}), free hand → fixture",
        paper=f"{paper.free.mean:g} ± {paper.free.sd:g} → {paper.fixture.mean:g} ± {paper.fixture.sd:g}{unit}, "
        f"n = {paper.trials} + {paper.trials} trials, pooled p = {paper.p:.2g}",
        reproduction=pair("paper"),
        certified=pair("certified"),
        best=best(measure, by_mode, seed),
        sure=". ".join(tests) or "too few pairs",
        note=measure.why,
    )


def _claim_of_extreme(about: str, printed: list[Printed]) -> Claim:
    free, fixture = (next(one for one in printed if one.about == about and one.with_fixture is fixed)
                     for fixed in (False, True))

    def pair(mode: str) -> str:
        sides = ((free, modes.NO_FIXTURE), (fixture, mode))
        return " → ".join(one.places[m].text(one.number) if m in one.places else "too few trials" for one, m in sides)

    return Claim(f"{about} (V-B), free hand → fixture", f"{free.number:g} → {fixture.number:g} mm, n = 2 + 2 trials",
                 pair("paper"), pair("certified"), "not compared: an extreme has no test", "not tested",
                 "median and central 95 % of simulated designs [mm]")


def _tests_table(primary: list[Primary]) -> Table:
    return Table(
        "The primary tests: certified, by pairs of trials",
        ["end", "against", "pairs", "pairs with two values", "certified minus the other [95 %]",
         "Hedges' g of pairs [95 %]", "p", "p after Holm"],
        [[one.test.measure.heading, figures.label(one.test.reference), str(one.test.pairs), str(one.test.valued),
          one.test.difference.text(), one.test.effect.text(), f"{one.test.p:.2g}", f"{one.holm:.2g}"]
         for one in primary],
        "p is of the signed-rank test over all pairs; an unfinished trial ranks as the worst. Holm's correction is over "
        "eight tests: four ends against no fixture and against the rule of Li et al. The intervals of differences are "
        "Student's. Those of g are exact for normal differences below "
        f"{hypothesis_tests.MANY_PAIRS} pairs, and BCa bootstraps from there on.",
    )


def _false_alarm_table(ends: list[tuple[Measure, ByMode]], seed: int) -> Table:
    lines = []
    for measure, by_mode in ends:
        paper = measure.published
        assert paper is not None
        of_trials = published_design.samples(measure, by_mode.get(modes.NO_FIXTURE, []))
        rate = published_design.false_alarms(of_trials, paper.trials, seed)
        lines.append([measure.heading, f"{paper.trials} + {paper.trials}", str(len(of_trials)),
                      rate.text(2) if np.isfinite(rate.value) else "too few trials"])
    return Table(
        "False alarms of the published test: the free hand against itself",
        ["end", "trials of a design", "trials drawn from", "share of designs with p below 0.05 [95 %]"],
        lines,
        "Both sides of a design are different trials of the same free hand, so 5 % are expected of a valid test. The "
        "test is the pooled Student test of Li et al., which takes the samples along a cut as independent. "
        f"{published_design.TESTED_DESIGNS:,} designs share the trials; the interval is the jackknife's over trials.",
    )


def _printed_table(printed: list[Printed]) -> Table:
    compared = (modes.NO_FIXTURE, *FIXTURES)
    return Table(
        f"Every printed number in {DESIGNS:,} designs of the simulation",
        ["number", "mode", "printed", *(figures.label(mode) for mode in compared)],
        [[one.about + (f" [{one.unit}]" if one.unit else ""), "fixture" if one.with_fixture else "free hand",
          f"{one.number:g}",
          *(one.places[mode].text(one.number) if mode in one.places else "-" for mode in compared)]
         for one in printed],
        "Each cell has the median and the central 95 % of the designs, and the percentage of designs below the printed "
        "number. A design has as many trials as that of Li et al. A place near 0 or 100 % rejects the simulation for "
        "that number. '-': another mode, or too few trials.",
    )


def _figure(printed: list[Printed]) -> Figure:
    """Draws the designs of each printed number, in units of their spread around the printed number."""
    shown = [one for one in printed if one.places]
    fig, ax = figures.new(160, 14 + 7 * len(shown))
    for place, one in enumerate(reversed(shown)):
        for offset, (mode, of) in zip((0.15, -0.15), one.places.items()):
            spread = max(of.designs.high - of.designs.low, 1e-9) / 4.0
            low, middle, high = ((value - one.number) / spread
                                 for value in (of.designs.low, of.designs.value, of.designs.high))
            ax.plot([low, high], [place + offset] * 2, color=figures.color(mode), linewidth=3.0, alpha=0.6)
            ax.plot(middle, place + offset, "o", color=figures.color(mode), label=figures.label(mode))
    ax.axvline(0.0, color=figures.INK, linewidth=1.0)
    ax.set_yticks(range(len(shown)), [_short(one) for one in reversed(shown)])
    ax.set_xscale("symlog", linthresh=4.0)
    ax.set_xticks([-100, -10, 0, 10, 100], ["-100", "-10", "0", "10", "100"])
    ax.set_xlabel("simulated minus printed,\nin quarters of the 95 % of designs")
    known = dict(zip(*reversed(ax.get_legend_handles_labels())))
    ax.legend(known.values(), known.keys(), loc="lower center", bbox_to_anchor=(0.0, 1.0), ncol=3)
    return Figure(
        "published_numbers", "The printed numbers among simulated designs",
        "Each line spans the central 95 % of the simulated designs, with a dot at their median. The printed number is "
        "at 0. A line that does not reach 0 contradicts the printed number.",
        figures.svg(fig))


def _short(one: Printed) -> str:
    about = one.about.replace("standard deviation", "sd").replace("fixture minus free hand", "difference")
    return about if about.endswith("difference") else f"{about}, {'fixture' if one.with_fixture else 'free'}"


def _headline(primary: list[Primary]) -> str:
    """Returns by which ends certified differs from each reference, after Holm."""
    sentences = []
    for reference in REFERENCES:
        of = [one for one in primary if one.test.reference == reference]
        found = {
            "better by": [one for one in of if one.holm < 0.05 and one.is_better],
            "worse by": [one for one in of if one.holm < 0.05 and not one.is_better],
            "no difference shown by": [one for one in of if one.holm >= 0.05],
        }
        parts = [f"{words} {', '.join(one.test.measure.name.split(',')[0] for one in some)}"
                 for words, some in found.items() if some]
        sentences.append(f"Certified against {figures.label(reference)}: {'; '.join(parts) or 'not tested'}.")
    return f"{' '.join(sentences)} (Eight primary tests, after Holm; {len(primary)} could be made.)"
