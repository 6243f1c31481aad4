# SPDX-License-Identifier: BSD-3-Clause
"""Runs the units of experiments on all processors, and keeps the rows of each finished unit.

The rows of a unit are kept in `kept/seed<seed>/<experiment>/<unit>.json`. They are reused while the unit and the code
behind its rows are unchanged, so a stopped run continues where it stopped. The code of a mode counts only for the
units of that mode: a new rule leaves the rows of all others. The tables contain all rows: `<experiment>.csv`, which
depends on the seed only, and `<experiment>_times.csv` with measured times.
"""
from __future__ import annotations

import ast
import csv
import hashlib
import importlib
import io
import json
import os
import re
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from functools import lru_cache
from modulefinder import ModuleFinder
from pathlib import Path
from types import ModuleType
from typing import Any

import keepout
from keepout import _workers

from . import modes
from .experiment import Row, Unit

#: Members of a row with measured times begin with this.
TIMED = "measured_"

#: Significant digits of numbers in tables. Rows that are kept have all.
DIGITS = 6

#: Modules on which no row depends: they only show rows, or choose which ones are made.
_SHOWING = ("__main__", "arguments", "comparison", "figures", "modes", "published", "published_design",
            "published_numbers", "record", "runner", "summary")
HERE = Path(__file__).parent


def source_digest(experiment: str, mode: str | None = None, *, libraries: bool = True) -> str:
    """Returns a digest of the code behind the rows of an experiment: its modules, and the rule of a mode.

    The code counts, not its comments and docstrings. In the experiment's own module, only what run() needs counts, so
    other tables and figures leave the rows. The C++ of benchmarks/native counts as a whole. A mode that modes.py
    does not have depends on the rules of the references. With mode None, a unit depends on all rules of this package if
    the experiment uses any. libraries: True adds keepout as it is built.
    """
    digest = hashlib.sha256(keepout.__version__.encode())
    if libraries:
        package = Path(keepout.__file__).parent
        for file in sorted([*package.parent.glob("*.so"), *package.glob("*.so"), *package.glob("*.py")]):
            digest.update(_bytes_digest(file))
    found = _modules(f"{HERE.name}.{experiment}")
    own_module = HERE / f"{experiment}.py"
    digest.update(_code(found - {own_module}) + _tree(own_module, "run").encode())
    if HERE / "rules" / "rule.py" in found:
        behind = modes.BUILT_IN if mode is None else (mode,) if mode in modes.MODES else modes.REFERENCES
        for source in filter(None, map(modes.source, behind)):
            is_of_user = source.module.endswith(".py")
            files = {Path(source.module)} if is_of_user else _modules(f"{HERE.name}.rules.{source.module}")
            digest.update(repr((source.name, source.options)).encode() + _code(files))
    return digest.hexdigest()[:16]


@lru_cache(maxsize=None)
def _modules(name: str) -> frozenset[Path]:
    """Returns the files of a module of this package and of those that it imports, without those of _SHOWING.

    The files of keepout_peers are its C++ sources.
    """
    finder = ModuleFinder([str(HERE.parent)], excludes=[f"{HERE.name}.{module}" for module in _SHOWING])
    finder.import_hook(name)
    native = (HERE.parent / "benchmarks" / "native").rglob("*.[ch]*") if "keepout_peers" in finder.any_missing() else ()
    return frozenset(native) | frozenset(Path(module.__file__) for module in finder.modules.values() if module.__file__)  # type: ignore[attr-defined]


def _code(files: Iterable[Path]) -> bytes:
    """Returns the code of files in Python and C++ as text without comments, docstrings and layout."""
    return "".join(_tree(file) for file in sorted(files)).encode()


@lru_cache(maxsize=None)
def _tree(file: Path, function: str | None = None) -> str:
    """Returns the code of a file; of Python, with a function, only what the function needs."""
    if file.suffix != ".py":
        return "".join(re.sub(r"//.*", "", file.read_text(encoding="utf-8")).split())
    tree = ast.parse(file.read_bytes())
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            first = body[0]
            if isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
                node.body = body[1:]
    if function:
        tree.body = _behind(tree.body, function)
    return ast.dump(tree)


def _behind(body: list[ast.stmt], function: str) -> list[ast.stmt]:
    """Returns the statements of a module that a function needs, the function itself, and those that define no name."""
    needed: set[int] = set()
    waiting = {function}
    while waiting:
        found = [node for node in body if id(node) not in needed and (not _bound(node) or _bound(node) & waiting)]
        needed |= {id(node) for node in found}
        waiting = {name.id for node in found for name in ast.walk(node) if isinstance(name, ast.Name)}
    return [node for node in body if id(node) in needed]


def _bound(node: ast.stmt) -> set[str]:
    """Returns the names that a statement of a module defines; none if it does more, such as a loop."""
    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
        return {node.name}
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return {(name.asname or name.name).split(".")[0] for name in node.names}
    if isinstance(node, (ast.Assign, ast.AnnAssign)):
        return {name.id for name in ast.walk(node) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)}
    return set()


@lru_cache(maxsize=None)
def _bytes_digest(file: Path) -> bytes:
    return hashlib.sha256(file.read_bytes()).digest()


def _be_a_worker() -> None:
    warnings.filterwarnings("ignore", "Mesh: ")  # counterexamples are open, and cavities face inward


def _run(module: str, unit: Unit) -> tuple[list[Row], float]:
    """Returns the rows of a unit, and the seconds that they took."""
    begun = time.monotonic()
    rows: list[Row] = importlib.import_module(module).run(unit)
    return rows, time.monotonic() - begun


def _answer() -> None:
    """Reads a module and a unit from stdin, and writes what _run() returns. A Dask worker runs this as a program."""
    _be_a_worker()
    module, *unit = json.load(sys.stdin)
    out, sys.stdout = sys.stdout, sys.stderr
    json.dump(_run(module, Unit(*unit)), out)


def _start(pool: Executor, on_cluster: bool, module: str, unit: Unit) -> Future[tuple[list[Row], float]]:
    """Starts a unit on a worker."""
    if not on_cluster:
        return pool.submit(_run, module, unit)
    environment = {name: value for name, value in os.environ.items() if name.startswith(("KEEPOUT_", "PYTHONPATH"))}
    command = [sys.executable, "-c", f"from {__name__} import _answer; _answer()"]
    lines = json.dumps([module, unit.name, unit.settings, unit.alone])
    return pool.submit(_workers.by_value(_workers.run_program), command, str(HERE.parent), environment, lines)


def _result(future: Future[tuple[Any, ...]]) -> tuple[list[Row], float]:
    """Returns the rows of a unit and the seconds that they took. Raises what stopped the unit."""
    result = future.result()
    if len(result) == 2:
        return result
    status, out, errors = result
    if status != 0:
        raise RuntimeError(errors.strip().splitlines()[-1] if errors.strip() else f"exit status {status}")
    rows, seconds = json.loads(out)
    return rows, seconds


class UnitError(RuntimeError):
    """Says which unit failed, and why. The rows of earlier units are kept."""


def folder_kept(folder: Path, seed: int) -> Path:
    """Returns the folder for the rows of a seed, within an output folder."""
    return folder / "kept" / f"seed{seed}"


class Kept:
    """The kept rows of the units of an experiment, in a folder."""

    def __init__(self, folder: Path, experiment: str) -> None:
        self._folder = folder / experiment
        self._experiment = experiment

    def _file(self, unit: Unit) -> Path:
        return self._folder / f"{unit.name}.json"

    def _digest(self, unit: Unit) -> str:
        return source_digest(self._experiment, unit.settings.get("mode"))

    def rows(self, unit: Unit) -> list[Row] | None:
        try:
            text = json.loads(self._file(unit).read_text())
            same = text["digest"] == self._digest(unit) and text["settings"] == json.loads(json.dumps(unit.settings))
            rows: list[Row] | None = text["rows"] if same else None
        except (OSError, ValueError, KeyError, TypeError):  # missing or incomplete
            return None
        return rows

    def keep(self, unit: Unit, rows: list[Row]) -> list[Row]:
        """Writes the rows, and returns them as a later run reads them, so that both runs have the same rows."""
        self._folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps({"digest": self._digest(unit), "settings": unit.settings, "rows": rows}, indent=1)
        part = self._file(unit).with_suffix(".part")
        part.write_text(text + "\n")
        part.replace(self._file(unit))
        plain: list[Row] = json.loads(text)["rows"]
        return plain


#: Units of a kind take about the same time: an experiment, and a mode or "".
Kind = tuple[str, str]


class Progress:
    """A line on the terminal, or a line every 10 seconds in a file: the finished units, and the time left.

    Prints nothing if KEEPOUT_QUIET is set.
    """

    INTERVAL = 10.0  # between lines in a file [s]

    def __init__(self, units: int) -> None:
        self._units = units
        self._done = 0
        self._shown = time.monotonic()
        self._jobs = 1
        self._left: list[Kind] = []
        self._seconds: dict[Kind, list[float]] = {}
        self._name = "nothing is finished yet"

    def begin(self, left: list[Kind], jobs: int) -> None:
        """Starts a batch of units, by their kinds, in `jobs` processes."""
        self._left, self._jobs = list(left), jobs

    def ran(self, kind: Kind, seconds: float) -> None:
        """Notes the time of a unit of this batch."""
        self._left.remove(kind)
        self._seconds.setdefault(kind, []).append(seconds)

    def count(self, name: str) -> None:
        """Counts a finished unit, or one that was kept."""
        self._done += 1
        self._name = name
        self.show(now=sys.stderr.isatty() or self._done == self._units)

    def time_left(self) -> float:
        """Returns the expected time of the batch [s]; 0 before a unit of it has finished.

        A unit takes as long as the finished ones of its kind, or else of its experiment, or else of all.
        """

        def expected(kind: Kind) -> float:
            of = self._seconds
            known = of.get(kind) or [s for k in of if k[0] == kind[0] for s in of[k]] or sum(of.values(), [])
            return sum(known) / len(known)

        if not self._seconds:
            return 0.0
        return sum(count * expected(kind) for kind, count in Counter(self._left).items()) / self._jobs

    def show(self, *, now: bool = False) -> None:
        """Prints the line if it is due, or immediately with `now`."""
        if os.environ.get("KEEPOUT_QUIET") or not (now or time.monotonic() - self._shown >= self.INTERVAL):
            return
        self._shown = time.monotonic()
        left = self.time_left()
        rest = f", {left / 60:.0f} min left" if left >= 60 else f", {left:.0f} s left" if left else ""
        line = f"{self._done} of {self._units} units{rest}: {self._name}"
        on_terminal = sys.stderr.isatty()
        print(f"\r\033[K{line}" if on_terminal else line,
              end="" if on_terminal and self._done < self._units else "\n", file=sys.stderr, flush=True)


def run_units(
    experiments: list[ModuleType], units: dict[str, list[Unit]], kept_in: Path, jobs: int, dask: str | None = None
) -> dict[str, list[Row]]:
    """Returns the rows of all units, by experiment, in the order of the units.

    Units that measure times run first, one after another, on this machine. The others run in `jobs` processes, or on
    the Dask cluster whose scheduler has the address `dask`. After a KeyboardInterrupt, finished units are kept.
    """
    kept = {e.NAME: Kept(kept_in, e.NAME) for e in experiments}
    progress = Progress(sum(len(of) for of in units.values()))
    results: dict[tuple[str, str], list[Row]] = {}
    left: list[tuple[ModuleType, Unit]] = []

    def done(experiment: ModuleType, unit: Unit, rows: list[Row]) -> None:
        results[experiment.NAME, unit.name] = rows
        progress.count(f"{experiment.NAME} {unit.name}")

    def kind(experiment: ModuleType, unit: Unit) -> Kind:
        return experiment.NAME, unit.settings.get("mode", "")

    for experiment in experiments:
        for unit in units[experiment.NAME]:
            if (rows := kept[experiment.NAME].rows(unit)) is None:
                left.append((experiment, unit))
            else:
                done(experiment, unit, rows)

    for alone in (True, False):
        batch = [(e, u) for e, u in left if u.alone is alone]
        if not batch:
            continue
        processes = 1 if alone else jobs
        progress.begin([kind(e, u) for e, u in batch], processes)
        on_cluster = dask is not None and not alone
        with _workers.cluster(dask) if on_cluster else _workers.processes(processes, _be_a_worker) as pool:
            running = {_start(pool, on_cluster, e.__name__, u): (e, u) for e, u in batch}
            while running:
                finished, _ = wait(running, timeout=Progress.INTERVAL, return_when=FIRST_COMPLETED)
                progress.show()
                faults: list[tuple[str, Exception]] = []
                for future in finished:
                    experiment, unit = running.pop(future)
                    try:
                        rows, seconds = _result(future)
                    except Exception as fault:
                        faults.append((f"{experiment.NAME} {unit.name}", fault))
                        continue
                    progress.ran(kind(experiment, unit), seconds)
                    done(experiment, unit, kept[experiment.NAME].keep(unit, rows))
                for name, fault in faults:
                    raise UnitError(f"{name}: {fault!r:.500}")
    return {e.NAME: [r for u in units[e.NAME] for r in results[e.NAME, u.name]] for e in experiments}


def tables(experiment: str, rows: list[Row]) -> dict[str, str]:
    """Returns the tables of an experiment as CSV, by name. Numbers have DIGITS significant digits."""
    members = list(dict.fromkeys(name for row in rows for name in row))
    timed = [name for name in members if name.startswith(TIMED)]
    steady = [name for name in members if not name.startswith(TIMED)]
    texts = [name for name in steady if any(isinstance(row.get(name), str) for row in rows)]
    named = {experiment: steady} | ({f"{experiment}_times": texts + timed} if timed else {})
    return {name: _table(columns, rows) for name, columns in named.items()}


def _table(columns: list[str], rows: list[Row]) -> str:
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row.get(column)) for column in columns] for row in rows)
    return out.getvalue()


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return " ".join(map(_cell, value))
    if isinstance(value, float):
        return f"{value:.{DIGITS}g}"
    return "" if value is None else str(value)
