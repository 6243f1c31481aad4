# SPDX-License-Identifier: BSD-3-Clause
"""The figures of the pages, between markers that readers do not see.

    <!--NAME-->TEXT<!--/-->                             in a line
    <!--NAME-->                                         or lines, up to <!--/--> on a line of its own

NAME is the name of a figure in values.py.
"""

import re
import shutil
import subprocess

FENCE = re.compile(r"^( {0,3})(`{3,}|~{3,}).*?^ {0,3}\2`*~* *$", re.M | re.S)
FIGURE = re.compile(r"<!--([a-z0-9_]+\.[a-z0-9_.]+)-->(.*?)<!--/-->", re.S)


def filled(text, values):
    """Returns the text of a page with all figures from the records. Raises KeyError for an unknown figure."""

    def figure(match):
        value = values[match[1]]
        if "\n" in value or match[2].startswith("\n"):
            value = f"\n{value}\n"
        return f"<!--{match[1]}-->{value}<!--/-->"

    return FIGURE.sub(figure, text)


def of_tree(root, names=("*.md",)):
    """Returns the paths of all files that git would commit and whose names match, by default all pages.

    Without git, leaves out build/, out/ and hidden directories.
    """
    if shutil.which("git"):
        listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard", *names],
                                capture_output=True, text=True)
        if listed.returncode == 0 and listed.stdout:
            return sorted(path for path in map(root.joinpath, listed.stdout.splitlines()) if path.is_file())
    inner = lambda path: path.relative_to(root).parts
    return sorted(path for name in names for path in root.rglob(name) if inner(path)[0] not in ("build", "out")
                  and not any(part.startswith(".") for part in inner(path)))


def blank(match):
    """Returns the same number of lines, without words."""
    return re.sub(r"[^\n]", " ", match[0])


def names_of(text):
    """Returns the names of all figures of a page."""
    return [match[1] for match in FIGURE.finditer(text)]


def without_figures(text):
    """Returns a page's text without its figures."""
    return FIGURE.sub("", text)
