# SPDX-License-Identifier: BSD-3-Clause
"""E8: how each value of the simulation changes the primary ends of E3 and E4, and SPARC.

Each number of operator, set-up and bone is changed alone, to the two ends of its range. Three ranges are from
literature: FROM_LITERATURE. All others are ours: the three of OURS, or half and twice the value. The trials are those of E3 and E4, with
no fixture and with certified; pairs have the same seed. An end that changes its sign with a value that no source fixes
is not a finding about fixtures.
"""
from __future__ import annotations

import textwrap
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from . import e3_path_tracing, e4_cutting, figures, hypothesis_tests, modes, parameters, teleoperation
from .comparison import Measure
from .experiment import Array, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import Interval
from .teleoperation import Simulation

NAME = "e8_sensitivity"
TITLE = "E8 Sensitivity to the values of the simulation"

COMPARED = (modes.NO_FIXTURE, "certified")
EXPERIMENTS = {module.NAME: module for module in (e3_path_tracing, e4_cutting)}
BASE = "as they are"

#: The ranges whose ends are published. Refractory time: 0.17 s (Miall, Weir, Stein, 1993) and 0.55 s (van de
#: Kamp et al., 2013, order 2). Noise: 6 % (finger force with sight and touch) and 15 % (matching of forces; both Jones,
#: 2000). Tremor: 0.049 mm (Riviere, Rader, Khosla, 1997) and 0.285 mm (all error of two surgeons in vivo, PubMed Central
#: PMC3989364).
FROM_LITERATURE = {
    "Intermittent.refractory": (0.17, 0.55), "Intermittent.noise": (0.06, 0.15), "Operator.tremor": (0.049, 0.285),
}
#: Ranges that we chose for the operator.
OURS = {
    "Intermittent.movement": (0.3, 0.8), "Intermittent.sight_in_depth": (0.25, 1.0), "Intermittent.tolerance": (0.25, 1.0),
}
RANGES = FROM_LITERATURE | OURS
#: Numbers of the task, not of the simulation.
FIXED = ("BoneProperties.thickness", "BoneProperties.blade")


def units(scale: Scale) -> list[Unit]:
    """Quick: E3, three pairs of trials for each value of RANGES and one for all others. Full: E3 with 20 pairs and
    three, and E4 with three."""
    planned = []
    for experiment in EXPERIMENTS if scale.full else [e3_path_tracing.NAME]:
        for parameter, ends in [(BASE, (1.0,)), *ranges(experiment).items()]:
            many = experiment == e3_path_tracing.NAME and parameter in (BASE, *RANGES)
            pairs = (20 if many else 3) if scale.full else (3 if many else 1)
            planned += [(experiment, parameter, value, mode, number)
                        for value in ends for mode in COMPARED for number in range(pairs)]
    return [_unit(*one, scale.seed) for one in planned]


def ranges(experiment: str) -> dict[str, tuple[float, ...]]:
    """Returns both ends of the range of each number that an experiment depends on, by name."""
    return {name: RANGES.get(name, (0.5 * value, 2.0 * value)) for name, value in parameters.numbers(Simulation()).items()
            if name not in FIXED and not (experiment == e3_path_tracing.NAME and name.startswith("BoneProperties."))}


def _unit(experiment: str, parameter: str, value: float, mode: str, number: int, seed: int) -> Unit:
    changed = {} if parameter == BASE else {parameter: value}
    trial = teleoperation.unit(mode, number, seed, changed=changed)
    return Unit(f"{experiment}-{trial.name}", trial.settings | {
        "experiment": experiment, "parameter": parameter, "value": value})


def run(unit: Unit) -> list[Row]:
    """Runs one trial of E3 or E4 with a changed value, and returns its ends."""
    of = unit.settings
    module = EXPERIMENTS[of["experiment"]]
    row = module.trial(of["mode"], of["seed"], of["number"], judged=False, changed=of["changed"])
    about = {name: of[name] for name in ("experiment", "parameter", "value", "mode", "number")}
    return [about | {"finished": row["finished"]} | {end.member: row[end.member] for end in _ends(module)}]


def _ends(module: ModuleType) -> list[Measure]:
    """Returns the primary ends, and the measures of smoothness that hardly depend on the duration."""
    return [measure for measure in module.MEASURES if measure.published or measure.member in ("sparc", "irregularity")]


@dataclass(frozen=True)
class Bar:
    """The difference certified minus no fixture of an end, at both ends of the range of a value."""

    parameter: str
    ends: tuple[float, float]
    low: Interval
    high: Interval
    pairs: int  # the fewest with two values

    @property
    def swing(self) -> float:
        """The distance between both ends of the bar; 0 if one is unknown."""
        swing = abs(self.high.value - self.low.value)
        return swing if np.isfinite(swing) else 0.0


def bars(rows: list[Row], measure: Measure) -> tuple[Interval, list[Bar]]:
    """Returns the difference with all values as they are, and a bar for each value, the longest first."""

    def difference(parameter: str, value: float) -> Array:
        of = {mode: {row["number"]: row[measure.member] for row in rows
                     if row["mode"] == mode and (row["parameter"], row["value"]) == (parameter, value)}
              for mode in COMPARED}
        free, held = (of[mode] for mode in COMPARED)
        return np.array([held[n] - free[n] for n in held if n in free and None not in (held[n], free[n])])

    found = []
    for parameter in dict.fromkeys(row["parameter"] for row in rows if row["parameter"] != BASE):
        low, high = sorted({row["value"] for row in rows if row["parameter"] == parameter})
        below, above = difference(parameter, low), difference(parameter, high)
        found.append(Bar(parameter, (low, high), hypothesis_tests.mean_difference(below),
                         hypothesis_tests.mean_difference(above), min(len(below), len(above))))
    return (hypothesis_tests.mean_difference(difference(BASE, 1.0)),
            sorted(found, key=lambda bar: (-bar.swing, bar.parameter)))


def findings(rows: list[Row], scale: Scale) -> Findings:
    of_ends = [(end, *bars(of, end)) for name, module in EXPERIMENTS.items()
               if (of := [row for row in rows if row["experiment"] == name]) for end in _ends(module)]
    told = ". ".join(f"{end.name[0].upper()}{end.name[1:]}: {_better(end, found)}"
                     + (f" ({_better(end, [bar for bar in found if bar.parameter in FROM_LITERATURE])} with a range from literature)"
                        if end.member == "spectral_arc_length" else "") for end, _, found in of_ends)
    changed = {row["parameter"] for row in rows} - {BASE}
    published = len(changed & set(FROM_LITERATURE))
    return Findings(
        "One value is changed at each point. The numbers count the points at which certified is better than no fixture. "
        f"{told}. {published} ranges are from literature and {len(changed) - published} are ours.",
        tables=[_table(*one) for one in of_ends],
        figures=[_tornado([one for one in of_ends if one[0].published])],
    )


def _better(end: Measure, found: list[Bar]) -> str:
    values = [side.value for bar in found for side in (bar.low, bar.high) if np.isfinite(side.value)]
    better = sum(value > 0.0 if end.higher_is_better else value < 0.0 for value in values)
    return f"{better} of {len(values)}"


def _table(measure: Measure, base: Interval, found: list[Bar]) -> Table:
    return Table(
        f"Certified minus no fixture, {measure.name}: one value changed",
        ["value", "low", "difference", "high", "difference", "swing", "pairs"],
        [[bar.parameter + (" *" if bar.parameter in FROM_LITERATURE else ""), f"{bar.ends[0]:g}", bar.low.text(),
          f"{bar.ends[1]:g}", bar.high.text(), f"{bar.swing:.2g}", str(bar.pairs)] for bar in found],
        f"With all values as they are: {base.text()}{measure.of_unit}. *: low and high are from literature; "
        "the other ranges are ours, most of them half and twice the value. Means of pairs of trials with Student's interval, if "
        "there are two pairs. Exploratory.",
    )


def _tornado(of_ends: list[tuple[Measure, Interval, list[Bar]]]) -> Figure:
    """Draws the longest bars of each end."""
    shown = 10
    fig, axes = figures.new(160, 62 * len(of_ends), rows=len(of_ends))
    color = figures.color("certified")
    for ax, (measure, base, found) in zip(np.atleast_1d(axes), of_ends):
        for place, bar in enumerate(reversed(found[:shown])):
            ax.plot([bar.low.value, bar.high.value], [place, place], color=color, linewidth=5.0, alpha=0.4)
            ax.plot(bar.low.value, place, "o", color=color)
            ax.plot(bar.high.value, place, "s", color=color)
        ax.axvline(base.value, color=figures.SOFT, linewidth=1.0, linestyle="--")
        ax.axvline(0.0, color=figures.INK, linewidth=1.0)
        ax.set_yticks(range(min(shown, len(found))), [bar.parameter for bar in reversed(found[:shown])])
        ax.set_xlabel(textwrap.fill(f"certified minus no fixture, {measure.heading}", 70))
    return Figure(
        f"{NAME}_tornado", "Sensitivity of each end",
        f"The {shown} values that change an end most. Circle: the low value; square: the high one. The dashed line has "
        "all values as they are; at 0 the fixture changes nothing.",
        figures.svg(fig))
