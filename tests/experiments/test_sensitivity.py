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


def test_every_number_has_a_name_and_is_changed_alone() -> None:
    assert parameters.numbers(Outer()) == {"Outer.width": 2.0, "Outer.off": 0.0, "Inner.depth": 3.0}
    assert parameters.changed(Outer(), {"Inner.depth": 6.0}) == replace(Outer(), inner=Inner(depth=6.0))
    assert parameters.changed(Outer(), {"Outer.off": 0.5}) == replace(Outer(), off=0.5)
    assert parameters.changed(SetUp(), {}) == SetUp()
    with pytest.raises(KeyError, match="Inner.width"):
        parameters.changed(Outer(), {"Inner.width": 1.0})


def test_each_value_is_changed_to_both_ends_of_its_range_in_pairs_and_no_value_of_the_task() -> None:
    units = e8_sensitivity.units(Scale(full=True))
    keys = [(u.settings["experiment"], u.settings["parameter"], u.settings["value"]) for u in units]
    assert {keys.count(key) for key in set(keys)} == {2 * 3, 2 * 20}
    for name in ("SetUp.fle", "BoneProperties.resistance", *e8_sensitivity.RANGES):
        values = sorted(value for experiment, parameter, value in set(keys)
                        if parameter == name and experiment == "e4_cutting")
        usual = parameters.numbers(teleoperation.Simulation())[name]
        assert len(values) == 2 and values[0] < usual < values[1]
        assert name in e8_sensitivity.RANGES or values == [usual / 2, usual * 2]
    assert not {key[1] for key in keys} & set(e8_sensitivity.FIXED)


def test_bars_are_differences_of_pairs_the_longest_first() -> None:
    end = next(m for m in e3_path_tracing.MEASURES if m.published)
    values = {("as they are", 1.0): 1.0, ("a", 0.5): 0.5, ("a", 2.0): 2.0, ("b", 0.5): 1.0, ("b", 2.0): 1.25}
    rows = [{"experiment": e3_path_tracing.NAME, "parameter": parameter, "value": value, "mode": mode,
             "number": number, "sparc": -2.0, "irregularity": 1.0,
             end.member: -8.0 + number + (gain if mode == "certified" else 0.0)}
            for (parameter, value), gain in values.items() for mode in ("none", "certified") for number in range(2)]
    rows[-1][end.member] = None  # an unfinished trial: one pair less
    base, found = e8_sensitivity.bars(rows, end)
    assert base.value == 1.0
    assert [(bar.parameter, bar.low.value, bar.high.value, bar.pairs) for bar in found] == [
        ("a", 0.5, 2.0, 2), ("b", 1.0, 1.25, 1)]
    findings = e8_sensitivity.findings(rows, Scale())
    assert "4 of 4" in findings.headline and "0 ranges are from literature and 2 are ours" in findings.headline
    assert len(findings.tables) == 3
    assert [row[0] for row in findings.tables[0].rows] == ["a", "b"]


def test_a_changed_value_reaches_the_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def run(trial: teleoperation.Trial) -> None:
        seen.append((trial.operator, trial.setup))
        raise StopIteration

    monkeypatch.setattr(teleoperation.Trial, "run", run)
    monkeypatch.setattr(e3_path_tracing.anatomy, "printed_skull", lambda: (None, None))
    for unit in e8_sensitivity.units(Scale()):
        if unit.settings["number"] == 0 and unit.settings["parameter"] in ("as they are", "SetUp.fle", "Operator.mass"):
            with pytest.raises(StopIteration):
                e8_sensitivity.run(unit)
    (base, setup), *changed = seen[::2]  # both modes have the same values
    assert [(o.mass / base.mass, s.fle / setup.fle) for o, s in changed] == [(0.5, 1), (2, 1), (1, 0.5), (1, 2)]
