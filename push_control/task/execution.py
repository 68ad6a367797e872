"""
Execution of a task: the state that it is in, and the behaviour that acts in it.

``TaskStateMachine`` has the states, ``StandReasons`` what keeps the robot from moving in any of
them, and one ``Behavior`` each commands the robot. A step updates perception, then stands or lets
the behaviour act, and changes the state once that has ended. A ``BehaviorFactory`` says which
states and behaviours there are: those of repeated pushes, or of a single one.
"""

import math
from typing import Any, NamedTuple

from push_base.push_force import force_warning
from push_control.behaviors.behavior import Abort, Behavior, MeasurementNeed, NoPushNeeded, Stand
from push_control.behaviors.failures import BehaviorFailure, FailureReport
from push_control.behaviors.progress import ProgressMonitor
from push_control.events import PerceptionEvent, TaskEvent
from push_control.goal import TaskFailure, TaskGoal
from push_control.perception.object_at_rest import has_moved
from push_control.perception.object_knowledge import ObjectKnowledge
from push_control.perception.raw_perception import RawPerception
from push_control.perception.view import UNSEEN_TIME
from push_control.settings import ControlSettings
from push_control.steered.status import ControllerStatus
from push_control.supervision_settings import aimed_tolerances, SupervisionSettings
from push_control.task.behavior_factory import BehaviorFactory
from push_control.task.stand_reasons import StandCause, StandReason, StandReasons
from push_control.task.state_machine import TaskStateMachine, Transitions
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.events import AnyReport, codes, Report, sentence
from push_model.geometry import Pose
from push_model.observation import Observation, Stamps
from push_model.outlook import Outlook
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import ObjectEstimate, STOP, Twist
from push_model.trajectory import PushTrajectory
from push_navigation.settings import DriveSettings
from push_safety.status import SafetyReport

# Time after the end of a steered push from which on the object may be at rest [s]; chosen: longer
# than the latency of its poses (0.08 s in the scenarios), and than it slides on.
SETTLING_TIME = 0.3
# What shows that the robot is too weak for the object.
TOO_WEAK = (BehaviorFailure.WHEELS_SPIN, BehaviorFailure.OBJECT_UNYIELDING,
            BehaviorFailure.BASE_STALLS)
# Ends of a task that an earlier fault of measurements or base may be behind.
CONSEQUENCES = (TaskFailure.NO_PLAN, TaskFailure.NO_PROGRESS, TaskFailure.TOO_HEAVY,
                TaskFailure.PUSH_FAILED)


class _Answer(NamedTuple):
    """The last command, the times of the measurements that it answers, and whose it is."""

    stamps: Stamps | None = None
    command: Twist = STOP
    behavior: Behavior[Any] | None = None


class _StatedOutlook(NamedTuple):
    """An ``Outlook`` and the time of the plan that stated it [s]."""

    outlook: Outlook
    time: float


class TaskExecution:
    """Answers measurements with commands."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, control: ControlSettings,
                 drive: DriveSettings, supervision: SupervisionSettings, *,
                 factory: type[BehaviorFactory] | None = None,
                 knowledge: ObjectKnowledge | None = None) -> None:
        """
        Stand idle.

        :param factory: class of the ``BehaviorFactory``; None for repeated pushes.
        :param knowledge: what was learned of the object in previous tasks, or None.
        """
        if factory is None:
            # Imported here: it takes a while, and a single push does without.
            from push_control.task.repeated_pushes import RepeatedPushBehaviors as factory
        self._behaviors: BehaviorFactory = factory(obj, robot, control, drive, supervision)
        supervision = self._behaviors.supervision
        self._progress = ProgressMonitor(supervision, aimed_tolerances(control, supervision))
        self._perception: RawPerception = self._behaviors.new_perception(-math.inf)
        if knowledge is not None:
            self._perception.start_from(knowledge)
        self._force_warning = force_warning(obj, robot)
        self._machine = TaskStateMachine(factory.table)
        self._reasons = StandReasons()
        self._behavior: Behavior[Any] = Stand()
        self._goal: TaskGoal | None = None
        self._plan: PushTrajectory | None = None
        # Of the last plan to the present goal.
        self._stated: _StatedOutlook | None = None
        # That localization has started over, until a push has moved the object.
        self._restart: Report[TaskEvent] | None = None
        # Whether the robot has touched the object elsewhere, until a push has moved it.
        self._has_run_into_object = False
        # Whether what it pushes has stopped the robot just now, and it backs off.
        self._backs_off = False
        # Why the safety layer last stopped the robot in this task.
        self._last_stop: SafetyReport | None = None
        # That a robot which was elsewhere has touched the object in this task, the first time.
        self._lost_touch: AnyReport | None = None
        # Status of the last push that has ended.
        self._last_push = ControllerStatus()
        self._answer = _Answer()

    def rehearse(self) -> None:
        """Compile or load now what a task would wait for; nothing that is known changes."""
        self._behaviors.rehearse()

    # What is known.

    @property
    def perception(self) -> RawPerception:
        """Perception of robot and object: a ``TaskPerception`` in repeated pushes."""
        return self._perception

    @property
    def object_estimate(self) -> ObjectEstimate | None:
        """The present ``ObjectEstimate``; None where there is none."""
        return self._behavior.object_estimate or self._perception.object_estimate

    @property
    def status(self) -> SupervisorStatus:
        """The present ``SupervisorStatus``, made where it is read."""
        machine, perception = self._machine, self._perception
        cause = self.cause
        return SupervisorStatus(
            state=machine.state, reason=sentence(cause), since=machine.since,
            pushes=machine.pushes, recoveries=machine.recoveries, history=machine.history,
            push=self._push_status,
            robot_pose=perception.robot_pose if perception.is_localized else None,
            is_requested=machine.is_requested and cause is machine.cause,
            failure=machine.failure, codes=codes(cause),
            goal_deviation=perception.goal_deviation, outlook=self._outlook)

    @property
    def _outlook(self) -> Outlook | None:
        """What remains of the outlook of the last plan; None once the goal has ended."""
        if self._stated is None or self.state.is_final or self.state is TaskState.IDLE:
            return None
        return self._stated.outlook.later(self._perception.time - self._stated.time)

    @property
    def state(self) -> TaskState:
        """The present ``TaskState``."""
        return self._machine.state

    @property
    def history(self) -> tuple[StateChange, ...]:
        """``StateChange`` of every state since the goal was set."""
        return self._machine.history

    @property
    def recoveries(self) -> int:
        """Number of failures recovered from for this goal."""
        return self._machine.recoveries

    @property
    def cause(self) -> AnyReport | None:
        """``Report`` of why the state is as it is; None while all is well."""
        stand_reason = self._stand_reason
        if stand_reason is not None:
            return stand_reason.report
        cause = self._behavior.waiting_cause or self._machine.cause
        if self.state is TaskState.PUSH:
            cause = cause or self._behavior.push_cause
        elif not self.state.is_standing:
            cause = cause or self._perception.pose_inconsistency
        return cause

    @property
    def reason(self) -> str:
        """The cause in one sentence, empty while all is well."""
        return sentence(self.cause)

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the base was stopped, and the robot stands until ``resume`` or a goal."""
        reason = self._stand_reason
        return self._behavior.awaits_resume or (
            reason is not None and reason.cause is StandCause.AWAITS_RESUME)

    @property
    def _stand_reason(self) -> StandReason | None:
        """Why a robot with a task under way has to stand, or None."""
        if self.state.is_standing:
            return None
        if self._behavior.handles_stops:
            return next(iter(self._reasons.holds), None)
        return self._reasons.first(self._perception.time)

    @property
    def _push_status(self) -> ControllerStatus:
        """Status of the present push, or of the last one."""
        present = self._behavior.push_status
        return self._last_push if present is None else present

    @property
    def _is_straight(self) -> bool:
        return self._plan is not None and self._plan.style.is_straight

    def _set_plan(self, plan: PushTrajectory) -> None:
        """Keep a plan, and what it states."""
        self._plan = plan
        self._stated = None if plan.outlook is None else _StatedOutlook(
            plan.outlook, self._perception.time)

    # From a measurement to a command.

    def step(self, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement; the same observation again gets the same answer, or a stop.

        :param observation: ``Observation``, with odometry as it comes.
        :param dt: time since the last step [s].
        :raises ValueError: where dt is negative or not finite.
        """
        if not 0.0 <= dt < math.inf:
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        answer = self._answer
        if observation.stamps != answer.stamps or self._behavior is not answer.behavior:
            self._update_perception(observation)
            self._update_stand_reasons()
            stand_reason = self._stand_reason
            command = self._act(dt) if stand_reason is None else self._stand(stand_reason)
            self._answer = _Answer(observation.stamps, command, self._behavior)
            self._perception.add_command(command, observation.time)
        elif self._stand_reason is not None:
            return STOP
        return self._answer.command

    def _update_perception(self, observation: Observation) -> None:
        """Take the measurements in; start over where the robot was put elsewhere."""
        starts_over = self._perception.is_robot_elsewhere and not self._reasons.is_stopped
        if starts_over:
            knowledge = self._perception.knowledge
            self._perception = self._behaviors.new_perception(observation.odometry.time)
            if knowledge is not None:
                self._perception.start_from(knowledge)
        self._perception.update(observation)
        if self._perception.pop_relocation() and not (starts_over or self.state.is_standing):
            self._enter(TaskState.PLAN, TaskEvent.RELOCATED.report())
        if not starts_over:
            return
        self._restart = TaskEvent.STARTED_OVER.report()
        if self.state.is_standing:
            self._machine.note(self._perception.time, self._restart)
        else:
            self._enter(TaskState.PLAN, self._restart)

    def _update_stand_reasons(self) -> None:
        """Check the measurements that the behaviour needs."""
        need, perception = self._behavior.measurement_need, self._perception
        if need is MeasurementNeed.NONE:
            self._reasons.forget_measurements()
            return
        fault = perception.measurement_fault(
            needs_object=need is MeasurementNeed.ODOMETRY_AND_OBJECT)
        self._reasons.on_measurements(fault, perception.time)

    def _stand(self, reason: StandReason) -> Twist:
        """Wait, and give the task up where that takes too long."""
        self._behavior.pause()
        if reason.failure is not None:
            self._abort(reason.failure, TaskEvent.ABORTED.report(reason=reason.report))
        elif self._must_look(reason):
            self._recover(reason.report)
        return STOP

    def _must_look(self, reason: StandReason) -> bool:
        """Tell whether the robot has to look for an object that should be in its view."""
        perception = self._perception
        return (perception.has_limited_view and reason.cause is StandCause.MEASUREMENTS
                and reason.duration > UNSEEN_TIME
                and perception.measurement_fault(needs_object=False) is None)

    def _act(self, dt: float) -> Twist:
        """Let the behaviour act, and leave it once it has ended."""
        behavior, perception = self._behavior, self._perception
        failure = behavior.on_bumped(perception) if perception.has_bumped else None
        command = STOP if failure is not None else behavior.step(perception, dt)
        failure = failure or behavior.failure
        if failure is not None:
            self._end_after_failure(failure)
            return STOP
        if behavior.finished:
            self._advance()
        return command

    # From state to state.

    @property
    def _transitions(self) -> Transitions:
        """Transitions of the present state, in which the robot acts."""
        return self._machine.table.transitions[self.state]

    def _advance(self) -> None:
        """Go on to the state that the end of the behaviour leads to."""
        result = self._behavior.result
        if isinstance(result, Abort):
            self._abort(*result)
        elif result is NoPushNeeded.REACHED:
            self._enter(TaskState.DONE, self._done_cause)
        elif result is NoPushNeeded.OUT_OF_VIEW:
            self._enter(TaskState.LOOK)
        elif result is NoPushNeeded.UNSEEN:
            self._enter(TaskState.RETREAT, TaskEvent.OBJECT_UNSEEN.report())
            self._behavior = self._behaviors.inspection(self._perception)
        elif not self._plans_next_goal():
            self._enter(self._next_state())

    @property
    def _done_cause(self) -> AnyReport | None:
        """Uncertainty of a task that is done; None where the tolerances bound it."""
        deviation = self._perception.goal_deviation
        if deviation is None:
            return None
        return TaskEvent.DONE_BY_ODOMETRY.report(
            position=1e3 * deviation.position, heading=math.degrees(deviation.heading))

    def _next_state(self) -> TaskState:
        """Find the state after a behaviour that has ended well."""
        next_state = self._transitions.success
        if self.state is TaskState.PUSH and not next_state.is_final and self._plan is not None:
            self._count_finished_push(self._plan, self._perception.object_pose.pose)
        if next_state is TaskState.ALIGN and self._is_straight:
            # Such a push finds the contact by itself, without a stop before it.
            return TaskState.PUSH
        if self.state is TaskState.RETREAT and self._perception.has_limited_view:
            return TaskState.LOOK
        return next_state

    def _count_finished_push(self, plan: PushTrajectory, object_pose: Pose) -> None:
        """Count a push that has ended well; one that has moved the object was where it seemed."""
        if has_moved(Pose(*plan.object_poses[0].tolist()), object_pose, self._progress.settings):
            self._restart = None
            self._has_run_into_object = False
        self._progress.count_finished_push(
            plan, object_pose, None if self._goal is None else self._goal.pose)

    def _plans_next_goal(self) -> bool:
        """Plan from rest to a goal that has come during the push; tell whether there is one."""
        goal = self._behavior.next_goal
        if goal is None:
            return False
        self._goal = goal
        self._stated = None
        self._start_task()
        self._enter(TaskState.PLAN, TaskEvent.NEW_GOAL.report(), is_requested=True)
        return True

    def _start_task(self) -> None:
        """Start the history of another task."""
        self._machine.start_task()
        self._last_stop = self._lost_touch = None

    def _end_after_failure(self, failure: FailureReport) -> None:
        """Go on after a failure, unless it has shown that the object is too heavy."""
        if failure.code is BehaviorFailure.OBJECT_NOT_MOVED:
            failure = self._explained(failure)
        elif failure.code is BehaviorFailure.BASE_STALLS:
            failure = self._progress.hold_up or failure
        if failure.code in TOO_WEAK and self._progress.count_spin(failure):
            self._abort(TaskFailure.TOO_HEAVY, self._too_heavy_report(failure))
            return
        if failure.code is BehaviorFailure.HELD_UP:
            # One too many ends the task after the retreat, so that the robot presses no more.
            self._progress.count_hold_up(failure)
        self._recover(failure)

    def _explained(self, failure: FailureReport) -> FailureReport:
        """Tell why an object does not move: the robot touches it and is too weak, or elsewhere."""
        if self._force_warning:
            return BehaviorFailure.WHEELS_SPIN.report()
        if self._perception.is_object_unyielding:
            return BehaviorFailure.OBJECT_UNYIELDING.report()
        return self._progress.last_spin or failure

    def _too_heavy_report(self, failure: FailureReport) -> Report[TaskEvent]:
        """Report an object that is too heavy, or is not where its poses or the robot seem."""
        cause = TaskEvent.ABORTED.report(reason=failure)
        inconsistency = self._perception.pose_inconsistency or self._restart
        if self._force_warning or inconsistency is None:
            return cause
        if (self._progress.is_light or self._perception.have_poses_jumped
                or self._has_run_into_object):
            # The object was moved before, or touched elsewhere: that is no matter of weight.
            return TaskEvent.ABORTED.report(reason=PerceptionEvent.INCONSISTENCIES.report(
                first=inconsistency, second=failure))
        return TaskEvent.ABORTED_INCONSISTENT.report(abort=cause, inconsistency=inconsistency)

    def _recover(self, cause: AnyReport, failure: TaskFailure = TaskFailure.PUSH_FAILED) -> None:
        """Count a failure as an attempt, and go to where it leads."""
        self._has_run_into_object |= cause.code is BehaviorFailure.RAN_INTO_OBJECT
        if cause.code is BehaviorFailure.LOST_ROBOT_TOUCHES and self._lost_touch is None:
            # What it did before, it did elsewhere, and it has displaced the object unawares.
            self._lost_touch = cause
            self._restart_progress()
        self._progress.count_attempt(cause)
        if not self._plans_next_goal():
            self._enter_after_failure(cause, failure)

    def _restart_progress(self) -> None:
        """Count attempts from zero, and progress from where the object is now."""
        self._progress = ProgressMonitor(self._progress.settings, self._progress.aim)

    def _enter_after_failure(self, cause: AnyReport, failure: TaskFailure) -> None:
        if self.state in (TaskState.PLAN, TaskState.APPROACH):
            self._progress.delay_request(self._perception.time)
        next_state = self._transitions.failure
        if next_state is TaskState.FAILED:
            self._abort(failure, cause)
            return
        self._machine.count_recovery()
        self._enter(next_state, cause)

    def _abort(self, failure: TaskFailure | None, cause: AnyReport) -> None:
        if failure in CONSEQUENCES:
            cause = self._with_disturbance(cause)
        self._enter(TaskState.FAILED, cause, failure=failure)

    def _with_disturbance(self, cause: AnyReport) -> AnyReport:
        """Add what was wrong with measurements or base in this task, unless that is said."""
        disturbance = self._perception.pose_jump or self._lost_touch or self._last_stop
        if disturbance is None or disturbance.code in cause.codes or any(
                isinstance(code, PerceptionEvent) for code in cause.codes):
            return cause
        return TaskEvent.ABORTED_AFTER.report(abort=cause, disturbance=disturbance)

    def _enter(self, state: TaskState, cause: AnyReport | None = None, *,
               is_requested: bool = False, failure: TaskFailure | None = None) -> None:
        """Change the state, and start its behaviour."""
        perception = self._perception
        if state in (TaskState.PLAN, TaskState.LOOK) and self._goal is None:
            # After the retreat of a task that was cancelled.
            state = TaskState.IDLE
        self._last_push = self._push_status
        if self.state is TaskState.PUSH:
            self._progress.count_push(perception.repeats_pose,
                                      have_poses_jumped=perception.have_poses_jumped)
        elif self.state is TaskState.PLAN and state is TaskState.LOOK:
            perception.restart_averaging(perception.time)
        self._behavior = self._behaviors.create(
            state, self._plan, self._goal, perception, self._progress)
        if state is TaskState.RETREAT:
            # A straight push ends at rest.
            settling_time = 0.0 if self._is_straight else SETTLING_TIME
            perception.restart_averaging(perception.time + settling_time)
        self._machine.enter(
            state, perception.time, cause, is_requested=is_requested, failure=failure)
