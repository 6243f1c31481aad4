# SPDX-License-Identifier: BSD-3-Clause
"""The command line: runs experiments, writes their tables, their figures and the report."""
from __future__ import annotations

import importlib
import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import keepout
from keepout import _workers

from .arguments import NAMES, read


def main(arguments: list[str]) -> int:
    told = read(arguments)
    # Programs and workers that this one starts obey these as well.
    chosen = {"KEEPOUT_QUIET": told.quiet and "1", "KEEPOUT_MODES": told.modes, "KEEPOUT_RULE": told.rule}
    os.environ.update({name: value for name, value in chosen.items() if value})
    # Only now, because modes.py reads them when it is imported.
    from . import modes, published_numbers, record, results, runner, summary
    from .experiment import Findings, Scale

    unknown = sorted({name for name in told.modes.split(",") if name} - set(modes.MODES))
    if unknown:
        known = ", ".join(modes.BUILT_IN)
        print(f"keepout: --modes: there is no '{', '.join(unknown)}'; there are {known}", file=sys.stderr)
        return 2
    experiments = [importlib.import_module(f".{name}", __package__) for name in told.only or NAMES]
    root = Path(__file__).resolve().parent.parent
    folder: Path = told.out or root / "out" / ("experiments_full" if told.full else "experiments")
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    if told.fresh:
        for experiment in experiments:
            shutil.rmtree(runner.folder_kept(folder, told.seed) / experiment.NAME, ignore_errors=True)

    scale = Scale(full=told.full, seed=told.seed)
    units = {e.NAME: e.units(scale) for e in experiments}
    jobs = told.jobs or len(os.sched_getaffinity(0))
    _workers.stop_on_signals()
    try:
        rows = runner.run_units(experiments, units, runner.folder_kept(folder, told.seed), jobs, told.dask)
    except KeyboardInterrupt:
        print(f"\nkeepout: stopped. Finished units are kept in {folder}; the same command continues from there.",
              file=sys.stderr)
        return 130

    findings: dict[str, tuple[str, Findings]] = {}
    if any(e.NAME in rows for e in published_numbers.FROM):
        findings[published_numbers.NAME] = (published_numbers.TITLE, published_numbers.findings(rows, scale))
    for experiment in experiments:
        findings[experiment.NAME] = (experiment.TITLE, experiment.findings(rows[experiment.NAME], scale))
        for name, table in runner.tables(experiment.NAME, rows[experiment.NAME]).items():
            (folder / f"{name}.csv").write_text(table)
    for title, found in findings.values():
        print(f"{title}\n  {found.headline}")
        for figure in found.figures:
            (folder / "figures" / f"{figure.name}.svg").write_text(figure.svg)
    command = shlex.join(["./run", "experiments", *arguments])
    (folder / "README.md").write_text(summary.text(findings, command, keepout.__version__))
    (folder / results.SOURCES).write_text(json.dumps(results.sources(units), indent=1) + "\n")
    file = folder / "experiments.json"
    record.write_record(file, scale, findings, complete=len(experiments) == len(NAMES), command=command)
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
    except (keepout.Error, OSError, RuntimeError, subprocess.CalledProcessError) as error:
        print(f"keepout: {error}", file=sys.stderr)
        sys.exit(1)
