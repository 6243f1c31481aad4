# SPDX-License-Identifier: BSD-3-Clause
"""The command line: runs experiments, writes their tables, their figures and the report."""
from __future__ import annotations

import argparse
import importlib
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import keepout

from . import record, runner, summary
from .experiment import Findings, Scale

EXPERIMENTS = tuple(importlib.import_module(f".{file.stem}", __package__)
                    for file in sorted(Path(__file__).parent.glob("e[0-9]*_*.py")))


def parser() -> argparse.ArgumentParser:
    names = ", ".join(f"{e.NAME.split('_')[0]} ({e.NAME[3:].replace('_', ' ')})" for e in EXPERIMENTS)
    of = argparse.ArgumentParser(
        prog="./run experiments",
        allow_abbrev=False,
        description="Repeats the experiments of Li et al. (IROS 2020) with their rule, keepout's rules and "
        "others. Writes tables, figures and a report. Finished units are kept: a run that was stopped "
        "continues where it stopped. See docs/experiments.md.",
    )
    of.add_argument("--full", action="store_true", help="all shapes and sizes, more repetitions; takes about an hour")
    of.add_argument("--seed", type=int, default=1, help="seed of all random numbers (default: 1)")
    of.add_argument("--only", metavar="E1,E3", default="", help=f"run only these: {names}")
    of.add_argument("--out", type=_folder, metavar="FOLDER", help="output directory (default: out/experiments "
                    "beside run, with --full out/experiments_full)")
    of.add_argument("--jobs", type=int, metavar="N",
                    help="number of parallel processes (default: one for each processor)")
    of.add_argument("-q", "--quiet", action="store_true", help="print no progress, only results, warnings and errors")
    of.add_argument("--fresh", action="store_true", help="delete kept units and start again")
    return of


def _folder(text: str) -> Path:
    if not text:
        raise argparse.ArgumentTypeError("expected the name of a folder, not ''")
    return Path(text)


def main(arguments: list[str]) -> int:
    told = parser().parse_args(arguments)
    if told.quiet:
        os.environ["KEEPOUT_QUIET"] = "1"  # also for programs that this one starts
    chosen = {name.strip().lower() for name in told.only.split(",") if name.strip()}
    known = {e.NAME.split("_")[0]: e for e in EXPERIMENTS}
    wrong = sorted(chosen - set(known))
    if wrong:
        parser().error(f"--only: unknown: {', '.join(wrong)}; known: {', '.join(known)}")
    if not 0 <= told.seed < 2**32:
        parser().error("--seed: give a whole number from 0 to 4294967295")
    if told.jobs is not None and told.jobs < 1:
        parser().error("--jobs: give 1 or more")
    experiments = [e for name, e in known.items() if not chosen or name in chosen]
    root = Path(__file__).resolve().parent.parent
    folder: Path = told.out or root / "out" / ("experiments_full" if told.full else "experiments")
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    if told.fresh:
        for experiment in experiments:
            shutil.rmtree(runner.folder_kept(folder, told.seed) / experiment.NAME, ignore_errors=True)

    scale = Scale(full=told.full, seed=told.seed)
    units = {e.NAME: e.units(scale) for e in experiments}
    jobs = told.jobs or len(os.sched_getaffinity(0))
    try:
        rows = runner.run_units(experiments, units, runner.folder_kept(folder, told.seed), jobs)
    except KeyboardInterrupt:
        print(f"\nkeepout: stopped. Finished units are kept in {folder}; the same command continues from there.",
              file=sys.stderr)
        return 130

    findings: dict[str, tuple[str, Findings]] = {}
    for experiment in experiments:
        name = experiment.NAME
        runner.write_tables(name, rows[name], folder)
        found = experiment.findings(rows[name], scale)
        for figure in found.figures:
            (folder / "figures" / f"{figure.name}.svg").write_text(figure.svg)
        findings[name] = (experiment.TITLE, found)
        print(f"{experiment.TITLE}\n  {found.headline}")
    command = shlex.join(["./run", "experiments", *arguments])
    (folder / "README.md").write_text(summary.text(findings, command, keepout.__version__))
    file = folder / "experiments.json"
    record.write_record(file, scale, findings, complete=len(experiments) == len(EXPERIMENTS), command=command)
    reported = _report(file)
    print(f"tables and figures in {folder}; {'report' if reported else 'record'} in {reported or file}")
    return 0


def _report(file: Path) -> Path | None:
    """Makes the page of a record and returns its path; None if the command that makes it is unknown."""
    command = os.environ.get("KEEPOUT_COMMAND")
    if not command:
        return None
    page = file.with_suffix(".html")
    subprocess.run([command, "report", str(file), "--out", str(page)], check=True, stdout=sys.stderr)
    return page


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (keepout.Error, OSError, runner.UnitError, subprocess.CalledProcessError) as error:
        print(f"keepout: {error}", file=sys.stderr)
        sys.exit(1)
