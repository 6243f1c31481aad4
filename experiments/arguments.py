# SPDX-License-Identifier: BSD-3-Clause
"""The arguments of ./run experiments. Needs nothing that is built: ./run reports a mistake in them before it builds."""
from __future__ import annotations

import argparse
import sys
from pathlib import Path

NAMES = tuple(file.stem for file in sorted(Path(__file__).parent.glob("e[0-9]*_*.py")))


def parser() -> argparse.ArgumentParser:
    names = ", ".join(f"{name.split('_')[0]} ({name[3:].replace('_', ' ')})" for name in NAMES)
    of = argparse.ArgumentParser(
        prog="./run experiments",
        allow_abbrev=False,
        description="Runs the experiments of Li et al. (IROS 2020) again, with their rule, keepout's and "
        "others. Writes tables, figures and a report. What is done is kept: a run that was stopped "
        "goes on where it was. See docs/experiments.md.",
    )
    of.add_argument("--full", action="store_true", help="all shapes and sizes, more repetitions: about an hour")
    of.add_argument("--seed", type=int, default=1, help="of all random numbers (default: 1)")
    of.add_argument("--only", metavar="E1,E3", default="", help=f"some of {names}")
    of.add_argument("--modes", metavar="NAMES", default="", help="the modes to compare, such as vector_field,fcl_slide: "
                    "fewer modes take less time. none, paper and certified are always compared")
    of.add_argument("--rule", type=_rule, metavar="FILE:CLASS", help="also compare a rule of your own, such as "
                    "mine.py:MyRule; examples/python/own_rule.py is one")
    of.add_argument("--out", type=_folder, metavar="FOLDER", help="where to write (default: out/experiments "
                    "beside run, with --full out/experiments_full)")
    of.add_argument("--jobs", type=int, metavar="N", help="processes at once (default: one a processor)")
    of.add_argument("--dask", metavar="ADDRESS", help="run on a Dask cluster: the address of its scheduler, such as "
                    "tcp://HOST:8786. All machines need this folder. Units that measure times run here")
    of.add_argument("-q", "--quiet", action="store_true", help="print no progress: only results, warnings and errors")
    of.add_argument("--fresh", action="store_true", help="begin anew, and forget what is kept")
    return of


def _folder(text: str) -> Path:
    if not text:
        raise argparse.ArgumentTypeError("expected the name of a folder, not ''")
    return Path(text)


def _rule(text: str) -> str:
    file, _, name = text.rpartition(":")
    if not file.endswith(".py") or not name.isidentifier():
        raise argparse.ArgumentTypeError(f"expected FILE.py:CLASS, not '{text}'")
    if not Path(file).is_file():
        raise argparse.ArgumentTypeError(f"there is no file '{file}'")
    return f"{Path(file).resolve()}:{name}"


def read(arguments: list[str]) -> argparse.Namespace:
    """Returns what the arguments say; `only` has the names of the experiments that are named."""
    told = parser().parse_args(arguments)
    known = {name.split("_")[0]: name for name in NAMES}
    chosen = [name.strip().lower() for name in told.only.split(",")] if told.only else []
    wrong = sorted(set(chosen) - set(known))
    if wrong:
        parser().error(f"--only: there is no '{', '.join(wrong)}'; there are {', '.join(known)}")
    told.only = [known[name] for name in chosen]
    if not 0 <= told.seed < 2**32:
        parser().error("--seed: give a whole number from 0 to 4294967295")
    if told.jobs is not None and told.jobs < 1:
        parser().error("--jobs: give 1 or more")
    return told


if __name__ == "__main__":
    read(sys.argv[1:])
