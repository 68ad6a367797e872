"""Previous poses of all members, as far back as measurements still come in."""

import numpy as np
from push_model.geometry import FloatArray

# Time for which previous poses are kept [s]; chosen: longer than object poses are late.
HISTORY_TIME = 1.5
# Initial capacity [poses]; chosen: of odometry with 50 Hz, each moved once.
INITIAL_CAPACITY = 64


class PoseHistory:
    """
    Poses of all members by time, the oldest first, in one array.

    ``times``: of odometry [s].
    """

    def __init__(self) -> None:
        """Start without poses."""
        self.times: list[float] = []
        self._buffer: FloatArray = np.empty((0, 1, 6))
        # Index of the oldest poses in the buffer.
        self._first = 0

    @property
    def poses(self) -> FloatArray:
        """Poses of all members by time, shape (k, n, 6), as of ``Members.poses``; writeable."""
        return self._buffer[self._first:self._first + len(self.times)]

    def append(self, time: float, poses: FloatArray) -> None:
        """
        Add the newest poses, and drop what is too old.

        :param time: later than all others [s].
        :param poses: of all members; a copy is kept.
        """
        if self._first + len(self.times) == len(self._buffer):
            self._grow(poses.shape)
        self._buffer[self._first + len(self.times)] = poses
        self.times.append(time)
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
        self.append(time, poses)

    def at(self, time: float) -> FloatArray:
        """
        Interpolate linearly; before the first and after the last time their poses hold.

        :param time: [s].
        :return: poses of all members then, shape (n, 6).
        """
        poses = self.poses
        after = next((i for i, other in enumerate(self.times) if other >= time), None)
        if after is None:
            return poses[-1]
        if after == 0:
            return poses[0]
        ratio = (time - self.times[after - 1]) / (self.times[after] - self.times[after - 1])
        first, last = poses[after - 1], poses[after]
        return first + ratio * (last - first)

    def _drop_first(self) -> None:
        del self.times[0]
        self._first += 1

    def _grow(self, shape: tuple[int, ...]) -> None:
        """Move all poses to the start of a buffer with twice their capacity."""
        poses = self.poses
        self._buffer = np.empty((max(INITIAL_CAPACITY, 2 * len(poses)), *shape))
        self._buffer[:len(poses)] = poses
        self._first = 0
