"""
A time below which no robot brings an object to a goal.

First the robot must get to the object: its gap to it, at drive speed at most. Then friction must
be overcome. While it is pushed slowly, the power of the contact force f at the contact velocity u
is what the supports rub away: f . u = sum q_i |v_i|, of the friction q_i that each support can
bear and its velocity v_i. And f balances the friction on the supports, so that |f| is at most
sum q_i. Hence |u| is at least the mean of the |v_i|, weighted by the q_i; over time, the way of
the contact is at least the mean of how far the supports must go, whatever pushes where and how
often. It is made at pushing speed at most.

Left out: turning, touching, retreats, going round. Inertia lets an object slide on for
v^2 / (2 mu g), some millimetres per push, which is not taken off.
"""

import math

import numpy as np
from push_control.task.settings import SupervisionSettings
from push_model.contact import find_contact
from push_model.geometry import Pose
from push_navigation.settings import DriveSettings


def contact_path_bound(obj, start, goal, supervision=None):
    """
    Way of the contact at least [m], to within the tolerances of the goal.

    :param obj: the true ``PushedObject``.
    :param start: ``Pose`` of the object.
    :param goal: ``Pose`` wanted for it.
    :param supervision: ``SupervisionSettings`` for the tolerances, or None for the defaults.
    """
    allowed = supervision or SupervisionSettings()
    feet = np.array([(foot.x, foot.y) for foot in obj.supports])
    distances = np.hypot(*np.subtract([Pose(*goal).transform(foot) for foot in feet],
                                      [Pose(*start).transform(foot) for foot in feet]).T)
    slack = allowed.position_tolerance + allowed.heading_tolerance * np.hypot(*feet.T)
    return float(np.average(np.maximum(distances - slack, 0.0), weights=obj.capacities))


def gap(scenario):
    """
    Distance that the robot must drive at least before it touches [m].

    :param scenario: the ``Scenario``.
    """
    return find_contact(scenario.true_object, scenario.start.object.pose, scenario.robot_start[:2],
                        scenario.true_robot.radius)[2]


def least_time(scenario, drive=None):
    """
    Time that a task takes at least [s].

    :param scenario: the ``Scenario``.
    :param drive: ``DriveSettings``, or None for the defaults.
    """
    speed = (drive or DriveSettings()).limited_to(scenario.true_robot).speed
    distance = contact_path_bound(scenario.true_object, scenario.start.object.pose,
                                  scenario.goal.pose)
    if math.isclose(distance, 0.0):
        return 0.0
    return gap(scenario) / speed + distance / scenario.planner.pushing_speed
