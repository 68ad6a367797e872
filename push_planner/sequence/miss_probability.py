"""
Probability that the last push of a sequence misses the tolerances, so that others must follow.

The numbers were counted in 180 pushes of random tasks with uncertain friction, noisy poses and
odometry that drifts. Straight pushes at a vertex or a round side miss least. Short pushes at a
face miss more, as the place of the robot along the face is not well known; so do rotations that
go on nearly to the end, and rotations nearly all round.
"""

from typing import Any

import numpy as np

# Probabilities that add up: of every push, ...
BASE = 0.2
# ... of a short push at a face, ...
ON_FACE = 0.3
# ... of a rotation that goes on to the end, ...
LATE_ROTATION = 0.4
# ... and of a rotation all round.
FULL_ROTATION = 0.8

# Between which values these come in: path length of the contact [m], ...
SHORT_PATH = 0.5
LONG_PATH = 1.5
# ... rotation from which its end matters [rad], ...
NOTICEABLE_ROTATION = 0.3
# ... straight end of the path after which a rotation is corrected [m], ...
SHORT_STRAIGHT = 0.1
LONG_STRAIGHT = 0.4
# ... and rotation [rad].
LARGE_ROTATION = 3.5
WHOLE_ROTATION = 6.0


def miss_probability(rotation: Any, straight: Any, path_length: Any, on_face: Any) -> Any:
    """
    Estimate the probability that a push misses; arguments are numbers or arrays of one shape.

    :param rotation: angle by which the push rotates the object, to and fro [rad].
    :param straight: length of the end of its path on which it does not rotate [m].
    :param path_length: of the contact [m].
    :param on_face: whether it pushes at a face.
    :return: probability, 0..1.
    """
    shortness = 1.0 - _ramp(path_length, SHORT_PATH, LONG_PATH)
    lateness = _ramp(rotation, 0.0, NOTICEABLE_ROTATION) * (
        1.0 - _ramp(straight, SHORT_STRAIGHT, LONG_STRAIGHT))
    probability = (BASE + ON_FACE * shortness * on_face + LATE_ROTATION * lateness
                   + FULL_ROTATION * _ramp(rotation, LARGE_ROTATION, WHOLE_ROTATION))
    return np.minimum(probability, 1.0)


def _ramp(value: Any, low: float, high: float) -> Any:
    """Return 0 up to ``low``, 1 from ``high`` on, linear between them."""
    return np.clip((value - low) / (high - low), 0.0, 1.0)
