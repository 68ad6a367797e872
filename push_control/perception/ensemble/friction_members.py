"""
What is known of an object's friction, and members of an ensemble that know just that.

Members differ in the logarithms L of the friction factors of the supports and in the contact
friction. Their centres of friction c(L) scatter with the mean m and the deviations s. Where the
centre is known as k with the deviation d, each member is given the centre

    c' = k + min(1, d / s) (c - m),    L' = L + G (c' - c),    G = cov(L, c) cov(c)^-1,

that is the most likely change of its supports; as c(L) bends a little, this is repeated.
"""

from typing import NamedTuple

import numpy as np
from push_control.perception.object_knowledge import ObjectKnowledge
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject

# Repetitions; chosen: each leaves less than a tenth of the error, so that 4 leave a micrometre.
REPETITIONS = 4
# Relative size below which an eigenvalue of a covariance is 0, as for supports on one line.
SINGULAR = 1e-9
# Least deviation that is kept [m], [1]; derived: below rounding there is nothing to scale.
MIN_DEVIATION = 1e-12


class FrictionMembers(NamedTuple):
    """
    Friction of the members of an ensemble.

    :param log_factors: logarithms of the friction of each support over its nominal value, shape
        (n, k).
    :param contact_friction: shape (n,).
    """

    log_factors: FloatArray
    contact_friction: FloatArray


def friction_centers(obj: PushedObject, log_factors: FloatArray) -> FloatArray:
    """
    Compute the centre of friction of every member.

    :param log_factors: as of ``FrictionMembers``, shape (n, k).
    :return: (x, y) in the object frame [m], shape (n, 2).
    """
    capacities = np.exp(log_factors) * np.array(obj.capacities)
    positions = np.array([(support.x, support.y) for support in obj.supports])
    return capacities @ positions / capacities.sum(axis=1, keepdims=True)


def knowledge_of(obj: PushedObject, members: FrictionMembers) -> ObjectKnowledge:
    """
    Summarize the friction of the members.

    :return: ``ObjectKnowledge``, with the greater deviation of the two axes for the centre.
    """
    centers = friction_centers(obj, members.log_factors)
    x, y = centers.mean(axis=0).tolist()
    return ObjectKnowledge((x, y), float(centers.std(axis=0).max()),
                           max(0.0, float(members.contact_friction.mean())),
                           float(members.contact_friction.std()))


def with_knowledge(obj: PushedObject, members: FrictionMembers,
                   knowledge: ObjectKnowledge) -> FrictionMembers:
    """
    Shift members to known means, and shrink their deviations to the known ones.

    Deviations that are smaller already stay as they are.

    :param members: ``FrictionMembers``, as drawn without knowledge.
    :param knowledge: ``ObjectKnowledge``, as it is by now.
    """
    centers = friction_centers(obj, members.log_factors)
    targets = _moved(centers, knowledge.friction_center, knowledge.center_deviation)
    log_factors = members.log_factors
    for _ in range(REPETITIONS):
        centers = friction_centers(obj, log_factors)
        anomalies = centers - centers.mean(axis=0)
        covariance = anomalies.T @ anomalies
        gain = np.linalg.pinv(covariance, rcond=SINGULAR, hermitian=True) @ (
            anomalies.T @ (log_factors - log_factors.mean(axis=0)))
        log_factors = log_factors + (targets - centers) @ gain
    friction = _moved(members.contact_friction[:, None], (knowledge.contact_friction,),
                      knowledge.contact_friction_deviation)
    return FrictionMembers(log_factors, np.maximum(0.0, friction[:, 0]))


def _moved(values: FloatArray, mean: tuple[float, ...], deviation: float) -> FloatArray:
    """Shift values to another mean, and shrink them to a deviation if theirs is greater."""
    anomalies = values - values.mean(axis=0)
    ratio = deviation / np.maximum(MIN_DEVIATION, anomalies.std(axis=0))
    return np.array(mean) + np.minimum(1.0, ratio) * anomalies
