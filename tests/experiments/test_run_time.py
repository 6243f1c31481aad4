# SPDX-License-Identifier: BSD-3-Clause
import math
import os
from pathlib import Path

import pytest

from experiments import e2_run_time, published
from experiments.experiment import Unit

CACHE = os.environ.get("KEEPOUT_CACHE", Path(__file__).resolve().parents[2] / ".cache")
BUNNY = Path(CACHE) / "fixtures" / "bunny.stl"


def test_where_a_rate_is_reached_is_found_on_a_power_law():
    curve = [(n, 1e6 / n**1.2) for n in (1_000, 30_000, 2_000_000)]
    assert e2_run_time.triangles_at(curve) == pytest.approx(1e6 ** (1 / 1.2))
    assert e2_run_time.triangles_at(curve, khz=1e-3) is None
    assert e2_run_time.triangles_at(curve[1:2], khz=1e3) == 30_000


def test_the_paper_s_own_rates_fall_below_1_khz_near_where_it_says():
    at = e2_run_time.triangles_at([(rate.triangles, rate.khz) for rate in published.RATES])
    assert math.isclose(at, published.TRIANGLES_AT_1_KHZ, rel_tol=0.5)


@pytest.mark.skipif(
    "KEEPOUT_COMMAND" not in os.environ or not BUNNY.exists(),
    reason="needs the command keepout, and the bunny: fixtures/prepare bunny")
def test_rows_are_the_same_but_for_times_and_verified():
    unit = Unit("few", {"triangles": 5000, "indices": ["wide_bvh", "pd_tree_1997"], "queries": 60,
                        "seed": 4})
    runs = [
        [{name: value for name, value in row.items() if not name.startswith("measured_")}
         for row in e2_run_time.run(unit)]
        for _ in range(2)
    ]
    assert runs[0] == runs[1]
    ways = {(row["rule"], row["index"], row["radius"]) for row in runs[0]}
    assert len(ways) == len(runs[0]) == 10 and e2_run_time.REPRODUCTION in ways
    assert all(row["verified"] and row["steps"] == 60 for row in runs[0])


def test_what_the_command_refuses_is_told(monkeypatch):
    monkeypatch.setenv("KEEPOUT_COMMAND", "false")
    with pytest.raises(RuntimeError, match="keepout bench"):
        e2_run_time.run(Unit("none", {"triangles": 1, "indices": [], "queries": 5, "seed": 1}))
