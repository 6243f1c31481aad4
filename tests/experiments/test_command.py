# SPDX-License-Identifier: BSD-3-Clause
"""Tests the command, tables, summary, record and page with an experiment that takes a second."""
import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

import pytest
from experiments.bone import BoneProperties
from experiments.experiment import Claim, Findings, Scale
from experiments.intermittent import Intermittent
from experiments.open_loop import OpenLoop
from experiments.operator_model import Operator
from experiments.record import write_record
from experiments.set_up_errors import SetUp

ROOT = Path(__file__).resolve().parents[2]


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "experiments", "--only", "e6", "--out", str(folder), *arguments]
    return subprocess.run(line, capture_output=True, text=True, cwd=ROOT, check=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("experiments")
    done = run(folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_the_papers_rule_fails_where_it_is_on_record_and_certified_nowhere(made: Path) -> None:
    with (made / "e6_counterexamples.csv").open() as table:
        rows = list(csv.DictReader(table))
    passed = {mode: {row["example"] for row in rows if row["mode"] == mode and row["passes"] == "yes"}
              for mode in ("paper", "certified", "all_faces")}
    assert passed["paper"] == {"CE2_boundary", "CE5_closed_octahedron", "CE6b_saddle", "CE6c_larger_saddle"}
    assert passed["certified"] == passed["all_faces"] == set()


def test_two_runs_with_a_seed_write_the_same_bytes(made: Path, tmp_path: Path) -> None:
    assert run(tmp_path).returncode == 0
    for name in ("e6_counterexamples.csv", "README.md"):
        told, before = ((folder / name).read_text().replace(str(folder), "") for folder in (tmp_path, made))
        assert told == before


def test_a_rule_of_your_own_is_a_mode_beside_the_references(tmp_path: Path) -> None:
    done = run(tmp_path, "--modes", "vector_field", "--rule", "examples/python/own_rule.py:StopShort")
    assert done.returncode == 0, done.stderr
    with (tmp_path / "e6_counterexamples.csv").open() as table:
        rows = list(csv.DictReader(table))
    modes = dict.fromkeys(row["mode"] for row in rows)
    assert list(modes) == ["paper", "certified", "vector_field", "StopShort"]
    assert not any(row["passes"] == "yes" for row in rows if row["mode"] == "StopShort")
    assert "StopShort" in (tmp_path / "README.md").read_text()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_signal_ends_the_workers_as_well(tmp_path: Path, number: signal.Signals) -> None:
    line = [sys.executable, "-m", "experiments", "--full", "--only", "e1", "--jobs", "2", "--out", str(tmp_path)]

    def running() -> int:
        listed = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True)
        return listed.stdout.splitlines().count(" ".join(line))

    process = subprocess.Popen(line, cwd=ROOT, text=True, stderr=subprocess.PIPE)
    deadline = time.monotonic() + 60
    while running() < 3 and time.monotonic() < deadline:
        time.sleep(0.1)
    assert running() == 3
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == (130 if number == signal.SIGTERM else -number)
    assert ("the same command continues" in err) == (number == signal.SIGTERM) and "Traceback" not in err
    while running() and time.monotonic() < deadline:
        time.sleep(0.1)
    assert running() == 0


def test_a_mode_that_is_unknown_is_named(tmp_path: Path) -> None:
    done = run(tmp_path, "--modes", "certified,magic")
    assert done.returncode == 2 and "there is no 'magic'" in done.stderr and "vector_field" in done.stderr


def test_a_rule_that_its_file_does_not_have_is_named(tmp_path: Path) -> None:
    done = run(tmp_path, "--rule", "examples/python/own_rule.py:Missing")
    assert done.returncode == 1 and "Missing" in done.stderr and "Traceback" not in done.stderr


def test_summary_record_and_page_say_the_same(made: Path) -> None:
    record = json.loads((made / "experiments.json").read_text())
    headline = record["experiments"][0]["headline"]
    assert headline in (made / "README.md").read_text()
    assert record["keepout_record"] == "experiments"
    assert not record["complete"]  # because --only omits the other experiments
    if "KEEPOUT_COMMAND" in os.environ:
        assert (made / "experiments.html").stat().st_size > 1000


def test_the_record_is_valid(made: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema", reason="needs python3-jsonschema")
    validator = jsonschema.Draft202012Validator(json.loads((ROOT / "docs/schemas/record.json").read_text()))
    record = json.loads((made / "experiments.json").read_text(encoding="utf-8"))
    assert not list(validator.iter_errors(record))
    del record["experiments"][0]["claims"]
    assert list(validator.iter_errors(record))


def test_the_command_makes_a_page_of_a_record(tmp_path: Path) -> None:
    claims = [Claim("depth", paper, "1 mm", "0 mm", "certified", "p = 0.01") for paper in "1-"]
    found = {"e3": ("E3 <Path>", Findings("Smoother.", claims))}
    file = tmp_path / "experiments.json"
    write_record(file, Scale(), found, True, "./run experiments")
    record = json.loads(file.read_text(encoding="utf-8"))
    assert record["headline"] == "Smoother."
    assert record["machine"]["processor"] and record["machine"]["libraries"]
    again = [os.environ["KEEPOUT_COMMAND"], "report", str(file)]
    subprocess.run(again, check=True, env={**os.environ, "KEEPOUT_WEB": str(tmp_path)})
    page = file.with_suffix(".html").read_text(encoding="utf-8")
    assert "<td>E3 &lt;Path&gt;</td><td>depth</td><td>1</td>" in page


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    done = run(tmp_path / "file")
    assert done.returncode == 1
    assert "file" in done.stderr and "Traceback" not in done.stderr


def test_an_empty_folder_name_is_refused() -> None:
    done = subprocess.run([sys.executable, "-m", "experiments", "--out", ""], capture_output=True, text=True, cwd=ROOT,
                          check=False)
    assert done.returncode == 2
    assert "argument --out: expected the name of a folder, not ''" in done.stderr


def test_the_page_has_the_values_that_are_simulated() -> None:
    """Each row of the table of values in docs/experiments.md has names, and their values in the same order."""
    page = (ROOT / "docs" / "experiments.md").read_text()
    known = {
        f"{type(of).__name__}.{name}": value
        for of in (Operator(), Intermittent(), OpenLoop(), SetUp(), BoneProperties())
        for name, value in asdict(of).items()
    }
    name = f"`(?:{'|'.join({of.split('.')[0] for of in known})})\\.\\w+`"
    rows = re.findall(rf"^\| ({name}(?:, {name})*) \| ([^|]+) \|", page, re.MULTILINE)
    told = set()
    for names, values in rows:
        numbers = [float(number) for number in re.findall(r"\d+\.?\d*", values)]
        of_row = re.findall(r"`(\w+\.\w+)`", names)
        assert numbers == [known[name] for name in of_row], names
        told.update(of_row)
    untold = set(known) - told
    assert untold == {"Operator.hand", "BoneProperties.behind"}
