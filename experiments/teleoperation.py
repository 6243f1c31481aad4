# SPDX-License-Identifier: BSD-3-Clause
"""The common part of the experiments of section V: a trial of a mode, and its measures."""
from __future__ import annotations

import zlib
from dataclasses import replace
from functools import lru_cache
from typing import Any

import keepout
import numpy as np
from keepout_peers import Judge
from numpy.typing import NDArray
from scipy import signal

from . import modes
from .experiment import Array, Row, Unit
from .operator_model import Operator
from .parameters import scaled
from .rules.rule import Corridor, Task
from .set_up_errors import SetUp, fiducials_around, registered_from_true
from .smoothness import spectral_arc_length, sparc
from .trial import Course, Trace, run_trial

MARGIN = 0.01  # [mm] for each rule: Li et al. (2020) have none, and the certified rule needs some
CORRIDOR = 1.0  # [mm] on each side of the sagittal plane (V)

#: The tremor of all comparisons, and the sweep [mm RMS of the goal].
TREMOR = 0.13
SWEEP = (0.0, 0.05, 0.25)
#: The modes of the sweeps and of the drawn trajectories.
SWEPT = ("none", "paper", "certified")

#: A mode, the number of the trial, and the settings of unit() that differ from its defaults.
Planned = tuple[str, int, dict[str, Any]]


def unit(mode: str, number: int, seed: int, *, tremor: float = TREMOR, ideal: bool = False,
         corridor: float = CORRIDOR) -> Unit:
    """Returns the unit of one trial of a mode. `ideal`: the set-up has no errors."""
    kind = f"tremor{round(tremor * 1000)}um-corridor{round(corridor * 1000)}um{'-ideal' if ideal else ''}"
    settings = {"mode": mode, "tremor": tremor, "ideal": ideal, "corridor": corridor, "number": number, "seed": seed}
    return Unit(f"{mode}-{kind}-{number}", settings)


def run_unit(
    unit: Unit, experiment: int, course: Course, index: keepout.Index, operator: Operator = Operator()
) -> tuple[Trace, Row]:
    """Runs the trial of a unit, and returns it with its row of measures. `experiment` is part of the seeds."""
    told = unit.settings
    factors = told.get("factors", {})  # of E8: values that are halved or doubled
    operator = scaled(replace(operator, tremor=told["tremor"]), factors)
    setup = scaled(SetUp.ideal() if told["ideal"] else SetUp(), factors)
    course = replace(course, bone=scaled(course.bone, factors)) if course.bone else course
    seeds = (told["seed"], experiment, told["number"], round(told["tremor"] * 1000))
    trace = operate(told["mode"], course, index, operator, setup, seeds, told["corridor"])
    about = {name: value for name, value in told.items() if name != "seed"}
    return trace, about | measures(trace, course, _judge(index))


@lru_cache(maxsize=1)
def _judge(index: keepout.Index) -> Judge:
    return Judge(index.mesh.vertices, index.mesh.triangles)


def operate(
    mode: str,
    course: Course,
    index: keepout.Index,
    operator: Operator,
    setup: SetUp,
    seeds: tuple[int, ...],
    corridor: float = CORRIDOR,
) -> Trace:
    """Runs one trial of a mode. Each mode, and each of the `seeds`, simulates another operator on another day."""
    random = np.random.default_rng([*seeds, zlib.crc32(mode.encode())])
    path = course.path
    middle = len(path.points) // 2
    fiducials = fiducials_around(path.points[middle], path.up[middle])
    registered = registered_from_true(setup, fiducials, random)
    a, b, c = path.points[0].tolist()
    x, y, z = path.across.tolist()
    task = Task(index.mesh, MARGIN, course.radius, Corridor((a, b, c), (x, y, z), corridor))
    return run_trial(course, modes.make_rule(mode, task, index), operator, setup, registered, random)


def measures(trace: Trace, course: Course, judge: Judge) -> Row:
    """Returns the measures of a trial, after the approach. A measure without a meaning is null, such as the duration
    of an unfinished trial.

    `crossings` and `deepest_registered_mm` are of the setpoint in the frame of the fixture, in the whole trial: what
    the rule itself allowed. `deepest_mm` is of the tip in the true frame. `beyond_registration_mm` is the part of it
    that exceeds the displacement by the registration. `energy_mj` is the work of the fixture's force on the handle;
    below 0 the fixture took energy.
    """
    start, rate = trace.begun, 1.0 / course.period
    tip, setpoint = trace.tip[start:], trace.setpoint[start:]
    speed = np.linalg.norm(np.diff(tip, axis=0), axis=1) * rate
    depth = -judge.distances(tip)
    displaced = np.linalg.norm(trace.registered(tip) - tip, axis=1)
    held = trace.force[start:] > 0.0
    return {
        "finished": trace.finished,
        "duration_s": len(trace.tip) * course.period if trace.finished else None,
        "spectral_arc_length": spectral_arc_length(speed, rate) if trace.finished else None,
        "sparc": sparc(speed, rate) if trace.finished else None,
        "crossings": int(judge.crossings(trace.setpoint[:-1], trace.setpoint[1:]).sum()),
        "deepest_registered_mm": max(0.0, float(-judge.distances(trace.setpoint).min())),
        "deepest_mm": max(0.0, float(depth.max())),
        "registration_error_mm": float(displaced.max()),
        "beyond_registration_mm": max(0.0, float((depth - displaced).max())),
        "force_n": float(trace.force[start:].mean()),
        "greatest_force_n": float(trace.force[start:].max()),
        "contact_n": float(trace.contact[start:].mean()),
        "energy_mj": float(trace.power.sum() * course.period),
        "chatter_um": chatter(setpoint, held, rate) if held.any() else None,
    }


def chatter(setpoint: Array, held: NDArray[np.bool_], rate: float) -> float:
    """Returns the root mean square of the setpoint above 30 Hz while the fixture constrains it [µm].

    A hand alone has almost no power there: it measures the interaction of fixture and hand.
    """
    high_pass = signal.butter(4, 30.0, "highpass", fs=rate, output="sos")
    fast = signal.sosfiltfilt(high_pass, setpoint, axis=0)
    return float(1000.0 * np.sqrt(np.mean(np.sum(fast[held] ** 2, axis=1))))
