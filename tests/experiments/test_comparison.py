# SPDX-License-Identifier: BSD-3-Clause
"""Tests the tables of E3 and E4: n in every cell, unfinished trials, and which tests are exploratory."""
import numpy as np
from experiments import published
from experiments.comparison import Measure, compare, main_rows
from experiments.experiment import Row
from experiments.teleoperation import CORRIDOR

MEASURES = (
    Measure("duration_s", "duration", "s", published.DURATION),
    Measure("deepest_mm", "deepest", "mm"),
    Measure("force_n", "force", "N", tested=False),
)


def rows() -> list[Row]:
    """Returns four trials of three modes; one of the rule of Li et al. is not finished."""
    random = np.random.default_rng(1)
    found = []
    for mode in ("none", "paper", "certified"):
        for number in range(4):
            finished = (mode, number) != ("paper", 2)
            found.append({
                "mode": mode, "number": number, "changed": "", "corridor": CORRIDOR, "ideal": False,
                "finished": finished, "duration_s": random.normal(200.0, 5.0) if finished else None,
                "crossings": 0, "deepest_registered_mm": 0.0, "deepest_mm": random.uniform(), "force_n": 1.0,
                "registration_error_mm": 0.3, "beyond_registration_mm": 0.0,
            })
    return found


def test_each_mean_has_its_n_and_unfinished_trials_are_counted() -> None:
    found = compare("e4", rows(), MEASURES, 1, ("duration_s",))
    means, _, _, sweeps = found.tables
    assert [row[:3] for row in means.rows] == [
        ["no fixture", "4", "0 of 4"], ["the paper's rule", "4", "1 of 4"], ["certified", "4", "0 of 4"]]
    assert [cell.split("n = ")[1] for cell in means.rows[1][3:]] == ["3", "4", "4"]
    assert [row[-1].split("n = ")[1] for row in sweeps.rows] == ["4", "3", "4"]
    assert "0 of 4 did not reach the end" in found.headline and not found.claims
    assert "the paper's rule 3 of 4; all of the other modes" in found.figures[0].caption


def test_primary_tests_are_not_among_the_exploratory_ones() -> None:
    tests = compare("e4", rows(), MEASURES, 1, ("duration_s",)).tables[2]
    assert "exploratory" in tests.title and "not adjusted for the 3 tests" in tests.note
    assert [row[:4] for row in tests.rows] == [
        ["duration [s]", "the paper's rule", "4", "3"], ["deepest [mm]", "the paper's rule", "4", "4"],
        ["deepest [mm]", "certified", "4", "4"]]


def test_a_changed_operator_set_up_or_corridor_is_not_among_the_main_rows() -> None:
    usual = rows()
    others = [usual[0] | other for other in (
        {"changed": "Operator.tremor=0.65"}, {"ideal": True}, {"corridor": CORRIDOR / 2})]
    assert main_rows([*usual, *others]) == usual
