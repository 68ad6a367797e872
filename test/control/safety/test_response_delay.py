"""The delay with which a robot follows its commands, known from the motion alone."""

import math

from push_control.safety.response_delay import ResponseDelay
from push_model.signals import Twist
import pytest

PERIOD = 0.02
SHORTEST = 0.4


def nominal(time: float, size: float = 1.0) -> Twist:
    """Move without any period, from rest."""
    time = max(0.0, time)
    return Twist(size * (0.1 * math.sin(1.1 * time) + 0.05 * math.sin(2.9 * time * time)), 0.0,
                 size * 0.3 * math.sin(1.7 * time))


def found_delay(delay: float, *, duration: float = 3.0, size: float = 1.0,
                offset: float = 0.0) -> float | None:
    """Find the delay of a robot that has moved for a while."""
    response = ResponseDelay(0.2, SHORTEST)
    for i in range(round(duration / PERIOD)):
        v_x, v_y, omega = nominal(i * PERIOD - delay, size)
        response.add(i * PERIOD, Twist(v_x + offset, v_y, omega + offset),
                     nominal(i * PERIOD, size))
    return response.find(at_once=True)


@pytest.mark.parametrize('delay', [0.45, 0.7, 1.0])
@pytest.mark.parametrize('size', [0.3, 1.0])
@pytest.mark.parametrize('offset', [0.0, 0.015])
def test_a_delay_is_found_whatever_is_added_to_the_motion(delay: float, size: float,
                                                          offset: float) -> None:
    """To the step of the search, for small motions too."""
    assert found_delay(delay, size=size, offset=offset) == pytest.approx(delay, abs=0.051)


@pytest.mark.parametrize('delay', [0.0, 0.1, 0.3])
def test_a_robot_that_follows_soon_is_not_late(delay: float) -> None:
    """At any moment."""
    for duration in (0.1, 0.3, 0.5, 1.0, 1.3, 2.0, 3.0):
        assert found_delay(delay, duration=duration) is None


@pytest.mark.parametrize('slope', [0.02, 0.05, 0.2])
@pytest.mark.parametrize('scale', [0.93, 1.07])
def test_wheels_of_another_size_make_no_ramp_late(slope: float, scale: float) -> None:
    """It is below or above its command at any moment, and so would one be that is late."""
    response = ResponseDelay(0.2, SHORTEST)
    for i in range(300):
        velocity = Twist(0.1 + slope * i * PERIOD, 0.0, 0.0)
        response.add(i * PERIOD, Twist(scale * velocity.v_x, 0.0, 0.0), velocity)
        assert i == 0 or response.find(at_once=True) is None
