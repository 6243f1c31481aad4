#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts patterns of prose that make readers stumble: plain_english_test.py ROOT [--list AREA]

Reads the pages (.md) and the comments and docstrings of the sources. The test fails if there is a match.
--list prints the matches of an area. CONTRIBUTING.md explains the rules. A text without a match is not yet good: the measure is a reader who
understands each sentence at first reading.
"""

import argparse
import ast
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs" / "figures"))
from pages import FENCE, blank, of_tree  # noqa: E402

AREAS = ("pages", "changelog", "headers", "sources", "tests")
NAMES = ("*.md", "*.h", "*.cpp", "*.py", "*.pyi", "*.mjs", "*.js", "*.ts", "*.css", "*.sh", "*.cmake", "CMakeLists.txt", "run", "test")
LONGEST = 30  # words of a sentence

PATTERNS = {
    "clause as a subject": r"^(What|Whether|Where|Who|Whose|Whatever|Whoever|Of|That which|How (far|many|much|long|often))\b(?!.*\?$)",
    "passive without an agent": r"\b(is|are|was|were|be|been|being) (told|asked|looked (for|at|into)|given up|let go)\b",
    "modal": r"\b(shall|(is|are|was|were) to be)\b",
    "riddle": r"\b(nobody|(is|are|was|were) none|none is|no number|so much|as much as|that which)\b",
    "docstring": r"^(The same|Likewise|Ditto)[.,:;]",
    "household word": r"\b(led (off|out|back)|leads? (off|out|back)|(kept|held|keeps?|holds?) back|let go|lets go|to the last bit"
                      r"|the bits\b(?! of)|looks? (at|for) less|yielding|softening|g[ai]ves? way|poses? a plane|turns a plane"
                      r"|witness(es)?|frontiers?|facets?|doctor|(no|has|have|had|without|enough|more|less) room|tells?\b|told)\b",
    "unit": r"\d us\b",
}
MATCH = {name: re.compile(pattern, re.I if name != "clause as a subject" and name != "docstring" else 0)
         for name, pattern in PATTERNS.items()}
COMMENT = re.compile(r"<!--.*?-->", re.S)
BLOCK_COMMENT = re.compile(r"/\*\*?(.*?)\*/", re.S)
FORMULA = re.compile(r"\$\$.+?\$\$|\$[^$\n]+\$", re.S)
INLINE_CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.S)
LINK = re.compile(r"!?\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)")
END = re.compile(r"(?<=[.!?])[\"')*_]*\s+(?=[\"'(*_`]*(?:[A-Z0-9`]|formula|keepout))")


def sentences(line, text):
    """Yields the line number and the text of each sentence of a paragraph that begins at `line`."""
    text = LINK.sub(r"\1", text)
    text = FORMULA.sub(lambda formula: "formula" + "\n" * formula[0].count("\n"), text)
    text = INLINE_CODE.sub(lambda code: "`code`" + "\n" * code[0].count("\n"), text)
    start = 0
    for end in [*(m.end() for m in END.finditer(text)), len(text)]:
        sentence = text[start:end]
        if sentence.strip():
            yield line + text.count("\n", 0, start + len(sentence) - len(sentence.lstrip())), " ".join(sentence.split())
        start = end


def paragraphs_of_page(text):
    """Yields the first line and the text of each paragraph, list item and cell of a page."""
    for rule in (FENCE, COMMENT):
        text = rule.sub(blank, text)
    first, lines = 1, []
    for number, line in enumerate([*text.split("\n"), ""], 1):
        if line.startswith("    ") and not lines:
            continue  # an indented listing
        starts = re.match(r"\s*([-*+]|\d+\.)\s+|#+\s|\s*\||\s*>", line)
        if lines and (starts or not line.strip()):
            yield first, "\n".join(lines)
            lines = []
        if line.lstrip().startswith("|"):
            for cell in line.strip().strip("|").split("|"):
                yield number, cell.strip()
        elif line.strip() and not line.startswith("#"):
            first = first if lines else number
            lines.append(line[starts.end():] if starts else line)


def paragraphs_of_comments(text, mark):
    """Yields the first line and the text of each comment.

    A blank comment line ends a paragraph, and so does a line of another indentation.
    """
    first, lines, column = 1, [], 0
    for number, line in enumerate([*text.split("\n"), ""], 1):
        comment = re.match(rf"(?P<code>.*?)(?:^|(?<=\s)){mark}+[!<]*(?: (?P<words>.*))?$", line)
        words = comment["words"] if comment else None
        alone = comment and not comment["code"].strip()
        if lines and not (words and alone and len(comment["code"]) == column):
            yield first, "\n".join(lines)
            lines = []
        if words and not re.match(r"SPDX|clang-format|NOLINT|noqa|shellcheck|type:|\W*$|#!|biome", words):
            first = first if lines else number
            column = len(comment["code"])
            lines.append(words)


def paragraphs_of_docstrings(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
            line = node.body[0].lineno
            for paragraph in re.split(r"\n\s*\n", ast.get_docstring(node)):
                yield line, paragraph
                line += paragraph.count("\n") + 2


def paragraphs(path):
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        yield from paragraphs_of_page(text)
    elif path.suffix in (".h", ".cpp", ".mjs", ".js", ".ts", ".css"):
        text = BLOCK_COMMENT.sub(lambda block: re.sub(r"^[ *]*", "// ", block[1], flags=re.M), text)
        yield from paragraphs_of_comments(text, "//")
    else:
        yield from paragraphs_of_comments(text, "#")
        if path.suffix in (".py", ".pyi"):
            yield from paragraphs_of_docstrings(text)


def area_of(path):
    if path.suffix == ".md":
        return "changelog" if path.name == "CHANGELOG.md" else "pages"
    if path.parts[0] == "tests" or "tests" in path.parts:
        return "tests"
    return "headers" if "include" in path.parts and path.parts[0] not in ("oracle", "fixtures") else "sources"


def matches(line, paragraph):
    for line, sentence in sentences(line, paragraph):
        for name, rule in MATCH.items():
            if rule.search(sentence):
                yield line, name, sentence
        if len(sentence.split()) > LONGEST:
            yield line, f"{len(sentence.split())} words", sentence


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--list", metavar="AREA", help="print the matches of an area, or of the paths that begin with it")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    counts, read = dict.fromkeys(AREAS, 0), dict.fromkeys(AREAS, 0)
    for path in of_tree(root, NAMES):
        name = path.relative_to(root)
        area = area_of(name)
        for line, paragraph in paragraphs(path):
            read[area] += sum(1 for _ in sentences(line, paragraph))
            for place, rule, sentence in matches(line, paragraph):
                counts[area] += 1
                if arguments.list and (area == arguments.list or str(name).startswith(arguments.list)):
                    print(f"{name}:{place}: {rule}: {sentence}")
    if arguments.list:
        return 0
    for area in AREAS:
        if read[area] < 100:
            sys.exit(f"{area}: only {read[area]} sentences: has something moved?")
        print(f"{area}: {counts[area]} matches in {read[area]} sentences")
    if any(counts.values()):
        print("rewrite the sentences that --list AREA prints: CONTRIBUTING.md, English")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
