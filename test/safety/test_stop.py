"""The stop itself: how long a robot has to have rested until it goes on."""

from push_model.geometry import Pose
from push_model.signals import Odometry, STOP, Twist
from push_safety.status import SafetyReason
from push_safety.stop import SafetyStop
from push_safety.tolerances import RELAPSE_REST_TIME, RELAPSE_TIME, REST_SPEED, REST_TIME
import pytest

PERIOD = 0.02
REASON = SafetyReason.FOLLOWS_LATE.report(delay=0.5)
ROLLING = Twist(1.5 * REST_SPEED, 0.0, 0.0)


def released_after(stop: SafetyStop, start: float, *, twist: Twist = STOP,
                   is_faulty: bool = False) -> float | None:
    """Stop a robot, and tell how long that lasts; None for more than twice the longest rest."""
    stop.stop(REASON)
    for i in range(round(2.0 * RELAPSE_REST_TIME / PERIOD)):
        measured = Odometry(start + i * PERIOD, Pose(0.0, 0.0, 0.0), twist)
        if stop.may_go_on(measured, is_faulty):
            assert stop.report is None
            return i * PERIOD
    return None


def test_a_robot_rests_before_it_goes_on_and_longer_where_it_is_stopped_again_soon() -> None:
    """Later than that, another stop is as the first one."""
    stop = SafetyStop()
    time = 0.0
    for pause, rest in ((0.0, REST_TIME), (0.5 * RELAPSE_TIME, RELAPSE_REST_TIME),
                        (1.5 * RELAPSE_TIME, REST_TIME)):
        time += pause
        duration = released_after(stop, time)
        assert duration is not None and rest < duration < rest + 2.0 * PERIOD
        time += duration


@pytest.mark.parametrize('twist, is_faulty', [(ROLLING, False), (STOP, True)])
def test_a_robot_that_rolls_or_errs_does_not_go_on(twist: Twist, is_faulty: bool) -> None:
    """However long it takes; after that it rests as always."""
    stop = SafetyStop()
    assert released_after(stop, 0.0, twist=twist, is_faulty=is_faulty) is None
    assert released_after(stop, 100.0) == pytest.approx(REST_TIME, abs=2.0 * PERIOD)
