# SPDX-License-Identifier: BSD-3-Clause
"""The table of mutants: reads it, checks it against the sources, and writes changed copies of the sources."""

import dataclasses
import hashlib
import re
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
ROOT = FOLDER.parent.parent
KINDS = ("bound sign rounding skip term stale budget comparison extremum guard constant order index status "
         "arithmetic").split()
EFFECTS = "promise time equivalent".split()


class TableError(Exception):
    """The table does not fit the sources, or breaks its own format."""


@dataclasses.dataclass
class Mutant:
    """One row of the table: in `file`, the text `before` + `old` + `after` has `new` instead of `old`."""

    name: str
    kind: str
    effect: str
    reason: str
    file: str
    before: str
    old: str
    new: str
    after: str
    where: str  # the row's place in the table
    in_constexpr: bool = False
    number: int = 0  # in the build: see build.py
    begin: int = 0  # of `old` in the file
    end: int = 0

    def digest(self):
        """Returns a short digest of the change. A result is valid as long as it stays the same."""
        text = "\0".join([self.file, self.before, self.old, self.new, self.after])
        return hashlib.sha256(" ".join(text.split()).encode()).hexdigest()[:12]

    def folder(self):
        """Returns the folder by which the report groups the mutant."""
        parts = Path(self.file).parts
        if "include" in parts:
            return parts[0] if parts[-2] in ("keepout", parts[0]) else f"{parts[0]}/{parts[-2]}"
        return "/".join([parts[0], *parts[2:3]] if len(parts) > 3 else parts[:1])


def read_table(folder=FOLDER / "table"):
    """Returns the mutants of all files of the table, and checks the format."""
    mutants = []
    for path in sorted(folder.glob("*.txt")):
        mutants += _read_file(path)
    names = set()
    for mutant in mutants:
        if mutant.name in names:
            raise TableError(f"{mutant.where}: a second mutant '{mutant.name}'")
        names.add(mutant.name)
    return mutants


def _read_file(path):
    mutants, source, head, text = [], None, None, []
    lines = path.read_text(encoding="utf-8").split("\n") + [""]
    for number, line in enumerate(lines, 1):
        where = f"{path.name}:{number}"
        if line.startswith("#"):
            continue
        if line.startswith("  ") and head:
            text.append(line.strip())
        elif head and not line.strip():
            mutants.append(_mutant(*head, source, "\n".join(text)))
            head, text = None, []
        elif line.startswith("["):
            source = line.strip("[] ")
        elif line.strip():
            head = (where, line)
    return mutants


def _mutant(where, head, source, text):
    match = re.fullmatch(r"(\w+): (\w+), (\w+)( \(constexpr\))?(?: - (.+))?", head)
    if not match:
        raise TableError(f"{where}: expected 'name: kind, effect - reason', not '{head}'")
    name, kind, effect, in_constexpr, reason = match.groups()
    if kind not in KINDS or effect not in EFFECTS:
        raise TableError(f"{where}: kind '{kind}' or effect '{effect}' is unknown")
    if effect == "equivalent" and not reason:
        raise TableError(f"{where}: an equivalent mutant needs a reason")
    change = re.fullmatch(r"(.*)«(.*?)\s*→\s*(.*?)»(.*)", text, re.DOTALL)
    if not change:
        raise TableError(f"{where}: expected one «old → new»")
    return Mutant(name, kind, effect, reason or "", source, change[1], change[2], change[3], change[4], where,
                  bool(in_constexpr))


def _pattern(text):
    """Returns a regular expression for the text with any white space, or none, at the ends."""
    return r"\s+".join(re.escape(word) for word in text.split())


def locate(mutants, root=ROOT):
    """Finds the place of each mutant. Returns the rows whose text does not occur exactly once, as sentences."""
    wrong, sources = [], {}
    for mutant in mutants:
        if mutant.file not in sources:
            path = root / mutant.file
            sources[mutant.file] = path.read_text(encoding="utf-8") if path.is_file() else None
        source = sources[mutant.file]
        if source is None:
            wrong.append(f"{mutant.where}: {mutant.name}: there is no file {mutant.file}")
            continue

        def gap(left, right):
            return r"\s+" if left[-1:].isspace() or right[:1].isspace() else ""

        old = _pattern(mutant.old)
        before, after = _pattern(mutant.before), _pattern(mutant.after)
        expression = (before + (gap(mutant.before, mutant.old) if before else "") + "(" + old + ")" +
                      (gap(mutant.old, mutant.after) if after else "") + after)
        found = list(re.finditer(expression, source))
        if len(found) != 1:
            wrong.append(f"{mutant.where}: {mutant.name}: its text occurs {len(found)} times in {mutant.file}")
            continue
        mutant.begin, mutant.end = found[0].span(1)
    return wrong


def _is_statement(mutant):
    return mutant.old.rstrip().endswith((";", "}")) and not mutant.old.startswith("{")


def _render(mutants, source, begin, end):
    """Returns source[begin:end] with all mutants whose place is in it. Those at the same place are alternatives; a
    place within another is changed in the original text of the outer one."""
    text, at = "", begin
    todo = sorted(mutants, key=lambda m: (m.begin, -m.end))
    while todo:
        first = todo[0]
        same = [m for m in todo if (m.begin, m.end) == (first.begin, first.end)]
        inner = [m for m in todo if m.begin < first.end and m not in same]
        if any(m.end > first.end for m in inner):
            raise TableError(f"{first.where}: {first.name}: its place overlaps another one")
        todo = [m for m in todo if m not in same and m not in inner]
        original = _render(inner, source, first.begin, first.end)
        for m in reversed(same):
            test = f"keepout_mutants::is({m.number})"
            if m.in_constexpr:
                test = f"(!std::is_constant_evaluated() && {test})"
            if _is_statement(m):
                original = f"{{ if ({test}) {{ {m.new} }} else {{ {original} }} }}"
            else:
                original = f"({test} ? ({m.new}) : ({original}))"
        text += source[at:first.begin] + original
        at = first.end
    return text + source[at:end]


def changed_source(mutants, source):
    """Returns the source with all of its mutants. A constexpr variable that has one becomes const."""
    text = _render(mutants, source, 0, len(source))
    text = re.sub(r"\bconstexpr (?=[^;{}()=]*= *[^;]*keepout_mutants::is)", "const ", text)
    include = '#include "keepout/mutant.h"\n'
    once = "#pragma once\n"
    if once in text:
        return text.replace(once, once + include, 1)
    return include + text
