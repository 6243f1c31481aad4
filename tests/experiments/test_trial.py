# SPDX-License-Identifier: BSD-3-Clause
"""Tests trials on the phantom, with and without a virtual fixture. The same seed gives the same trial."""
import numpy as np
import pytest
from experiments import anatomy, modes, teleoperation
from experiments.bone import BoneProperties
from experiments.operator_model import Operator
from experiments.rules.rule import Rule
from experiments.set_up_errors import SetUp
from experiments.trial import Course

try:
    anatomy.mesh_file("skull")
except (OSError, anatomy.subprocess.CalledProcessError) as missing:
    pytest.skip(f"the CT skull is not prepared: {missing}", allow_module_level=True)

from keepout_peers import Judge  # noqa: E402


def short_trial(mode: str, seed: int = 1, setup: SetUp = SetUp(), cut: bool = True):
    """Returns eight seconds of cutting, deep enough to cut through the shell, and their measures."""
    path, index = anatomy.phantom()
    bone = BoneProperties(resistance=0.2) if cut else None
    course = Course(path=path, depth=anatomy.SHELL, speed=0.5, bone=bone, time_limit=8.0)
    trace = teleoperation.operate(mode, course, index, Operator(), setup, (seed,))
    judge = Judge(index.mesh.vertices, index.mesh.triangles)
    return trace, teleoperation.measures(trace, course, judge)


def test_the_phantom_is_a_shell_of_two_millimetres_on_a_closed_block() -> None:
    path, index = anatomy.phantom()
    found = index.mesh.inspect(self_intersections=True)
    assert found.watertight and not found.inside_out and found.self_intersections == 0
    assert path.length == pytest.approx(anatomy.PATH_LENGTH)
    assert np.ptp(path.points[:, 0]) == 0.0
    distances = Judge(index.mesh.vertices, index.mesh.triangles).distances(path.points)
    assert distances == pytest.approx(np.full(len(path.points), anatomy.SHELL), abs=0.02)


def test_the_path_lies_on_the_outside_of_the_skull() -> None:
    path = anatomy.skull_path()
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


def test_a_fixture_takes_energy_from_the_hand_unless_its_force_comes_late() -> None:
    at_once = short_trial("certified", setup=SetUp(latency=0.0))[1]
    trace, late = short_trial("certified", setup=SetUp(latency=0.02))
    assert at_once["energy_mj"] < 0.0 < late["energy_mj"]
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
    monkeypatch.setattr(modes, "make_rule", lambda *task: Stops(make_rule(*task)))
    assert along() < 0.6 < 2.0 < slides


def test_the_same_seed_is_the_same_trial_and_another_is_not() -> None:
    first, again, other = (short_trial("certified", seed)[0] for seed in (1, 1, 2))
    assert np.array_equal(first.tip, again.tip) and np.array_equal(first.force, again.force)
    assert not np.array_equal(first.tip[:1000], other.tip[:1000])


def test_the_narrower_the_corridor_the_less_it_deviates() -> None:
    path, index = anatomy.phantom()
    course = Course(path=path, depth=0.0, speed=0.5, time_limit=8.0)
    operator = Operator(slow_across=1.5, bias_across=1.5)
    widest = []
    for corridor in (0.25, 1.0):
        trace = teleoperation.operate(
            "certified", course, index, operator, SetUp.ideal(), (3,), corridor
        )
        widest.append(np.abs(trace.setpoint[:, 0] - anatomy.SAGITTAL_X).max())
    assert widest[0] < 0.26 < 0.5 < widest[1] < 1.01
