"""
Identify friction from where recorded pushes end.

Unknown are

* the centre of friction F (x, y), object frame,
* the ratio of c^2, the mean square distance of the supports from F, to that of the nominal object,
* the contact friction mu_c,
* with more than three supports, how else friction is distributed between them: patterns that move
  neither F nor the sum, which are estimated along and not reported.

Slow pushes do not depend on mass, inertia and the size of the friction on the floor. With p the
unknowns in the order above (c^2 and mu_c as logarithms), e_j the end of push j as integrated by
``push_model.analysis.slow_push`` and l a length that makes angles lengths, the cost is

    sum_j |(x, y, l theta)(e_j(p) - end_j)|^2 / sigma^2 + sum_i ((p_i - p_i0) / s_i)^2

sigma is estimated from the median of what is left; a push that is off by more than OUTLIER sigma
counts less (Huber's weights); the second sum is the prior of the nominal object. The cost
is minimized by Gauss's and Newton's method with derivatives by differences, which are integrated
all at once.

Intervals: with A the information of the linearized problem and g_j the gradient of push j, the
deviation of a number is the greater of that by A^-1 and that by the jackknife over the pushes,

    (n - 1) / n  sum_j (A_-j^-1 g_j)^2,        A_-j without push j,

as the three numbers of an end do not err independently: what is wrong in a push, such as the place
of the robot along the face, is wrong in all of them. Student's t has as many degrees of freedom
as pushes tell of that number, ``(sum_j k_j)^2 / sum_j k_j^2`` with k_j the share of push j in its
variance: of contact friction only those tell that slide.
"""

import dataclasses
import math
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray
from push_control.identification.recorded_push import RecordedPush, stacked
from push_model.analysis.sliding_contact import SupportArrays
from push_model.analysis.slow_push import integrate_slow_pushes, Shape
from push_model.friction import friction_center
from push_model.geometry import FloatArray, wrap_angles
from push_model.interval import Interval
from push_model.parameters import PushedObject, Support
from scipy.linalg import null_space
from scipy.stats import norm, t as student

# Chosen: points of each path; the ends change by less than 0.5 % of the push with twice as many.
POINTS = 31
# Steps of the differences: metres, and two logarithms. Chosen: far above rounding.
DIFFERENCES = (1e-3, 1e-3, 0.02, 0.02)
PATTERN_DIFFERENCE = 0.02
# Chosen: converged long before.
ITERATIONS = 12
# Steps are halved so often where the cost would grow, and the search ends at a relative step of
# the cost below this.
HALVINGS = 5
ENOUGH = 1e-4
# Prior of a nominal object: F within a quarter of the root of c^2 of its place, c^2
# within 30 % and contact friction within a factor of 1.8 (one standard deviation each). Chosen.
CENTER_SHARE = 0.25
LOG_STD = 0.3
LOG_FRICTION = 0.6
PATTERN = 0.3
# A support keeps at least this part of its friction: so that F stays inside.
MIN_SHARE = 0.02
CONFIDENCE = 0.95
# Least degrees of freedom. Chosen: one push that tells nearly all leaves about the prior.
MIN_DEGREES = 3.0
# Huber's threshold, in standard deviations of a push's root mean square. Chosen, as usual.
OUTLIER = 2.0
# Least standard deviation [m]. Measured on recordings of the plant: what the points of the paths
# and the touch at the end leave; intervals then cover the truth about as often as stated.
MIN_SIGMA = 6e-4
NAMES = ('friction_center_x', 'friction_center_y', 'c_squared_ratio', 'contact_friction')


@dataclasses.dataclass(frozen=True)
class Identification:
    """
    Object identified from recorded pushes.

    :param friction_center_x: of F, object frame [m].
    :param friction_center_y: likewise [m].
    :param c_squared_ratio: c^2 over that of the nominal object.
    :param contact_friction: mu_c.
    :param sigma: standard deviation of what is left, per coordinate of an end [m].
    :param pushes: number of pushes.
    :param sliding: pushes in which the contact slides at some time, at the estimate.
    :param object: the nominal object with the identified friction.
    """

    friction_center_x: Interval
    friction_center_y: Interval
    c_squared_ratio: Interval
    contact_friction: Interval
    sigma: float
    pushes: int
    sliding: int
    object: PushedObject


class _Problem(NamedTuple):
    """Stacked pushes of a nominal object."""

    obj: PushedObject
    robot_radius: float
    starts: FloatArray
    ends: FloatArray
    paths: FloatArray
    is_free: FloatArray

    @property
    def patterns(self) -> int:
        """Number of distributions of friction that move neither F nor the sum."""
        return len(self.is_free) - len(NAMES)

    @property
    def differences(self) -> FloatArray:
        """Steps of the differences, shape (4 + patterns,)."""
        return np.array([*DIFFERENCES, *[PATTERN_DIFFERENCE] * self.patterns])

    @property
    def length(self) -> float:
        """Length that makes angles lengths: the root of the mean square distance from F [m]."""
        return math.sqrt(_mean_square(SupportArrays.of(self.obj)))

    @property
    def nominal(self) -> FloatArray:
        """Unknowns of the nominal object, shape (4 + patterns,)."""
        return np.array([*friction_center(self.obj), 0.0,
                         math.log(self.obj.contact_friction_coefficient),
                         *[0.0] * self.patterns])

    @property
    def stds(self) -> FloatArray:
        """Standard deviations of the prior about the nominal object, shape (4 + patterns,)."""
        center = CENTER_SHARE * self.length
        return np.array([center, center, LOG_STD, LOG_FRICTION, *[PATTERN] * self.patterns])

    def residuals(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ends minus measured ends for k sets of unknowns, (k, 3 n), and who slides."""
        sets, count = len(unknowns), len(self.starts)
        changed = [changed_supports(self.obj, row) for row in unknowns]
        supports = SupportArrays(np.repeat([one.positions for one in changed], count, axis=0),
                                 np.repeat([one.capacities for one in changed], count, axis=0))
        pushes = integrate_slow_pushes(
            Shape.of(self.obj), supports, np.repeat(np.exp(unknowns[:, 3]), count),
            self.robot_radius, np.tile(self.starts, (sets, 1)), np.tile(self.paths, (sets, 1, 1)))
        residuals = pushes.poses[:, -1] - np.tile(self.ends, (sets, 1))
        residuals[:, 2] = self.length * wrap_angles(residuals[:, 2])
        slides = (pushes.slides != 0).any(axis=1).reshape(sets, count)
        return residuals.reshape(sets, 3 * count), slides


def changed_supports(obj: PushedObject, unknowns: FloatArray) -> SupportArrays:
    """
    Change the friction of a nominal object.

    :param obj: nominal object.
    :param unknowns: F (x, y) [m], logarithm of the ratio of c^2, another, and an amount of each of
        ``friction_patterns``; those are 0 where they are left out.
    :return: supports: friction is shifted between them for F, and their distances from F are
        scaled for c^2.
    """
    positions, capacities = SupportArrays.of(obj)
    nominal = np.array(friction_center(obj))
    offsets = positions - nominal
    total = capacities.sum()
    covariance = offsets.T @ (capacities[:, None] * offsets) / total
    shares = 1.0 + offsets @ np.linalg.pinv(covariance, rcond=1e-9) @ (unknowns[:2] - nominal)
    patterns = friction_patterns(positions, capacities)
    shares = shares + patterns[:, :len(unknowns) - len(NAMES)] @ unknowns[len(NAMES):]
    changed = capacities * np.maximum(shares, MIN_SHARE)
    center = changed @ positions / changed.sum()
    return SupportArrays(center + math.exp(0.5 * unknowns[2]) * (positions - center),
                         changed * (total / changed.sum()))


def friction_patterns(positions: FloatArray, capacities: FloatArray) -> FloatArray:
    """
    Find relative changes of the capacities that move neither their sum nor their centre.

    :param positions: of the supports, shape (k, 2) [m].
    :param capacities: shape (k,) [N].
    :return: patterns with a root mean square of 1, shape (k, k - 3), or fewer columns.
    """
    moments = np.vstack([capacities, *(capacities * positions.T)])
    return null_space(moments) * math.sqrt(len(capacities))


def _mean_square(supports: SupportArrays) -> float:
    """Mean square distance of supports from their centre of friction [m^2]."""
    weights = supports.capacities / supports.capacities.sum()
    offsets = supports.positions - weights @ supports.positions
    return float(weights @ (offsets ** 2).sum(axis=1))


def identify(obj: PushedObject, robot_radius: float, pushes: Sequence[RecordedPush],
             free: Sequence[str] = NAMES) -> Identification:
    """
    Identify friction from recorded pushes.

    :param obj: nominal ``PushedObject``; its shape and the positions of its supports count, its
        friction is the prior.
    :param robot_radius: R_p [m].
    :param pushes: at least three.
    :param free: names of the unknowns, some of ``NAMES``; the others keep their nominal values.
    :return: the identification.
    :raises ValueError: for fewer than three pushes, or an unknown name.
    """
    if len(pushes) < 3:
        raise ValueError(f'pushes: got {len(pushes)}, expected at least 3 recorded pushes')
    unknown = sorted(set(free) - set(NAMES))
    if unknown:
        raise ValueError(f'free: got {", ".join(unknown)}, expected some of {", ".join(NAMES)}')
    patterns = friction_patterns(*SupportArrays.of(obj)).shape[1]
    is_free = np.array([name in free for name in NAMES] + [True] * patterns)
    problem = _Problem(obj, robot_radius, *stacked(pushes, POINTS), is_free)
    unknowns, slope, residuals, slides = _minimized(problem)
    sigma, weights = _weights(residuals, int(is_free.sum()))
    margin = np.zeros(len(is_free))
    margin[is_free] = _margins(slope, residuals, weights / sigma ** 2, problem.stds[is_free])
    low, high = unknowns - margin, unknowns + margin
    intervals = [Interval(*(float(value) for value in row))
                 for row in zip(unknowns, low, high)][:len(NAMES)]
    # Friction that is shifted between the supports changes c^2 as well.
    shifted = changed_supports(obj, np.array([*unknowns[:2], 0.0, *unknowns[3:]]))
    factor = _mean_square(shifted) / _mean_square(SupportArrays.of(obj))
    ratio = Interval(*(factor * math.exp(value) for value in intervals[2]))
    friction = Interval(*map(math.exp, intervals[3]))
    return Identification(intervals[0], intervals[1], ratio, friction, sigma, len(pushes),
                          int(slides.sum()), identified_object(obj, unknowns))


def identified_object(obj: PushedObject, unknowns: FloatArray) -> PushedObject:
    """
    Make the object with identified friction, its loads unchanged where the supports stay in place.

    :param obj: nominal object.
    :param unknowns: as of ``changed_supports``, the fourth the logarithm of mu_c.
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
    friction = [float(capacity) / max(load, 1e-3 * weight)
                for capacity, load in zip(capacities, moved.loads)]
    return dataclasses.replace(
        obj, supports=tuple(Support(x, y, mu) for (x, y), mu in zip(points, friction)),
        contact_friction_coefficient=math.exp(float(unknowns[3])))


def _weights(residuals: FloatArray, unknowns: int) -> tuple[float, FloatArray]:
    """Estimate the standard deviation of what is left [m], and weights (3 n,) of the pushes."""
    degrees = max(1.0, len(residuals) - unknowns)
    sizes = np.sqrt((residuals.reshape(-1, 3) ** 2).mean(axis=1))
    typical = max(MIN_SIGMA, float(np.median(sizes)) * math.sqrt(len(residuals) / degrees))
    weights = np.repeat(np.minimum(1.0, OUTLIER * typical / np.maximum(sizes, 1e-12)), 3)
    return max(MIN_SIGMA, math.sqrt(float(weights @ residuals ** 2) / degrees)), weights


def _margins(slope: FloatArray, residuals: FloatArray, weights: FloatArray,
             stds: FloatArray) -> FloatArray:
    """
    Find half the widths of the intervals.

    :param slope: derivatives of the residuals of n pushes, shape (3 n, u).
    :param residuals: shape (3 n,).
    :param weights: of their squares, shape (3 n,).
    :param stds: standard deviations of the prior, shape (u,).
    :return: shape (u,).
    """
    count = len(residuals) // 3
    prior = np.diag(1.0 / stds ** 2)
    each = slope.reshape(count, 3, -1)
    weighted = weights.reshape(count, 3, 1) * each
    informations = np.einsum('jka,jkb->jab', each, weighted)
    gradients = np.einsum('jka,jk->ja', weighted, residuals.reshape(count, 3))
    information = informations.sum(axis=0) + prior
    covariance = np.linalg.inv(information)
    steps = np.linalg.solve(information - informations, gradients[:, :, None])[..., 0]
    jackknife = np.sqrt((count - 1) / count * (steps ** 2).sum(axis=0))
    deviations = np.maximum(np.sqrt(np.diag(covariance)), jackknife)
    shares = np.einsum('ab,jbc,ca->ja', covariance, informations, covariance)
    telling = shares.sum(axis=0) ** 2 / np.maximum((shares ** 2).sum(axis=0), 1e-300)
    quantiles = student.ppf(0.5 * (1.0 + CONFIDENCE), np.maximum(MIN_DEGREES, telling))
    # Nothing is known worse than before the first push.
    prior_margins = stds * float(norm.ppf(0.5 * (1.0 + CONFIDENCE)))
    return np.minimum(quantiles * deviations, prior_margins)


def _minimized(problem: _Problem) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return unknowns (u,), derivatives (3 n, free), residuals (3 n,) and who slides (n,)."""
    free = np.flatnonzero(problem.is_free)
    unknowns = problem.nominal
    slope, residuals, slides = _linearized(problem, unknowns, free)
    for _ in range(ITERATIONS):
        better = _improved(problem, unknowns, free, (slope, residuals))
        if better is None:
            break
        unknowns = better
        slope, residuals, slides = _linearized(problem, unknowns, free)
    return unknowns, slope, residuals, slides


def _linearized(problem: _Problem, unknowns: FloatArray,
                free: NDArray[np.int_]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return derivatives (3 n, free), residuals (3 n,) and who slides (n,)."""
    residuals, slides = problem.residuals(
        np.vstack([unknowns, unknowns + np.diag(problem.differences)[free]]))
    slope = ((residuals[1:] - residuals[0]) / problem.differences[free, None]).T
    return slope, residuals[0], slides[0]


def _improved(problem: _Problem, unknowns: FloatArray, free: NDArray[np.int_],
              linearized: tuple[FloatArray, FloatArray]) -> FloatArray | None:
    """Take the best of the step and its halvings; None where the cost hardly falls."""
    slope, residuals = linearized
    sigma, weights = _weights(residuals, len(free))
    stds, off = problem.stds[free], (unknowns - problem.nominal)[free]
    step = np.zeros(len(unknowns))
    step[free] = -np.linalg.solve(
        slope.T @ (weights[:, None] * slope) / sigma ** 2 + np.diag(1.0 / stds ** 2),
        slope.T @ (weights * residuals) / sigma ** 2 + off / stds ** 2)
    tried = unknowns + 0.5 ** np.arange(HALVINGS)[:, None] * step
    others = problem.residuals(tried)[0]
    costs = (weights * (others / sigma) ** 2).sum(axis=1) + (
        ((tried - problem.nominal)[:, free] / stds) ** 2).sum(axis=1)
    cost = float(weights @ (residuals / sigma) ** 2 + (off / stds) @ (off / stds))
    best = int(np.argmin(costs))
    return tried[best] if costs[best] <= cost * (1.0 - ENOUGH) else None
