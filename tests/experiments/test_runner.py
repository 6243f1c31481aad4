# SPDX-License-Identifier: BSD-3-Clause
"""Results are stored and reused, tables are reproducible, and times are in separate tables."""
import shutil
import sys
import time
import types
from pathlib import Path

import pytest
from experiments import __main__ as command
from experiments import runner, summary
from experiments.experiment import Claim, Findings, Scale, Table, Unit


@pytest.fixture
def counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> types.ModuleType:
    """Returns an experiment that logs each of its runs in a file."""
    module = types.ModuleType("counted_experiment")
    module.NAME = "counted"
    log = tmp_path / "log"

    def run(unit: Unit) -> list[dict]:
        with log.open("a") as out:
            out.write(unit.name + "\n")
        third = unit.settings["number"] / 3
        return [{"number": unit.settings["number"], "third": third, "all": [third, 1], "measured_s": 0.5}]

    module.run, module.log = run, log
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr(runner, "source_digest", lambda experiment: "no sources")
    return module


def ran(experiment: types.ModuleType) -> list[str]:
    return experiment.log.read_text().split()


def units(count: int) -> dict[str, list[Unit]]:
    return {"counted": [Unit(f"unit-{n}", {"number": n}) for n in range(count)]}


def test_a_second_run_does_only_what_is_not_kept(counted: types.ModuleType, tmp_path: Path) -> None:
    first = runner.run_units([counted], units(2), tmp_path, 1)
    more = runner.run_units([counted], units(3), tmp_path, 1)
    assert ran(counted) == ["unit-0", "unit-1", "unit-2"]
    assert more["counted"][:2] == first["counted"]
    changed = {"counted": [Unit("unit-0", {"number": 7})]}
    assert runner.run_units([counted], changed, tmp_path, 1)["counted"][0]["number"] == 7


def test_other_sources_make_what_is_kept_void(
    counted: types.ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runner.run_units([counted], units(1), tmp_path, 1)
    monkeypatch.setattr(runner, "source_digest", lambda experiment: "other")
    runner.run_units([counted], units(1), tmp_path, 1)
    assert ran(counted) == ["unit-0", "unit-0"]


def test_rows_depend_on_their_own_experiment_and_not_on_how_they_are_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = tmp_path / "experiments"
    shutil.copytree(Path(runner.__file__).parent, copy, ignore=shutil.ignore_patterns("native"))
    monkeypatch.setattr(runner, "__file__", str(copy / "runner.py"))
    before = {name: runner.source_digest(name) for name in ("e3_path_tracing", "e4_cutting")}
    for shown in ("figures.py", "comparison.py"):
        (copy / shown).write_text("# another look\n")
    assert {name: runner.source_digest(name) for name in before} == before
    (copy / "e4_cutting.py").write_text("# another experiment\n")
    assert runner.source_digest("e3_path_tracing") == before["e3_path_tracing"]
    assert runner.source_digest("e4_cutting") != before["e4_cutting"]
    runs = runner.source_digest("e2_run_time")
    (copy / "trial.py").write_text("# another trial\n")
    assert runner.source_digest("e3_path_tracing") != before["e3_path_tracing"]
    assert runner.source_digest("e2_run_time") == runs  # the experiment has no trials
    (copy / "rules" / "rule.py").write_text("# another interface\n")
    before = runner.source_digest("e1_validation")
    (copy / "rules" / "native.py").write_text("# another rule\n")
    assert runner.source_digest("e1_validation") != before


@pytest.mark.parametrize("quiet", [False, True])
def test_without_a_terminal_lines_come_while_a_unit_runs_unless_it_is_quiet(
    counted: types.ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str],
    quiet: bool,
) -> None:
    def run_slowly(unit: Unit) -> list[dict]:
        time.sleep(0.5)
        return [{"number": 1}]

    counted.run = run_slowly
    monkeypatch.setattr(runner.Progress, "INTERVAL", 0.1)
    monkeypatch.setenv("KEEPOUT_QUIET", "1" if quiet else "")
    runner.run_units([counted], units(1), tmp_path, 1)
    lines = capfd.readouterr().err.splitlines()
    assert not lines if quiet else lines.count("0 of 1 units: nothing is finished yet") >= 2
    assert quiet or lines[-1] == "1 of 1 units: counted unit-0"


def test_a_torn_file_is_done_again(counted: types.ModuleType, tmp_path: Path) -> None:
    runner.run_units([counted], units(1), tmp_path, 1)
    file = tmp_path / "counted" / "unit-0.json"
    for torn in (file.read_text()[:40], "[]", "{}"):
        file.write_text(torn)
        runner.run_units([counted], units(1), tmp_path, 1)
    assert ran(counted) == ["unit-0"] * 4


def test_a_unit_that_fails_is_named_and_the_others_are_kept(
    counted: types.ModuleType, tmp_path: Path
) -> None:
    wrong = {"counted": [*units(1)["counted"], Unit("wrong", {"number": "x"})]}
    with pytest.raises(runner.UnitError, match="counted wrong: TypeError"):
        runner.run_units([counted], wrong, tmp_path, 1)
    runner.run_units([counted], units(1), tmp_path, 1)
    assert ran(counted) == ["unit-0", "wrong"]


def test_times_stand_in_a_table_of_their_own(counted: types.ModuleType, tmp_path: Path) -> None:
    rows = runner.run_units([counted], units(2), tmp_path, 2)["counted"]
    runner.write_tables("counted", rows, tmp_path)
    steady = (tmp_path / "counted.csv").read_text()
    assert steady == "number,third,all\n0,0.0,0.0 1\n1,0.3333333333333333,0.3333333333333333 1\n"
    assert (tmp_path / "counted_times.csv").read_text().splitlines()[0] == "measured_s"


def test_a_summary_has_claims_before_tables(tmp_path: Path) -> None:
    found = Findings(
        "It was found.",
        claims=[Claim("depth", "1", "2", "3|4", "certified", "p = 1", "why")],
        tables=[Table("Table", ["a"], [["b"]], "Note.")],
    )
    text = summary.text({"e": ("E0", found)}, "./run experiments", "1.0")
    assert text.index("| depth | p = 1 | 1 | 2 | 3\\|4 |") < text.index("## E0") < text.index("**Table.** Note.")


@pytest.mark.parametrize(
    "arguments, names", [(["--only", "e9"], "e9"), (["--seed", "-1"], "--seed"), (["--seed", "4294967296"], "--seed"), (["--jobs", "0"], "--jobs"), (["--ful"], "--ful")]
)
def test_a_wrong_argument_is_named(
    arguments: list[str], names: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as exit_:
        command.main(arguments)
    assert exit_.value.code == 2
    assert names in capsys.readouterr().err


@pytest.mark.parametrize("full", [False, True])
def test_units_have_names_of_their_own_that_files_can_have(full: bool) -> None:
    for experiment in command.EXPERIMENTS:
        names = [unit.name for unit in experiment.units(Scale(full=full))]
        assert len(names) == len(set(names)) > 0
        assert all(set(name) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") for name in names)
