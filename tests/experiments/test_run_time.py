# SPDX-License-Identifier: BSD-3-Clause
import math
import os
from pathlib import Path

import numpy as np
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
    unit = Unit("few", {"triangles": 5000, "indices": ["wide_bvh", "pd_tree_1997"],
                        "rules": "all_faces,paper,certified", "queries": 60, "seed": 4, "run": 0})
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
        e2_run_time.run(Unit("none", {"triangles": 1, "indices": [], "rules": "", "queries": 5, "seed": 1, "run": 0}))


def made_up(rates: dict[e2_run_time.Way, float], processes: int = e2_run_time.PARTS) -> list[dict]:
    """Returns rows of two sizes in so many processes; each part is a tenth slower than the last."""
    parts = [[0.9**part for part in range(e2_run_time.PARTS)][run::processes] for run in range(processes)]
    return [{"triangles": size, "rule": way[0], "index": way[1], "radius": way[2], "run": run, "steps": 200,
             "measured_medians_us": [1e3 / (khz * slower * (1e5 / size)) for slower in of],
             "measured_p99_us": 2e3 / khz, "measured_max_us": 3e3 / khz + run,
             "measured_machine": "none", "measured_others_cores": 0.0}
            for way, khz in rates.items() for size in (51_978, 989_376) for run, of in enumerate(parts)]


WAYS = [e2_run_time.REPRODUCTION, *(way for _, way in e2_run_time.FACTORS)]


@pytest.mark.parametrize("processes", [1, e2_run_time.PARTS])
def test_index_sphere_and_rule_are_factors_of_the_whole(processes):
    khz = e2_run_time.timed(made_up(dict(zip(WAYS, (1.0, 100.0, 3000.0, 2400.0))), processes))
    parts = [e2_run_time.factor(khz, before, after, 989_376) for before, after in zip(WAYS, WAYS[1:])]
    assert [part.value for part in parts] == pytest.approx([100.0, 30.0, 0.8])
    assert all(part.low == pytest.approx(part.high) for part in parts)  # pairs of parts are as slow as each other
    whole = e2_run_time.factor(khz, WAYS[0], WAYS[-1], 989_376)
    assert whole.value == pytest.approx(math.prod(part.value for part in parts))
    assert math.isnan(e2_run_time.factor(khz, WAYS[0], ("paper", "embree", 5.0), 989_376).value)


@pytest.mark.parametrize("processes", [1, e2_run_time.PARTS])
def test_findings_have_medians_of_a_thousand_steps_with_intervals_and_the_slowest(processes):
    rows = made_up(dict(zip(WAYS, (1.0, 100.0, 3000.0, 2400.0))), processes)
    factors, rates, slow = e2_run_time.findings(rows, e2_run_time.Scale()).tables
    assert e2_run_time.PARTS * e2_run_time.PART >= 1000 and "1,200 steps" in rates.note
    assert [row[0] for row in factors.rows] == ["index", "sphere as long as the longest step", "rule", "all three"]
    assert all("[" in cell and "n =" not in cell for row in rates.rows for cell in row[3:5])
    assert slow.rows[0][3] == "2e+03 / 3e+03"


def test_findings_have_a_headline_and_three_claims():
    found = e2_run_time.findings(made_up(dict(zip(WAYS, (1.0, 100.0, 3000.0, 2400.0)))), e2_run_time.Scale())
    assert "times as fast" in found.headline and len(found.claims) == 3


def test_a_cell_of_few_steps_states_its_n_and_has_no_interval():
    khz = e2_run_time.timed(made_up({e2_run_time.OURS: 5.0})[:1])
    assert e2_run_time._rate(khz[e2_run_time.OURS][51_978]) == "9.62 (n = 200)"
    assert math.isnan(e2_run_time.factor(khz, e2_run_time.OURS, e2_run_time.OURS, 51_978).low)


def test_the_interval_of_a_median_contains_it_in_95_percent():
    random = np.random.default_rng(3)
    for count in (6, 12, 24):
        found = [e2_run_time.median(random.lognormal(size=count)) for _ in range(2000)]
        share = sum(of.low <= 1.0 <= of.high for of in found) / len(found)
        assert share >= 0.95 - 4 * math.sqrt(0.05 * 0.95 / len(found)), count


@pytest.mark.parametrize("full", [False, True])
def test_every_cell_of_the_factors_has_a_thousand_steps(full):
    units = e2_run_time.units(e2_run_time.Scale(full=full))
    assert len({unit.name for unit in units}) == len(units)
    for size in {unit.settings["triangles"] for unit in units}:
        of = [u.settings for u in units if u.settings["triangles"] == size]
        assert [told["run"] for told in of] == list(range(len(of)))
        for index in e2_run_time.OF_FACTORS:
            assert sum(told["queries"] for told in of if index in told["indices"]) >= 1000
    slow = [u.settings for u in units if set(u.settings["indices"]) & set(e2_run_time.SLOW_INDICES)]
    assert all(told["queries"] == e2_run_time.PART for told in slow)
    assert all(told["triangles"] <= e2_run_time.LARGEST_OF_SLOW for told in slow)
