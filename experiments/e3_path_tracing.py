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

from . import anatomy, figures, modes, parameters, published, teleoperation
from .comparison import Measure, compare, main_rows
from .experiment import Figure, Findings, Row, Scale, Unit
from .parameters import Values
from .set_up_errors import SetUp
from .teleoperation import CORRIDOR, SLOW, SWEEP, SWEPT, Planned, Simulation, Trial
from .trial import Course, Trace

NAME = "e3_path_tracing"
TITLE = "E3 Path tracing (section V-A)"

SPEED = 2.0  # [mm/s], ours: Li et al. do not give it
TIME_LIMIT = 120.0  # [s]; a trial that finishes does so within about 60 s


def units(scale: Scale) -> list[Unit]:
    """Returns five trials for each mode, as in Li et al., two for SLOW modes; full: 40. Adds a sweep of tremor, and
    trials without errors of the set-up."""
    trials: list[Planned] = [(mode, n, {}) for mode in modes.MODES
                             for n in range(40 if scale.full else 2 if mode in SLOW else 5)]
    trials += [(mode, n, {"changed": {"Operator.tremor": t}}) for mode in SWEPT for t in SWEEP
               for n in range(10 if scale.full else 1)]
    trials += [(mode, n, {"ideal": True}) for mode in modes.MODES for n in range(2 if scale.full else 1)]
    return [teleoperation.unit(mode, n, scale.seed, **of) for mode, n, of in trials]


def planned(mode: str, seed: int, number: int = 0, *, ideal: bool = False, corridor: float = CORRIDOR,
            changed: Values | None = None, simulation: Simulation = Simulation()) -> Trial:
    """Returns the trial of a mode. Modes with the same seed and number meet the same operator and registration."""
    path, index = anatomy.printed_skull()
    course = Course(path=path, depth=0.0, speed=SPEED, time_limit=TIME_LIMIT)
    of = parameters.changed(simulation, changed or {})
    return Trial(mode, (seed, 3, number), course, index, of.operator, SetUp.ideal() if ideal else of.setup, corridor)


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
    drawn = told["mode"] in SWEPT and not told["ideal"] and not told["changed"] and told["number"] < 5
    return [
        teleoperation.about(told) | made.measures(trace) | _distances(trace, made.course)
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
    """Compares each mode with no fixture; adds the overlay of trajectories."""
    swept = ("spectral_arc_length", "sparc", "absolute_depth_mm", "deviation_mm")
    found = compare(NAME, rows, MEASURES, scale.seed, swept)
    return replace(found, figures=[*found.figures, _overlay(main_rows(rows))])


def _overlay(rows: list[Row]) -> Figure:
    """Draws the trajectories on the section of the skull, as Li et al. do."""
    fig, axes = figures.new(160, 120, rows=len(SWEPT))
    for ax, mode in zip(axes, SWEPT, strict=True):
        for row in (row for row in rows if row["mode"] == mode and row["along_mm"]):
            ax.plot(row["along_mm"], row["height_mm"], color=figures.color(mode), linewidth=0.6)
        ax.axhline(0.0, color=figures.INK, linewidth=1.0)
        ax.sharex(axes[0])
        ax.set(ylabel="height [mm]", ylim=(-3.2, 3.2), title=figures.label(mode))
    axes[-1].set_xlabel("along the path [mm]")
    return Figure(
        f"{NAME}_overlay",
        "Trajectories on the section of the skull",
        "The height of the tip over the planned outer surface of the skull, in five trials of each mode.",
        figures.svg(fig),
    )
