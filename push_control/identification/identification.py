"""
Identify friction from where recorded pushes end.

Unknown are, object by object,

* the centre of friction F (x, y), object frame,
* the ratio of c^2, the mean square distance of the supports from F, to that of the nominal object,
* with more than three supports, how else friction is distributed between them: patterns that move
  neither F nor the sum, which are estimated along and not reported,

and one contact friction mu_c for all objects, as the same robot pushes them. Slow pushes do not
depend on mass and inertia. A contact above the floor, at the height that the object's file states,
shifts loads in proportion to the friction on the floor, whose size is estimated along; nothing
else depends on it.

Statics gives F and c^2 where supports and mass centre are known and the floor is even. Whether
they are is left to the pushes: an object gets the prior ``FREE`` in place of ``STATICS`` where its
pushes say so (``push_control.identification.prior_choice``).

Intervals: with A the information of the linearized problem and g_j the gradient of push j, the
deviation of a number is the greater of that by A^-1 and that by the jackknife over the pushes,

    (n - 1) / n  sum_j (A_-j^-1 g_j)^2,        A_-j without push j,

as the three numbers of an end do not err independently: what is wrong in a push, such as the place
of the robot along the face, is wrong in all of them. Student's t has as many degrees of freedom
as pushes tell of that number, ``(sum_j k_j)^2 / sum_j k_j^2`` with k_j the share of push j in its
variance: of contact friction only those tell that slide.
"""

import dataclasses
import itertools
import math
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_control.identification.friction_changes import (
    changed_supports, CONTACT_FRICTION, FLOOR_FRICTION, identified_object, mean_square,
)
from push_control.identification.pooled_fit import Fit, fitted, FREE, Pool, STATICS
from push_control.identification.prior_choice import freed
from push_control.identification.push_set import PushSet
from push_control.identification.recorded_push import RecordedPush
from push_model.geometry import FloatArray
from push_model.interval import Interval
from push_model.parameters import PushedObject
from scipy.stats import norm, t as student

CONFIDENCE = 0.95
# Least degrees of freedom. Chosen: one push that tells nearly all leaves about the prior.
MIN_DEGREES = 3.0
MIN_PUSHES = 3


class PushedRecording(NamedTuple):
    """
    Recorded pushes of one object.

    :param object: nominal object; its shape, the positions of its supports and the height of its
        contact count, its friction is the prior.
    :param pushes: at least three.
    """

    object: PushedObject
    pushes: Sequence[RecordedPush]


@dataclasses.dataclass(frozen=True)
class Identification:
    """
    Object identified from recorded pushes.

    :param friction_center_x: of F, object frame [m].
    :param friction_center_y: likewise [m].
    :param c_squared_ratio: c^2 over that of the nominal object.
    :param contact_friction: mu_c, the same for all objects.
    :param sigma: standard deviation of what is left, per coordinate of an end [m], of all objects.
    :param pushes: number of pushes of this object.
    :param sliding: pushes in which the contact slides at some time, at the estimate.
    :param is_free: whether pushes say that friction on the floor is not as statics has it.
    :param object: the nominal object with the identified friction.
    """

    friction_center_x: Interval
    friction_center_y: Interval
    c_squared_ratio: Interval
    contact_friction: Interval
    sigma: float
    pushes: int
    sliding: int
    is_free: bool
    object: PushedObject


def identify(obj: PushedObject, robot_radius: float,
             pushes: Sequence[RecordedPush]) -> Identification:
    """
    Identify the friction of one object.

    :param obj: nominal object, as of ``PushedRecording``.
    :param robot_radius: R_p [m].
    :param pushes: at least three.
    :return: the identification.
    :raises ValueError: for fewer than three pushes.
    """
    return identify_together([PushedRecording(obj, pushes)], robot_radius)[0]


def identify_together(recordings: Sequence[PushedRecording],
                      robot_radius: float) -> tuple[Identification, ...]:
    """
    Identify the friction of objects that the same robot pushes, with one contact friction.

    :param recordings: of each object.
    :param robot_radius: R_p [m].
    :return: the identification of each.
    :raises ValueError: for fewer than three pushes of an object.
    """
    for recording in recordings:
        if len(recording.pushes) < MIN_PUSHES:
            raise ValueError(f'pushes: got {len(recording.pushes)}, expected at least '
                             f'{MIN_PUSHES} recorded pushes')
    pool = Pool.of([PushSet.of(obj, robot_radius, pushes) for obj, pushes in recordings])
    fit, are_free = _best_fit(pool)
    margins = _margins(fit)
    firsts = np.cumsum([0, *(len(one.starts) for one in pool.sets)])
    return tuple(
        _identification(one, fit.unknowns[columns], margins[columns], is_free, fit.sigma,
                        fit.linearization.slides[first:last])
        for one, columns, is_free, (first, last) in zip(
            pool.sets, pool.columns, are_free, itertools.pairwise(firsts)))


def _best_fit(pool: Pool) -> tuple[Fit, list[bool]]:
    """Free the friction on the floor of those objects of which pushes say so."""
    statics = fitted(pool, pool.stds([STATICS] * len(pool.sets)))
    free = fitted(pool, pool.stds([FREE] * len(pool.sets)), statics)
    are_free = freed(pool, statics, free)
    if all(are_free):
        return free, are_free
    if not any(are_free):
        return statics, are_free
    priors = [FREE if is_free else STATICS for is_free in are_free]
    return fitted(pool, pool.stds(priors), statics), are_free


def _identification(one: PushSet, unknowns: FloatArray, margins: FloatArray, is_free: bool,
                    sigma: float, slides: NDArray[np.bool_]) -> Identification:
    """State what was identified of one object."""
    x, y, log_ratio, log_friction = (
        Interval(float(value), float(value - margin), float(value + margin))
        for value, margin in zip(unknowns[:FLOOR_FRICTION], margins))
    # Friction that is shifted between the supports changes c^2 as well.
    unscaled = np.array([*unknowns[:2], 0.0, *unknowns[CONTACT_FRICTION:]])
    factor = mean_square(changed_supports(one.obj, unscaled)) / one.length ** 2
    ratio = Interval(*(factor * math.exp(value) for value in log_ratio))
    return Identification(x, y, ratio, Interval(*map(math.exp, log_friction)), sigma, len(slides),
                          int(slides.sum()), is_free, identified_object(one.obj, unknowns))


def _margins(fit: Fit) -> FloatArray:
    """Find half the widths of the intervals, shape (u,)."""
    slope, residuals, _ = fit.linearization
    count = len(residuals) // 3
    weights = fit.weights / fit.sigma ** 2
    each = slope.reshape(count, 3, -1)
    weighted = weights.reshape(count, 3, 1) * each
    informations = np.einsum('jka,jkb->jab', each, weighted)
    gradients = np.einsum('jka,jk->ja', weighted, residuals.reshape(count, 3))
    information = informations.sum(axis=0) + np.diag(1.0 / fit.stds ** 2)
    covariance = np.linalg.inv(information)
    steps = np.linalg.solve(information - informations, gradients[:, :, None])[..., 0]
    jackknife = np.sqrt((count - 1) / count * (steps ** 2).sum(axis=0))
    deviations = np.maximum(np.sqrt(np.diag(covariance)), jackknife)
    shares = np.einsum('ab,jbc,ca->ja', covariance, informations, covariance)
    telling = shares.sum(axis=0) ** 2 / np.maximum((shares ** 2).sum(axis=0), 1e-300)
    quantiles = student.ppf(0.5 * (1.0 + CONFIDENCE), np.maximum(MIN_DEGREES, telling))
    # Nothing is known worse than before the first push.
    prior_margins = fit.stds * float(norm.ppf(0.5 * (1.0 + CONFIDENCE)))
    return np.minimum(quantiles * deviations, prior_margins)
