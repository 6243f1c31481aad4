# SPDX-License-Identifier: BSD-3-Clause
"""A short unit of each experiment has the rows of golden_rows/: texts and counts exactly, numbers to five digits.

Another processor may round the last of the six printed digits differently, and noise near 0 altogether.

If a change of rows is intended, write them again, and say why in the commit:

    python3 tests/experiments/test_golden_rows.py [e4_cutting ...]
"""
import importlib
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from experiments import anatomy, runner
from experiments.arguments import NAMES
from experiments.experiment import Row, Scale, Unit

GOLDEN = Path(__file__).parent / "golden_rows"
MODES = ("none", "paper", "certified")

#: Settings that make a unit short.
SHORT: dict[str, dict[str, Any]] = {
    "e1_validation": {"loops": 2},
    "e2_run_time": {"triangles": 5000, "queries": 40},
    "e3_path_tracing": {"number": 5},  # the first five have drawn trajectories: long rows
    "e5_distance_field": {"anatomy": "airway", "loops": 2, "samples": 300, "cells": [1.0]},
    "e7_margin": {"draws": 1},
}


def short_units(experiment: str) -> list[Unit]:
    """Returns a unit of each of MODES, or the first unit if units have no mode."""
    units = importlib.import_module(f"experiments.{experiment}").units(Scale())
    of_modes = [next((u for u in units if u.settings.get("mode") == mode), None) for mode in MODES]
    chosen = [unit for unit in of_modes if unit] or units[:1]
    return [replace(unit, settings=unit.settings | SHORT.get(experiment, {})) for unit in chosen]


def rows_of(experiment: str) -> list[Row]:
    module = importlib.import_module(f"experiments.{experiment}")
    return [row for unit in short_units(experiment) for row in module.run(unit)]


def prepared() -> bool:
    try:
        anatomy.mesh_file("skull")
        anatomy.mesh_file("bunny")
        anatomy.mesh_file("airway")
    except (OSError, anatomy.subprocess.CalledProcessError):
        return False
    return True


@pytest.mark.skipif(not prepared(), reason="needs sample meshes: fixtures/prepare skull bunny airway")
@pytest.mark.parametrize("experiment", NAMES)
def test_rows_are_the_golden_ones(experiment: str) -> None:
    made = runner.tables(experiment, rows_of(experiment))[experiment]
    golden = (GOLDEN / f"{experiment}.csv").read_text()
    if made == golden:
        return
    here, there = ([line.replace(" ", ",").split(",") for line in text.splitlines()] for text in (made, golden))
    assert [len(line) for line in here] == [len(line) for line in there]
    for line, expected in zip(here, there):
        assert all(map(same, line, expected)), f"{line} are not {expected}"


def same(cell: str, expected: str) -> bool:
    """Returns whether two cells are the same text or whole number, or numbers that agree to five digits."""
    try:
        numbers = float(cell), float(expected)
    except ValueError:
        return cell == expected
    return cell == expected or not all(map(float.is_integer, numbers)) and numbers[0] == pytest.approx(
        numbers[1], rel=1e-5, abs=1e-9)


if __name__ == "__main__":
    GOLDEN.mkdir(exist_ok=True)
    for name in sys.argv[1:] or NAMES:
        (GOLDEN / f"{name}.csv").write_text(runner.tables(name, rows_of(name))[name])
