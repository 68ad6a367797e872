"""Bounds of a push: the floor, the length and the progress that its plan stands for."""

import numpy as np
from push_control.settings import ControlSettings
from push_model.events import EventReport, PushEvent
from push_model.geometry import Coordinates, FloatArray
from push_model.trajectory import PushTrajectory

# Distance of the object from its planned path at which a push is aborted, where it is not set, and
# length beyond ``max_length_ratio`` of the planned one, both over the size of the object. Chosen:
# of 251 random pushes that came to their goals six deviated by more than 4 sizes (of those looked
# at, approaches of a differential drive by 4.3 and over 12 sizes), four went farther than 20.
DEVIATION_RATIO = 5.0
LENGTH_MARGIN_RATIO = 15.0
# Spacing of the planned path in comparisons [m]; chosen: cuts corners by millimetres.
SPACING = 0.05
# Length of path after which a push that comes no nearer is aborted, over the size of the object
# and over the remaining length, and the time [s]. Chosen: a new path may be a fifth longer than
# what remains, and a robot that closes a gap takes two seconds.
STALL_SIZE_RATIO = 2.0
STALL_LENGTH_RATIO = 0.5
STALL_TIME = 20.0


class PlanBounds:
    """
    Bounds of floor, length and time of a push, as the plan for its goal needed them.

    Neither new paths nor plans that the push itself asks for widen these bounds.
    """

    def __init__(self, target: PushTrajectory, size: float, settings: ControlSettings) -> None:
        """
        Take the bounds from a plan.

        :param size: greatest distance between two points of the object's outline [m].
        """
        self.planned_length = planned_length(target)
        self.max_length = (settings.max_length_ratio * self.planned_length
                           + LENGTH_MARGIN_RATIO * size)
        self.max_deviation = settings.max_path_deviation or DEVIATION_RATIO * size
        self._stall_length = STALL_SIZE_RATIO * size
        self._path = _resampled(target.object_poses[:, :2])
        self.restart()

    def restart(self) -> None:
        """Measure progress anew, as towards the goal along another path."""
        self._least_remaining = np.inf
        self._stalled_since = 0.0
        self._stalled_time = 0.0

    def is_on_floor(self, positions: FloatArray) -> bool:
        """
        Tell whether all of some positions of the object are on the floor of the plan.

        :param positions: [m], shape (n, 2).
        """
        return bool((self._deviations(positions) <= self.max_deviation).all())

    def check(self, position: Coordinates, travelled: float, remaining: float,
              dt: float) -> EventReport | None:
        """
        Tell which of the bounds a push exceeds.

        :param position: of the object (x, y) [m].
        :param travelled: path length of the contact since the plan was taken up [m].
        :param remaining: length of its present path that remains [m].
        :param dt: time since the last call, in which the robot pushed [s].
        :return: ``EventReport``, or None.
        """
        deviation = float(self._deviations(np.array([position]))[0])
        if deviation > self.max_deviation:
            return PushEvent.LEFT_FLOOR.report(deviation=deviation, limit=self.max_deviation)
        if travelled > self.max_length:
            return PushEvent.PATH_TOO_LONG.report(travelled=travelled,
                                                  planned=self.planned_length)
        if remaining < self._least_remaining:
            self._least_remaining = remaining
            self._stalled_since, self._stalled_time = travelled, 0.0
            return None
        self._stalled_time += dt
        length = travelled - self._stalled_since
        longest = self._stall_length + STALL_LENGTH_RATIO * max(0.0, self._least_remaining)
        if length > longest or self._stalled_time > STALL_TIME:
            return PushEvent.NO_PROGRESS.report(length=length, time=self._stalled_time)
        return None

    def _deviations(self, positions: FloatArray) -> FloatArray:
        """Distances of positions, shape (n, 2), from the planned path [m], shape (n,)."""
        offsets = positions[:, None, :] - self._path
        return np.sqrt((offsets ** 2).sum(axis=2).min(axis=1))


def planned_length(target: PushTrajectory) -> float:
    """Path length of the contact along a plan [m]."""
    return float(np.hypot(*np.diff(target.contact_poses[:, :2], axis=0).T).sum())


def _resampled(path: FloatArray) -> FloatArray:
    """Space the points of a path evenly."""
    distances = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    count = 2 + int(distances[-1] / SPACING)
    even = np.linspace(0.0, distances[-1], count)
    return np.column_stack([np.interp(even, distances, column) for column in path.T])
