"""
Match of scan points to walls: Gauss-Newton on the signed distance.

With the prediction m of the pose (x, y, heading) and its covariance P, the residuals are the
signed distances s of the points from walls, with the gradient g and the Jacobian
J = (g_x, g_y, lever x g):

    w = q^2 min(1, a / l) / sigma^2,    q = 1 / (1 + s^2 / (rho^2 + J P J')),
    (H + P^-1) step = -(sum w s J + P^-1 (x - m)),    H = sum w J' J.

The robust width rho grows by what the prediction leaves open, so that a wall is not an outlier
because the robot is elsewhere. Beams that are a apart count together as one per length l of wall,
as a wall errs as a whole.
"""

import math
from typing import NamedTuple

import numpy as np
from push_localization.scan_points import ScanPoints
from push_localization.settings import PlaceSettings
from push_localization.wall_field import WallField
from push_model.geometry import FloatArray

# Steps at most, and the step below which they end [m], [rad]; chosen: three are enough while
# tracking, and less than a millimetre does not matter.
MAX_STEPS = 10
MIN_STEP = 2e-4


class Prior(NamedTuple):
    """
    What is known of a pose before a scan.

    :param pose: (x, y, heading), shape (3,) [m, m, rad].
    :param covariance: shape (3, 3).
    """

    pose: FloatArray
    covariance: FloatArray


class Match(NamedTuple):
    """
    Result of a match.

    :param pose: (x, y, heading), shape (3,) [m, m, rad].
    :param information: H of the scan alone, shape (3, 3).
    :param fit: part of the beams that end at walls, 0 to 1.
    """

    pose: FloatArray
    information: FloatArray
    fit: float


class _Linearization(NamedTuple):
    """Residuals of a scan at a pose, their Jacobian, and their weights."""

    residuals: FloatArray
    jacobian: FloatArray
    weights: FloatArray
    fit: float


class ScanMatcher:
    """Matches scans to the walls of one map."""

    def __init__(self, field: WallField, settings: PlaceSettings) -> None:
        """Take the walls."""
        self.field = field
        self._robust = settings.robust
        self._wall_length = settings.wall_length
        self._variance = settings.noise ** 2 + (settings.map_noise * field.resolution) ** 2

    def match(self, scan: ScanPoints, prior: Prior, start: FloatArray | None = None) -> Match:
        """
        Find the pose of the robot at the time of a scan.

        :param scan: ``ScanPoints``.
        :param prior: ``Prior``, the prediction.
        :param start: pose to begin at, shape (3,); None for the prediction.
        """
        pose = prior.pose.copy() if start is None else start.copy()
        prior_information = np.linalg.inv(prior.covariance)
        shares = np.minimum(1.0, scan.spacings / self._wall_length) / self._variance
        for _ in range(MAX_STEPS):
            at = self._linearized(scan, pose, prior.covariance, shares)
            weighted = at.jacobian * at.weights[:, None]
            information = weighted.T @ at.jacobian
            gradient = weighted.T @ at.residuals + prior_information @ _error(pose, prior.pose)
            step = np.linalg.solve(information + prior_information, gradient)
            pose -= step
            if np.abs(step).max() < MIN_STEP:
                break
        at = self._linearized(scan, pose, prior.covariance, shares)
        weighted = at.jacobian * at.weights[:, None]
        return Match(pose, weighted.T @ at.jacobian, at.fit)

    def _linearized(self, scan: ScanPoints, pose: FloatArray, covariance: FloatArray,
                    shares: FloatArray) -> _Linearization:
        """Compute residuals, Jacobian and weights; ``shares`` are weights without outliers."""
        levers = placed(scan.points, pose) - pose[:2]
        sample = self.field.sample(levers + pose[:2])
        g = sample.gradients
        jacobian = np.column_stack((g, levers[:, 0] * g[:, 1] - levers[:, 1] * g[:, 0]))
        spread = ((jacobian @ covariance) * jacobian).sum(axis=1)
        q = 1.0 / (1.0 + sample.distances ** 2 / (self._robust ** 2 + spread))
        return _Linearization(sample.distances, jacobian, q * q * shares, float((q * q).mean()))


def placed(points: FloatArray, pose: FloatArray) -> FloatArray:
    """
    Bring points from the frame of the robot to the world.

    :param points: (x, y), shape (n, 2) [m].
    :param pose: of the robot, (x, y, heading).
    :return: shape (n, 2) [m].
    """
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


def _error(pose: FloatArray, other: FloatArray) -> FloatArray:
    difference = pose - other
    difference[2] = math.remainder(difference[2], 2.0 * math.pi)
    return difference
