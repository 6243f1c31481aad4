# SPDX-License-Identifier: BSD-3-Clause
"""The common part of the experiments of section V: a trial of a mode, and its measures."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import keepout
import numpy as np
from keepout_peers import Judge
from numpy.typing import NDArray
from scipy import signal

from . import modes
from .bone import BoneProperties
from .experiment import Array, Row, Unit
from .operator_model import Operator, streams
from .parameters import Values
from .rules.native import terrain_of
from .rules.rule import Corridor, Task
from .set_up_errors import SetUp, fiducials_around, registered_from_true
from .smoothness import spectral_arc_length, sparc
from .trial import Course, Trace, draw, run_trial

MARGIN = 0.01  # [mm] for each rule: Li et al. (2020) have none, and the certified rule needs some
CORRIDOR = 1.0  # [mm] on each side of the sagittal plane (V)

#: The sweep of the tremor [mm RMS at the hand]. 0.049 mm: surgeons who hold an instrument still (Riviere, Rader,
#: Khosla, 1997). 0.65 mm: 0.13 mm at the tip.
SWEEP = (0.0, 0.049, 0.65)
#: The modes of the sweeps and of the drawn trajectories.
SWEPT = ("none", "paper", "certified")

#: A trial of these takes 2 to 50 s of processor time, most of it in FCL and Bullet: E4 and quick runs have fewer of them.
SLOW = ("all_faces", "fcl_slide", "bullet_slide")

#: A mode, the number of the trial, and the settings of unit() that differ from its defaults.
Planned = tuple[str, int, dict[str, Any]]


@dataclass(frozen=True)
class Simulation:
    """All that is simulated beside the rule: their numbers can be changed, see parameters.changed()."""

    operator: Operator = field(default_factory=Operator)
    setup: SetUp = field(default_factory=SetUp)
    bone: BoneProperties = field(default_factory=BoneProperties)


def unit(mode: str, number: int, seed: int, *, ideal: bool = False, corridor: float = CORRIDOR,
         changed: Values | None = None) -> Unit:
    """Returns the unit of one trial of a mode. `ideal`: the set-up has no errors. `changed`: other values of numbers of
    a Simulation."""
    kind = f"corridor{round(corridor * 1000)}um{'-ideal' if ideal else ''}"
    kind += "".join(f"-{name}{value:g}" for name, value in (changed or {}).items())
    settings = {"mode": mode, "ideal": ideal, "corridor": corridor, "changed": dict(changed or {}), "number": number,
                "seed": seed}
    return Unit(f"{mode}-{kind}-{number}", settings)


def about(settings: dict[str, Any]) -> Row:
    """Returns the settings of a trial as members of its row. `changed` is text, such as "Operator.tremor=0.049"."""
    changed = " ".join(f"{name}={value:g}" for name, value in settings["changed"].items())
    return {name: value for name, value in settings.items() if name != "seed"} | {"changed": changed}


@dataclass(frozen=True)
class Trial:
    """One trial of a mode. All trials with the same `seeds` have the same hand, tremor, registration and sight."""

    mode: str
    seeds: tuple[int, ...]
    course: Course
    index: keepout.Index
    operator: Operator = field(default_factory=Operator)
    setup: SetUp = field(default_factory=SetUp)
    corridor: float = CORRIDOR

    def run(self) -> Trace:
        """Returns the course of the trial."""
        random = streams(*self.seeds)
        path = self.course.path
        middle = len(path.points) // 2
        fiducials = fiducials_around(path.points[middle], path.up[middle])
        registered = registered_from_true(self.setup, fiducials, random("registration"))
        a, b, c = path.points[0].tolist()
        x, y, z = path.across.tolist()
        task = Task(self.index.mesh, MARGIN, self.course.radius, Corridor((a, b, c), (x, y, z), self.corridor))
        rule = modes.make_rule(self.mode, task)
        draws = draw(self.course, self.operator, random)
        return run_trial(self.course, rule, self.operator, self.setup, registered, draws)

    def measures(self, trace: Trace, *, judged: bool = True) -> Row:
        """Returns the measures of a trace, after the approach. A measure without a meaning is null, such as the
        duration of an unfinished trial.

        `irregularity` is the arc length beyond 1, for each root of a second: by the law of
        smoothness.arc_length_bounds() it hardly depends on the duration. `energy_mj` is the work of the fixture's force
        on the handle; below 0 the fixture took energy. With `judged`, the judge adds what happened to the anatomy: see
        _judged().
        """
        start, rate = trace.begun, 1.0 / self.course.period
        speed = np.linalg.norm(np.diff(trace.tip[start:], axis=0), axis=1) * rate
        held = trace.force[start:] > 0.0
        row: Row = {
            "finished": trace.finished,
            "duration_s": len(trace.tip) * self.course.period if trace.finished else None,
            "spectral_arc_length": None,
            "sparc": None,
            "irregularity": None,
            "force_n": float(trace.force[start:].mean()),
            "greatest_force_n": float(trace.force[start:].max()),
            "contact_n": float(trace.contact[start:].mean()),
            "energy_mj": float(trace.power.sum() * self.course.period),
            "chatter_um": chatter(trace.setpoint[start:], held, rate) if held.any() else None,
        }
        if trace.finished:
            length, lasted = spectral_arc_length(speed, rate), len(speed) / rate
            row["spectral_arc_length"], row["sparc"] = length, sparc(speed, rate)
            row["irregularity"] = (-length - 1.0) / lasted**0.5
        return row | (_judged(trace, terrain_of(self.index.mesh).judge()) if judged else {})


def _judged(trace: Trace, judge: Judge) -> Row:
    """Returns what a trial did to the anatomy.

    `crossings` and `deepest_registered_mm` are of the setpoint in the frame of the fixture, in the whole trial: what
    the rule itself allowed. `deepest_mm` is of the tip in the true frame, after the approach. `beyond_registration_mm`
    is the part of it that exceeds the displacement by the registration.
    """
    tip = trace.tip[trace.begun :]
    depth = -judge.distances(tip)
    displaced = np.linalg.norm(trace.registered(tip) - tip, axis=1)
    return {
        "crossings": int(judge.crossings(trace.setpoint[:-1], trace.setpoint[1:]).sum()),
        "deepest_registered_mm": max(0.0, float(-judge.distances(trace.setpoint).min())),
        "deepest_mm": max(0.0, float(depth.max())),
        "registration_error_mm": float(displaced.max()),
        "beyond_registration_mm": max(0.0, float((depth - displaced).max())),
    }


def chatter(setpoint: Array, held: NDArray[np.bool_], rate: float) -> float:
    """Returns the root mean square of the setpoint above 30 Hz while the fixture constrains it [µm].

    A hand alone has almost no power there: it measures the interaction of fixture and hand.
    """
    high_pass = signal.butter(4, 30.0, "highpass", fs=rate, output="sos")
    fast = signal.sosfiltfilt(high_pass, setpoint, axis=0)
    return float(1000.0 * np.sqrt(np.mean(np.sum(fast[held] ** 2, axis=1))))
