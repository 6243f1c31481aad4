#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the tables of options.md from the options of the built Python module, which must be on PYTHONPATH:

    python3 docs/options.py            writes the page
    python3 docs/options.py --check    exits with 1 if the page differs from the module
"""

import sys
from pathlib import Path

import keepout

bar = r"\|"  # a bar that does not end a cell
PAGE = Path(__file__).with_name("options.md")


def table(options):
    """Returns a Markdown table with a row for each option."""
    rows = ["| option | command | default | range | unit | meaning | can change |", "|---|---|--:|---|---|---|---|"]
    for option in options:
        default = f"`{option.default}`" if option.type == "str" or option.choices else option.default
        rows.append(f"| `{option.name}` | {option.command and f'`--{option.command}`'} | {default} | {option.range} "
                    f"| {option.unit} | {option.description.replace('|', bar)} | {'yes' if option.is_changeable else ''} |")
    return "\n".join(rows)


def written(text):
    """Returns the text of the page with the tables of the module."""
    for name, options in keepout.options().items():
        begin = f"<!--options {name}-->\n"
        before, rest = text.split(begin)
        text = before + begin + table(options) + "\n" + rest[rest.index("<!--/-->"):]
    return text


def main(check):
    text = PAGE.read_text(encoding="utf-8")
    if written(text) == text:
        return 0
    if check:
        return "docs/options.md differs from the module: run 'python3 docs/options.py'"
    PAGE.write_text(written(text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main("--check" in sys.argv[1:]))
