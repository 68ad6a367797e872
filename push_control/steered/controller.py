"""The controller of a push: which phase it is in, and whether the robot may move."""

import math
from typing import NamedTuple

from push_control.perception.measurement_faults import is_finite_odometry, measurement_fault
from push_control.perception.measurement_watch import MeasurementWatch
from push_control.settings import ControlSettings
from push_control.steered.closed_loop import ClosedLoopPush
from push_control.steered.execution import plain_status, PushExecution
from push_control.steered.laws.closed_form import ClosedFormLaw
from push_control.steered.laws.own_law import OwnLaw
from push_control.steered.laws.steering_law import SteeringLaw
from push_control.steered.open_loop import OpenLoopPush
from push_control.steered.start import start_fault
from push_control.steered.status import ControllerStatus, Phase
from push_model.events import EventReport, PushEvent
from push_model.observation import Observation, Stamps
from push_model.optional import is_casadi_installed
from push_model.parameters import PushedObject, RoundRobot
from push_model.signals import STOP, Twist
from push_model.trajectory import PushTrajectory
from push_safety.status import SafetyReport


# Time for which a push that has begun waits for measurements [s]; chosen: longer than an occlusion
# by somebody who passes, and shorter than anybody's patience.
WAITING_TIME_LIMIT = 20.0
# Stops by the safety layer in one push at which it fails; chosen: as many as end a task.
MAX_SAFETY_STOPS = 3


class _State(NamedTuple):
    """State of the controller, and its notice."""

    phase: Phase = Phase.IDLE
    event: EventReport | None = None


class _Answer(NamedTuple):
    """The last command, and the times of the measurements that it answers."""

    stamps: Stamps | None = None
    command: Twist = STOP


class _SafetyStop(NamedTuple):
    """
    The last stop by the safety layer.

    :param report: why it holds the robot, or None where the robot may move.
    :param stop_count: number of stops of this push.
    :param command: the last one before it.
    :param time: when that was sent [s].
    """

    report: SafetyReport | None = None
    stop_count: int = 0
    command: Twist = STOP
    time: float = 0.0


class Controller:
    """
    Answers every measurement with a command that pushes the object along a target.

    Waits while measurements are stale or broken, or the safety layer holds the robot, and goes on
    from where object and robot are then. Stops for good once the push is done or has failed.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings):
        """
        Stand idle.

        :param obj: the nominal ``PushedObject``; its friction may be wrong.
        """
        self._obj = obj
        self._robot = robot
        self._settings = settings
        self._law = make_steering_law(robot, settings)
        self.reset()

    def reset(self) -> None:
        """Forget the target and everything measured."""
        self._target: PushTrajectory | None = None
        self._push: PushExecution | None = None
        # That has requested the present target, where this could not be taken up without a start.
        self._failed_push: PushExecution | None = None
        self._pose_time: float | None = None
        self._watch = MeasurementWatch()
        self._stop = _SafetyStop()
        self._state = _State()
        self._answer = _Answer()

    @property
    def phase(self) -> Phase:
        """The present ``Phase``."""
        return self._state.phase

    @property
    def event(self) -> EventReport | None:
        """``EventReport`` of what is out of the ordinary; None while all is well."""
        return self._state.event

    @property
    def awaits_resume(self) -> bool:
        """Tell whether the robot stands until ``resume``."""
        stop = self._stop.report
        return stop is not None and stop.code.awaits_resume and not self.phase.has_ended

    @property
    def replan_requested(self) -> bool:
        """Tell whether the push has failed where another plan may bring the object to its goal."""
        return self._push is not None and self._push.replan_requested

    @property
    def status(self) -> ControllerStatus:
        """The present ``ControllerStatus``, made where it is read: the above cost less."""
        if self._push is None:
            return plain_status(*self._state)
        return self._push.status(*self._state)

    def step(self, target: PushTrajectory | None, observation: Observation, dt: float) -> Twist:
        """
        Answer a measurement; the same observation again gets the same answer.

        :param target: ``PushTrajectory`` in the world frame, or None; a new one resets the
            controller, unless it starts at the push that is under way.
        :param dt: time since the last step [s].
        :return: ``Twist`` in the robot's axes.
        :raises ValueError: where dt is negative or not finite.
        """
        if not 0.0 <= dt < math.inf:
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        if target is not self._target:
            if target is None or not self._continues_with(target, observation):
                failed = self._push if self.replan_requested else None
                self.reset()
                self._failed_push = failed
            self._target = target
        if target is None or self._state.phase.has_ended:
            return STOP
        if observation.stamps != self._answer.stamps:
            self._answer = _Answer(observation.stamps, self._command(target, observation, dt))
        return self._answer.command

    def on_safety_report(self, fault: SafetyReport | None, stop: SafetyReport | None) -> None:
        """
        Take note of what the safety layer has found; called before the step with that odometry.

        A push that it stops goes on once it may, unless that was too often, or it has no feedback;
        where the base was stopped, once somebody lets it.

        :param fault: not read: where the robot is stopped for it, that says so.
        :param stop: why the robot is stopped, or None where it may move.
        """
        is_new = stop is not None and self._stop.report is None
        self._stop = self._stop._replace(report=stop)
        if stop is None or self._push is None or self._state.phase.has_ended:
            return
        if is_new:
            stamps, command = self._answer
            # That a base was stopped is found after stops that were counted for it.
            count = self._stop.stop_count + (not stop.code.awaits_resume)
            self._stop = _SafetyStop(stop, count, command, 0.0 if stamps is None else stamps[0])
        if self._law is None:
            self._state = _State(Phase.FAILED, PushEvent.SAFETY_STOP.report(reason=stop))
        elif self._stop.stop_count >= MAX_SAFETY_STOPS:
            self._state = _State(Phase.FAILED, PushEvent.STOPPED_TOO_OFTEN.report(
                count=self._stop.stop_count, reason=stop))

    def resume(self) -> None:
        """Go on with a push after a stop of the base."""
        if self.awaits_resume:
            self._stop = _SafetyStop()
            self._watch = MeasurementWatch()

    def pause(self, observation: Observation) -> None:
        """Stand in place of a step, without regard to measurements; the next step goes on."""
        self._watch = MeasurementWatch()
        if self._push is not None:
            odometry = observation.odometry
            self._push.pause(odometry if is_finite_odometry(odometry) else None)

    def _continues_with(self, target: PushTrajectory, observation: Observation) -> bool:
        """Change over to a target that starts at the present push, if it does."""
        phase = self._state.phase
        if self._push is None or not (phase is Phase.PUSHING or self._push.replan_requested):
            return False
        try:
            continued = self._push.continue_with(target, observation)
        except ValueError:
            # The push that then starts from rest reports it.
            return False
        failure = self._push.failure
        if continued and failure is None:
            self._state = self._state._replace(phase=Phase.PUSHING)
        elif continued:
            self._state = _State(Phase.FAILED, failure)
        return continued

    def _command(self, target: PushTrajectory, observation: Observation, dt: float) -> Twist:
        """Wait, start a push or go on with it, whichever the measurements allow."""
        fault = self._measurement_fault(observation)
        if self._stop.report is not None:
            fault = PushEvent.SAFETY_STOP.report(reason=self._stop.report)
        if self._push is not None:
            if fault is None:
                self._push.observe(observation)
                fault = self._push.pose_fault(observation.time)
            fault = self._watch.update(fault, observation.time)
        if fault is not None:
            return self._wait(fault, observation)
        if self._push is None:
            fault = self._start(target, observation)
        if self._push is None or fault is not None:
            self._state = _State(Phase.FAILED, fault)
            return STOP
        # After a gap, as while code is compiled, the robot speeds up from where it was.
        command = self._push.advance(observation.time, min(dt, self._settings.odometry_timeout))
        if self._push.failure is not None:
            self._state = _State(Phase.FAILED, self._push.failure)
        elif self._push.finished:
            self._state = _State(Phase.DONE)
        else:
            self._state = _State(Phase.PUSHING, self._push.notice)
        return command

    def _measurement_fault(self, observation: Observation) -> EventReport | None:
        """Tell why the measurements cannot be used; open loop uses none."""
        measured = observation.object_pose
        if measured is not None and measured.pose.is_finite():
            self._pose_time = measured.time
        if self._law is None:
            return None
        return measurement_fault(observation, self._pose_time, self._settings)

    def _start(self, target: PushTrajectory, observation: Observation) -> EventReport | None:
        """Start a push; tell why it cannot be done."""
        try:
            if self._law is None:
                self._push = OpenLoopPush(self._robot, self._settings, target)
            else:
                self._push = ClosedLoopPush(self._obj, self._robot, self._settings, self._law,
                                            target, observation)
                if isinstance(self._failed_push, ClosedLoopPush):
                    self._push.retry_after(self._failed_push, target)
        except ValueError as error:
            return PushEvent.TARGET_REFUSED.report(error=error)
        return (self._push.failure
                or start_fault(self._robot, self._settings, target, observation))

    def _wait(self, fault: EventReport, observation: Observation) -> Twist:
        """Stand while the measurements cannot be used, for a while."""
        self._state = _State(Phase.WAITING, fault)
        odometry = observation.odometry
        if self._stop.report is not None and self._stop.report.code.is_of_odometry:
            odometry = odometry._replace(twist=self._coasting_twist(observation.time))
        if self._push is not None:
            self._push.pause(odometry if is_finite_odometry(odometry) else None)
        if (self._watch.waited(observation.time) > WAITING_TIME_LIMIT
                and not self.awaits_resume):
            self._state = _State(Phase.FAILED, PushEvent.GAVE_UP_WAITING.report(
                limit=WAITING_TIME_LIMIT, reason=fault))
        return STOP

    def _coasting_twist(self, time: float) -> Twist:
        """Velocity of a robot that comes to rest, where odometry cannot tell."""
        lag = self._robot.time_constant
        ratio = math.exp(-max(0.0, time - self._stop.time) / lag) if lag > 0.0 else 0.0
        return Twist(*(ratio * value for value in self._stop.command))


def make_steering_law(robot: RoundRobot, settings: ControlSettings) -> SteeringLaw | None:
    """
    Make the law that the settings name.

    :return: ``SteeringLaw``; None for open loop.
    :raises ValueError: where it needs what is not installed, or is no law.
    """
    if settings.control_law == 'mpc':
        if not is_casadi_installed():
            raise ValueError("control_law: got 'mpc', which needs casadi, expected 'feedback' or "
                             "'open_loop' where that is not installed")
        # Imported here: the other laws need neither casadi nor scipy.
        from push_control.steered.laws.mpc import PredictiveLaw
        return PredictiveLaw(robot, settings)
    if settings.control_law == 'feedback':
        return ClosedFormLaw(settings)
    if settings.control_law == 'open_loop':
        return None
    return OwnLaw(robot, settings)
