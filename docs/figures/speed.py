# SPDX-License-Identifier: BSD-3-Clause
"""The figures of the records of `bench` and `bench --speed`."""

from values import grouped, number, of_kind, share, table


def with_unit(value, unit):
    return f"{number(value)}{'x' if unit == 'x' else f' {unit}'.rstrip()}"


def side(measured):
    times = [measured["us"][key] for key in ("p50", "p99", "p999")]
    in_ms = times[0] >= 1e4
    texts = [number(time * (1e-3 if in_ms else 1.0)) for time in times if time is not None]
    return f"{measured['name']} {' / '.join(texts)}{' ms' if in_ms else ''}"


# Figures that pages print alone, by the start of `work` and `compared`.
NAMED = {
    "step_5": ("whole step, paper's rule, r = 5 mm", ""),
    "step_1": ("whole step, paper's rule, r = 1 mm", ""),
    "contact": ("certified step in contact", ""),
    "free": ("certified step in free space", ""),
    "query_fcl": ("sphere query r = 5 mm", "FCL"),
    "query_embree": ("sphere query r = 5 mm", "Embree"),
    "build_fcl": ("build of the index", "FCL"),
    "build_embree": ("build of the index", "Embree"),
    "first_step": ("binary STL", "(assimp + FCL's tree) / ours"),
    "first_step_cached": ("binary STL", "(assimp + FCL's tree) / ours, with the index cache"),
    "long_motion": ("certified in contact, margin .2 mm", "motion 1-5 mm"),
    "unrelated": ("certified, unrelated states", ""),
    "fine": ("certified, motion 1-5 mm, margin 1.1 mm", "median"),
    "refit": ("refit after all vertices moved", ""),
    "largest": ("file to index, 2 cores", ""),
    "largest_memory": ("file to index, 100 M triangles", "peak of memory"),
    "largest_contact": ("certified in contact, margin .2 mm", "100 M"),
}


def named_rows(rows):
    """Returns the rows of NAMED that exist in the run."""
    found = {}
    for name, (work, compared) in NAMED.items():
        of_it = [row for row in rows if row["work"].startswith(work)
                 and (row["compared"] == compared or not row["compared"].startswith("(assimp"))
                 and row["compared"].startswith(compared)]
        if of_it:
            found[name] = of_it[0]
    return found


def time_of(measured, p="p50"):
    """Returns a time with its unit."""
    time = measured["us"][p]
    if time is None:
        return "-"
    if time >= 1e6:
        return f"{number(time * 1e-6)} s"
    return f"{number(time * 1e-3)} ms" if time >= 1e4 else f"{number(time)} µs"


@of_kind("speed")
def speed(record):
    rows = []
    for row in record["rows"]:
        ((sense, demanded),) = row["demanded"].items()
        figure = row["remark"] or "not measured"
        if row["figure"] is not None:
            figure = with_unit(row["figure"], row["unit"])
            figure = figure if row["met"] else f"**{figure}**"
        unit = "x" if row["unit"] == "x" else f" {row['unit']}".rstrip()
        rows.append([f"{row['work']}: {row['compared']}", f"{sense.replace('_', ' ')} {demanded:g}{unit}", figure,
                     "; ".join(side(measured) for measured in row["sides"])])
    yield "table", table(["work: compared", "demanded", "measured", "made of, µs"], rows, left=4)
    yield "unmet", str(sum(1 for row in record["rows"] if row["figure"] is not None and not row["met"]))
    rows = named_rows(record["rows"])
    for name, row in rows.items():
        yield f"{name}.figure", with_unit(row["figure"], row["unit"])
        for k, side_name in enumerate(("others", "ours")[:len(row["sides"])]):
            for p in ("p50", "p99", "p999"):
                yield f"{name}.{side_name}.{p}", time_of(row["sides"][k], p)
    yield "cold", next(time_of(row["sides"][0]) for row in record["rows"] if "caches emptied" in row["work"])
    histogram = record["histogram"]
    points = ["p50", "p99", "p999", "p9999", "p99999"]
    yield "cycles", table(
        ["at most, µs", "p50", "p99", "p99.9", "p99.99", "p99.999", "longest"],
        [[name, *(number(1e-3 * histogram[key]["at_most_ns"][p]) for p in points),
          number(1e-3 * histogram[key]["longest_ns"])]
         for name, key in (("certified step", "steps"), ("empty loop", "nothing"))])


@of_kind("bench")
def bench(record):
    rows = record["benchmark"]["rows"]
    for (mesh, triangles), of_mesh in grouped(rows, "mesh", "triangles").items():
        yield f"{mesh}{triangles}.indices", index_table(of_mesh)
        yield f"{mesh}{triangles}.solvers", solver_table(of_mesh)
        yield f"{mesh}{triangles}.rules", rule_table(of_mesh)
    for mesh, of_mesh in grouped(rows, "mesh").items():
        if len({row["triangles"] for row in of_mesh}) > 1:
            for radius in sorted({row["radius"] for row in of_mesh if row["radius"]}):
                yield f"{mesh}.sweep_{radius:g}mm", sweep_table([row for row in of_mesh if row["radius"] == radius])
    yield "rows", str(len(rows))
    yield "all", table(
        ["mesh", "triangles", "radius, mm", "index", "rule", "solver", "hits, mean", "planes, mean", "candidates, µs",
         "query, µs", "step, µs", "99 %", "verified"],
        [[row["mesh"], f"{row['triangles']:,}", row["radius"] or "as far as each motion goes", f"`{row['index']}`",
          f"`{row['activation']}`", f"`{row['solver']}`", number(row["hits_mean"]), number(row["planes_mean"]),
          median(row, "collect_us"), median(row, "query_us"), median(row, "step_us"), number(row["step_us"]["p99"]),
          "yes" if row["verified"] else "**no**"] for row in rows], left=6)


def median(row, stage):
    return number(row[stage]["p50"]) if row.get(stage) else "-"


def index_table(rows):
    """Returns the rows that differ only in the index: the rule of Li et al. (2020) with our solver."""
    radii = sorted({row["radius"] for row in rows if row["radius"]})
    kept = {}
    for row in rows:
        if row["solver"] == "active_set" and row["activation"] == "paper" and row["radius"]:
            kept.setdefault(row["index"], {})[row["radius"]] = row
    body = []
    for index, by_radius in kept.items():
        first = next(iter(by_radius.values()))
        of_radius = lambda stage: [median(by_radius[r], stage) if r in by_radius else "-" for r in radii]
        body.append([f"`{index}`", number(first["bytes_per_triangle"]), number(first["build_s"], 2),
                     *of_radius("collect_us"), *of_radius("query_us"), *of_radius("step_us")])
    columns = [f"{what}, {r:g} mm, µs" for what in ("candidates", "query", "step") for r in radii]
    return table(["index", "bytes a triangle", "build, s", *columns], body)


def sweep_table(rows):
    """Returns each index against the number of triangles: the rule of Li et al. (2020) with our solver."""
    kept = {}
    for row in rows:
        if row["solver"] == "active_set" and row["activation"] == "paper":
            kept.setdefault(row["index"], {})[row["triangles"]] = row
    sizes = sorted({size for by_size in kept.values() for size in by_size})
    cell = lambda row: f"{median(row, 'collect_us')} + {median(row, 'exact_us')}" if row else "-"
    return table(["µs: candidates + exact test", *(f"{size:,} triangles" for size in sizes)],
                 [[f"`{index}`", *(cell(by_size.get(size)) for size in sizes)] for index, by_size in kept.items()])


def solver_table(rows):
    """Returns the rows that differ only in the solver, on one index."""
    solvers = {row["solver"] for row in rows if row["solver"] != "active_set"}
    index = next((row["index"] for row in rows if row["solver"] in solvers), None)
    body = [[f"`{row['solver']}`", f"`{row['activation']}`", f"{row['radius']:g}" if row["radius"] else "-",
             number(row["planes_mean"]), median(row, "solve_us"), median(row, "step_us"),
             number(row["step_us"]["p99"]), share(row["unsolved_share"], 1.0)]
            for row in rows if row["index"] == index]
    return table(["solver", "rule", "radius, mm", "planes, mean", "solve, µs", "step, µs", "99 %", "unsolved"], body,
                 left=2)


def rule_table(rows):
    body = [[f"`{row['activation']}`", f"{row['radius']:g}" if row["radius"] else "as far as each motion goes",
             number(row["planes_mean"]), median(row, "step_us"), number(row["step_us"]["p99"])]
            for row in rows if row["index"] == "wide_bvh" and row["solver"] == "active_set"]
    return table(["rule", "radius, mm", "planes, mean", "step, µs", "99 %"], body)
