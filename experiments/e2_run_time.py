# SPDX-License-Identifier: BSD-3-Clause
"""E2: the time of a step against the number of triangles, and where it exceeds 1 ms (IV-B).

`keepout bench` times the product: each rule on each index, on a bunny of 150 mm that is resampled to each size. A
tool presses on the surface and slides along it by 0.05 to 0.2 mm a step; each step is compared with a reference before
it is timed. A cell has PARTS parts of PART steps. A part has four strokes of 50 steps, at independent places. Steps of
a stroke depend on each other, so intervals are over the medians of the parts.

The run of Li et al. (2020) is the rule `paper` on `pd_tree_1997`, their tree as published. They do not give the motion
sphere of their figure: ours are of 5 mm, as in their section V, and as long as the longest step. `certified` searches
as far as a motion goes, without a sphere. FACTORS separates index, sphere and rule.
"""
from __future__ import annotations

import json
import math
import os
import subprocess
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import keepout
import numpy as np
from matplotlib.axes import Axes
from scipy import stats

from . import figures, published
from .experiment import Claim, Figure, Findings, Row, Scale, Table, Unit
from .hypothesis_tests import UNKNOWN, Interval

NAME = "e2_run_time"
TITLE = "E2 Run time against triangles (section IV-B)"

SIZES = (51_978, 200_000)
FULL_SIZES = (
    51_978, 104_000, 200_000, 500_000, 989_376, 2_000_000, 4_000_000, 8_000_000)
#: The steps of a part, and the parts of a cell. The range of 6 medians contains the true one with 96.9 %.
PART = 200
PARTS = 6
#: Up to this size, each part is timed in a process of its own. A process compares a sample of its steps with brute
#: force first, which takes a minute on 8 million triangles. So there one process times all parts.
FEW_TRIANGLES = 200_000

#: For comparison only, one part, up to LARGEST_OF_SLOW triangles: a query tests every triangle, or needs much memory.
SLOW_INDICES = ("brute_force", "fcl_collide")
LARGEST_OF_SLOW = 60_000
#: Indices of other libraries need up to 560 bytes a triangle: only up to LARGEST_OF_OTHERS triangles.
LARGEST_OF_OTHERS = 1_000_000

_STEPS = (f"A cell is the median of at least {PARTS * PART:,} steps, or it states its n. In brackets is the 95 % "
          f"interval over the medians of parts. A part has {PART} steps: four strokes at independent places. Steps of a stroke "
          f"depend on each other. Up to {FEW_TRIANGLES:,} triangles, {PARTS} parts of the rules of Li et al. and certified "
          "on pd_tree_1997 and wide_bvh have a process each. All other parts of a cell are in one process, so their "
          "interval does not include differences between processes")
LONGEST_STEP = 0.2  # of `keepout bench` [mm]

#: A rule, an index, and the radius of the motion sphere [mm]; None: as far as the motion goes.
Way = tuple[str, str, float | None]

REPRODUCTION: Way = ("paper", "pd_tree_1997", 5.0)
OURS: Way = ("certified", "wide_bvh", None)
#: From the reproduction to ours, one change at a time.
FACTORS: tuple[tuple[str, Way], ...] = (
    ("index", ("paper", "wide_bvh", 5.0)),
    ("sphere as long as the longest step", ("paper", "wide_bvh", LONGEST_STEP)),
    ("rule", OURS),
)

#: The indices of FACTORS; the rules and radii of all cells.
OF_FACTORS = ["pd_tree_1997", "wide_bvh"]
RADII = f"5,{LONGEST_STEP}"


def units(scale: Scale) -> list[Unit]:
    """Returns the units of each size, each of one process; in a full run also those of all indices."""
    planned: list[Unit] = []

    def add(size: int, indices: list[str], steps: int, rules: str = "paper,certified") -> None:
        number = sum(unit.settings["triangles"] == size for unit in planned)
        planned.append(Unit(f"triangles_{size}_run{number}", {
            "triangles": size, "indices": indices, "rules": rules, "queries": steps, "seed": scale.seed, "run": number,
        }, alone=True))

    for size in FULL_SIZES if scale.full else SIZES:
        for _ in range(PARTS if size <= FEW_TRIANGLES else 0):
            add(size, OF_FACTORS, PART)
        if scale.full and size <= LARGEST_OF_OTHERS:
            names = [part.name for part in keepout.indices()]
            add(size, [name for name in names if name not in SLOW_INDICES], PARTS * PART, "all_faces,paper,certified")
            if size <= LARGEST_OF_SLOW:
                add(size, [name for name in names if name in SLOW_INDICES], PART, "all_faces,paper,certified")
        elif size > FEW_TRIANGLES:
            add(size, OF_FACTORS, PARTS * PART)
    return planned


def run(unit: Unit) -> list[Row]:
    """Returns a row for each rule, index and radius. Raises RuntimeError with the message of `keepout bench`."""
    asked = unit.settings
    with TemporaryDirectory() as folder:
        record = Path(folder) / "record.json"
        command = [
            os.environ["KEEPOUT_COMMAND"], "bench", "--triangles", str(asked["triangles"]),
            "--index", ",".join(asked["indices"]), "--activation", asked["rules"], "--radius", RADII,
            "--queries", str(asked["queries"]), "--seed", str(asked["seed"] * (PARTS + 2) + asked["run"]),
            "--seconds", "3600",  # all queries, however long they take, so that rows are reproducible
            "--json", str(record), "--out", str(record.with_suffix(".html")),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"keepout bench: {done.stderr.strip()}")
        return [{"run": asked["run"]} | row for row in rows_of(json.loads(record.read_text()))]


def rows_of(record: Row) -> list[Row]:
    """Returns the rows of a record of `keepout bench`; times in µs, memory in bytes."""
    machine = record["machine"]
    rows: list[Row] = []
    for row in record["benchmark"]["rows"]:
        step = row["step_us"] or {}
        rows.append({
            "triangles": row["triangles"], "rule": row["activation"], "index": row["index"],
            "radius": row["radius"], "steps": row["queries"], "verified": row["verified"],
            "in_reach": row["hits_mean"], "planes": row["planes_mean"],
            "unsolved_share": row["unsolved_share"],
            "memory": round(row["bytes_per_triangle"] * row["triangles"]), "hash": row["hash"],
            "measured_medians_us": row["step_medians_us"], "measured_p50_us": step.get("p50"),
            "measured_p99_us": step.get("p99"), "measured_max_us": step.get("max"),
            "measured_build_s": row["build_s"], "measured_remark": row["remark"],
            "measured_others_cores": record["benchmark"]["others_cores"],
            "measured_machine": f"{machine['processor']}, {machine['simd']}, {machine['compiler']}",
        })
    return rows


def triangles_at(curve: Sequence[tuple[int, float]], khz: float = 1.0) -> float | None:
    """Returns the triangles at which a curve of (triangles, kHz) first falls below a rate; None if it does not.

    Interpolates on logarithmic axes. Returns the first point if it is already below.
    """
    if curve and curve[0][1] < khz:
        return float(curve[0][0])
    for (few, fast), (many, slow) in zip(curve, curve[1:]):
        if slow < khz <= fast:
            share = math.log(fast / khz) / math.log(fast / slow)
            return float(few * (many / few) ** share)
    return None


#: The rate of each part of a cell [kHz], by the process and the number of the part in it.
Parts = dict[tuple[int, int], float]
#: For each way, its cells by the number of triangles, ascending.
Timed = dict[Way, dict[int, Parts]]
Curve = list[tuple[int, float]]


def findings(rows: list[Row], scale: Scale) -> Findings:
    khz = timed(rows)
    sizes = sorted({row["triangles"] for row in rows})
    curves = {way: curve(of) for way, of in khz.items()}
    parts = [(name, factor(khz, before, after, sizes[-1])) for name, before, after in _changes()]
    headline = (
        f"From the rule of Li et al. on their tree, with a sphere of 5 mm, to certified, on {sizes[-1]:,} triangles. "
        f"{' '.join(f'The {name} makes a step {_text(times)} times as fast.' for name, times in parts)} "
        f"The certified rule makes steps at {_khz(dict(curves[OURS])[sizes[-1]])} kHz there.")
    return Findings(headline, _claims(khz, curves),
                    [_factor_table(khz, sizes), _rate_table(rows, khz, curves, sizes), _slow_table(rows, sizes)],
                    [_figure(curves), _factor_figure(khz, sizes)])


def timed(rows: list[Row]) -> Timed:
    """Returns the rates of the parts for each rule, index and radius, by the number of triangles."""
    rates: Timed = {}
    for row in sorted(rows, key=lambda row: (int(row["triangles"]), int(row["run"]))):
        parts = {(row["run"], number): 1e3 / us for number, us in enumerate(row["measured_medians_us"])}
        if parts:
            rates.setdefault(_way_of(row), {}).setdefault(row["triangles"], {}).update(parts)
    return rates


def median(of: Iterable[float]) -> Interval:
    """Returns the median with its 95 % interval: the number of values below the true median is binomial.

    The interval is between two of the values. It is NaN for fewer than six independent values.
    """
    values = np.sort(list(of))
    if not len(values):
        return UNKNOWN
    rank = int(stats.binom.ppf(0.025, len(values), 0.5))
    low, high = (values[rank - 1], values[-rank]) if rank else (UNKNOWN.low, UNKNOWN.high)
    return Interval(float(np.median(values)), float(low), float(high))


def factor(khz: Timed, before: Way, after: Way, size: int) -> Interval:
    """Returns how many times as fast `after` is as `before`, over parts with the same motions."""
    fast, slow = (khz.get(way, {}).get(size, {}) for way in (after, before))
    return median(fast[part] / slow[part] for part in fast if part in slow)


def curve(of: dict[int, Parts]) -> Curve:
    """Returns (triangles, median rate of the parts)."""
    return [(size, median(parts.values()).value) for size, parts in of.items()]


def _way_of(row: Row) -> Way:
    return row["rule"], row["index"], row["radius"]


def _changes() -> list[tuple[str, Way, Way]]:
    ways = [REPRODUCTION, *(way for _, way in FACTORS)]
    return [(name, before, after) for (name, after), before in zip(FACTORS, ways)]


def _factor_table(khz: Timed, sizes: list[int]) -> Table:
    return Table(
        "From the rule of Li et al. on their tree to certified: what each change gains",
        ["change", "from", "to", *(f"{size:,}" for size in sizes)],
        [[name, _way(before), _way(after), *(_text(factor(khz, before, after, size)) for size in sizes)]
         for name, before, after in [*_changes(), ("all three", REPRODUCTION, OURS)]],
        "The cells are ratios of rates: the median of the parts, with its 95 % interval. Both sides of a "
        "factor have the same motions. The rule of Li et al. has no margin here and "
        "certified has one of 0.2 mm, so certified searches farther.",
    )


def _rate_table(rows: list[Row], khz: Timed, curves: dict[Way, Curve], sizes: list[int]) -> Table:
    where = "; ".join(sorted({row["measured_machine"] for row in rows}))
    busy = max(row["measured_others_cores"] or 0.0 for row in rows)
    return Table(
        "Rate of the median step [kHz]",
        ["rule", "index", "sphere", *(f"{size:,}" for size in sizes), "below 1 kHz at"],
        [[rule, index, _sphere(radius), *(_rate(khz[rule, index, radius].get(size)) for size in sizes),
          _fall(curves[rule, index, radius])] for rule, index, radius in _sorted(khz)],
        f"{where}; one thread; other processes kept up to {busy:.1f} cores busy. {_STEPS}. "
        f"'-' means not built or not timed. The indices {' and '.join(SLOW_INDICES)} are only for comparison, "
        f"timed up to {LARGEST_OF_SLOW:,} triangles. Indices of other libraries are timed up to {LARGEST_OF_OTHERS:,}.",
    )


def _slow_table(rows: list[Row], sizes: list[int]) -> Table:
    """Returns the slow steps of the drawn ways: a control loop must bear these."""
    ways = [REPRODUCTION, *(way for _, way in FACTORS)]

    def cell(way: Way, size: int) -> str:
        of = [row for row in rows if _way_of(row) == way and row["triangles"] == size and row["measured_p99_us"]]
        return (f"{np.median([row['measured_p99_us'] for row in of]):.3g} / "
                f"{max(row['measured_max_us'] for row in of):.3g}") if of else "-"

    return Table(
        "Slow steps: 99 % and maximum [µs]",
        ["rule", "index", "sphere", *(f"{size:,}" for size in sizes)],
        [[rule, index, _sphere(radius), *(cell((rule, index, radius), size) for size in sizes)]
         for rule, index, radius in ways],
        "The median of the processes' 99 % quantiles, and the longest step of all processes. A maximum includes "
        "interruptions by the operating system.",
    )


def _sorted(khz: Timed) -> list[Way]:
    return sorted(khz, key=lambda way: (way[0], -(way[2] or 0), way[1]))


def _sphere(radius: float | None) -> str:
    return "motion" if radius is None else f"{radius:g} mm"


def _way(way: Way) -> str:
    return f"{way[0]} on {way[1]}" + ("" if way[2] is None else f", {way[2]:g} mm")


def _khz(rate: float | None) -> str:
    if rate is None:
        return "-"
    return f"{rate:,.0f}" if rate >= 100.0 else f"{rate:.3g}"


def _rate(parts: Parts | None) -> str:
    """Returns the rate of a cell, with the number of its steps if they are fewer than 1,000."""
    if not parts:
        return "-"
    steps = len(parts) * PART
    return _text(median(parts.values())) + (f" (n = {steps})" if steps < 1000 else "")


def _text(of: Interval) -> str:
    """Returns a median with its interval, if there is one; `-` for NaN."""
    if not np.isfinite(of.value):
        return "-"
    return _khz(of.value) + (f" [{_khz(of.low)}, {_khz(of.high)}]" if np.isfinite(of.low) else "")


def _fall(points: Curve) -> str:
    at = triangles_at(points)
    if at is None:
        return f"> {points[-1][0]:,}"
    return f"< {points[0][0]:,}" if at == points[0][0] else f"{float(f'{at:.2g}'):,.0f}"


def _claims(khz: Timed, curves: dict[Way, Curve]) -> list[Claim]:
    sure = f"medians of {PARTS * PART:,} steps or more; each step is bitwise identical to the reference"
    authors = [rate for rate in published.AUTHORS_CODE if rate.radius == 5.0]
    claims = []
    for printed, measured in zip(published.RATES, (authors[0], authors[-1])):
        here = {way: of[printed.triangles] for way, of in khz.items() if printed.triangles in of}
        if not here:
            continue
        claims.append(Claim(
            f"rate at {printed.triangles:,} triangles (IV-B)", f"{printed.khz:g} kHz",
            f"{_rate(here.get(REPRODUCTION))} kHz", f"{_rate(here.get(OURS))} kHz", _fastest(here), sure,
            f"another processor, and another program: the authors' published code makes {measured.khz:g} kHz (one "
            "core, g++ 12; no record names the machine). Ours is at 5 mm; Li et al. do not give their radius",
        ))
    claims.append(Claim(
        "triangles at 1 kHz (IV-B)", f"about {published.TRIANGLES_AT_1_KHZ:,}",
        _fall(curves[REPRODUCTION]), _fall(curves[OURS]), "not compared: most ways stay above 1 kHz", sure,
        f"the authors' published code falls below 1 kHz at "
        f"{_fall([(rate.triangles, rate.khz) for rate in authors])} triangles in our measurement; no record names its "
        "machine",
    ))
    return claims


def _fastest(here: dict[Way, Parts]) -> str:
    """Returns the fastest way; a tie if the intervals of the two fastest overlap, or if one has no interval."""
    of = {way: median(parts.values()) for way, parts in here.items()}
    first, second = sorted(of, key=lambda way: -of[way].value)[:2]
    told = [f"{_way(way)}, {_rate(here[way])} kHz" for way in (first, second)]
    return told[0] if of[first].low > of[second].high else f"none beats the next: {'; '.join(told)}"


def _figure(curves: dict[Way, Curve]) -> Figure:
    fig, ax = figures.new(150, 110)
    drawn = [(REPRODUCTION, "-"), *zip((way for _, way in FACTORS), ("--", ":", "-"))]
    for (rule, index, radius), line in drawn:
        _plot(ax, curves[rule, index, radius], f"{figures.label(rule)}, {index}, {_sphere(radius)}",
              color=figures.color(rule), marker="o", linestyle=line)
    printed = [(rate.triangles, rate.khz) for rate in published.RATES]
    _plot(ax, printed, "the paper, as printed", color="black", marker="s", linestyle="none")
    authors = [(rate.triangles, rate.khz) for rate in published.AUTHORS_CODE if rate.radius == 5.0]
    _plot(ax, authors, "the authors' code, on ours", color="black", marker="x", linestyle=":")
    ax.axhline(1.0, color="black", linewidth=0.8)
    ax.set(xscale="log", yscale="log", xlabel="triangles", ylabel="rate of the median step [kHz]")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncol=2)
    return Figure(
        "rate", "Rate against triangles",
        "The meshes are bunnies of 150 mm, and steps are 0.05 to 0.2 mm long. The lines change index, sphere and rule "
        "one after another. Below the line at 1 kHz, a loop is too slow. Li et al. used an Intel Core i7-8700.",
        figures.svg(fig))


def _factor_figure(khz: Timed, sizes: list[int]) -> Figure:
    """Draws the factors of index, sphere and rule, with their intervals."""
    fig, axes = figures.new(160, 60, columns=len(FACTORS))
    for ax, (name, before, after) in zip(axes, _changes()):
        known = [(size, of) for size in sizes if np.isfinite((of := factor(khz, before, after, size)).value)]
        color = figures.color(after[0])
        for size, of in known:
            ax.plot([size, size], [of.low, of.high], color=color, linewidth=1.0)
        ax.plot([size for size, _ in known], [of.value for _, of in known], "o-", color=color)
        ax.axhline(1.0, color="black", linewidth=0.8)
        ax.set(xscale="log", yscale="log", xlabel="triangles", ylim=(0.1, 300.0),
               title=textwrap.fill(name, 20))
    axes[0].set_ylabel("times as fast")
    return Figure(
        "rate_factors", "Index, sphere and rule as factors of the rate",
        f"Each point is the median factor of the parts, with its 95 % interval. The changes follow each other: "
        f"{_way(REPRODUCTION)}, "
        f"then {', then '.join(_way(way) for _, way in FACTORS)}.",
        figures.svg(fig))


def _plot(ax: Axes, points: Iterable[tuple[int, float]], label: str, **look: str) -> None:
    triangles, khz = zip(*points)
    ax.plot(triangles, khz, label=label, **look)
