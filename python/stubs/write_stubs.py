# SPDX-License-Identifier: BSD-3-Clause
"""Writes the stubs of the module that was built: write_stubs.py TEMPLATE OUT, with PYTHONPATH at the module.

The comments on the options of a class become its keywords, set_options and properties. An attribute
of a class, `name: type`, becomes a property that cannot be set."""

import re
import sys
from pathlib import Path

import keepout


def keyword(option):
    return f"        {option.name}: {option.type} = {option.default!r},\n"


def change(option):
    return f"        {option.name}: {option.type} | None = None,\n"


def prop(option):
    return f"    {option.name}: {option.type}\n"


def main(template, out):
    text = Path(template).read_text(encoding="utf-8")
    for name, options in keepout.options().items():
        changes = "".join(change(option) for option in options if option.is_changeable)
        text = text.replace(f"        # keywords of {name}\n", "".join(map(keyword, options)))
        text = text.replace(f"        # changes of {name}\n", changes)
        text = text.replace(f"    # properties of {name}\n", "".join(map(prop, options)))
    text = re.sub(r"^    (\w+): ([^=\n]*[^=,\n])$", r"    @property\n    def \1(self) -> \2: ...", text, flags=re.M)
    Path(out).write_text(text, encoding="utf-8")


main(*sys.argv[1:])
