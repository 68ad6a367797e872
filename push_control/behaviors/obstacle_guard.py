"""Obstacles of a map in the way of a push, and a guard that ends it before they are met."""

import numpy as np
from numpy.typing import ArrayLike
from push_model.geometry import IntArray, Pose
from push_model.parameters import PushedObject, RoundRobot
from push_model.trajectory import PushTrajectory
from push_navigation.occupancy_map import OccupancyMap

# Clearance that a push keeps, where its plan does [m]; chosen: the noise of poses and of maps.
GUARDED_CLEARANCE = 0.01
# Clearance that it may lose against its plan where that has less [m]; chosen.
LOST_CLEARANCE = 0.005
# Time that the robot takes to stop, with the age of what it sees [s]; chosen: poses are 0.1 s old,
# a drive lags by as much, and it brakes from 0.3 m/s in a third of a second, half as far.
REACTION_TIME = 0.35
# Time over which motion is measured [s]; chosen: two periods of the object pose.
MEASURED_TIME = 0.1
# Members that all have to keep clear of obstacles while nothing is seen; chosen: the nearest one
# of them is 1.6 standard deviations off, in the mean.
GUARDED_MEMBERS = 12


class ObstacleGuard:
    """Predicts the clearances of object and robot by the rate at which they change."""

    def __init__(self, occupancy_map: OccupancyMap, obj: PushedObject, robot: RoundRobot,
                 target: PushTrajectory) -> None:
        self._map = occupancy_map
        self._obj = obj
        self._robot = robot
        planned = self._clearances(target.object_poses, target.robot_poses)
        self._limits = [min(GUARDED_CLEARANCE, clearance - LOST_CLEARANCE)
                        for clearance in planned]
        self._last: list[float] | None = None
        self._rates = [0.0, 0.0]
        # Number of poses at that time.
        self._count = 0
        self._elapsed = 0.0

    def is_close(self, object_poses: ArrayLike, robot_poses: ArrayLike, dt: float) -> bool:
        """
        Tell whether the push has to end.

        :param object_poses: where the object may be by now (x, y, theta), shape (n, 3); the
            nearest one to an obstacle counts.
        :param robot_poses: likewise.
        :param dt: time since the last call [s].
        """
        clearances = self._clearances(object_poses, robot_poses)
        count = len(np.asarray(object_poses))
        self._elapsed += dt
        if self._last is None or count != self._count:
            # Poses of other members, or of another number of them, tell of no motion.
            self._last = clearances
            self._elapsed = 0.0
            self._count = count
        elif self._elapsed >= MEASURED_TIME:
            self._rates = [(now - before) / self._elapsed
                           for now, before in zip(clearances, self._last)]
            self._last, self._elapsed = clearances, 0.0
        return any(rate < 0.0 and clearance + REACTION_TIME * rate < limit
                   for clearance, rate, limit in zip(clearances, self._rates, self._limits))

    def _clearances(self, object_poses: ArrayLike, robot_poses: ArrayLike) -> list[float]:
        robot = float(self._map.clearance(np.asarray(robot_poses)[:, :2]).min())
        return [self._map.object_clearance(self._obj, object_poses), robot - self._robot.radius]


def guarded_members(count: int) -> IntArray:
    """
    Choose the members of an ensemble that have to keep clear while nothing is seen.

    :param count: of all members.
    :return: their indices.
    """
    return np.linspace(0, count - 1, GUARDED_MEMBERS).astype(int)


def blocks_push(target: PushTrajectory, obj: PushedObject, robot: RoundRobot,
                previous: OccupancyMap | None, occupancy_map: OccupancyMap | None,
                robot_pose: Pose) -> bool:
    """
    Tell whether a new map has an obstacle in the way of a push where the previous one has none.

    :param target: ``PushTrajectory``, of which that counts which is left.
    :param previous: ``OccupancyMap``, or None for open floor.
    :param occupancy_map: the new one.
    """
    nearest = int(np.hypot(*(target.robot_poses[:, :2] - robot_pose[:2]).T).argmin())
    objects, robots = target.object_poses[nearest:], target.robot_poses[nearest:]

    def is_free(floor: OccupancyMap | None) -> bool:
        return floor is None or (floor.object_is_free(obj, objects, 0.0)
                                 and floor.robot_is_free(robot, robots, 0.0))
    return not is_free(occupancy_map) and is_free(previous)
