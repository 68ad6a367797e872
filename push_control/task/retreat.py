"""The way off the object after a push."""

import math

from push_control.task.approach import PathExecution
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.signals import STOP
from push_navigation.path import Path, sample_path

SPACING = 0.02


class Retreat:
    """Goes straight off the object, where drive and map allow it."""

    def __init__(self, obj, robot, drive, supervision, occupancy_map=None):
        """
        Prepare.

        :param obj: the ``PushedObject``.
        :param robot: the ``RoundRobot``.
        :param drive: ``DriveSettings``.
        :param supervision: ``SupervisionSettings``.
        :param occupancy_map: the ``OccupancyMap``, or None.
        """
        self._parts, self._workspace = (obj, robot, drive), occupancy_map
        self._patience, self._travel = supervision.stall_timeout, None
        self.finished, self.failure_reason = False, ''

    def pause(self):
        """Stand; the next step sets out anew."""
        self._travel = None

    def step(self, perception, dt):
        """
        Compute the command.

        :param perception: ``TaskPerception`` of the robot, and of where the object was seen last.
        :param dt: time since the last call [s].
        :return: ``Twist``; STOP once there is ``failure_reason``.
        """
        _, robot, drive = self._parts
        if self._travel is None:
            way = retreat_path(*self._parts, perception.robot_pose,
                               perception.observation.object_pose.pose, self._workspace)
            if way is None:
                self.finished = True
                return STOP
            self._travel = PathExecution(robot, drive, way, self._patience)
        command = self._travel.step(perception.robot_pose, dt)
        self.finished, self.failure_reason = self._travel.finished, self._travel.failure_reason
        return command


def retreat_path(obj, robot, drive, robot_pose, object_pose, occupancy_map=None):
    """
    Find the straight way off an object.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param drive: ``DriveSettings``.
    :param robot_pose: ``Pose`` of the robot, at the object.
    :param object_pose: ``Pose`` of the object.
    :param occupancy_map: the ``OccupancyMap``, or None.
    :return: ``Path``, or None where the drive or the map allow none that leads away.
    """
    _, normal, gap = find_contact(obj, object_pose, robot_pose[:2], robot.radius)
    x, y, heading = robot_pose
    angles = (heading + math.pi, heading) if robot.drive == 'differential' else (
        normal + math.pi,)
    found = None
    for length in (drive.retreat_distance, 0.5 * drive.retreat_distance):
        for angle in angles:
            end = Pose(x + length * math.cos(angle), y + length * math.sin(angle), heading)
            way = Path((robot_pose, end))
            gain = find_contact(obj, object_pose, end[:2], robot.radius)[2] - gap
            if gain > 0.5 * length and _is_free(way, robot, drive, occupancy_map):
                found = found or way
    return found


def _is_free(way, robot, drive, occupancy_map):
    return occupancy_map is None or occupancy_map.robot_is_free(
        robot, sample_path(way, robot, SPACING), drive.map_clearance)
