# SPDX-License-Identifier: BSD-3-Clause
"""E8: how each value of the simulation changes the four primary ends of E3 and E4.

Each number of operator, set-up and bone is halved and doubled, alone. The trials are those of E3 and E4, with no
fixture and with certified; pairs have the same seed. An end that changes its sign with a value that no source fixes is
not a finding about fixtures.
"""
from __future__ import annotations

import textwrap
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from . import e3_path_tracing, e4_cutting, figures, hypothesis_tests, modes, parameters, teleoperation
from .bone import BoneProperties
from .comparison import Measure
from .experiment import Array, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import Interval
from .operator_model import Operator
from .set_up_errors import SetUp

NAME = "e8_sensitivity"
TITLE = "E8 Sensitivity to the values of the simulation"

FACTORS = (0.5, 2.0)
COMPARED = (modes.NO_FIXTURE, "certified")
#: Numbers of the task, not of the simulation.
FIXED = ("BoneProperties.thickness", "BoneProperties.blade")
#: The experiments, and the dataclasses with their numbers.
OF: dict[str, tuple[ModuleType, tuple[object, ...]]] = {
    e3_path_tracing.NAME: (e3_path_tracing, (Operator(), SetUp())),
    e4_cutting.NAME: (e4_cutting, (Operator(), SetUp(), BoneProperties())),
}
BASE = ("as they are", 1.0)


def units(scale: Scale) -> list[Unit]:
    """Quick: E3, one pair of trials for each value. Full: E3 and E4, three pairs."""
    return [
        _unit(name, mode, number, parameter, factor, scale.seed)
        for name, (_, objects) in OF.items() if scale.full or name == e3_path_tracing.NAME
        for parameter, factor in [BASE, *((p, f) for p in _parameters(objects) for f in FACTORS)]
        for mode in COMPARED for number in range(3 if scale.full else 1)
    ]


def _parameters(objects: tuple[object, ...]) -> list[str]:
    return [name for of in objects for name in parameters.names(of) if name not in FIXED]


def _unit(experiment: str, mode: str, number: int, parameter: str, factor: float, seed: int) -> Unit:
    trial = teleoperation.unit(mode, number, seed)
    changed = {"experiment": experiment, "parameter": parameter, "factors": {parameter: factor}}
    name = f"{experiment}-{parameter.replace(' ', '_')}-x{factor:g}-{mode}-{number}"
    return Unit(name, trial.settings | changed)


def run(unit: Unit) -> list[Row]:
    """Runs one trial of E3 or E4 with a changed value, and returns its primary ends."""
    of = unit.settings
    module, _ = OF[of["experiment"]]
    row = _trial(module, unit)
    about = {name: of[name] for name in ("experiment", "parameter", "mode", "number")}
    return [about | {"factor": of["factors"][of["parameter"]], "finished": row["finished"]}
            | {end.member: row[end.member] for end in _ends(module)}]


def _trial(module: ModuleType, unit: Unit) -> Row:
    """Returns the row of a trial of E3 or E4 with the changed values of the unit."""
    of = unit.settings
    objects: dict[str, Any] = {
        name: parameters.scaled(value, of["factors"])
        for name, value in zip(("operator", "setup", "bone"), OF[module.NAME][1])}
    row: Row = module.trial(
        of["mode"], of["seed"], of["number"], judged=False, tremor=objects["operator"].tremor, **objects)
    return row


def _ends(module: ModuleType) -> list[Measure]:
    return [measure for measure in module.MEASURES if measure.published]


@dataclass(frozen=True)
class Bar:
    """The difference certified minus no fixture of an end, with a value halved, as it is, and doubled."""

    parameter: str
    half: Interval
    double: Interval
    pairs: int  # the fewest with two values

    @property
    def swing(self) -> float:
        """The distance between both ends of the bar; 0 if one is unknown."""
        swing = abs(self.double.value - self.half.value)
        return swing if np.isfinite(swing) else 0.0


def bars(rows: list[Row], measure: Measure) -> tuple[Interval, list[Bar]]:
    """Returns the difference with all values as they are, and a bar for each value, the longest first."""

    def difference(parameter: str, factor: float) -> Array:
        of = {mode: {row["number"]: row[measure.member] for row in rows
                     if row["mode"] == mode and (row["parameter"], row["factor"]) == (parameter, factor)}
              for mode in COMPARED}
        free, held = (of[mode] for mode in COMPARED)
        return np.array([held[n] - free[n] for n in held if n in free and None not in (held[n], free[n])])

    found = []
    for parameter in dict.fromkeys(row["parameter"] for row in rows if row["parameter"] != BASE[0]):
        sides = [difference(parameter, factor) for factor in FACTORS]
        half, double = map(hypothesis_tests.mean_difference, sides)
        found.append(Bar(parameter, half, double, min(map(len, sides))))
    return (hypothesis_tests.mean_difference(difference(*BASE)),
            sorted(found, key=lambda bar: (-bar.swing, bar.parameter)))


def findings(rows: list[Row], scale: Scale) -> Findings:
    of_ends = [(end, *bars(of, end)) for name, (module, _) in OF.items()
               if (of := [row for row in rows if row["experiment"] == name]) for end in _ends(module)]
    told = []
    for end, _, found in of_ends:
        values = [side.value for bar in found for side in (bar.half, bar.double) if np.isfinite(side.value)]
        better = sum(value > 0.0 if end.higher_is_better else value < 0.0 for value in values)
        told.append(f"{end.name}, {better} of {len(values)}")
    return Findings(
        f"Points at which certified is better than no fixture, with one value halved or doubled: {'; '.join(told)}.",
        tables=[_table(*one) for one in of_ends],
        figures=[_tornado(of_ends)],
    )


def _table(measure: Measure, base: Interval, found: list[Bar]) -> Table:
    return Table(
        f"Certified minus no fixture, {measure.name}: one value changed",
        ["value", "halved", "doubled", "swing", "pairs"],
        [[bar.parameter, bar.half.text(), bar.double.text(), f"{bar.swing:.2g}", str(bar.pairs)] for bar in found],
        f"With all values as they are: {base.text()}{measure.of_unit}. Means of pairs of trials with Student's interval, "
        "if there are two pairs. Exploratory.",
    )


def _tornado(of_ends: list[tuple[Measure, Interval, list[Bar]]]) -> Figure:
    """Draws the longest bars of each end."""
    shown = 10
    fig, axes = figures.new(160, 62 * len(of_ends), rows=len(of_ends))
    color = figures.color("certified")
    for ax, (measure, base, found) in zip(np.atleast_1d(axes), of_ends):
        for place, bar in enumerate(reversed(found[:shown])):
            ax.plot([bar.half.value, bar.double.value], [place, place], color=color, linewidth=5.0, alpha=0.4)
            ax.plot(bar.half.value, place, "o", color=color)
            ax.plot(bar.double.value, place, "s", color=color)
        ax.axvline(base.value, color=figures.SOFT, linewidth=1.0, linestyle="--")
        ax.axvline(0.0, color=figures.INK, linewidth=1.0)
        ax.set_yticks(range(min(shown, len(found))), [bar.parameter for bar in reversed(found[:shown])])
        ax.set_xlabel(textwrap.fill(f"certified minus no fixture, {measure.heading}", 70))
    return Figure(
        f"{NAME}_tornado", "Sensitivity of each end",
        f"The {shown} values that change an end most. Circle: the value is halved; square: doubled. The dashed line has "
        "all values as they are; at 0 the fixture changes nothing.",
        figures.svg(fig))
