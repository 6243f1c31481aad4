# SPDX-License-Identifier: BSD-3-Clause
"""Tests the operator: random streams, bands and sizes of errors, decisions of the hand, compliance of the arm."""
import numpy as np
import pytest
from experiments.bone import BoneProperties
from experiments.intermittent import Intermittent
from experiments.open_loop import OpenLoop, adjustments, slow_error
from experiments.operator_model import Operator, streams, tremor
from experiments.trial import Course
from test_set_up_errors import straight_path
from trial_in_python import Arm, IntermittentHand, OpenLoopHand, Seen

PERIOD = 0.001


def power_within(signal: np.ndarray, low: float, high: float) -> float:
    """Returns the fraction of the power from `low` to `high` Hz."""
    spectrum = np.abs(np.fft.rfft(signal, axis=0)) ** 2
    frequency = np.fft.rfftfreq(len(signal), PERIOD)
    return float(spectrum[(frequency >= low) & (frequency <= high)].sum() / spectrum.sum())


@pytest.mark.parametrize("rms", [0.05, 0.13, 0.25])
def test_tremor_has_its_amount_and_its_band(rms: float) -> None:
    shake = tremor(np.random.default_rng(1), 60_000, PERIOD, rms)
    assert np.sqrt(np.mean(np.sum(shake**2, axis=1))) == pytest.approx(rms)
    assert power_within(shake, 7.0, 13.0) > 0.98
    assert power_within(shake, 0.0, 5.0) < 1e-3


def test_no_tremor_is_zero() -> None:
    assert not tremor(np.random.default_rng(1), 1000, PERIOD, 0.0).any()


def test_streams_differ_by_seed_and_purpose_and_repeat() -> None:
    def first(*seeds: int, purpose: str = "hand") -> float:
        return float(streams(*seeds)(purpose).random())

    assert first(1, 2) == first(1, 2)
    assert len({first(1, 2), first(2, 1), first(1, 2, purpose="tremor"), first(1, 2, purpose="sight")}) == 4


def test_slow_errors_are_below_two_hertz_and_of_unit_size() -> None:
    errors = slow_error(np.random.default_rng(2), 2_000_000, PERIOD, 0.03)
    assert power_within(errors, 0.0, 2.2) > 0.999
    assert np.mean(errors**2) == pytest.approx(1.0, abs=0.15)


def test_adjustments_are_from_half_a_hertz_to_two() -> None:
    errors = adjustments(np.random.default_rng(3), 200_000, PERIOD, 0.4)
    assert power_within(errors, 0.25, 4.0) > 0.95
    assert power_within(errors, 4.0, 500.0) < 0.001
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(0.4)


def test_the_arm_gives_way_by_force_over_stiffness() -> None:
    operator = Operator()
    arm = Arm(operator, np.zeros(3))
    force = np.array([0.0, 0.0, 0.5])
    for _ in range(3000):
        arm.move(np.zeros(3), np.zeros(3), force, PERIOD)
    assert arm.place == pytest.approx(force / operator.stiffness, abs=1e-9)


def test_the_arm_swings_as_mass_spring_and_damper_do() -> None:
    operator = Operator(damping=0.0)
    arm = Arm(operator, np.array([1.0, 0.0, 0.0]))
    places = [arm.move(np.zeros(3), np.zeros(3), np.zeros(3), PERIOD)[0] for _ in range(5000)]
    turns = np.count_nonzero(np.diff(np.sign(places)))
    natural = np.sqrt(operator.stiffness * 1000.0 / operator.mass) / (2 * np.pi)
    assert turns / 2 / 5.0 == pytest.approx(natural, rel=0.02)


def course(**settings) -> Course:
    return Course(path=straight_path(), depth=0.0, speed=2.0, **settings)


def exact() -> Intermittent:
    """Returns a hand without noise, drift or errors of sight."""
    return Intermittent(noise=0.0, drift=0.0, sight_across=0.0, sight_in_depth=0.0)


def started(hand: Intermittent, of: Course, fixture: bool = False, seed: int = 1) -> IntermittentHand:
    return IntermittentHand(Operator(hand=hand), of, hand.draw(of, streams(seed)), fixture)


def aims(hand: IntermittentHand, cycles: int, seen: Seen) -> np.ndarray:
    """Returns the intended places in cycles without an approach, in each of which the hand sees `seen`."""
    places = []
    for cycle in range(cycles):
        places.append(hand.aim(cycle, 0))
        hand.look(seen)
    return np.array(places)


def test_a_correction_is_one_movement_of_minimum_jerk() -> None:
    """The hand sees an error in depth from the start. The second decision knows that the first has corrected it."""
    error = 0.8
    hand = started(exact(), course())
    places = []
    for cycle in range(700):
        places.append(hand.aim(cycle, 0))
        hand.look(Seen(0.0, 0.0, error + places[-1][2], 0.0, 0.0))
    depth = np.array(places)[:, 2]
    part = np.clip((np.arange(700) - 250) / 500.0, 0.0, 1.0)
    assert depth == pytest.approx(-error * (10 * part**3 - 15 * part**4 + 6 * part**5), abs=1e-12)


def test_errors_below_the_tolerance_are_not_corrected() -> None:
    within = 0.9 * exact().tolerance
    places = aims(started(exact(), course()), 2000, Seen(0.0, within, within, 0.0, 0.0))
    assert not places[:, 1:].any()
    assert places[-1, 0] > 0.0  # it goes on along the path


def test_a_hand_that_sees_the_depth_wrong_does_not_go_on() -> None:
    places = aims(started(exact(), course()), 2000, Seen(0.0, 0.0, 3.0, 0.0, 0.0))
    assert not places[:, 0].any()
    assert places[-1, 2] < 0.0


def test_touch_frees_the_channel() -> None:
    """Without a fixture every second decision is about the depth, and the hand goes on half as often."""
    along = {}
    for name, fixture, push in (("sight", False, 0.0), ("touch", True, exact().touch)):
        places = aims(started(exact(), course(), fixture), 8000, Seen(0.0, 0.0, 0.0, 0.0, push))
        along[name] = places[-1, 0]
        assert not places[:, 1:].any()
    assert along["touch"] == pytest.approx(2.0 * along["sight"], rel=0.1)
    assert along["touch"] == pytest.approx(2.0 * 7.5, rel=0.1)  # the speed of the course


def test_with_a_fixture_the_hand_presses_until_it_feels_the_force_of_touch() -> None:
    of = course()
    hand = started(exact(), of, fixture=True)
    for cycle in range(6000):
        place = hand.aim(cycle, 0)
        push = of.force_per_mm * max(0.0, place[2] - 1.0)  # the fixture is 1 mm below
        hand.look(Seen(0.0, 0.0, min(place[2], 1.0), 0.0, push))
    assert push == pytest.approx(exact().touch, rel=0.01)


def test_a_hand_in_doubt_lifts_the_tool_and_enters_again() -> None:
    of = course(bone=BoneProperties())
    hand = started(exact(), of)
    places = []
    for cycle in range(8000):
        places.append(hand.aim(cycle, 0))
        wrong = 0.9 if 2000 < cycle <= 2500 else 1.8 if 2500 < cycle < 3000 else 0.0  # the view deceives
        hand.look(Seen(0.0, 0.0, places[-1][2] + wrong, 0.0, 0.0))
    depth = np.array(places)[:, 2]
    assert depth[:2000] == pytest.approx(0.0, abs=1e-12)
    assert depth.min() == pytest.approx(-exact().lift, abs=1e-9)
    assert depth[-1] == pytest.approx(0.0, abs=exact().tolerance + 1e-9)


def test_motor_noise_grows_with_the_movement() -> None:
    ends = []
    for error in (1.0, 4.0):
        landed = []
        for seed in range(40):
            hand = Intermittent(drift=0.0, sight_across=0.0, sight_in_depth=0.0, refractory=10.0)
            landed.append(aims(started(hand, course(), seed=seed), 10_600, Seen(0.0, 0.0, error, 0.0, 0.0))[-1, 2])
        ends.append(np.std(landed) / error)
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)
    assert ends[0] == pytest.approx(Intermittent().noise, rel=0.35)


def test_errors_of_the_open_loop_hand_depend_on_the_place_alone() -> None:
    of = course()
    operator = Operator(hand=OpenLoop(tolerance=1.0))
    draws = operator.hand.draw(of, streams(1))
    found = {}
    for offset in (0.0, 1.0):  # the second hand sees an error, and moves at half speed
        hand = OpenLoopHand(operator, of, draws, False)
        for cycle in range(3000):
            along, across, below = hand.aim(cycle, 0)
            hand.look(Seen(0.0, offset, 10.0, 0.0, 0.0))
        found[offset] = along
        expected = np.interp(along, np.arange(len(draws["errors"])) * of.speed / 50.0, draws["errors"][:, 0])
        assert across == pytest.approx(expected, abs=1e-9)
    assert found[1.0] == pytest.approx(found[0.0] / 2.0, rel=0.1)
