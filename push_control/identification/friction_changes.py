"""
What may be wrong about the friction of a nominal object: the unknowns of identification.

The unknowns of one object stand in a row:

* F (x, y), the centre of friction, object frame [m];
* the logarithm of the ratio of c^2, the mean square distance of the supports from F, to the
  nominal one;
* the logarithm of the contact friction mu_c;
* the logarithm of the ratio of all friction on the floor to the nominal one;
* with more than three supports, amounts of the *patterns*: distributions of friction between them
  that move neither F nor the sum.
"""

import dataclasses
import math

import numpy as np
from push_model.analysis.sliding_contact import SupportArrays
from push_model.analysis.slow_push import LoadedSupports
from push_model.friction import friction_center, load_gradients
from push_model.geometry import FloatArray
from push_model.parameters import PushedObject, Support
from scipy.linalg import null_space

# Where the logarithm of mu_c stands in a row of unknowns, and where the patterns begin.
CONTACT_FRICTION = 3
FLOOR_FRICTION = 4
PATTERNS = 5
# A support keeps at least this part of its friction: so that F stays inside.
MIN_SHARE = 0.02
# A support that carries less than this part of the weight gets no greater mu. Chosen: rounding.
MIN_LOAD = 1e-3


def nominal_unknowns(obj: PushedObject) -> FloatArray:
    """
    Return the unknowns that change nothing.

    :param obj: nominal object.
    :return: unknowns, shape (5 + patterns,).
    """
    patterns = friction_patterns(*SupportArrays.of(obj)).shape[1]
    return np.array([*friction_center(obj), 0.0, math.log(obj.contact_friction_coefficient),
                     0.0, *[0.0] * patterns])


def changed_supports(obj: PushedObject, unknowns: FloatArray) -> SupportArrays:
    """
    Change the friction of a nominal object.

    :param obj: nominal object.
    :param unknowns: of the object.
    :return: supports: friction is shifted between them for F, and their distances from F are
        scaled for c^2.
    """
    positions, capacities = SupportArrays.of(obj)
    nominal = np.array(friction_center(obj))
    offsets = positions - nominal
    total = capacities.sum()
    covariance = offsets.T @ (capacities[:, None] * offsets) / total
    shares = 1.0 + offsets @ np.linalg.pinv(covariance, rcond=1e-9) @ (unknowns[:2] - nominal)
    shares = shares + friction_patterns(positions, capacities) @ unknowns[PATTERNS:]
    changed = capacities * np.maximum(shares, MIN_SHARE)
    center = changed @ positions / changed.sum()
    total *= math.exp(unknowns[FLOOR_FRICTION])
    return SupportArrays(center + math.exp(0.5 * unknowns[2]) * (positions - center),
                         changed * (total / changed.sum()))


def changed_loaded_supports(obj: PushedObject, unknowns: FloatArray) -> LoadedSupports:
    """
    Change the friction of a nominal object, and how its loads shift.

    :param obj: nominal object, with the height of its contact.
    :param unknowns: of the object.
    :return: supports; each with the coefficient of its changed capacity and its nominal load.
    """
    changed = changed_supports(obj, unknowns)
    friction = changed.capacities / np.maximum(obj.loads, MIN_LOAD * sum(obj.loads))
    gradients = math.exp(-0.5 * unknowns[2]) * np.array(load_gradients(obj))
    return LoadedSupports(changed, obj.contact_height * friction[:, None] * gradients)


def friction_patterns(positions: FloatArray, capacities: FloatArray) -> FloatArray:
    """
    Find relative changes of the capacities that move neither their sum nor their centre.

    :param positions: of the supports, shape (k, 2) [m].
    :param capacities: shape (k,) [N].
    :return: patterns with a root mean square of 1, shape (k, k - 3), or fewer columns.
    """
    moments = np.vstack([capacities, *(capacities * positions.T)])
    return null_space(moments) * math.sqrt(len(capacities))


def identified_object(obj: PushedObject, unknowns: FloatArray) -> PushedObject:
    """
    Make the object with identified friction, its loads unchanged where the supports stay in place.

    :param obj: nominal object.
    :param unknowns: of the object.
    :return: the object; each support keeps its share of the load by ``load_fraction``.
    """
    positions, capacities = changed_supports(obj, unknowns)
    # Loads as before; the friction coefficients carry the rest.
    weight = sum(obj.loads)
    points = [(support.x, support.y) for support in obj.supports]
    if abs(unknowns[2]) > 1e-12:
        points = [(float(x), float(y)) for x, y in positions]
    supports = tuple(Support(x, y, 1.0) for x, y in points)
    moved = dataclasses.replace(obj, supports=supports)
    friction = [float(capacity) / max(load, MIN_LOAD * weight)
                for capacity, load in zip(capacities, moved.loads)]
    return dataclasses.replace(
        obj, supports=tuple(Support(x, y, mu) for (x, y), mu in zip(points, friction)),
        contact_friction_coefficient=math.exp(float(unknowns[CONTACT_FRICTION])))


def mean_square(supports: SupportArrays) -> float:
    """Mean square distance of supports from their centre of friction [m^2]."""
    weights = supports.capacities / supports.capacities.sum()
    offsets = supports.positions - weights @ supports.positions
    return float(weights @ (offsets ** 2).sum(axis=1))
