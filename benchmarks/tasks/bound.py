"""
Lower bound on the time in which any robot brings an object to a goal.

First the robot closes its gap to the object, at drive speed at most. Then friction must be
overcome. While the object is pushed slowly, the power of the contact force f at the contact
velocity u is dissipated at the supports: f . u = sum q_i |v_i|, with the friction capacity q_i and
the velocity v_i of each support. Since f balances the friction at the supports, |f| is at most
sum q_i. Hence |u| is at least the mean of the |v_i|, weighted by the q_i; integrated over time,
the path length of the contact is at least the weighted mean of the distances that the supports
must travel, whatever pushes where and how often. It is travelled at the greatest speed of a push.

Not included: rotations of the robot, guarded approaches, retreats and detours. Inertia lets an
object slide on for v^2 / (2 mu g), some millimetres per push, which is not subtracted.
"""

import math
from typing import Optional

import numpy as np
from push_control.supervision_settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_navigation.settings import DriveSettings
from push_planner.straight.trajectory import greatest_speed
from push_scenario.definition.scenario import Scenario


def contact_path_bound(obj: PushedObject, start: Pose, goal: Pose,
                       supervision: Optional[SupervisionSettings] = None) -> float:
    """
    Bound the path length of the contact from below, to within the tolerances of the goal [m].

    :param obj: the true ``PushedObject``.
    :param start: ``Pose`` of the object.
    :param goal: goal ``Pose`` of the object.
    :param supervision: ``SupervisionSettings`` for the tolerances, or None for the defaults.
    """
    tolerances = supervision or SupervisionSettings()
    feet = np.array([(foot.x, foot.y) for foot in obj.supports])
    distances = np.hypot(*np.subtract([Pose(*goal).transform(foot) for foot in feet],
                                      [Pose(*start).transform(foot) for foot in feet]).T)
    slack = tolerances.position_tolerance + tolerances.heading_tolerance * np.hypot(*feet.T)
    return float(np.average(np.maximum(distances - slack, 0.0), weights=obj.capacities))


def gap(scenario: Scenario) -> float:
    """
    Return the distance that the robot must drive at least before it touches the object [m].

    :param scenario: the ``Scenario``.
    """
    return find_contact(scenario.true_object, scenario.start.object.pose, scenario.robot_start[:2],
                        scenario.true_robot.radius)[2]


def least_time(scenario: Scenario, drive: Optional[DriveSettings] = None) -> float:
    """
    Return the time that a task takes at least [s].

    :param scenario: the ``Scenario``.
    :param drive: ``DriveSettings``, or None for the defaults.
    """
    speed = (drive or DriveSettings()).limited_to(scenario.true_robot).speed
    distance = contact_path_bound(scenario.true_object, scenario.start.object.pose,
                                  scenario.goal.pose)
    if math.isclose(distance, 0.0):
        return 0.0
    pushing = greatest_speed(scenario.true_robot, scenario.planner)
    return gap(scenario) / speed + distance / pushing
