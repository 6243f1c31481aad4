# SPDX-License-Identifier: BSD-3-Clause
"""The figures of each record: a table or a number for each name.

Each function handles one kind of record, and yields names and texts. The full name of a figure is the name of the
record, a dot, and the name that the function yields.
"""

import math
import re

MEASURED_BY = {}


def of_kind(kind):
    def register(function):
        MEASURED_BY[kind] = function
        return function

    return register


def of_records(kept):
    """Returns the text of every figure by its full name."""
    figures = {}
    for name, one in kept.items():
        record = one["record"]
        figures[f"{name}.commit"] = one["commit"]
        figures[f"{name}.command"] = f"`{record['command'].replace('keepout ', './run ')}`"
        machine = record.get("machine") or next(iter(record.get("shards", [])), {}).get("machine")
        if isinstance(machine, str):  # the machine of a shard of a campaign, or the printed one
            text = machine.replace("GNU", "GCC")
            figures[f"{name}.machine"] = f"{text}, {record['date'][:10]}, commit {one['commit']}"
        elif machine:
            compiler = machine["compiler"].replace("GNU", "GCC")
            figures[f"{name}.machine"] = (f"{machine['processor']}, {machine['cores']} cores, {compiler}, "
                                          f"{machine['simd']}, {record['date'][:10]}, commit {one['commit']}")
        for key, text in MEASURED_BY[record["keepout_record"]](record):
            figures[f"{name}.{key}"] = text
    return figures


def number(value, digits=3):
    """Returns a number with this many significant digits, and with separators of thousands."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    if abs(value) >= 10 ** (digits - 1) or float(value).is_integer():
        return f"{value:,.0f}"
    return f"{value:#.{digits}g}".rstrip(".")


def share(part, whole, digits=2):
    return f"{number(100.0 * part / whole, digits)} %" if whole else "-"


def table(columns, rows, left=1):
    """Returns a Markdown table; the first `left` columns hold words, the others numbers."""
    rule = ["---" if i < left else "--:" for i in range(len(columns))]
    lines = [f"| {' | '.join(columns)} |", f"|{'|'.join(rule)}|"]
    for row in rows:
        if len(row) != len(columns):
            raise ValueError(f"a row of {len(row)} cells below {len(columns)} columns: {row}")
        lines.append(f"| {' | '.join(map(str, row))} |")
    return "\n".join(lines)


def grouped(rows, *keys):
    """Returns the rows grouped by their values of these keys (or of one key), in the order of the first rows."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys) if len(keys) > 1 else row[keys[0]], []).append(row)
    return groups


def total(rows, key):
    return sum(row[key] for row in rows)


@of_kind("simulate")
def simulate(record):
    rows = []
    for run in record["runs"]:
        its = run["summary"]
        is_free = run["rule"] == "none"
        name = "no fixture" if is_free else f"`{run['rule']}`"
        if its["deepest_mm"] is None:  # an open surface has no inside
            inside = ("-", its["crossings"])
        else:
            inside = (f"{number(its['deepest_mm'])}{' mm' if its['deepest_mm'] else ''}",
                      number(its["cycles_inside"]))
        steps = ["-"] * 4 if is_free else [
            f"{its['closest_approach_mm']:.2f} mm", number(its["stopped"]),
            f"{number(its['p50_us'])} µs", f"{number(its['p99_us'])} µs"]
        rows.append([name, *inside, *steps])
        for key in ("p50_us", "p99_us", "crossings", "stopped"):
            yield f"{run['rule']}.{key}", number(its[key])
    inside = ["deepest inside", "cycles inside"]
    if record["runs"][0]["summary"]["deepest_mm"] is None:
        inside = ["inside", "passages through the surface"]
    yield "table", table(["rule", *inside, "nearest approach", "cycles stopped", "median step", "99 %"], rows)
    yield "cycles", number(record["runs"][0]["summary"]["cycles"])


def rounded_up(mm):
    return "-" if mm is None else f"{math.ceil(100 * mm) / 100:.2f}"


def tracking(record, bodies):
    """The figures of `simulate --physics`: the setpoint beside the measured instrument."""
    measured = [row for row in record["rows"] if row["mode"] == "measured"]
    yield "tracking", table(
        ["speed, mm/s", *(f"{body}: error" for body in bodies), *(f"{body}: margin" for body in bodies)],
        [[f"{speed:g}", *(f"{max(row[f'{body}_error_mm'] for row in rows):.3f}" for body in bodies),
          *(rounded_up(max(row[f"{body}_asks_mm"] for row in rows)) for body in bodies)]
         for speed, rows in grouped(measured, "mm_per_s").items()])
    cells = []
    for (mesh, speed, margin), rows in sorted(grouped(record["rows"], "mesh", "mm_per_s", "margin_mm").items()):
        setpoint, robot = (next(row for row in rows if row["mode"] == mode) for mode in ("setpoint", "measured"))
        nearest = [setpoint[f"{body}_least_mm"] for body in bodies if setpoint[f"{body}_least_mm"] is not None]
        cells.append([mesh, f"{speed:g}", f"{margin:g}", f"{min(nearest):.3f}" if nearest else "-",
                      *("-" if robot[f"{body}_least_mm"] is None else f"{robot[f'{body}_least_mm']:.3f}"
                        for body in bodies), f"{robot['in_mesh']:,}"])
    yield "table", table(["mesh", "mm/s", "margin", "setpoint", *bodies, "cycles in the mesh"], cells)
    setpoint = [row for row in record["rows"] if row["mode"] == "setpoint"]
    for what in ("cycles", "below"):
        yield what, f"{total(setpoint, what):,}"
    for margin, rows in grouped(measured, "margin_mm").items():
        yield f"in_mesh.{margin:g}", f"{total(rows, 'in_mesh'):,}"
    # The certified clearance minus the smallest measured one.
    lost = [row["margin_mm"] - (row[f"{body}_asks_mm"] - row[f"{body}_error_mm"]) - row[f"{body}_least_mm"]
            for row in measured for body in bodies if row[f"{body}_least_mm"] is not None]
    yield "lost_mm", rounded_up(max(lost, default=None))
    yield "strokes", re.search(r"--strokes (\d+)", record["command"])[1]


@of_kind("simulate_robot")
def simulate_robot(record):
    bodies = [body["name"] for body in record["bodies"]]
    if "margin_mm" in record["rows"][0]:
        yield from tracking(record, bodies)
        return
    rows = []
    for row in record["rows"]:
        cells = []
        for body in bodies:
            below, inside = row[f"{body}_below"], row[f"{body}_in_mesh"]
            deepest = f"; {number(row[f'{body}_deepest_mm'])} mm" if inside else ""
            cells.append(f"{below:,}; {inside:,}{deepest}" if below else "0")
        rows.append([f"{row['mesh']}, x{row['speed']:g}", row["mode"], *cells, f"{row['refused']:,}"])
    yield "table", table(["mesh, speed", "mode", *bodies, "no motion"], rows, left=2)
    for mode, of_mode in grouped(record["rows"], "mode").items():
        key = mode.replace(" ", "_")
        for what in ("cycles", "refused"):
            yield f"{key}.{what}", f"{total(of_mode, what):,}"
        for what in ("below", "in_mesh"):
            yield f"{key}.{what}", f"{sum(total(of_mode, f'{b}_{what}') for b in bodies):,}"
        yield f"{key}.deepest_mm", number(max(row[f"{b}_deepest_mm"] for row in of_mode for b in bodies))


@of_kind("verify")
def verify(record):
    its = record["total"]
    yield "steps", f"{its['steps']:,}"
    yield "meshes", str(len(record["meshes"]))
    yield "breaches", f"{sum(its['breaches'].values()):,}"
    for kind, count in its["breaches"].items():
        yield f"breaches.{kind}", f"{count:,}"
    yield "led_out", f"{its['led_out']:,}"
    yield "least_mm", f"{its['least_beyond_margin']:.2g}"
    yield "least_tau", f"{its['least_beyond_margin_in_tau']:.3g}"
    yield "statuses", ", ".join(f"`{name}` {count:,}" for name, count in its["statuses"].items() if count)


@of_kind("verify_robot")
def verify_robot(record):
    for key in ("cycles", "below", "in_mesh", "guides_left", "limits_broken", "strayed"):
        yield key, f"{record['total'][key]:,}"
    yield "scenarios", table(
        ["scenario", "speed", "cycles", "below", "guides left", "joint limits broken", "strayed",
         "blocked, searched", "movable"],
        [[scenario, f"x{speed:g}", f"{total(rows, 'cycles'):,}",
          *(total(rows, key) for key in ("below", "guides_left", "limits_broken", "strayed")),
          f"{total(rows, 'excess_samples'):,}", share(total(rows, "movable"), total(rows, "excess_samples"))]
         for (scenario, speed), rows in grouped(record["rows"], "scenario", "speed").items()])
    yield "by_mesh", table(
        ["mesh", "scenario", "speed", "cycles", "below", "rounds, mean/max", "blocked", "truncated",
         "no motion", "excess", "with a useful motion"],
        [[row["mesh"], row["scenario"], f"x{row['speed']:g}", f"{row['cycles']:,}", row["below"],
          f"{row['rounds_mean']:.2f}/{row['rounds_max']}", f"{100 * row['blocked_share']:.0f} %",
          f"{100 * row['cut_share']:.2g} %", f"{100 * row['unmoved_share']:.2g} %",
          number(row["excess_mean"], 2), f"{row['useful']} of {row['excess_samples']}"]
         for row in record["rows"] if row["cycles"]], left=2)
    yield "recovery", table(
        ["mesh", "scenario", "recovered within 500 cycles", "cycles, mean"],
        [[row["mesh"], row["scenario"], f"{row['recovered']} of {row['recoveries']}",
          number(row["recovery_cycles_mean"])]
         for row in record["rows"] if row["recoveries"] and row["speed"] == 1.0], left=2)
    percentiles = ("p50", "p99", "p999", "max")
    timed = [row for row in record["rows"] if row["cycles"] and row["point_us"]["p50"]]
    yield "times", table(
        ["mesh", "scenario", "speed", "median, µs", "99 %", "99.9 %", "longest", "work units, at most",
         "ball at the tip, median, µs", "99 %", "99.9 %", "longest"],
        [[row["mesh"], row["scenario"], f"x{row['speed']:g}", *(number(row["step_us"][p]) for p in percentiles),
          f"{row['looks_max']:,}", *(number(row["point_us"][p]) for p in percentiles)] for row in timed], left=2)
    if timed:
        first = timed[0]
        yield "p50", number(first["step_us"]["p50"], 2)
        yield "p99", number(first["step_us"]["p99"], 2)
        for p in ("p50", "p99"):
            yield f"{p}_ratio", number(first["step_us"][p] / first["point_us"][p], 2)
    yield "rates", rate_times(timed)
    yield "by_step_length", step_lengths(record["rows"])
    yield "undershot_mm", number(max(-min(row["least_beyond_mm"] for row in record["rows"]
                                          if row["least_beyond_mm"] is not None), 0.0), 2)


def rate_times(rows):
    """Returns the times in contact and free, by the length of a step and the rate of the cycles."""
    timed = [row for row in rows if row.get("contact_us")]
    keys = ("contact_us", "free_us")
    return table(
        ["mesh", "step, at most", "cycle rate", "speed, at most", "cycles",
         *(f"{key.removesuffix('_us')}, µs: p50 / p99 / p99.9 / longest" for key in keys)],
        [[row["mesh"], f"{500 * row['speed']:g} µm, {20 * row['speed']:g} mrad", f"{number(1.0 / row['cycle_s'])} Hz",
          f"{number(0.5 * row['speed'] / row['cycle_s'])} mm/s", f"{row['cycles']:,}",
          *(" / ".join(number(time) for time in row[key].values()) for key in keys)] for row in timed])


def step_lengths(rows):
    """Returns a table by the length of a step, and by the rate of the cycles."""
    body = []
    for speed, its in sorted(grouped(rows, "speed").items()):
        cycles, cycle_s = total(its, "cycles"), its[0].get("cycle_s")
        blocked = sum(row["blocked_share"] * row["cycles"] for row in its if row["cycles"])
        least = min(0.0, *(row["least_beyond_mm"] or 0.0 for row in its))
        body.append([f"{0.5 * speed:g} mm, {0.02 * speed:g} rad", f"{number(1.0 / cycle_s)} Hz" if cycle_s else "-",
                     f"{cycles:,}", share(blocked, cycles), f"{total(its, 'below'):,}", number(-least, 2),
                     f"{total(its, 'in_mesh'):,}", number(max(row["deepest_mm"] for row in its), 2)])
    return table(
        ["step length, at most", "cycle rate", "cycles", "in contact", "below the certified clearance", "at most by, mm",
         "in the mesh", "deepest, mm"], body)


@of_kind("plan")
def plan(record):
    rows = [[its["mesh"], its["checker"], f"{its['solved']}/{its['runs']}",
             f"{its['valid']}/{its['solved']}" if its["solved"] else "-",
             its["entering"] if its["solved"] else "-",
             number(its["least_clearance_mm"], 4) if its["solved"] else "-",
             number(1e3 * its["median_seconds"], 2), number(1e3 * its["median_checking_seconds"], 2),
             number(its["median_checks"]), number(its["median_length_mm"]) if its["solved"] else "-"]
            for its in record["summaries"]]
    yield "table", table(["mesh", "checker", "solved", "valid", "enters", "least clearance, mm", "median time, ms",
                          "of it in the checker, ms", "motions checked", "length, mm"], rows, left=2)
    yield from plan_numbers(record)


@of_kind("plan_robot")
def plan_robot(record):
    rows = [[its["mesh"], its["checker"], f"{its['solved']}/{its['runs']}", f"{its['valid']}/{its['solved']}",
             its["motions"], its["too_close"], its["entering"],
             number(its["deepest_mm"], 2) if its["entering"] else "-", number(1e3 * its["median_seconds"], 2),
             number(its["median_checks"]), number(its["median_length_mm"])]
            for its in record["summaries"]]
    yield "table", table(["mesh", "checker", "solved", "valid", "motions", "too close", "in the mesh", "deepest, mm",
                          "median time, ms", "motions checked", "length, mm"], rows, left=2)
    yield from plan_numbers(record)


def plan_numbers(record):
    """Yields sums over the meshes for each checker, and its time relative to that of `certified`."""
    summaries = grouped(record["summaries"], "checker")
    certified = {its["mesh"]: its for its in summaries["certified"]}
    for checker, of_it in summaries.items():
        key = checker.replace(" %", "").replace(" ", "_")
        for what in ("runs", "solved", "valid", "entering"):
            yield f"{key}.{what}", str(total(of_it, what))
        yield f"{key}.invalid", str(total(of_it, "solved") - total(of_it, "valid"))
        yield f"{key}.unsolved", str(total(of_it, "runs") - total(of_it, "solved"))
        for its in of_it:
            yield f"{key}.{its['mesh']}.ms", number(1e3 * its["median_seconds"], 2)
            yield f"{key}.{its['mesh']}.checks", number(its["median_checks"])
            if its["median_checks"]:
                yield f"{key}.{its['mesh']}.us_per_check", number(1e6 * its["median_checking_seconds"] / its["median_checks"], 2)
            yield f"{key}.{its['mesh']}.times_certified", number(its["median_seconds"] / certified[its["mesh"]]["median_seconds"], 2)
            yield f"{key}.{its['mesh']}.solved", str(its["solved"])


@of_kind("output")
def output(record):
    """Yields the Markdown table that a program printed, without repeated headers."""
    lines = record["text"].splitlines()
    yield "table", "\n".join(dict.fromkeys(line for line in lines if line.startswith("|")))


@of_kind("compare")
def compare(record):
    solvers, phases = record["comparison"]["solvers"], record["comparison"]["narrow_phases"]
    if solvers:
        sums = {}
        for name, rows in grouped(solvers["rows"], "solver").items():
            sums[name] = {key: total(rows, key) for key in ("problems", "optimal", "infeasible", "gave_up", "wrong")}
            for key in ("step_difference", "kkt_residual"):
                sums[name][key] = max(row[key] for row in rows)
            sums[name]["converged"] = sum(count for row in rows for outcome, count in row["outcomes"].items()
                                          if outcome.startswith("XTOL_REACHED -> infeasible"))
        yield "solvers", table(
            ["solver", "problems", "optimal", "without a solution, proved", "of these, claimed as converged",
             "given up", "wrong answers that passed", "worst difference, of the motion", "worst KKT residual"],
            [[f"`{name}`", number(its["problems"], 5), number(its["optimal"], 5), number(its["infeasible"], 5),
              "-" if name == "active_set" else its["converged"], its["gave_up"], its["wrong"],
              f"{its['step_difference']:.0e}", f"{its['kkt_residual']:.0e}"] for name, its in sums.items()])
        for name, its in sums.items():
            for key in ("problems", "infeasible", "converged", "gave_up", "wrong"):
                yield f"{name}.{key}", f"{its[key]:,}"
    if phases:
        groups = grouped(phases["rows"], "tool", "backend")
        relations = [row["relation"] for row in next(iter(groups.values()))]
        yield "narrow_phases", table(
            ["tool", "narrow phase", "pairs", "failed", "contradicted", "worst error, mm", "unproven, mm",
             *(f"p50 {relation}, µs" for relation in relations), "p99, the worst, µs"],
            [[tool, f"`{backend}`", *(number(total(rows, key), 5)
                                      for key in ("pairs", "failed", "contradicted")),
              *(short(max(row[key] for row in rows)) for key in ("worst_error_mm", "worst_unproven_mm")),
              *(number(row["p50_us"], 2) for row in rows), number(max(row["p99_us"] for row in rows), 2)]
             for (tool, backend), rows in groups.items()], left=2)


def short(value):
    """Returns a number with two digits; a small one as a power of ten."""
    return "0" if value == 0 else f"{value:.1e}" if abs(value) < 0.01 else f"{value:.2g}"
