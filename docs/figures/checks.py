# SPDX-License-Identifier: BSD-3-Clause
"""The faults that `python3 docs/figures --check` finds.

1. A page differs from its records.
2. A row of a table has another number of cells than its header, or a line of text begins with a figure: its
   marker would end the paragraph.
3. A record is stale, by the rule in records.py. This is skipped where git's history is missing.
4. No page prints a record, or a page states a time that is not the figure of a record.
"""

import re

import pages
import records

BEGINS_WITH_FIGURE = re.compile(r"^ *<!--[\w.]+-->.*\S", re.M)
TIME = re.compile(r"\b\d[\d.,]* ?(?:µs|us|ns)\b")
RULE = re.compile(r"^ *\|?(?: *:?-+:? *\|)+ *:?-* *:?-* *\|? *$")


def cells(row):
    return len(re.findall(r"(?<!\\)\|", row.strip().strip("|"))) + 1


def uneven_rows(text):
    """Returns the rows of tables, by number, that have another number of cells than their header."""
    lines = pages.FENCE.sub(pages.blank, text).split("\n")
    uneven, columns = [], 0
    for number, line in enumerate(lines, 1):
        if not line.lstrip().startswith("|"):
            columns = 0
            continue
        if RULE.match(line):
            columns = cells(lines[number - 2])
        if columns and cells(line) != columns:
            uneven.append(number)
    return uneven


def of_page(text, figures):
    """Yields the faults of a page."""
    yield from (f"{text.count(chr(10), 0, found.start()) + 1}: a line of text begins with a figure"
                for found in BEGINS_WITH_FIGURE.finditer(text))
    yield from (f"{line}: a row has another number of cells than its header" for line in uneven_rows(text))
    if unknown := [name for name in pages.names_of(text) if name not in figures]:
        yield f" unknown figures {', '.join(unknown)}"
    elif pages.filled(text, figures) != text:
        yield " differs from its records: run 'python3 docs/figures'"


def all_of(kept, figures):
    """Yields the faults of the pages and the records."""
    printed = set()
    for path in pages.of_tree(records.ROOT):
        inner = path.relative_to(records.ROOT)
        text = path.read_text(encoding="utf-8")
        yield from (f"{inner}:{problem}" for problem in of_page(text, figures))
        printed.update(name.split(".")[0] for name in pages.names_of(text))
        if inner.parts[0] in ("docs", "README.md", "benchmarks"):
            yield from (f"{inner}: {time[0]} is not the figure of a record"
                        for time in TIME.finditer(pages.without_figures(pages.FENCE.sub("", text))))
    yield from (f"docs/records/{name}: no page prints it" for name in kept if name not in printed)
    for name, one in kept.items():
        if not records.is_in_history(one["commit"]):
            print(f"skipped the age of {name}: its commit {one['commit']} is not in git's history here")
        elif why := records.staleness(name, one):
            yield f"docs/records/{name}: {why}"
