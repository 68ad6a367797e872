"""The view: where poses of the object are expected, as a camera or a tracker sees it."""

from collections.abc import Mapping
import math
from typing import NamedTuple

from push_control.supervision_settings import SupervisionSettings
from push_model.geometry import distance, Pose, wrap_angle

# Margins at the nearest distance [m] and at the edge of the view [rad] within which poses may come
# or not; chosen: a camera sees less of an object at the edge of its picture.
GAP_MARGIN = 0.03
ANGLE_MARGIN = 0.1
# Time without a pose after which an object is out of view [s]; chosen: some periods of a camera.
UNSEEN_TIME = 0.6
# Names of the fields in diagnostics: those of their parameters.
REPORTED_NAMES = 'view_angle', 'view_nearest', 'view_farthest'
# Standard deviations of the robot relative to the object that are added to these margins.
MARGIN_SIGMAS = 2.0


class View(NamedTuple):
    """
    Poses from which the object is seen: all, unless something is stated.

    :param half_angle: greatest angle between the robot's heading and the origin of the object at
        which poses come [rad]; pi for all round.
    :param nearest: least gap between robot and object with poses [m]; 0 for in contact, too.
    :param farthest: greatest distance from the robot's centre to the origin with poses [m].
    """

    half_angle: float = math.pi
    nearest: float = 0.0
    farthest: float = math.inf

    @classmethod
    def from_settings(cls, supervision: SupervisionSettings) -> 'View':
        """Read the view that is stated."""
        return cls(supervision.view_angle, supervision.view_nearest, supervision.view_farthest)

    @classmethod
    def from_report(cls, values: Mapping[str, str]) -> 'View | None':
        """
        Read the view that a controller reports.

        :param values: of its diagnostic, by name.
        :return: None where it reports none.
        """
        try:
            return cls(*(float(values[name]) for name in REPORTED_NAMES))
        except (KeyError, ValueError):
            return None

    def to_report(self) -> dict[str, float]:
        """Return the values of the diagnostic, by name; none where the object is always seen."""
        return {} if self == View() else dict(zip(REPORTED_NAMES, self))

    def expects(self, robot: Pose, obj: Pose, gap: float, position_std: float = 0.0,
                heading_std: float = 0.0) -> bool:
        """
        Tell whether poses of the object have to come, with the margins of the view.

        :param robot: ``Pose`` of the robot.
        :param obj: ``Pose`` of the object.
        :param gap: between them [m].
        :param position_std: standard deviation of the robot relative to the object [m].
        :param heading_std: the same of its heading [rad].
        """
        return (self._is_far_enough(gap, position_std)
                and distance(robot, obj) <= self.farthest
                and self.faces(robot, obj, position_std, heading_std))

    def faces(self, robot: Pose, obj: Pose, position_std: float = 0.0,
              heading_std: float = 0.0) -> bool:
        """
        Tell whether the robot faces the object well enough to see it.

        :param robot: as of ``expects``.
        :param obj: as of ``expects``.
        :param position_std: as of ``expects``.
        :param heading_std: as of ``expects``.
        """
        if self.half_angle >= math.pi:
            return True
        away = max(distance(robot, obj), position_std)
        angular_std = heading_std + (position_std / away if away > 0.0 else 0.0)
        limit = self.half_angle - ANGLE_MARGIN - MARGIN_SIGMAS * angular_std
        return abs(bearing(robot, obj)) <= limit

    def _is_far_enough(self, gap: float, position_std: float) -> bool:
        return self.nearest == 0.0 or (
            gap >= self.nearest + GAP_MARGIN + MARGIN_SIGMAS * position_std)


def bearing(robot: Pose, obj: Pose) -> float:
    """
    Return the direction of the origin of an object from the heading of a robot.

    :return: angle [rad], counterclockwise, 0 straight ahead.
    """
    return wrap_angle(math.atan2(obj.y - robot.y, obj.x - robot.x) - robot.theta)
