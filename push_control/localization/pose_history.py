"""Former poses of all members, as far back as measurements still come in."""

from collections import deque

from push_model.geometry import FloatArray

# Time for which former poses are kept [s]; chosen: longer than object poses are late.
HISTORY_TIME = 0.4


class PoseHistory:
    """
    Poses of all members by time, the oldest first.

    ``times``: of odometry [s]. ``poses``: as of ``Members.poses``, one array for each time.
    """

    def __init__(self) -> None:
        """Begin without poses."""
        self.times: deque[float] = deque()
        self.poses: deque[FloatArray] = deque()

    def append(self, time: float, poses: FloatArray) -> None:
        """
        Add the newest poses, and drop what is too old.

        :param time: later than all others [s].
        :param poses: of all members; a copy is kept.
        """
        self.times.append(time)
        self.poses.append(poses.copy())
        while time - self.times[0] > HISTORY_TIME:
            self._drop_first()

    def drop_before(self, time: float) -> None:
        """
        Drop what nobody asks for again once a measurement of some time has come.

        :param time: up to which no other measurement comes [s].
        """
        while len(self.times) > 1 and self.times[1] <= time:
            self._drop_first()

    def restart(self, time: float, poses: FloatArray) -> None:
        """
        Forget all poses but the newest.

        :param time: of these [s].
        :param poses: of all members; a copy is kept.
        """
        self.times.clear()
        self.poses.clear()
        self.append(time, poses)

    def at(self, time: float) -> FloatArray:
        """
        Interpolate linearly; before the first and after the last time their poses stand.

        :param time: [s].
        :return: poses of all members then, shape (n, 6).
        """
        after = next((i for i, other in enumerate(self.times) if other >= time), None)
        if after is None:
            return self.poses[-1]
        if after == 0:
            return self.poses[0]
        ratio = (time - self.times[after - 1]) / (self.times[after] - self.times[after - 1])
        first, last = self.poses[after - 1], self.poses[after]
        return first + ratio * (last - first)

    def _drop_first(self) -> None:
        self.times.popleft()
        self.poses.popleft()
