# SPDX-License-Identifier: BSD-3-Clause
"""E7: does the margin that registration asks for keep a tool off the dura?

The chain of a surgery: the robot touches six fiducials, each with an error (FLE). keepout.fit_rigid fits them,
keepout.registration_margin gives the margin for a confidence, and the certified rule keeps a tool that far from the
mesh at its registered place. The tool presses on the dura along the whole path, which is the worst that an operator
can do. A draw touches if the tool reaches the mesh at its true place. The share of draws that touch must not exceed
1 - confidence. The dura is the forbidden block of E4.

The tool is a point, or an instrument of the joint step with shaft, wrist and jaws. Its joints are off their setpoints
in each cycle, evenly within bounds. The bounds times their levers add to the margin, as docs/choosing_a_margin.md
says; a margin without them shows what they are for. Peng
et al. (2024, abstract) calibrated a cable-driven robot (RAVEN-II). The errors of its first three joints were 0.104 and
0.120 degrees and 0.118 mm. The other three joints here have the error of the second; this value is ours.
"""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import keepout
import numpy as np
from keepout_peers import Judge, Terrain
from matplotlib.axes import Axes
from scipy import stats

from . import anatomy, figures
from .experiment import Array, Claim, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import Interval, share
from .set_up_errors import fiducials_around

NAME = "e7_margin"
TITLE = "E7 Registration, margin and the dura"

FLES = (0.3, 0.65, 1.0, 1.5)  # root mean square of the vector [mm]; 0.65 as in E3 and E4
CONFIDENCES = (0.5, 0.9, 0.99, 0.999)
LEAST_MARGIN = 0.01  # [mm] without a margin for the registration; certified needs some
FIXED = (0.25, 0.5, 1.0)  # margins of a point that do not depend on the FLE [mm]
POINT, INSTRUMENT = "point", "instrument"
DRAWS = {POINT: 400, INSTRUMENT: 100}  # of each FLE in a full run
QUICK_DRAWS = {POINT: 60, INSTRUMENT: 5}

#: What a margin covers.
NOTHING, KNOWN, ESTIMATED = "nothing", "registration, FLE known", "registration, FLE estimated"
JOINTS, NO_JOINTS = "registration and joints", "registration only"
#: The margins that promise to keep the tool off.
PROMISED = (KNOWN, ESTIMATED, JOINTS)

STEP = 0.3  # longest commanded motion of a cycle [mm]
PRESSING = 3.0  # depth of the operator's goal below the dura [mm]
START_HEIGHT = 5.0  # beyond the margin [mm]

PORT_HEIGHT = 150.0  # of the remote center over the middle of the path [mm]
BAND = 0.002  # of the instrument's guard [mm]
#: Largest errors of the six joints: uniform errors with the root mean squares of the docstring [rad, mm].
JOINT_ERRORS = np.sqrt(3.0) * np.array([*np.radians([0.104, 0.120]), 0.118, *np.radians([0.120] * 3)])


def units(scale: Scale) -> list[Unit]:
    draws = DRAWS if scale.full else QUICK_DRAWS
    return [Unit(f"{tool}-fle{round(1000 * fle)}um", {"tool": tool, "fle": fle, "draws": count, "seed": scale.seed})
            for tool, count in draws.items() for fle in FLES]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each draw of a registration and each margin. All margins have the same draws."""
    of = unit.settings
    return [row for draw in range(of["draws"]) for row in _draw(of["tool"], of["fle"], draw, of["seed"])]


@dataclass(frozen=True)
class Place:
    """The dura below the path: the points that the tool presses on, the free direction there, and its judge."""

    points: Array  # (n, 3) [mm]
    up: Array  # (n, 3), unit
    ahead: Array  # (3,), unit, along the path at its middle
    index: keepout.Index
    judge: Judge
    fiducials: Array  # (6, 3) [mm]


@lru_cache(maxsize=1)
def place() -> Place:
    """Returns the dura of the phantom of E4."""
    path, index = anatomy.phantom()
    middle = len(path.points) // 2
    ahead = path.points[middle + 1] - path.points[middle - 1]
    return Place(
        path.points - anatomy.SHELL * path.up, path.up, ahead / np.linalg.norm(ahead), index,
        Terrain(index.mesh.vertices, index.mesh.triangles).judge(), fiducials_around(path.points[middle], path.up[middle]))


def _draw(tool: str, fle: float, draw: int, seed: int) -> list[Row]:
    random = np.random.default_rng([seed, 7, round(1000 * fle), draw])
    here = place()
    touched = here.fiducials + random.standard_normal(here.fiducials.shape) * fle / np.sqrt(3.0)
    fit = keepout.fit_rigid(touched, here.fiducials)
    errors = random.uniform(-1.0, 1.0, (10_000, len(JOINT_ERRORS))) * JOINT_ERRORS
    ends = here.points[[0, len(here.points) // 2, -1]]
    corners = np.concatenate([ends, ends + (30.0 if tool == INSTRUMENT else 5.0) * here.up[0]])
    margins = [(0.0, NOTHING, LEAST_MARGIN)]
    margins += [(0.0, f"a fixed {length:g} mm", length) for length in FIXED if tool == POINT]
    for covers in (KNOWN, ESTIMATED) if tool == POINT else (JOINTS, NO_JOINTS):
        of_fle = None if covers == ESTIMATED else fle
        margins += [(c, covers, keepout.registration_margin(fit, corners, c, of_fle)) for c in CONFIDENCES]
    worst = max(_deviation(fit, ends[i], here.up[i * (len(here.points) - 1) // 2], fle) for i in range(3))
    displaced = np.linalg.norm(_moved(fit.mesh_from_robot, here.points) - here.points, axis=1).max()
    rows: list[Row] = []
    for confidence, covers, margin in margins:
        clearance, reached = (_press_with_point(margin, fit) if tool == POINT
                              else _press_with_instrument(margin, covers == JOINTS, fit, errors))
        rows.append({
            "tool": tool, "fle": fle, "draw": draw, "confidence": confidence, "covers": covers,
            "registration_margin_mm": margin, "touches": bool(clearance <= 0.0), "clearance_mm": clearance,
            "reached": reached, "registration_error_mm": float(displaced),
            "one_way": float(stats.norm.sf(margin / worst)),
        })
    return rows


def _deviation(fit: keepout.RigidFit, at: Array, up: Array, fle: float) -> float:
    """Returns the standard deviation of the registration error at a place, towards the dura [mm]."""
    return float(np.sqrt(up @ keepout.target_error(fit, at, fle=fle) @ up))


def _moved(pose: Array, points: Array) -> Array:
    moved: Array = points @ pose[:3, :3].T + pose[:3, 3]
    return moved


def _press_with_point(margin: float, fit: keepout.RigidFit) -> tuple[float, float]:
    """Returns the least clearance of a point from the dura at its true place [mm], and the share of the path done."""
    here = place()
    guard = keepout.MotionConstraint(here.index.mesh, index=here.index, margin=margin)
    tip = here.points[0] + (margin + START_HEIGHT) * here.up[0]
    tips, goal = [tip], 0
    while goal < len(here.points) and len(tips) < 4 * len(here.points):
        tip = tip + guard.step(tip, _towards(tip, here.points[goal] - PRESSING * here.up[goal])).motion
        tips.append(tip)
        goal += _is_down(here, tip, goal, margin) * 4
    true = _moved(np.linalg.inv(fit.mesh_from_robot), np.array(tips))
    return float(here.judge.distances(true).min()), min(1.0, goal / len(here.points))


def _towards(tip: Array, goal: Array) -> Array:
    """Returns the commanded motion of a cycle."""
    desired = goal - tip
    length = float(np.linalg.norm(desired))
    return desired * (STEP / length) if length > STEP else desired


def _is_down(here: Place, tip: Array, goal: int, margin: float) -> bool:
    """Returns whether the tip has come down onto the margin: before, the goal does not move along the path."""
    return float((tip - here.points[goal]) @ here.up[goal]) < margin + 1.0


class ResearchKitArm:
    """A research kit's patient-side arm over the path, with the bodies of its instrument.

    The kinematic table and the bodies are those of tests/python/surfaces.py and fixtures/robots/psm.urdf. The place of
    the port is in the frame of the registered anatomy.
    """

    RADII = (4.5, 3.0, 1.0)  # of shaft, wrist and jaws [mm]
    SPACING = 0.5  # of the points at which the judge measures a body: a distance is right to half of it [mm]
    LOWEST = 10.0  # length at the lower end of the shaft that the judge measures [mm]

    def __init__(self, port: Array, up: Array, ahead: Array) -> None:
        ahead = ahead - (ahead @ up) * up
        ahead = ahead / np.linalg.norm(ahead)
        base = np.eye(4)
        base[:3, :3] = np.stack([np.cross(ahead, up), ahead, up], axis=1)
        base[:3, 3] = port
        turn = np.pi / 2
        table = [
            keepout.TableRow("yaw", alpha=turn, theta=turn, lower=-1.588, upper=1.588, velocity=1),
            keepout.TableRow("pitch", alpha=-turn, theta=-turn, lower=-0.925025, upper=0.925025, velocity=1),
            keepout.TableRow("insertion", kind="prismatic", alpha=turn, d=-431.8, lower=0, upper=240, velocity=500),
            keepout.TableRow("roll", d=416.2, lower=-4.53786, upper=4.53786, velocity=8),
            keepout.TableRow("wrist_pitch", alpha=-turn, theta=-turn, lower=-1.39626, upper=1.39626, velocity=8),
            keepout.TableRow("wrist_yaw", a=9.1, alpha=-turn, theta=-turn, lower=-1.39626, upper=1.39626, velocity=8),
        ]
        flange = np.array([[0, -1, 0, 0], [0, 0, 1, 10.2], [-1, 0, 0, 0], [0, 0, 0, 1]])
        ends = [(0, (0, 0, 0)), (4, (0, 0, 0)), (5, (9.1, 0, 0)), (6, (0, 10.2, 0))]
        bodies = [keepout.Body(name, pair, radius) for name, pair, radius in zip(
            ("shaft", "wrist", "jaws"), zip(ends, ends[1:]), self.RADII)]
        self.instrument = keepout.Instrument(keepout.chain_of_table(table, base=base, flange=flange), bodies)
        self._port = port
        self._links = [(keepout.chain_of_table(table[:link], base=base), np.array(at)) for link, at in ends[1:]]

    def start(self, height: float) -> Array:
        """Returns the joints with which the tip is `height` under the port, straight down [mm]."""
        return np.array([0.0, 0.0, height - 3.7, 0.0, 0.0, 0.0])

    def tips(self, joints: Array) -> Array:
        """Returns the tips of (n, 6) joints, (n, 3) [mm]."""
        tips: Array = self.instrument.chain.forward_kinematics(joints)[..., :3, 3]
        return tips

    def sampled(self, joints: Array) -> tuple[Array, Array]:
        """Returns points on the axes of the bodies of (n, 6) joints, (n, points, 3), and their radii, (points,)."""
        ends = [np.broadcast_to(self._port, (len(joints), 3))]
        for chain, at in self._links:
            poses = chain.forward_kinematics(joints[:, : len(chain.joints)])
            ends.append(poses[:, :3, :3] @ at + poses[:, :3, 3])
        points, radii = [], []
        for top, low, radius in zip(ends, ends[1:], self.RADII):
            length = float(np.linalg.norm(low[0] - top[0]))
            shown = min(length, self.LOWEST)
            for along in np.linspace(1.0 - shown / length, 1.0, int(shown / self.SPACING) + 2):
                points.append(top + along * (low - top))
                radii.append(radius)
        return np.stack(points, axis=1), np.array(radii)

    @classmethod
    def joint_margin(cls) -> float:
        """Returns the largest displacement of a point of the instrument by the errors of all joints, over the path [mm].

        The lever is the length below the port for yaw and pitch, and 1 for the insertion. For the others it is the
        length of wrist and jaws, and the radius of the wrist.
        """
        long, short = PORT_HEIGHT + 20.0, 9.1 + 10.2 + cls.RADII[1]
        return float(np.array([long, long, 1.0, short, short, short]) @ JOINT_ERRORS)


def _press_with_instrument(
    margin: float, covers_joints: bool, fit: keepout.RigidFit, errors: Array
) -> tuple[float, float]:
    """Returns the least clearance of the instrument's bodies at their true place [mm], and the share of the path."""
    here = place()
    middle = len(here.points) // 2
    arm = ResearchKitArm(here.points[middle] + PORT_HEIGHT * here.up[middle], here.up[middle], here.ahead)
    whole = margin + BAND + (arm.joint_margin() if covers_joints else 0.0)
    guard = keepout.InstrumentGuard(here.index.mesh, arm.instrument, index=here.index, margin=whole, band=BAND)
    joints = arm.start(PORT_HEIGHT - whole - arm.RADII[-1] - 2.0 * START_HEIGHT)
    all_joints, goal = [joints], 0
    while goal < len(here.points) and len(all_joints) < 4 * len(here.points):
        tip = arm.tips(joints)
        joints = joints + guard.step(joints, linear=_towards(tip, here.points[goal] - PRESSING * here.up[goal])).increment
        all_joints.append(joints)
        goal += _is_down(here, tip, goal, whole + arm.RADII[-1]) * 4
    real = np.array(all_joints) + errors[: len(all_joints)]
    points, radii = arm.sampled(real)
    true = _moved(np.linalg.inv(fit.mesh_from_robot), points.reshape(-1, 3))
    clearance = here.judge.distances(true).reshape(points.shape[:2]) - radii
    return float(clearance.min()), min(1.0, goal / len(here.points))


def findings(rows: list[Row], scale: Scale) -> Findings:
    tools = [tool for tool in (POINT, INSTRUMENT) if any(row["tool"] == tool for row in rows)]
    kept, combinations = map(sum, zip(*(_kept(rows, tool) for tool in tools)))
    total = len({(row["tool"], row["fle"], row["draw"]) for row in rows})
    return Findings(
        f"In {kept} of {combinations} combinations of tool, FLE and confidence, the share of "
        f"{total:,} registrations that touch the dura is compatible with the promise.",
        [_claim(rows, tool) for tool in tools], [_table(rows, tool) for tool in tools], [_figure(rows)])


def _cells(rows: list[Row], tool: str) -> list[tuple[float, str, float, list[Row]]]:
    """Returns FLE, what the margin covers, confidence and rows of each combination."""
    of_cell: dict[tuple[float, str, float], list[Row]] = {}
    for row in rows:
        if row["tool"] == tool:
            of_cell.setdefault((row["fle"], row["covers"], row["confidence"]), []).append(row)
    return [(*key, of_cell[key]) for key in sorted(of_cell)]


def _kept(rows: list[Row], tool: str) -> tuple[int, int]:
    """Returns in how many combinations with a confidence the share may be as promised, and of how many."""
    promised = [(1.0 - confidence, _touching(of))
                for _, covers, confidence, of in _cells(rows, tool) if covers in PROMISED]
    return sum(found.low <= most for most, found in promised), len(promised)


def _percent(value: float) -> str:
    return f"{100 * value:.3g} %"


def _touching(of: list[Row]) -> Interval:
    return share(sum(row["touches"] for row in of), len(of))


def _found(of: list[Row]) -> str:
    found = _touching(of)
    return f"{_percent(found.value)} [{_percent(found.low)}, {_percent(found.high)}]"


def _table(rows: list[Row], tool: str) -> Table:
    lines = []
    for fle, covers, confidence, of in _cells(rows, tool):
        lines.append([
            f"{fle:g}", covers, f"{confidence:g}" if confidence else "-",
            f"{np.median([row['registration_margin_mm'] for row in of]):.2f}",
            f"{np.median([row['registration_error_mm'] for row in of]):.2f}",
            f"at most {_percent(1.0 - confidence)}" if covers in PROMISED else "-",
            _percent(float(np.mean([row["one_way"] for row in of]))), _found(of), str(len(of)),
            f"{min(row['clearance_mm'] for row in of):.2f}", f"{100 * np.mean([row['reached'] for row in of]):.0f} %",
        ])
    extra = f" The errors of the joints need {ResearchKitArm.joint_margin():.2f} mm more." if tool == INSTRUMENT else ""
    return Table(
        f"Registrations with which the {tool} touches the dura",
        ["FLE [mm]", "margin covers", "confidence", "margin of the registration, median [mm]",
         "registration error on the path, median [mm]", "promised", "by target_error, one way, one place", "found [95 %]",
         "registrations", "least clearance [mm]", "path done"],
        lines,
        "The tool presses on the dura along the whole path, always as deep as certified lets it. All rows of an FLE have "
        "the same registrations. 'One way' is the probability that the registration error at the worst of three places "
        "exceeds the margin towards the dura. Found: with the interval of Clopper and Pearson." + extra,
    )


def _claim(rows: list[Row], tool: str) -> Claim:
    of = [row for row in rows if row["tool"] == tool and row["confidence"] == 0.99 and row["covers"] in (KNOWN, JOINTS)]
    without = [row for row in rows if row["tool"] == tool and row["confidence"] == 0.0]
    return Claim(
        f"registrations with which the {tool} touches the dura, margin for 99 %", "-", "not run: the same margin",
        f"{_found(of)}, n = {len(of)}; without the margin {_found(without)}", "not compared",
        "promised: at most 1 %, by the model of the errors",
        "all values of FLE together; Li et al. have no margin")


def _figure(rows: list[Row]) -> Figure:
    fig, (by_length, by_promise) = figures.new(160, 75, columns=2)
    color = figures.color("certified")
    for fle, marker in zip(FLES, "os^D"):
        of = [some for one, _, confidence, some in _cells(rows, POINT) if one == fle and not confidence]
        of.sort(key=lambda some: float(some[0]["registration_margin_mm"]))
        lengths = [some[0]["registration_margin_mm"] for some in of]
        by_length.plot(lengths, [np.mean([row["one_way"] for row in some]) for some in of], color=figures.SOFT)
        _bars(by_length, lengths, of, marker, f"FLE {fle:g} mm", color)
    by_length.set(xlabel="margin of the point [mm]", ylabel="registrations that touch the dura", ylim=(-0.02, 1.0))
    by_length.plot([], [], color=figures.SOFT, label="predicted")
    by_length.legend()
    for tool, covers, marker in ((POINT, KNOWN, "o"), (INSTRUMENT, JOINTS, "s")):
        of = [[row for row in rows if (row["tool"], row["covers"], row["confidence"]) == (tool, covers, confidence)]
              for confidence in CONFIDENCES]
        promised = (1.0 - np.array(CONFIDENCES)) * (0.93 if tool == POINT else 1.07)
        _bars(by_promise, promised, of, marker, tool, color if tool == POINT else figures.INK)
    by_promise.plot([0.001, 0.5], [0.001, 0.5], color=figures.SOFT, label="promised")
    by_promise.set(xscale="log", xlabel="promised: at most")
    by_promise.set_yscale("symlog", linthresh=0.001)
    by_promise.set_ylim(-0.0002, 1.0)
    by_promise.legend()
    return Figure(
        "margin_promised_and_found", "Registrations with which the tool touches the dura",
        "Left: margins of a fixed length; the gray lines are the prediction of target_error, one way and at one place. "
        "Right: margins for a confidence, all values of FLE together; the gray line is the promise. Bars are intervals "
        "of Clopper and Pearson.",
        figures.svg(fig))


def _bars(ax: Axes, places: Iterable[float], of: list[list[Row]], marker: str, label: str, color: str) -> None:
    """Draws the share of registrations that touch at each place, with its interval."""
    for place_, some in zip(places, of):
        found = _touching(some)
        ax.plot([place_, place_], [found.low, found.high], color=color, linewidth=0.8)
        ax.plot(place_, found.value, marker, color=color, label=label)
        label = "_"  # matplotlib shows no such label
