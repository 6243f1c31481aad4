#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that docs/embedding.md lists all installed components and headers, and no others:
embedding_page_test.py PREFIX PAGE"""

import pathlib
import re
import sys


# Components that a build leaves out if their library is missing; each has a directory of headers.
OPTIONAL = {"ompl", "urdf"}


def rows(text, heading):
    """Yields the cells of each row of the table whose header begins with `heading`."""
    table = text[text.index(f"| {heading} |"):].split("\n\n")[0]
    for line in table.splitlines()[2:]:
        yield [cell.strip() for cell in line.strip("|").split("|")]


def headers_named(cell, installed):
    """Returns the headers that a cell names. A name may be in the directory of the name before it."""
    names, directory = set(), ""
    for name in re.findall(r"`([\w/]+\.h)`", cell):
        if "/" in name:
            directory = name.rsplit("/", 1)[0] + "/"
        elif directory + name in installed:
            name = directory + name
        names.add(name)
    return names


def main(prefix, page):
    include = pathlib.Path(prefix, "include/keepout")
    headers = {path.relative_to(include).as_posix() for path in include.rglob("*.h")}
    components = {match[1] for path in pathlib.Path(prefix).glob("lib*/**/cmake/keepout/keepout-*.cmake")
                  if (match := re.fullmatch(r"keepout-([a-z]+)\.cmake", path.name)) and match[1] != "config"}
    text = pathlib.Path(page).read_text(encoding="utf-8")
    listed, places = set(), set()
    for component, _, where, _ in rows(text, "component"):
        listed.add(component.strip("`"))
        places |= set(re.findall(r"`(\w+/)`", where))
    named = set()
    for _, cell, promise in rows(text, "for"):
        named |= headers_named(cell, headers)
        if promise not in ("stable", "none"):
            return f"a promise is neither 'stable' nor 'none': {promise}"
    left_out = OPTIONAL - components
    listed -= left_out
    named = {name for name in named if name.split("/")[0] not in left_out}
    faults = [f"{what}: {' '.join(sorted(names))}" for what, names in (
        ("components that are not in the page", components - listed),
        ("components that are not installed", listed - components),
        ("headers that are not in the page", headers - named),
        ("headers that are not installed", named - headers),
        ("directories of headers without a component in the page",
         {name.split("/")[0] + "/" for name in headers if "/" in name} - places)) if names]
    if len(headers) < 50 or len(components) < 5:
        faults.append(f"only {len(headers)} headers and {len(components)} components: has something moved?")
    return "\n".join(faults) or print(f"{len(components)} components, {len(headers)} headers")


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
