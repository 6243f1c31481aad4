# SPDX-License-Identifier: BSD-3-Clause
"""E2: the rate of a control loop against the number of triangles, and where it falls below 1 kHz (IV-B).

`keepout bench` times the product: each rule on each index, on a bunny of 150 mm that is resampled to each size. A
tool presses on the surface and slides along it; each step is compared with a reference before it is timed. The run of
Li et al. (2020) is the rule `paper` on `pd_tree_1997`, their tree as published. They do not give the motion sphere of
their figure: ours is of 5 mm, as in their section V, and of 1 mm. `certified` searches as far as a motion goes,
without a sphere.
"""
from __future__ import annotations

import json
import math
import os
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import keepout
from matplotlib.axes import Axes

from . import figures, published
from .experiment import Claim, Figure, Findings, Row, Scale, Table, Unit

NAME = "e2_run_time"
TITLE = "E2 Run time against triangles (section IV-B)"

SIZES = (51_978, 200_000, 989_376)
FULL_SIZES = (
    51_978, 104_000, 200_000, 500_000, 989_376, 2_000_000, 4_000_000, 16_000_000)
#: Above this size fewer steps are timed, because the slowest take tens of milliseconds.
MANY_TRIANGLES = 1_000_000

#: For comparison only, up to LARGEST_OF_SLOW triangles: a query tests every triangle, or needs much memory.
SLOW_INDICES = ("brute_force", "fcl_collide")
LARGEST_OF_SLOW = 60_000
#: Indices of other libraries need up to 560 bytes a triangle: only up to LARGEST_OF_OTHERS triangles.
OUR_INDICES = ("wide_bvh", "pd_tree", "pd_tree_1997")
LARGEST_OF_OTHERS = 2_000_000

REPRODUCTION = ("paper", "pd_tree_1997", 5.0)
OURS = ("certified", "wide_bvh", None)


def units(scale: Scale) -> list[Unit]:
    return [
        Unit(f"triangles_{size}", {
            "triangles": size, "indices": _indices(size), "seed": scale.seed,
            "queries": 200 if size > MANY_TRIANGLES else 1000 if scale.full else 500,
        }, alone=True)
        for size in (FULL_SIZES if scale.full else SIZES)
    ]


def run(unit: Unit) -> list[Row]:
    """Returns a row for each rule, index and radius. Raises RuntimeError with the message of `keepout bench`."""
    asked = unit.settings
    with TemporaryDirectory() as folder:
        record = Path(folder) / "record.json"
        command = [
            os.environ["KEEPOUT_COMMAND"], "bench", "--triangles", str(asked["triangles"]),
            "--index", ",".join(asked["indices"]), "--activation", "all_faces,paper,certified",
            "--radius", "5,1", "--queries", str(asked["queries"]), "--seed", str(asked["seed"]),
            "--seconds", "3600",  # all queries, however long they take, so that rows are reproducible
            "--json", str(record), "--out", str(record.with_suffix(".html")),
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"keepout bench: {done.stderr.strip()}")
        return rows_of(json.loads(record.read_text()))


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
            "measured_khz": row["rate_khz"], "measured_p50_us": step.get("p50"),
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


def findings(rows: list[Row], scale: Scale) -> Findings:
    curves = _curves(rows)
    sizes = sorted({row["triangles"] for row in rows})
    ours, theirs = curves[OURS], curves[REPRODUCTION]
    ratio = dict(ours)[sizes[-1]] / dict(theirs)[sizes[-1]]
    where = "; ".join(sorted({row["measured_machine"] for row in rows}))
    busy = max(row["measured_others_cores"] or 0.0 for row in rows)
    rate = _khz(dict(ours)[sizes[-1]])
    table = Table(
        "Rate of the median step [kHz]",
        ["rule", "index", "sphere", *(f"{size:,}" for size in sizes), "below 1 kHz at"],
        [
            [rule, index, "motion" if radius is None else f"{radius:g} mm",
             *(_khz(dict(curve).get(size)) for size in sizes), _fall(curve)]
            for (rule, index, radius), curve in sorted(
                curves.items(), key=lambda entry: (entry[0][0], -(entry[0][2] or 0), entry[0][1]))
        ],
        f"{where}; one thread; other processes kept up to {busy:.1f} cores busy. '-' means not built or "
        f"not timed. The indices {' and '.join(SLOW_INDICES)} are only for comparison, and timed up to "
        f"{LARGEST_OF_SLOW:,} triangles. Indices of other libraries are timed up to {LARGEST_OF_OTHERS:,}.",
    )
    headline = (
        f"On {sizes[-1]:,} triangles the certified rule makes steps at {rate} kHz, {ratio:.0f} "
        f"times as fast as the paper's rule on the paper's tree. The certified rule falls below 1 kHz at "
        f"{_fall(ours)} triangles, the paper's rule at {_fall(theirs)}.")
    return Findings(headline, _claims(rows, curves), [table], [_figure(curves)])


def _indices(size: int) -> list[str]:
    names = [part.name for part in keepout.indices()]
    if size > LARGEST_OF_OTHERS:
        return [name for name in names if name in OUR_INDICES]
    return [name for name in names if name not in SLOW_INDICES or size <= LARGEST_OF_SLOW]


#: A rule, an index, and the radius of the motion sphere [mm]; None: as far as the motion goes.
Way = tuple[str, str, float | None]
Curves = dict[Way, list[tuple[int, float]]]


def _curves(rows: list[Row]) -> Curves:
    """Returns (triangles, kHz) for each rule, index and radius, by ascending number of triangles."""
    curves: Curves = {}
    for row in sorted(rows, key=lambda row: int(row["triangles"])):
        if row["measured_khz"] is not None:
            way = (row["rule"], row["index"], row["radius"])
            curves.setdefault(way, []).append((row["triangles"], row["measured_khz"]))
    return curves


def _way(way: Way) -> str:
    return f"{way[0]} on {way[1]}" + ("" if way[2] is None else f", {way[2]:g} mm")


def _khz(rate: float | None) -> str:
    if rate is None:
        return "-"
    return f"{rate:,.0f}" if rate >= 100.0 else f"{rate:.3g}"


def _fall(curve: list[tuple[int, float]]) -> str:
    at = triangles_at(curve)
    if at is None:
        return f"> {curve[-1][0]:,}"
    return f"< {curve[0][0]:,}" if at == curve[0][0] else f"{float(f'{at:.2g}'):,.0f}"


def _claims(rows: list[Row], curves: Curves) -> list[Claim]:
    steps = min(row["steps"] for row in rows)
    sure = f"medians of {steps:,} steps, each bitwise identical to the reference"
    authors = [rate for rate in published.AUTHORS_CODE if rate.radius == 5.0]
    claims = []
    for printed, timed in zip(published.RATES, (authors[0], authors[-1])):
        here = {way: dict(curve).get(printed.triangles) for way, curve in curves.items()}
        known = {way: rate for way, rate in here.items() if rate is not None}
        best = max(known, key=lambda way: known[way])
        claims.append(Claim(
            f"rate at {printed.triangles:,} triangles (IV-B)", f"{printed.khz:g} kHz",
            f"{_khz(here[REPRODUCTION])} kHz", f"{_khz(here[OURS])} kHz",
            f"{_way(best)}, {_khz(known[best])} kHz", sure,
            f"another processor, and another program: the authors' published code makes "
            f"{timed.khz:g} kHz (one core, g++ 12; no record names the machine). Ours is at 5 mm; the paper does not give its radius",
        ))
    furthest = max(curves, key=lambda way: (triangles_at(curves[way]) or math.inf, curves[way][-1]))
    claims.append(Claim(
        "triangles at 1 kHz (IV-B)", f"about {published.TRIANGLES_AT_1_KHZ:,}",
        _fall(curves[REPRODUCTION]), _fall(curves[OURS]),
        f"{_way(furthest)}, {_fall(curves[furthest])}", sure,
        f"the authors' published code falls below 1 kHz at "
        f"{_fall([(rate.triangles, rate.khz) for rate in authors])} triangles in our measurement; no record names its machine",
    ))
    return claims


def _figure(curves: Curves) -> Figure:
    fig, ax = figures.new(150, 95)
    drawn = [
        (("all_faces", "wide_bvh", 5.0), "--"), (REPRODUCTION, "-"),
        (("paper", "wide_bvh", 5.0), "--"), (("certified", "pd_tree_1997", None), "-"),
        (OURS, "--"),
    ]
    for (rule, index, radius), line in drawn:
        _plot(ax, curves[rule, index, radius], f"{figures.label(rule)}, {index}",
              color=figures.color(rule), marker="o", linestyle=line)
    printed = [(rate.triangles, rate.khz) for rate in published.RATES]
    _plot(ax, printed, "the paper, as printed", color="black", marker="s", linestyle="none")
    timed = [(rate.triangles, rate.khz) for rate in published.AUTHORS_CODE if rate.radius == 5.0]
    _plot(ax, timed, "the authors' code, on ours", color="black", marker="x", linestyle=":")
    ax.axhline(1.0, color="black", linewidth=0.8)
    ax.set(xscale="log", yscale="log", xlabel="triangles", ylabel="rate of the median step [kHz]")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return Figure(
        "rate", "Rate against triangles",
        "The meshes are bunnies of 150 mm. The radius of the motion sphere is 5 mm; certified searches as far as each "
        "motion goes. Below the line, a loop is slower than 1 kHz. Li et al. used an Intel Core i7-8700.",
        figures.svg(fig))


def _plot(ax: Axes, points: Iterable[tuple[int, float]], label: str, **look: str) -> None:
    triangles, khz = zip(*points)
    ax.plot(triangles, khz, label=label, **look)
