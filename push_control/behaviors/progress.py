"""Progress of a task: attempts since the object last came nearer to its goal."""

import enum
import math
from typing import NamedTuple

from push_control.behaviors.failures import FailureReport, held_up
from push_control.events import no_plan, TaskEvent
from push_control.goal import TaskFailure
from push_control.perception.object_at_rest import has_moved, ObjectAtRest
from push_control.supervision_settings import (
    BIASED_SIGMAS, LIKELY_SIGMAS, MIN_AIM, SupervisionSettings)
from push_model.events import AnyReport, Report
from push_model.geometry import distance, Pose, wrap_angle
from push_model.plan_request import GoalTolerances, PlanFailure, PlanRequest
from push_model.trajectory import PushStyle, PushTrajectory

# Every other attempt without progress reduces the fraction of the friction cone that a plan may
# use by this factor, down to the minimum; chosen: 0.64 after four attempts, 0.4 after ten.
CAUTION_FACTOR = 0.8
MIN_CONE_FRACTION = 0.4
ATTEMPTS_PER_REDUCTION = 2
# Looks from other sides at an object that may be at its goal; chosen: all round it.
MAX_INSPECTIONS = 3
# Stops by the safety layer since the object last came nearer to its goal; chosen: one may be a
# person, and one the next time.
MAX_SAFETY_STOPS = 3
# Pushes at which the wheels spun since then; chosen: the second one confirms the first.
MAX_SPINS = 2
# Pushes at which the object was held up since then; chosen: another plan may lead round what holds
# it, a third push onto it does not.
MAX_HOLD_UPS = 3
# Displacement by one push from which on an object is not too heavy [m]; chosen: some give way by
# centimetres before the wheels spin.
LIGHT_DISTANCE = 0.1
# Pushes in a row that may leave the object pose as it was, to the last digit; chosen: the robot
# may have missed the object once or twice, and a tracker that is frozen from the start shows no
# more.
MAX_UNSEEN_PUSHES = 3
# The same once the poses have jumped; chosen: one push may have missed an object that somebody has
# put elsewhere.
MAX_UNSEEN_AFTER_JUMP = 2
# Failures that another map may end, and the time for which one is waited for [s]; chosen: somebody
# steps aside, or takes away what stands at the goal.
MAP_FAILURES = (PlanFailure.NOT_FREE, PlanFailure.BLOCKED, PlanFailure.UNCERTAIN_POSITION,
                PlanFailure.NO_FACE, PlanFailure.SEARCH_LIMIT)
MAP_TIME_LIMIT = 20.0
# Pushes to waypoints as planned that may bring the object no nearer to its goal, over the attempts
# that may; chosen: a detour through three rooms takes some thirty pushes.
WAYPOINTS_PER_ATTEMPT = 4
# Distance and rotation from the planned end of a push to a waypoint within which it has gone as
# planned [m, rad]; chosen: a standard deviation of long pushes.
WAYPOINT_DISTANCE, WAYPOINT_ANGLE = 0.12, 0.3
# Time from where there is no plan, or no path to where it starts, until another plan is requested
# [s]; chosen: attempts outlast a map that is wrong for some seconds.
RETRY_TIME = 1.0
# Time after which the robot reports that the object does not come to rest, and after which it
# gives up [s]; chosen: longer than poses are averaged, and than somebody carries the object about.
REST_REPORT_TIME = 3.0
# Part of the tolerances within which an object counts as at its goal where its place in the map is
# uncertain for as long as it is averaged; chosen: the rest is for that.
MAP_AIM = 0.8
REST_TIME_LIMIT = 60.0
# Factor on its tolerances up to which a task that fails names those that would do; chosen: beyond,
# the object has not come near its goal.
MAX_EXCESS = 3.0


class GoalCheck(enum.Enum):
    """Tell whether an object at rest is at its goal."""

    REACHED = 'reached'
    MISSED = 'missed'
    # More measurements may tell.
    UNCERTAIN = 'uncertain'
    # Only poses from another side may.
    UNSEEN = 'unseen'


class _FailedRequest(NamedTuple):
    """A request without a plan, the ``PlanFailure``, and whether it was one before."""

    request: PlanRequest
    code: PlanFailure
    is_repeated: bool


class RestClock:
    """Measures for how long the robot has waited for the object to rest, since the last push."""

    def __init__(self) -> None:
        """Start with an object that rests."""
        self._moving_since: float | None = None
        self._present_wait = 0.0
        # Long waits that have ended, in all [s].
        self._earlier_waits = 0.0

    @property
    def is_long(self) -> bool:
        """Tell whether the present wait is long enough to be reported."""
        return self._present_wait > REST_REPORT_TIME

    @property
    def is_too_long(self) -> bool:
        """Tell whether all long waits together are a reason to give up."""
        return self.is_long and self._earlier_waits + self._present_wait > REST_TIME_LIMIT

    def wait(self, time: float) -> None:
        """
        Wait on.

        :param time: now [s].
        """
        if self._moving_since is None:
            self._moving_since = time
        self._present_wait = time - self._moving_since

    def end_wait(self) -> None:
        """End the present wait; the total keeps it if it was long, as rest may have seemed so."""
        if self.is_long:
            self._earlier_waits += self._present_wait
        self._moving_since, self._present_wait = None, 0.0


class ProgressMonitor:
    """
    Counts pushes and recoveries since the object last came nearer to its goal.

    ``settings``: the ``SupervisionSettings``, and ``aim``: the tolerances that pushes aim at, both
    of which may be replaced. ``rest_clock``: the ``RestClock``.
    """

    def __init__(self, settings: SupervisionSettings, aim: tuple[float, float]) -> None:
        """
        Start without attempts.

        :param aim: tolerances of position [m] and heading [rad] that pushes aim at.
        """
        self.settings = settings
        self.aim = aim
        self.rest_clock = RestClock()
        # Before that no other plan is requested [s].
        self._retry_time = -math.inf
        self._inspections = 0
        self._safety_stops = 0
        self._spins = 0
        self._last_spin: FailureReport | None = None
        self._hold_ups = 0
        self._last_hold_up: FailureReport | None = None
        # Whether a push has moved the object farther than what is too heavy moves.
        self._is_light = False
        # Whether the wheels have spun, or the object was held up, at the last push.
        self._has_just_stalled = False
        self._unseen_pushes = 0
        self._max_unseen_pushes = MAX_UNSEEN_PUSHES
        self._least_error = math.inf
        self._least_tolerances: GoalTolerances | None = None
        self._least_time = math.inf
        self._attempts = 0
        self._waypoints = 0
        self._last_failure: AnyReport | None = None
        self._failed_request: _FailedRequest | None = None
        self._planning_failure: AnyReport | None = None
        # Since when there is no plan for what the map shows [s], or None.
        self._blocked_since: float | None = None
        self._uncertainty: AnyReport | None = None

    def count_attempt(self, failure: AnyReport | None = None) -> None:
        """
        Count a push or a recovery.

        :param failure: ``Report`` of what went wrong, or None.
        """
        self._attempts += 1
        self._inspections = 0
        self._last_failure = failure or self._last_failure

    def count_finished_push(self, plan: PushTrajectory, object_pose: Pose,
                            goal: Pose | None = None) -> None:
        """
        Count a push that has ended well.

        One that has brought the object nearer to its goal is progress, before the object is
        averaged: a stop on the way from there is the first one.

        :param plan: its ``PushTrajectory``.
        :param object_pose: ``Pose`` of the object after it.
        :param goal: goal ``Pose``; None where it was given up meanwhile.
        """
        self._has_just_stalled = False
        start = Pose(*plan.object_poses[0].tolist())
        self._is_light |= distance(start, object_pose) > LIGHT_DISTANCE
        if goal is not None and self._relative_error(object_pose, goal) < (
                self.settings.improvement_ratio * self._least_error):
            self._safety_stops = 0
        if plan.style is PushStyle.WAYPOINT and _is_at_end(plan, object_pose):
            self.count_waypoint()
        else:
            self.count_attempt()

    def count_waypoint(self) -> None:
        """Count a push that has brought the object where the plan has it on its way."""
        self._inspections = 0
        self._waypoints += 1
        if self._waypoints % WAYPOINTS_PER_ATTEMPT == 0:
            self._attempts += 1

    def count_safety_stop(self) -> bool:
        """Count a stop by the safety layer; return whether it is one too many."""
        self._safety_stops += 1
        return self._safety_stops >= MAX_SAFETY_STOPS

    def count_spin(self, failure: FailureReport) -> bool:
        """
        Count a push at which the wheels spun; return whether it is one too many.

        :param failure: how that has shown.
        """
        self._spins += 1
        self._last_spin = failure
        self._has_just_stalled = True
        return self._spins >= MAX_SPINS

    def count_hold_up(self, failure: FailureReport) -> None:
        """
        Count a push at which something held the object up.

        :param failure: what did.
        """
        self._hold_ups += 1
        self._has_just_stalled = True
        self._last_hold_up = failure

    @property
    def hold_up(self) -> FailureReport | None:
        """What holds up an object at which the base stalls; None where it may be too heavy."""
        if self._hold_ups > 0:
            return self._last_hold_up
        return held_up(is_in_map=False) if self._is_light else None

    @property
    def last_spin(self) -> FailureReport | None:
        """How that has shown at the last such push; None where the object has come nearer."""
        return self._last_spin if self.has_spun else None

    @property
    def has_spun(self) -> bool:
        """Tell whether the wheels have spun at a push since the object last came nearer."""
        return self._spins > 0

    @property
    def is_light(self) -> bool:
        """Tell whether a push has moved the object farther than what is too heavy moves."""
        return self._is_light

    def forget_safety_stops(self) -> None:
        """Count stops from zero again: somebody has looked after the robot."""
        self._safety_stops = 0

    def count_push(self, repeats_pose: bool, *, have_poses_jumped: bool = False) -> None:
        """
        Count a push that has ended.

        :param repeats_pose: whether the object pose is what it was before, to the last digit.
        :param have_poses_jumped: whether object poses have jumped in this task.
        """
        self._max_unseen_pushes = (
            MAX_UNSEEN_AFTER_JUMP if have_poses_jumped else MAX_UNSEEN_PUSHES)
        self._unseen_pushes = self._unseen_pushes + 1 if repeats_pose else 0
        self.rest_clock = RestClock()

    def delay_request(self, time: float) -> None:
        """
        Wait for a moment before another plan is requested.

        :param time: now [s].
        """
        self._retry_time = time + RETRY_TIME

    def allow_request(self) -> None:
        """Let another plan be requested at once."""
        self._retry_time = -math.inf

    def may_request(self, time: float) -> bool:
        """
        Return whether another plan may be requested.

        :param time: now [s].
        """
        return time >= self._retry_time

    def count_inspection(self, object_at_rest: ObjectAtRest) -> None:
        """Count a look from another side at an object that may be at its goal."""
        self._inspections += 1
        if self._inspections > MAX_INSPECTIONS:
            self._uncertainty = TaskEvent.GOAL_UNCERTAIN.report(
                position=1e3 * object_at_rest.position_error,
                heading=math.degrees(object_at_rest.heading_error), **self._least_change())

    def on_planning_failed(self, request: PlanRequest, code: PlanFailure,
                           reason: str | AnyReport, time: float) -> None:
        """
        Note that there is no plan; twice for the same reason from the same poses is once too many.

        A plan that cannot be used tells nothing of these poses: it was spoilt or meant for others
        on its way, and the next one may be right. What a map blocks, another one may free: that is
        waited for, and counts as no attempt.

        :param reason: the same in one sentence, or a ``Report`` of it.
        :param time: now [s].
        """
        if code not in MAP_FAILURES:
            self.count_attempt(no_plan(code, reason))
            self._blocked_since = None
        elif self._blocked_since is None:
            self._blocked_since = time
        if code is PlanFailure.INVALID_PLAN:
            return
        last = self._failed_request
        is_repeated = (last is not None and last.code is code
                       and not self._have_moved(last.request, request))
        self._failed_request = _FailedRequest(request, code, is_repeated)
        if self._blocked_since is not None:
            if time - self._blocked_since >= MAP_TIME_LIMIT:
                self._planning_failure = TaskEvent.PLANNING_FAILED_FOR_LONG.report(
                    duration=MAP_TIME_LIMIT, failure=code, reason=reason)
        elif is_repeated:
            self._planning_failure = TaskEvent.PLANNING_FAILED_AGAIN.report(
                failure=code, reason=reason)

    def awaits_map(self, request: PlanRequest, time: float) -> bool:
        """
        Tell whether a plan would fail again, as no other map has come since it failed twice.

        :param time: now [s].
        """
        last = self._failed_request
        return (self._blocked_since is not None and time - self._blocked_since < MAP_TIME_LIMIT
                and last is not None and last.is_repeated
                and not self._have_moved(last.request, request))

    def on_plan(self) -> None:
        """Note that there is a plan."""
        self._blocked_since = None
        self.forget_planning_failures()

    def forget_planning_failures(self) -> None:
        """Forget requests without a plan, as there may be one now, but not since when."""
        self._failed_request = None
        if self._blocked_since is None:
            self._planning_failure = None

    def check_goal(self, object_at_rest: ObjectAtRest, goal: Pose,
                   remaining_time: float | None = None) -> GoalCheck:
        """
        Check whether an object is at its goal, and whether it has come nearer.

        :param goal: goal ``Pose``.
        :param remaining_time: that the task is expected to take still, where that shows progress
            although the error does not fall [s].
        """
        settings, pose = self.settings, object_at_rest.pose
        position_error = distance(pose, goal)
        heading_error = abs(wrap_angle(pose.theta - goal.theta))
        error = self._relative_error(pose, goal)
        sigmas = settings.required_sigmas
        if object_at_rest.is_biased:
            sigmas = min(BIASED_SIGMAS, sigmas)
        position_std, heading_std = _goal_errors(object_at_rest)
        position_margin, heading_margin = sigmas * position_std, sigmas * heading_std
        if (position_error <= settings.position_tolerance - position_margin
                and heading_error <= settings.heading_tolerance - heading_margin):
            return GoalCheck.REACHED
        self._note_tolerances(position_error + position_margin, heading_error + heading_margin)
        is_certain = (position_error > settings.position_tolerance + position_margin
                      or heading_error > settings.heading_tolerance + heading_margin)
        if not (is_certain or object_at_rest.is_biased or self._is_averaged(object_at_rest)):
            return GoalCheck.UNCERTAIN
        if self._is_likely_there(object_at_rest, position_error, heading_error):
            return GoalCheck.REACHED
        self._note_progress(error, remaining_time)
        if (object_at_rest.is_biased and position_error <= self.aim[0]
                and heading_error <= self.aim[1]):
            return GoalCheck.UNSEEN
        return GoalCheck.MISSED

    def _is_likely_there(self, object_at_rest: ObjectAtRest, position_error: float,
                         heading_error: float) -> bool:
        """Tell whether an object of which further poses tell no more counts as at its goal."""
        settings = self.settings
        if object_at_rest.is_in_map:
            return (position_error <= MAP_AIM * settings.position_tolerance
                    and heading_error <= MAP_AIM * settings.heading_tolerance)
        sigmas = min(LIKELY_SIGMAS, settings.required_sigmas)
        if object_at_rest.has_common_errors and not object_at_rest.is_biased:
            position_std, heading_std = _goal_errors(object_at_rest)
            return (position_error <= _reduced(settings.position_tolerance, sigmas * position_std)
                    and heading_error <= _reduced(settings.heading_tolerance,
                                                  sigmas * heading_std))
        return (settings.has_limited_view and not object_at_rest.is_biased
                and position_error
                <= settings.position_tolerance - sigmas * object_at_rest.position_error
                and heading_error
                <= settings.heading_tolerance - sigmas * object_at_rest.heading_error)

    def _relative_error(self, pose: Pose, goal: Pose) -> float:
        """Return the error of an object over its tolerance."""
        settings = self.settings
        return max(distance(pose, goal) / settings.position_tolerance,
                   abs(wrap_angle(pose.theta - goal.theta)) / settings.heading_tolerance)

    def _note_tolerances(self, position: float, heading: float) -> None:
        """Note tolerances [m, rad] with which the goal would be reached, if they are the least."""
        settings, least = self.settings, self._least_tolerances
        tolerances = GoalTolerances(max(settings.position_tolerance, position),
                                    max(settings.heading_tolerance, heading))
        if least is None or self._excess(tolerances) < self._excess(least):
            self._least_tolerances = tolerances

    def _excess(self, tolerances: GoalTolerances) -> float:
        """Return by which factor tolerances exceed those of the task."""
        return max(tolerances.position / self.settings.position_tolerance,
                   tolerances.heading / self.settings.heading_tolerance)

    def _least_change(self) -> dict[str, float]:
        """Return the least tolerances that would do, rounded up, in mm and degrees."""
        position, heading = self._least_tolerances or GoalTolerances(math.inf, math.inf)
        return {'position_tolerance': _rounded_up(1e3 * position),
                'heading_tolerance': _rounded_up(math.degrees(heading))}

    def averaging_report(self, object_at_rest: ObjectAtRest) -> Report[TaskEvent] | None:
        """Report what averaging waits for; None where it does not take long."""
        settings = self.settings
        if object_at_rest.duration < settings.max_averaging_time:
            return None
        position, heading = settings.precise_errors
        return TaskEvent.AVERAGING.report(
            position=1e3 * position, heading=math.degrees(heading),
            limit=settings.averaging_time_limit)

    def _is_averaged(self, object_at_rest: ObjectAtRest) -> bool:
        """Tell whether further poses are not worth their time."""
        settings, duration = self.settings, object_at_rest.duration
        if duration < settings.max_averaging_time:
            return False
        errors = object_at_rest.position_error, object_at_rest.heading_error
        return (object_at_rest.is_in_map or settings.is_precise(*errors)
                or duration >= settings.averaging_time_limit)

    def _note_progress(self, error: float, remaining_time: float | None) -> None:
        ratio, is_first = self.settings.improvement_ratio, math.isinf(self._least_error)
        is_nearer = error < ratio * self._least_error
        is_sooner = remaining_time is not None and remaining_time < ratio * self._least_time
        if is_nearer:
            self._least_error = error
        if is_sooner and remaining_time is not None:
            self._least_time = remaining_time
        if is_nearer or is_sooner:
            self._attempts = 0
            self._waypoints = 0
            self._safety_stops = self._safety_stops if is_first else 0
            # What the object went before it stopped tells nothing of the next push.
            if not (is_first or self._has_just_stalled):
                self._spins = self._hold_ups = 0
            self._last_failure = None

    @property
    def cone_fraction(self) -> float:
        """Fraction of the friction cone that the next plan may use."""
        reductions = self._attempts // ATTEMPTS_PER_REDUCTION
        return max(MIN_CONE_FRACTION, CAUTION_FACTOR ** reductions)

    @property
    def abort_cause(self) -> AnyReport | None:
        """``Report`` of why the task is to be aborted; None while it is not."""
        if self._unseen_pushes >= self._max_unseen_pushes:
            return TaskEvent.PUSHES_UNSEEN.report(count=self._unseen_pushes)
        if self._hold_ups >= MAX_HOLD_UPS and self._last_hold_up is not None:
            return TaskEvent.ABORTED.report(reason=self._last_hold_up)
        if self._attempts < self.settings.max_attempts:
            return self._uncertainty or self._planning_failure
        abort = TaskEvent.ATTEMPTS_USED_UP.report(count=self._attempts)
        if self._last_failure is not None:
            abort = TaskEvent.ATTEMPTS_FAILED.report(count=self._attempts,
                                                     failure=self._last_failure)
        least = self._least_tolerances
        if least is None or self._excess(least) > MAX_EXCESS:
            return abort
        return TaskEvent.NEARLY_DONE.report(abort=abort, **self._least_change())

    @property
    def failure(self) -> TaskFailure | None:
        """Why the task is to be aborted, None while it is not."""
        if self._unseen_pushes >= self._max_unseen_pushes:
            return TaskFailure.NO_MEASUREMENTS
        if self._attempts >= self.settings.max_attempts or self._hold_ups >= MAX_HOLD_UPS:
            return TaskFailure.NO_PROGRESS
        return TaskFailure.NO_PLAN if self._planning_failure else None

    def _have_moved(self, before: PlanRequest, request: PlanRequest) -> bool:
        """Tell whether object or robot are elsewhere than in a previous request."""
        return (has_moved(before.object_pose, request.object_pose, self.settings)
                or has_moved(before.robot_pose, request.robot_pose, self.settings))


def _is_at_end(plan: PushTrajectory, pose: Pose) -> bool:
    """Tell whether an object is about where a plan ends."""
    end = Pose(*plan.object_poses[-1].tolist())
    return (distance(end, pose) < WAYPOINT_DISTANCE
            and abs(wrap_angle(end.theta - pose.theta)) < WAYPOINT_ANGLE)


def _rounded_up(value: float) -> float:
    """Round a value to a tenth, no less than it is."""
    return math.ceil(10.0 * value) / 10.0 if math.isfinite(value) else value


def _goal_errors(object_at_rest: ObjectAtRest) -> tuple[float, float]:
    """Return the standard deviations of an object in the frame of its goal, [m] and [rad]."""
    return (math.hypot(object_at_rest.position_error, object_at_rest.common_position_error),
            math.hypot(object_at_rest.heading_error, object_at_rest.common_heading_error))


def _reduced(tolerance: float, margin: float) -> float:
    """Reduce a tolerance by a margin, but to no less than pushes aim at."""
    return max(MIN_AIM * tolerance, tolerance - margin)
