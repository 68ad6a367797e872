"""A push at one instant, in world axes: the points, forces and angles that a sketch shows."""

import math
from typing import Any, NamedTuple

from push_model.contact import rolling_constants
from push_model.dynamics import Input, State
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from studies.analysis.free_body import free_body, FreeBody
from studies.analysis.pushing_location import PushingLocation

Point = tuple[float, float]


class PushInstant(NamedTuple):
    """
    An object and a round robot in contact.

    :param obj: the pushed object.
    :param state: pose, yaw rate and contact of the object.
    :param inputs: motion imposed at the contact.
    :param robot_radius: R_p [m].
    :param object_radius: R_s, radius of curvature of the object at the contact [m].
    """

    obj: PushedObject
    state: State
    inputs: Input
    robot_radius: float
    object_radius: float

    @property
    def pose(self) -> Pose:
        """Pose of the object."""
        return Pose(*self.state[:3])

    @property
    def contact(self) -> Point:
        """Contact point C [m]."""
        return self.pose.transform((self.state.c_x, self.state.c_y))

    @property
    def robot(self) -> Point:
        """Centre P of the robot [m]."""
        x, y = self.contact
        return (x - self.robot_radius * math.cos(self.state.gamma),
                y - self.robot_radius * math.sin(self.state.gamma))

    @property
    def mass_center(self) -> Point:
        """Centre of mass G [m]."""
        return self.pose.transform(self.obj.center_of_mass)

    @property
    def friction_center(self) -> Point:
        """Centre of friction F [m]."""
        return self.pose.transform(friction_center(self.obj))

    @property
    def supports(self) -> tuple[Point, ...]:
        """Support points [m]."""
        return tuple(self.pose.transform((support.x, support.y)) for support in self.obj.supports)

    @property
    def forces(self) -> FreeBody:
        """All forces on the object."""
        rolling = rolling_constants(self.robot_radius, self.object_radius)
        return free_body(self.obj, self.state, self.inputs, rolling)

    @property
    def push_angle(self) -> float:
        """World direction of the push [rad]."""
        return math.atan2(self.inputs.v_y, self.inputs.v_x)

    @property
    def rho(self) -> float:
        """Pushing angle, from the contact normal to the push [rad]."""
        return self.push_angle - self.state.gamma

    @property
    def alpha(self) -> float:
        """Angle from the line C to F to the push [rad]."""
        (x_c, y_c), (x_f, y_f) = self.contact, self.friction_center
        return math.remainder(self.push_angle - math.atan2(y_f - y_c, x_f - x_c), 2.0 * math.pi)

    def from_normal(self, angle: float, length: float) -> Point:
        """
        Return a vector at an angle from the contact normal.

        :param angle: 0 along the normal n, 90 degrees along the tangent t [rad].
        :param length: [m].
        :return: (x, y) in world axes [m].
        """
        return Pose(0.0, 0.0, self.state.gamma).rotate(
            (length * math.cos(angle), length * math.sin(angle)))


def instant_at_rotation(obj: PushedObject, location: PushingLocation, rotation: float,
                        speed: float, heading: float = 0.0) -> PushInstant:
    """
    Place a rotated object on a robot at the origin that moves straight ahead.

    :param obj: the pushed object, which has no yaw rate.
    :param location: where it is pushed.
    :param rotation: of the object from the location's reference, rolled on the robot [rad].
    :param speed: of the push [m/s].
    :param heading: world direction of the push [rad].
    :return: the instant.
    :raises ValueError: for a rotation at which the contact has left its face.
    """
    low, high = location.rotation_range
    if not low <= rotation <= high:
        raise ValueError(f'rotation: got {rotation:.3g} rad, expected {low:.3g} to {high:.3g} '
                         'rad: the contact would leave its face')
    theta = heading + rotation - location.push_direction
    gamma = heading - float(location.rho(rotation))
    contact = (location.robot_radius * math.cos(gamma), location.robot_radius * math.sin(gamma))
    f_x, f_y = (float(coordinate) for coordinate in location.friction_center(rotation))
    center = Pose(*contact, heading).transform((f_x, f_y))
    arm = Pose(0.0, 0.0, theta).rotate(friction_center(obj))
    pose = Pose(center[0] - arm[0], center[1] - arm[1], theta)
    state = State(*pose, 0.0, gamma, *pose.inverse().transform(contact))
    return PushInstant(obj, state, straight_inputs(speed, heading), location.robot_radius,
                       location.object_radius)


def straight_inputs(speed: float, direction: float) -> Input:
    """
    Make the input of constant velocity by a robot that does not rotate.

    :param speed: of the contact [m/s].
    :param direction: of its velocity, world [rad].
    :return: the input.
    """
    v_x: Any = speed * math.cos(direction)
    v_y: Any = speed * math.sin(direction)
    return Input(v_x, v_y, 0.0, 0.0, 0.0)
