#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the table of promises and features: promises_test.py ROOT [--table]

promises.ini beside this file has a section for each feature. A section lists the entry points of the
feature, and has a cell for each promise of docs/safety.md. A line of a cell names a test:

    PROGRAM Suite.Test          A GoogleTest in PROGRAM of tests/CMakeLists.txt.
    test_FILE.py::test_NAME     A Python test.
    ctest NAME                  A ctest test.
    -: REASON                   The only line: why this feature needs no test.

The check fails if a promise has no cell or an empty one, or if a test does not exist. It also fails if
an entry point in the sources has no feature. --table prints the table.
"""

import configparser
import pathlib
import re
import sys
import textwrap

ROOMS = ("engine", "robot", "control", "adapters")  # their public headers have entry points
STATUSES = {"Status", "CycleStatus"}
ENTRIES = "entry points"


def read(path):
    return path.read_text(encoding="utf-8")


def promises_of(root):
    """Returns the promises that docs/safety.md makes, in its order."""
    return re.findall(r"^\| \*\*(P\d+)\*\* \|", read(root / "docs/safety.md"), re.M)


# Tests.


def programs_of(root):
    """Returns the names Suite.Test of each program of tests/CMakeLists.txt."""
    lists = re.sub(r"#.*", "", read(root / "tests/CMakeLists.txt"))
    programs = {}
    for name, sources in re.findall(r"(?:keepout_test|target_sources)\(\s*(\w+)([^)]*)\)", lists):
        for source in re.findall(r"[\w/]+\.cpp", sources):
            text = read(root / "tests" / source)
            tests = re.findall(r"^(?:TYPED_)?TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\s*\)", text, re.M)
            programs.setdefault(name, set()).update(f"{suite}.{test}" for suite, test in tests)
    return programs


def python_tests_of(root):
    return {f"{path.name}::{name}" for path in (root / "tests").rglob("test_*.py")
            for name in re.findall(r"^def (test_\w+)\(", read(path), re.M)}


def ctest_names_of(root):
    names = set()
    for path in (root / "tests").rglob("CMakeLists.txt"):
        text = read(path)
        names.update(re.findall(r"add_test\(NAME ([\w.]+)\s", text))
        names.update("web." + name for name in re.findall(r"^web_test\((\w+)", text, re.M))
    return names


# Entry points.


def declarations_in(path):
    """Returns a header without comments, attributes and default arguments that are empty."""
    return re.sub(r"//[^\n]*|/\*.*?\*/|\[\[.*?\]\] ?| = \{\}", "", read(path), flags=re.S)


def types_in(text):
    """Yields the keyword, name, bases and body of each class and struct at namespace level."""
    for head in re.finditer(r"^(?:template <[^\n]*>\n)?(class|struct) (\w+)([^;{(]*)\{", text, re.M):
        end = re.compile(r"^\}", re.M).search(text, head.end()).start()
        yield head[1], head[2], head[3], text[head.end():end]


def public_part(keyword, body):
    """Returns the public declarations of a class or struct, without the bodies of functions."""
    parts = re.split(r"^ (public|protected|private):", body, flags=re.M)
    public = parts[0] if keyword == "struct" else ""
    public += "".join(text for access, text in zip(parts[1::2], parts[2::2]) if access == "public")
    while (inner := re.sub(r"\{[^{}]*\}", ";", public)) != public:
        public = inner
    return public


def functions_in(declarations):
    """Yields the return type, name and qualifiers of each function."""
    for declaration in declarations.split(";"):
        words = " ".join(declaration.split())
        function = re.match(r"((?:[\w:&<>*,]+ )+?)[&*]?(\w+)\((.*)\)([\w ]*)", words)
        if function:
            yield function[1].split(), function[2], function[4].split()


def entry_points_in_headers(root):
    headers = {path: declarations_in(path) for room in ROOMS
               for path in sorted((root / room).glob("**/include/keepout/**/*.h"))}
    types = [(path, *each) for path, text in headers.items() for each in types_in(text)]
    answers = STATUSES | {name for _, _, name, _, body in types
                          if re.search(rf"^  (?:{'|'.join(STATUSES)}) status\b", body, re.M)}
    for path, keyword, name, bases, body in types:
        public = public_part(keyword, body)
        functions = list(functions_in(public))
        # A rule is one entry point, because a constraint calls its functions.
        if "public ActivationRule" in bases:
            yield name
        elif name != "ActivationRule" and any(
                answers & set(result) and "noexcept" in after and "const" not in after
                for result, _, after in functions):
            yield from (f"{name}::{function}" for result, function, after in functions
                        if "const" not in after and "static" not in result and function != name
                        and function != "operator")
        if name in ("Guide", "Region"):  # each is a kind of guide or region
            yield from (f"{name}::{function}" for result, function, _ in functions
                        if "static" in result)
        yield from (f"{name}::{field}" for field in
                    re.findall(r"^  std::vector<Guide> (\w+)(?= =|;| \{)", public, re.M))
        if "ompl" in path.parts and keyword == "class":
            yield name
    for path, text in headers.items():
        outside = re.sub(r"^(?:class|struct) \w+[^;{(]*\{.*?^\};", "", text, flags=re.M | re.S)
        outside = re.sub(r"^[#n}][^\n]*", "", outside, flags=re.M)
        for result, function, _ in functions_in(re.sub(r"\{[^{}]*\}", ";", outside)):
            if "ompl" in path.parts or (answers - STATUSES) & set(result):
                yield function


def entry_points_in_python(root):
    defined = re.compile(r'(?<!module)\.def\(\s*"([a-z]\w*)"')
    of_both = defined.findall(read(root / "python/src/guard_of.h"))
    for path in (root / "python/src").glob("*.cpp"):
        text = read(path)
        methods = defined.findall(text) + (of_both if "bind_guard<" in text else [])
        if "step" in methods:
            name = re.search(r'type\(module, "(\w+)"', text)[1]
            yield from (f"{name}.{method}" for method in methods)


def entry_points_of(root):
    verbs = re.findall(r'\{"(\w+)",\s*\{', read(root / "apps/keepout/serve/client.cpp"))
    return {*entry_points_in_headers(root), *entry_points_in_python(root),
            *(f"serve {verb}" for verb in verbs)}


# The check.


def lines_of(cell):
    return [line.strip() for line in cell.splitlines() if line.strip()]


class Sources:
    def __init__(self, root):
        self.promises = promises_of(root)
        self.programs = programs_of(root)
        self.other_tests = python_tests_of(root) | {f"ctest {name}" for name in ctest_names_of(root)}
        self.entry_points = entry_points_of(root)

    def has_test(self, line):
        program, _, test = line.partition(" ")
        return line in self.other_tests or test in self.programs.get(program, ())

    def faults_of_cell(self, lines):
        if not lines:
            yield "is empty: name a test, or write '-: ' and a reason why there is no test"
        if lines and lines[0].startswith("-"):
            if len(lines) > 1 or not re.fullmatch(r"-: \w.{9,}", lines[0]):
                yield "has neither tests nor '-: ' with a reason"
            return
        yield from (f"names '{line}', which is not a test" for line in lines if not self.has_test(line))

    def faults_of(self, table):
        named = set()
        for feature, cells in table.items():
            entries = set(lines_of(cells.get(ENTRIES, "")))
            named |= entries
            yield from (f"{feature}: there is no entry point '{entry}'"
                        for entry in sorted(entries - self.entry_points))
            yield from (f"{feature}: '{promise}' is not a promise of docs/safety.md"
                        for promise in cells if promise not in (*self.promises, ENTRIES))
            for promise in self.promises:
                lines = lines_of(cells.get(promise, ""))
                yield from (f"{feature}, {promise}: {fault}" for fault in self.faults_of_cell(lines))
        yield from (f"'{entry}' is an entry point of no feature: add it to '{ENTRIES}' of one, or add "
                    "a section and fill its cells" for entry in sorted(self.entry_points - named))


def read_table(path):
    parser = configparser.ConfigParser(delimiters=("=",), comment_prefixes=("#",),
                                       interpolation=None)
    parser.optionxform = str
    parser.read_string(read(path))
    return {feature: dict(parser[feature]) for feature in parser.sections()}


def require_that_faults_are_found(sources, table):
    """Fails if the check does not find a fault that this function adds to the table."""
    feature = next(iter(table))
    entries = table[feature][ENTRIES]
    changes = {"no cell": {"P1": ""}, "a promise that is none": {"P99": "-: there is no such promise"},
               "no reason": {"P1": "-:"}, "a test that is none": {"P1": "step_test Step.Nonsense"},
               "a program that is none": {"P1": "no_test Step.TheMarginIsKept"},
               "no entry point": {ENTRIES: "\n".join(lines_of(entries)[1:])},
               "an entry point that is none": {ENTRIES: entries + "\nMotionConstraint::nonsense"}}
    for name, change in changes.items():
        if not list(sources.faults_of({**table, feature: {**table[feature], **change}})):
            sys.exit(f"the check overlooks a table with {name}")
    if len(sources.entry_points) < 50 or len(sources.promises) < 14:
        sys.exit("the check finds too few entry points or promises: adapt it to the sources")


def print_table(sources, table):
    for feature, cells in table.items():
        print(f"\n{feature} ({', '.join(lines_of(cells[ENTRIES]))})")
        for promise in sources.promises:
            text = "; ".join(lines_of(cells[promise]))
            print(textwrap.fill(text, 110, initial_indent=f"  {promise:<4}", subsequent_indent="      "))


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    sources = Sources(root)
    table = read_table(root / "tests/docs/promises.ini")
    faults = list(sources.faults_of(table))
    if faults:
        sys.exit("\n".join(faults))
    require_that_faults_are_found(sources, table)
    if "--table" in sys.argv[2:]:
        print_table(sources, table)
    cells = [cell for cells in table.values() for name, cell in cells.items() if name != ENTRIES]
    reasons = sum(lines_of(cell)[0].startswith("-") for cell in cells)
    print(f"{len(sources.promises)} promises, {len(table)} features, {len(sources.entry_points)} entry "
          f"points: {len(cells) - reasons} cells name tests, {reasons} state why there is no test")


if __name__ == "__main__":
    main()
