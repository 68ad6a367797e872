"""The start of a plan: where robot and contact are there, and whether the robot stands there."""

import math

from push_control.settings import ControlSettings
from push_model.events import EventReport, PushEvent
from push_model.geometry import distance, Pose, wrap_angle
from push_model.observation import Observation
from push_model.parameters import RoundRobot
from push_model.trajectory import PushTrajectory

# Distance and rotation of the object from the start of a plan up to which it is followed from
# where the object is [m], [rad]; chosen: the controller corrects as much on the first metre.
MAX_OBJECT_OFFSET = 0.25
MAX_OBJECT_ROTATION = 0.5


def robot_start_pose(target: PushTrajectory, pose: Pose) -> Pose:
    """
    Place the robot for a push of an object that stands elsewhere than planned.

    :param pose: ``Pose`` of the object in the world.
    :return: ``Pose`` of the robot in the world.
    """
    planned = Pose(*target.object_poses[0].tolist())
    return pose @ planned.inverse() @ Pose(*target.robot_poses[0].tolist())


def contact_start_point(target: PushTrajectory) -> tuple[float, float]:
    """
    Find where a push begins on the object.

    :return: contact in the object frame (x, y) [m].
    """
    planned = Pose(*target.object_poses[0].tolist())
    return planned.inverse().transform(target.contact_poses[0][:2].tolist())


def start_fault(robot: RoundRobot, settings: ControlSettings, target: PushTrajectory,
                observation: Observation) -> EventReport | None:
    """
    Tell how far object or robot stand from the start of a plan, and where the robot must stand.

    :return: ``EventReport``, or None where both stand near enough.
    """
    if observation.object_pose is None:
        return None
    planned, measured = Pose(*target.object_poses[0].tolist()), observation.object_pose.pose
    moved, turned = distance(planned, measured), wrap_angle(measured.theta - planned.theta)
    if moved > MAX_OBJECT_OFFSET or abs(turned) > MAX_OBJECT_ROTATION:
        return PushEvent.OBJECT_NOT_AT_START.report(distance=moved,
                                                    rotation=math.degrees(turned))
    here = observation.odometry.pose
    start = robot_start_pose(target, observation.object_pose.pose)
    offset = distance(start, here)
    rotation = wrap_angle(here.theta - start.theta)
    # A differential drive cannot correct its heading while it pushes.
    rim_offset = robot.radius * abs(rotation) if robot.drive == 'differential' else 0.0
    if max(offset, rim_offset) <= settings.start_tolerance:
        return None
    return PushEvent.ROBOT_NOT_AT_START.report(
        distance=offset, rotation=math.degrees(rotation), x=start.x, y=start.y,
        heading=wrap_angle(start.theta))
