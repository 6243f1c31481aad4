# SPDX-License-Identifier: BSD-3-Clause
"""The command line: runs experiments, writes their tables, their figures and the report."""
from __future__ import annotations

import importlib
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import keepout

from . import record, runner, summary
from .arguments import NAMES, read
from .experiment import Findings, Scale

EXPERIMENTS = tuple(importlib.import_module(f".{name}", __package__) for name in NAMES)


def main(arguments: list[str]) -> int:
    told = read(arguments)
    if told.quiet:
        os.environ["KEEPOUT_QUIET"] = "1"  # programs that this one starts obey it as well
    experiments = [e for e in EXPERIMENTS if not told.only or e.NAME in told.only]
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
