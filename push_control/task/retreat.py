"""The way off the object after a push."""

import math

from push_control.task.approach import Travel
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.signals import STOP
from push_navigation.path import sampled, Way

SPACING = 0.02


class Retreat:
    """Goes straight off the object, where drive and map allow it."""

    def __init__(self, obj, robot, drive, supervision, workspace=None):
        """
        Prepare.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        :param workspace: the ``Workspace``, or None.
        """
        self._parts, self._workspace = (obj, robot, drive), workspace
        self._patience, self._travel = supervision.stall_time, None
        self.finished, self.trouble = False, ''

    def halt(self):
        """Stand; the next step sets out anew."""
        self._travel = None

    def step(self, sight, dt):
        """
        Compute the command.

        :param sight: ``Sight`` of the robot, and of where the object was seen last.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is ``trouble``.
        """
        _, robot, drive = self._parts
        if self._travel is None:
            way = retreat_way(*self._parts, sight.robot_pose,
                              sight.observation.object_pose.pose, self._workspace)
            if way is None:
                self.finished = True
                return STOP
            self._travel = Travel(robot, drive, way, self._patience)
        command = self._travel.step(sight.robot_pose, dt)
        self.finished, self.trouble = self._travel.finished, self._travel.trouble
        return command


def retreat_way(obj, robot, drive, robot_pose, object_pose, workspace=None):
    """
    Find the straight way off an object.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param drive: ``DriveSettings``.
    :param robot_pose: ``Pose`` of the robot, at the object.
    :param object_pose: ``Pose`` of the object.
    :param workspace: the ``Workspace``, or None.
    :return: ``Way``, or None where the drive or the map allow none that leads away.
    """
    _, normal, gap = find_contact(obj, object_pose, robot_pose[:2], robot.radius)
    x, y, heading = robot_pose
    angles = (heading + math.pi, heading) if robot.drive == 'differential' else (
        normal + math.pi,)
    found = None
    for length in (drive.retreat, 0.5 * drive.retreat):
        for angle in angles:
            end = Pose(x + length * math.cos(angle), y + length * math.sin(angle), heading)
            way = Way((robot_pose, end))
            gain = find_contact(obj, object_pose, end[:2], robot.radius)[2] - gap
            if gain > 0.5 * length and _is_free(way, robot, drive, workspace):
                found = found or way
    return found


def _is_free(way, robot, drive, workspace):
    return workspace is None or workspace.robot_is_free(
        robot, sampled(way, robot, SPACING), drive.map_clearance)
