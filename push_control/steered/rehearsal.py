"""A plan that only loads what a steered push needs: the object is pushed straight ahead."""

import math

import numpy as np
from push_model.contact import contact_point, normal_range
from push_model.geometry import FloatArray, Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.trajectory import PushTrajectory

# Speed [m/s], times of the samples [s]; chosen: slower than any base, longer than its start takes.
SPEED = 0.05
TIMES: FloatArray = np.array([0.0, 1.0, 2.0, 3.0, 4.0])


def rehearsal_plan(obj: PushedObject, robot: RoundRobot) -> PushTrajectory:
    """
    Plan a translation of an object at the origin, pushed at a vertex, or where it is round.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot`` that pushes.
    :return: ``PushTrajectory`` of a steered push; the object need not keep to it.
    """
    contact = Contact('vertex', index=0) if obj.outline else Contact('round', offset=math.pi)
    low, high = normal_range(obj, contact)
    normal = 0.5 * (low + high)
    velocity: FloatArray = np.array((SPEED * math.cos(normal), SPEED * math.sin(normal), 0.0))
    twists: FloatArray = np.tile(velocity, (len(TIMES), 1))
    touch = Pose(*contact_point(obj, contact), normal)
    object_poses, contact_poses, robot_poses = (
        np.add(start, np.outer(TIMES, velocity))
        for start in (Pose(0.0, 0.0, 0.0), touch, touch @ Pose(-robot.radius, 0.0, 0.0)))
    return PushTrajectory(TIMES, object_poses, twists, contact_poses, twists, robot_poses, twists)
