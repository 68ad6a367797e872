"""Measurements and commands, the pure counterparts of the topics."""

import enum
import math
from typing import Literal, NamedTuple

import numpy as np
from push_model.geometry import FloatArray, Pose

# What the pose of odometry refers to: sums of the robot's own motion, whose error grows with the
# distance; or the world, as of motion capture or a map, whose error stays as stated.
OdometryReference = Literal['drifting', 'absolute']


class Twist(NamedTuple):
    """Velocity (v_x, v_y) [m/s] and yaw rate omega [rad/s], in robot axes."""

    v_x: float = 0.0
    v_y: float = 0.0
    omega: float = 0.0


STOP = Twist()


class PoseCovariance(NamedTuple):
    """
    Covariance of the errors of a measured pose, along the axes of the world.

    The fields are the entries of the upper triangle, by rows: of x and y [m^2], of one of them and
    the heading [m rad], and of the heading [rad^2].
    """

    x_x: float
    x_y: float
    x_theta: float
    y_y: float
    y_theta: float
    theta_theta: float

    @classmethod
    def from_matrix(cls, matrix: FloatArray) -> 'PoseCovariance':
        """
        Read the upper triangle of a matrix.

        :param matrix: covariance of (x, y, theta), shape (3, 3).
        """
        return cls(*matrix[np.triu_indices(3)].tolist())

    @classmethod
    def from_deviations(cls, position: float, heading: float) -> 'PoseCovariance':
        """
        Make the covariance of errors that are independent of each other.

        :param position: standard deviation of x and of y [m].
        :param heading: standard deviation of the heading [rad].
        """
        return cls(position ** 2, 0.0, 0.0, position ** 2, 0.0, heading ** 2)

    @property
    def position_deviation(self) -> float:
        """Standard deviation of x or y, the greater one [m]."""
        return math.sqrt(max(self.x_x, self.y_y))

    @property
    def heading_deviation(self) -> float:
        """Standard deviation of the heading [rad]."""
        return math.sqrt(self.theta_theta)

    @property
    def deviation(self) -> 'PoseDeviation':
        """The ``PoseDeviation``, with the longer axis of the ellipse of positions."""
        mean, half_difference = 0.5 * (self.x_x + self.y_y), 0.5 * (self.x_x - self.y_y)
        longest = mean + math.hypot(half_difference, self.x_y)
        return PoseDeviation(math.sqrt(longest), self.heading_deviation)

    @property
    def matrix(self) -> FloatArray:
        """The same as a symmetric matrix of (x, y, theta), shape (3, 3)."""
        x_x, x_y, x_theta, y_y, y_theta, theta_theta = self
        return np.array([(x_x, x_y, x_theta), (x_y, y_y, y_theta),
                         (x_theta, y_theta, theta_theta)])


class PoseDeviation(NamedTuple):
    """
    Standard deviations of a pose.

    :param position: in the direction in which it is greatest [m].
    :param heading: of the heading [rad].
    """

    position: float
    heading: float


class ObjectEstimate(NamedTuple):
    """
    Estimate of an object at a time [s].

    :param time: of the estimate [s].
    :param pose: ``Pose`` in the world.
    :param covariance: ``PoseCovariance`` of it; None where it is not known.
    :param friction_center: centre of friction as identified, object frame (x, y) [m].
    """

    time: float
    pose: Pose
    covariance: PoseCovariance | None
    friction_center: tuple[float, float]


class Odometry(NamedTuple):
    """
    Robot pose in the world frame and twist in robot axes, measured at a time [s].

    :param time: of the measurement [s].
    :param pose: ``Pose`` of the robot.
    :param twist: ``Twist`` of the robot.
    :param covariance: ``PoseCovariance`` of the pose as its source states it; None where it states
        none. Whether it holds is for ``OdometryReference`` to say: many bases state a small
        constant one for a pose that drifts.
    """

    time: float
    pose: Pose
    twist: Twist
    covariance: PoseCovariance | None = None


class ObjectPose(NamedTuple):
    """
    Object pose in the world frame, measured at a time [s].

    :param time: of the measurement [s].
    :param pose: ``Pose`` of the object.
    :param covariance: ``PoseCovariance`` of the pose as its source states it; None where it states
        none. Of a relative pose it is that of the measurement alone, along the axes of the robot.
    :param relative: ``Pose`` of the object in the axes of the robot at that time, where a sensor
        on the robot measures it; ``pose`` is then composed with odometry. None where the pose is
        measured in the world.
    """

    time: float
    pose: Pose
    covariance: PoseCovariance | None = None
    relative: Pose | None = None


class LidarScan(NamedTuple):
    """
    One turn of a lidar in the plane.

    :param time: of the first beam [s].
    :param ranges: of the beams, shape (n,) [m]; those outside the limits measure nothing.
    :param angle_min: direction of the first beam in the frame of the lidar [rad].
    :param angle_increment: from one beam to the next [rad].
    :param time_increment: from one beam to the next [s].
    :param range_min: limit of what is measured [m].
    :param range_max: limit of what is measured [m].
    """

    time: float
    ranges: FloatArray
    angle_min: float
    angle_increment: float
    time_increment: float
    range_min: float
    range_max: float

    @property
    def middle(self) -> float:
        """Time of the middle of the scan [s]."""
        return self.time + 0.5 * (len(self.ranges) - 1) * self.time_increment

    @property
    def end(self) -> float:
        """Time of the last beam [s]."""
        return self.time + (len(self.ranges) - 1) * self.time_increment


class PlaceStatus(enum.Enum):
    """Status of the place of a robot in a map."""

    TRACKED = 'tracked'
    # What is measured does not fit the map: robot or map are elsewhere.
    LOST = 'lost'
    # The robot was lost, and is elsewhere than it seemed to be.
    REGAINED = 'regained'


class RobotPlace(NamedTuple):
    """
    Place of the robot in a map, measured beside drifting odometry.

    Its errors last: they are those of the map, the same in the next measurement.

    :param time: of the measurement [s].
    :param pose: ``Pose`` of the robot in the world.
    :param covariance: ``PoseCovariance`` of it, of all measurements so far.
    :param status: ``PlaceStatus``.
    """

    time: float
    pose: Pose
    covariance: PoseCovariance
    status: PlaceStatus = PlaceStatus.TRACKED
