"""
Supervisor of a task: what its user, the planner and the safety layer have to say.

Everything else is ``TaskExecution``: a step answers a measurement with a command.
"""

from collections.abc import Callable
import math

from push_control.events import no_plan, TaskEvent
from push_control.goal import TaskFailure, TaskGoal
from push_control.perception.object_at_rest import has_moved
from push_control.settings import ControlSettings
from push_control.steered.plan_check import ExpectedEnds, PoseRegion
from push_control.supervision_settings import aimed_tolerances, SupervisionSettings
from push_control.task.execution import TaskExecution
from push_control.task.status import TaskState
from push_model.events import AnyReport, Report
from push_model.geometry import distance, Pose, wrap_angle
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_safety.protective_field import ProtectiveCause
from push_safety.status import SafetyReason, SafetyReport


class Supervisor(TaskExecution):
    """Brings an object to its goal: answers measurements with commands, and requests plans."""

    # Goals and settings.

    def set_goal(self, pose: Pose | None, since: float = -math.inf) -> None:
        """
        Start a task, whatever is under way; while paused it waits for ``resume``.

        :param pose: goal ``Pose`` of the object; None for no task.
        :param since: as of ``TaskGoal`` [s].
        :raises ValueError: where it is not finite.
        """
        if pose is None:
            self.stop(TaskEvent.NO_GOAL.report())
            return
        if not Pose(*pose).is_finite():
            raise ValueError(f'goal: got {pose}, expected three finite numbers')
        self._goal = TaskGoal(Pose(*pose), since)
        self._stated = None
        self._reasons.resume()
        if self._behavior.take_goal(self._goal, self._behaviors.tolerances):
            self._machine.note(self._perception.time, TaskEvent.NEW_GOAL.report(),
                               is_requested=True)
            return
        self._restart_progress()
        self._perception.forget_contacts()
        self._start_task()
        if self.state is not TaskState.PAUSED:
            self._enter(self._machine.restart_state, self._new_goal_report(), is_requested=True)

    def _new_goal_report(self) -> Report[TaskEvent]:
        """Report a new goal, and what is known already to stand against it."""
        if self._force_warning:
            return TaskEvent.NEW_GOAL_TOO_HEAVY.report(warning=self._force_warning)
        return TaskEvent.NEW_GOAL.report()

    def restart(self, pose: Pose | None, since: float = -math.inf) -> None:
        """
        Start over: with the plan that was kept for the start, or to a goal.

        :param pose: goal ``Pose`` of the object; None for no task.
        :param since: as of ``TaskGoal`` [s].
        """
        if self.keeps_plan and self._plan is not None and self.state is not TaskState.PLAN:
            self.drive(self._plan)
        else:
            self.set_goal(pose, since)
        self.resume()

    def set_settings(self, control: ControlSettings, drive: DriveSettings,
                     supervision: SupervisionSettings) -> None:
        """
        Set settings under way: checks of the goal use them now, movements from the next one on.

        What perception was made with stays: noise of the sensors, drift of the odometry, and how
        long the object is averaged.
        """
        self._behaviors.set_settings(control, drive, supervision)
        supervision = self._behaviors.supervision
        self._progress.settings = supervision
        self._progress.aim = aimed_tolerances(control, supervision)

    def set_map(self, occupancy_map: OccupancyMap | None) -> None:
        """Set the map, None for open floor; a path or push that it blocks is given up."""
        self._behaviors.occupancy_map = occupancy_map
        perception = self._perception
        if perception.is_localized and self._behavior.is_blocked(occupancy_map,
                                                                 perception.robot_pose):
            self._recover(TaskEvent.MAP_BLOCKS_PATH.report())
        self._progress.forget_planning_failures()

    def move_map(self, occupancy_map: OccupancyMap | None) -> None:
        """Move the map a little for the next behaviour; planning that failed in it fails again."""
        self._behaviors.occupancy_map = occupancy_map

    def move_goal(self, pose: Pose) -> None:
        """Move the goal a little for the next behaviour or plan, as where its frame drifts."""
        if self._goal is not None:
            self._goal = self._goal._replace(pose=pose)
        self._behavior.move_goal(pose)

    # Plans.

    @property
    def plan_request(self) -> PlanRequest | None:
        """``PlanRequest`` that waits for its plan, or None."""
        return self._behavior.plan_request

    @property
    def awaits_plan(self) -> bool:
        """Tell whether nothing happens before the plan comes that was requested."""
        return self._behavior.needs_plan and self.plan_request is not None

    @property
    def keeps_plan(self) -> bool:
        """Tell whether a plan is made before the start, and kept for the next one."""
        return self._behaviors.keeps_plan

    @property
    def has_stored_plan(self) -> bool:
        """Tell whether there is a plan that the next start drives."""
        return self.keeps_plan and self._plan is not None

    def expected_ends(self, request: PlanRequest | None) -> ExpectedEnds:
        """
        Tell where a plan has to start, and where it has to end.

        :param request: the ``PlanRequest`` that it answers, or None.
        """
        poses: list[Pose] = []
        if request is not None:
            poses.append(request.object_pose)
        if self._perception.has_pose_after(-math.inf):
            poses.append(self._perception.object_pose.pose)
        starts = tuple(PoseRegion(pose, *self._behavior.start_limits) for pose in poses)
        if request is None:
            return ExpectedEnds(starts)
        return ExpectedEnds(starts, PoseRegion(request.goal, *request.tolerances),
                            self._behavior.ends_at_goal)

    def preparation(self, trajectory: PushTrajectory) -> Callable[[], object] | None:
        """Tell what takes long before a plan is driven, as of ``BehaviorFactory``."""
        return self._behaviors.preparation(trajectory, self._perception)

    def set_plan(self, trajectory: PushTrajectory) -> None:
        """Set the plan that was requested, wherever the robot stands; ignore any other."""
        if self.plan_request is None:
            return
        if self._perception.has_limited_view and not trajectory.style.is_straight:
            self.on_planning_failed(PlanFailure.NO_FEASIBLE_SITE,
                                    TaskEvent.PUSH_NEEDS_POSES.report())
            return
        requested = self.plan_request.object_pose
        start = Pose(*trajectory.object_poses[0].tolist())
        if self.awaits_plan and has_moved(requested, start, self._progress.settings):
            self.on_planning_failed(
                PlanFailure.INVALID_PLAN, TaskEvent.PLAN_STARTS_ELSEWHERE.report(
                    distance=distance(requested, start),
                    rotation=math.degrees(abs(wrap_angle(start.theta - requested.theta)))))
            return
        self._progress.on_plan()
        self.drive(trajectory)

    def drive(self, trajectory: PushTrajectory) -> None:
        """Follow a plan, be it requested or not; without a stop where the behaviour can."""
        self._set_plan(trajectory)
        if self._behavior.take_plan(trajectory):
            self._machine.note(self._perception.time, TaskEvent.NEW_PLAN.report(),
                               is_requested=True)
        else:
            self._enter(self._machine.table.transitions[TaskState.PLAN].success)

    def keep_plan(self, trajectory: PushTrajectory, cause: AnyReport) -> None:
        """
        Stand with a plan, for the next start to drive it.

        :param cause: ``Report`` of why it is not driven now.
        """
        self._set_plan(trajectory)
        self._enter(TaskState.IDLE, cause)

    def on_planning_failed(self, code: PlanFailure, reason: str | AnyReport) -> None:
        """
        Note that there is no plan for the request.

        :param reason: ``code`` in one sentence, or a ``Report`` of it.
        """
        request, now = self.plan_request, self._perception.time
        if request is None:
            return
        if code is PlanFailure.AT_GOAL:
            self._enter(TaskState.DONE,
                        TaskEvent.NO_PUSH_NEEDED.report(failure=code, reason=reason))
            return
        if self._behavior.goes_on_without_plan():
            return
        self._perception.restart_averaging(now)
        self._progress.on_planning_failed(request, code, reason, now)
        cause = self._behavior.push_cause or no_plan(code, reason)
        self._enter_after_failure(cause, TaskFailure.NO_PLAN)

    def on_plan_refused(self) -> None:
        """Note that a plan cannot be driven, so that the robot stands."""
        code = PlanFailure.INVALID_PLAN
        if self.state is TaskState.PLAN:
            self.on_planning_failed(code, code.value)
        elif not self.state.is_standing:
            self._abort(TaskFailure.NO_PLAN, no_plan(code, code.value))

    def on_plan_overdue(self, cause: AnyReport) -> None:
        """
        Note that the plan has not come in time, by the clock of the caller.

        :param cause: ``Report`` of that.
        """
        if self.plan_request is None or self._behavior.goes_on_without_plan():
            return
        self._recover(cause, TaskFailure.NO_PLAN)
        # At once: a plan that is only late answers this request as well.
        self._progress.allow_request()

    def renew_request(self) -> None:
        """Request the plan that is awaited once more, from where robot and object are then."""
        self._behavior.renew_request()

    # Stops.

    def hold(self, cause: AnyReport | None) -> None:
        """Stand until the cause is None; the task goes on after it."""
        self._reasons.hold(cause)

    def protect(self, report: Report[ProtectiveCause] | None) -> None:
        """Stand for what a scan shows, as of ``StandReasons.protect``."""
        self._reasons.protect(report)

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found; called before the step with that odometry.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        if fault is not None and fault.code.is_of_odometry:
            self._perception.distrust_odometry(fault.code is SafetyReason.ODOMETRY_JUMPED)
        self._behavior.on_safety_report(fault, stop)
        self._backs_off = False
        is_new = self._reasons.on_stop(stop, self._perception.time)
        if stop is None or not is_new or self.state.is_standing:
            return
        may_act = not self._behavior.handles_stops and not self.awaits_resume
        failure = self._behavior.stop_failure(stop) if may_act else None
        if failure is not None:
            # The object has stopped the robot: nothing is wrong with its base.
            self._end_after_failure(failure)
            self._progress.allow_request()
            self._backs_off = self.state is TaskState.RETREAT
            return
        self._last_stop = stop
        if may_act:
            self._end_behavior(stop)

    def _end_behavior(self, stop: SafetyReport) -> None:
        """Give up what the robot does, or the task where that was too often."""
        if self._progress.count_safety_stop():
            self._abort(TaskFailure.ROBOT_STOPPED, TaskEvent.ABORTED.report(reason=stop))
        else:
            self._recover(stop)
            # At once: the next attempt shows whether the base follows.
            self._progress.allow_request()

    @property
    def backs_off(self) -> bool:
        """Tell whether what it pushes has stopped the robot just now, and it backs off."""
        return self._backs_off

    @property
    def can_pause(self) -> bool:
        """Tell whether what it does can be paused."""
        return self._machine.leads_to(TaskState.PAUSED)

    def pause(self) -> None:
        """Stand until ``resume``."""
        if self.can_pause:
            self._enter(TaskState.PAUSED)

    def resume(self) -> None:
        """Go on after a pause, or after a stop of the base with another plan."""
        if self._behavior.resume():
            self._reasons.resume()
            return
        if self.state is TaskState.PAUSED or self.awaits_resume:
            if self.awaits_resume:
                self._progress.forget_safety_stops()
            self._reasons.resume()
            self._enter(self._machine.restart_state, TaskEvent.RESUMED.report(),
                        is_requested=True)

    @property
    def can_restart(self) -> bool:
        """Tell whether ``restart`` can go on with the task after it was interrupted now."""
        return self.state not in self._machine.table.lost and self._behavior.next_goal is None

    def stop(self, cause: AnyReport) -> None:
        """Abandon the task and stand, at the user's request."""
        self._abandon()
        self._enter(TaskState.IDLE, cause, is_requested=True)

    def interrupt(self, cause: AnyReport) -> None:
        """Abandon the task for a fault, and stand; the cause stays until there is a goal."""
        self._goal = None
        self._enter(TaskState.IDLE, cause)

    def cancel(self, cause: AnyReport) -> None:
        """Abandon the task; a robot that may touch the object backs off before it stands."""
        state = self._machine.cancellation_state
        if state is TaskState.IDLE or self.awaits_resume:
            self.stop(cause)
            return
        if self.state is not state:
            self._enter(state, cause, is_requested=True)
        self._abandon()

    def _abandon(self) -> None:
        """Forget goal and plan; one of repeated pushes tells how the robot backs off."""
        self._goal = self._stated = None
        if self.keeps_plan:
            self._plan = None
