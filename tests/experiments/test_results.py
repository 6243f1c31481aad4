# SPDX-License-Identifier: BSD-3-Clause
"""The published results are those of the present code, and small enough to keep."""
import csv
import gzip
import json
import random
import re
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


@pytest.mark.skipif(not PUBLISHED.exists(), reason="no run with sources.json is published yet")
def test_the_readme_tells_the_published_results() -> None:
    record = json.loads((results.FOLDER / "experiments.json").read_text())
    found = {experiment["name"]: experiment["headline"] for experiment in record["experiments"]}
    readme = " ".join((results.FOLDER.parents[1] / "README.md").read_text().split())
    first = re.fullmatch(r"Certified: in (.*)\. The tip entered in 0 of \d+ \[.*?\] loops, and (.*?) of the free motion was "
                         r"lost. The paper's rule as printed: 0 of \d+ \[.*?\] loops, (.*?) lost.", found["e1_validation"])
    assert first, found["e1_validation"]
    assert f"In {first[1]}, `certified` never let the tip in, and lost {first[2]} of the free motion." in readme
    assert f"never let it in there either, and lost {first[3]}." in readme
    assert "4 of 9 passed through" in found["e6_counterexamples"] and "0 of 9 passed" in found["e6_counterexamples"]
    assert record["headline"] == found["e1_validation"]
    assert found["published_numbers"].startswith(
        "Certified against no fixture: better by spectral arc length, cutting path deviation, absolute penetration depth, "
        "duration. Certified against the paper's rule: better by spectral arc length, absolute penetration depth; "
        "worse by duration; ")
    printed = next(table["rows"] for e in record["experiments"] for table in e["tables"]
                   if table["title"].startswith("Every printed number"))
    contradicted = [row for row in printed if re.search("(above|below) all", " ".join(row[3:5]))]
    assert len(contradicted) > len(printed) / 2
    sparc = next(row for e in record["experiments"] if e["name"] == "e3_path_tracing" for table in e["tables"]
                 if "exploratory" in table["title"] for row in table["rows"] if row[:2] == ["SPARC, 10 Hz", "certified"])
    assert sparc[2] == "40" and float(sparc[4].split("[")[1].split(",")[1].rstrip("]")) < 0
