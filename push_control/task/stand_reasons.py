"""Why a robot has to stand in a task that is under way."""

import enum
import math
from typing import NamedTuple

from push_control.goal import TaskFailure
from push_control.perception.measurement_watch import MeasurementWatch
from push_model.events import AnyReport, EventReport, Report
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReport


class StandCause(enum.Enum):
    """Cause for which a robot stands; the first one of those that hold counts."""

    # The base was stopped, or something was in its way: somebody has to let it go on.
    AWAITS_RESUME = 'awaits resume'
    SAFETY_STOP = 'safety stop'
    # Something that is required is missing, as the map, or a scan shows something in the way.
    HOLD = 'hold'
    # Measurements do not come, or cannot be used.
    MEASUREMENTS = 'measurements'


# Time for which a cause may last until the task is given up [s], and the failure that it then is.
# Chosen: a base that restarts is back by the first, and for measurements a user needs longer.
STOP_TIME_LIMIT = 10.0
MEASUREMENT_TIME_LIMIT = 60.0
LIMITS = {
    StandCause.SAFETY_STOP: (STOP_TIME_LIMIT, TaskFailure.ROBOT_STOPPED),
    StandCause.MEASUREMENTS: (MEASUREMENT_TIME_LIMIT, TaskFailure.NO_MEASUREMENTS)}


class StandReason(NamedTuple):
    """
    A reason to stand.

    :param cause: its ``StandCause``.
    :param report: ``Report`` of it.
    :param duration: for which it holds [s]; 0 where no limit applies.
    """

    cause: StandCause
    report: AnyReport
    duration: float = 0.0

    @property
    def failure(self) -> TaskFailure | None:
        """``TaskFailure`` that it has become by lasting too long, or None."""
        limit, failure = LIMITS.get(self.cause, (math.inf, None))
        return failure if self.duration > limit else None


class StandReasons:
    """Collects the reasons to stand, in the order in which they count."""

    def __init__(self) -> None:
        """Start without any."""
        self._stop: SafetyReport | None = None
        self._stopped_since = 0.0
        self._hold_report: AnyReport | None = None
        self._protection: Report[ProtectiveCause] | None = None
        # What was in the way, until somebody lets the robot go on.
        self._obstruction: Report[ProtectiveCause] | None = None
        self._watch = MeasurementWatch()
        self._fault: EventReport | None = None

    def on_stop(self, stop: SafetyReport | None, time: float) -> bool:
        """
        Take note of whether the safety layer stops the robot.

        :param stop: why, or None where the robot may move.
        :param time: now [s].
        :return: whether it was not stopped before.
        """
        is_new = stop is not None and self._stop is None
        if is_new:
            self._stopped_since = time
        self._stop = stop
        return is_new

    @property
    def is_stopped(self) -> bool:
        """Tell whether the safety layer stops the robot."""
        return self._stop is not None

    def resume(self) -> None:
        """Forget what somebody was awaited for: here they are."""
        self._obstruction = None
        if self._stop is not None and self._stop.code.awaits_resume:
            self._stop = None

    def hold(self, report: AnyReport | None) -> None:
        """
        Stand for as long as something is missing.

        :param report: ``Report`` of what; None where nothing is.
        """
        self._hold_report = report

    def protect(self, report: Report[ProtectiveCause] | None) -> None:
        """
        Stand for what a scan shows, or until ``resume`` where a person has to say that it is gone.

        :param report: ``Report`` of it; None where the way is clear.
        """
        self._protection = report
        if report is not None and report.code.awaits_resume:
            self._obstruction = report

    def on_measurements(self, fault: EventReport | None, time: float) -> None:
        """
        Take note of whether the newest measurements can be used.

        :param fault: why not, or None where they can.
        :param time: now [s].
        """
        if self._stop is not None or self.holds:
            self.forget_measurements()
        else:
            self._fault = self._watch.update(fault, time)

    def forget_measurements(self) -> None:
        """Forget faults of measurements: nothing depends on them now."""
        self._watch = MeasurementWatch()
        self._fault = None

    @property
    def holds(self) -> tuple[StandReason, ...]:
        """Reasons that no behaviour handles by itself, the one that counts first."""
        reasons: list[StandReason] = []
        if self._obstruction is not None:
            reasons.append(StandReason(StandCause.AWAITS_RESUME, self._obstruction))
        if self._hold_report is not None:
            reasons.append(StandReason(StandCause.HOLD, self._hold_report))
        if self._protection is not None and not self._protection.code.awaits_resume:
            reasons.append(StandReason(StandCause.HOLD, self._protection))
        return tuple(reasons)

    def all(self, time: float) -> tuple[StandReason, ...]:
        """
        List all reasons, the one that counts first.

        :param time: now [s].
        """
        reasons: list[StandReason] = []
        if self._stop is not None and self._stop.code.awaits_resume:
            reasons.append(StandReason(StandCause.AWAITS_RESUME, self._stop))
        elif self._stop is not None:
            duration = time - self._stopped_since
            reasons.append(StandReason(StandCause.SAFETY_STOP, self._stop, duration))
        reasons += self.holds
        if self._fault is not None:
            duration = self._watch.waited(time)
            reasons.append(StandReason(StandCause.MEASUREMENTS, self._fault, duration))
        order = list(StandCause)
        return tuple(sorted(reasons, key=lambda reason: order.index(reason.cause)))

    def first(self, time: float) -> StandReason | None:
        """
        Return the reason that counts, or None where the robot may move.

        :param time: now [s].
        """
        return next(iter(self.all(time)), None)
