"""Search for the place of a scan on a grid of poses, from which a match finds the rest."""

import math
from typing import NamedTuple

import numpy as np
from push_localization.matching import Prior
from push_localization.scan_points import ScanPoints
from push_localization.wall_field import WallField
from push_model.geometry import FloatArray

# Spacing of the grid [m], [rad]; chosen: from its nearest node a match converges.
STEP, HEADING_STEP = 0.1, math.radians(2.0)
# Beams that are compared; chosen: every few centimetres of a wall would tell the same.
BEAMS = 60
# Standard deviation of a beam's end from a wall, and the distance at which it counts half [m];
# chosen: half a diagonal of the grid, and what has moved since the map was made.
SIGMA, ROBUST = 0.1, 0.3
# Standard deviations of the prediction to which a start is searched; chosen.
RANGE_SIGMAS = 2.5


class SearchRange(NamedTuple):
    """
    Range of a search to either side.

    :param distance: along each axis [m].
    :param angle: of the heading [rad].
    """

    distance: float
    angle: float


def search(field: WallField, scan: ScanPoints, prior: Prior, reach: SearchRange) -> FloatArray:
    """
    Find the node of a grid round a prediction at which a scan and the prediction fit best.

    :param field: ``WallField``.
    :param scan: ``ScanPoints``.
    :param prior: ``Prior``, the centre of the grid.
    :param reach: ``SearchRange``.
    :return: pose (x, y, heading), shape (3,) [m, m, rad].
    """
    points = scan.points[::max(1, len(scan.points) // BEAMS)]
    offsets = _steps(reach.distance, STEP)
    x, y = (axis.ravel() for axis in np.meshgrid(offsets, offsets))
    information = np.linalg.inv(prior.covariance)
    best, least = prior.pose, math.inf
    for turn in _steps(reach.angle, HEADING_STEP).tolist():
        angle = prior.pose[2] + turn
        c, s = math.cos(angle), math.sin(angle)
        levers = points @ np.array([[c, s], [-s, c]])
        errors = np.stack((x, y, np.full(x.shape, turn)), axis=1)
        ends = levers[None] + (prior.pose[:2] + errors[:, :2])[:, None]
        squares = field.nearest_distances(ends).astype(float) ** 2
        costs = (squares / (1.0 + squares / ROBUST ** 2)).sum(axis=1) / SIGMA ** 2
        costs += ((errors @ information) * errors).sum(axis=1)
        index = int(costs.argmin())
        if costs[index] < least:
            least, best = float(costs[index]), prior.pose + errors[index]
    return best


def start_range(covariance: FloatArray) -> SearchRange:
    """
    Return the range that covers a prediction.

    :param covariance: of it, shape (3, 3).
    """
    stds = RANGE_SIGMAS * np.sqrt(np.diag(covariance))
    return SearchRange(float(stds[:2].max()), float(min(stds[2], math.pi)))


def likelihood(field: WallField, points: FloatArray) -> float:
    """
    Tell how well the ends of beams lie on walls.

    :param field: ``WallField``.
    :param points: ends in the world, shape (n, 2) [m].
    :return: from 0 to 1.
    """
    distances = field.sample(points).distances
    return float(np.exp(-0.5 * (distances / SIGMA) ** 2).mean())


def _steps(reach: float, step: float) -> FloatArray:
    count = math.ceil(reach / step)
    return np.array([step * index for index in range(-count, count + 1)])
