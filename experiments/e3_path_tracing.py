# SPDX-License-Identifier: BSD-3-Clause
"""E3: the operator traces the outside of a pre-cut skull along a planned path (section V-A).

The path is 30 mm on the outside of the CT skull, smoothed by 1 mm as a print is. The slot exists already, so only the
fixture stops the tip. Measures smoothness: spectral arc length up to 20 Hz as in Li et al. (2020), and SPARC. Also
measures the distance from the planned depth, and the distance across the path.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from . import anatomy, figures, modes, published, teleoperation
from .comparison import Measure, compare, main_rows
from .experiment import Figure, Findings, Row, Scale, Table, Unit
from .operator_model import Operator
from .set_up_errors import SetUp
from .teleoperation import CORRIDOR, SENSITIVITY, SWEEP, SWEPT, TREMOR, Planned, Trial, vary
from .trial import Course, Trace

NAME = "e3_path_tracing"
TITLE = "E3 Path tracing (section V-A)"

VARIED = (modes.NO_FIXTURE, "certified")  # the modes of the table of sensitivity
SPEED = 2.0  # [mm/s], ours: Li et al. do not give it


def units(scale: Scale) -> list[Unit]:
    """Returns five trials for each mode, as in Li et al.; full: 40. Adds a sweep of tremor, trials without errors of
    the set-up, and trials with other values of the operator."""
    of_all: list[Planned] = [(mode, n, {}) for mode in modes.MODES for n in range(40 if scale.full else 5)]
    swept = [(mode, n, {"tremor": t}) for mode in SWEPT for t in SWEEP for n in range(10 if scale.full else 1)]
    ideal = [(mode, n, {"ideal": True}) for mode in modes.MODES for n in range(2 if scale.full else 1)]
    varied: list[Planned] = [(mode, n, {"varied": {name: value}}) for name, ends in SENSITIVITY.items()
                             for value in ends for mode in VARIED for n in range(20 if scale.full else 3)]
    return [teleoperation.unit(mode, n, scale.seed, **of) for mode, n, of in of_all + swept + ideal + varied]


def planned(mode: str, seed: int, number: int = 0, *, tremor: float = TREMOR, ideal: bool = False,
            corridor: float = CORRIDOR, varied: dict[str, float] | None = None, operator: Operator = Operator(),
            setup: SetUp = SetUp()) -> Trial:
    """Returns the trial of a mode. Modes with the same seed and number meet the same operator and registration."""
    path, index = anatomy.printed_skull()
    course = Course(path=path, depth=0.0, speed=SPEED, time_limit=240.0)
    return Trial(mode, (seed, 3, number), course, index, vary(replace(operator, tremor=tremor), varied),
                 SetUp.ideal() if ideal else setup, corridor)


def trial(mode: str, seed: int, number: int = 0, *, judged: bool = True, **settings: Any) -> Row:
    """Returns the row of one trial. `settings`: see planned(). With `judged` the row has the measures of the judge."""
    made = planned(mode, seed, number, **settings)
    trace = made.run()
    return made.measures(trace, judged=judged) | _distances(trace, made.course)


def run(unit: Unit) -> list[Row]:
    """Runs one trial."""
    told = unit.settings
    made = planned(**told)
    trace = made.run()
    along, _, depth = made.course.path.depths(trace.tip[trace.begun :])
    drawn = told["mode"] in SWEPT and not told["ideal"] and told["number"] < 5
    about = {name: value for name, value in told.items() if name != "seed"}
    return [
        about | made.measures(trace) | _distances(trace, made.course)
        | {
            "along_mm": np.round(along[::25], 2).tolist() if drawn else None,
            "height_mm": np.round(-depth[::25], 4).tolist() if drawn else None,
        }
    ]


def _distances(trace: Trace, course: Course) -> Row:
    _, across, depth = course.path.depths(trace.tip[trace.begun :])
    return {"absolute_depth_mm": float(np.abs(depth).mean()), "deviation_mm": float(np.abs(across).mean())}


MEASURES = (
    Measure(
        "spectral_arc_length", "spectral arc length, 20 Hz", "", published.SAL, higher_is_better=True,
        why="The arc length grows with the duration of a trace, which the paper does not give. A trace with a fixture "
        "is shorter here, because touch frees the channel that looks at the depth",
    ),
    Measure("sparc", "SPARC, 10 Hz", "", higher_is_better=True),
    Measure("irregularity", "arc length beyond 1, for each root of a second", ""),
    Measure("absolute_depth_mm", "distance from the planned depth", "mm"),
    Measure("deepest_mm", "deepest below the surface", "mm"),
    Measure("deviation_mm", "distance from the path, across", "mm"),
    Measure("duration_s", "duration", "s"),
    Measure("force_n", "force of the fixture on the hand", "N", tested=False),
    Measure("energy_mj", "energy that the fixture gave to the hand", "mJ", tested=False),
    Measure("chatter_um", "chatter of the setpoint above 30 Hz", "µm"),
)


def findings(rows: list[Row], scale: Scale) -> Findings:
    """Compares each mode with no fixture; adds the overlay of trajectories, and sweeps of the operator's values."""
    swept = ("spectral_arc_length", "sparc", "absolute_depth_mm", "deviation_mm")
    usual = [row for row in rows if not row["varied"]]
    found = compare(NAME, usual, MEASURES, scale.seed, swept)
    return replace(found, figures=[*found.figures, _overlay(main_rows(usual))],
                   tables=[*found.tables, _sensitivity([row for row in rows if row["varied"]])])


def _sensitivity(rows: list[Row]) -> Table:
    """Returns the smoothness with other values of the operator, without a fixture and with the certified rule."""
    members = ("spectral_arc_length", "sparc", "irregularity", "duration_s")
    lines, rises = [], 0
    kinds = list(dict.fromkeys(tuple(row["varied"].items()) for row in rows))
    for kind in kinds:
        here = {mode: [row for row in rows if tuple(row["varied"].items()) == kind and row["mode"] == mode]
                for mode in VARIED}
        means = {mode: [_mean([row[member] for row in of]) for member in members] for mode, of in here.items()}
        free, held = means[VARIED[0]], means[VARIED[1]]
        rises += held[0] > free[0]
        lines.append([", ".join(f"{name} = {value:g}" for name, value in kind),
                      ", ".join(f"{sum(row['finished'] for row in of)} of {len(of)}" for of in here.values()),
                      *(f"{a:.2f} → {b:.2f}" for a, b in zip(free, held, strict=True))])
    return Table(
        "Other values of the operator",
        ["value", "finished, free and certified", "arc length", "SPARC",
         "arc length beyond 1, for each root of a second", "duration [s]"],
        lines,
        f"Means without a fixture → with certified. The arc length rises at {rises} of {len(kinds)} points. "
        "The arc length depends on the duration; SPARC and the last but one column hardly do.",
    )


def _mean(values: list[float | None]) -> float:
    told = [value for value in values if value is not None]
    return float(np.mean(told)) if told else float("nan")


def _overlay(rows: list[Row]) -> Figure:
    """Draws the trajectories on the section of the skull, as Li et al. do."""
    fig, axes = figures.new(160, 120, rows=len(SWEPT))
    for ax, mode in zip(axes, SWEPT, strict=True):
        for row in (row for row in rows if row["mode"] == mode and row["along_mm"]):
            ax.plot(row["along_mm"], row["height_mm"], color=figures.color(mode), linewidth=0.6)
        ax.axhline(0.0, color=figures.INK, linewidth=1.0)
        ax.set(ylabel="height [mm]", ylim=(-3.2, 3.2), title=figures.label(mode))
    axes[-1].set_xlabel("along the path [mm]")
    return Figure(
        f"{NAME}_overlay",
        "Trajectories on the section of the skull",
        "The height of the tip over the planned outer surface of the skull, in five trials of each mode.",
        figures.svg(fig),
    )
