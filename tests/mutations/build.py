# SPDX-License-Identifier: BSD-3-Clause
"""Builds all mutants at once, from a copy of the sources."""

import json
import os
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
    """Returns the mutants with their numbers in the build. Throws if the build has others."""
    numbers = json.loads(NUMBERS.read_text()) if NUMBERS.is_file() else {}
    old = [m.name for m in mutants if numbers.get(m.name, [0, ""])[1] != m.digest()]
    if old:
        raise TableError(f"call `tests/mutations/run build` again: the build lacks {', '.join(old)}")
    for mutant in mutants:
        mutant.number = numbers[mutant.name][0]
    return mutants


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
    subprocess.run(["ninja", "-C", str(OUT), f"-j{jobs}", "-k", "0", *targets], check=True)
