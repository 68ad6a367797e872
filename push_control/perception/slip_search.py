"""
Search for a robot whose wheels have slipped: its pose explains what it has not touched.

Odometry measures the wheels. Where these slip during a part of the path, the robot moves and turns
by less there, and from then on it is elsewhere, by decimetres, with a heading that is wrong by
tens of degrees. No feature of a map tells it so, but the object does: as long as its poses show it
at rest, the robot cannot have driven through it. So some hypotheses

    (a, b, r): from the path length a to b the robot has moved by the ratio r of odometry

are drawn, the path since the robot was last known is integrated for each, and those that lead
through the object are dropped. Axes: k hypotheses, n poses of the path.
"""

import math

import numpy as np
from push_model.geometry import distance, FloatArray, Pose, wrap_angle, wrap_angles
from push_model.parameters import PushedObject, RoundRobot
from push_navigation.obstacle import inflate

# Distance and rotation between two poses of the path that are compared [m], [rad]; chosen: a
# robot does not pass an object between two of them. And the number of poses from which on only
# every other one stays; chosen: six metres.
PATH_DISTANCE, PATH_ROTATION = 0.05, 0.2
MAX_PATH_POSES = 120
# Overlap of robot and object beyond which a hypothesis is wrong [m]; chosen: the object moves as
# far while a pose of it is under way.
MAX_OVERLAP = 0.04
# Gap beyond which the robot does not touch an object that it has moved [m]; chosen: likewise.
MAX_TOUCH_GAP = 0.06
# Number of hypotheses, and how many have to remain at least; chosen: so that what odometry
# errs by is one of several, and those that remain have a standard deviation.
HYPOTHESES, MIN_REMAINING = 1000, 4
# Least ratio of motion, and by how much farther than the path, over its length, slip may reach at
# either end; chosen: a robot that moves less does not arrive anywhere, and a third of all.
MIN_RATIO, MARGIN = 0.2, 0.3
# Standard deviations of the robot where the path starts (x, y, heading) [m, m, rad]; chosen: with
# what odometry errs by besides.
OTHER_STD = 0.03, 0.03, 0.05
# Number of these that are compared; chosen: their squares are computed in milliseconds.
MAX_COMPARED = 150
# Distance and rotation within which hypotheses support one another [m], [rad]; chosen: a push that
# begins as far beside the object still touches it.
ALIKE = 0.12, 0.35


class SlipSearch:
    """Path of the robot since it was last known, and what was seen of the object meanwhile."""

    def __init__(self, obj: PushedObject, robot: RoundRobot, seed: int = 0) -> None:
        """
        Start without a path.

        :param seed: of the hypotheses.
        """
        self._radius = robot.radius
        # Where the robot's centre touches the object, and a circle around that.
        self._contact = inflate(obj.outline, obj.radius, robot.radius)
        self._extent = self._contact.radius + max(math.hypot(*vertex)
                                                  for vertex in self._contact.core)
        self._rng = np.random.default_rng(seed)
        self._spacing = 1.0
        # Where odometry has the robot, as added up from the start of the path.
        self._robot: Pose | None = None
        self._path: list[Pose] = []
        self._objects: list[Pose] = []

    def restart(self, robot: Pose | None) -> None:
        """
        Start a path where the robot is known.

        :param robot: its ``Pose`` in the world; None if it is not known, then there is no path.
        """
        self._robot = robot
        self._path, self._objects = [], []
        self._spacing = 1.0

    def drive(self, step: Pose, object_pose: Pose) -> None:
        """
        Continue the path, if it was started.

        :param step: motion of the robot by odometry, as ``Pose`` in its axes before.
        :param object_pose: ``Pose`` of the object as it was seen last.
        """
        if self._robot is None:
            return
        self._robot = self._robot @ step
        last = self._path[-1] if self._path else None
        if last is None or (
                distance(last, self._robot) > self._spacing * PATH_DISTANCE
                or abs(wrap_angle(self._robot.theta - last.theta))
                > self._spacing * PATH_ROTATION):
            self._path.append(self._robot)
            self._objects.append(object_pose)
        if len(self._path) > MAX_PATH_POSES:
            self._path, self._objects = self._path[::2], self._objects[::2]
            self._spacing *= 2.0

    def find(self, object_pose: Pose, is_touching: bool) -> FloatArray | None:
        """
        Find where the robot may be by now.

        :param object_pose: ``Pose`` of the object by now.
        :param is_touching: whether the robot touches it for certain.
        :return: poses (x, y, theta) that are alike, the most that are, shape (k, 3); None where
            slip does not explain what was seen, or nothing was driven.
        """
        if self._robot is None or math.isinf(self._radius) or len(self._path) < 2:
            return None
        robots = self._robots(np.array([*self._path, self._robot]))
        gaps = self._gaps(robots, np.array([*self._objects, object_pose]))
        remains = gaps.min(axis=1) > -MAX_OVERLAP
        if is_touching:
            remains &= gaps[:, -1] < MAX_TOUCH_GAP
        remaining = robots[remains, -1][:MAX_COMPARED]
        return _most_alike(remaining) if len(remaining) >= MIN_REMAINING else None

    def _robots(self, path: FloatArray) -> FloatArray:
        """Integrate the path by each hypothesis, shape (k, n, 3)."""
        rng, count = self._rng, len(path)
        shift = np.diff(path, axis=0)
        c, s = np.cos(path[:-1, 2]), np.sin(path[:-1, 2])
        forward = c * shift[:, 0] + s * shift[:, 1]
        lateral = c * shift[:, 1] - s * shift[:, 0]
        rotation = wrap_angles(shift[:, 2])
        # Many slip from the start, and many until now.
        indices = np.arange(count - 1)
        first = count * rng.uniform(-MARGIN, 1.0, (HYPOTHESES, 1))
        last = rng.uniform(first, count * (1.0 + MARGIN))
        ratios = np.where((first <= indices) & (indices < last),
                          rng.uniform(MIN_RATIO, 1.0, (HYPOTHESES, 1)), 1.0)
        robots = np.empty((HYPOTHESES, count, 3))
        # In the robot's axes, as all else: where the world has its own does not matter.
        x, y, theta = rng.normal(0.0, OTHER_STD, (HYPOTHESES, 3)).T
        robots[:, 0, 0] = path[0, 0] + c[0] * x - s[0] * y
        robots[:, 0, 1] = path[0, 1] + s[0] * x + c[0] * y
        robots[:, 0, 2] = path[0, 2] + theta
        robots[:, 1:, 2] = robots[:, :1, 2] + np.cumsum(ratios * rotation, axis=1)
        # A slip that turns the robot less bends its path as it goes.
        middle = robots[:, :-1, 2] + 0.5 * (ratios - 1.0) * rotation
        c, s = ratios * np.cos(middle), ratios * np.sin(middle)
        robots[:, 1:, 0] = robots[:, :1, 0] + np.cumsum(c * forward - s * lateral, axis=1)
        robots[:, 1:, 1] = robots[:, :1, 1] + np.cumsum(s * forward + c * lateral, axis=1)
        return robots

    def _gaps(self, robots: FloatArray, objects: FloatArray) -> FloatArray:
        """Compute the gaps between robots and object, shape (k, n) [m]."""
        shift = robots[..., :2] - objects[:, :2]
        c, s = np.cos(objects[:, 2]), np.sin(objects[:, 2])
        x = c * shift[..., 0] + s * shift[..., 1]
        y = c * shift[..., 1] - s * shift[..., 0]
        gaps: FloatArray = np.hypot(x, y) - self._extent
        # Those that are farther away touch nothing, however much farther.
        is_near = gaps < MAX_TOUCH_GAP
        gaps[is_near] = self._contact.distances(np.stack([x[is_near], y[is_near]], axis=1))
        return gaps


def _most_alike(poses: FloatArray) -> FloatArray:
    """Return the largest group of poses that are like one of them."""
    x, y, theta = (poses[:, None] - poses[None]).transpose(2, 0, 1)
    theta = wrap_angles(theta)
    are_alike = (x ** 2 + y ** 2) / ALIKE[0] ** 2 + (theta / ALIKE[1]) ** 2 < 1.0
    best = int(are_alike.sum(axis=1).argmax())
    group = poses[are_alike[best]]
    group[:, 2] = poses[best, 2] - theta[best, are_alike[best]]
    return group
