"""How likely the last push of a chain misses the tolerances, so that more pushes are to follow."""

import numpy as np

# As counted in 180 pushes of random tasks with uncertain friction, noisy poses and odometry that
# drifts: straight pushes at a vertex or a round side miss least, short ones at a face miss more,
# as the robot's place along the face is not well known; so do turns that go on nearly to the end,
# and turns nearly all round.
BASE, ON_FACE, SHORT_END, ROUND = 0.2, 0.3, 0.4, 0.8
SHORT_WAY, LONG_WAY = 0.5, 1.5
TURNED, LITTLE, ENOUGH = 0.3, 0.1, 0.4
FAR_ROUND, ALL_ROUND = 3.5, 6.0


def miss_probability(turned, straight, way, on_face):
    """
    Tell how likely a push misses; arguments are numbers or arrays of one shape.

    :param turned: angle by which the push turns the object, to and fro [rad].
    :param straight: way at its end on which it does not turn [m].
    :param way: of the contact [m].
    :param on_face: whether it pushes at a face.
    :return: chance, 0..1.
    """
    short = 1.0 - _rise(way, SHORT_WAY, LONG_WAY)
    late = _rise(turned, 0.0, TURNED) * (1.0 - _rise(straight, LITTLE, ENOUGH))
    chance = (BASE + ON_FACE * short * on_face + SHORT_END * late
              + ROUND * _rise(turned, FAR_ROUND, ALL_ROUND))
    return np.minimum(chance, 1.0)


def _rise(value, low, high):
    """From 0 at the one to 1 at the other."""
    return np.clip((value - low) / (high - low), 0.0, 1.0)
