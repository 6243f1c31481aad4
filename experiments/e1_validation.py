# SPDX-License-Identifier: BSD-3-Clause
"""E1: does each rule keep a point out of each shape? (section IV-A: out of all 11 shapes)

A simulated hand tries to push the tip through the surface, in loops with the same seeds for every mode. The judge,
which shares no code with keepout, decides if the tip entered. The best safe step, found by branch and bound, shows
how much motion a rule lost. Only closed shapes count: around the border of an open shape, a tip may pass and come
back from behind. Rules that guard one side allow that.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from time import perf_counter
from typing import Any

import keepout
import numpy as np
from scipy.stats import binomtest

from . import figures
from .experiment import Claim, Figure, Findings, Row, Scale, Table, Unit
from .modes import FIXTURES, MODES, make_rule
from .point_hand import ROUTES, PointHand, place_outside
from .rules.rule import Rule, Task

NAME = "e1_validation"
TITLE = "E1 Validation on shapes (section IV-A)"

#: The rule of Li et al. (2020) as printed, without a margin; "paper" has the margin of all others.
AS_PUBLISHED = "paper_published"
MARGIN = 0.2  # [mm]
REACH = 2.0 * MARGIN  # limit of computed clearances [mm]
#: Without a margin a tip may lie on the surface; closer than this, it counts as on it. [mm]
TOUCH = 1e-6

#: The shapes of a quick run: small ones of each kind, and the skull.
QUICK_SHAPES = ("cube", "sphere", "concave_sphere", "pyramid", "gear", "thin_plates", "star_bumps",
                "cortex", "far_cube", "pinion", "femur", "saddle_terrain", "skull")
#: A shape takes minutes to sample as finely as these; E5 has these fields.
WITHOUT = ("sdf_0.25", "sdf_0.5")

CYCLES = 300  # of a loop
LOOPS = 10  # of a shape and a mode; twice as many in a full run
BEST_STEPS = 3  # of a loop, to compare with the best safe step

#: The rows of a shape and a mode.
Loops = dict[tuple[str, str], list[Row]]


def units(scale: Scale) -> list[Unit]:
    """Returns a unit for each shape and mode, shape by shape, so that a process reuses what it has read."""
    import keepout_peers

    shapes = [name for name, _ in keepout_peers.named_meshes()] if scale.full else QUICK_SHAPES
    modes = [mode for mode in (*MODES, AS_PUBLISHED) if mode not in WITHOUT]
    loops = LOOPS * (2 if scale.full else 1)
    return [
        Unit(f"{shape}_{mode}", {"shape": shape, "mode": mode, "loops": loops, "seed": scale.seed})
        for shape in shapes
        for mode in modes
    ]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each loop; a single row with `refused` if a rule rejects the shape."""
    shape, mode = unit.settings["shape"], unit.settings["mode"]
    index, judge = _surface(shape)
    margin = 0.0 if mode == AS_PUBLISHED else MARGIN
    task = Task(index.mesh, margin=margin)
    rows: list[Row] = []
    for number in range(unit.settings["loops"]):
        about: Row = {"shape": shape, "mode": mode, "loop": number}
        random = np.random.default_rng([unit.settings["seed"], number, *shape.encode()])
        try:
            rule = make_rule("paper" if mode == AS_PUBLISHED else mode, task, index)
            start = place_outside(index, 1.5 * MARGIN, 2.0, random)
        except ValueError as refusal:
            return [about | {"refused": str(refusal)}]
        route = ROUTES[number % len(ROUTES)]
        rows.append(about | _loop(index, judge, rule, task, start, route, random))
    return rows


@lru_cache(maxsize=1)
def _surface(shape: str) -> tuple[keepout.Index, Any]:
    import keepout_peers

    vertices, triangles = keepout_peers.named_mesh(shape)
    mesh = keepout.Mesh(vertices, triangles)
    return keepout.Index(mesh), keepout_peers.Judge(vertices, triangles)


def _loop(
    index: keepout.Index, judge: Any, rule: Rule | None, task: Task, start: np.ndarray, route: str,
    random: np.random.Generator,
) -> Row:
    """Runs one loop: a tip that starts outside, a hand, a rule, and the judge's findings."""
    longest = task.radius * 10.0 ** random.uniform(-2.0, 0.0)  # [mm]
    tip = start
    sample = random.random(CYCLES)  # selects the steps to compare with the best
    hand = PointHand(index, route, longest, random)
    tips, asked = np.empty((CYCLES + 1, 3)), np.empty((CYCLES, 3))
    tips[0] = tip
    seconds = 0.0
    for cycle in range(CYCLES):
        desired = asked[cycle] = hand.next(tip)
        begun = perf_counter()
        motion = desired if rule is None else rule.step(tip, desired)
        seconds += perf_counter() - begun
        tips[cycle + 1] = tip = tip + motion
    return {"route": route, "longest": longest, **_judged(judge, tips, asked, sample, task.margin),
            "measured_step_us": 1e6 * seconds / CYCLES}


def _judged(
    judge: Any, tips: np.ndarray, asked: np.ndarray, sample: np.ndarray, margin: float
) -> Row:
    """Returns if the tip of a loop entered, its depth and clearance, and the motion lost until it entered."""
    starts, ends = tips[:-1], tips[1:]
    distances = judge.distances(tips)  # below 0 inside; inside is free if the normals point inwards
    clearances = np.minimum(judge.least_distances(starts, ends, REACH), REACH)
    depths = -np.sign(distances[0]) * distances
    entered = clearances == 0.0
    if margin == 0.0:  # a tip that touches may still be outside
        clear = np.abs(distances) > TOUCH
        entered = (entered & clear[:-1] & clear[1:]) | (judge.closed & (depths[1:] > TOUCH))
    before = int(entered.argmax()) if entered.any() else len(asked)
    kept = np.minimum(margin, np.abs(distances[:-1]))[:before]  # a tip that is closer may stay so
    lost = np.linalg.norm(ends - starts - asked, axis=1)[:before]
    length = np.linalg.norm(asked, axis=1)[:before]
    room = judge.least_distances(starts[:before], starts[:before] + asked[:before], REACH)
    free = (room >= margin) & (room > 0.0) & (length > 0.0)
    safe = (clearances[:before] >= kept * (1.0 - 1e-6)) & (clearances[:before] > 0.0)
    limited = np.flatnonzero(~free & safe & (length > 0.0) & (distances[:-1][:before] != 0.0))
    excess = []
    for i in limited[np.argsort(sample[limited])][:BEST_STEPS]:
        _, cost, _ = judge.best_step(starts[i], asked[i], float(kept[i]))
        excess.append((lost[i] - cost) / length[i])
    return {
        "closed": judge.closed,
        "crossed": bool(entered.any()),
        "depth": float(max(0.0, depths.max())) if judge.closed else None,
        "clearance": float(clearances.min()),
        "unsafe": int((~safe).sum()),
        "free_asked": float(length[free].sum()),
        "free_lost": float(lost[free].sum()),
        "excess": float(np.sum(excess)),
        "excess_of": len(excess),
    }


def findings(rows: list[Row], scale: Scale) -> Findings:
    """Returns which modes kept the tip out of which shapes, and how much motion they lost."""
    shapes = list(dict.fromkeys(row["shape"] for row in rows))
    modes = list(dict.fromkeys(row["mode"] for row in rows))
    loops: Loops = {(s, m): [] for s in shapes for m in modes}
    for row in rows:
        if "refused" not in row:
            loops[row["shape"], row["mode"]].append(row)
    closed = [s for s in shapes if any(r["closed"] for m in modes for r in loops[s, m])]
    counted = {m: [row for s in closed for row in loops[s, m]] for m in modes}

    def told(mode: str) -> str:
        tried = [s for s in closed if loops[s, mode]]
        kept = sum(_crossed(loops[s, mode]) == 0 for s in tried)
        got_in, of = _crossed(counted[mode]), len(counted[mode])
        return f"{kept} of {len(tried)} shapes, {got_in} of {of} loops"

    safe = [m for m in modes if m in FIXTURES and not _crossed(counted[m])
            and all(loops[s, m] for s in closed)]
    best = min(safe, key=lambda m: _excess(counted[m]), default=None)
    claims = [
        Claim(
            about="shapes that the tip never entered, and loops in which it entered (IV-A)",
            paper="11 of 11 shapes",
            reproduction=told(AS_PUBLISHED),
            certified=told("certified"),
            best=figures.label(best) if best else "none",
            sure=_mcnemar(counted[AS_PUBLISHED], counted["certified"]),
            note="best: the mode with the least excess of all modes in which the tip never entered",
        ),
        Claim(
            about="free motion that is lost (IV-A)",
            paper="-",
            reproduction=_number(100 * _lost(counted[AS_PUBLISHED]), 1, " %"),
            certified=_number(100 * _lost(counted["certified"]), 1, " %"),
            best=figures.label(min(safe, key=lambda m: _lost(counted[m]))) if safe else "none",
            sure=_sign_test(closed, loops),
            note="the rule adds planes of all triangles in the sphere, also of those that the motion does not reach",
        ),
    ]
    headline = (f"Counts of closed shapes that the tip never entered, and of loops in which it entered. "
                f"The paper's rule as printed: {told(AS_PUBLISHED)}; it loses "
                f"{claims[1].reproduction} of the free motion. Certified: {told('certified')}; "
                f"it loses {claims[1].certified}.")
    tables = [_overview(modes, counted, told), _by_shape(shapes, closed, modes, loops)]
    return Findings(headline, claims, tables, [_picture(shapes, modes, loops)])


def _crossed(loops: list[Row]) -> int:
    return sum(row["crossed"] for row in loops)


def _excess(loops: list[Row]) -> float:
    """Returns the mean of (|u - u_desired| - that of the best safe step) / |u_desired|, of safe steps."""
    steps = sum(row["excess_of"] for row in loops)
    return sum(row["excess"] for row in loops) / steps if steps else float("nan")


def _lost(loops: list[Row]) -> float:
    asked = sum(row["free_asked"] for row in loops)
    return sum(row["free_lost"] for row in loops) / asked if asked else float("nan")


def _mcnemar(ours: list[Row], theirs: list[Row]) -> str:
    """Returns the exact two-sided test of pairs of loops with the same shape and seed."""
    other = {(row["shape"], row["loop"]): row["crossed"] for row in theirs}
    pairs = [(row["crossed"], other[row["shape"], row["loop"]]) for row in ours
             if (row["shape"], row["loop"]) in other]
    only_first = sum(a and not b for a, b in pairs)
    only_second = sum(b and not a for a, b in pairs)
    if only_first + only_second == 0:
        return "no loop differs"
    p = binomtest(only_first, only_first + only_second).pvalue
    return f"McNemar, {only_first} against {only_second} of {len(pairs)} loops, p = {p:.2g}"


def _sign_test(closed: list[str], loops: Loops) -> str:
    """Returns the two-sided sign test over shapes: does the printed rule lose more free motion than the certified
    one?"""
    lost = [(_lost(loops[s, AS_PUBLISHED]), _lost(loops[s, "certified"])) for s in closed]
    more, less = sum(a > b + 1e-9 for a, b in lost), sum(a < b - 1e-9 for a, b in lost)
    if more + less == 0:
        return "no shape differs"
    p = binomtest(more, more + less).pvalue
    return f"sign test, more on {more} shapes, less on {less}, p = {p:.2g}"


def _number(value: float, digits: int, unit: str = "") -> str:
    return "-" if np.isnan(value) else f"{value:.{digits}f}{unit}"


def _deepest(loops: list[Row]) -> float:
    return max((row["depth"] for row in loops if row["depth"] is not None), default=float("nan"))


def _overview(
    modes: list[str], counted: dict[str, list[Row]], told: Callable[[str], str]
) -> Table:
    rows = []
    for mode in modes:
        loops = counted[mode]
        rows.append([
            _label(mode), told(mode), f"{_deepest(loops):.2f}",
            f"{min((row['clearance'] for row in loops), default=float('nan')):.3g}",
            _number(100 * _lost(loops), 2, " %"),
            _number(100 * _excess(loops), 1, " %") if mode in (*FIXTURES, AS_PUBLISHED) else "-",
        ])
    note = (f"Closed shapes that the tip never entered, and loops of {CYCLES} cycles in which it entered. "
            "Lost: free motion that the rule did not allow. Excess: how much more limited safe steps differ from the "
            "desired motion than the best safe step does, relative to the desired motion.")
    columns = ["mode", "never entered, entered", "deepest [mm]", "least clearance [mm]", "lost",
               "excess"]
    return Table("Modes over all closed shapes", columns, rows, note)


def _by_shape(shapes: list[str], closed: list[str], modes: list[str], loops: Loops) -> Table:
    def cell(of: list[Row]) -> str:
        if not of:
            return "refused"
        deepest = f", {_deepest(of):.1f} mm" if _deepest(of) > 0.0 else ""
        return f"{_crossed(of)}/{len(of)}{deepest}" if _crossed(of) else "0"

    rows = [
        [shape if shape in closed else f"{shape} (open)", *(cell(loops[shape, m]) for m in modes)]
        for shape in shapes
    ]
    note = ("Number of loops with a crossing / number of loops, and the greatest depth of the tip. "
            "Open shapes do not count.")
    columns = ["shape", *map(_label, modes)]
    return Table("Loops in which the tip crossed the surface", columns, rows, note)


def _picture(shapes: list[str], modes: list[str], loops: Loops) -> Figure:
    fig, ax = figures.new(170, 30 + 6.5 * len(shapes))
    for column, mode in enumerate(modes):
        shares = np.array([_crossed(loops[s, mode]) / max(1, len(loops[s, mode])) for s in shapes])
        ax.scatter(np.full(len(shapes), column), range(len(shapes)), s=150.0 * shares,
                   color=figures.color(_of_look(mode)))
    ax.set_xticks(range(len(modes)), [_label(mode) for mode in modes], rotation=35, ha="right",
                  rotation_mode="anchor")
    ax.set_yticks(range(len(shapes)), shapes)
    ax.set_xlim(-0.6, len(modes) - 0.4)
    ax.set_ylim(len(shapes) - 0.4, -0.6)
    caption = ("The area of a dot is the fraction of loops in which the tip crossed the surface. "
               "Without a dot, the tip never crossed it.")
    return Figure("e1_crossings", "Loops in which the tip entered", caption, figures.svg(fig))


def _of_look(mode: str) -> str:
    return "paper" if mode == AS_PUBLISHED else mode


def _label(mode: str) -> str:
    return "the paper's, no margin" if mode == AS_PUBLISHED else figures.label(mode)
