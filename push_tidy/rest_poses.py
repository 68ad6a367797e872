"""Where several objects are at rest: the mean of some measurements of each."""

from collections.abc import Sequence
import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import Pose, wrap_angle


class RestPose(NamedTuple):
    """
    An object at rest.

    :param pose: mean ``Pose`` in the world.
    :param deviation: standard deviation of one measured position about it, along an axis [m].
    """

    pose: Pose
    deviation: float


class RestPoses:
    """
    Measurements of objects at rest.

    :param names: of the objects.
    :param count: measurements of each that are averaged.
    """

    def __init__(self, names: Sequence[str], count: int) -> None:
        self._count = count
        self._poses: dict[str, list[Pose]] = {name: [] for name in names}

    def restart(self) -> None:
        """Forget all measurements: objects have moved."""
        for poses in self._poses.values():
            poses.clear()

    def add(self, name: str, pose: Pose) -> None:
        """
        Take a measurement in.

        :param name: of the object.
        :param pose: its measured ``Pose`` in the world.
        """
        poses = self._poses[name]
        if len(poses) < self._count:
            poses.append(pose)

    @property
    def missing(self) -> list[str]:
        """Names of objects of which measurements are missing."""
        return [name for name, poses in self._poses.items() if len(poses) < self._count]

    def means(self) -> dict[str, RestPose]:
        """Return the ``RestPose`` of each object that was measured, by name."""
        return {name: _mean(poses) for name, poses in self._poses.items() if poses}


def _mean(poses: Sequence[Pose]) -> RestPose:
    values = np.array(poses)
    first = poses[0].theta
    # Headings beside the first one, so that none of them wraps.
    values[:, 2] = [wrap_angle(theta - first) for theta in values[:, 2].tolist()]
    x, y, turn = values.mean(axis=0).tolist()
    deviation = math.sqrt(float(values[:, :2].var(axis=0).mean()))
    return RestPose(Pose(x, y, wrap_angle(first + turn)), deviation)
