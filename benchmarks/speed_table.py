#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints what runs of `keepout bench --speed --json FILE` measured as one Markdown table.

    benchmarks/speed_table.py avx2.json avx512.json

A column for each run, named by its SIMD target, with the figures of each row; in bold what falls short
of the demand. The last column has what the figure of the first run that has the row is made of. The table of
docs/performance.md is made by it.
"""
import json
import sys


def number(value):
    """Three digits, as the command's own table has it."""
    return f"{value:.0f}" if value >= 99.95 else f"{value:#.3g}".rstrip(".")


def figure(row):
    if row["figure"] is None:
        return row["remark"] or "not measured"
    unit = "x" if row["unit"] == "x" else f" {row['unit']}".rstrip()
    text = (number(row["figure"]) if row["figure"] else "0") + unit
    return text if row["met"] else f"**{text}**"


def demand(row):
    ((sense, value),) = row["demanded"].items()
    unit = "x" if row["unit"] == "x" else f" {row['unit']}".rstrip()
    return f"{sense.replace('_', ' ')} {value:g}{unit}"


def side(measured):
    times = [measured["us"][key] for key in ("p50", "p99", "p999")]
    in_ms = times[0] >= 1e4
    texts = [number(time * (1e-3 if in_ms else 1)) for time in times if time is not None]
    return f"{measured['name']} {' / '.join(texts)}{' ms' if in_ms else ''}"


def main(paths):
    runs = [json.load(open(path, encoding="utf-8")) for path in paths]
    tables = [{(row["work"], row["compared"]): row for row in run["rows"]} for run in runs]
    targets = [run["machine"]["simd"] for run in runs]
    print("| work: compared | demanded |", " | ".join(targets), "| made of, us |")
    print("|---" * (3 + len(runs)) + "|")
    rows = {name: row for table in reversed(tables) for name, row in table.items()}
    order = list(tables[-1]) if len(tables[-1]) == len(rows) else list(rows)
    for name in order:
        row = rows[name]
        figures = [figure(table[name]) if name in table else "-" for table in tables]
        sides = "; ".join(side(measured) for measured in row["sides"])
        print(f"| {': '.join(name)} | {demand(row)} |", " | ".join(figures), f"| {sides} |")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("name the JSON files that 'keepout bench --speed --json FILE' has written")
    main(sys.argv[1:])
