# SPDX-License-Identifier: BSD-3-Clause
"""E1: does each rule keep a point out of each shape, at any step length? (section IV-A: out of all 11 shapes)

A simulated operator tries to push the tip through the surface, in loops with the same starts and seeds for every mode.
Loops differ in the longest motion of a cycle, and have the same total displacement. Seven routes lead into corners,
past rims and saddles, and through sheets (benchmarks/native/push.h). The judge, which shares no code with keepout,
judges each step exactly. The best safe step, found by branch and bound, shows how much motion a rule lost. Only
closed shapes are used: around the border of an open shape, a tip may pass and come back from behind.
"""
from __future__ import annotations

from functools import lru_cache
from typing import Any

import keepout
import keepout_peers
import numpy as np

from . import figures
from .experiment import Claim, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import Interval, share, sign_p
from .modes import MODES, NO_FIXTURE, make_rule
from .rules.native import terrain_of
from .rules.rule import Task

NAME = "e1_validation"
TITLE = "E1 Validation on shapes, by step length (section IV-A)"

#: The rule of Li et al. (2020) as printed, without a margin; "paper" has the margin of all others. The motion sphere
#: of both is the longest step. In the third variant it is 5 mm at any step length.
AS_PUBLISHED = "paper_published"
LARGE_SPHERE = "paper_5mm"
LARGE_RADIUS = 5.0  # [mm]
OURS = "certified"

MARGIN = 0.2  # [mm]
LENGTHS = (0.01, 0.05, 0.2, 1.0, 5.0)  # the longest motion of a cycle [mm]
WAY = 20.0  # total commanded displacement of a loop [mm]
HEIGHT = 2.0  # of the highest start above the surface [mm]
INSIDE_WAY = 5.0  # displacement of a tip that has entered [mm]
BEST_STEPS = 1  # of a loop, to compare with the best safe step

#: The shapes of a quick run: small ones of each kind, and the skull.
QUICK_SHAPES = ("cube", "sphere", "concave_sphere", "pyramid", "gear", "thin_plates", "star_bumps",
                "cortex", "far_cube", "pinion", "femur", "skull")

#: Loops of a shape, a mode and a step length, and more loops of the certified rule in a full run.
LOOPS, FULL_LOOPS, MORE_LOOPS = 7, 70, 280

E1_MODES = (*MODES[:MODES.index("paper")], AS_PUBLISHED, "paper", LARGE_SPHERE, *MODES[MODES.index("paper") + 1:])


def units(scale: Scale) -> list[Unit]:
    """Returns a unit for each shape and mode, shape by shape, so that a process reuses what it has read."""
    shapes = [name for name, _ in keepout_peers.named_meshes()] if scale.full else QUICK_SHAPES
    loops = {mode: FULL_LOOPS if scale.full else LOOPS for mode in E1_MODES}
    if scale.full:
        loops[OURS] = MORE_LOOPS
    return [
        Unit(f"{shape}_{mode}", {"shape": shape, "mode": mode, "loops": loops[mode], "seed": scale.seed})
        for shape in shapes
        for mode in E1_MODES
    ]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each step length; no row for an open shape, and one with `refused` if the rule rejects it."""
    shape, mode = unit.settings["shape"], unit.settings["mode"]
    mesh, judge = _surface(shape)
    if not judge.closed:
        return []
    rows = []
    for length in LENGTHS:
        about: Row = {"shape": shape, "mode": mode, "step_mm": length}
        try:
            rows.append(about | _loops(unit, length, mesh, judge))
        except ValueError as refusal:
            return [about | {"refused": str(refusal)}]
    return rows


@lru_cache(maxsize=1)
def _surface(shape: str) -> tuple[keepout.Mesh, Any]:
    mesh = keepout.Mesh(*keepout_peers.named_mesh(shape))
    return mesh, terrain_of(mesh).judge()


def _loops(unit: Unit, length: float, mesh: keepout.Mesh, judge: Any) -> Row:
    """Returns the sums over all loops of a shape, a mode and a step length."""
    asked = unit.settings
    terrain = terrain_of(mesh)
    found = []
    task, rule = _rule(asked["mode"], length, mesh)
    for number in range(asked["loops"]):
        route = keepout_peers.ROUTES[number % len(keepout_peers.ROUTES)]
        key = [asked["seed"], number, round(1000 * length), *asked["shape"].encode()]
        seeds = np.random.SeedSequence(key).generate_state(3, np.uint64).tolist()
        start = keepout_peers.start(terrain, route, 1.5 * MARGIN, HEIGHT, seeds[0])
        found.append(keepout_peers.push(
            judge, rule, keepout_peers.PointPusher(terrain, route, length, seeds[1]), start, margin=task.margin,
            cycles=round(WAY / length), cycles_inside=round(INSIDE_WAY / length), best_steps=BEST_STEPS,
            seed=seeds[2]))
    sums = {name: sum(loop[name] for loop in found)
            for name in ("steps", "unsafe", "free_asked", "free_lost", "excess", "excess_of")}
    return {
        "loops": len(found), "entered": [number for number, loop in enumerate(found) if loop["entered"]], **sums,
        "deepest": max(loop["depth"] for loop in found), "clearance": min(loop["clearance"] for loop in found),
    }


def _rule(mode: str, length: float, mesh: keepout.Mesh) -> tuple[Task, Any]:
    margin = 0.0 if mode == AS_PUBLISHED else MARGIN
    task = Task(mesh, margin=margin, radius=LARGE_RADIUS if mode == LARGE_SPHERE else length)
    return task, make_rule(_base(mode), task)


def findings(rows: list[Row], scale: Scale) -> Findings:
    """Returns which modes kept the tip out, and how much motion they lost, at each step length."""
    modes = list(dict.fromkeys(row["mode"] for row in rows))
    of = {mode: [row for row in rows if row["mode"] == mode and "refused" not in row] for mode in modes}
    fixtures = [mode for mode in modes if mode != NO_FIXTURE]
    never = [mode for mode in fixtures if not _entered(of[mode]) and _shapes(of[mode]) == _shapes(rows)]
    least = min((_percent(of[mode]) for mode in never), default="")
    claims = [
        Claim(
            about="shapes that the tip never entered, and loops in which it entered (IV-A)",
            paper="11 of 11 shapes",
            reproduction=_told(of[AS_PUBLISHED]),
            certified=_told(of[OURS]),
            best=", ".join(map(_label, never)) or "none",
            sure=_mcnemar(of[AS_PUBLISHED], of[OURS]),
            note=f"best: the modes in which the tip never entered; over all step lengths, {LENGTHS[0]:g} to "
            f"{LENGTHS[-1]:g} mm",
        ),
        Claim(
            about="free motion that is lost (IV-A)",
            paper="-",
            reproduction=_percent(of[AS_PUBLISHED]),
            certified=_percent(of[OURS]),
            best=", ".join(_label(mode) for mode in never if _percent(of[mode]) == least) or "none",
            sure=_sign_test(of[AS_PUBLISHED], of[OURS]),
            note="best: of the modes in which the tip never entered. Their rule adds planes of all triangles in the "
            "sphere, also of those that the motion does not reach",
        ),
    ]
    steps = sum(row["steps"] for row in of[OURS])
    headline = (
        f"Certified: in {steps:,} steps on {len(_shapes(of[OURS]))} closed shapes, with steps of {LENGTHS[0]:g} to "
        f"{LENGTHS[-1]:g} mm. The tip entered in {_rate(of[OURS])} loops, and {_percent(of[OURS])} of the free "
        f"motion was lost. The paper's rule as printed: {_rate(of[AS_PUBLISHED])} loops, "
        f"{_percent(of[AS_PUBLISHED])} lost.")
    return Findings(headline, claims, [_by_length(of), _overview(of), _by_shape(of)], [_picture(of)])


def _loop_count(rows: list[Row]) -> int:
    return sum(row["loops"] for row in rows)


def _entered(rows: list[Row]) -> int:
    return sum(len(row["entered"]) for row in rows)


def _shapes(rows: list[Row]) -> list[str]:
    return list(dict.fromkeys(row["shape"] for row in rows))


def _rate_of(rows: list[Row]) -> Interval:
    """Returns the fraction of loops that enter, with its 95 % interval."""
    return share(_entered(rows), _loop_count(rows))


def _rate(rows: list[Row]) -> str:
    rate = _rate_of(rows)
    return f"{_entered(rows)} of {_loop_count(rows)} [{100 * rate.low:.2g}, {100 * rate.high:.2g} %]"


def _told(rows: list[Row]) -> str:
    shapes = _shapes(rows)
    kept = sum(not _entered([row for row in rows if row["shape"] == shape]) for shape in shapes)
    return f"{kept} of {len(shapes)} shapes, {_rate(rows)} loops"


def _ratio(rows: list[Row], part: str, whole: str) -> float:
    total = float(sum(row[whole] for row in rows))
    return float(sum(row[part] for row in rows)) / total if total else float("nan")


def _percent(rows: list[Row], part: str = "free_lost", whole: str = "free_asked") -> str:
    value = 100.0 * _ratio(rows, part, whole)
    return "-" if np.isnan(value) else f"{value:.2f} %"


def _mcnemar(ours: list[Row], theirs: list[Row]) -> str:
    """Returns the exact two-sided test of the pairs of loops with the same shape, step length and seed."""
    other = {(row["shape"], row["step_mm"]): row for row in theirs}
    pairs = only_first = only_second = 0
    for row in ours:
        beside = other.get((row["shape"], row["step_mm"]))
        if beside is None:
            continue
        both = min(row["loops"], beside["loops"])
        first, second = ({n for n in each["entered"] if n < both} for each in (row, beside))
        pairs += both
        only_first += len(first - second)
        only_second += len(second - first)
    if only_first + only_second == 0:
        return f"no loop of {pairs} differs"
    p = sign_p(only_first, only_second)
    return f"McNemar, {only_first} against {only_second} of {pairs} loops, p = {p:.2g}"


def _sign_test(ours: list[Row], theirs: list[Row]) -> str:
    """Returns the two-sided sign test over shapes: does the first rule lose more free motion than the second?"""
    lost = [[_ratio([row for row in rows if row["shape"] == shape], "free_lost", "free_asked")
             for rows in (ours, theirs)] for shape in _shapes(ours)]
    more, less = sum(a > b + 1e-9 for a, b in lost), sum(a < b - 1e-9 for a, b in lost)
    if more + less == 0:
        return "no shape differs"
    p = sign_p(more, less)
    return f"sign test, more on {more} shapes, less on {less}, p = {p:.2g}"


def _at(rows: list[Row], length: float) -> list[Row]:
    return [row for row in rows if row["step_mm"] == length]


def _by_length(of: dict[str, list[Row]]) -> Table:
    def cell(rows: list[Row]) -> str:
        return f"{_rate(rows)}; {_percent(rows)}" if rows else "-"

    lines = [[_label(mode), *(cell(_at(rows, length)) for length in LENGTHS)] for mode, rows in of.items()]
    note = ("Loops in which the tip entered, with the 95 % interval of Clopper and Pearson; then the free motion that "
            "the rule did not allow.")
    return Table("Loops entered and free motion lost, by step length",
                 ["mode", *(f"{length:g} mm" for length in LENGTHS)], lines, note)


def _overview(of: dict[str, list[Row]]) -> Table:
    lines = [[
        _label(mode), f"{sum(row['steps'] for row in rows):,}", _told(rows),
        f"{max(row['deepest'] for row in rows):.2f}", f"{min(row['clearance'] for row in rows):.3g}",
        _percent(rows), _percent(rows, "excess", "excess_of") if mode != NO_FIXTURE else "-",
    ] for mode, rows in of.items() if rows]
    note = (f"A loop has {WAY:g} mm of commanded motion. A tip that entered goes on for {INSIDE_WAY:g} mm. Lost: free "
            "motion that the rule did not allow. Excess: how much more limited safe steps differ from the desired "
            "motion than the best safe step does, relative to the desired motion.")
    columns = ["mode", "steps", "never entered, entered", "deepest [mm]", "least clearance [mm]", "lost", "excess"]
    return Table("Modes over all closed shapes and step lengths", columns, lines, note)


def _by_shape(of: dict[str, list[Row]]) -> Table:
    shapes = _shapes([row for rows in of.values() for row in rows])

    def cell(rows: list[Row]) -> str:
        return f"{_entered(rows)}/{_loop_count(rows)}" if rows else "refused"

    lines = [[shape, *(cell([row for row in rows if row["shape"] == shape]) for rows in of.values())]
             for shape in shapes]
    return Table("Loops in which the tip entered, of all loops", ["shape", *map(_label, of)], lines)


#: The line of each variant of the rule of Li et al. in the figure; others are solid.
_LINES = {AS_PUBLISHED: ":", LARGE_SPHERE: "--"}
#: The marker of each rule that is not keepout's, also for print without colors; others have circles.
_MARKERS = {"closest_points_2007": "v", "vector_field": "^", "distance_field": "s", "fcl_slide": "D", "bullet_slide": "P"}


def _picture(of: dict[str, list[Row]]) -> Figure:
    fig, (upper, middle, lower) = figures.new(170, 205, rows=3)
    for place, (mode, rows) in enumerate(of.items()):
        aside = 1.05 ** (place - len(of) / 2)  # so that intervals do not cover each other
        lengths = [length for length in LENGTHS if _at(rows, length)]
        across = [aside * length for length in lengths]
        look = {"color": figures.color(_base(mode)), "linestyle": _LINES.get(mode, "-"),
                "marker": _MARKERS.get(mode, "o"), "linewidth": 2.6 if mode == OURS else 1.2,
                "zorder": 3 if mode == OURS else 2}
        rates = [_rate_of(_at(rows, n)) for n in lengths]
        upper.plot(across, [100 * rate.value for rate in rates], label=_label(mode), **look)
        upper.vlines(across, [100 * rate.low for rate in rates], [100 * rate.high for rate in rates],
                     color=look["color"], linewidth=1.0, alpha=0.6)
        if mode != NO_FIXTURE:
            for ax, part, whole in ((middle, "free_lost", "free_asked"), (lower, "excess", "excess_of")):
                ax.plot(across, [100 * _ratio(_at(rows, n), part, whole) for n in lengths], **look)
    upper.set(ylabel="loops entered [%]", title="Safety")
    middle.set(ylabel="free motion lost [%]", title="Freedom in free space")
    lower.set(ylabel="excess of limited steps [%]", title="Freedom at the surface", xlabel="longest step [mm]")
    for ax in (upper, middle, lower):
        ax.set(xscale="log", xlim=(0.7 * LENGTHS[0], 1.4 * LENGTHS[-1]))
        ax.set_xticks(LENGTHS, [f"{length:g}" for length in LENGTHS])
        ax.minorticks_off()
    lower.legend(*upper.get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, -0.22), ncol=3)
    caption = ("Above: loops in which the tip entered, with 95 % intervals. Middle: free motion that the rule did not "
               "allow. Below: how much more limited safe steps differ from the desired motion than the best safe step "
               "does. All loops have the same commanded displacement. An ideal rule is zero in all panels.")
    return Figure("e1_by_step_length", "Loops entered and free motion lost, by step length", caption, figures.svg(fig))


def _base(mode: str) -> str:
    """Returns the mode of a variant."""
    return "paper" if mode in (AS_PUBLISHED, LARGE_SPHERE) else mode


def _label(mode: str) -> str:
    own = {AS_PUBLISHED: "the paper's, no margin", LARGE_SPHERE: "the paper's, sphere 5 mm"}
    return own.get(mode) or figures.label(mode)
