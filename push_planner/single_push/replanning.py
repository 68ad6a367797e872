"""
Planning from measurements: from rest, or from the push that is under way.

The object's yaw rate is that of the model for the present pushing angle. Successive object poses
would tell it late and badly: 0.3 degrees of noise over 0.2 s are 0.04 rad/s, a tenth of a turn as
sharp as pushing allows, while the object follows the model within millimetres of way. Above about
0.3 m/s inertia makes the model too quick.
"""

import dataclasses
import math

from push_model.contact import contact_point, find_contact
from push_model.geometry import distance, Pose, wrap_angle
from push_model.plan_request import PlanFailure
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.robot_kinematics import contact_velocity
from push_planner.problem import InitialMotion, PlanningFailed, problem_from_placement
from push_planner.settings import PlannerSettings
from push_planner.single_push.planner import plan_push
from push_planner.single_push.site_selection import choose_site, SiteChoice

SLOWEST = 0.01
OLDEST = 0.5
MUCH_THE_SAME, TURNED = 0.3, 0.3


def plan_from_measurements(obj, robot, measured, odometry, goal, settings=None, previous=None):
    """
    Plan from the newest measurements, at the site that the settings ask for.

    A push that is under way goes on at its site, from its present motion, if it can: else it is
    planned as from rest.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param measured: ``ObjectPose``.
    :param odometry: ``Odometry``.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param previous: the last ``Plan``, or None.
    :return: ``push_planner.single_push.site_selection.SiteChoice``; its table is empty where no sites were compared.
    :raises PlanningFailed: with the reason.
    """
    settings, here = settings or PlannerSettings(), None
    try:
        here = problem_from_measurements(obj, robot, measured, odometry, goal, settings)
    except PlanningFailed as failure:
        if settings.site == 'current' or failure.code is not PlanFailure.NOT_IN_CONTACT:
            raise
    if here is not None and here.motion.speed > 0.0:
        try:
            return SiteChoice(plan_push(here, previous if _is_alike(previous, goal) else None), ())
        except PlanningFailed:
            here = dataclasses.replace(here, motion=InitialMotion())
    if settings.site == 'current':
        return SiteChoice(plan_push(here), ())
    return choose_site(obj, robot, measured.pose, goal, settings, here)


def problem_from_measurements(obj, robot, measured, odometry, goal, settings):
    """
    Make the problem of pushing on.

    :param obj: the ``PushedObject``.
    :param robot: the ``RoundRobot``.
    :param measured: ``ObjectPose``; while pushed it is carried on to the time of the odometry.
    :param odometry: ``Odometry``.
    :param goal: ``Pose`` wanted for the object in the world.
    :param settings: ``PlannerSettings``.
    :return: ``PushProblem``, with the present motion; from rest where the robot does not push.
    :raises PlanningFailed: where a pose is not finite or the robot is not at the object.
    """
    pose, age = measured.pose, max(0.0, odometry.time - measured.time)
    if _pushes(robot, odometry) and age <= OLDEST:
        pose = _carried(obj, robot, pose, odometry, age, settings.contact_tolerance)
    problem = problem_from_placement(obj, robot, pose, odometry.pose, goal, settings)
    velocity = contact_velocity(problem.heading, problem.normal, robot.radius, odometry.twist)
    angle = wrap_angle(math.atan2(velocity[1], velocity[0]) - problem.normal)
    if not _pushes(robot, odometry) or math.cos(angle) <= 0.0:
        return problem
    return dataclasses.replace(problem, motion=InitialMotion(
        math.hypot(*velocity), _turning(obj, problem.contact, pose, velocity), angle))


def _pushes(robot, odometry):
    return all(math.isfinite(value) for value in odometry.twist) and (
        math.isfinite(robot.radius)) and math.hypot(*odometry.twist[:2]) > SLOWEST


def _carried(obj, robot, pose, odometry, age, reach):
    """Carry an object's pose on by its age, at the robot's present velocity."""
    x, y, phi = odometry.pose
    v_x, v_y = Pose(0.0, 0.0, phi).rotate(odometry.twist[:2])
    then = Pose(x - age * v_x, y - age * v_y, phi - age * odometry.twist[2])
    if not (Pose(*pose).is_finite() and then.is_finite()):
        return pose
    contact, normal, gap = find_contact(obj, pose, then[:2], robot.radius)
    velocity = contact_velocity(then.theta, normal, robot.radius, odometry.twist)
    ahead = velocity[0] * math.cos(normal) + velocity[1] * math.sin(normal)
    if abs(gap) > reach or ahead <= 0.0:
        return pose
    turn = age * _turning(obj, contact, pose, velocity)
    c_x, c_y = pose.transform(contact_point(obj, contact))
    arm_x, arm_y = Pose(0.0, 0.0, turn).rotate((pose.x - c_x, pose.y - c_y))
    return Pose(c_x + age * velocity[0] + arm_x, c_y + age * velocity[1] + arm_y,
                pose.theta + turn)


def _turning(obj, contact, pose, velocity):
    local = Pose(0.0, 0.0, -pose.theta).rotate(velocity)
    return quasi_static_yaw_rate(obj, contact_point(obj, contact), *local)


def _is_alike(previous, goal):
    if previous is None:
        return False
    former = previous.problem.goal
    return (distance(former, goal) <= MUCH_THE_SAME
            and abs(wrap_angle(former.theta - goal.theta)) <= TURNED)
