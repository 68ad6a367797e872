"""The supervisor of a task: approach, touch, push, retreat, until the object is at its goal."""

import dataclasses

from push_control.task.behaviors import BehaviorFactory
from push_control.task.perception import TaskPerception
from push_control.task.progress import ProgressMonitor
from push_control.task.status import StateChange, SupervisorStatus, TaskState
from push_model.geometry import Pose
from push_model.plan_request import PlanRequest
from push_model.signals import STOP

AT_OBJECT = (TaskState.ALIGN, TaskState.PUSH, TaskState.RETREAT)
FOLLOWING = {TaskState.APPROACH: TaskState.ALIGN, TaskState.ALIGN: TaskState.PUSH,
             TaskState.PUSH: TaskState.RETREAT, TaskState.RETREAT: TaskState.PLAN}
SETTLING = 0.3


class Supervisor:
    """Answers measurements with commands, and says where from a plan is wanted."""

    def __init__(self, obj, robot, control, drive, supervision):
        """
        Stand idle.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param control: ``ControlSettings``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        """
        self._settings, self._tries = supervision, ProgressMonitor(supervision)
        self._legs = BehaviorFactory(obj, robot, control, drive, supervision)
        self._sight = TaskPerception(control, supervision)
        self._goal = self._target = self._leg = self._resume = None
        self._wants, self._asked, self._waiting = None, 0.0, ''
        self._stamps, self._command, self._status = None, STOP, SupervisorStatus()

    @property
    def plan_request(self):
        """The plan that is ``PlanRequest``, or None."""
        return self._wants

    @property
    def status(self):
        """The present ``SupervisorStatus``."""
        push = self._leg.status if self._status.state == TaskState.PUSH else self._status.push
        return dataclasses.replace(
            self._status, reason=self._waiting or self._status.reason or (
                push.reason if self._status.state == TaskState.PUSH else ''),
            robot_pose=self._sight.robot_pose, push=push)

    def set_goal(self, pose):
        """
        Begin a task, whatever is under way.

        :param pose: ``Pose`` wanted for the object; None for no task.
        :raises ValueError: where it is not finite.
        """
        if pose is None:
            return self.stop('has no goal')
        if not Pose(*pose).is_finite():
            raise ValueError(f'goal: got {pose}, expected three finite numbers')
        self._goal, self._tries = Pose(*pose), ProgressMonitor(self._settings)
        self._status = dataclasses.replace(self._status, pushes=0, recoveries=0, history=())
        if self._status.state != TaskState.PAUSED:
            self._begin_anew('has a new goal')

    def set_map(self, occupancy_map):
        """
        Take a map, for the next way.

        :param occupancy_map: the ``OccupancyMap``, or None.
        """
        self._legs.occupancy_map = occupancy_map
        self._tries.look_anew()

    def take(self, trajectory):
        """
        Take the plan that was wanted; one that was not is ignored.

        :param trajectory: ``PushTrajectory``; the robot may stand anywhere.
        """
        if self._wants is None:
            return
        self._target = trajectory
        self._tries.look_anew()
        self._enter(TaskState.APPROACH)

    def on_planning_failed(self, reason):
        """
        Hear that there is no plan.

        :param reason: one sentence.
        """
        if self._wants is not None:
            self._sight.look_anew(self._sight.time)
            self._tries.on_planning_failed(self._wants, reason)
            self._recover(f'no plan: {reason}')

    def pause(self):
        """Stand until told to resume."""
        if not self._status.state.is_standing:
            self._resume = self._status.state
            self._enter(TaskState.PAUSED)

    def resume(self):
        """Go on after a pause: what was planned is planned anew."""
        if self._status.state == TaskState.PAUSED:
            self._begin_anew('goes on')

    def stop(self, reason):
        """
        Give up the task and stand.

        :param reason: one sentence.
        """
        self._goal = None
        self._enter(TaskState.IDLE, reason)

    def step(self, observation, dt):
        """
        Answer a measurement; the same observation again gets the same answer.

        :param observation: ``Observation``, odometry as it comes.
        :param dt: time since the last step [s].
        :return: ``Twist`` in the robot's axes.
        :raises ValueError: where dt is negative or not finite.
        """
        if not 0.0 <= dt < float('inf'):
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        if observation.stamps != self._stamps:
            self._stamps = observation.stamps
            self._sight.take(observation)
            self._command = self._answer(dt)
        return self._command

    def _answer(self, dt):
        state = self._status.state
        self._waiting = ''
        if state.is_standing:
            return STOP
        if state != TaskState.PUSH:
            self._waiting = self._sight.failure_reason(blind=state == TaskState.RETREAT)
        if self._waiting or state == TaskState.PLAN:
            if self._leg is not None:
                self._leg.pause()
            return STOP if self._waiting else self._plan()
        command = self._leg.step(self._sight, dt)
        if self._leg.failure_reason:
            self._recover(self._leg.failure_reason)
            return STOP
        if self._leg.finished:
            self._next(state)
        return command

    def _plan(self):
        object_at_rest, now = self._sight.object_at_rest, self._sight.time
        if object_at_rest is None or object_at_rest.duration < self._settings.min_averaging_time:
            return STOP
        if self._wants is not None:
            if now - self._asked > self._settings.plan_timeout:
                self._recover(f'no plan came within {self._settings.plan_timeout:g} s')
            return STOP
        verdict = self._tries.check_goal(object_at_rest, self._goal)
        if verdict == 'reached':
            self._enter(TaskState.DONE)
        elif verdict == 'off' and self._tries.abort_reason:
            self._enter(TaskState.FAILED, self._tries.abort_reason)
        elif verdict == 'off':
            self._legs.correct_overlap(self._sight)
            self._wants = PlanRequest(object_at_rest.pose, self._sight.robot_pose, self._goal,
                                      self._legs.object_model.obj, self._tries.cone_fraction)
            self._asked = now
        return STOP

    def _next(self, state):
        if state == TaskState.PUSH:
            self._tries.count()
        self._enter(FOLLOWING[state])

    def _recover(self, failure_reason):
        self._tries.count(failure_reason)
        self._status = dataclasses.replace(self._status, recoveries=self._status.recoveries + 1)
        # A retreat that fails is not tried again: a way to elsewhere may lead off the object.
        at_contact = self._status.state in (TaskState.ALIGN, TaskState.PUSH)
        self._enter(TaskState.RETREAT if at_contact else TaskState.PLAN, failure_reason)

    def _begin_anew(self, reason):
        state = self._resume if self._status.state == TaskState.PAUSED else self._status.state
        self._enter(TaskState.RETREAT if state in AT_OBJECT else TaskState.PLAN, reason)

    def _enter(self, state, reason=''):
        status, time = self.status, self._sight.time
        self._wants, self._waiting = None, ''
        self._leg = self._legs.create(state, self._target, self._sight)
        if state == TaskState.RETREAT:
            self._sight.look_anew(time + SETTLING)
        self._status = dataclasses.replace(
            self._status, state=state, reason=reason, since=time, push=status.push,
            pushes=status.pushes + (state == TaskState.PUSH),
            history=(*status.history, StateChange(time, state, reason)))
