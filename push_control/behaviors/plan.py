"""Plan: stand, measure the object at rest, and decide whether and how it is to be pushed."""

from typing import Callable

from push_control.behaviors.behavior import (
    Abort, Behavior, BehaviorContext, MeasurementNeed, NoPushNeeded,
)
from push_control.behaviors.progress import GoalCheck, ProgressMonitor
from push_control.events import PerceptionEvent, TaskEvent
from push_control.goal import TaskFailure, TaskGoal
from push_control.perception.object_at_rest import ObjectAtRest
from push_control.perception.perception import TaskPerception
from push_control.perception.view import UNSEEN_TIME
from push_model.events import AnyReport
from push_model.geometry import distance, Pose
from push_model.plan_request import PlanRequest
from push_model.signals import STOP, Twist

# Standard deviation of the gap of a robot whose pose overlaps the object [m]; chosen: the noise of
# one object pose.
OVERLAP_STD = 0.002


class PlanBehavior(Behavior[TaskPerception]):
    """
    Stands, and requests a plan once the object is known to be at rest away from its goal.

    It finishes with a ``result`` only where no push is needed or possible: until then it waits for
    the plan that it has requested.
    """

    needs_plan = True
    # The first push of several may end anywhere.
    ends_at_goal = False

    def __init__(self, context: BehaviorContext, progress: ProgressMonitor, goal: TaskGoal,
                 remaining_time: Callable[[Pose, Pose], float | None]) -> None:
        """
        Start.

        :param context: the ``BehaviorContext``; its object may be the nominal one.
        :param progress: the ``ProgressMonitor`` of the task.
        :param remaining_time: expects the time that the task still takes from the ``Pose`` of the
            object to the goal [s]; None where that is unknown.
        """
        super().__init__()
        self._goal = goal.pose
        self._since = goal.since
        self._context = context
        self._progress = progress
        self._remaining_time = remaining_time
        self._averaging: AnyReport | None = None
        self._motion: AnyReport | None = None
        # Since when it stands here [s].
        self._started_at: float | None = None
        if context.supervision.has_limited_view:
            # Without a pose it looks for the object.
            self.measurement_need = MeasurementNeed.ODOMETRY
        progress.rest_clock.end_wait()

    @property
    def waiting_cause(self) -> AnyReport | None:
        """What the measurement waits for; None where it does not take long."""
        return self._averaging or self._motion

    def move_goal(self, pose: Pose) -> None:
        """Move the goal a little, as where its frame drifts."""
        self._goal = pose

    @property
    def start_limits(self) -> tuple[float, float]:
        """Distance and rotation up to which an object is at the start of a plan [m, rad]."""
        return self._progress.settings.moved_distance, self._progress.settings.moved_angle

    def pause(self) -> None:
        """Do nothing: the robot stands."""

    def step(self, perception: TaskPerception, dt: float) -> Twist:
        """Stand; measure and decide."""
        if perception.has_limited_view and not perception.has_fresh_pose:
            self._await_pose(perception)
            return STOP
        if not self._has_measured_rest(perception):
            self._await_rest(perception)
            return STOP
        self._progress.rest_clock.end_wait()
        if self.plan_request is None and self._progress.may_request(perception.time):
            perception.evaluate_push()
            self._decide(perception)
        return STOP

    def _has_measured_rest(self, perception: TaskPerception) -> bool:
        return (perception.has_pose_after(self._since) and perception.has_object_at_rest
                and perception.object_at_rest.duration
                >= self._progress.settings.min_averaging_time)

    def _await_pose(self, perception: TaskPerception) -> None:
        """Wait for a pose, unless the object is out of view."""
        if self._started_at is None:
            self._started_at = perception.time
        unseen_time = min(perception.pose_age, perception.time - self._started_at)
        if self.plan_request is None and unseen_time >= UNSEEN_TIME:
            self._finish(NoPushNeeded.OUT_OF_VIEW)

    def _await_rest(self, perception: TaskPerception) -> None:
        """Report why the object does not come to rest, and give up after a while."""
        clock = self._progress.rest_clock
        clock.wait(perception.time)
        if clock.is_long:
            self._motion = perception.motion_report
        if clock.is_too_long:
            self._abort(TaskFailure.NOT_AT_REST, TaskEvent.ABORTED.report(reason=self._motion))

    def _decide(self, perception: TaskPerception) -> None:
        """Compare the object at rest with its goal, and act on that."""
        object_at_rest = perception.object_at_rest
        goal_distance = distance(object_at_rest.pose, self._goal)
        limit = self._progress.settings.max_goal_distance
        if goal_distance > limit:
            self._abort(TaskFailure.NO_PLAN, TaskEvent.GOAL_TOO_FAR.report(
                distance=goal_distance, limit=limit))
            return
        check = self._progress.check_goal(
            object_at_rest, self._goal, self._remaining_time(object_at_rest.pose, self._goal))
        self._averaging = None
        if check is GoalCheck.UNCERTAIN:
            self._averaging = self._progress.averaging_report(object_at_rest)
        elif check is GoalCheck.REACHED:
            self._finish(NoPushNeeded.REACHED)
        elif check is GoalCheck.UNSEEN:
            self._inspect(object_at_rest)
        elif self._progress.abort_cause is not None or perception.is_refuted:
            self._abort_with_inconsistencies(perception)
        else:
            self._request_plan(perception, object_at_rest.pose)

    def _inspect(self, object_at_rest: ObjectAtRest) -> None:
        """See an object that may be at its goal from another side, unless that was too often."""
        self._progress.count_inspection(object_at_rest)
        cause = self._progress.abort_cause
        if cause is not None:
            self._abort(self._progress.failure, cause)
        else:
            self._finish(NoPushNeeded.UNSEEN)

    def _abort_with_inconsistencies(self, perception: TaskPerception) -> None:
        """Give the task up, and name what measurements have to do with it."""
        cause, failure = self._progress.abort_cause, self._progress.failure
        inconsistency = _inconsistency(perception)
        if cause is None:
            self._abort(TaskFailure.NO_PROGRESS, TaskEvent.ABORTED.report(reason=inconsistency))
        elif failure is TaskFailure.NO_PROGRESS and inconsistency is not None:
            self._abort(failure, TaskEvent.ABORTED_INCONSISTENT.report(
                abort=cause, inconsistency=inconsistency))
        else:
            self._abort(failure, cause)

    def _request_plan(self, perception: TaskPerception, object_pose: Pose) -> None:
        """Request a plan, unless it would fail again."""
        perception.correct_overlap(self._context.obj, self._context.robot, OVERLAP_STD)
        progress, localization = self._progress, perception.localization
        knowledge, uncertainty = localization.knowledge, perception.position_uncertainty
        request = PlanRequest(
            object_pose, perception.robot_pose, self._goal, localization.obj,
            progress.cone_fraction, *progress.aim, self._position_std(perception),
            knowledge.center_deviation, knowledge.contact_friction_deviation,
            uncertainty.slope, uncertainty.drift)
        if not progress.awaits_map(request, perception.time):
            self.plan_request = request

    def _position_std(self, perception: TaskPerception) -> float:
        """Return the std of the robot at the object, in a map in the world too [m]."""
        at_object = perception.position_deviation
        if self._context.occupancy_map is None:
            return at_object
        return max(at_object, perception.position_uncertainty.position)

    def _abort(self, failure: TaskFailure | None, cause: AnyReport) -> None:
        self._finish(Abort(failure, cause))

    def _finish(self, result: NoPushNeeded | Abort) -> None:
        self.result = result
        self.finished = True


def _inconsistency(perception: TaskPerception) -> AnyReport | None:
    """Report what does not fit object poses, or odometry, or both; None where all fits."""
    poses, odometry = perception.pose_inconsistency, perception.odometry_inconsistency
    if poses is None or odometry is None:
        return poses or odometry
    return PerceptionEvent.INCONSISTENCIES.report(first=poses, second=odometry)
