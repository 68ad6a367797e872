"""The delay with which a base follows, known from the motion alone."""

from collections.abc import Iterator
import math

import numpy as np
from push_model.geometry import Pose
from push_model.signals import Twist
from push_safety.delay_search import DelayMatch, DelaySearch
from push_safety.motion_check import LateDetector
import pytest

PERIOD = 0.02
# Search of a base that is identified, finer than that of one that is late.
FINE = 0.02


def expected(time: float, size: float = 1.0) -> Twist:
    """Move without any period, from rest."""
    time = max(0.0, time)
    return Twist(size * (0.1 * math.sin(1.1 * time) + 0.05 * math.sin(2.9 * time * time)), 0.0,
                 size * 0.3 * math.sin(1.7 * time))


def motion(delay: float, *, duration: float = 3.0, size: float = 1.0, offset: float = 0.0,
           period: float = PERIOD) -> Iterator[tuple[float, Twist, Twist]]:
    """Yield times, measured and expected velocities of a base that is late."""
    for i in range(round(duration / period)):
        v_x, v_y, omega = expected(i * period - delay, size)
        yield (i * period, Twist(v_x + offset, v_y, omega + offset), expected(i * period, size))


def match(delay: float, *, step: float = 0.05, angle: float = 0.0, noise: float = 0.0,
          period: float = PERIOD, sign: float = 1.0) -> DelayMatch:
    """Find a delay with any search, in axes that are rotated, or mirrored."""
    search = DelaySearch(history_time=3.0, max_delay=1.2, step=step)
    rng = np.random.default_rng(1)
    for time, measured, nominal in motion(delay, period=period):
        errors = (noise * rng.standard_normal(3)).tolist()
        search.add(time, *(Twist(*Pose(0.0, 0.0, angle).rotate((twist.v_x, sign * twist.v_y)),
                                 sign * twist.omega) for twist in (
            Twist(*(a + b for a, b in zip(measured, errors))), nominal)))
    found = search.find(0.4)
    assert found is not None
    return found


@pytest.mark.parametrize('step', [0.02, 0.05])
@pytest.mark.parametrize('delay', [0.0, 0.08, 0.21, 0.33, 0.47, 0.7, 1.01])
def test_a_delay_is_found_between_two_steps_of_the_search(delay: float, step: float) -> None:
    """Better than to the step; the delay that it is nearest to is a step."""
    found = match(delay, step=step)
    assert abs(found.delay - delay) <= 0.51 * step
    assert found.precise_delay == pytest.approx(delay, abs=0.15 * step)
    assert found.variance < 0.02 * found.measured_variance


@pytest.mark.parametrize('delay', [0.1, 0.5])
def test_noise_shifts_no_delay_by_more_than_a_step(delay: float) -> None:
    """Of 5 mm/s, and of 1 cm/s."""
    for noise in (0.005, 0.01):
        assert match(delay, noise=noise).precise_delay == pytest.approx(delay, abs=0.05)


@pytest.mark.parametrize('angle, sign', [(1.0, 1.0), (-2.5, 1.0), (0.0, -1.0)])
def test_axes_and_sides_make_no_difference(angle: float, sign: float) -> None:
    """Variances are those of vectors."""
    assert match(0.33, angle=angle, sign=sign) == pytest.approx(match(0.33), rel=1e-9)


@pytest.mark.parametrize('period', [0.01, 0.05])
def test_the_period_of_odometry_makes_little_difference(period: float) -> None:
    assert match(0.33, period=period).precise_delay == pytest.approx(0.33, abs=0.01)


def test_a_history_that_is_too_short_tells_nothing() -> None:
    """None at all, a single velocity, and one that started while the base moved already."""
    search = DelaySearch(history_time=3.0, max_delay=1.2, step=FINE)
    assert search.is_empty and search.find(0.0) is None
    search.add(0.0, Twist(0.0, 0.0, 0.0), Twist(0.0, 0.0, 0.0))
    assert search.find(0.0) is None and search.is_at_rest
    search.clear()
    for time, measured, nominal in motion(0.0):
        search.add(time, measured._replace(v_y=1.0), nominal)
        assert (search.find(0.4) is not None) == (time > 1.2 + 0.4 - 0.5 * PERIOD)


def late(delay: float, *, duration: float = 3.0, size: float = 1.0,
         offset: float = 0.0) -> float | None:
    """Find the delay of a robot that has moved for a while, where it is late."""
    detector = LateDetector()
    for time, measured, nominal in motion(delay, duration=duration, size=size, offset=offset):
        detector.add(time, measured, nominal)
    return detector.find(at_once=True)


@pytest.mark.parametrize('delay', [0.45, 0.7, 1.0])
@pytest.mark.parametrize('size', [0.3, 1.0])
@pytest.mark.parametrize('offset', [0.0, 0.015])
def test_a_base_is_late_whatever_is_added_to_the_motion(delay: float, size: float,
                                                        offset: float) -> None:
    """Its delay is named, for small motions too."""
    assert late(delay, size=size, offset=offset) == pytest.approx(delay, abs=0.01)


@pytest.mark.parametrize('delay', [0.0, 0.1, 0.3])
def test_a_base_that_follows_soon_is_not_late(delay: float) -> None:
    """At any moment."""
    for duration in (0.1, 0.3, 0.5, 1.0, 1.3, 2.0, 3.0):
        assert late(delay, duration=duration) is None


@pytest.mark.parametrize('slope', [0.02, 0.05, 0.2])
@pytest.mark.parametrize('scale', [0.93, 1.07])
def test_wheels_of_another_size_make_no_ramp_late(slope: float, scale: float) -> None:
    """It is below or above its command at any moment, and so would one be that is late."""
    detector = LateDetector()
    for i in range(300):
        velocity = Twist(0.1 + slope * i * PERIOD, 0.0, 0.0)
        detector.add(i * PERIOD, Twist(scale * velocity.v_x, 0.0, 0.0), velocity)
        assert i == 0 or detector.find(at_once=True) is None
