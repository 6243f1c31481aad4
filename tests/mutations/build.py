# SPDX-License-Identifier: BSD-3-Clause
"""Builds all mutants at once, from a copy of the sources."""

import os
import subprocess

from table import FOLDER, ROOT, TableError, changed_source, locate, read_table

BUILD = ROOT / "build" / "mutations"
WITHOUT = ("FCL BULLET EMBREE CCD NLOPT OMPL URDF MUJOCO CGAL ROS1 DDS").split()


def write_if_different(path, data):
    """Writes the file only if it differs, so that ninja compiles only what changed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_bytes() != data:
        path.write_bytes(data)
        return True
    return False


def write_tree(mutants):
    """Writes the copy of the sources. Returns the number of files that changed since the last call."""
    wrong = locate(mutants)
    if wrong:
        raise TableError("\n".join(wrong))
    by_file = {}
    for mutant in mutants:
        by_file.setdefault(mutant.file, []).append(mutant)
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
    changed, tree = 0, BUILD / "tree"
    names = [name for name in listed.decode().split("\0") if name and (ROOT / name).is_file()]
    for name in names:
        data = (ROOT / name).read_bytes()
        if name in by_file:
            data = changed_source(by_file[name], data.decode()).encode()
        changed += write_if_different(tree / name, data)
        (tree / name).chmod((ROOT / name).stat().st_mode)
    changed += write_if_different(tree / "engine/include/keepout/mutant.h", (FOLDER / "mutant.h").read_bytes())
    for path in [p for p in tree.rglob("*") if p.is_file()]:
        if str(path.relative_to(tree)) not in {*names, "engine/include/keepout/mutant.h"}:
            path.unlink()
    return changed


def build(targets, jobs):
    """Builds the programs with all mutants."""
    mutants = read_table()
    print(f"{len(mutants)} mutants; {write_tree(mutants)} files changed", flush=True)
    out = BUILD / "out"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("CMAKE_")}
    if not (out / "build.ninja").is_file():
        # Three of the five SIMD targets, and no modules, which have no mutants.
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DKEEPOUT_SHARE_HEADERS=ON", "-DKEEPOUT_BUILD_EXAMPLES=OFF",
                   "-DKEEPOUT_BUILD_PYTHON=OFF", "-DKEEPOUT_INSTALL=OFF", "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG -w",
                   # SSSE3 and SSE4 by their numbers, because CMake's test of the compiler quotes nothing.
                   "-DCMAKE_CXX_FLAGS=-DHWY_DISABLED_TARGETS=6144"]
        options += [f"-DKEEPOUT_WITH_{name}=OFF" for name in WITHOUT]
        subprocess.run(["cmake", "-S", str(BUILD / "tree"), "-B", str(out), "-G", "Ninja", *options], check=True,
                       env=environment)
    subprocess.run(["ninja", "-C", str(out), f"-j{jobs}", *targets], check=True, env=environment)
