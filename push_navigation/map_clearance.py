"""
Clearance from the obstacles of a map, for a robot whose place is not certain.

Odometry drifts, so that the standard deviation of the robot's place grows as it drives,

    sigma^2 = p^2 + (a r)^2 + (d s r / 2)^2,

with that at the start p, the errors of heading and distance a, the drift of the heading d, the
distance r from the start and the length s driven. A path keeps some standard deviations clear.

That bounds the deviation in all directions, whatever the path. Where there is less room, the path
itself tells more: a drift of the heading displaces a robot that has driven through the places q to
p along one line only, by

    d J (s p - int q ds),

J a quarter turn to the left: across a straight path, and so not across the door at its end round a
corner. Then the ellipse of these deviations is kept clear.
"""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import RoundRobot
from push_navigation.occupancy_map import OccupancyMap
from push_navigation.path import NoPathFound, PathFailure
from push_navigation.settings import DriveSettings

# Clearance that a robot gains per distance from a start where it has less than it should; chosen:
# it leads away from the obstacle within 30 degrees.
GAIN = 0.5
# Length of a path over the distance of its ends, where it is not known yet; chosen: that of a path
# through a door round a corner.
WINDING = 1.3
# Positions on the long axis of an ellipse of deviations, over half of it; chosen: the robot's disc
# about one reaches those about the next up to axes of twice its diameter.
AXIS_POSITIONS = (-1.0, -0.7, -0.35, 0.0, 0.35, 0.7, 1.0)


class PositionUncertainty(NamedTuple):
    """
    Uncertainty of the robot's position, and its growth.

    :param position: standard deviation of x or y [m].
    :param slope: by which it grows per distance from the start: that of the heading, and of
        measured distances [m/m].
    :param drift: standard deviation of the drift of the heading [rad/m].
    """

    position: float = 0.0
    slope: float = 0.0
    drift: float = 0.0

    def deviations(self, lengths: FloatArray, away: FloatArray) -> FloatArray:
        """
        Predict the standard deviations of the place along a path.

        :param lengths: driven to each place, shape (n,) [m].
        :param away: distance of each place from the start, shape (n,) [m].
        :return: shape (n,) [m].
        """
        return np.sqrt(self.position ** 2 + (self.slope * away) ** 2
                       + (0.5 * self.drift * lengths * away) ** 2)


CERTAIN = PositionUncertainty()


class MapContext(NamedTuple):
    """
    Limits of the room for a path.

    :param occupancy_map: the ``OccupancyMap``.
    :param uncertainty: ``PositionUncertainty`` of the robot.
    :param sigmas: standard deviations of its place by which it keeps clear of obstacles.
    """

    occupancy_map: OccupancyMap
    uncertainty: PositionUncertainty = CERTAIN
    sigmas: float = 2.0


class PositionEllipse(NamedTuple):
    """
    Ellipse of the standard deviations of a position.

    :param major: half its long axis [m].
    :param minor: half its short axis [m].
    :param angle: of the long axis in the world [rad].
    """

    major: float
    minor: float
    angle: float


class Shortfall(NamedTuple):
    """
    Place on a path that lacks room for a robot which does not know its position.

    :param x: of the place [m].
    :param y: of the place [m].
    :param clearance: of the place [m].
    :param required: clearance that the robot's centre needs there [m].
    :param deviation: standard deviation of the robot's position there [m].
    :param ellipse: ``PositionEllipse`` of the robot there.
    :param path: points (x, y) along it, shape (n, 2) [m].
    """

    x: float
    y: float
    clearance: float
    required: float
    deviation: float
    ellipse: PositionEllipse
    path: FloatArray


class MapClearance(NamedTuple):
    """
    Clearance that one path keeps from obstacles.

    :param context: ``MapContext``.
    :param radius: of the robot [m].
    :param start: of the path (x, y) [m].
    :param margin: kept everywhere [m].
    :param gap: of the robot at the start [m].
    :param counts_drift: whether ``required`` counts the drift of the heading; else that is up to
        ``is_free``.
    """

    context: MapContext
    radius: float
    start: tuple[float, float]
    margin: float
    gap: float
    counts_drift: bool = True

    def required(self, points: FloatArray, lengths: FloatArray | None = None) -> FloatArray:
        """
        Compute the clearance that the robot's centre needs [m].

        :param points: (x, y), shape (n, 2) [m].
        :param lengths: driven to each of them, shape (n,) [m]; None where it is not known.
        :return: shape (n,).
        """
        away = np.hypot(*(np.asarray(points)[:, :2] - self.start).T)
        uncertainty = self.context.uncertainty
        if not self.counts_drift:
            uncertainty = uncertainty._replace(drift=0.0)
        deviations = uncertainty.deviations(
            WINDING * away if lengths is None else lengths, away)
        # What the start lacks cannot be had near it.
        margins = np.minimum(self.context.sigmas * deviations, self.gap + GAIN * away)
        return self.radius + np.maximum(self.margin, margins)

    def is_free(self, poses: FloatArray, slack: float = 0.0) -> bool:
        """
        Tell whether a path keeps clear.

        :param poses: (x, y, theta) along it, from its start on, shape (n, 3).
        :param slack: that the clearance may lack [m].
        """
        points = np.asarray(poses)[:, :2]
        lengths = _driven_lengths(points)
        clearance = self.context.occupancy_map.clearance(points)
        if np.all(clearance >= self.required(points, lengths) - slack):
            return True
        without_drift = self._replace(counts_drift=False).required(points)
        if not np.all(clearance >= without_drift - slack):
            return False
        return self._is_free_along(points, _levers(points, lengths),
                                   without_drift - self.radius, slack)

    def shortfall(self, poses: FloatArray) -> Shortfall | None:
        """
        Find where a path lacks most of the clearance that it needs, the drift in all directions.

        :param poses: (x, y, theta) along it, from its start on, shape (n, 3).
        :return: ``Shortfall``, None where it lacks none.
        """
        points = np.asarray(poses)[:, :2]
        lengths = _driven_lengths(points)
        clearances = self.context.occupancy_map.clearance(points)
        required = self.required(points, lengths)
        worst = int(np.argmax(required - clearances))
        if clearances[worst] >= required[worst]:
            return None
        away = np.hypot(*(points - self.start).T)
        deviations = self.context.uncertainty.deviations(lengths, away)
        ellipse = self._ellipse(_levers(points, lengths)[worst], float(away[worst]))
        return Shortfall(float(points[worst, 0]), float(points[worst, 1]),
                         float(clearances[worst]), float(required[worst]),
                         float(deviations[worst]), ellipse, points)

    def _ellipse(self, lever: FloatArray, away: float) -> PositionEllipse:
        """
        Predict the ellipse of the deviations at a place of a path.

        :param lever: ``s p - int q ds`` there, shape (2,) [m^2].
        :param away: from the start [m].
        """
        uncertainty = self.context.uncertainty
        x, y = -uncertainty.drift * lever[1], uncertainty.drift * lever[0]
        minor = math.hypot(uncertainty.position, uncertainty.slope * away)
        return PositionEllipse(math.hypot(minor, x, y), minor, math.atan2(y, x))

    def _is_free_along(self, points: FloatArray, levers: FloatArray, others: FloatArray,
                       slack: float) -> bool:
        """
        Tell whether the ellipses of the deviations are clear.

        :param points: (x, y) along the path, shape (n, 2) [m].
        :param levers: ``s p - int q ds`` of each, shape (n, 2) [m^2].
        :param others: what the deviations besides the drift need, shape (n,) [m].
        :param slack: that the clearance may lack [m].
        """
        axes = self.context.sigmas * self.context.uncertainty.drift * np.column_stack(
            [-levers[:, 1], levers[:, 0]])
        # What the start lacks cannot be had near it.
        away = np.hypot(*(points - points[0]).T)
        lengths = np.hypot(*axes.T)
        axes *= np.minimum(1.0, (self.gap + GAIN * away) / np.maximum(lengths, 1e-9))[:, None]
        for position in AXIS_POSITIONS:
            distances = self.context.occupancy_map.clearance(points + position * axes)
            needed = self.radius + math.sqrt(1.0 - position * position) * others
            if np.any(distances < needed - slack):
                return False
        return True


def _driven_lengths(points: FloatArray) -> FloatArray:
    """Lengths driven from the first of some points to each [m]."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _levers(points: FloatArray, lengths: FloatArray) -> FloatArray:
    """
    Compute by which levers a drift of the heading has displaced the robot along a path.

    :param points: (x, y) along it, shape (n, 2) [m].
    :param lengths: driven to each, shape (n,) [m].
    :return: ``s p - int q ds`` of each, shape (n, 2) [m^2].
    """
    away = points - points[0]
    middles = 0.5 * (away[:-1] + away[1:]) * np.diff(lengths)[:, None]
    moments = np.concatenate([np.zeros((1, 2)), np.cumsum(middles, axis=0)])
    return lengths[:, None] * away - moments


def map_clearance(robot: RoundRobot, start: Pose, goal: Pose, settings: DriveSettings,
                  context: MapContext) -> MapClearance:
    """
    Find what a path keeps clear of obstacles, no more than it has at its start.

    :raises NoPathFound: where the robot would overlap an obstacle at the start, or be too near to
        one at the goal.
    """
    here, there = context.occupancy_map.clearance([start[:2], goal[:2]]).tolist()
    if here < robot.radius:
        raise NoPathFound(PathFailure.START_IN_OBSTACLE.report(x=start.x, y=start.y))
    gap = here - robot.radius
    margins = MapClearance(context, robot.radius, start[:2], min(settings.map_clearance, gap), gap)
    if there < margins.radius + margins.margin:
        raise NoPathFound(PathFailure.GOAL_NEAR_OBSTACLE.report(x=goal.x, y=goal.y))
    least = margins._replace(counts_drift=False).required(np.array([goal[:2]]))
    if there < float(least[0]):
        raise NoPathFound(PathFailure.GOAL_TOO_UNCERTAIN.report(x=goal.x, y=goal.y))
    return margins
