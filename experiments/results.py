# SPDX-License-Identifier: BSD-3-Clause
"""Publishes a full run in experiments/results, and says which results have other sources by now.

    PYTHONPATH=build/release/python python3 -m experiments.results out/experiments_full

copies tables, figures, the summary and the record without its pictures, which are files beside it. Long tables are
compressed. `sources.json` has a digest of the code behind each experiment and mode. tests/experiments/test_results.py
compares it with the sources.
"""
from __future__ import annotations

import gzip
import json
import shutil
import sys
from pathlib import Path

from . import runner
from .experiment import Unit

FOLDER = Path(__file__).parent / "results"
SOURCES = "sources.json"
LARGEST = 1_000_000  # all tables and the record [bytes]
LONG = 200_000  # a table of more is compressed [bytes]

#: The digests of each experiment by mode; of units without a mode by "".
Digests = dict[str, dict[str, str]]


def sources(units: dict[str, list[Unit]]) -> Digests:
    """Returns the digests of the code behind units, by the name of the experiment. The libraries that were built do not count."""
    return {name: _digests(name, {unit.settings.get("mode", "") for unit in of}) for name, of in units.items()}


def _digests(experiment: str, of_modes: set[str]) -> dict[str, str]:
    return {mode: runner.source_digest(experiment, mode or None, libraries=False) for mode in sorted(of_modes)}


def outdated(folder: Path = FOLDER) -> list[str]:
    """Returns the experiments and modes in a folder whose code has changed, such as "e3_path_tracing certified"."""
    made: Digests = json.loads((folder / SOURCES).read_text())
    return [f"{name} {mode}".strip() for name, of in made.items() for mode, digest in _digests(name, set(of)).items()
            if digest != of[mode]]


def _stored(file: Path) -> tuple[str, bytes]:
    """Returns the name and the bytes under which a file is published."""
    data = file.read_bytes()
    return (file.name, data) if len(data) <= LONG else (f"{file.name}.gz", gzip.compress(data, mtime=0))


def publish(made: Path, folder: Path = FOLDER) -> None:
    """Replaces the results in `folder` by those of a run. Raises ValueError if its tables exceed LARGEST."""
    files = dict(_stored(file) for file in (*made.glob("*.csv"), made / SOURCES))
    record = json.loads((made / "experiments.json").read_text())
    for experiment in record["experiments"]:
        experiment["figures"] = []
    files["experiments.json"] = (json.dumps(record, indent=1, ensure_ascii=False) + "\n").encode()
    size = sum(map(len, files.values()))
    if size > LARGEST:
        raise ValueError(f"tables and record have {size:,} bytes, more than {LARGEST:,}")
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "figures").mkdir(parents=True)
    for name, data in files.items():
        (folder / name).write_bytes(data)
    for file in (made / "README.md", *(made / "figures").glob("*.svg")):
        shutil.copy(file, folder / file.relative_to(made))


if __name__ == "__main__":
    publish(Path(sys.argv[1]))
