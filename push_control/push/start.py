"""Where robot and contact are at the start of a plan, and whether the robot stands there."""

import math

from push_control.events import EventReport, PushEvent
from push_model.geometry import distance, Pose, wrap_angle


def robot_start_pose(target, pose):
    """
    Place the robot for a push of an object that stands elsewhere than planned.

    :param target: the ``PushTrajectory``.
    :param pose: ``Pose`` of the object.
    :return: ``Pose`` of the robot.
    """
    planned = Pose(*target.object_poses[0].tolist())
    return pose @ planned.inverse() @ Pose(*target.robot_poses[0].tolist())


def contact_start_point(target):
    """
    Find where a push begins on the object.

    :param target: the ``PushTrajectory``.
    :return: contact in the object frame (x, y) [m].
    """
    planned = Pose(*target.object_poses[0].tolist())
    return planned.inverse().transform(target.contact_poses[0][:2].tolist())


def start_fault(robot, settings, target, observation) -> EventReport | None:
    """
    Say how far the robot stands from the start of a plan, and where it should.

    :param robot: the ``RoundRobot``.
    :param settings: ``ControlSettings``.
    :param target: the ``PushTrajectory``.
    :param observation: ``Observation``.
    :return: ``EventReport``, or None where it stands near enough.
    """
    if observation.object_pose is None:
        return None
    pose, place = observation.object_pose.pose, observation.odometry.pose
    meant = robot_start_pose(target, pose)
    away, turn = distance(meant, place), wrap_angle(place.theta - meant.theta)
    aside = robot.radius * abs(turn) if robot.drive == 'differential' else 0.0
    if max(away, aside) <= settings.start_tolerance:
        return None
    return PushEvent.ROBOT_NOT_AT_START.report(
        distance=away, rotation=math.degrees(turn), x=meant.x, y=meant.y,
        heading=wrap_angle(meant.theta))
