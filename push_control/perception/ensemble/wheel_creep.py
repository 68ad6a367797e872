"""
Wheels that creep: the harder they push, the larger the part of their way that they lose.

With the creep k, a step of odometry (dx, dy) against the force F of the contact moves the robot by

    (1 - k F) (dx, dy)

Where pushes are seen, wheels are taken not to creep until object poses tell otherwise; those of a
robot that pushes what it does not see may creep from the start. k is estimated with the other
errors of odometry, and as far as it is not known the place of the robot is less certain after each
push, the more so the heavier the object is.
"""

import numpy as np
from push_control.perception.ensemble.members import Members
from push_dynamics.layout import NORMAL_FORCE, TANGENTIAL_FORCE
from push_model.geometry import FloatArray

# Range of the creep of wheels that do [1/N]; chosen: 3 to 15 % of the way at 15 N, where the
# scale of odometry explains less than that.
CREEP_RANGE = 0.002, 0.01
# Part of a step that is lost at most; chosen: force peaks of the touch count as no more.
MAX_LOSS = 0.5


def spread_creep(count: int, rng: np.random.Generator) -> FloatArray:
    """
    Spread the creep evenly over that of wheels that do, in random order.

    :param count: number of members.
    :return: creep [1/N], shape (n, 1).
    """
    low, high = CREEP_RANGE
    ranks = rng.permutation(count)
    return (low + (high - low) * (ranks + 0.5) / count)[:, None]


def reduce_by_creep(increments: FloatArray, members: Members) -> None:
    """
    Take off what the wheels lose by the force that each member pushes with.

    :param increments: motion (x, y, theta) of each robot by odometry, shape (n, 3), is written.
    """
    if not members.wheel_creep.any():
        return
    forces = np.hypot(members.states[:, NORMAL_FORCE], members.states[:, TANGENTIAL_FORCE])
    loss = np.clip(members.wheel_creep[:, 0] * forces, -MAX_LOSS, MAX_LOSS)
    increments[:, :2] *= 1.0 - loss[:, None]
