"""Parameters of the planner's node."""

from typing import NamedTuple

from push_model.parameters import PushedObject, RoundRobot
from push_navigation.settings import DriveSettings, MapSettings
from push_planner.settings import PlannerSettings


class PlannerParameters(NamedTuple):
    """
    Parameters of the planner, by section.

    :param object: the ``PushedObject`` to be prepared for.
    :param robot: the ``RoundRobot``.
    :param planner: ``PlannerSettings``.
    :param drive: ``DriveSettings``; for tasks.
    :param map_settings: ``MapSettings``; for tasks.
    """

    object: PushedObject
    robot: RoundRobot
    planner: PlannerSettings
    drive: DriveSettings
    map_settings: MapSettings
