# SPDX-License-Identifier: BSD-3-Clause
"""E4: the operator cuts skulls along a planned path (section V-B).

As in Li et al. (2020), the shell is 2 mm thick (here on the outside of the CT skull) and the path is in the sagittal
plane. The corridor is 1 mm on each side, the motion sphere 5 mm, and there are six fiducials. Measures 30 samples in
each trial, 1 mm apart. Cutting path deviation is the distance from the path to the far edge of the cut, so half the
width of the kerf is included. Penetration depth is the depth of the kerf minus the thickness of the shell: positive is
an over-cut.
"""
from __future__ import annotations

from typing import Any

import numpy as np

from . import anatomy, modes, parameters, published, teleoperation
from .bone import CELL
from .comparison import Measure, compare
from .experiment import Findings, Row, Scale, Unit
from .parameters import Values
from .set_up_errors import SetUp
from .teleoperation import CORRIDOR, SLOW, SWEEP, SWEPT, Planned, Simulation, Trial
from .trial import Course, Trace

NAME = "e4_cutting"
TITLE = "E4 Cutting (section V-B)"

CORRIDORS = (0.25, 0.5)  # [mm], besides that of Li et al.
SAMPLES = 30
SPEED = 56.0 / 60.0  # [mm/s]: an ultrasonic chisel cuts bone deepest at 56 mm/min (Khambay, Walmsley, 2000, abstract)
VISIBLE = 0.1  # a cut this deep is seen on the outside [mm], ours


def units(scale: Scale) -> list[Unit]:
    """Quick: two trials for each mode, as in Li et al., one for SLOW modes. Full: 40, ten for SLOW modes; sweeps of
    tremor and corridor; trials without errors of the set-up."""
    usual, slow = (40, 10) if scale.full else (2, 1)
    trials: list[Planned] = [(mode, n, {}) for mode in modes.MODES for n in range(slow if mode in SLOW else usual)]
    trials += [(mode, 0, {"ideal": True}) for mode in SWEPT]
    trials += [("certified", n, {"corridor": c}) for c in CORRIDORS for n in range(10 if scale.full else 1)]
    if scale.full:
        trials += [(mode, n, {"changed": {"Operator.tremor": t}}) for mode in SWEPT for t in SWEEP for n in range(10)]
    return [teleoperation.unit(mode, n, scale.seed, **of) for mode, n, of in trials]


def planned(mode: str, seed: int, number: int = 0, *, ideal: bool = False, corridor: float = CORRIDOR,
            changed: Values | None = None, simulation: Simulation = Simulation()) -> Trial:
    """Returns the trial of a mode. Modes with the same seed and number meet the same operator and registration.

    `ideal`: no errors of the set-up, and no bone: no force, no deflection.
    """
    path, index = anatomy.phantom()
    of = parameters.changed(simulation, changed or {})
    course = Course(path=path, depth=anatomy.SHELL, speed=SPEED, bone=None if ideal else of.bone, time_limit=600.0)
    return Trial(mode, (seed, 4, number), course, index, of.operator, SetUp.ideal() if ideal else of.setup, corridor)


def trial(mode: str, seed: int, number: int = 0, *, judged: bool = True, **settings: Any) -> Row:
    """Returns the row of one trial. `settings`: see planned(). With `judged` the row has the measures of the judge."""
    made = planned(mode, seed, number, **settings)
    trace = made.run()
    return made.measures(trace, judged=judged) | _cut_measures(trace, made.course)


def run(unit: Unit) -> list[Row]:
    """Runs one trial."""
    return [teleoperation.about(unit.settings) | trial(**unit.settings)]


def _cut_measures(trace: Trace, course: Course) -> Row:
    deviation, depth = cut(trace, course)
    reached = [at for at in deviation if at is not None]
    return {
        "millimetres_reached": len(reached),
        "deviation_mm": float(np.mean(reached)) if trace.finished else None,
        "greatest_deviation_mm": float(np.max(reached)) if trace.finished else None,
        "depth_mm": float(np.mean(depth)),
        "absolute_depth_mm": float(np.mean(np.abs(depth))),
        "over_cut_mm": max(0.0, float(np.max(depth))),
        "under_cut_mm": max(0.0, float(-np.min(depth))),
        "deviations_mm": deviation,
        "depths_mm": depth,
    }


def cut(trace: Trace, course: Course) -> tuple[list[float | None], list[float]]:
    """Returns deviation and penetration depth at each millimeter of the path [mm].

    The deviation is the distance from the path to the far edge of the cut in that millimeter; None without a cut.
    Without bone there is no kerf; the path and the depth of the tip replace it.
    """
    path = course.path
    if course.bone is None:
        return _cut_by_the_tip(trace, course)
    deviations: list[float | None] = []
    depths: list[float] = []
    middle = trace.kerf.shape[1] // 2
    for number in range(SAMPLES):
        here = trace.kerf[path.number(number) : path.number(number + 1.0)]
        columns = np.flatnonzero((here > VISIBLE).any(axis=0))
        far = max(abs(columns[0] - middle), abs(columns[-1] - middle)) if len(columns) else None
        deviations.append(None if far is None else float((far + 0.5) * CELL))
        depths.append(float(trace.kerf[path.number(number + 0.5)].max()) - anatomy.SHELL)
    return deviations, depths


def _cut_by_the_tip(trace: Trace, course: Course) -> tuple[list[float | None], list[float]]:
    along, across, depth = course.path.depths(trace.tip[trace.begun :])
    millimetre = np.minimum(along.astype(int), SAMPLES - 1)
    deviations: list[float | None] = []
    depths: list[float] = []
    for number in range(SAMPLES):
        here = (millimetre == number) & (depth > 0.0)
        deviations.append(float(np.abs(across[here]).max()) if here.any() else None)
        depths.append(float(depth[here].max(initial=0.0)) - anatomy.SHELL)
    return deviations, depths


MEASURES = (
    Measure(
        "deviation_mm", "cutting path deviation", "mm", published.PATH_DEVIATION, samples="deviations_mm",
        why="A corridor of 1 mm on each side seldom limits the operator. With a fixture there are fewer entries "
        "into the kerf, so its far edge is nearer to the path. The table of sweeps has narrower corridors",
    ),
    Measure(
        "absolute_depth_mm", "absolute penetration depth", "mm", published.PENETRATION_DEPTH, samples="depths_mm",
        why="The operator presses with at most two newtons, so the blade seldom breaks through far. With a fixture, "
        "the depth error comes from the bending of robot and tool, and from the error of registration. "
        "The paper's rule also stays away from the region in valleys",
    ),
    Measure(
        "duration_s", "duration", "s", published.DURATION,
        why="No duration is fitted: the bone resists less, or more, than the paper's phantom. An operator that feels "
        "a fixture need not look at the depth, nor lift the tool",
    ),
    Measure("greatest_deviation_mm", "greatest deviation", "mm"),
    Measure("over_cut_mm", "greatest over-cut", "mm"),
    Measure("under_cut_mm", "greatest under-cut", "mm"),
    Measure("contact_n", "force on the bone", "N"),
    Measure("millimetres_reached", "length of the path cut", "mm"),
    Measure("force_n", "force of the fixture on the hand", "N", tested=False),
    Measure("energy_mj", "energy that the fixture gave to the hand", "mJ", tested=False),
    Measure("chatter_um", "chatter of the setpoint above 30 Hz", "µm"),
)


def findings(rows: list[Row], scale: Scale) -> Findings:
    """Compares each mode with no fixture; then the sweeps."""
    return compare(NAME, rows, MEASURES, scale.seed, ("deviation_mm", "absolute_depth_mm", "duration_s"))
