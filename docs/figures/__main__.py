#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the measured figures of the pages from the records in docs/records.

    python3 docs/figures                      writes all pages.

    python3 docs/figures --check              exits with 1 if checks.py finds a fault.

    python3 docs/figures --names              prints all figures.

    python3 docs/figures --show FILE          prints the figures of a command's --json.

    python3 docs/figures --keep NAME FILE...  keeps a command's --json as a record, then writes all pages.

A record belongs to the commit at which it was measured: HEAD, or --commit. With --output-of COMMAND the
file contains the output of a program. docs/records.md explains how to measure each record again.
"""

import argparse
import json
import sys

import checks
import pages
import records
import speed  # noqa: F401, registers its figures
import values


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--names", action="store_true")
    parser.add_argument("--show", metavar="FILE")
    parser.add_argument("--keep", nargs="+", metavar="NAME FILE")
    parser.add_argument("--commit", default="HEAD")
    parser.add_argument("--output-of", metavar="COMMAND")
    arguments = parser.parse_args()
    if arguments.show:
        with open(arguments.show, encoding="utf-8") as file:
            record = json.load(file)
        for name, value in values.MEASURED_BY[record["keepout_record"]](record):
            print(f"{name}:{chr(10) if chr(10) in value else ' '}{value}")
        return 0
    if arguments.keep:
        records.keep(arguments.keep[0], arguments.keep[1:], arguments.commit, arguments.output_of)
    kept = records.read_all()
    figures = values.of_records(kept)
    if arguments.names:
        for name, value in figures.items():
            print(f"{name}: {value if len(value) < 80 else value[:77] + '...'}")
        return 0
    if arguments.check:
        problems = list(checks.all_of(kept, figures))
        print("\n".join(problems) or f"{len(figures)} figures of {len(kept)} records")
        return 1 if problems else 0
    for path in pages.of_tree(records.ROOT):
        text = path.read_text(encoding="utf-8")
        try:
            written = pages.filled(text, figures)
        except KeyError as error:
            sys.exit(f"{path}: unknown figure {error}: see --names")
        if written != text:
            path.write_text(written, encoding="utf-8")
            print(f"{path.relative_to(records.ROOT)}: written from the records")
    return 0


if __name__ == "__main__":
    sys.exit(main())
