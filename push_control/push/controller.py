"""The controller that the node runs: which phase, whether it may move, and why not."""

import dataclasses

from push_control.estimation.monitors import is_finite_odometry, measurement_fault
from push_control.laws.closed_form import ClosedFormLaw
from push_control.laws.mpc import PredictiveLaw
from push_control.push.closed_loop import ClosedLoopPush
from push_control.push.open_loop import OpenLoopPush
from push_control.push.start import start_fault
from push_model.geometry import Pose
from push_model.signals import STOP

PHASES = ('idle', 'pushing', 'waiting', 'done', 'failed')


@dataclasses.dataclass(frozen=True)
class ControllerStatus:
    """
    What the controller does, and why; errors are those of its estimate.

    :param phase: one of ``PHASES``.
    :param reason: one sentence, empty while all is well.
    :param position_error: distance of the object from its goal [m].
    :param heading_error: object heading less that of the goal [rad].
    :param remaining_distance: way of the flat point that is left [m].
    :param travelled_distance: way of the contact since the start [m].
    :param friction_center: estimate in the object frame (x, y) [m].
    :param push_direction: estimated effective robot heading [rad].
    :param object_pose: estimated ``Pose`` of the object, one drive lag ahead.
    :param robot_pose: ``Pose`` of the robot at that time, as it must be to touch the object.
    :param in_contact: whether the robot is seen to touch the object.
    :param replan: why a push has failed that a plan from there may bring to its goal, else empty.
    :param path_replans: number of new paths.
    :param reapproaches: number of new approaches near the goal.
    :param slips: number of times that the contact was seen to slide.
    :param contact_losses: number of times that the object was seen to be out of touch.
    :param rejected_poses: number of measurements that did not fit.
    :param solver_failures: number of times that the closed-form law stood in for the solver.
    :param solver_reason: why it did so last, empty while it did not.
    """

    phase: str = 'idle'
    reason: str = ''
    position_error: float = 0.0
    heading_error: float = 0.0
    remaining_distance: float = 0.0
    travelled_distance: float = 0.0
    friction_center: tuple = (0.0, 0.0)
    push_direction: float = 0.0
    object_pose: Pose = Pose(0.0, 0.0, 0.0)
    robot_pose: Pose = Pose(0.0, 0.0, 0.0)
    in_contact: bool = True
    replan: str = ''
    path_replans: int = 0
    reapproaches: int = 0
    slips: int = 0
    contact_losses: int = 0
    rejected_poses: int = 0
    solver_failures: int = 0
    solver_reason: str = ''


class Controller:
    """Calls the law of the settings, and stops the robot when it must."""

    def __init__(self, obj, robot, settings):
        """
        Stand idle.

        :param obj: the ``PushedObject`` as believed.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        """
        self._parts = obj, robot, settings
        self._law = None
        if settings.control_law == 'mpc':
            self._law = PredictiveLaw(robot, settings)
        elif settings.control_law == 'feedback':
            self._law = ClosedFormLaw(settings)
        self.reset()

    def reset(self):
        """Forget the target and everything measured."""
        self._target = self._push = self._stamps = self._pose_time = None
        self._phase, self._reason, self._command = 'idle', '', STOP

    @property
    def status(self):
        """The present ``ControllerStatus``."""
        report = {} if self._push is None else self._push.report
        return ControllerStatus(self._phase, self._reason, **report)

    def step(self, target, observation, dt):
        """
        Answer a measurement; the same observation again gets the same answer.

        :param target: ``PushTrajectory`` in the world frame, or None; a new one starts anew,
            unless it starts at the push that is under way.
        :param observation: ``Observation``.
        :param dt: time since the last step [s].
        :return: ``Twist`` in the robot's axes.
        :raises ValueError: where dt is negative or not finite.
        """
        if not 0.0 <= dt < float('inf'):
            raise ValueError(f'dt: got {dt!r}, expected a finite time of at least 0 [s]')
        if target is not self._target:
            if not self._goes_on(target, observation):
                self.reset()
            self._target = target
        if target is None or self._phase in ('done', 'failed'):
            return STOP
        if observation.stamps != self._stamps:
            self._stamps = observation.stamps
            self._command = self._answer(observation, dt)
        return self._command

    def _goes_on(self, target, observation):
        if target is None or not (self._phase == 'pushing' or self.status.replan):
            return False
        try:
            kept = self._push.continue_with(target, observation)
        except ValueError:
            # It is said when the push begins anew.
            return False
        self._phase = 'pushing' if kept else self._phase
        return kept

    def _answer(self, observation, dt):
        open_loop = self._law is None
        measured = observation.object_pose
        if measured is not None and measured.pose.is_finite():
            self._pose_time = measured.time
        if not open_loop:
            self._reason = measurement_fault(observation, self._pose_time, self._parts[2])
        if self._reason:
            return self._wait(observation.odometry)
        if self._push is None:
            try:
                self._push = (OpenLoopPush(*self._parts, self._target, observation) if open_loop
                              else ClosedLoopPush(*self._parts, self._law, self._target,
                                                  observation))
            except ValueError as error:
                self._reason = str(error)
            self._reason = self._reason or start_fault(
                *self._parts[1:], self._target, observation)
            if self._reason:
                self._phase = 'failed'
                return STOP
        self._phase = 'pushing'
        self._push.observe(observation)
        command = self._push.advance(observation.time, dt)
        if self._push.failure:
            self._phase, self._reason = 'failed', self._push.failure
        elif self._push.finished:
            self._phase = 'done'
        else:
            self._reason = self._push.notice
        return command

    def _wait(self, odometry):
        self._phase = 'waiting'
        if self._push is not None:
            self._push.pause(odometry if is_finite_odometry(odometry) else None)
        return STOP


def make_controller(obj, robot, settings):
    """
    Make the controller of a robot.

    :param obj: the ``PushedObject`` as believed; its friction may be wrong.
    :param robot: the ``RoundRobot``.
    :param settings: ``ControlSettings``.
    :return: ``Controller``.
    """
    return Controller(obj, robot, settings)
