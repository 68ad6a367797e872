"""
A push that has met nothing: where the robot has not been.

An object that is where it was has not stood in the way. So members whose robot would have driven
through it are refuted, and those that would have passed it beside or before take their places.
That makes the rest differ in other ways, but not less: a push that met nothing measures nothing
of the robot along any direction.
"""

import numpy as np
from push_control.perception.ensemble.ensemble_state import RobotMemory
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_navigation.obstacle import inflate

# Overlap of robot and object beyond which the object would have been seen to move [m]; chosen:
# noise of its poses and errors of its outline, some times.
MAX_OVERLAP = 0.02
# Poses of the path that are compared with the object; chosen: an object is not passed between two.
PATH_POSES = 21
# Members that have to remain at least; chosen: of fewer ones chance would say where the robot is,
# which is then elsewhere by more than it is known, or touches an object that does not yield.
MIN_REMAINING = 5


def after_missed_push(memory: RobotMemory, odometry_pose: Pose, obj: PushedObject, radius: float,
                      object_pose: Pose) -> RobotMemory:
    """
    Return what is known of the robot before a push that has met nothing.

    :param memory: ``RobotMemory`` of before the push.
    :param odometry_pose: ``Pose`` of odometry at its end.
    :param radius: of the robot [m].
    :param object_pose: ``Pose`` that the object had before and after.
    :return: ``RobotMemory`` of the same time; unchanged where hardly a member explains it.
    """
    step = memory.odometry_pose.inverse() @ odometry_pose
    gaps = _gaps(memory.robots, step, obj, radius, object_pose)
    remaining = np.flatnonzero(gaps > -MAX_OVERLAP)
    count = len(memory.robots)
    if not MIN_REMAINING <= len(remaining) < count:
        return memory
    # Each one as often as any other, but for one time.
    chosen = remaining[np.arange(count) * len(remaining) // count]
    return memory._replace(robots=_as_uncertain(memory.robots[chosen], memory.robots),
                           odometry_errors=memory.odometry_errors[chosen])


def _gaps(robots: FloatArray, step: Pose, obj: PushedObject, radius: float,
          object_pose: Pose) -> FloatArray:
    """Compute the least gap of each robot on its path, shape (n,) [m]."""
    contact = inflate(obj.outline, obj.radius, radius)
    c, s = np.cos(robots[:, 2]), np.sin(robots[:, 2])
    path = np.stack((c * step.x - s * step.y, s * step.x + c * step.y), axis=1)
    fractions = np.linspace(0.0, 1.0, PATH_POSES)[:, None, None]
    x, y = np.moveaxis(robots[:, :2] + fractions * path - object_pose[:2], -1, 0)
    c, s = np.cos(object_pose.theta), np.sin(object_pose.theta)
    points = np.stack((c * x + s * y, c * y - s * x), axis=-1)
    distances = contact.distances(points.reshape(-1, 2)).reshape(PATH_POSES, -1)
    return np.asarray(distances.min(axis=0), dtype=np.float64)


def _as_uncertain(robots: FloatArray, before: FloatArray) -> FloatArray:
    """Spread poses about their mean until they are no surer than those before, axis by axis."""
    mean, stds = robots.mean(axis=0), robots.std(axis=0)
    ratios = np.ones_like(stds)
    np.divide(before.std(axis=0), stds, out=ratios, where=stds > 0.0)
    return mean + np.maximum(ratios, 1.0) * (robots - mean)
