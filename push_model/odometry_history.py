"""Where the robot was, by odometry, at the time of a measurement that comes later."""

import bisect

from push_model.geometry import Pose, wrap_angle
from push_model.signals import ObjectPose, Odometry

# Time for which odometry is kept [s]; chosen: longer than the greatest latency of the simulator.
HISTORY_TIME = 6.0


class OdometryHistory:
    """Poses of odometry by time, with which relative poses of an object are placed."""

    def __init__(self) -> None:
        """Start without odometry."""
        self._times: list[float] = []
        self._poses: list[Pose] = []

    def append(self, odometry: Odometry) -> None:
        """
        Add the newest odometry, and drop what is too old; what is not newer is ignored.

        :param odometry: ``Odometry``.
        """
        if self._times and odometry.time <= self._times[-1]:
            return
        self._times.append(odometry.time)
        self._poses.append(odometry.pose)
        excess = bisect.bisect_left(self._times, odometry.time - HISTORY_TIME)
        del self._times[:excess], self._poses[:excess]

    def pose_at(self, time: float) -> Pose | None:
        """
        Interpolate where the robot was.

        :param time: when [s].
        :return: ``Pose`` in the world; the newest for a later time; None before the oldest.
        """
        index = bisect.bisect_left(self._times, time)
        if index == len(self._times):
            return self._poses[-1] if self._poses else None
        if self._times[index] == time:
            return self._poses[index]
        if index == 0:
            return None
        return _between(self._poses[index - 1], self._poses[index],
                        (time - self._times[index - 1])
                        / (self._times[index] - self._times[index - 1]))

    def place(self, measured: ObjectPose) -> ObjectPose | None:
        """
        Compose a relative pose with odometry at its time.

        :param measured: ``ObjectPose`` with ``relative``; its ``pose`` counts for nothing.
        :return: the same with its ``pose`` in the world; None where there is no odometry of its
            time.
        :raises ValueError: where the pose is not relative.
        """
        if measured.relative is None:
            raise ValueError('measured.relative: got None, expected a pose in the robot frame')
        robot_pose = self.pose_at(measured.time)
        if robot_pose is None:
            return None
        x, y, theta = robot_pose @ measured.relative
        return measured._replace(pose=Pose(x, y, wrap_angle(theta)))


def _between(start: Pose, end: Pose, fraction: float) -> Pose:
    """Interpolate two poses along a line, the heading the shorter way round."""
    rotation = wrap_angle(end.theta - start.theta)
    return Pose(start.x + fraction * (end.x - start.x), start.y + fraction * (end.y - start.y),
                start.theta + fraction * rotation)
