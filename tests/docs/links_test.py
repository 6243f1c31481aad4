#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks all links of the pages: links_test.py ROOT

Reads every .md file that git would commit; without git, all except those in build/, out/ and hidden folders.
A relative link must name a file or folder of the sources, in the same letter case. An anchor must name a heading
or an <a id> there. Links to the web are not followed. A picture must have a text. docs/README.md must
have a link to each page beside it, and docs/embedding.md must name each public header.
"""

import pathlib
import re
import sys
import unicodedata
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs" / "figures"))
from pages import FENCE, blank, of_tree  # noqa: E402

CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.S)
COMMENT = re.compile(r"<!--.*?-->", re.S)
LINK = re.compile(r"(?P<picture>!?)\[(?P<words>(?:[^\[\]]|\[[^\]]*\])*)\]\((?P<to>[^()\s]*)(?:\s+\"[^\"]*\")?\)")
NAMED = re.compile(r'<a id="([^"]+)"></a>')
HEADING = re.compile(r"^#{1,6} +(.+?) *#* *$", re.M)


def anchor_of(heading):
    """Returns the anchor that GitHub gives a heading."""
    words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
    kept = (c for c in words if c in " -_" or unicodedata.category(c)[0] in "LNM")
    return "".join(kept).strip().replace(" ", "-")


def anchors(page):
    found, seen = set(NAMED.findall(page.read_text(encoding="utf-8"))), {}
    for heading in HEADING.findall(FENCE.sub(blank, page.read_text(encoding="utf-8"))):
        anchor = anchor_of(heading)
        number = seen.get(anchor, 0)
        seen[anchor] = number + 1
        found.add(f"{anchor}-{number}" if number else anchor)
    return found


def exists(path):
    """Returns true if the path exists in this letter case, even if the file system ignores the case."""
    return path.exists() and (path.name in ("", "..", ".") or
                              path.resolve().name in [p.name for p in path.resolve().parent.iterdir()])


def faults_of(page, root):
    text = page.read_text(encoding="utf-8")
    for rule in (FENCE, COMMENT, CODE):
        text = rule.sub(blank, text)
    for link in LINK.finditer(text):
        line = text.count("\n", 0, link.start()) + 1
        if link["picture"] and not link["words"].strip():
            yield line, f"the picture {link['to']} has no text for readers who cannot see it"
        parts = urllib.parse.urlsplit(link["to"])
        if parts.scheme or parts.netloc:
            continue
        target = page
        if parts.path:
            target = page.parent / urllib.parse.unquote(parts.path)
            if not exists(target):
                yield line, f"there is no {link['to']}"
                continue
            if root not in target.resolve().parents and target.resolve() != root:
                yield line, f"{link['to']} is outside the sources"
                continue
        if parts.fragment and target.suffix == ".md" and parts.fragment not in anchors(target):
            yield line, f"there is no heading for {link['to']}"


def unnamed_headers(root):
    """Returns the public headers that the table of docs/embedding.md does not name."""
    rooms = ("engine", "robot", "control", "solvers", "solvers/nlopt", "adapters", "adapters/urdf", "adapters/ompl", "factory")
    headers = [header for room in rooms for header in sorted((root / room / "include/keepout").rglob("*.h"))]
    if len(headers) < 60:
        sys.exit(f"only {len(headers)} public headers: has something moved?")
    named = set(re.findall(r"`(?:\w+/)*(\w+\.h)`", (root / "docs/embedding.md").read_text(encoding="utf-8")))
    return [header.relative_to(root) for header in headers if header.name not in named]


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    pages = of_tree(root)
    if not pages:
        sys.exit(f"{root}: there are no pages")
    faults = [f"{page.relative_to(root)}:{line}: {why}" for page in pages
              for line, why in faults_of(page, root)]
    overview = root / "docs/README.md"
    listed = {(overview.parent / link["to"]).resolve()
              for link in LINK.finditer(overview.read_text(encoding="utf-8"))}
    faults += [f"docs/README.md:1: has no link to {page.name}" for page in pages
               if page.parent == overview.parent and page != overview and page not in listed]
    faults += [f"docs/embedding.md:1: does not state the stability of {header}" for header in unnamed_headers(root)]
    print("\n".join(faults) or f"{len(pages)} pages: all links are valid")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
