"""Reasons to stand: the order in which they count, and how long each may last."""

import itertools

from push_control.events import TaskEvent
from push_control.goal import TaskFailure
from push_control.task.stand_reasons import (
    LIMITS, MEASUREMENT_TIME_LIMIT, StandCause, StandReasons, STOP_TIME_LIMIT)
from push_model.events import PushEvent
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReason
import pytest

STOOD = SafetyReason.BASE_STOOD.report(duration=2.0)
LATE = SafetyReason.FOLLOWS_LATE.report(delay=0.5)
STALE = PushEvent.OBJECT_POSE_STALE.report(age=1.0, limit=0.5)
NO_MAP = TaskEvent.NO_USABLE_MAP.report(map_fault='no map')
PASSED = ProtectiveCause.OBSTRUCTED_UNTIL_RESUME.report()
IN_THE_WAY = ProtectiveCause.OBSTRUCTED.report(restart_time=2.0)
NO_POSE = PushEvent.NO_OBJECT_POSE.report()


def causes(reasons, time=0.0):
    """List the causes, the one that counts first."""
    return [reason.cause for reason in reasons.all(time)]


def raise_all(order, stop):
    """Raise every reason, in some order."""
    reasons = StandReasons()
    raised = {'stop': lambda: reasons.on_stop(stop, 0.0), 'hold': lambda: reasons.hold(NO_MAP),
              'measurements': lambda: reasons.on_measurements(STALE, 0.0)}
    for name in order:
        raised[name]()
    return reasons


@pytest.mark.parametrize('order', list(
    itertools.permutations(['stop', 'hold', 'measurements'])))
@pytest.mark.parametrize('stop, cause', [
    (LATE, StandCause.SAFETY_STOP), (STOOD, StandCause.AWAITS_RESUME)])
def test_the_order_of_reasons_is_not_that_in_which_they_come(order, stop, cause):
    """A stop of the base comes before what is missing, that before bad measurements."""
    reasons = raise_all(order, stop)
    found = causes(reasons)
    assert found == [cause, StandCause.HOLD, StandCause.MEASUREMENTS][:len(found)]
    assert found[:2] == [cause, StandCause.HOLD]
    assert reasons.first(0.0).report is stop
    reasons.on_stop(None, 1.0)
    assert reasons.first(1.0).report is NO_MAP


def test_causes_are_declared_in_the_order_in_which_they_count():
    """Of several that hold, the first one of the enumeration is the first of the list."""
    reasons = raise_all(['measurements', 'hold', 'stop'], LATE)
    order = list(StandCause)
    found = [order.index(cause) for cause in causes(reasons)]
    assert len(found) == 3 and found == sorted(found)


def test_without_a_reason_the_robot_may_move():
    """A new list is empty, and so is one whose reasons have ended."""
    reasons = raise_all(['hold'], None)
    reasons.hold(None)
    reasons.on_measurements(None, 0.0)
    for each in (StandReasons(), reasons):
        assert each.all(0.0) == () and each.first(0.0) is None and not each.is_stopped


@pytest.mark.parametrize('duration, failure', [
    (STOP_TIME_LIMIT - 0.1, None), (STOP_TIME_LIMIT + 0.1, TaskFailure.ROBOT_STOPPED)])
def test_a_stop_that_lasts_becomes_a_failure(duration, failure):
    """From when the robot was stopped, however often that is reported, and for what reason."""
    reasons = StandReasons()
    assert reasons.on_stop(LATE, 3.0)
    assert not reasons.on_stop(SafetyReason.CLOCK_FELL_BACK.report(shift=1.0), 4.0)
    assert reasons.first(3.0 + duration).failure is failure
    reasons.on_stop(None, 5.0)
    assert reasons.on_stop(LATE, 6.0)
    assert reasons.first(3.0 + duration).failure is None


def test_somebody_who_is_awaited_may_take_their_time():
    """Once they are there, only that reason ends."""
    reasons = StandReasons()
    reasons.on_stop(STOOD, 0.0)
    assert reasons.first(1e6).failure is None
    reasons.resume()
    assert reasons.first(0.0) is None
    reasons.on_stop(LATE, 0.0)
    reasons.resume()
    assert causes(reasons) == [StandCause.SAFETY_STOP]


def test_what_was_in_the_way_awaits_a_person_and_a_restart_by_itself_does_not() -> None:
    """Also once it is gone; a word that comes too early does not count."""
    reasons = StandReasons()
    reasons.protect(PASSED)
    reasons.protect(None)
    assert causes(reasons) == [StandCause.AWAITS_RESUME]
    assert reasons.first(1e6).failure is None and reasons.first(1e6).report is PASSED
    reasons.protect(PASSED)
    reasons.resume()
    # It is seen again by the next scan.
    reasons.protect(PASSED)
    assert causes(reasons) == [StandCause.AWAITS_RESUME]
    reasons.protect(None)
    reasons.resume()
    assert reasons.first(0.0) is None
    reasons.protect(IN_THE_WAY)
    assert causes(reasons) == [StandCause.HOLD]
    reasons.protect(None)
    assert reasons.first(0.0) is None


def test_what_is_missing_may_take_its_time():
    """A map may come after hours."""
    reasons = StandReasons()
    reasons.hold(NO_MAP)
    assert reasons.first(1e6).failure is None
    assert StandCause.HOLD not in LIMITS and StandCause.AWAITS_RESUME not in LIMITS


@pytest.mark.parametrize('fault, failure', [
    (STALE, TaskFailure.NO_MEASUREMENTS), (NO_POSE, None)])
def test_measurements_that_stop_coming_become_a_failure(fault, failure):
    """Those that have never come may still."""
    reasons = StandReasons()
    for time in (0.0, 0.5 * MEASUREMENT_TIME_LIMIT, MEASUREMENT_TIME_LIMIT):
        reasons.on_measurements(fault, time)
        assert reasons.first(time).cause is StandCause.MEASUREMENTS
        assert reasons.first(time).failure is None
    reasons.on_measurements(fault, MEASUREMENT_TIME_LIMIT + 0.1)
    assert reasons.first(MEASUREMENT_TIME_LIMIT + 0.1).failure is failure


def test_faults_of_measurements_start_over_after_another_reason():
    """Nobody has waited for measurements while the base was stopped."""
    reasons = StandReasons()
    reasons.on_measurements(STALE, 0.0)
    reasons.on_stop(LATE, 1.0)
    reasons.on_measurements(STALE, 1.0)
    assert causes(reasons, 1.0) == [StandCause.SAFETY_STOP]
    reasons.on_stop(None, 50.0)
    reasons.on_measurements(STALE, 50.0)
    assert reasons.first(50.0).duration == 0.0
    reasons.forget_measurements()
    assert reasons.first(50.0) is None
