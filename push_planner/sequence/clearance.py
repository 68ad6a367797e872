"""Clearance of push sequences in a map: neither object nor robot meets an obstacle."""

import math
from typing import NamedTuple, Sequence

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.plan_request import PlanFailure
from push_model.trajectory import PushTrajectory
from push_navigation.obstacle import inflate
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.settings import DriveSettings
from push_planner.problem import PlanningFailed
from push_planner.sequence.kinematics import IntArray, object_poses_along, SequenceMotions
from push_planner.sequence.primitives import PrimitiveTable
from push_planner.sequence.search import ClearancePenalty
from push_planner.sequence.steps import SequenceStep

# Fractions of the clearance of the settings that the object keeps, the first that start and goal
# allow.
MARGIN_FRACTIONS = (1.0, 0.5, 0.0)
# Poses on each segment, for a coarse look and a fine one.
COARSE_SAMPLES = 4
FINE_SAMPLES = 8
# Time per clearance that is missing [s/m], chosen: 1 cm counts as 5 s, about the time of a push of
# half a metre.
PENALTY_RATE = 500.0


class _MapPoses(NamedTuple):
    """
    Poses of the object in the frame of the map, arrays of one shape.

    :param x: along columns [m].
    :param y: along rows [m].
    :param c: cosine of the orientation.
    :param s: sine of it.
    """

    x: FloatArray
    y: FloatArray
    c: FloatArray
    s: FloatArray


class _InnerCircle(NamedTuple):
    """
    A circle inside the object.

    :param x: middle in the object frame, x [m].
    :param y: middle in the object frame, y [m].
    :param radius: [m].
    """

    x: float
    y: float
    radius: float


class ClearanceCheck:
    """
    A map with an object that is to be pushed from start to goal in it.

    The object's margin is what start and goal allow, at most that of the settings.

    :param occupancy_map: the ``OccupancyMap``.
    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param start: ``Pose`` of the object in the world.
    :param goal: goal ``Pose`` of the object in the world.
    :param drive: ``DriveSettings``.
    :raises PlanningFailed: where start or goal is not free.
    """

    def __init__(self, occupancy_map: OccupancyMap, obj: PushedObject, robot: RoundRobot,
                 start: Pose, goal: Pose, drive: DriveSettings) -> None:
        self.occupancy_map = occupancy_map
        self._obj = obj
        self._robot = robot
        self._start = start
        self._robot_margin = drive.map_clearance
        for name, pose in (('object stands', start), ('goal is', goal)):
            if not occupancy_map.object_is_free(obj, [pose], 0.0):
                raise PlanningFailed(
                    PlanFailure.NOT_FREE, f'the {name} at {pose.x:.2f} m, {pose.y:.2f} m, where '
                    'the map has an obstacle or ends')
        self._object_margin = next(
            margin for margin in np.multiply(MARGIN_FRACTIONS, drive.map_clearance)
            if occupancy_map.object_is_free(obj, [start, goal], margin))

    def penalty(self, table: PrimitiveTable) -> ClearancePenalty:
        """
        Make the function that tells how much clearance many sequences are short of.

        :param table: ``PrimitiveTable``.
        :return: ``ClearancePenalty``; its times are 0 for sequences that are free, infinite for
            those that do not reach the goal. A fine look includes the corners of the object.
        """
        robot_places = np.array(table.robot_poses)[table.locations, :2]
        circle = self._inner_circle()

        def penalty(moves: IntArray, motions: SequenceMotions, fine: bool) -> FloatArray:
            penalties = np.full(len(moves), math.inf)
            reached = motions.reaches_goal
            moves = moves[reached]
            poses = self._to_map(object_poses_along(
                table, moves, motions.select(reached), FINE_SAMPLES if fine else COARSE_SAMPLES))
            robot_x, robot_y = np.moveaxis(robot_places[moves], -1, 0)[..., None]
            deficits = [
                self._deficit(poses, robot_x, robot_y, self._robot.radius + self._robot_margin),
                self._deficit(poses, circle.x, circle.y, circle.radius + self._object_margin)]
            if fine:
                deficits += [self._deficit(poses, x, y, self._object_margin)
                             for x, y in self._obj.outline]
            penalties[reached] = PENALTY_RATE * np.sum(deficits, axis=0)
            return penalties

        return penalty

    def is_free(self, object_poses: Sequence[Sequence[float]] | FloatArray,
                robot_poses: Sequence[Sequence[float]] | FloatArray) -> bool:
        """
        Return whether object and robot are free at all poses.

        :param object_poses: (x, y, theta) in the world, shape (n, 3).
        :param robot_poses: the same of the robot.
        """
        return (self.occupancy_map.object_is_free(self._obj, object_poses, self._object_margin)
                and self.occupancy_map.robot_is_free(self._robot, robot_poses,
                                                     self._robot_margin))

    def violation(self, trajectory: PushTrajectory) -> str:
        """
        Describe what is wrong with a push; empty where nothing is.

        :param trajectory: ``PushTrajectory``.
        """
        free = self.is_free(trajectory.object_poses, trajectory.robot_poses)
        return '' if free else 'the push meets an obstacle or leaves the map'

    def steps_are_free(self, steps: Sequence[SequenceStep]) -> bool:
        """
        Return whether a sequence is free all along.

        :param steps: ``SequenceStep`` list.
        """
        for step in steps:
            robot_in_object = step.push.start.inverse() @ step.push.robot_start
            poses = step.object_poses(self.occupancy_map.resolution)
            if not self.is_free(poses, [pose @ robot_in_object for pose in poses]):
                return False
        return True

    def _to_map(self, poses: FloatArray) -> _MapPoses:
        """Transform poses from the frame of the object at the start, shape (..., 3)."""
        x, y, rotation = np.moveaxis(poses, -1, 0)
        c, s = math.cos(self._start.theta), math.sin(self._start.theta)
        points = np.stack((self._start.x + c * x - s * y, self._start.y + s * x + c * y), axis=-1)
        x, y = self.occupancy_map.to_map(points.reshape(-1, 2)).T.reshape(2, *rotation.shape)
        theta = rotation + (self._start.theta - self.occupancy_map.origin.theta)
        return _MapPoses(x, y, np.cos(theta), np.sin(theta))

    def _deficit(self, poses: _MapPoses, x: float | FloatArray, y: float | FloatArray,
                 required: float) -> FloatArray:
        """Clearance that a point of the object, in its frame, is short of, shape (m,) [m]."""
        clearance = self.occupancy_map.clearance_in_map_frame(
            poses.x + poses.c * x - poses.s * y, poses.y + poses.s * x + poses.c * y)
        return np.maximum(required - clearance.min(axis=(1, 2)), 0.0)

    def _inner_circle(self) -> _InnerCircle:
        if not self._obj.outline:
            return _InnerCircle(0.0, 0.0, self._obj.radius)
        x, y = np.array(self._obj.outline).mean(axis=0)
        depth = inflate(self._obj.outline, 0.0, 0.0).distances([(x, y)])[0]
        return _InnerCircle(x, y, -float(depth))
