# SPDX-License-Identifier: BSD-3-Clause
"""Results are stored and reused, tables are reproducible, and times are in separate tables."""
import importlib
import shutil
import sys
import time
import types
from pathlib import Path

import pytest
from experiments import __main__ as command
from experiments import modes, runner, summary
from experiments.arguments import NAMES
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
    monkeypatch.setattr(runner, "source_digest", lambda experiment, mode: "no sources")
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
    monkeypatch.setattr(runner, "source_digest", lambda experiment, mode: "other")
    runner.run_units([counted], units(1), tmp_path, 1)
    assert ran(counted) == ["unit-0", "unit-0"]


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Returns a copy of the sources, of which runner computes its digests."""
    here = tmp_path / "experiments"
    shutil.copytree(runner.HERE, here, ignore=shutil.ignore_patterns("results", "__pycache__"))
    monkeypatch.setattr(runner, "HERE", here)
    return here


def digest(experiment: str, mode: str | None = None) -> str:
    runner._modules.cache_clear()
    runner._tree.cache_clear()
    return runner.source_digest(experiment, mode, libraries=False)


def test_rows_depend_on_the_code_of_their_own_experiment_and_not_on_how_they_are_shown(copy: Path) -> None:
    names = ("e2_run_time", "e3_path_tracing", "e4_cutting")
    before = {name: digest(name, "certified") for name in names}
    for shown in ("figures.py", "comparison.py"):
        (copy / shown).write_text("look = 'another'\n")
    with (copy / "trial.py").open("a") as trial:
        trial.write("# A remark.\n")
    assert {name: digest(name, "certified") for name in names} == before
    (copy / "e4_cutting.py").write_text("from . import trial\n")
    assert digest("e3_path_tracing", "certified") == before["e3_path_tracing"]
    assert digest("e4_cutting", "certified") != before["e4_cutting"]
    (copy / "trial.py").write_text("def trial(): return 'another'\n")
    assert digest("e3_path_tracing", "certified") != before["e3_path_tracing"]
    assert digest("e2_run_time", "certified") == before["e2_run_time"]  # the experiment has no trials


def test_of_an_experiment_only_the_code_that_its_run_needs_counts(copy: Path) -> None:
    module = copy / "e2_run_time.py"
    text = module.read_text()
    before = digest("e2_run_time")
    module.write_text(text.replace("ylim=(", "alpha=0.5, ylim=(") + "\n\ndef another_figure():\n    return LONGEST_STEP\n")
    assert digest("e2_run_time") == before
    for needed in ("LONGEST_STEP = ", "def rows_of("):
        changed = text.replace(needed, f"{needed}1 + " if needed.endswith("= ") else f"{needed}extra, ")
        assert changed != text
        module.write_text(changed)
        assert digest("e2_run_time") != before
    module.write_text(text + "\n\nfor radius in ():\n    RADII[radius] = LONGEST_STEP\n")  # may change what run() uses
    assert digest("e2_run_time") != before


def test_a_rule_that_changes_keeps_the_rows_of_other_modes(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rule = copy / "rules" / "mine.py"
    rule.write_text("GAIN = 1.0\n")
    monkeypatch.setitem(modes._rules, "mine", modes.Source("mine", "Mine"))
    for names in ("MODES", "BUILT_IN"):
        monkeypatch.setattr(modes, names, (*getattr(modes, names), "mine"))
    of_modes = ("none", "certified", "mine")
    before = {mode: digest("e1_validation", mode) for mode in (*of_modes, None)}
    assert len(set(before.values())) == 4
    rule.write_text("GAIN = 0.5\n")
    after = {mode: digest("e1_validation", mode) for mode in before}
    assert {mode for mode in before if before[mode] != after[mode]} == {"mine", None}
    # A variant of a reference, under a name that modes.py does not have, depends on the references.
    variant = digest("e3_path_tracing", "paper_published")
    rules = copy / "rules" / "native.py"
    rules.write_text(rules.read_text() + "\n\nVALUE = 1\n")
    assert digest("e3_path_tracing", "paper_published") != variant


def test_rows_depend_on_the_code_in_cpp_and_not_on_its_comments(copy: Path) -> None:
    native = copy.parent / "benchmarks" / "native"
    native.mkdir(parents=True)
    (native / "rule.cpp").write_text("double gain = 1.0;\n")
    before = digest("e6_counterexamples"), digest("e2_run_time")
    (native / "rule.cpp").write_text("double gain =\n    1.0;  // a remark\n")
    assert (digest("e6_counterexamples"), digest("e2_run_time")) == before
    (native / "rule.cpp").write_text("double gain = 0.5;\n")
    assert digest("e6_counterexamples") != before[0] and digest("e2_run_time") == before[1]


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


def test_the_time_left_is_that_of_finished_units_of_the_same_kind() -> None:
    slow, fast, other = ("e3", "fcl_slide"), ("e3", "certified"), ("e7", "")
    progress = runner.Progress(6)
    progress.begin([slow, slow, fast, fast, other], 2)
    assert progress.time_left() == 0.0
    progress.ran(slow, 12.0)
    progress.ran(fast, 2.0)
    assert progress.time_left() == pytest.approx((12.0 + 2.0 + 7.0) / 2)  # the other: the mean of all


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
    tables = runner.tables("counted", rows)
    assert tables["counted"] == "number,third,all\n0,0,0 1\n1,0.333333,0.333333 1\n"
    assert tables["counted_times"].splitlines()[0] == "measured_s"


def test_a_summary_has_claims_before_tables(tmp_path: Path) -> None:
    found = Findings(
        "It was found.",
        claims=[Claim("depth", "1", "2", "3|4", "certified", "p = 1", "why")],
        tables=[Table("Table", ["a"], [["b"]], "Note.")],
    )
    text = summary.text({"e": ("E0", found)}, "./run experiments", "1.0")
    assert text.index("| depth | p = 1 | 1 | 2 | 3\\|4 |") < text.index("## E0") < text.index("**Table.** Note.")


@pytest.mark.parametrize(
    "arguments, names", [(["--only", "e9"], "e9"), (["--seed", "-1"], "--seed"), (["--seed", "4294967296"], "--seed"), (["--jobs", "0"], "--jobs"), (["--ful"], "--ful"),
     (["--rule", "mine.py"], "--rule"), (["--rule", "missing.py:Mine"], "missing.py")]
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
    for name in NAMES:
        experiment = importlib.import_module(f"experiments.{name}")
        names = [unit.name for unit in experiment.units(Scale(full=full))]
        assert len(names) == len(set(names)) > 0
        assert all(set(name) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") for name in names)
