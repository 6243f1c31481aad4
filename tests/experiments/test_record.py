# SPDX-License-Identifier: BSD-3-Clause
"""The record of the experiments: the command makes a page of it."""
import json
import os
import subprocess

from experiments.experiment import Claim, Findings, Scale
from experiments.record import write_record


def test_the_command_makes_a_page_of_it(tmp_path):
    claims = [Claim("depth", paper, "1 mm", "0 mm", "certified", "p = 0.01") for paper in "1-"]
    found = {"e3": ("E3 <Path>", Findings("Smoother.", claims))}
    file = tmp_path / "experiments.json"
    write_record(file, Scale(), found, True, "./run experiments", "2026-11-23T12:00:00Z")
    record = json.loads(file.read_text(encoding="utf-8"))
    assert record["headline"].startswith("1 number of the paper,")
    assert record["machine"]["processor"] and record["machine"]["libraries"]
    again = [os.environ["KEEPOUT_COMMAND"], "report", str(file)]
    subprocess.run(again, check=True, env={**os.environ, "KEEPOUT_WEB": str(tmp_path)})
    page = file.with_suffix(".html").read_text(encoding="utf-8")
    assert "<td>E3 &lt;Path&gt;</td><td>depth</td><td>1</td>" in page
