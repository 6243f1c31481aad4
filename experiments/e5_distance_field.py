# SPDX-License-Identifier: BSD-3-Clause
"""E5: what a guarantee costs: distance fields beside the mesh itself, where anatomy is thin.

Most systems use a distance field today. A field that is inflated by its largest error can be trusted, but refuses free
space. A finer grid refuses less, and costs memory and time. E5 works on closed meshes of anatomy, in the box with the
most thin walls. It measures the free space that a field refuses, its memory, and its build and step time. It counts how
often a tip enters that pushes at such walls. Other rules push at the same walls, among them vector-field inequalities
with other primitives and gains than in the other experiments. Li et al. (2020) have no such experiment. The aneurysm of
the sample meshes is open at its ends: it has no inside, so it is not used.
"""
from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import keepout
import keepout_peers
import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from . import figures
from .anatomy import mesh_file
from .experiment import Array, Claim, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import holm, sign_p
from .modes import BUILT_IN, make_rule
from .rules import native
from .rules.rule import Rule, Task

NAME = "e5_distance_field"
TITLE = "E5 What a guarantee costs: distance fields at thin walls"

ANATOMY = ("skull", "airway")
FULL_ANATOMY = ("skull", "airway", "brain")
#: Meshes of hollow anatomy: the tool is inside, and everything around it is solid.
HOLLOW = ("airway",)

CELLS = (1.0, 0.5, 0.25)  # of the fields [mm]
#: The uses of a field: benchmarks/native/rules/distance_field_rule.h. The mode distance_field of the other experiments
#: cuts at the finest cell.
USES = {"plane": "one plane", "cut": "cut at the margin", "sure": "inflated to a proof"}
OURS = "certified"

#: The rules without a grid, by name: the modes of the other experiments, and further vector-field inequalities.
RULES: dict[str, Callable[[Task], Any]] = {
    **{mode: partial(make_rule, mode) for mode in (
        OURS, "paper", "closest_points_2007", "vector_field", "fcl_slide", "bullet_slide") if mode in BUILT_IN},
    "vector_field, gain 0.2": partial(native.closest_points, obstacles="nearest", gain=0.2),
    "vector_field, all triangles": partial(native.closest_points, obstacles="all"),
    "vector_field, all triangles, gain 0.2": partial(native.closest_points, obstacles="all", gain=0.2),
}

MARGIN = 0.2  # [mm]
HALF_BOX = 16.0  # of the sampled box [mm]
INNER = 12.5  # of the part with the tested walls and distances [mm]
NEAR = 2.0  # free space is that up to this far from the surface [mm]
THICKEST = 4.0  # thickest wall [mm]
THIN = 1.0  # walls thinner than this are tested separately [mm]
OPPOSED = 1.9  # of 2: the distance between the front and back contacts of a ball in a wall, in radii
ONE_WALL = 3.0  # places this close are on one wall, also through others [mm]
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
        self.judge = native.terrain_of(mesh).judge()
        self._sign = -1.0 if mesh.inspect().inside_out else 1.0

    def distances(self, points: Array) -> Array:
        """Returns the distances of (n, 3) points; negative in the solid."""
        signed: Array = self._sign * self.judge.distances(points)
        return signed


@dataclass(frozen=True)
class Pushes:
    """The start of each tip before a wall, and its desired motion in each cycle, (n, 3); and the number of the wall."""

    starts: Array
    desired: Array
    wall: NDArray[Any]


def units(scale: Scale) -> list[Unit]:
    return [
        Unit(anatomy, {
            "anatomy": anatomy, "seed": scale.seed, "samples": 20_000 if scale.full else 4000,
            "loops": 150 if scale.full else 60, "cells": CELLS,
        }, alone=True)
        for anatomy in (FULL_ANATOMY if scale.full else ANATOMY)
    ]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each rule, and for each use of each field. Lengths in mm, memory in bytes, fractions of 1."""
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
    task = Task(mesh, MARGIN, float(np.hypot(PUSH, SLIDE)) * (1.0 + 1e-9))  # a sphere as large as the longest motion

    def row_of(mode: str, rule: Rule, more: Row) -> Row:
        beside = pushed(rule, truth, thicker)
        about: Row = {"anatomy": asked["anatomy"], "mode": mode, "triangles": len(mesh), **more}
        thick: Row = {f"thicker_{name}": beside[name] for name in ("loops", "entered", "deepest")}
        return about | pushed(rule, truth, thin) | thick

    memory = {"memory": index.memory, "memory_whole": index.memory, "refused": 0.0, "measured_build_s": built}
    rows = [row_of(mode, make(task), memory) for mode, make in RULES.items()]
    for cell in asked["cells"]:
        field = native.field_of(mesh, cell, MARGIN)
        begun = time.perf_counter()
        in_box = field.sample(center - HALF_BOX, center + HALF_BOX)
        built = time.perf_counter() - begun
        about = {"cell": cell, "memory": in_box, "memory_whole": field.memory_of_all(), "measured_build_s": built,
                 **errors(field, truth, places)}
        for use in USES:
            margin = MARGIN + (field.error_bound if use == "sure" else 0.0)
            refused = {"refused": refused_space(field, truth, places, margin)}
            rule = native.distance_field(task, cell=cell, use=use)
            rows.append(row_of(f"field_{use}_{cell:g}", rule, {"use": use} | about | refused))
    return rows


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


def errors(field: Any, truth: Truth, points: Array) -> Row:
    """Returns the errors of the field's distances at the points within its band [mm]."""
    exact, found = truth.distances(points), field.distances(points)
    near = np.abs(exact) < MARGIN + field.error_bound
    wrong = np.abs(found[near] - exact[near])
    return {"error_p99": float(np.quantile(wrong, 0.99)), "error_max": float(wrong.max()), "error_points": len(wrong)}


def refused_space(field: Any, truth: Truth, points: Array, margin: float) -> float:
    """Returns the fraction of the free space near the surface that a field with an enlarged margin refuses.

    Free space: the points whose exact distance is at least MARGIN and at most NEAR.
    """
    exact = truth.distances(points)
    free = points[(exact >= MARGIN) & (exact <= NEAR)]
    return float((field.distances(free) < margin).mean())


def pushes_at(truth: Truth, walls: Walls, random: np.random.Generator, loops: int) -> Pushes:
    """Returns pushes at the walls that have free space in front of them, at most `loops`.

    Places closer than ONE_WALL to each other are on one wall, also if other places connect them.
    """
    room = truth.distances(walls.front - START * walls.inwards)
    walls = walls.where(room > 0.5 * START)
    walls = walls.where(random.permutation(len(walls.half))[:loops])
    slide = np.cross(walls.inwards, random.normal(size=walls.inwards.shape))
    slide *= SLIDE / np.linalg.norm(slide, axis=1, keepdims=True)
    near = cKDTree(walls.front).sparse_distance_matrix(cKDTree(walls.front), ONE_WALL)
    _, wall = connected_components(near, directed=False)
    return Pushes(walls.front - START * walls.inwards, PUSH * walls.inwards + slide, wall)


def pushed(rule: Rule, truth: Truth, pushes: Pushes) -> Row:
    """Pushes tips at walls. Returns the walls of the tips that enter, how deep they get, and the step time."""
    found = [
        keepout_peers.push(truth.judge, rule, keepout_peers.SteadyPusher(desired), start, margin=MARGIN,
                           cycles=CYCLES, cycles_inside=CYCLES)
        for start, desired in zip(pushes.starts, pushes.desired)
    ]
    asked = sum(loop["free_asked"] for loop in found)
    return {
        "loops": len(found), "walls": len(set(pushes.wall.tolist())),
        "entered": [int(wall) for wall, loop in zip(pushes.wall, found) if loop["entered"]],
        "deepest": max(loop["depth"] for loop in found), "least_distance": min(loop["clearance"] for loop in found),
        "lost": sum(loop["free_lost"] for loop in found) / asked if asked else None,
        "measured_step_us": float(np.median([1e6 * loop["seconds"] / loop["steps"] for loop in found])),
    }


def findings(rows: list[Row], scale: Scale) -> Findings:
    fields = [row for row in rows if "cell" in row]
    others = [row for row in rows if "cell" not in row]
    ours = [row for row in rows if row["mode"] == OURS]
    p_values = _p_values(rows)
    cost = Table(
        "The costs of a guarantee",
        ["anatomy", "field", "cell [mm]", "entered", "free space refused", "memory, box / all [MB]", "built in [s]",
         "step [µs]", "error 99 % / max [mm]", "p"],
        [[
            row["anatomy"], USES[row["use"]] if "cell" in row else _label(row["mode"]),
            f"{row['cell']:g}" if "cell" in row else "-", _entered([row]), f"{100 * row['refused']:.1f} %",
            f"{row['memory'] / 1e6:.1f} / {row['memory_whole'] / 1e6:.0f}", f"{row['measured_build_s']:.2f}",
            f"{row['measured_step_us']:.1f}",
            f"{row['error_p99']:.3f} / {row['error_max']:.2f}" if "cell" in row else "-",
            f"{p_values[row['mode']]:.2g}" if "cell" in row else "-",
        ] for row in [*ours, *fields]],
        f"Entered: loops in which the tip entered, of all loops at walls thinner than {THIN:g} mm. Refused: the "
        f"fraction of the space between {MARGIN:g} and {NEAR:g} mm from the surface in which a tip may not be. Memory "
        f"and build time of a field are for a box of {2 * HALF_BOX:g} mm; its memory is also that of the whole mesh, "
        "in a narrow band. A field has exact distances, which take longer to build than approximate ones. Memory and "
        "build time of the certified rule are for the index of the whole mesh. All steps run in C++. p: of "
        "equal loops with certified, over all anatomies (McNemar, a wall counts once; Holm).",
    )
    beside = Table(
        "Rules at thin and thicker walls",
        ["anatomy", "rule", "entered", "deepest [mm]", f"walls of {THIN:g} to {THICKEST:g} mm: entered",
         "free motion lost", "step [µs]"],
        [[
            row["anatomy"], _label(row["mode"]), _entered([row]), f"{row['deepest']:.2f}",
            f"{len(row['thicker_entered'])} of {row['thicker_loops']}",
            "-" if row["lost"] is None else f"{100 * row['lost']:.2f} %", f"{row['measured_step_us']:.1f}",
        ] for row in [*others, *fields]],
        f"The tip pushes by {PUSH:g} mm a cycle into a wall and {SLIDE:g} mm along it, for {CYCLES} cycles. The motion "
        "sphere of the paper's rule is as large as the motion.",
    )
    finest = [row for row in fields if row["cell"] == min(CELLS)]
    sure, cut = ([row for row in finest if row["use"] == use] for use in ("sure", "cut"))
    headline = (
        f"A field of {min(CELLS):g} mm that is inflated to a proof refuses {_range(sure)} of the free space near the "
        f"surface and enters {_entered(sure)} loops. Cut at the margin without a proof, it refuses {_range(cut)} and "
        f"enters {_entered(cut)} loops. Certified refuses none and enters {_entered(ours)} loops.")
    return Findings(headline, _claims(rows), [cost, beside], [_figure(rows)])


def _label(mode: str) -> str:
    """Returns the label of a rule: that of the mode, with the variant."""
    mode, *variant = mode.split(", ")
    if mode.startswith("field_"):
        _, use, cell = mode.split("_")
        return f"distance field {cell} mm, {USES[use]}"
    return ", ".join([figures.label(mode), *variant])


def _entered(rows: list[Row]) -> str:
    return f"{sum(len(row['entered']) for row in rows)} of {sum(row['loops'] for row in rows)}"


def _range(rows: list[Row]) -> str:
    low, high = (100 * of(row["refused"] for row in rows) for of in (min, max))
    return f"{low:.1f} %" if f"{low:.1f}" == f"{high:.1f}" else f"{low:.1f} to {high:.1f} %"


def _p_values(rows: list[Row]) -> dict[str, float]:
    """Returns the p of each field: does it let in as many tips as certified does? After Holm."""
    of = {mode: [row for row in rows if row["mode"] == mode] for mode in dict.fromkeys(row["mode"] for row in rows)}
    fields = [mode for mode in of if "cell" in of[mode][0]]
    return dict(zip(fields, holm([walls_test(of[mode], of[OURS]) for mode in fields])))


def _claims(rows: list[Row]) -> list[Claim]:
    """Returns the loops and the refused space of the two uses of the finest field that compete with certified."""
    p_values = _p_values(rows)
    ours = [row for row in rows if row["mode"] == OURS]
    claims = []
    for use in ("cut", "sure"):
        mode = f"field_{use}_{min(CELLS):g}"
        field = [row for row in rows if row["mode"] == mode]
        ranks = {label: (sum(len(row["entered"]) for row in own), sum(row["refused"] for row in own))
                 for label, own in ((_label(mode), field), (_label(OURS), ours))}
        claims.append(Claim(
            f"loops at thin walls that enter, and free space refused: {_label(mode)}: {_entered(field)} loops, "
            f"{_range(field)}",
            "-", "-", f"{_entered(ours)} loops, {_range(ours)}",
            ", ".join(label for label, rank in ranks.items() if rank == min(ranks.values())),
            f"p = {p_values[mode]:.2g} for the loops (McNemar, a wall counts once; Holm over {len(p_values)} fields)"))
    return claims


def walls_test(ours: list[Row], theirs: list[Row]) -> float:
    """Returns the exact two-sided p of McNemar's test in which a wall counts once.

    Both rules have the same loops at the same walls. A wall counts for the rule that let in more tips there, and not
    at all if both let in as many. Without a difference between the rules, each counts with probability 1/2.
    """
    more = less = 0
    for row, beside in zip(ours, theirs):
        for wall in set(row["entered"]) | set(beside["entered"]):
            difference = row["entered"].count(wall) - beside["entered"].count(wall)
            more += difference > 0
            less += difference < 0
    return sign_p(more, less)


#: The line of each use of a field in the figure.
_LINES = {"plane": ":", "cut": "--", "sure": "-"}


def _figure(rows: list[Row]) -> Figure:
    fig, axes = figures.new(170, 110, columns=2)
    markers = ("o", "s", "^")  # at least as many as FULL_ANATOMY
    for anatomy, marker in zip(dict.fromkeys(row["anatomy"] for row in rows), markers):
        own = [row for row in rows if row["anatomy"] == anatomy]
        ours = next(row for row in own if row["mode"] == OURS)
        for use, line in _LINES.items():
            fields = [row for row in own if row.get("use") == use]
            look: dict[str, Any] = {"color": figures.color("distance_field"), "linestyle": line, "marker": marker,
                    "label": f"{anatomy}, {USES[use]}"}
            refused = [100 * row["refused"] for row in fields]
            memory = [row["memory_whole"] / 1e6 for row in fields]
            axes[0].plot(refused, [100 * len(row["entered"]) / row["loops"] for row in fields], **look)
            if use == "sure":
                axes[1].plot(memory, refused, **look)
        look = {"color": figures.color(OURS), "linestyle": "none", "marker": marker, "markersize": 8,
                "label": f"{anatomy}, certified"}
        axes[0].plot([0.0], [100 * len(ours["entered"]) / ours["loops"]], **look)
        axes[1].plot([ours["memory_whole"] / 1e6], [0.0], **look)
    axes[0].set(xlabel="free space refused [%]", ylabel="loops entered [%]", title="Safety against freedom")
    axes[1].set(xlabel="memory, whole mesh [MB]", ylabel="free space refused [%]", xscale="log",
                title="Price of a proof")
    axes[1].xaxis.set_major_formatter("{x:g}")
    axes[1].minorticks_off()
    handles = axes[0].get_legend_handles_labels()[0]
    for ax, half in zip(axes, (handles[: len(handles) // 2], handles[len(handles) // 2 :])):
        ax.legend(handles=half, loc="upper left", bbox_to_anchor=(0.0, -0.25))
    return Figure(
        "e5_price_of_a_proof", "The costs of a guarantee",
        f"Points of a line are cells of {', '.join(f'{cell:g}' for cell in CELLS)} mm. Left: an ideal rule is at the "
        "origin. Right: fields that are inflated to a proof, and the certified rule, which queries the mesh.",
        figures.svg(fig))
