"""
Where a push saw the robot, in comparison with where it was localized.

During a push the controller estimates the object's pose and the contact, and with them where the
robot must be. At its end that is compared with the localization, both at one time constant tau of
the drive after the last odometry (x, y, phi), with the mean twist (v, omega) of that time:

    e_xy = P_seen - offset t - ((x, y) + R(phi + tau omega / 2) tau v)
    e_phi = phi_seen - phi - tau omega

The ``offset``, to the left t of the push, is that of the contact. The controller cannot tell a
contact that is off to one side from a centre of friction that is off to the other: both rotate the
object. Where the centre is known from former pushes, the difference between the centre that the
controller sees and the known one is therefore an offset of the contact, and so of the robot.

The covariance is diagonal along the axes lateral (t), longitudinal and heading.
"""

import math
from typing import NamedTuple

import numpy as np
from push_control.laws.command import mean_twist
from push_control.push.status import ControllerStatus
from push_control.task.object_model import ObjectModelEstimator
from push_model.contact import find_contact
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_model.parameters import RoundRobot
from push_model.signals import Odometry, Twist

# Standard deviations of position [m] and heading [rad] of the robot as a push with a steady
# contact sees it; chosen.
POSITION_STD = 0.01
HEADING_STD = 0.01
# These grow by this factor for each slip and each loss of contact; chosen.
DISTURBANCE_FACTOR = 2


class LateralOffset(NamedTuple):
    """
    Offset of the robot across a push.

    :param direction: world angle of the lateral axis, to the left of the push [rad].
    :param offset: of the robot to that side, as seen minus true [m].
    :param deviation: standard deviation of that [m].
    """

    direction: float = 0.0
    offset: float = 0.0
    deviation: float = 0.0


class PushInnovation(NamedTuple):
    """
    Robot pose as seen by a push, minus that of the localization.

    :param error: (x, y, heading) in the world frame [m, m, rad].
    :param direction: world angle of the lateral axis, to the left of the push [rad].
    :param lateral_std: standard deviation of the position across the push [m].
    :param longitudinal_std: the same along the push [m].
    :param heading_std: standard deviation of the heading [rad].
    """

    error: tuple[float, float, float]
    direction: float
    lateral_std: float
    longitudinal_std: float
    heading_std: float

    @property
    def covariance(self) -> FloatArray:
        """Covariance of ``error``, shape (3, 3)."""
        c, s = math.cos(self.direction), math.sin(self.direction)
        # Columns: lateral, longitudinal, heading.
        axes = np.array([(c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)])
        deviations = np.array((self.lateral_std, self.longitudinal_std, self.heading_std))
        return axes @ np.diag(deviations ** 2) @ axes.T


def lateral_offset(object_model: ObjectModelEstimator, robot: RoundRobot,
                   status: ControllerStatus) -> LateralOffset:
    """
    Attribute what a push sees of the centre of friction to an offset of its contact.

    :param object_model: the ``ObjectModelEstimator``.
    :param robot: the ``RoundRobot``.
    :param status: ``ControllerStatus`` of the push.
    :return: ``LateralOffset``.
    """
    obj, pose, radius = object_model.obj, status.object_pose, robot.radius
    x, y, _ = status.robot_pose
    normal = find_contact(obj, pose, (x, y), radius).gamma
    point = pose.inverse().transform((x + radius * math.cos(normal),
                                      y + radius * math.sin(normal)))
    seen = object_model.lateral_innovation(point, status.friction_center)
    # On a round side the contact is off by less than the centre of the robot.
    ratio = 1.0 if obj.outline else 1.0 + radius / obj.radius
    return LateralOffset(seen.direction + pose.theta, ratio * seen.offset, ratio * seen.deviation)


def push_innovation(status: ControllerStatus, odometry: Odometry, command: Twist, lag: float,
                    offset: LateralOffset) -> PushInnovation:
    """
    Compare where a push saw the robot with where it was localized.

    :param status: ``ControllerStatus`` at the end of the push, one drive lag ahead.
    :param odometry: newest ``Odometry``, with the pose of the localization.
    :param command: last command.
    :param lag: tau, time constant of the drive [s].
    :param offset: ``LateralOffset`` of the contact.
    :return: ``PushInnovation``.
    """
    seen = status.robot_pose
    motion = mean_twist(odometry.twist, command, lag)
    x, y, heading = odometry.pose
    ahead_x, ahead_y = Pose(x, y, heading + 0.5 * lag * motion.omega).transform(
        (lag * motion.v_x, lag * motion.v_y))
    error = (seen.x - offset.offset * math.cos(offset.direction) - ahead_x,
             seen.y - offset.offset * math.sin(offset.direction) - ahead_y,
             wrap_angle(seen.theta - heading - lag * motion.omega))
    factor = deviation_factor(status)
    return PushInnovation(
        error, offset.direction, factor * math.hypot(POSITION_STD, offset.deviation),
        factor * POSITION_STD, factor * HEADING_STD)


def disturbances(status: ControllerStatus) -> int:
    """
    Count how often the contact of a push did not hold.

    :param status: ``ControllerStatus``.
    """
    return status.slips + status.contact_losses


def deviation_factor(status: ControllerStatus) -> int:
    """
    Find by how much less certain a push is than one with a steady contact.

    :param status: ``ControllerStatus``.
    :return: factor of its standard deviations.
    """
    return 1 + DISTURBANCE_FACTOR * disturbances(status)
