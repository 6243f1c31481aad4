# SPDX-License-Identifier: BSD-3-Clause
"""E4: skulls are cut along a planned path (section V-B).

A shell of 2 mm, as the paper's phantoms are, on the outside of the CT skull; sagittal plane, corridor of 1 mm
on each side, motion sphere of 5 mm, six fiducials. Measured at 1 mm spacing, 30 samples a trial:
cutting path deviation, the farthest that the tip was beside the path within the bone, and
penetration depth, the depth of the kerf less the shell's thickness: positive is an over-cut.
"""
from __future__ import annotations

import numpy as np
from keepout_peers import Judge

from . import anatomy, modes, published
from .bone import BoneProperties
from .comparison import Measure, compare, sweep_table
from .experiment import Findings, Row, Scale, Unit
from .operator_model import Operator
from .set_up_errors import SetUp
from .teleoperation import Trial, measures, operate
from .trial import Course

NAME = "e4_cutting"
TITLE = "E4 Cutting (section V-B)"

#: Tremor of all comparisons, and the sweep [mm RMS at the tip].
TREMOR = 0.13
SWEEP = (0.0, 0.05, 0.25)
SWEPT = ("none", "paper", "certified")
SAMPLES = 30


def units(scale: Scale) -> list[Unit]:
    """Quick: two trials a mode, as the paper's. Full: ten, a sweep of tremor, and no errors of the set-up."""
    repetitions = 10 if scale.full else 2

    def of(mode: str, tremor: float, ideal: bool, number: int) -> Unit:
        name = f"{mode}-tremor{round(tremor * 1000)}um{'-ideal' if ideal else ''}-{number}"
        settings = {"mode": mode, "tremor": tremor, "ideal": ideal, "number": number}
        return Unit(name, settings | {"seed": scale.seed})

    of_all = [of(mode, TREMOR, False, n) for mode in modes.MODES for n in range(repetitions)]
    if not scale.full:
        return of_all
    swept = [of(m, t, False, n) for m in SWEPT for t in SWEEP for n in range(5)]
    ideal = [of(m, TREMOR, True, n) for m in SWEPT for n in range(2)]
    return of_all + swept + ideal


def run(unit: Unit) -> list[Row]:
    """One trial."""
    told = unit.settings
    path, index = anatomy.phantom()
    setup = SetUp.ideal() if told["ideal"] else SetUp()
    bone = None if told["ideal"] else BoneProperties()  # no force, no deflection
    course = Course(path=path, depth=anatomy.SHELL, speed=0.17, bone=bone)
    operator = Operator(tremor=told["tremor"])
    seeds = (told["seed"], 4, told["number"], round(told["tremor"] * 1000))
    trial = operate(told["mode"], course, index, operator, setup, seeds)
    judge = Judge(index.mesh.vertices, index.mesh.triangles)
    deviation, depth = cut(trial, course)
    return [
        {name: told[name] for name in ("mode", "tremor", "ideal", "number")}
        | measures(trial, course, judge)
        | {
            "deviation_mm": float(np.mean(deviation)),
            "greatest_deviation_mm": float(np.max(deviation)),
            "depth_mm": float(np.mean(depth)),
            "absolute_depth_mm": float(np.mean(np.abs(depth))),
            "over_cut_mm": max(0.0, float(np.max(depth))),
            "under_cut_mm": max(0.0, float(-np.min(depth))),
            "deviations_mm": deviation,
            "depths_mm": depth,
        }
    ]


def cut(trial: Trial, course: Course) -> tuple[list[float], list[float]]:
    """Deviation and penetration depth at each millimetre of the path [mm].

    Without bone to cut there is no kerf, and the tip's own depth takes its place.
    """
    path, trace = course.path, trial.trace
    along, across, depth = path.depths(trace.tip[trace.begun :])
    millimetre = np.minimum(along.astype(int), SAMPLES - 1)
    deviations, depths = [], []
    for number in range(SAMPLES):
        here = (millimetre == number) & (depth > 0.0)
        deviations.append(float(np.abs(across[here]).max(initial=0.0)))
        if course.bone:
            kerf = float(trace.kerf[path.number(number + 0.5)])
        else:
            kerf = float(depth[here].max(initial=0.0))
        depths.append(kerf - anatomy.SHELL)
    return deviations, depths


MEASURES = (
    Measure("deviation_mm", "cutting path deviation", "mm", published.PATH_DEVIATION, samples="deviations_mm"),
    Measure("absolute_depth_mm", "absolute penetration depth", "mm", published.PENETRATION_DEPTH, samples="depths_mm"),
    Measure("duration_s", "duration", "s", published.DURATION),
    Measure("greatest_deviation_mm", "greatest deviation", "mm"),
    Measure("over_cut_mm", "greatest over-cut", "mm"),
    Measure("under_cut_mm", "greatest under-cut", "mm"),
    Measure("contact_n", "force on the bone", "N"),
    Measure("force_n", "force of the fixture on the hand", "N"),
    Measure("absorbed_mj", "energy that the fixture took from the hand", "mJ"),
    Measure("chatter_um", "chatter of the setpoint above 30 Hz", "um"),
)


def findings(rows: list[Row], scale: Scale) -> Findings:
    """Compared mode by mode with no fixture; then the sweep of tremor."""
    main = [row for row in rows if row["tremor"] == TREMOR and not row["ideal"]]
    found = compare(NAME, main, MEASURES, scale.seed)
    if not scale.full:
        return found
    return found.with_table(sweep_table(rows, ("deviation_mm", "absolute_depth_mm", "duration_s", "spectral_arc_length")))
