#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the measured figures of the pages: figures_test.py ROOT

1. Each page has the figures that its records give.
2. Each row of a table has as many cells as its header.
3. No record is stale, by the rule in docs/figures/records.py. This is skipped where git's history is missing.
4. Each record is printed somewhere, and pages state times only as figures of records.
"""

import pathlib
import re
import sys

FENCE = re.compile(r"^( {0,3})(`{3,}|~{3,}).*?^ {0,3}\2`*~* *$", re.M | re.S)
TIME = re.compile(r"\b\d[\d.,]* ?(?:µs|us|ns)\b")
RULE = re.compile(r"^ *\|?(?: *:?-+:? *\|)+ *:?-* *:?-* *\|? *$")


def cells(row):
    return len(re.findall(r"(?<!\\)\|", row.strip().strip("|"))) + 1


def uneven_rows(text):
    """Returns the rows of tables, by number, that have another number of cells than their header."""
    lines = FENCE.sub(lambda match: "\n" * match[0].count("\n"), text).split("\n")
    uneven, columns = [], 0
    for number, line in enumerate(lines, 1):
        if not line.lstrip().startswith("|"):
            columns = 0
        elif RULE.match(line):
            columns = cells(lines[number - 2])
            if cells(line) != columns:
                uneven.append(number)
        elif columns and cells(line) != columns:
            uneven.append(number)
    return uneven


def main(root):
    sys.path.insert(0, str(root / "docs" / "figures"))
    import pages
    import records
    import speed  # noqa: F401, registers what it prints
    import values

    kept = records.read_all()
    figures = values.of_records(kept)
    problems = []
    printed = set()
    for path in pages.of_tree(root):
        inner = path.relative_to(root)
        text = path.read_text(encoding="utf-8")
        problems += [f"{inner}:{line}: a row has another number of cells than its header"
                     for line in uneven_rows(text)]
        unknown = [name for name in pages.names_of(text) if name not in figures]
        if unknown:
            problems.append(f"{inner}: there are no figures {', '.join(unknown)}")
            continue
        printed.update(name.split(".")[0] for name in pages.names_of(text))
        if pages.filled(text, figures) != text:
            problems.append(f"{inner}: differs from its records: run 'python3 docs/figures'")
        if inner.parts[0] in ("docs", "README.md", "benchmarks"):
            problems += [f"{inner}: {time[0]} is not the figure of a record"
                         for time in TIME.finditer(pages.without_figures(FENCE.sub("", text)))]
    problems += [f"docs/records/{name}: no page prints it" for name in kept if name not in printed]
    for name, one in kept.items():
        if not records.is_in_history(one["commit"]):
            print(f"skipped: the age of {name}, as its commit {one['commit']} is not in git's history here")
        elif why := records.staleness(name, one):
            problems.append(f"docs/records/{name}: {why}")
    print("\n".join(problems) or f"{len(figures)} figures of {len(kept)} records")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
