# SPDX-License-Identifier: BSD-3-Clause
"""Tests that values are changed one at a time, and that bars have the differences of pairs."""
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from experiments import e3_path_tracing, e8_sensitivity, parameters, teleoperation
from experiments.experiment import Scale
from experiments.set_up_errors import SetUp


@dataclass(frozen=True)
class Inner:
    depth: float = 3.0
    name: str = "inner"


@dataclass(frozen=True)
class Outer:
    width: float = 2.0
    off: float = 0.0
    endless: float = np.inf
    count: int = 4
    inner: Inner = field(default_factory=Inner)


def test_every_number_has_a_name_and_is_scaled_alone() -> None:
    assert parameters.names(Outer()) == ["Outer.width", "Inner.depth"]
    assert parameters.scaled(Outer(), {"Inner.depth": 2.0}) == replace(Outer(), inner=Inner(depth=6.0))
    assert parameters.scaled(Outer(), {"Outer.width": 0.5}) == replace(Outer(), width=1.0)
    assert parameters.scaled(SetUp(), {}) == SetUp()


def test_each_value_is_halved_and_doubled_in_pairs_and_no_value_of_the_task() -> None:
    units = e8_sensitivity.units(Scale(full=True))
    keys = [(u.settings["experiment"], u.settings["parameter"], *u.settings["factors"].values()) for u in units]
    assert all(keys.count(key) == 2 * 3 for key in set(keys))
    assert {key[2] for key in keys} == {0.5, 1.0, 2.0}
    names = {key[1] for key in keys}
    assert "SetUp.fle" in names and "BoneProperties.resistance" in names
    assert not names & set(e8_sensitivity.FIXED)
    assert all(set(unit.name) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") for unit in units)


def test_bars_are_differences_of_pairs_the_longest_first() -> None:
    end = next(m for m in e3_path_tracing.MEASURES if m.published)
    values = {("as they are", 1.0): 1.0, ("a", 0.5): 0.5, ("a", 2.0): 2.0, ("b", 0.5): 1.0, ("b", 2.0): 1.25}
    rows = [{"experiment": e3_path_tracing.NAME, "parameter": parameter, "factor": factor, "mode": mode,
             "number": number, end.member: -8.0 + number + (gain if mode == "certified" else 0.0)}
            for (parameter, factor), gain in values.items() for mode in ("none", "certified") for number in range(2)]
    rows[-1][end.member] = None  # an unfinished trial: one pair less
    base, found = e8_sensitivity.bars(rows, end)
    assert base.value == 1.0
    assert [(bar.parameter, bar.half.value, bar.double.value, bar.pairs) for bar in found] == [
        ("a", 0.5, 2.0, 2), ("b", 1.0, 1.25, 1)]
    findings = e8_sensitivity.findings(rows, Scale())
    assert "4 of 4" in findings.headline and len(findings.tables) == 1
    assert [row[0] for row in findings.tables[0].rows] == ["a", "b"]


def test_a_changed_value_reaches_the_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def run(trial: teleoperation.Trial) -> None:
        seen.append((trial.operator, trial.setup))
        raise StopIteration

    monkeypatch.setattr(teleoperation.Trial, "run", run)
    monkeypatch.setattr(e3_path_tracing.anatomy, "printed_skull", lambda: (None, None))
    for unit in e8_sensitivity.units(Scale()):
        if unit.settings["parameter"] in ("as they are", "SetUp.fle", "Operator.mass"):
            with pytest.raises(StopIteration):
                e8_sensitivity.run(unit)
    (base, setup), *changed = seen[::2]  # both modes have the same values
    assert [(o.mass / base.mass, s.fle / setup.fle) for o, s in changed] == [(0.5, 1), (2, 1), (1, 0.5), (1, 2)]
