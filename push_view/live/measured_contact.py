"""Contact of robot and object as they are measured, with the force that a simulator states."""

import math

from push_model.contact import contact_point, find_contact
from push_model.geometry import Pose
from push_model.parameters import PushedObject, RoundRobot

# Time for which a force is shown [s]; chosen: three periods of the simulator's.
FORCE_TIME = 0.3
UNKNOWN = (math.nan,) * 6


class MeasuredContact:
    """
    The contact, and the last force in it.

    :param obj: the nominal ``PushedObject``.
    :param robot: the ``RoundRobot``.
    """

    def __init__(self, obj: PushedObject, robot: RoundRobot) -> None:
        self._object = obj
        self._robot_radius = robot.radius
        self._force = (0.0, 0.0)
        self._force_time = -math.inf

    def on_force(self, time: float, force: tuple[float, float]) -> None:
        """
        Take note of a force of the robot on the object.

        :param time: when it came [s].
        :param force: (f_x, f_y), axes of the object frame [N].
        """
        self._force_time, self._force = time, force

    def values(self, time: float, object_pose: Pose | None,
               robot_pose: Pose) -> tuple[float, ...]:
        """
        Find out what a row shows.

        :param time: of the row [s].
        :param object_pose: measured ``Pose``; None before the first.
        :param robot_pose: measured ``Pose``.
        :return: force along the normal and along the tangent [N], nan where none was stated; place
            of the contact (x, y) [m]; angle of the normal [rad]; gap [m].
        """
        if object_pose is None:
            return UNKNOWN
        nearest = find_contact(self._object, object_pose, robot_pose, self._robot_radius)
        point = object_pose.transform(contact_point(self._object, nearest.contact))
        force = (math.nan, math.nan)
        if 0.0 <= time - self._force_time <= FORCE_TIME:
            f_x, f_y = object_pose.rotate(self._force)
            c, s = math.cos(nearest.gamma), math.sin(nearest.gamma)
            force = (c * f_x + s * f_y, c * f_y - s * f_x)
        return (*force, *point, nearest.gamma, nearest.gap)
