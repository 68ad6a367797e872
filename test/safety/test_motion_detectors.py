"""What is noticed of a base before any model fails: how closely it follows, stuck."""

import math

import numpy as np
from numpy.typing import NDArray
from push_model.signals import STOP, Twist
from push_safety.motion_check import (
    ACCELERATION, add_sample, CloseFollowing, FOLLOWS, INTEGRAL_COUNT, MAX_SUPPORT,
    STUCK, STUCK_MEMORY, StuckDetector, WEIGHT)
from push_safety.tolerances import LEARNING_TIME, LEVER_ARM, SETTLING_TIME
import pytest

AHEAD, TURNING = Twist(0.2, 0.0, 0.0), Twist(0.2, 0.0, 0.5)


def followed(following, velocity, duration, is_close=True):
    for _ in range(round(duration / 0.02)):
        following.add(velocity, 0.02, is_close=is_close)


def test_every_axis_that_moves_must_have_been_seen():
    """A drive straight ahead tells nothing of turning, and nothing of standing."""
    following = CloseFollowing()
    followed(following, AHEAD, 0.5 * LEARNING_TIME)
    assert not following.is_known(AHEAD)
    followed(following, AHEAD, 0.6 * LEARNING_TIME)
    assert following.is_known(AHEAD) and not following.is_known(TURNING)
    assert not following.is_known(STOP)
    followed(following, TURNING, 1.1 * LEARNING_TIME)
    assert following.is_known(TURNING)


def test_what_was_in_doubt_must_be_shown_for_twice_as_long():
    """Again and again, so that a base with noise is soon not held to it any more."""
    following, expected = CloseFollowing(), LEARNING_TIME
    for _ in range(3):
        followed(following, AHEAD, 1.1 * expected)
        assert following.is_known(AHEAD)
        followed(following, AHEAD, 0.1, is_close=False)
        assert following.is_known(AHEAD)
        expected *= 2.0
        followed(following, AHEAD, 0.9 * expected)
        assert not following.is_known(AHEAD)


def test_a_command_that_jumps_is_not_judged_closely():
    """Until a base with any acceleration has settled."""
    following = CloseFollowing()
    assert following.is_settled((0.1, 0.0, 0.5), 0.0)
    assert not following.is_settled((0.0, 0.0, 1.0), 1.0)
    assert not following.is_settled((0.0, 0.0, 0.0), 1.0 + 0.9 * SETTLING_TIME)
    assert following.is_settled((0.0, 0.0, 0.0), 1.0 + 1.1 * SETTLING_TIME)


PERIOD = 0.02
ALL_COUNT = np.zeros(1)
TIMES = np.arange(0.0, 2.0, PERIOD)
# A command that varies by 20 mm/s, and by 0.1 rad/s.
MODEL = np.stack([0.15 + 0.02 * np.sin(4.0 * TIMES), 0.0 * TIMES, 0.1 * np.cos(4.0 * TIMES)],
                 axis=1)


def found_stuck(measured: NDArray[np.float64], model: NDArray[np.float64] = MODEL) -> list[bool]:
    """Tell after each sample whether the base is stuck, with one model."""
    test, found = StuckDetector(1), []
    rates = np.abs(np.diff(model, axis=0, prepend=model[:1])) / PERIOD
    for velocity, rate, sample in zip(model, rates, measured):
        test.add(velocity[None], rate[None], sample, PERIOD)
        found.append(test.is_stuck(ALL_COUNT, 0.0))
    return found


def random_samples(size: float) -> tuple[NDArray[np.float64], ...]:
    """Draw durations, and velocities, rates of two models and measured ones of a size."""
    rng = np.random.default_rng(1)
    return (rng.uniform(0.01, 0.1, 40), rng.normal(0.0, size, (40, 2, 3)),
            rng.uniform(0.0, 1.0, (40, 2, 3)), rng.normal(0.0, size, (40, 3)))


def test_integrals_are_those_of_weighted_samples() -> None:
    """Computed anew from all samples, with steps of any duration; where little speaks for any."""
    durations, models, rates, measured = samples = random_samples(2e-3)
    means, integrals = np.zeros((2, 2, 3)), np.zeros((2, INTEGRAL_COUNT))
    for dt, model, rate, sample in zip(*samples):
        add_sample(model, rate, sample, means, integrals, dt)
    ends = np.cumsum(durations)
    weights = durations * np.exp((ends - ends[-1]) / STUCK_MEMORY)
    units = np.array((1.0, 1.0, LEVER_ARM))

    def squares(values: NDArray[np.float64]) -> float:
        deviations = units * (values - np.average(values, axis=0, weights=weights))
        return float(weights @ (deviations * deviations).sum(axis=1))
    for i in range(2):
        assert integrals[i, FOLLOWS] == pytest.approx(squares(models[:, i] - measured))
        assert integrals[i, STUCK] == pytest.approx(squares(measured))
        assert integrals[i, WEIGHT] == pytest.approx(weights.sum())
        assert integrals[i, ACCELERATION] == pytest.approx(
            float(weights @ ((units * rates[:, i]) ** 2).sum(axis=1)))


def test_no_past_speaks_for_a_model_by_more_than_counts() -> None:
    """And what has weighed less since weighs so in all integrals alike."""
    means, integrals = np.zeros((2, 2, 3)), np.zeros((2, INTEGRAL_COUNT))
    for dt, model, rate, sample in zip(*random_samples(0.1)):
        before = integrals.copy()
        add_sample(model, rate, sample, means, integrals, dt)
        support = 2.0 * integrals[:, STUCK] - integrals[:, FOLLOWS]
        assert (support <= MAX_SUPPORT * (1.0 + 1e-9)).all()
        assert (integrals[:, WEIGHT] <= before[:, WEIGHT] + dt).all()


@pytest.mark.parametrize('yaw_rate', [0.0, 0.5, 1.0, 2.0])
def test_a_base_that_has_just_followed_a_fast_turn_is_not_believed_for_long(
        yaw_rate: float) -> None:
    """It keeps the velocity that it has at the end of the turn [rad/s], while it is to brake."""
    turn = np.clip(np.minimum(TIMES, 1.0 - TIMES) / 0.5, 0.0, 1.0)
    model = np.stack([0.15 - 0.2 * np.clip(TIMES - 1.0, 0.0, None), 0.0 * TIMES, yaw_rate * turn],
                     axis=1)
    end = round(1.0 / PERIOD)
    measured = np.concatenate([model[:end], np.broadcast_to(model[end], model[end:].shape)])
    found = found_stuck(measured, model)
    assert not any(found[:end]) and any(found[:end + round(0.34 / PERIOD)])


@pytest.mark.parametrize('acceleration', [0.3, 1.0, 3.0])
@pytest.mark.parametrize('delay', [0.0, 0.03])
def test_a_base_that_follows_a_little_later_than_a_model_is_not_stuck(
        acceleration: float, delay: float) -> None:
    """By half of the step of their delays, however fast its commands change their direction."""
    def speeds(times: NDArray[np.float64]) -> NDArray[np.float64]:
        phases = np.maximum(times - 0.2, 0.0) / 0.4
        triangle = 0.1 + 0.2 * acceleration * np.abs(phases % 2.0 - 1.0)
        return np.stack([triangle, 0.0 * times, 0.0 * times], axis=1)
    assert not any(found_stuck(speeds(TIMES - delay), speeds(TIMES)))


@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_a_base_that_keeps_a_velocity_is_stuck(noise: float) -> None:
    """Whichever it keeps, with noise as well; it is not where nothing is commanded to vary."""
    draws = noise * np.random.default_rng(2).standard_normal(MODEL.shape) * (1.0, 1.0, 2.0)
    for velocity in ((0.15, 0.0, 0.1), (0.0, 0.0, 0.0)):
        measured = np.broadcast_to(velocity, MODEL.shape) + draws
        found = found_stuck(measured)
        assert any(found) and found.index(True) * PERIOD < 0.5
        assert not any(found_stuck(measured, np.broadcast_to(MODEL[0], MODEL.shape)))


@pytest.mark.parametrize('ratio', [0.42, 1.0, 1.5])
@pytest.mark.parametrize('offset', [-0.1, 0.0, 0.1])
def test_a_base_that_follows_in_some_measure_is_not_stuck(ratio: float, offset: float) -> None:
    """With wheels of another size, and driven by something else besides."""
    draws = 0.005 * np.random.default_rng(3).standard_normal(MODEL.shape) * (1.0, 1.0, 2.0)
    assert not any(found_stuck(ratio * MODEL + offset + draws))


@pytest.mark.parametrize('step', [0.005, 0.01])
def test_a_base_whose_speeds_come_in_steps_is_not_stuck(step: float) -> None:
    """As it keeps each of them for a while only."""
    for slope in (0.02, 0.05, 0.1, 0.3):
        model = np.stack([0.1 + slope * TIMES, 0.0 * TIMES, 0.0 * TIMES], axis=1)
        assert not any(found_stuck(step * np.round(model / step), model))


def test_a_model_that_does_not_count_explains_nothing() -> None:
    """One that does is enough; none says nothing."""
    test = StuckDetector(2)
    for velocity in MODEL:
        test.add(np.stack([velocity, MODEL[0]]), np.zeros((2, 3)), MODEL[0], PERIOD)
    assert not test.is_stuck(np.zeros(2), 0.0)
    assert test.is_stuck(np.array((0.0, 1.0)), 0.5)
    assert not test.is_stuck(np.full(2, math.inf), 0.5)
    test.clear()
    assert not test.is_stuck(np.zeros(2), 0.0)
