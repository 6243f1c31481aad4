# SPDX-License-Identifier: BSD-3-Clause
"""Tests the tables of E1 on rows with a known result."""
import pytest

pytest.importorskip("keepout_peers")

from experiments import e1_validation as e1
from experiments.experiment import Scale


def row(mode, step_mm, entered, lost=0.0, loops=14, shape="cube"):
    return {"shape": shape, "mode": mode, "step_mm": step_mm, "loops": loops, "entered": entered, "steps": 100,
            "unsafe": 0, "free_asked": 10.0, "free_lost": lost, "excess": 0.0, "excess_of": 1, "deepest": 0.0,
            "clearance": 0.2}


def rows_of(mode, entered, **more):
    return [row(mode, length, entered, **more) for length in e1.LENGTHS]


def test_pairs_are_loops_that_both_modes_have():
    first, second = rows_of("paper", [1, 2, 3]), rows_of("certified", [3, 40], loops=280)
    pairs = 14 * len(e1.LENGTHS)
    only = 2 * len(e1.LENGTHS)
    p = 2.0 / 2**only
    assert e1._mcnemar(first, second) == f"McNemar, {only} against 0 of {pairs} loops, p = {p:.2g}"
    assert e1._mcnemar(first, first) == f"no loop of {pairs} differs"


def test_without_an_entry_the_interval_ends_at_the_bound_of_clopper_and_pearson():
    rate = e1._rate_of([row("certified", 1.0, [], loops=100)])
    assert rate.low == 0.0
    assert rate.high == pytest.approx(1.0 - 0.025 ** (1 / 100))


def test_best_are_the_modes_without_an_entry_that_lose_least():
    rows = [*rows_of("none", [0]), *rows_of(e1.AS_PUBLISHED, [], lost=3.0), *rows_of("paper", [], lost=5.0),
            *rows_of("certified", [], loops=280), *rows_of("vector_field", [2])]
    found = e1.findings(rows, Scale())
    shapes, lost = found.claims
    assert shapes.best == "the paper's, no margin, the paper's rule, certified"
    assert (lost.best, lost.reproduction, lost.certified) == ("certified", "30.00 %", "0.00 %")
    assert found.headline.startswith("Certified: in 500 steps on 1 closed shapes")
    assert "e1_by_step_length" == found.figures[0].name


def test_all_loops_of_a_mode_have_the_same_displacement_and_those_of_all_modes_the_same_seeds():
    units = {unit.settings["mode"]: unit.settings for unit in e1.units(Scale()) if unit.settings["shape"] == "gear"}
    assert set(units) == set(e1.E1_MODES)
    assert all(settings == {**units["certified"], "mode": mode} for mode, settings in units.items())
    unit = next(unit for unit in e1.units(Scale()) if unit.name == "cube_certified")
    short = type(unit)(unit.name, unit.settings | {"loops": 2})
    rows = e1.run(short)
    assert [r["steps"] for r in rows] == [2 * round(e1.WAY / length) for length in e1.LENGTHS]
    assert rows == e1.run(short)
    assert all(r["entered"] == [] and r["unsafe"] == 0 for r in rows)
