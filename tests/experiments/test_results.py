# SPDX-License-Identifier: BSD-3-Clause
"""The published results are those of the present code, and small enough to keep."""
import csv
import gzip
import json
import random
from pathlib import Path

import pytest
from experiments import results
from experiments.experiment import Unit

PUBLISHED = results.FOLDER / results.SOURCES


@pytest.fixture
def made(tmp_path: Path) -> Path:
    """Returns the output folder of a run."""
    folder = tmp_path / "made"
    (folder / "figures").mkdir(parents=True)
    (folder / "e6_counterexamples.csv").write_text("example,mode\na,paper\n")
    (folder / "README.md").write_text("# Results\n")
    (folder / "figures" / "one.svg").write_text("<svg/>")
    (folder / "experiments.json").write_text(json.dumps({"experiments": [{"name": "e6", "figures": [{"svg": "<svg/>"}]}]}))
    units = {"e6_counterexamples": [Unit("paper", {"mode": "paper"}), Unit("other", {})]}
    (folder / results.SOURCES).write_text(json.dumps(results.sources(units)))
    return folder


def test_a_run_is_published_with_its_tables_and_a_record_without_pictures(made: Path, tmp_path: Path) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "old.csv").write_text("of an earlier run")
    results.publish(made, tmp_path / "results")
    names = {file.relative_to(tmp_path / "results").as_posix() for file in (tmp_path / "results").rglob("*.*")}
    assert names == {"README.md", "e6_counterexamples.csv", "experiments.json", "sources.json", "figures/one.svg"}
    record = json.loads((tmp_path / "results" / "experiments.json").read_text())
    assert record["experiments"] == [{"name": "e6", "figures": []}]


def test_tables_that_are_too_large_are_not_published(made: Path, tmp_path: Path) -> None:
    (made / "large.csv").write_bytes(random.Random(1).randbytes(results.LARGEST))
    with pytest.raises(ValueError, match="more than 1,000,000"):
        results.publish(made, tmp_path / "results")
    assert not (tmp_path / "results").exists()


def test_a_long_table_is_compressed(made: Path, tmp_path: Path) -> None:
    text = "draw,touches\n" + "1,no\n" * results.LONG
    (made / "e7_margin.csv").write_text(text)
    results.publish(made, tmp_path / "results")
    assert gzip.decompress((tmp_path / "results" / "e7_margin.csv.gz").read_bytes()).decode() == text


def test_results_of_other_code_are_named(made: Path) -> None:
    assert results.outdated(made) == []
    sources = json.loads((made / results.SOURCES).read_text())
    sources["e6_counterexamples"]["paper"] = "of an earlier rule"
    (made / results.SOURCES).write_text(json.dumps(sources))
    assert results.outdated(made) == ["e6_counterexamples paper"]


@pytest.mark.skipif(not PUBLISHED.exists(), reason="no run with sources.json is published yet")
def test_the_published_results_are_of_the_present_code() -> None:
    assert results.outdated() == [], "run ./run experiments --full, then python3 -m experiments.results"


@pytest.mark.skipif(not PUBLISHED.exists(), reason="no run with sources.json is published yet")
def test_the_published_tables_are_small_and_have_rows() -> None:
    tables = [*results.FOLDER.glob("*.csv*"), results.FOLDER / "experiments.json", PUBLISHED]
    assert sum(file.stat().st_size for file in tables) <= results.LARGEST
    for name in json.loads(PUBLISHED.read_text()):
        plain = results.FOLDER / f"{name}.csv"
        with plain.open() if plain.exists() else gzip.open(f"{plain}.gz", "rt") as table:
            assert len(list(csv.reader(table))) > 1
