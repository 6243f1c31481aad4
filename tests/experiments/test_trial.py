# SPDX-License-Identifier: BSD-3-Clause
"""Tests trials on the phantom, with and without a virtual fixture. The same seed gives the same trial."""
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from experiments import anatomy, e3_path_tracing, e4_cutting, modes, teleoperation
from experiments.bone import BoneProperties
from experiments.open_loop import OpenLoop
from experiments.operator_model import Operator
from experiments.rules.native import terrain_of
from experiments.rules.rule import Rule
from experiments.set_up_errors import SetUp
from experiments.teleoperation import Simulation, Trial
from experiments.trial import Course
from trial_in_python import run_in_python

try:
    anatomy.mesh_file("skull")
except (OSError, anatomy.subprocess.CalledProcessError) as missing:
    pytest.skip(f"the CT skull is not prepared: {missing}", allow_module_level=True)

#: The arrays of a trace.
ARRAYS = ("tip", "setpoint", "goal", "force", "power", "contact", "kerf")
HANDS = {"intermittent": Simulation(), "open_loop": Simulation(Operator(hand=OpenLoop()))}


def short_trial(mode: str, seed: int = 1, setup: SetUp = SetUp(), cut: bool = True):
    """Returns eight seconds of cutting, deep enough to cut through the shell, and their measures."""
    path, index = anatomy.phantom()
    bone = BoneProperties(resistance=0.2) if cut else None
    course = Course(path=path, depth=anatomy.SHELL, speed=0.5, bone=bone, time_limit=8.0)
    trial = Trial(mode, (seed,), course, index, HANDS["open_loop"].operator, setup)
    trace = trial.run()
    return trace, trial.measures(trace)


def seconds_of(trial: Trial, seconds: float) -> Trial:
    return replace(trial, course=replace(trial.course, time_limit=seconds))


@pytest.mark.parametrize("mode", modes.MODES)
@pytest.mark.parametrize("hand", HANDS)
def test_the_loop_in_c_plus_plus_has_the_bits_of_the_loop_in_python(
    mode: str, hand: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two seconds: the approach, the first contact with fixture and bone, and the first decisions."""
    for experiment in (e3_path_tracing, e4_cutting):
        if mode not in teleoperation.SWEPT and experiment is e3_path_tracing:
            continue  # to save time: a rule in Python is called back in the same way in both
        ideal = mode == "all_faces"  # no latency, no registration error, and no bone in E4
        trial = seconds_of(experiment.planned(mode, 1, ideal=ideal, simulation=HANDS[hand]), 2.0)
        native = trial.run()
        with monkeypatch.context() as patch:
            patch.setattr(teleoperation, "run_trial", run_in_python)
            python = trial.run()
        for name in ARRAYS:
            assert np.array_equal(getattr(native, name), getattr(python, name)), name
        assert (native.begun, native.finished) == (python.begun, python.finished)
        assert native.force.any() or mode == modes.NO_FIXTURE or experiment is e4_cutting


def test_trials_in_threads_are_those_in_turn() -> None:
    planned = [(mode, n) for n in range(2) for mode in ("none", "certified", "vector_field")]
    trials = [seconds_of(e4_cutting.planned(mode, 1, n), 4.0) for mode, n in planned]
    in_turn = [trial.run() for trial in trials]
    with ThreadPoolExecutor(4) as pool:
        in_threads = list(pool.map(Trial.run, trials))
    for one, other in zip(in_turn, in_threads, strict=True):
        assert all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ARRAYS)


def test_an_error_in_a_rule_ends_the_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken:
        def step(self, tip, desired):
            raise RuntimeError("no such motion")

    monkeypatch.setattr(modes, "make_rule", lambda mode, task: Broken())
    with pytest.raises(RuntimeError, match="no such motion"):
        seconds_of(e3_path_tracing.planned("none", 1), 2.0).run()


def test_all_modes_meet_the_same_operator_and_registration() -> None:
    """Before the first contact, the goals of all modes are the same."""
    traces = [seconds_of(e3_path_tracing.planned(mode, 1), 0.6).run() for mode in ("none", "paper", "certified")]
    for trace in traces[1:]:
        assert np.array_equal(trace.goal, traces[0].goal)
        assert np.array_equal(trace.registered.translation, traces[0].registered.translation)


def test_a_row_is_that_of_its_seed_and_number() -> None:
    row, again, other = (e3_path_tracing.trial("certified", 1, n) for n in (0, 0, 1))
    assert row == again and row["finished"] and row["crossings"] == 0
    assert row["duration_s"] != other["duration_s"]
    light = e3_path_tracing.trial("certified", 1, 0, judged=False)
    assert light.items() <= row.items()


def test_the_cut_of_a_trial_has_the_width_of_the_blade_at_least() -> None:
    row = e4_cutting.trial("certified", 1, judged=False)
    assert row["finished"] and row["millimetres_reached"] == e4_cutting.SAMPLES
    assert min(row["deviations_mm"]) >= BoneProperties().kerf / 2


def test_the_phantom_is_a_shell_of_two_millimetres_on_a_closed_block() -> None:
    path, index = anatomy.phantom()
    found = index.mesh.inspect(self_intersections=True)
    assert found.watertight and not found.inside_out and found.self_intersections == 0
    assert path.length == pytest.approx(anatomy.PATH_LENGTH)
    assert np.ptp(path.points[:, 0]) == 0.0
    distances = terrain_of(index.mesh).judge().distances(path.points)
    assert distances == pytest.approx(np.full(len(path.points), anatomy.SHELL), abs=0.02)


def test_the_path_lies_on_the_outside_of_the_print() -> None:
    path, index = anatomy.printed_skull()
    assert index.distances(path.points).max() < 0.02
    assert anatomy.real_index("skull").distances(path.points).max() < 0.5
    assert path.length == pytest.approx(anatomy.PATH_LENGTH)


def test_certified_holds_a_hand_that_leans_on_it_and_no_fixture_does_not() -> None:
    trace, held = short_trial("certified")
    assert held["crossings"] == 0 and held["deepest_registered_mm"] == 0.0
    assert held["greatest_force_n"] > 0.1  # the operator pressed on the fixture
    assert held["beyond_registration_mm"] == 0.0
    across = trace.setpoint[:, 0] - anatomy.SAGITTAL_X
    assert np.abs(across).max() < teleoperation.CORRIDOR + 0.01
    free = [short_trial("none", seed)[1] for seed in range(4)]
    assert max(row["deepest_mm"] for row in free) > 0.2
    assert all(row["force_n"] == 0.0 for row in free)


def test_a_fixture_takes_less_energy_from_the_hand_if_its_force_comes_late() -> None:
    at_once = short_trial("certified", setup=SetUp(latency=0.0))[1]
    trace, late = short_trial("certified", setup=SetUp(latency=0.02))
    assert at_once["energy_mj"] < 0.0
    assert at_once["energy_mj"] < late["energy_mj"]
    # The force is at most 0.3 N/mm times the distance between goal and setpoint.
    apart = np.linalg.norm(trace.setpoint - trace.goal, axis=1)
    assert np.all(trace.force <= 0.3 * apart + 1e-9)


class Stops:
    """Moves only if nothing limits the motion."""

    def __init__(self, rule: Rule) -> None:
        self._rule = rule

    def step(self, tip: np.ndarray, desired: np.ndarray) -> np.ndarray:
        return desired if np.array_equal(self._rule.step(tip, desired), desired) else np.zeros(3)


def test_a_tool_that_is_stuck_does_not_come_to_the_end_of_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    path, _ = anatomy.phantom()

    def along() -> float:
        trace, _ = short_trial("certified", cut=False)
        return float(path.depths(trace.tip[-1:])[0][0])

    slides = along()
    make_rule = modes.make_rule
    monkeypatch.setattr(modes, "make_rule", lambda mode, task: Stops(make_rule(mode, task)))
    assert along() < 0.6 < 1.0 < slides


def test_the_same_seed_is_the_same_trial_and_another_is_not() -> None:
    first, again, other = (short_trial("certified", seed)[0] for seed in (1, 1, 2))
    assert np.array_equal(first.tip, again.tip) and np.array_equal(first.force, again.force)
    assert not np.array_equal(first.tip[:1000], other.tip[:1000])


def test_the_narrower_the_corridor_the_less_it_deviates() -> None:
    path, index = anatomy.phantom()
    course = Course(path=path, depth=0.0, speed=0.5, time_limit=8.0)
    operator = Operator(hand=OpenLoop(slow_across=1.5, bias_across=1.5))
    widest = []
    for corridor in (0.25, 1.0):
        trace = Trial("certified", (3,), course, index, operator, SetUp.ideal(), corridor).run()
        widest.append(np.abs(trace.setpoint[:, 0] - anatomy.SAGITTAL_X).max())
    assert widest[0] < 0.26 < 0.5 < widest[1] < 1.01
