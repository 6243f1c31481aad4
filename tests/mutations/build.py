# SPDX-License-Identifier: BSD-3-Clause
"""Builds all mutants at once, from a copy of the sources."""

import json
import re
import subprocess

from table import FOLDER, ROOT, TableError, changed_source, locate, read_table

BUILD = ROOT / "build" / "mutations"
NUMBERS = BUILD / "numbers.json"
TREE = BUILD / "tree"
OUT = TREE / "build" / "release"  # in the copy as in the tree, so that ccache knows what has not changed


def write_if_different(path, data):
    """Writes the file only if it differs, so that ninja compiles only what changed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_bytes() != data:
        path.write_bytes(data)
        return True
    return False


def give_numbers(mutants):
    """Numbers the mutants. A mutant keeps its number, so that a new row of the table changes only its own source."""
    old = json.loads(NUMBERS.read_text()) if NUMBERS.is_file() else {}
    names = {m.name for m in mutants}
    used = {number for name, (number, _) in old.items() if name in names}
    free = iter(n for n in range(1, 2000) if n not in used)
    for mutant in mutants:
        mutant.number = old[mutant.name][0] if mutant.name in old else next(free)
    write_if_different(NUMBERS, json.dumps({m.name: (m.number, m.digest()) for m in mutants}).encode())


def built(mutants):
    """Returns the mutants that are in the build, with their numbers there. Names the others."""
    numbers = json.loads(NUMBERS.read_text()) if NUMBERS.is_file() else {}
    lacking = [m.name for m in mutants if numbers.get(m.name, [0, ""])[1] != m.digest()]
    if lacking:
        print(f"not in the build: {', '.join(lacking)}", flush=True)
    found = [m for m in mutants if m.name not in lacking]
    for mutant in found:
        mutant.number = numbers[mutant.name][0]
    return found


def write_tree(mutants):
    """Writes the copy of the sources. Returns the number of files that changed since the last call."""
    wrong = locate(mutants)
    if wrong:
        raise TableError("\n".join(wrong))
    give_numbers(mutants)
    by_file = {}
    for mutant in mutants:
        by_file.setdefault(mutant.file, []).append(mutant)
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
    changed = 0
    names = [name for name in listed.decode().split("\0") if name and (ROOT / name).is_file()]
    for name in names:
        data = (ROOT / name).read_bytes()
        if name in by_file:
            data = changed_source(by_file[name], data.decode()).encode()
        changed += write_if_different(TREE / name, data)
        (TREE / name).chmod((ROOT / name).stat().st_mode)
    changed += write_if_different(TREE / "engine/include/keepout/mutant.h", (FOLDER / "mutant.h").read_bytes())
    kept = {*names, "engine/include/keepout/mutant.h"}
    for path in [p for top in TREE.iterdir() if top.name != "build" for p in [top, *top.rglob("*")] if p.is_file()]:
        if str(path.relative_to(TREE)) not in kept:
            path.unlink()
    return changed


def build(targets, jobs):
    """Builds the programs with all mutants: the preset release of the copy."""
    mutants = read_table()
    print(f"{len(mutants)} mutants; {write_tree(mutants)} files changed", flush=True)
    if not (OUT / "build.ninja").is_file():
        subprocess.run(["cmake", "--preset", "release"], cwd=TREE, check=True)
    while True:
        ninja = subprocess.Popen(["ninja", "-C", str(OUT), f"-j{jobs}", "-k", "0", *targets], text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        errors = set()
        for line in ninja.stdout:
            print(line, end="", flush=True)
            place = re.match(r"(.*/tree/\S+?):(\d+):\d+: error: ", line)
            if place:
                errors |= mutants_of_line(place[1], int(place[2]), mutants)
        if ninja.wait() == 0:
            return
        if not errors:
            raise TableError("the build failed, and no mutant is at the place of an error")
        print("these mutants do not compile, and are left out: " + ", ".join(sorted(errors)), flush=True)
        mutants = [m for m in mutants if m.name not in errors]
        write_tree(mutants)


def mutants_of_line(name, number, mutants):
    """Returns the names of the mutants in a line of the copy, or in the nearest of a few lines above it."""
    lines = (OUT / name).resolve().read_text(encoding="utf-8").split("\n")
    for line in reversed(lines[max(0, number - 6):number]):
        numbers = {int(n) for n in re.findall(r"keepout_mutants::is\((\d+)\)", line)}
        if numbers:
            return {m.name for m in mutants if m.number in numbers}
    return set()
