"""The pushed object as the controller models it at one contact, in numbers of a control step."""

import math

import numpy as np
from push_control.settings import ControlSettings
from push_control.steered import step_kernel
from push_control.steered.estimation.contact_site import initial_contact_site, RollingContact
from push_control.steered.estimation.filter_kernel import MEMORY_SIZE
from push_control.steered.estimation.limit_surface_table import LimitSurfaceTable
from push_control.steered.estimation.push_motion import MotionState, PushMotion
from push_control.steered.laws.contact_steering import SteeringCommand
from push_control.steered.path.guidance import Guidance
from push_control.steered.path.path import CurvatureLimits
from push_control.steered.step_kernel import (
    ANGLE, ARM, C_SQUARED, CENTER_AT_CONTACT, COMMAND, CONE_ANGLE, CONTACT, CONTACT_HEIGHT,
    COVARIANCE, EXPECTED, FEEDBACK_FRACTION, FLAT_NOW, FLAT_PREDICTED, FORCES, GOAL, INTERVAL,
    IS_DIFFERENTIAL, LIMITS_NOW, MAX_ERRORS, MAX_SPEED, MAX_YAW_RATE, NORMAL_NOW, NOT_FINITE,
    NOW, PATH_HOLDS, PREDICTED, PUSH_SIZE, ROLLING_GAIN, START_SPEED, STEP_SIZE,
    TIME_CONSTANT, ZETA, ZETA_HIGH, ZETA_LOW, ZETA_REST,
)
from push_dynamics.compiled import array_view, interpreted
from push_model.friction import friction_covariance, has_heights
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.quasi_static import (
    pushed_friction_center, SLIDING_COLUMNS, sliding_rows, Vehicle, vehicle, vehicle_along)
from push_model.signals import Twist
from push_model.trajectory import PushTrajectory


class ContactModel:
    """
    One robot at one contact of an object, and the push there at the present control step.

    ``is_differential``: whether the base is a differential drive. ``nominal``: the nominal object
    as ``Vehicle``, pushed at the start. ``center``: its centre of friction under the push (x, y)
    [m]. ``cone_angle``: half angle of the friction cone that feedback may use [rad]. ``motion``:
    ``PushMotion``. ``memory``: that of the filter, see ``filter_kernel``.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings,
                 target: PushTrajectory):
        """
        Model the contact that a target starts from.

        :raises ValueError: where this robot cannot push so at the target's contact.
        """
        self._obj = obj
        self._robot = robot
        self.is_differential = robot.drive == 'differential'
        site = initial_contact_site(obj, robot, target)
        if self.is_differential and site.kind != 'vertex':
            raise ValueError(f'target: got a contact of kind {site.kind!r} for a differential '
                             'drive, which cannot steer there, expected a vertex')
        self.nominal = vehicle(obj, site.point)
        self.center = pushed_friction_center(obj, site.point)
        supports = LimitSurfaceTable(obj, site.point)
        self.motion = PushMotion(robot.radius, site, supports)
        cone_angle = math.atan(settings.friction_fraction * obj.contact_friction_coefficient)
        self.cone_angle = settings.feedback_cone_fraction * cone_angle
        self._push: FloatArray = np.zeros(PUSH_SIZE)
        self._push[IS_DIFFERENTIAL] = self.is_differential
        self._push[MAX_SPEED], self._push[MAX_YAW_RATE] = robot.max_speed, robot.max_yaw_rate
        self._push[TIME_CONSTANT] = robot.time_constant + robot.dead_time
        self._push[ROLLING_GAIN] = settings.rolling_gain
        self._push[START_SPEED] = settings.start_speed
        self._push[CONE_ANGLE] = cone_angle
        self._push[FEEDBACK_FRACTION] = settings.feedback_cone_fraction
        self._push[MAX_ERRORS:COVARIANCE] = (settings.replan_lateral_error,
                                             settings.replan_heading_error)
        self._push[COVARIANCE:CONTACT_HEIGHT] = friction_covariance(obj)
        self._push[CONTACT_HEIGHT] = obj.contact_height
        self._push[FORCES:PUSH_SIZE] = supports.forces
        # Without heights loads stay as they are at rest, and none of these is read.
        rows = sliding_rows(obj) if has_heights(obj) else []
        self._supports: FloatArray = np.reshape(rows, (-1, SLIDING_COLUMNS))
        self._step: FloatArray = np.zeros(STEP_SIZE)
        # The same numbers, which Python reads by this view in a quarter of the time.
        self._view = array_view(self._step)
        self.memory: FloatArray = np.zeros(MEMORY_SIZE)
        self._limits: FloatArray = np.zeros(2)

    def initial_site(self, target: PushTrajectory) -> RollingContact:
        """
        Find the contact that another target starts from.

        :raises ValueError: where the robot does not touch the object there.
        """
        return initial_contact_site(self._obj, self._robot, target)

    def aim(self, goal: Pose) -> None:
        """
        Take the goal that the flat output refers to.

        :param goal: ``Pose`` of the object in the world.
        """
        self._push[GOAL:FORCES] = goal

    def look(self, memory: FloatArray, interval: float, guidance: Guidance) -> bool:
        """
        Look at the push at one control step, and project z ahead on its path.

        :param memory: of the filter, see ``filter_kernel``; of its ``RollingContact`` here.
        :param interval: from the time of its ``latest`` until now [s].
        :param guidance: ``Guidance``, the projection of which is written.
        :return: whether z is near its path, and that keeps to the limits.
        :raises ValueError: where the states are not finite, or the centre of friction is at the
            contact: nothing steers there.
        """
        self.memory = memory
        self._view[INTERVAL] = interval
        outcome = step_kernel.look(self._push, self._supports, memory, self._step, guidance.rows,
                                   guidance.projection)
        if outcome == NOT_FINITE:
            raise ValueError(f'state: got {self._step[NOW:NORMAL_NOW]}, expected finite numbers')
        if outcome == CENTER_AT_CONTACT:
            raise ValueError(f'center: got {self.predicted.center}, the point of contact, '
                             'expected a point apart from it')
        return outcome == PATH_HOLDS

    def stop(self) -> None:
        """Expect that the robot is commanded to stand until the next command."""
        self._step[COMMAND:EXPECTED] = 0.0

    @property
    def predicted(self) -> MotionState:
        """``MotionState`` one drive lag ahead."""
        return MotionState(*self._step[PREDICTED:NORMAL_NOW].tolist())

    @property
    def vehicle(self) -> Vehicle:
        """The object as ``Vehicle``, pushed at the contact ahead."""
        view = self._view
        return vehicle_along((view[CONTACT], view[CONTACT + 1]), view[ARM], view[ANGLE],
                             view[C_SQUARED])

    @property
    def flat_output_now(self) -> Pose:
        """``Pose`` of z now, in its goal frame: the frame of z where the object is at its goal."""
        view = self._view
        return Pose(view[FLAT_NOW], view[FLAT_NOW + 1], view[FLAT_NOW + 2])

    @property
    def flat_output(self) -> Pose:
        """The same one drive lag ahead."""
        view = self._view
        return Pose(view[FLAT_PREDICTED], view[FLAT_PREDICTED + 1], view[FLAT_PREDICTED + 2])

    @property
    def limits_now(self) -> CurvatureLimits:
        """``CurvatureLimits`` of feedback that the contact survives now."""
        return CurvatureLimits(self._view[LIMITS_NOW], self._view[LIMITS_NOW + 1])

    @property
    def zeta(self) -> float:
        """Angle from the line C->F to the contact normal now [rad]."""
        return self._view[ZETA]

    @property
    def zeta_rest(self) -> float:
        """Equilibrium of zeta on a straight path [rad]."""
        return self._view[ZETA_REST]

    @property
    def zeta_limits(self) -> tuple[float, float]:
        """Zeta at which the contact stays on its feature, (lowest, highest) [rad]."""
        return self._view[ZETA_LOW], self._view[ZETA_HIGH]

    def limits(self, cone_fraction: float) -> CurvatureLimits:
        """
        Curvatures that the contact survives one drive lag ahead.

        :param cone_fraction: fraction of the friction cone that may be used.
        """
        # Few new paths are drawn: machine code for this would take longer than all of them.
        interpreted(step_kernel.write_limits)(self._push, self.memory, self._step,
                                              cone_fraction, self._limits)
        return CurvatureLimits(*self._limits.tolist())

    def approach(self) -> Twist:
        """Compute the command that closes a gap slowly, along the contact normal."""
        interpreted(step_kernel.write_approach)(self._push, self.memory, self._step)
        return self._command

    def command(self, curvature: float, speed: float) -> SteeringCommand:
        """
        Compute the command that gives z a curvature.

        :param curvature: of z [1/m].
        :param speed: of the contact [m/s].
        """
        mode = step_kernel.write_command(self._push, self.memory, self._step, curvature, speed)
        return SteeringCommand(self._command, mode)

    @property
    def _command(self) -> Twist:
        view = self._view
        return Twist(view[COMMAND], view[COMMAND + 1], view[COMMAND + 2])

    def center_error_ratio(self) -> float:
        """Distance of the centre of friction from its nominal place, over that to the contact."""
        return math.dist(self.predicted.center, self.center) / self.nominal.arm
