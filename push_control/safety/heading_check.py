"""
Headings that a tracker confuses: those at which an object looks the same.

An outline that a rotation by 2 pi / n takes to itself looks the same in n headings. Where the pose
of such an object is rotated by a multiple of that from one measurement to the next, and is hardly
displaced, it was not the object that moved, which nobody rotates so exactly about its origin.
"""

import math

import numpy as np
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import PushedObject
from push_model.signals import ObjectPose

# Distance between vertices that are the same over the size of the outline; chosen: a tracker does
# not see a difference of a few per cent.
SAME_RATIO = 0.05
# What a flip may differ from a multiple of the angle [rad], and displace the object [m]; chosen:
# the noise of a tracker, and what an object is pushed on between two of its poses.
FLIP_TOLERANCE = 0.15
FLIP_DISTANCE = 0.05


class HeadingCheck:
    """
    Takes flips of the heading back.

    ``flip``: what was added to the heading that was measured last to get that of the object [rad].
    """

    def __init__(self, obj: PushedObject, heading_count: int = 0) -> None:
        """
        Begin before the first pose, which counts as right.

        :param obj: the ``PushedObject``.
        :param heading_count: number of headings in which it looks the same; 0: as the outline has
            it.
        """
        count = heading_count or rotational_symmetry(obj)
        self._angle = 2.0 * math.pi / count
        self._last: Pose | None = None
        self.flip = 0.0

    def believed(self, measured: ObjectPose) -> ObjectPose:
        """
        Correct a measured pose.

        :param measured: ``ObjectPose``, in the order of time.
        :return: the same, with the heading that continues the former ones.
        """
        pose, last = measured.pose, self._last
        if not pose.is_finite():
            return measured
        self.flip = 0.0
        if last is not None and distance(pose, last) < FLIP_DISTANCE:
            rotation = wrap_angle(pose.theta - last.theta)
            multiple = self._angle * round(rotation / self._angle)
            if abs(rotation - multiple) < FLIP_TOLERANCE:
                self.flip = -multiple
        self._last = Pose(pose.x, pose.y, wrap_angle(pose.theta + self.flip))
        return ObjectPose(measured.time, self._last, measured.covariance)


def rotational_symmetry(obj: PushedObject) -> int:
    """
    Count the headings in which an outline looks the same; 1 for a disc, whose heading is marked.

    :param obj: the ``PushedObject``.
    """
    if not obj.outline:
        return 1
    vertices = np.array(obj.outline)
    vertices = vertices - vertices.mean(axis=0)
    tolerance = SAME_RATIO * float(np.hypot(*vertices.T).max())
    # About the origin, as it is the pose of the frame that must be the same.
    if np.hypot(*np.array(obj.outline).mean(axis=0)) > tolerance:
        return 1
    for count in range(len(vertices), 1, -1):
        c, s = math.cos(2.0 * math.pi / count), math.sin(2.0 * math.pi / count)
        rotated = vertices @ np.array([(c, s), (-s, c)])
        gaps = np.hypot(*(rotated[:, None] - vertices[None]).transpose(2, 0, 1)).min(axis=1)
        if gaps.max() < tolerance:
            return count
    return 1
