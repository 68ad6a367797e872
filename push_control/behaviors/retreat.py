"""Retreat: drive straight off the object after a push."""

import math

from push_control.behaviors.behavior import BehaviorContext, MeasurementNeed
from push_control.behaviors.path_execution import PathBehavior
from push_control.perception.raw_perception import RawPerception
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_navigation.path import Path, sample_path

# Spacing at which a path is checked against the map [m]; chosen: below the cells of a map.
SPACING = 0.02
# Part of its length by which a retreat must widen the gap, to lead off the object; chosen: it is
# then within 60 degrees of the contact normal.
MIN_GAP_RATIO = 0.5
# The same of a longer path that leads off slantwise, where no other does, as after a contact that
# has rolled to where the robot passes the object; chosen: within 80 degrees of the normal.
MIN_SLANTED_GAP_RATIO = 0.17
# Angles to the contact normal in which a holonomic base leaves, in order [rad]; chosen: the widest
# that still lead off, and one between; beside a wall behind the robot one of them is free.
LEAVING_ANGLES = tuple(math.radians(angle) for angle in (0.0, 30.0, -30.0, 58.0, -58.0, 78.0,
                                                         -78.0))
# Standard deviations of the robot's place by which it keeps clear of obstacles of a map.
CERTAIN_SIGMAS = 2.0
# What a robot nearer to obstacles than that may come nearer still, and the least clearance that it
# keeps then [m]; chosen: a few degrees off a wall beside which it has pushed, and the error of a
# map.
NEARER, LEAST_CLEARANCE = 0.005, 0.01


class Retreat(PathBehavior[RawPerception]):
    """Drives straight off the object, where drive and map allow it."""

    measurement_need = MeasurementNeed.ODOMETRY

    def __init__(self, context: BehaviorContext, distance: float, end_speed: float = 0.0) -> None:
        """
        Start.

        :param distance: how far to drive [m].
        :param end_speed: speed with which the robot passes the end, 0 where it stops there [m/s].
        """
        super().__init__(context, end_speed)
        self._distance = distance

    def plan(self, perception: RawPerception) -> Path | None:
        """
        Find the straight path off the object.

        :return: ``Path``, or None where drive or map allow none that leads away.
        """
        if not perception.has_pose_after(-math.inf):
            return None
        return retreat_path(self.context, perception.robot_pose, perception.expected_object_pose,
                            self._distance, perception.position_deviation)


def retreat_path(context: BehaviorContext, robot_pose: Pose, object_pose: Pose,
                 retreat_distance: float, deviation: float = 0.0) -> Path | None:
    """
    Find the straight path off an object; half as long or slantwise where no other is free.

    A robot that stands near an obstacle already need not keep farther from it.

    :param robot_pose: ``Pose`` of the robot, at the object.
    :param retreat_distance: length of the path [m].
    :param deviation: standard deviation of the robot's place [m].
    :return: ``Path``, or None where drive or map allow none that leads away.
    """
    margin = max(context.drive.map_clearance, CERTAIN_SIGMAS * deviation)
    path = _clear_path(context, robot_pose, object_pose, retreat_distance, margin)
    occupancy_map = context.occupancy_map
    if path is not None or occupancy_map is None:
        return path
    clearance = float(occupancy_map.clearance([robot_pose[:2]])[0]) - context.robot.radius
    nearer = max(LEAST_CLEARANCE, clearance - NEARER)
    if nearer >= margin:
        return None
    return _clear_path(context, robot_pose, object_pose, retreat_distance, nearer)


def _clear_path(context: BehaviorContext, robot_pose: Pose, object_pose: Pose,
                retreat_distance: float, margin: float) -> Path | None:
    """Find the path, with a distance to obstacles of the map."""
    robot = context.robot
    _, normal, gap = find_contact(context.obj, object_pose, robot_pose[:2], robot.radius)
    x, y, heading = robot_pose
    directions = [normal + math.pi + angle for angle in LEAVING_ANGLES]
    if robot.drive == 'differential':
        directions = [heading + math.pi, heading]
    attempts = ((retreat_distance, MIN_GAP_RATIO), (0.5 * retreat_distance, MIN_GAP_RATIO),
                (2.0 * retreat_distance, MIN_SLANTED_GAP_RATIO))
    limit = context.drive.reverse_limit if robot.drive == 'differential' else math.inf
    for full_length, ratio in attempts:
        length = min(full_length, limit)
        for direction in directions:
            end = Pose(x + length * math.cos(direction), y + length * math.sin(direction), heading)
            path = Path((robot_pose, end))
            gain = find_contact(context.obj, object_pose, end[:2], robot.radius).gap - gap
            if gain > ratio * length and _is_free(path, context, margin):
                return path
    return None


def _is_free(path: Path, context: BehaviorContext, margin: float) -> bool:
    occupancy_map, robot = context.occupancy_map, context.robot
    return occupancy_map is None or occupancy_map.robot_is_free(
        robot, sample_path(path, robot, SPACING), margin)
