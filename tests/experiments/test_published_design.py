# SPDX-License-Identifier: BSD-3-Clause
"""Tests the repeated design of Li et al. against scipy, hand calculations and trials with known properties."""
import numpy as np
import pytest
from scipy import stats

from experiments import e3_path_tracing, e4_cutting, modes, published, published_design, published_numbers
from experiments.comparison import Measure, against, best
from experiments.experiment import Row, Scale
from experiments.teleoperation import CORRIDOR

DEPTH = Measure("depth", "depth", "mm", samples="samples")


def cut(samples: list[float]) -> np.ndarray:
    return np.array(samples, dtype=np.float64)


def test_a_design_pools_the_samples_and_its_p_is_that_of_scipy() -> None:
    random = np.random.default_rng(1)
    trials = [random.normal(mean, 1.0, 30) for mean in (0.0, 0.3, 0.5, 0.9)]
    numbers = np.array([[0, 1], [2, 0]]), np.array([[2, 3], [1, 3]])
    a, b = (published_design.pooled(trials, of) for of in numbers)
    found = published_design.student_p(a, b)
    for design in range(2):
        one, other = (np.concatenate([trials[i] for i in of[design]]) for of in numbers)
        assert (a.mean[design], a.sd[design]) == pytest.approx((one.mean(), one.std(ddof=1)))
        assert found[design] == pytest.approx(stats.ttest_ind(one, other).pvalue)


def test_designs_have_different_trials_and_are_those_of_their_seed() -> None:
    numbers = published_design.draw(6, 4, 500, (3,))
    assert numbers.shape == (500, 4) and all(len(set(design)) == 4 for design in numbers.tolist())
    assert np.array_equal(numbers, published_design.draw(6, 4, 500, (3,)))
    assert set(numbers.ravel()) == set(range(6))
    with pytest.raises(ValueError, match="needs 4 trials"):
        published_design.draw(3, 4, 1, (1,))


@pytest.mark.parametrize("between", [0.0, 0.2])
def test_the_rate_of_false_alarms_is_that_of_theory(between: float) -> None:
    """With a variance `between` trials, the mean of two trials of 30 samples varies as between / 2 + 1 / 60."""
    random = np.random.default_rng(2)
    deviation = np.sqrt((between / 2 + 1 / 60) / ((between + 1) / 60))
    expected = 2 * stats.norm.sf(1.96 / deviation)
    rates = []
    for pool in range(20):
        trials = [random.normal(np.sqrt(between) * random.normal(), 1.0, 30) for _ in range(40)]
        rates.append(published_design.false_alarms(trials, 2, seed=pool))
    mean = np.mean([rate.value for rate in rates])
    assert mean == pytest.approx(expected, abs=4 * np.std([rate.value for rate in rates]) / np.sqrt(20) + 0.01)
    assert sum(rate.low <= expected <= rate.high for rate in rates) >= 14  # 95 % would be 19 of 20


def test_a_rate_of_false_alarms_needs_two_sides() -> None:
    assert np.isnan(published_design.false_alarms([np.ones(30)] * 3, 2, seed=1).value)


def test_a_printed_number_has_its_place() -> None:
    designs = np.arange(1.0, 101.0)
    place = published_design.predicted(10.0, designs)
    assert place.percentile == 9.5 and place.designs.value == 50.5
    assert place.text(10.0).endswith("10 is at 9.5 %")
    assert published_design.predicted(0.0, designs).text(0.0).endswith("below all")


def rows_of(values: dict[str, list[float | None]], member: str = "depth") -> dict[str, list[Row]]:
    return {mode: [{"number": n, member: value, "finished": value is not None, "deepest_registered_mm": 0.0}
                   for n, value in enumerate(of)] for mode, of in values.items()}


def test_an_unfinished_trial_is_the_worst_and_counts() -> None:
    by_mode = rows_of({"none": [1.0, 2.0, 3.0, 4.0], "certified": [0.5, None, 2.5, None]})
    test = against(DEPTH, "certified", "none", by_mode, seed=1)
    assert test is not None
    assert (test.pairs, test.valued, test.difference.value) == (4, 2, -0.5)
    assert test.p == pytest.approx(0.5)  # ranks 1.5 and 1.5 down, 3.5 and 3.5 up: sums of 7 or more in 4 of 16
    both = rows_of({"none": [1.0, None], "certified": [1.0, None]})
    assert against(DEPTH, "certified", "none", both, seed=1).p == 1.0  # type: ignore[union-attr]


def test_a_mode_is_best_only_if_it_beats_the_next() -> None:
    random = np.random.default_rng(3)
    base = random.normal(1.0, 0.1, 12)
    clear = {"paper": base + 0.5, "certified": base, "vector_field": base + 0.3 + 0.01 * random.normal(size=12)}
    text = best(DEPTH, rows_of({mode: list(of) for mode, of in clear.items()}), seed=1)
    assert text.startswith("certified") and "next vector field" in text
    equal = {mode: list(base + 0.1 * random.normal(size=12)) for mode in clear}
    assert best(DEPTH, rows_of(equal), seed=1).startswith("none beats the next")
    lost = rows_of({"paper": [None, 1.0], "certified": [1.0, 2.0]})
    assert best(DEPTH, lost, seed=1).startswith("fewer than two modes")


def trials_of(mode: str, count: int, random: np.random.Generator) -> tuple[list[Row], list[Row]]:
    """Returns made-up rows of E3 and E4."""
    common = {"mode": mode, "changed": "", "corridor": CORRIDOR, "ideal": False, "finished": True,
              "deepest_registered_mm": 0.0}
    e3 = [common | {"number": n, "spectral_arc_length": random.normal(-8.0)} for n in range(count)]
    e4 = []
    for n in range(count):
        deviations, depths = np.abs(random.normal(0.6, 0.2, 30)), random.normal(0.0, 0.6, 30)
        e4.append(common | {
            "number": n, "deviations_mm": [None, *deviations.tolist()[1:]], "depths_mm": depths.tolist(),
            "deviation_mm": deviations.mean(), "absolute_depth_mm": np.abs(depths).mean(),
            "duration_s": random.normal(220.0, 10.0)})
    return e3, e4


def test_every_printed_number_has_a_place_and_eight_tests_are_a_family() -> None:
    random = np.random.default_rng(4)
    made = [trials_of(mode, 7, random) for mode in (modes.NO_FIXTURE, "paper", "certified")]
    rows = {e.NAME: [row for of in made for row in of[i]] for i, e in enumerate((e3_path_tracing, e4_cutting))}
    found = published_numbers.findings(rows, Scale())
    tests, alarms, numbers = found.tables
    assert len(tests.rows) == 8 and len(alarms.rows) == 4 and len(found.claims) == 4 + len(published.EXTREMES)
    of_ends, of_extremes = 4 * 5, 2 * len(published.EXTREMES)
    assert len(numbers.rows) == of_ends + of_extremes
    assert all(sum(cell != "-" for cell in row[3:]) == (1 if row[1] == "free hand" else 2) for row in numbers.rows)
    raw, adjusted = ([float(row[i]) for row in tests.rows] for i in (6, 7))
    assert min(adjusted) == pytest.approx(min(1.0, 8 * min(raw)), rel=0.02)
    assert published_numbers.findings(rows, Scale()) == found
    only_e3 = published_numbers.findings({e3_path_tracing.NAME: rows[e3_path_tracing.NAME]}, Scale())
    alone = [float(row[7]) for row in only_e3.tables[0].rows]
    assert len(alone) == 2 and min(alone) == pytest.approx(
        min(1.0, 8 * min(float(row[6]) for row in only_e3.tables[0].rows)), rel=0.02)
