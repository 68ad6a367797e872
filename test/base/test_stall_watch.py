"""A base that stands at an object although it is commanded."""

from push_base.stall_watch import COMPARED_TIME, StallWatch
from push_model.signals import STOP, Twist
import pytest

PERIOD = 0.02
COMMAND = Twist(0.03, 0.04, 0.1)


def times_of_stall(measured, seconds=3.0, command=COMMAND):
    """
    List when a base seems to stall [s].

    :param measured: function of the time [s] that gives the ``Twist`` of odometry.
    """
    watch, times = StallWatch(), []
    for k in range(round(seconds / PERIOD)):
        watch.add(PERIOD * k, command, measured(PERIOD * k))
        if watch.is_stalled:
            times.append(PERIOD * k)
    return times


def scaled(ratio):
    """Return the velocity of a base that does a part of what it is told."""
    return Twist(*(ratio * value for value in COMMAND))


@pytest.mark.parametrize('measured', [
    STOP, Twist(0.08, -0.06, 0.0), Twist(0.0, 0.0, 1.0), scaled(-1.0)])
def test_a_base_that_does_not_go_where_it_is_told_stalls(measured):
    """At rest, to the side, turning, or back: as soon as there is enough to compare."""
    times = times_of_stall(lambda _: measured)
    assert times[0] == pytest.approx(COMPARED_TIME, abs=PERIOD)
    assert times[-1] == pytest.approx(3.0, abs=1.5 * PERIOD)


@pytest.mark.parametrize('measured', [
    lambda _: scaled(1.0), lambda _: scaled(0.2),
    # In pulses, and after a dead time.
    lambda time: scaled(2.5 if time % 0.4 < 0.15 else 0.0),
    lambda time: scaled(1.0 if time > 0.5 else 0.0)])
def test_a_base_that_moves_on_does_not_stall(measured):
    """However little of its command it does, and however late."""
    assert times_of_stall(measured) == []


def test_a_base_that_is_to_stand_does_not_stall():
    """Nor does one that moves all the same."""
    assert times_of_stall(lambda _: STOP, command=STOP) == []
    assert times_of_stall(lambda _: COMMAND, command=STOP) == []


def test_a_base_that_is_stopped_stalls_from_then_on():
    """After the time that is compared, but for the tenth that is tolerated."""
    times = times_of_stall(lambda time: scaled(1.0 if time < 1.0 else 0.0))
    assert 1.0 + 0.9 * COMPARED_TIME - PERIOD < times[0] < 1.0 + COMPARED_TIME + PERIOD
