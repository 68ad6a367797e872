"""
What each support carries: loads that balance the weight about the mass centre.

Up to three supports (not in a line) are statically determinate. With more, the object is taken as
a rigid plate on feet of equal stiffness that cannot pull, unless shares are given.
"""

import numpy as np
from scipy.optimize import nnls

BALANCE_TOLERANCE = 0.01
STIFF = 1e5


def load_shares(points, given, center):
    """
    Share of the weight on each support.

    :param points: places of the supports, shape (k, 2) [m].
    :param given: relative shares, one per support; all 0 where none are given.
    :param center: mass centre (x, y) [m], same frame.
    :return: tuple of k shares that sum up to 1.
    :raises ValueError: where the object would tip, where given shares do not balance it, or where
        only some are given; the text has no name in front.
    """
    points, given, center = (np.array(v, dtype=float) for v in (points, given, center))
    reach = max(float(np.abs(points - center).max()), 1e-9)
    shares = _balanced((points - center) / reach)
    if shares is None:
        raise ValueError(f'got a mass centre at ({center[0]:g}, {center[1]:g}), expected it '
                         'inside the hull of the supports: the object would tip')
    if given.any() and not given.all():
        raise ValueError(f'got load shares {given.tolist()}, expected one above 0 for every '
                         'support, or none')
    given = given / given.sum() if given.any() else shares
    pressure = given @ points
    if np.abs(pressure - center).max() > BALANCE_TOLERANCE * reach:
        raise ValueError(f'got load shares that balance about ({pressure[0]:.4g}, '
                         f'{pressure[1]:.4g}), expected about the mass centre ({center[0]:g}, '
                         f'{center[1]:g}): change either, or give no shares')
    # Where statics leave no choice, rounded shares do not count.
    return tuple((shares if _is_determinate(points) else given).tolist())


def _is_determinate(points):
    return np.linalg.matrix_rank(np.column_stack([np.ones(len(points)), points])) == len(points)


def _balanced(points):
    # Least squares of the loads among all that balance: springs of equal stiffness under a plate.
    rows = np.vstack([np.ones(len(points)), points.T])
    want = np.array([1.0, 0.0, 0.0])
    rough, _ = nnls(np.vstack([STIFF * rows, np.eye(len(points))]),
                    np.concatenate([STIFF * want, np.zeros(len(points))]))
    # A foot without load is allowed: a mass centre on the edge of the hull is at the limit.
    carrying = rough > 1e-9
    shares = np.zeros(len(points))
    shares[carrying] = np.linalg.lstsq(rows[:, carrying], want, rcond=None)[0]
    balances = np.abs(rows @ shares - want).max() < 1e-6 and shares.min() > -1e-6
    return np.maximum(shares, 0.0) if balances else None
