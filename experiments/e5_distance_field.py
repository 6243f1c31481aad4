# SPDX-License-Identifier: BSD-3-Clause
"""E5: a distance field, which most systems use today, compared with the mesh itself, where anatomy is thin.

On closed meshes of anatomy, in the box with the most thin walls. Measures the errors of a grid's distances, the walls
that it loses, its memory, and how far a tip gets that pushes at such walls. Rules: the distance field's, that of Li
et al. (2020), and the certified one. Li et al. have no such experiment. The aneurysm of the sample meshes is open at
its ends: it has no inside, so it is not used.
"""
from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import keepout
import numpy as np
from keepout_peers import Judge
from numpy.typing import NDArray
from scipy import stats

from . import figures
from .anatomy import mesh_file
from .experiment import Array, Claim, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import holm
from .modes import make_rule
from .rules.rule import Rule, Task
from .rules.signed_distance_field import SignedDistanceField, VoxelGrid

NAME = "e5_distance_field"
TITLE = "E5 A distance field beside the mesh, at thin walls"

ANATOMY = ("skull", "airway")
FULL_ANATOMY = ("skull", "airway", "brain")
#: Meshes of hollow anatomy: the tool is inside, and everything around it is solid.
HOLLOW = ("airway",)

CELLS = {"sdf_0.25": 0.25, "sdf_0.5": 0.5, "sdf_1": 1.0}  # [mm]
MODES = ("paper", "certified", *CELLS)

HALF_BOX = 16.0  # of the sampled box [mm]
INNER = 12.5  # of the part with the tested walls and distances [mm]
NEAR = 2.0  # distances are compared up to this far from the surface [mm]
THICKEST = 4.0  # thickest wall [mm]
THIN = 1.0  # walls thinner than this are tested separately [mm]
CELLS_THICK = (1, 2, 4)  # walls thinner than this many cells are counted
OPPOSED = 1.9  # of 2: the distance between the front and back contacts of a ball in a wall, in radii
START = 1.0  # distance of the tip from a wall at the start [mm]
PUSH, SLIDE, CYCLES = 0.1, 0.03, 120  # desired motion of a cycle, into and along a wall [mm]


@dataclass(frozen=True)
class Walls:
    """Places on walls, (n, 3); the unit direction into each; half its thickness; and its middle."""

    front: Array
    inwards: Array
    half: Array
    middle: Array

    def where(self, which: NDArray[Any]) -> Walls:
        return Walls(self.front[which], self.inwards[which], self.half[which], self.middle[which])


class Truth:
    """The judge's findings on a closed mesh. An airway whose normals point inwards is free inside."""

    def __init__(self, mesh: keepout.Mesh) -> None:
        self._judge = Judge(mesh.vertices, mesh.triangles)
        self._sign = -1.0 if mesh.inspect().inside_out else 1.0

    def distances(self, points: Array) -> Array:
        """Returns the distances of (n, 3) points; negative in the solid."""
        signed: Array = self._sign * self._judge.distances(points)
        return signed

    def entered(self, tips: Array) -> bool:
        """Returns True if the path through the places (n, 3) touches the mesh, or if a place is in the solid."""
        touches = self._judge.crossings(tips[:-1], tips[1:]).any()
        return bool(touches or self.distances(tips).min() < 0.0)


def units(scale: Scale) -> list[Unit]:
    return [
        Unit(anatomy, {
            "anatomy": anatomy, "seed": scale.seed, "samples": 20_000 if scale.full else 4000,
            "loops": 150 if scale.full else 60,
        }, alone=True)
        for anatomy in (FULL_ANATOMY if scale.full else ANATOMY)
    ]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each mode. Lengths in mm, memory in bytes, fractions of 1."""
    asked = unit.settings
    mesh = keepout.load_mesh(mesh_file(asked["anatomy"]))
    if asked["anatomy"] in HOLLOW:
        mesh = keepout.Mesh(mesh.vertices, mesh.triangles[:, ::-1])
    begun = time.perf_counter()
    index = keepout.Index(mesh)
    built = time.perf_counter() - begun
    truth = Truth(mesh)
    random = np.random.default_rng(asked["seed"])
    center, walls = thinnest_place(index, random, asked["samples"])
    places = np.indices((28,) * 3).reshape(3, -1).T * 0.9 + center - INNER + random.random(3) * 0.3
    is_thin = 2 * walls.half < THIN
    thin, thicker = (
        pushes_at(truth, walls.where(which), random, asked["loops"])
        for which in (is_thin, ~is_thin)
    )
    task = Task(mesh)

    def row_of(mode: str, new_rule: Callable[[], Rule], more: Row) -> Row:
        row: Row = {
            "anatomy": asked["anatomy"], "mode": mode, "triangles": len(mesh),
            "center": " ".join(f"{x:.2f}" for x in center), "walls": len(walls.half),
        }
        beside = pushed(new_rule, truth, *thicker)
        row |= {f"thicker_{name}": beside[name] for name in ("loops", "entered", "deepest")}
        return row | more | pushed(new_rule, truth, *thin)

    memory = {"memory": index.memory, "memory_whole": index.memory, "measured_build_s": built}
    rows = [
        row_of(mode, partial(_rule, mode, task, index), memory)
        for mode in MODES if mode not in CELLS
    ]
    for mode, cell in CELLS.items():
        begun = time.perf_counter()
        grid = VoxelGrid(mesh, index, cell, center - HALF_BOX, center + HALF_BOX)
        built = time.perf_counter() - begun
        whole = int(np.prod(np.ptp(mesh.bounds, axis=0) / cell + 1)) * grid.values.itemsize
        field = {
            "cell": cell, "memory": grid.memory, "memory_whole": whole, "measured_build_s": built,
        } | errors(grid, truth, places) | lost_walls(grid, walls)
        rows.append(row_of(mode, partial(SignedDistanceField, task, index, cell, grid), field))
    return rows


def _rule(mode: str, task: Task, index: keepout.Index) -> Rule:
    rule = make_rule(mode, task, index)
    assert rule is not None, "both modes are fixtures"
    return rule


def thinnest_place(
    index: keepout.Index, random: np.random.Generator, samples: int
) -> tuple[Array, Walls]:
    """Returns the center of the box that has most of the thin walls, and the walls there, from new samples."""
    everywhere = walls_at(index, *surface_points(index.mesh, random, samples))
    thin = everywhere.front[everywhere.half < 0.25 * THICKEST]
    apart = np.abs(thin[:, None] - thin[None]).max(axis=2)
    center = thin[np.argmax((apart < INNER).sum(axis=1))]
    corners = index.mesh.vertices[index.mesh.triangles]
    inside = np.abs(corners.mean(axis=1) - center).max(axis=1) < INNER - 1.0
    return center, walls_at(index, *surface_points(index.mesh, random, samples, inside))


def surface_points(
    mesh: keepout.Mesh, random: np.random.Generator, count: int,
    chosen: NDArray[np.bool_] | None = None,
) -> tuple[Array, Array]:
    """Returns random points on the chosen triangles, and the directions inwards: (count, 3) each."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    area = np.linalg.norm(normals, axis=1)
    weight = area if chosen is None else np.where(chosen, area, 0.0)
    which = random.choice(len(area), count, p=weight / weight.sum())
    u, v = random.random((2, count, 1))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    points = a[which] + u * (b - a)[which] + v * (c - a)[which]
    return points, -normals[which] / area[which, None]


def walls_at(index: keepout.Index, points: Array, inwards: Array) -> Walls:
    """Returns the places that are on a wall, no thicker than THICKEST.

    Bisection finds the largest ball in the solid that touches a place. The ball lies in a wall if it touches the
    other side straight across. A contact beside the place, as behind a ridge, does not count.
    """
    low, high = np.zeros(len(points)), np.full(len(points), 0.5 * THICKEST)
    for _ in range(30):
        radius = 0.5 * (low + high)
        fits = index.distances(points + radius[:, None] * inwards) >= radius * (1 - 1e-6) - 1e-9
        low, high = np.where(fits, radius, low), np.where(fits, high, radius)
    middle = points + low[:, None] * inwards
    is_wall = np.zeros(len(points), dtype=bool)
    for i in np.flatnonzero((low > 0.01) & (low < 0.499 * THICKEST)):
        touched = index.hits(middle[i], low[i] * 1.001 + 1e-6).points
        across = np.linalg.norm(touched - points[i], axis=1).max(initial=0.0)
        is_wall[i] = across > OPPOSED * low[i]
    return Walls(points, inwards, low, middle).where(is_wall)


def errors(grid: VoxelGrid, truth: Truth, points: Array) -> Row:
    """Returns the errors of the grid's distances at the points near the surface [mm]."""
    exact = truth.distances(points)
    near = np.abs(exact) < NEAR
    wrong = np.abs(grid.distances(points[near]) - exact[near])
    return {
        "error_mean": float(wrong.mean()), "error_p99": float(np.quantile(wrong, 0.99)),
        "error_max": float(wrong.max()), "error_points": int(near.sum()),
    }


def lost_walls(grid: VoxelGrid, walls: Walls) -> Row:
    """Returns, for walls thinner than some cells, their number and the fraction whose middle is free."""
    free = grid.distances(walls.middle) >= 0.0
    row: Row = {}
    for cells in CELLS_THICK:
        thin = 2 * walls.half < cells * grid.cell
        row[f"walls_{cells}_cells"] = int(thin.sum())
        row[f"lost_{cells}_cells"] = float(free[thin].mean()) if thin.any() else None
    return row


def pushes_at(
    truth: Truth, walls: Walls, random: np.random.Generator, loops: int
) -> tuple[Array, Array]:
    """Returns the start of each tip before a wall, if it is free there, and its desired motion in each cycle."""
    room = truth.distances(walls.front - START * walls.inwards)
    walls = walls.where(room > 0.5 * START)
    walls = walls.where(random.permutation(len(walls.half))[:loops])
    slide = np.cross(walls.inwards, random.normal(size=walls.inwards.shape))
    slide *= SLIDE / np.linalg.norm(slide, axis=1, keepdims=True)
    return walls.front - START * walls.inwards, PUSH * walls.inwards + slide


def pushed(
    new_rule: Callable[[], Rule], truth: Truth, starts: Array, wanted: Array
) -> Row:
    """Pushes tips at walls. Returns how many enter, how deep, and the step times."""
    tips = np.empty((len(starts), CYCLES + 1, 3))
    tips[:, 0] = starts
    times = []
    for loop, desired in enumerate(wanted):
        rule = new_rule()
        for cycle in range(CYCLES):
            begun = time.perf_counter_ns()
            motion = rule.step(tips[loop, cycle], desired)
            times.append(time.perf_counter_ns() - begun)
            tips[loop, cycle + 1] = tips[loop, cycle] + motion
    distance = np.array([truth.distances(of_loop) for of_loop in tips])
    inside = distance < 0.0
    out_again = np.maximum.accumulate(inside, axis=1) & ~inside
    return {
        "loops": len(tips), "entered": int(sum(map(truth.entered, tips))),
        "passed": int(out_again.any(axis=1).sum()),
        "deepest": float(np.maximum(0.0, -distance).max()), "least_distance": float(distance.min()),
        "below_half_margin": int((distance.min(axis=1) < 0.1).sum()),
        "measured_step_us": float(np.median(times)) * 1e-3,
    }


def findings(rows: list[Row], scale: Scale) -> Findings:
    table = Table(
        "A grid of distances, and the mesh itself",
        ["anatomy", "mode", "error mean / 99 % / max [mm]", "walls lost, < 1 / 2 / 4 cells",
         "memory, box / all [MB]", "built in [s]", "step [µs]", "entered / passed", "deepest [mm]",
         "thicker walls: entered"],
        [[
            row["anatomy"], figures.label(row["mode"]), _errors(row), _lost(row),
            f"{row['memory'] / 1e6:.1f} / {row['memory_whole'] / 1e6:.0f}",
            f"{row['measured_build_s']:.2f}", f"{row['measured_step_us']:.1f}",
            f"{row['entered']} / {row['passed']} of {row['loops']}", f"{row['deepest']:.2f}",
            f"{row['thicker_entered']} of {row['thicker_loops']}",
        ] for row in rows],
        f"The values are for a box of {2 * HALF_BOX:g} mm, placed where most thin walls are. Errors are those within "
        f"{NEAR:g} mm of the surface. A wall is lost if the field is free in the middle of the wall. The tip pushes "
        f"at walls thinner than {THIN:g} mm; in the last column, at walls of {THIN:g} to {THICKEST:g} mm. "
        "Passed: the tip entered and came out again. Steps with grids run in Python. Those of the other rules run in "
        "C++, called from Python.",
    )
    fields = [row for row in rows if row["mode"] in CELLS]
    ours = [row for row in rows if row["mode"] == "certified"]
    entered, loops = sum(row["entered"] for row in fields), sum(row["loops"] for row in fields)
    headline = (
        f"An operator pushed a tip at walls thinner than {THIN:g} mm. Under distance fields, the tip entered in "
        f"{entered} of {loops} loops, at most {max(row['deepest'] for row in fields):.2f} mm deep. Under certified, "
        f"it entered in {sum(row['entered'] for row in ours)} of {sum(row['loops'] for row in ours)}.")
    return Findings(headline, _claims(rows), [table], [_figure(rows)])


def _errors(row: Row) -> str:
    if "cell" not in row:
        return "-"
    return f"{row['error_mean']:.3f} / {row['error_p99']:.2f} / {row['error_max']:.2f}"


def _lost(row: Row) -> str:
    shares = [row.get(f"lost_{cells}_cells") for cells in CELLS_THICK]
    return " / ".join("-" if share is None else f"{100 * share:.0f} %" for share in shares)


def _claims(rows: list[Row]) -> list[Claim]:
    """Compares how often each field lets the tip in with certified: Fisher's exact test, then Holm."""
    counts = {}
    for mode in MODES:
        own = [row for row in rows if row["mode"] == mode]
        entered = sum(row["entered"] for row in own)
        counts[mode] = (entered, sum(row["loops"] for row in own) - entered)
    p_values = [
        float(stats.fisher_exact([counts[mode], counts["certified"]])[1]) for mode in CELLS
    ]
    said = {mode: f"{inside} of {inside + outside}" for mode, (inside, outside) in counts.items()}
    fewest = min(inside for inside, _ in counts.values())
    best = ", ".join(figures.label(mode) for mode in MODES if counts[mode][0] == fewest)
    return [
        Claim(
            f"loops at thin walls that enter: {figures.label(mode)} {said[mode]}", "-",
            said["paper"], said["certified"], best,
            f"p = {p:.2g}, field against certified (Fisher, Holm)",
            "p is only approximate. It assumes independent loops, but some loops push at the same wall, and all modes "
            "use the same walls")
        for mode, p in zip(CELLS, holm(p_values))
    ]


def _figure(rows: list[Row]) -> Figure:
    fig, (left, right) = figures.new(160, 95, columns=2)
    lines = ("-", "--", ":", "-.", (0, (1, 5)))  # at least as many as FULL_ANATOMY
    for anatomy, line in zip(sorted({row["anatomy"] for row in rows}), lines):
        own = [row for row in rows if row["anatomy"] == anatomy]
        fields = [row for row in own if row["mode"] in CELLS]
        fields.sort(key=lambda row: float(row["cell"]))
        cells = [row["cell"] for row in fields]
        for part, marker in (("error_p99", "o"), ("error_max", "x")):
            left.plot(cells, [row[part] for row in fields], color="black", linestyle=line,
                      marker=marker, label=f"{anatomy}, {'99 %' if marker == 'o' else 'largest'}")
        right.plot(cells, [row["memory_whole"] / 1e6 for row in fields], color="black",
                   linestyle=line, marker="o", label=f"{anatomy}, grid")
        index = next(row for row in own if row["mode"] == "certified")
        right.plot(cells, [index["memory_whole"] / 1e6] * len(cells), linestyle=line,
                   color=figures.color("certified"), label=f"{anatomy}, index of the mesh")
    left.set(xscale="log", yscale="log", ylabel="error near the surface [mm]")
    left.set_yticks([0.05, 0.1, 0.2, 0.5], ["0.05", "0.1", "0.2", "0.5"])
    right.set(xscale="log", yscale="log", ylabel="memory, whole mesh [MB]")
    for ax in (left, right):
        ax.set_xlabel("voxel [mm]")
        ax.set_xticks(list(CELLS.values()), [f"{cell:g}" for cell in CELLS.values()])
        ax.minorticks_off()
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return Figure(
        "error_and_memory", "Error and memory of a distance field",
        "Left: the error of the field within 2 mm of the surface. Right: the memory of the field. The certified rule "
        "queries the mesh, so its distances do not depend on a voxel.", figures.svg(fig))
