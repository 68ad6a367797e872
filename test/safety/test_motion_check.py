"""Motion against commands: laws of a base that follows as stated, and of one that does not."""

from collections.abc import Callable
import dataclasses
import itertools
import math

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, STOP, Twist
from push_safety.motion_check import MotionCheck
from push_safety.status import SafetyReport
from push_safety.tolerances import (
    ACCELERATION_RATIOS, AXIS_TOLERANCE, CLOSE_RATIO, CLOSE_SPEED_TOLERANCE, LAGS,
    MAX_RESIDUAL_SUM, MAX_RESPONSE_TIME, SPEED_TOLERANCE, WHEEL_TOLERANCE)
import pytest

ROBOT = RoundRobot(radius=0.17, drive='holonomic', max_speed=0.4, max_yaw_rate=1.5,
                   max_acceleration=0.8, time_constant=0.1)
# Step in which the true base moves [s]; far below its lag.
FINE_STEP = 0.002
HERE = Pose(0.0, 0.0, 0.0)
Command = Callable[[float], Twist]
# What a base does with a command that acts at a time, and with the velocity that it has.
Heed = Callable[[float, Twist, Twist], Twist]


@dataclasses.dataclass(frozen=True)
class Base:
    """
    A base, integrated in fine steps.

    :param delay: from a command to the first motion [s].
    :param lag: its time constant [s].
    :param acceleration_ratio: its limit over that of ``ROBOT``.
    :param period: of its odometry [s].
    :param noise: of its odometry, along an axis [m/s], and of twice that [rad/s].
    :param gap: time of every second in which no odometry comes [s].
    """

    delay: float = 0.1
    lag: float = 0.1
    acceleration_ratio: float = 1.0
    period: float = 0.02
    noise: float = 0.0
    gap: float = 0.0

    def first_fault(self, command: Command, duration: float, heed: Heed | None = None, *,
                    is_mirrored: bool = False, seed: int = 0,
                    since: float = 0.0) -> tuple[float, float, SafetyReport] | None:
        """
        Drive, and find when and why the base is first said not to follow.

        :param heed: what it does otherwise.
        :param is_mirrored: whether left is right.
        :param since: when it starts to do otherwise [s].
        :return: time [s], how far it was beside what a good base does since then [m], and report.
        """
        rng, check = np.random.default_rng(seed), MotionCheck(ROBOT)
        sign = -1.0 if is_mirrored else 1.0
        velocity = good = STOP
        sent, beside = list[tuple[float, Twist]](), np.zeros(2)
        steps = round(self.period / FINE_STEP)
        for index in range(round(duration / self.period)):
            time = index * self.period
            errors = (self.noise * rng.standard_normal(3) * (1.0, 1.0, 2.0)).tolist()
            seen = Twist(*(a + b for a, b in zip(velocity, errors)))
            report = None if time % 1.0 < self.gap else check.check(Odometry(
                100.0 + time, HERE, Twist(seen.v_x, sign * seen.v_y, sign * seen.omega)))
            if report is not None:
                return time, float(np.hypot(*beside)), report
            wanted = command(time)
            check.add_command(Twist(wanted.v_x, sign * wanted.v_y, sign * wanted.omega),
                              100.0 + time)
            sent.append((time, wanted))
            for fine in range(steps):
                now = time + fine * FINE_STEP
                acting = next((twist for at, twist in reversed(sent)
                               if at <= now - self.delay + 1e-9), STOP)
                good = self._followed(good, acting)
                is_good = heed is None or now < since
                target = acting if is_good or heed is None else heed(now, acting, velocity)
                velocity = self._followed(velocity, target)
                beside += FINE_STEP * (np.array(velocity[:2]) - good[:2])
        return None

    def _followed(self, velocity: Twist, target: Twist) -> Twist:
        """Follow with first order and limited acceleration for a fine step."""
        ratio = 1.0 - math.exp(-FINE_STEP / self.lag)
        d_x, d_y, d_omega = (a - b for a, b in zip(target, velocity))
        limit = self.acceleration_ratio * ROBOT.max_acceleration * FINE_STEP
        yaw_limit = self.acceleration_ratio * ROBOT.max_yaw_acceleration * FINE_STEP
        part = min(ratio, limit / max(math.hypot(d_x, d_y), 1e-9))
        turn = min(ratio, yaw_limit / max(abs(d_omega), 1e-9))
        return Twist(velocity.v_x + part * d_x, velocity.v_y + part * d_y,
                     velocity.omega + turn * d_omega)


def waves(speed: float, phase: float = 0.0) -> Command:
    """Return commands that vary smoothly along all axes."""
    return lambda time: Twist(speed * (1.0 + 0.4 * math.sin(1.3 * time + phase)),
                              0.3 * speed * math.sin(0.9 * time + 2.0 * phase),
                              2.0 * speed * math.sin(1.7 * time + phase))


def steps(seed: int) -> Command:
    """Return commands that jump at random moments, now and then to rest."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.exponential(0.8, 40))
    twists = [Twist(*(value * is_moving).tolist()) for value, is_moving in zip(
        rng.uniform((-0.3, -0.2, -1.0), (0.3, 0.2, 1.0), (41, 3)), rng.random(41) < 0.8)]
    return lambda time: twists[int(np.searchsorted(times, time, 'right'))]


def is_off(now: float, acting: Twist, velocity: Twist) -> Twist:
    """Stop whatever is commanded."""
    return STOP


def keeps(now: float, acting: Twist, velocity: Twist) -> Twist:
    """Go on with the velocity that it has."""
    return velocity


def is_reversed(now: float, acting: Twist, velocity: Twist) -> Twist:
    """Move the other way round."""
    return Twist(-acting.v_x, -acting.v_y, -acting.omega)


def is_turned(now: float, acting: Twist, velocity: Twist) -> Twist:
    """Move at a right angle to the command."""
    return Twist(-acting.v_y, acting.v_x, acting.omega)


def is_driven(now: float, acting: Twist, velocity: Twist) -> Twist:
    """Move as somebody else commands it."""
    return Twist(0.3, 0.2, -1.0)


@pytest.mark.parametrize('seed', range(30))
def test_a_base_that_follows_as_stated_is_never_stopped(seed: int) -> None:
    """Whatever its delay, lag, acceleration, period and noise are, within what is stated."""
    rng = np.random.default_rng(seed)
    (low, _), (high, margin) = LAGS[0], LAGS[-1]
    base = Base(delay=rng.uniform(0.0, MAX_RESPONSE_TIME - 0.1),
                lag=rng.uniform(low * ROBOT.time_constant,
                                high * ROBOT.time_constant + margin),
                acceleration_ratio=rng.uniform(ACCELERATION_RATIOS[0], ACCELERATION_RATIOS[-1]),
                period=float(rng.choice([0.01, 0.02, 0.05])), noise=rng.uniform(0.0, 0.006))
    for command in (steps(seed), waves(rng.uniform(0.02, 0.3), rng.uniform(-3.0, 3.0))):
        assert base.first_fault(command, 8.0, seed=seed) is None


@pytest.mark.parametrize('gap', [0.2, 0.45])
@pytest.mark.parametrize('seed', range(4))
def test_a_base_that_follows_while_no_odometry_comes_is_not_stopped(seed: int, gap: float) -> None:
    """Commands that change meanwhile count from when they were sent."""
    assert Base(gap=gap).first_fault(steps(seed), 8.0) is None


PHASES = [0.2 * k for k in range(12)]
PERIODS = 0.01, 0.02, 0.05


@pytest.mark.slow
@pytest.mark.parametrize('heed', [is_off, is_reversed, is_turned, is_driven])
@pytest.mark.parametrize('speed, max_time', [(0.05, 0.38), (0.1, 0.2), (0.15, 0.2), (0.3, 0.2)])
def test_a_base_that_does_something_else_is_stopped_soon_at_every_phase(
        heed: Heed, speed: float, max_time: float) -> None:
    """And within 2 cm of where a good base would be; the slower it should move, the later."""
    for (index, phase), noise in itertools.product(enumerate(PHASES), (0.0, 0.004)):
        period = PERIODS[index % len(PERIODS)]
        since = 3.0 + phase
        fault = Base(period=period, noise=noise).first_fault(waves(speed), 8.0, heed, since=since)
        assert fault is not None
        time, beside, report = fault
        assert since < time <= since + max_time + 2.0 * period and beside < 0.02
        assert report.code.is_of_motion


@pytest.mark.slow
@pytest.mark.parametrize('speed, max_time', [(0.05, 1.2), (0.1, 0.7), (0.15, 0.5), (0.3, 0.35)])
def test_a_base_that_keeps_its_velocity_is_stopped_before_that_matters(
        speed: float, max_time: float) -> None:
    """At every phase of a motion that varies: within 16 mm of where a good base would be."""
    for phase, noise in itertools.product(PHASES, (0.0, 0.004)):
        since = 3.0 + phase
        fault = Base(noise=noise).first_fault(waves(speed), 8.0, keeps, since=since)
        assert fault is not None
        assert since < fault[0] <= since + max_time and fault[1] < 0.016


@pytest.mark.parametrize('speed', [0.05, 0.15, 0.3])
@pytest.mark.parametrize('sign', [-1.0, 1.0])
def test_a_constant_deviation_is_noticed_after_the_time_that_its_size_means(
        speed: float, sign: float) -> None:
    """A deviation d after h / (d / s - 1) and the lag of the base; below s it never is."""
    steady = (AXIS_TOLERANCE + WHEEL_TOLERANCE) * speed
    tolerated = SPEED_TOLERANCE + steady
    lag = Base().lag
    for ratio in (1.5, 2.0, 4.0):
        def deviates(now: float, acting: Twist, velocity: Twist, ratio: float = ratio) -> Twist:
            return acting._replace(v_x=acting.v_x + sign * ratio * tolerated)
        fault = Base().first_fault(lambda _: Twist(speed, 0.0, 0.0), 8.0, deviates, since=3.0)
        assert fault is not None
        assert 3.0 < fault[0] < 3.0 + MAX_RESIDUAL_SUM / (ratio - 1.0) + 3.0 * lag

    def is_close(now: float, acting: Twist, velocity: Twist) -> Twist:
        deviation = 0.9 * (CLOSE_SPEED_TOLERANCE + CLOSE_RATIO * steady)
        return acting._replace(v_x=acting.v_x + sign * deviation)
    assert Base().first_fault(lambda _: Twist(speed, 0.0, 0.0), 12.0, is_close, since=3.0) is None


@pytest.mark.parametrize('heed', [is_off, is_reversed, is_turned, is_driven, keeps])
@pytest.mark.parametrize('phase', PHASES[::4])
def test_left_and_right_make_no_difference(heed: Heed, phase: float) -> None:
    """The mirror image of a drive is stopped at the same message, for the same reason."""
    fault, image = (Base().first_fault(waves(0.2), 8.0, heed, since=3.0 + phase,
                                       is_mirrored=is_mirrored) for is_mirrored in (False, True))
    assert fault is not None and image is not None
    assert fault[:2] == image[:2] and fault[2].code is image[2].code
