"""A push at one instant, in world axes: where everything is that a sketch draws."""

import math
from typing import NamedTuple

from push_model.analysis.free_body import free_body
from push_model.contact import rolling_constants
from push_model.dynamics import Input, State
from push_model.friction import friction_center
from push_model.geometry import Pose
from push_model.parameters import PushedObject


class PushInstant(NamedTuple):
    """
    An object and a round robot that touch.

    :param obj: the ``PushedObject``.
    :param state: ``State``.
    :param inputs: ``Input``.
    :param robot_radius: R_p [m].
    :param object_radius: R_s, radius of curvature at the contact [m].
    """

    obj: PushedObject
    state: State
    inputs: Input
    robot_radius: float
    object_radius: float

    @property
    def pose(self):
        """``Pose`` of the object."""
        return Pose(*self.state[:3])

    @property
    def contact(self):
        """Contact point C [m]."""
        return self.pose.transform((self.state.c_x, self.state.c_y))

    @property
    def robot(self):
        """Centre P of the robot [m]."""
        x, y = self.contact
        return (x - self.robot_radius * math.cos(self.state.gamma),
                y - self.robot_radius * math.sin(self.state.gamma))

    @property
    def mass_centre(self):
        """Mass centre G [m]."""
        return self.pose.transform(self.obj.center_of_mass)

    @property
    def friction_centre(self):
        """Friction centre F [m]."""
        return self.pose.transform(friction_center(self.obj))

    @property
    def supports(self):
        """Support points [m]."""
        return tuple(self.pose.transform((foot.x, foot.y)) for foot in self.obj.supports)

    @property
    def forces(self):
        """``FreeBody`` of the object."""
        rolling = rolling_constants(self.robot_radius, self.object_radius)
        return free_body(self.obj, self.state, self.inputs, rolling)

    @property
    def push_angle(self):
        """World direction of the push [rad]."""
        return math.atan2(self.inputs.v_y, self.inputs.v_x)

    @property
    def alpha(self):
        """Angle from the line C to F to the push [rad]."""
        (x_c, y_c), (x_f, y_f) = self.contact, self.friction_centre
        return math.remainder(self.push_angle - math.atan2(y_f - y_c, x_f - x_c), 2.0 * math.pi)

    def along(self, direction, length):
        """
        Vector of a length along the contact normal (0) or the tangent (90 degrees).

        :param direction: from the normal [rad].
        :param length: [m].
        """
        return Pose(0.0, 0.0, self.state.gamma).rotate(
            (length * math.cos(direction), length * math.sin(direction)))


def at_turn(obj, location, turn, speed, robot=(0.0, 0.0), heading=0.0):
    """
    Place an object on the robot as a straight push has it, turned from the reference.

    :param obj: the ``PushedObject``.
    :param location: ``PushingLocation`` on it.
    :param turn: from the location's reference [rad].
    :param speed: of the push [m/s].
    :param robot: centre P of the robot [m].
    :param heading: world direction of the push [rad].
    :return: ``PushInstant``, the object not turning.
    :raises ValueError: for a turn at which the contact has left its face.
    """
    low, high = location.rotation_range
    if not low <= turn <= high:
        raise ValueError(f'turn: got {turn:.3g} rad, expected {low:.3g} to {high:.3g} rad: the '
                         'contact would leave its face')
    theta = heading + turn - location.push_direction
    gamma = heading - float(location.rho(turn))
    contact = (robot[0] + location.robot_radius * math.cos(gamma),
               robot[1] + location.robot_radius * math.sin(gamma))
    f_x, f_y = (float(part) for part in location.friction_center(turn))
    center = Pose(*contact, heading).transform((f_x, f_y))
    arm = Pose(0.0, 0.0, theta).rotate(friction_center(obj))
    pose = Pose(center[0] - arm[0], center[1] - arm[1], theta)
    state = State(*pose, 0.0, gamma, *pose.inverse().transform(contact))
    inputs = Input(speed * math.cos(heading), speed * math.sin(heading), 0.0, 0.0, 0.0)
    return PushInstant(obj, state, inputs, location.robot_radius, location.object_radius)
