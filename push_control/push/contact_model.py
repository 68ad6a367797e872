"""The pushed object as the controller models it at one contact: pure functions of the estimate."""

import functools
import math
from typing import NamedTuple

from push_control.estimation.contact_site import ContactSite, initial_contact_site
from push_control.estimation.limit_surface_table import LimitSurfaceTable
from push_control.estimation.push_motion import PushMotion, PushState
from push_control.laws.contact_steering import ContactSteering, SteeringCommand
from push_control.path.path import CurvatureLimits
from push_control.settings import ControlSettings
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.quasi_static import pushed_friction_center, Vehicle, vehicle
from push_model.trajectory import PushTrajectory


class PushStep(NamedTuple):
    """
    The push at one control step, as estimated.

    :param now: ``PushState`` now.
    :param ahead: ``PushState`` one drive lag ahead, where the command takes effect.
    :param site: the ``ContactSite``.
    :param vehicle: the object as ``Vehicle``, pushed at the contact ahead.
    :param normal_now: angle of the contact normal in the object frame now [rad].
    :param normal_ahead: the same one drive lag ahead [rad].
    """

    now: PushState
    ahead: PushState
    site: ContactSite
    vehicle: Vehicle
    normal_now: float
    normal_ahead: float

    def normal(self, state: PushState) -> float:
        """
        Contact normal in one of the two states.

        :param state: ``now`` or ``ahead``.
        :return: its angle in the object frame [rad].
        """
        return self.normal_ahead if state is self.ahead else self.normal_now

    def flat_output(self, state: PushState, goal: Pose) -> Pose:
        """
        Pose of z in its goal frame: the frame of z where the object is at its goal.

        :param state: ``now`` or ``ahead``.
        :param goal: ``Pose`` of the object at its goal, in the world.
        :return: ``Pose``.
        """
        x, y = state.pose.transform(self.vehicle.flat_output)
        goal_x, goal_y = goal.transform(self.vehicle.flat_output)
        to_goal = Pose(0.0, 0.0, -goal.theta - self.vehicle.angle)
        return Pose(*to_goal.rotate((x - goal_x, y - goal_y)), state.theta - goal.theta)


class ContactModel:
    """
    One robot at one contact of an object.

    ``is_differential``: whether the base is a differential drive. ``nominal``: the nominal object
    as ``Vehicle``, pushed at the start. ``center``: its centre of friction under the push (x, y)
    [m]. ``steering``: ``ContactSteering``. ``motion``: ``PushMotion``.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot, settings: ControlSettings,
                 target: PushTrajectory):
        """
        Model the contact that a target starts from.

        :param obj: the nominal ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param settings: ``ControlSettings``.
        :param target: the ``PushTrajectory``.
        :raises ValueError: where this robot cannot push so at the target's contact.
        """
        self._obj = obj
        self._robot = robot
        self.is_differential = robot.drive == 'differential'
        site = initial_contact_site(obj, robot, target)
        self.nominal = vehicle(obj, site.point)
        self.center = pushed_friction_center(obj, site.point)
        supports = LimitSurfaceTable(obj, site.point)
        self.steering = ContactSteering(obj, robot, settings, site, supports)
        self.motion = PushMotion(robot.radius, site, supports)
        # At a vertex all arguments stay the same until the next pose: one entry is enough.
        self._vehicle = functools.lru_cache(maxsize=1)(self._pushed_at)

    @property
    def time_constant(self) -> float:
        """Time constant of the robot's drive [s]."""
        return self._robot.time_constant

    def initial_site(self, target: PushTrajectory) -> ContactSite:
        """
        Find the contact that another target starts from.

        :param target: the ``PushTrajectory``.
        :return: ``ContactSite``.
        :raises ValueError: where the robot does not touch the object there.
        """
        return initial_contact_site(self._obj, self._robot, target)

    def step(self, now: PushState, ahead: PushState, site: ContactSite) -> PushStep:
        """
        Look at the push at one control step.

        :param now: ``PushState`` now.
        :param ahead: ``PushState`` one drive lag ahead.
        :param site: the ``ContactSite`` as it is by now.
        :return: ``PushStep``.
        """
        x, y, normal_ahead = site.contact_at(ahead.phi - ahead.theta)
        pushed = self._vehicle((x, y), (ahead.p_x, ahead.p_y), ahead.q)
        normal_now = site.contact_at(now.phi - now.theta).normal
        return PushStep(now, ahead, site, pushed, normal_now, normal_ahead)

    def limits(self, step: PushStep, state: PushState, cone_fraction: float) -> CurvatureLimits:
        """
        Curvatures that the contact survives.

        :param step: ``PushStep``.
        :param state: its ``now`` or ``ahead``.
        :param cone_fraction: fraction of the friction cone that may be used.
        :return: ``CurvatureLimits``.
        """
        return self.steering.limits(step.site, step.vehicle, step.normal(state), cone_fraction)

    def command(self, step: PushStep, curvature: float, speed: float) -> SteeringCommand:
        """
        Compute the command that gives z a curvature.

        :param step: ``PushStep``.
        :param curvature: of z [1/m].
        :param speed: of the contact [m/s].
        :return: ``SteeringCommand``.
        """
        return self.steering.command(step.site, step.vehicle, step.normal_ahead, step.ahead,
                                     curvature=curvature, speed=speed)

    def center_error_ratio(self, state: PushState) -> float:
        """
        How far the centre of friction is from its nominal place.

        :param state: ``PushState``.
        :return: distance over that from the contact.
        """
        return math.dist(state.center, self.center) / self.nominal.arm

    def _pushed_at(self, point: tuple[float, float], center: tuple[float, float],
                   c_squared_log: float) -> Vehicle:
        """See the object as a vehicle, with centre of friction and c^2 as estimated."""
        return vehicle(self._obj, point, center).with_c_squared_ratio(math.exp(c_squared_log))
