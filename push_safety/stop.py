"""
The stop: why the robot is stopped, and when it may go on.

A stopped robot gets zeros until it has been at rest for a while and nothing is wrong. Zeros are
what every base follows, also one that an emergency stop holds: whether it would follow anything
else shows only in the next attempt to move. So a standstill starts with the fault for which the
robot was stopped, and is over when it has moved as commanded for a while; in between nobody knows.
After a standstill that is too long the robot waits until somebody lets it go on.
"""

import math

from push_model.signals import Odometry, Twist
from push_safety.status import SafetyReason, SafetyReport
from push_safety.tolerances import (
    FOLLOWING_TIME, LAST_ATTEMPT_RATIO, RELAPSE_REST_TIME, RELAPSE_TIME, REST_SPEED, REST_TIME,
    REST_YAW_RATE)


def is_at_rest(twist: Twist) -> bool:
    """
    Tell whether a robot counts as being at rest.

    :param twist: ``Twist`` as measured.
    """
    return math.hypot(twist.v_x, twist.v_y) < REST_SPEED and abs(twist.omega) < REST_YAW_RATE


class SafetyStop:
    """
    Holds the reason to stop until the robot may go on.

    ``report``: why the robot is stopped, None while all is well.
    ``max_standstill``: time for which the base may be at rest although it is commanded, or
    odometry may be missing, until the robot waits for ``resume`` [s]; infinite for never.
    """

    def __init__(self, max_standstill: float = math.inf) -> None:
        """Start with a robot that may move."""
        self.max_standstill = max_standstill
        self._standstill = _Standstill()
        self.reset()

    def reset(self) -> None:
        """Forget everything measured, as where time went back."""
        self._at_rest_since: float | None = None
        # When the robot last went on after a stop [s].
        self._released_at = -math.inf
        self.release()

    def release(self) -> None:
        """Note that the robot is not commanded."""
        self._standstill.reset()
        self.report: SafetyReport | None = None

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stays stopped until ``resume``."""
        return self.report is not None and self.report.code.awaits_resume

    def resume(self) -> None:
        """Let a robot go on that waits for it; another stop soon after is no relapse."""
        self.report = None
        self._standstill.reset()
        self._released_at = -math.inf

    def excuse(self, duration: float) -> None:
        """
        Note that clocks were set ahead: nobody has stood for that time.

        :param duration: by how much [s].
        """
        if self._at_rest_since is not None:
            self._at_rest_since += duration
        self._released_at += duration
        self._standstill.excuse(duration)

    def explain(self) -> None:
        """Note that it is known by now how the base moves: another stop is no relapse."""
        self._released_at = -math.inf

    def stop(self, report: SafetyReport) -> None:
        """Stop the robot, unless it is stopped already."""
        self.report = self.report or report
        self._at_rest_since = None

    def may_go_on(self, odometry: Odometry, is_faulty: bool) -> bool:
        """
        Release a stopped robot that has been at rest for a while.

        :param is_faulty: whether anything is wrong with this odometry.
        :return: whether the robot goes on.
        """
        time, since = odometry.time, self._at_rest_since
        if is_faulty or not is_at_rest(odometry.twist):
            self._at_rest_since = None
        elif since is None:
            self._at_rest_since = time
        elif self.report and not self.awaits_resume and self._has_rested(since, time):
            self.go_on(time)
            return True
        return False

    def go_on(self, time: float) -> None:
        """
        Let a stopped robot go on; another stop soon after is a relapse.

        :param time: now [s].
        """
        self.report = None
        self._released_at = time

    def _has_rested(self, since: float, time: float) -> bool:
        """Tell whether a robot that was stopped has been at rest for long enough."""
        if time - since <= REST_TIME:
            return False
        has_relapsed = since - self._released_at < RELAPSE_TIME
        return (not has_relapsed or time - since > RELAPSE_REST_TIME
                or time > self._standstill.last_attempt_time(self.max_standstill))

    def observe(self, odometry: Odometry, fault: SafetyReport | None, gap: float) -> None:
        """
        Stop the robot for a fault, or for good where its base was stopped.

        :param fault: what is wrong with this odometry, or None.
        :param gap: time for which odometry was expected, and missing [s].
        """
        time, standstill, limit = odometry.time, self._standstill, self.max_standstill
        at_rest = is_at_rest(odometry.twist)
        if fault is not None and self.report is None and not fault.code.is_of_odometry:
            standstill.on_stop(fault, time, is_at_rest=at_rest)
        standstill.observe(time, is_at_rest=at_rest,
                           is_stopped=fault is not None or self.report is not None)
        if not self.awaits_resume:
            if gap > limit:
                self.report = SafetyReason.ODOMETRY_WAS_MISSING.report(duration=gap)
            elif standstill.is_too_long(limit, time, is_faulty=fault is not None):
                self.report = SafetyReason.BASE_STOOD.report(duration=standstill.duration(time))
        if fault is not None and self._is_news(fault):
            self.report = fault

    def _is_news(self, fault: SafetyReport) -> bool:
        """Tell whether a fault is the first, or says more of a base that does not follow."""
        says_more = fault.code.is_of_odometry or fault.code is SafetyReason.FOLLOWS_LATE
        return self.report is None or self.report.code.is_of_motion and says_more


class _Standstill:
    """Time for which the base has not been seen to follow."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Restart with a base that follows."""
        # Since when the robot is at rest although it was commanded [s], or None.
        self._since: float | None = None
        # Since when it moves as commanded after that [s], or None.
        self._moving_since: float | None = None

    def excuse(self, duration: float) -> None:
        """Leave out a time that has not passed [s]."""
        if self._since is not None:
            self._since += duration
        if self._moving_since is not None:
            self._moving_since += duration

    def on_stop(self, fault: SafetyReport, time: float, *, is_at_rest: bool) -> None:
        """Note that the robot is stopped, as it does not follow."""
        if self._since is None and (is_at_rest or fault.code is SafetyReason.NOT_MOVING):
            self._since = time
        elif not is_at_rest:
            # The last attempt has moved it, but otherwise than commanded: nobody has stopped it.
            self.reset()

    def observe(self, time: float, *, is_at_rest: bool, is_stopped: bool) -> None:
        """Take in whether the robot is at rest, and whether it has to be."""
        if self._since is None:
            return
        if is_at_rest or is_stopped:
            self._moving_since = None
        elif self._moving_since is None:
            self._moving_since = time
        if not is_at_rest:
            self._since = time
        if self._moving_since is not None and time - self._moving_since > FOLLOWING_TIME:
            self.reset()

    def duration(self, time: float) -> float:
        """Tell for how long the robot has been at rest although commanded [s], 0 for not."""
        return 0.0 if self._since is None else time - self._since

    def last_attempt_time(self, limit: float) -> float:
        """Tell when to try for the last time whether the base follows [s]; infinite for never."""
        return math.inf if self._since is None else self._since + LAST_ATTEMPT_RATIO * limit

    def is_too_long(self, limit: float, time: float, *, is_faulty: bool) -> bool:
        """Tell whether it is beyond its limit, or the last attempt within it has failed."""
        return (self.duration(time) > limit
                or is_faulty and time >= self.last_attempt_time(limit))
