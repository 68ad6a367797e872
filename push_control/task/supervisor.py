"""
Supervisor of a task: plan, approach, align, push, retreat, until the object is at its goal.

States, and where they lead when all goes well (``Transitions`` says the rest):

    PLAN -> APPROACH -> ALIGN -> PUSH -> RETREAT -> PLAN -> ... -> DONE

In PLAN the robot stands and the object is measured at rest; there the task is done, aborted, or a
plan of the next push requested. In every other state a ``Behavior`` commands the robot.
"""

import dataclasses
import math
from typing import NamedTuple

from push_control.estimation.measurement_watch import MeasurementWatch
from push_control.estimation.object_knowledge import ObjectKnowledge
from push_control.events import sentence
from push_control.observation import Observation
from push_control.push.status import ControllerStatus
from push_control.safety.status import SafetyReason, SafetyReport
from push_control.settings import ControlSettings
from push_control.task.behavior import Behavior
from push_control.task.behavior_factory import BehaviorFactory
from push_control.task.perception import has_moved, ObjectAtRest, TaskPerception
from push_control.task.progress import GoalCheck, ProgressMonitor
from push_control.task.settings import aimed_tolerances, SupervisionSettings
from push_control.task.status import StateChange, SupervisorStatus, TaskFailure, TaskState
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure, PlanRequest
from push_model.signals import ObjectEstimate, STOP, Twist
from push_model.trajectory import PushStyle, PushTrajectory
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_primitives.simplification import simplified_object

# Time after the end of a push from which on the object may be at rest [s]; chosen: longer than the
# latency of its poses (0.08 s in the scenarios), and than it slides on.
SETTLING_TIME = 0.3
# Time from where there is no plan, or no path to where it begins, until another plan is requested
# [s]; chosen: attempts outlast a map that is wrong for some seconds.
RETRY_TIME = 1.0
# Time for which the safety layer may hold the robot until the task is given up [s]; chosen: a base
# that restarts is back by then.
STOP_TIME_LIMIT = 10.0
# Time after which the robot says that the object does not come to rest, and after which it gives
# up [s]; chosen: longer than poses are averaged, and than somebody carries the object about.
REST_REPORT_TIME = 3.0
REST_TIME_LIMIT = 60.0
# Distance and rotation from the planned end of a push to a waypoint within which it has gone as
# planned [m, rad]; chosen: a standard deviation of long pushes.
WAYPOINT_DISTANCE, WAYPOINT_ANGLE = 0.12, 0.3
# Distance from the object to its goal that is a mistake of a unit or a frame [m]; chosen: nothing
# is pushed as far.
MAX_GOAL_DISTANCE = 200.0
# Time for which a task waits for measurements that have come before [s]; chosen: likewise.
MEASUREMENT_TIME_LIMIT = 60.0


class Transitions(NamedTuple):
    """
    Where a state leads.

    :param success: state after the end of its behaviour.
    :param failure: state after its failure.
    :param restart: state from which another plan is sought, as for a new goal.
    """

    success: TaskState
    failure: TaskState
    restart: TaskState


# A robot in contact backs off first. A retreat that fails is not repeated: the path to the next
# pre-push pose may lead off the object.
TRANSITIONS = {
    TaskState.PLAN: Transitions(TaskState.APPROACH, TaskState.PLAN, TaskState.PLAN),
    TaskState.APPROACH: Transitions(TaskState.ALIGN, TaskState.PLAN, TaskState.PLAN),
    TaskState.ALIGN: Transitions(TaskState.PUSH, TaskState.RETREAT, TaskState.RETREAT),
    TaskState.PUSH: Transitions(TaskState.RETREAT, TaskState.RETREAT, TaskState.RETREAT),
    TaskState.RETREAT: Transitions(TaskState.PLAN, TaskState.PLAN, TaskState.RETREAT)}


class _Answer(NamedTuple):
    """The last command, and the times of the measurements that it answers."""

    stamps: tuple[float, float, float | None] | None = None
    command: Twist = STOP


class Supervisor:
    """Answers measurements with commands, and requests plans."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 drive: DriveSettings, supervision: SupervisionSettings, *,
                 knowledge: ObjectKnowledge | None = None) -> None:
        """
        Stand idle.

        :param obj: the nominal ``PushedObject``; a fine outline and many supports are simplified,
            as the planner does.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        :param knowledge: what was learned of the object in former tasks, or None.
        """
        obj = simplified_object(obj)
        self._settings = supervision
        self._aim = aimed_tolerances(control, supervision)
        self._progress = ProgressMonitor(supervision, self._aim)
        self._behaviors = BehaviorFactory(obj, robot, control, drive, supervision)
        self._perception = TaskPerception(obj, robot, control, supervision)
        if knowledge is not None:
            self._perception.localization.start_from(knowledge)
        self._goal: Pose | None = None
        self._plan: PushTrajectory | None = None
        self._behavior: Behavior | None = None
        # That waits for its plan.
        self._pending: PlanRequest | None = None
        self._paused_state = TaskState.IDLE
        # Why the safety layer holds the robot, or None.
        self._stop_report: SafetyReport | None = None
        self._stopped_since = 0.0
        # Since when the object has not been at rest where it should be [s], or None.
        self._moving_since: float | None = None
        # Long waits for that, in all, since the last push [s].
        self._unrest_time = 0.0
        # Before that no other plan is requested [s].
        self._retry_time = -math.inf
        # Why the robot has to stand besides, one sentence, or empty.
        self._hold_reason = ''
        self._watch = MeasurementWatch()
        self._answer = _Answer()
        # As of the last change of state; ``status`` adds what is measured since.
        self._entered = SupervisorStatus()
        self._reason_to_wait = ''
        # Made where somebody asks for it, which is less often than the robot is commanded.
        self._status: SupervisorStatus | None = None

    @property
    def plan_request(self) -> PlanRequest | None:
        """``PlanRequest`` that waits for its plan, or None."""
        return self._pending

    @property
    def status(self) -> SupervisorStatus:
        """The present ``SupervisorStatus``."""
        if self._status is None:
            self._status = self._present_status()
        return self._status

    @property
    def state(self) -> TaskState:
        """The present ``TaskState``."""
        return self._entered.state

    @property
    def reason(self) -> str:
        """One sentence on the present state, empty while all is well."""
        state = self._entered.state
        reason = self._hindrance or self._entered.reason
        if reason or state.is_standing:
            return reason
        if state is not TaskState.PUSH:
            return self._perception.pose_doubt
        return self._entered.push.reason if self._behavior is None else self._behavior.push_reason

    @property
    def _hindrance(self) -> str:
        """Why the robot has to wait; a task that is over waits for nothing."""
        return '' if self._entered.state.is_final else self._reason_to_wait

    @property
    def failure(self) -> TaskFailure | None:
        """Why the task was given up, where it was."""
        return self._entered.failure

    @property
    def pushes(self) -> int:
        """Number of pushes begun for this goal."""
        return self._entered.pushes

    @property
    def history(self) -> tuple[StateChange, ...]:
        """``StateChange`` of every state since the goal was set."""
        return self._entered.history

    @property
    def recoveries(self) -> int:
        """Number of failures recovered from for this goal."""
        return self._entered.recoveries

    @property
    def knowledge(self) -> ObjectKnowledge:
        """What is known of the object by now."""
        return self._perception.localization.knowledge

    @property
    def object_estimate(self) -> ObjectEstimate | None:
        """The present ``ObjectEstimate``; None before the first measurements."""
        localization = self._perception.localization
        if not (localization.is_initialized and localization.has_object):
            return None
        return ObjectEstimate(self._perception.time, localization.object_pose,
                              localization.object_covariance, localization.friction_center)

    @property
    def identified_object(self) -> PushedObject:
        """The ``PushedObject`` with friction as identified by now."""
        return self._perception.localization.obj

    @property
    def friction_center_covariance(self) -> tuple[float, float, float]:
        """Covariance of the centre of friction in the object frame (xx, xy, yy) [m^2]."""
        return self._perception.localization.friction_center_covariance

    def take_over_robot(self, former: 'Supervisor') -> None:
        """
        Start with the robot where it was localized while it pushed another object.

        :param former: the ``Supervisor`` of that object, with the same settings.
        """
        self._perception.localization.take_over_robot(former._perception.localization)

    def set_goal(self, pose: Pose | None) -> None:
        """
        Start a task, whatever is under way; while paused it waits for ``resume``.

        :param pose: goal ``Pose`` of the object; None for no task.
        :raises ValueError: where it is not finite.
        """
        if pose is None:
            self.stop('no goal')
            return
        if not Pose(*pose).is_finite():
            raise ValueError(f'goal: got {pose}, expected three finite numbers')
        self._goal = Pose(*pose)
        self._progress = ProgressMonitor(self._settings, self._aim)
        self._perception.forget_contacts()
        self._unrest_time = 0.0
        self._retry_time = -math.inf
        self._entered = dataclasses.replace(self._entered, pushes=0, recoveries=0, history=())
        if self._entered.state is not TaskState.PAUSED:
            self._restart(self._entered.state, 'new goal')
        self._update_status()

    def set_settings(self, control: ControlSettings, drive: DriveSettings,
                     supervision: SupervisionSettings) -> None:
        """
        Set settings under way: checks of the goal use them now, movements from the next one on.

        What perception was made with stays: noise of the sensors, drift of the odometry, and how
        long the object is averaged.

        :param control: ``ControlSettings``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._settings = supervision
        self._aim = aimed_tolerances(control, supervision)
        self._progress.settings = supervision
        self._progress.aim = self._aim
        self._behaviors.set_settings(control, drive, supervision)

    def set_map(self, occupancy_map: OccupancyMap | None) -> None:
        """
        Set the map for the next path; a path or push that it blocks is given up.

        :param occupancy_map: the ``OccupancyMap``, or None for open floor.
        """
        self._behaviors.occupancy_map = occupancy_map
        if self._behavior is not None and self._behavior.is_blocked(
                occupancy_map, self._perception.robot_pose):
            self._recover('the new map has an obstacle in the way')
            self._update_status()
        self._progress.forget_planning_failures()

    def move_goal(self, pose: Pose) -> None:
        """
        Move the goal a little, as where the frame that it is in has drifted; the task goes on.

        :param pose: goal ``Pose`` of the object, used from the next behaviour or plan on.
        """
        if self._goal is not None:
            self._goal = pose

    def move_map(self, occupancy_map: OccupancyMap | None) -> None:
        """
        Move the map a little, likewise; planning that failed in it fails again.

        :param occupancy_map: the ``OccupancyMap``, or None for open floor.
        """
        self._behaviors.occupancy_map = occupancy_map

    def set_plan(self, trajectory: PushTrajectory) -> None:
        """
        Set the plan that was requested; one that was not is ignored.

        :param trajectory: ``PushTrajectory``; the robot may stand anywhere.
        """
        if self._pending is None:
            return
        requested = self._pending.object_pose
        start = Pose(*trajectory.object_poses[0].tolist())
        if has_moved(requested, start, self._settings):
            self.on_planning_failed(
                PlanFailure.INVALID_PLAN, 'the plan begins where the object is not, '
                f'{distance(requested, start):.2f} m and '
                f'{math.degrees(abs(wrap_angle(start.theta - requested.theta))):.0f} deg off')
            return
        self._plan = trajectory
        self._progress.on_plan()
        self._enter(TRANSITIONS[TaskState.PLAN].success)
        self._update_status()

    def on_planning_failed(self, code: PlanFailure, reason: str) -> None:
        """
        Note that there is no plan for the request.

        :param code: ``PlanFailure``.
        :param reason: the same in one sentence.
        """
        if self._pending is None:
            return
        self._perception.restart_averaging(self._perception.time)
        self._progress.on_planning_failed(self._pending, code, reason, self._perception.time)
        self._return(f'no plan: {reason}')
        self._update_status()

    def on_plan_overdue(self) -> None:
        """Note that the plan has not come within ``plan_timeout``, by the clock of the caller."""
        if self._pending is not None:
            self._recover(f'no plan within {self._settings.plan_timeout:g} s')
            # At once: a plan that is only late answers this request as well.
            self._retry_time = -math.inf
            self._update_status()

    def renew_request(self) -> None:
        """Request the plan that is awaited once more, from where robot and object are then."""
        self._pending = None
        self._update_status()

    def hold(self, reason: str) -> None:
        """
        Stand for as long as something is missing; the task goes on after it.

        :param reason: one sentence; empty where the robot may move.
        """
        self._hold_reason = reason

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found; called before the step with that odometry.

        :param fault: what is wrong with the newest odometry, or None.
        :param stop: why the robot is stopped, or None where it may move.
        """
        if fault is not None and fault.reason.is_of_odometry:
            self._perception.distrust_odometry(fault.reason is SafetyReason.ODOMETRY_JUMPED)
        is_new = stop is not None and self._stop_report is None
        self._stop_report = stop
        if is_new:
            self._stopped_since = self._perception.time
            if not self._entered.state.is_standing:
                self._end_behavior(str(stop))
                self._update_status()

    def _end_behavior(self, reason: str) -> None:
        """Give up what the robot does, or the task where that was too often."""
        if self._progress.count_safety_stop():
            self._fail(TaskFailure.ROBOT_STOPPED, reason)
        else:
            self._recover(reason)

    def _fail(self, failure: TaskFailure, reason: str) -> None:
        self._enter(TaskState.FAILED, f'aborted: {reason}')
        self._entered = dataclasses.replace(self._entered, failure=failure)

    def pause(self) -> None:
        """Stand until ``resume``."""
        if not self._entered.state.is_standing:
            self._paused_state = self._entered.state
            self._enter(TaskState.PAUSED)
            self._update_status()

    def resume(self) -> None:
        """Go on after a pause, with another plan."""
        if self._entered.state is TaskState.PAUSED:
            self._restart(self._paused_state, 'resumed')
            self._update_status()

    def stop(self, reason: str) -> None:
        """
        Abandon the task and stand.

        :param reason: one sentence.
        """
        self._goal = None
        self._enter(TaskState.IDLE, reason, is_requested=True)
        self._update_status()

    def interrupt(self, reason: str) -> None:
        """
        Abandon the task for a fault, and stand.

        :param reason: one sentence, which stays until there is a goal.
        """
        self._goal = None
        self._enter(TaskState.IDLE, reason)
        self._update_status()

    def cancel(self, reason: str) -> None:
        """
        Abandon the task; a robot that may touch the object backs off before it stands.

        :param reason: one sentence.
        """
        state = self._entered.state
        if state.is_standing or TRANSITIONS[state].restart is not TaskState.RETREAT:
            self.stop(reason)
            return
        self._goal = None
        if state is not TaskState.RETREAT:
            self._enter(TaskState.RETREAT, reason, is_requested=True)
        self._update_status()

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement; the same observation again gets the same answer.

        :param observation: ``Observation``, with odometry as it comes.
        :param dt: time since the last step [s].
        :return: ``Twist`` in the robot's axes.
        :raises ValueError: where dt is negative or not finite.
        """
        if not 0.0 <= dt < math.inf:
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        stamps = observation.stamps
        if stamps != self._answer.stamps:
            self._perception.update(observation)
            waiting_reason = self._waiting_reason()
            self._answer = _Answer(stamps, self._command(waiting_reason, dt))
            self._update_status(waiting_reason)
        return self._answer.command

    def _waiting_reason(self) -> str:
        """Why the robot has to wait for better measurements; a steered push decides by itself."""
        state = self._entered.state
        stop_reason = '' if self._stop_report is None else str(self._stop_report)
        if not state.is_standing and (stop_reason or self._hold_reason):
            self._watch = MeasurementWatch()
            return stop_reason or self._hold_reason
        if state.is_standing or state is TaskState.PUSH and not self._is_unsteered:
            self._watch = MeasurementWatch()
            return ''
        perception = self._perception
        return sentence(self._watch.update(
            perception.measurement_fault(needs_object=state is not TaskState.RETREAT),
            perception.time))

    def _command(self, waiting_reason: str, dt: float) -> Twist:
        if self._entered.state.is_standing:
            return STOP
        if waiting_reason:
            if self._behavior is not None:
                self._behavior.pause()
            is_stopped = self._stop_report is not None
            now = self._perception.time
            if is_stopped and now - self._stopped_since > STOP_TIME_LIMIT:
                self._fail(TaskFailure.ROBOT_STOPPED, waiting_reason)
            elif self._watch.waited(now) > MEASUREMENT_TIME_LIMIT:
                self._fail(TaskFailure.NO_MEASUREMENTS, waiting_reason)
            return STOP
        if self._behavior is None:
            self._check_goal()
            return STOP
        command = self._behavior.step(self._perception, dt)
        if self._behavior.failure_reason:
            self._recover(self._behavior.failure_reason)
            return STOP
        if self._behavior.finished:
            self._advance()
        return command

    def _check_goal(self) -> None:
        """Measure the object at rest, then end the task or request a plan."""
        perception, settings, now = self._perception, self._settings, self._perception.time
        if (not perception.has_object_at_rest
                or perception.object_at_rest.duration < settings.min_averaging_time):
            self._await_rest()
            return
        self._note_unrest()
        if self._pending is not None or self._goal is None or now < self._retry_time:
            return
        perception.judge_push()
        object_at_rest = perception.object_at_rest
        if distance(object_at_rest.pose, self._goal) > MAX_GOAL_DISTANCE:
            self._fail(TaskFailure.NO_PLAN,
                       f'the goal is {distance(object_at_rest.pose, self._goal):.0f} m away, at '
                       f'most {MAX_GOAL_DISTANCE:g} m is expected')
            return
        check = self._progress.check_goal(
            object_at_rest, self._goal,
            self._behaviors.remaining_time(object_at_rest.pose, self._goal))
        if check is GoalCheck.REACHED:
            self._enter(TaskState.DONE)
        elif check is GoalCheck.UNSEEN:
            self._inspect(object_at_rest)
        elif check is GoalCheck.MISSED and (self._progress.abort_reason or perception.is_refuted):
            self._abort()
        elif check is GoalCheck.MISSED:
            self._behaviors.correct_overlap(perception)
            localization, knowledge = perception.localization, perception.localization.knowledge
            uncertainty = localization.place_uncertainty
            request = PlanRequest(
                object_at_rest.pose, perception.robot_pose, self._goal, localization.obj,
                self._progress.cone_fraction, *self._aim, uncertainty.position,
                knowledge.center_deviation, knowledge.contact_friction_deviation,
                uncertainty.slope, uncertainty.drift)
            if not self._progress.awaits_map(request, now):
                self._pending = request

    def _abort(self) -> None:
        """Give the task up for want of progress, and say what measurements have to do with it."""
        reason, failure = self._progress.abort_reason, self._progress.failure
        doubts = '; '.join(filter(None, (self._perception.pose_doubt,
                                         self._perception.odometry_doubt)))
        if not reason:
            self._fail(TaskFailure.NO_PROGRESS, doubts)
            return
        if failure is TaskFailure.NO_PROGRESS and doubts:
            reason = f'{reason}; {doubts}'
        self._enter(TaskState.FAILED, reason)
        self._entered = dataclasses.replace(self._entered, failure=failure)

    def _await_rest(self) -> None:
        """Say why the object does not come to rest, and give up after a while."""
        now = self._perception.time
        if self._moving_since is None:
            self._moving_since = now
        waited = now - self._moving_since
        if waited <= REST_REPORT_TIME:
            return
        reason = self._perception.unrest
        if self._unrest_time + waited <= REST_TIME_LIMIT:
            self._entered = dataclasses.replace(self._entered, reason=reason, is_requested=False)
            return
        self._fail(TaskFailure.NOT_AT_REST, reason)

    def _note_unrest(self) -> None:
        """End a wait for the object to rest; what only seemed to be rest begins no new one."""
        if self._moving_since is not None:
            waited = self._perception.time - self._moving_since
            self._unrest_time += waited if waited > REST_REPORT_TIME else 0.0
        self._moving_since = None

    def _inspect(self, object_at_rest: ObjectAtRest) -> None:
        """See an object that may be at its goal from another side, then check it again."""
        self._progress.count_inspection(object_at_rest)
        if self._progress.abort_reason:
            self._enter(TaskState.FAILED, self._progress.abort_reason)
            return
        self._enter(TaskState.RETREAT, 'the object has to be seen from another side')
        self._behavior = self._behaviors.inspection(self._perception)

    def _advance(self) -> None:
        state = self._entered.state
        if state is TaskState.PUSH and self._is_at_waypoint:
            self._progress.count_waypoint()
        elif state is TaskState.PUSH:
            self._progress.count_attempt()
        next_state = TRANSITIONS[state].success
        if next_state is TaskState.ALIGN and self._is_unsteered:
            # Such a push finds the contact by itself, without a stop before it.
            next_state = TaskState.PUSH
        self._enter(next_state)

    @property
    def _is_at_waypoint(self) -> bool:
        """Whether the object is where the plan of a push to a waypoint has it."""
        plan = self._plan
        if plan is None or plan.style is not PushStyle.WAYPOINT:
            return False
        end, pose = Pose(*plan.object_poses[-1].tolist()), self._perception.object_pose.pose
        return (distance(end, pose) < WAYPOINT_DISTANCE
                and abs(wrap_angle(end.theta - pose.theta)) < WAYPOINT_ANGLE)

    @property
    def _is_unsteered(self) -> bool:
        return self._plan is not None and self._plan.style.is_unsteered

    def _recover(self, failure_reason: str) -> None:
        self._progress.count_attempt(failure_reason)
        self._return(failure_reason)

    def _return(self, failure_reason: str) -> None:
        """Go to where a failure leads, and note that."""
        if self._entered.state in (TaskState.PLAN, TaskState.APPROACH):
            self._retry_time = self._perception.time + RETRY_TIME
        self._entered = dataclasses.replace(self._entered,
                                            recoveries=self._entered.recoveries + 1)
        self._enter(TRANSITIONS[self._entered.state].failure, failure_reason)

    def _restart(self, state: TaskState, reason: str) -> None:
        """Seek another plan, from a state in which the robot was."""
        self._enter(TaskState.PLAN if state.is_standing else TRANSITIONS[state].restart, reason,
                    is_requested=True)

    def _enter(self, state: TaskState, reason: str = '', *, is_requested: bool = False) -> None:
        if state is TaskState.PLAN and self._goal is None:
            # After the retreat of a task that was cancelled.
            state = TaskState.IDLE
        push, now = self._push_status(), self._perception.time
        if self._entered.state is TaskState.PUSH:
            self._progress.count_push(self._perception.repeats_pose)
        self._pending = None
        self._note_unrest()
        self._behavior = self._behaviors.create(state, self._plan, self._goal, self._perception)
        if state is TaskState.RETREAT:
            # An unsteered push ends at rest.
            settling_time = 0.0 if self._is_unsteered else SETTLING_TIME
            self._perception.restart_averaging(now + settling_time)
        pushes = self._entered.pushes
        if state is TaskState.PUSH:
            pushes += 1
            self._unrest_time = 0.0
        self._entered = dataclasses.replace(
            self._entered, state=state, reason=reason, since=now, push=push, pushes=pushes,
            is_requested=is_requested, failure=None,
            history=(*self._entered.history, StateChange(now, state, reason, is_requested)))

    def _push_status(self) -> ControllerStatus:
        """Status of the present push, or of the last one."""
        push = None if self._behavior is None else self._behavior.push_status
        return self._entered.push if push is None else push

    def _update_status(self, waiting_reason: str = '') -> None:
        self._reason_to_wait = waiting_reason
        self._status = None

    def _present_status(self) -> SupervisorStatus:
        entered, localization = self._entered, self._perception.localization
        return dataclasses.replace(
            entered, reason=self.reason, push=self._push_status(),
            is_requested=entered.is_requested and not self._hindrance,
            robot_pose=localization.pose if localization.is_initialized else None)
