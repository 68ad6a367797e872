"""
Waiting for measurements: where they fail again and again, they must be good for a while.

Measurements that are late by turns would let the robot start and stop many times in a second. The
reason stays the same while it waits, but for its values, which are renewed now and then.
"""

import math

from push_model.events import EventReport, PushEvent

# Times for which measurements must be good again before the robot goes on: at first, where they
# have failed again soon after it had gone on, and where they do so once more [s]; and what counts
# as soon [s]. Chosen: a single message that is lost or broken costs nothing, and nobody drives
# with gaps in every second.
RECOVERY_TIMES = 0.0, 0.5, 1.0
RELAPSE_TIME = 2.0
# Period at which the values of a reason are renewed [s]; chosen: to be read.
RENEWAL_PERIOD = 2.0
# Age of object poses over the limit up to which they do come, but too late; chosen: a camera of
# 5 Hz with a latency of 0.2 s that loses a picture is below with the default limit, and a tracker
# that is gone is above soon.
LATE_RATIO = 3.0
# Events that describe the start, and not what has stopped.
START_EVENTS = (PushEvent.NO_OBJECT_POSE,)


class MeasurementWatch:
    """
    Tells whether measurements can be used, and for how long they could not.

    ``fault``: ``EventReport`` of why the robot waits, or None.
    """

    def __init__(self) -> None:
        """Start with measurements that can be used."""
        self.fault: EventReport | None = None
        self._code: PushEvent | None = None
        self._reported_at = -math.inf
        self._since = math.inf
        self._bad_at = -math.inf
        self._recovered_at = -math.inf
        self._relapses = 0
        # Greatest age of object poses since the values of the reason were renewed [s].
        self._max_age = 0.0

    def update(self, fault: EventReport | None, time: float) -> EventReport | None:
        """
        Take note of whether the newest measurements can be used.

        :param fault: ``EventReport`` of why not, or None.
        :param time: now [s].
        :return: why the robot has to wait, or None where it may move.
        """
        if fault is None or fault.code in START_EVENTS:
            if self.fault is None or fault is not None:
                return fault
            recovery = RECOVERY_TIMES[min(self._relapses, len(RECOVERY_TIMES) - 1)]
            if time - self._bad_at >= recovery:
                self.fault, self._recovered_at = None, time
            return self.fault
        if self.fault is None:
            self._since, self._max_age = time, 0.0
            has_relapsed = time - self._recovered_at < RELAPSE_TIME
            self._relapses = self._relapses + 1 if has_relapsed else 0
        self._max_age = max(self._max_age, fault.values.get('age', 0.0))
        is_known = self.fault is not None and self._code is fault.code
        is_renewed = time - self._reported_at >= RENEWAL_PERIOD
        if not is_known or is_renewed:
            self.fault, self._reported_at = self._named(fault, time), time
        if is_renewed:
            self._max_age = 0.0
        self._bad_at = time
        return self.fault

    def _named(self, fault: EventReport, time: float) -> EventReport:
        """Name poses that are too old by a little, for long: waiting changes nothing."""
        self._code = fault.code
        is_late = (fault.code is PushEvent.OBJECT_POSE_STALE
                   and self.waited(time) >= RENEWAL_PERIOD
                   and self._max_age <= LATE_RATIO * fault.values['limit'])
        if not is_late:
            return fault
        return PushEvent.OBJECT_POSES_LATE.report(age=self._max_age, limit=fault.values['limit'])

    def waited(self, time: float) -> float:
        """
        Tell for how long the robot has waited.

        :param time: now [s].
        :return: [s], 0 where it does not wait.
        """
        return 0.0 if self.fault is None else time - self._since
