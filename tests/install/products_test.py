#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the target `products` builds what `cmake --install` copies: products_test.py BUILD

Fails if a plain `cmake --install BUILD` would copy a library or program that the target does not build.
"""

import pathlib
import re
import subprocess
import sys

BLOCK = re.compile(r"^if\(CMAKE_INSTALL_COMPONENT STREQUAL [^\n]* OR NOT CMAKE_INSTALL_COMPONENT\)$"
                   r"(.*?)^endif\(\)$", re.M | re.S)
BUILT = re.compile(r"TYPE (?:STATIC_LIBRARY|SHARED_LIBRARY|MODULE|EXECUTABLE) (?:OPTIONAL )?"
                   r"FILES((?:\s+\"[^\"]+\")+)")


INCLUDED = re.compile(r'^\s*include\("([^"]+/cmake_install\.cmake)"\)', re.M)


def installed(script):
    """Yields the files that a script and the scripts it includes copy. Other scripts below the build belong to tests."""
    text = script.read_text(encoding="utf-8")
    for block in BLOCK.findall(text):
        for files in BUILT.findall(block):
            yield from (pathlib.Path(f) for f in re.findall(r'"([^"]+)"', files))
    for included in INCLUDED.findall(text):
        yield from installed(pathlib.Path(included))


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    # `query` lists the inputs of the target, and `inputs` lists the inputs of those.
    listed = "".join(subprocess.run(["ninja", "-C", build, "-t", *tool, "products"],
                                    capture_output=True, text=True, check=True).stdout
                     for tool in (["query"], ["inputs"]))
    made = {build / line.strip() for line in listed.splitlines()}
    taken = set(installed(build / "cmake_install.cmake"))
    if len(taken) < 5:
        sys.exit(f"only {len(taken)} files are installed: has the form of the scripts changed?")
    missing = sorted(str(path.relative_to(build)) for path in taken - made)
    if missing:
        sys.exit("installed, but not built by the target products: " + ", ".join(missing))
    print(f"{len(taken)} libraries and programs are installed, and the target products builds them all")


if __name__ == "__main__":
    main()
