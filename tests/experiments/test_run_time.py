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
    calls = [(["wide_bvh", "pd_tree_1997"], "all_faces,paper,certified", "5,1,0.2")]
    unit = Unit("few", {"triangles": 5000, "calls": calls, "queries": 60, "seed": 4, "run": 0})
    runs = [
        [{name: value for name, value in row.items() if not name.startswith("measured_")}
         for row in e2_run_time.run(unit)]
        for _ in range(2)
    ]
    assert runs[0] == runs[1]
    ways = {(row["rule"], row["index"], row["radius"]) for row in runs[0]}
    assert len(ways) == len(runs[0]) == 14 and e2_run_time.REPRODUCTION in ways
    assert all(row["verified"] and row["steps"] == 60 for row in runs[0])


def test_what_the_command_refuses_is_told(monkeypatch):
    monkeypatch.setenv("KEEPOUT_COMMAND", "false")
    with pytest.raises(RuntimeError, match="keepout bench"):
        e2_run_time.run(Unit("none", {"triangles": 1, "calls": [([], "paper", "5")], "queries": 5, "seed": 1, "run": 0}))


def made_up(rates: dict[e2_run_time.Way, float]) -> list[dict]:
    """Returns rows of two sizes; each run is a tenth slower than the one before."""
    return [{"triangles": size, "rule": way[0], "index": way[1], "radius": way[2], "run": run, "steps": 200,
             "measured_khz": khz * 0.9**run * (1e5 / size), "measured_p99_us": 2e3 / khz,
             "measured_max_us": 3e3 / khz + run, "measured_machine": "none", "measured_others_cores": 0.0}
            for way, khz in rates.items() for size in (51_978, 989_376) for run in range(e2_run_time.RUNS)]


def test_index_sphere_and_rule_are_factors_of_the_whole():
    ways = [e2_run_time.REPRODUCTION, *(way for _, way in e2_run_time.FACTORS)]
    rows = made_up(dict(zip(ways, (1.0, 100.0, 3000.0, 2400.0))))
    khz = e2_run_time.timed(rows, "measured_khz")
    parts = [e2_run_time.factor(khz, before, after, 989_376) for before, after in zip(ways, ways[1:])]
    assert [part.value for part in parts] == pytest.approx([100.0, 30.0, 0.8])
    assert all(part.low == pytest.approx(part.high) for part in parts)  # pairs of runs are as slow as each other
    whole = e2_run_time.factor(khz, ways[0], ways[-1], 989_376)
    assert whole.value == pytest.approx(math.prod(part.value for part in parts))
    assert math.isnan(e2_run_time.factor(khz, ways[0], ("paper", "embree", 5.0), 989_376).value)


def test_findings_have_medians_of_a_thousand_steps_with_intervals_and_the_slowest():
    ways = [e2_run_time.REPRODUCTION, *(way for _, way in e2_run_time.FACTORS)]
    found = e2_run_time.findings(made_up(dict(zip(ways, (1.0, 100.0, 3000.0, 2400.0)))), e2_run_time.Scale())
    factors, rates, slow = found.tables
    assert e2_run_time.RUNS * e2_run_time.QUERIES >= 1000 and "1,200 steps" in rates.note
    assert [row[0] for row in factors.rows] == ["index", "sphere as long as the longest step", "rule", "all three"]
    assert all("[" in cell for row in rates.rows for cell in row[3:5])
    assert slow.rows[0][3] == "2e+03 / 3e+03"
    assert "times as fast" in found.headline and len(found.claims) == 3


def test_a_single_run_has_no_interval():
    one = made_up({e2_run_time.OURS: 5.0})[:1]
    khz = e2_run_time.timed(one, "measured_khz")
    assert e2_run_time._rate(khz[e2_run_time.OURS][51_978]) == "9.62"
    assert math.isnan(e2_run_time.factor(khz, e2_run_time.OURS, e2_run_time.OURS, 51_978).low)


@pytest.mark.parametrize("full", [False, True])
def test_every_size_up_to_a_million_has_all_runs_of_the_factors(full):
    units = e2_run_time.units(e2_run_time.Scale(full=full))
    for size in {unit.settings["triangles"] for unit in units}:
        runs = [u.settings["run"] for u in units
                if u.settings["triangles"] == size and u.settings["calls"] == e2_run_time.OF_FACTORS]
        assert runs == list(range(e2_run_time.RUNS if size <= 1_000_000 else 1))
