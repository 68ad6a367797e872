"""
Replanning: plans from measurements, from rest or from the push that is under way.

The object's yaw rate is that of the quasi-static model at the present pushing angle. Successive
object poses would give it late and inaccurately: 0.3 degrees of noise over 0.2 s are 0.04 rad/s, a
tenth of the tightest turn, while the object follows the model within millimetres of path. Above
about 0.3 m/s inertia makes the model's yaw rate too high.
"""

import dataclasses
import math
from typing import Optional

from push_model.contact import contact_point, find_contact
from push_model.geometry import distance, Pose, wrap_angle
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.plan_request import GoalTolerances, PlanFailure
from push_model.quasi_static import quasi_static_yaw_rate
from push_model.robot_kinematics import contact_velocity
from push_model.signals import ObjectPose, Odometry
from push_model.trajectory import PushTrajectory
from push_planner.outlook import push_outlook
from push_planner.problem import InitialMotion, PlanningFailed, problem_from_placement, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.feasibility import check_not_at_goal
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from push_planner.steered.site_selection import choose_site, SiteChoice

# Speed below which a robot does not push [m/s]. Chosen: above the noise of odometry at rest.
MIN_SPEED = 0.01
# Age beyond which an object pose is not predicted [s]. Chosen: at 0.15 m/s, 75 mm of path.
MAX_AGE = 0.5
# Distance and angle between two goals for which the previous plan is a good start [m, rad].
SIMILAR_DISTANCE = 0.3
SIMILAR_ANGLE = 0.3


def plan_from_measurements(obj: PushedObject, robot: RoundRobot, measured: ObjectPose,
                           odometry: Odometry, goal: Pose,
                           settings: Optional[PlannerSettings] = None, *,
                           previous: Optional[Plan] = None,
                           tolerances: Optional[GoalTolerances] = None) -> SiteChoice:
    """
    Plan from the newest measurements, at the site that the settings ask for.

    A push that is under way goes on at its site, from its present motion, if it can: else it is
    planned as from rest.

    :param goal: ``Pose`` of the object in the world at the end.
    :param settings: ``PlannerSettings``, or None for the defaults.
    :param previous: the last ``Plan``, or None.
    :param tolerances: ``GoalTolerances`` within which no push is needed, or None for the accuracy
        of plans.
    :raises PlanningFailed: with the reason.
    """
    settings = settings or PlannerSettings()
    check_not_at_goal(measured.pose, goal, settings, tolerances)
    current: Optional[PushProblem] = None
    try:
        current = problem_from_measurements(obj, robot, measured, odometry, goal, settings)
    except PlanningFailed as failure:
        if settings.site == 'current' or failure.code is not PlanFailure.NOT_IN_CONTACT:
            raise
    if current is not None and current.motion.speed > 0.0:
        try:
            start_from = previous if _is_similar(previous, goal) else None
            return SiteChoice(plan_push(current, start_from), ())
        except PlanningFailed:
            current = dataclasses.replace(current, motion=InitialMotion())
    if current is not None and settings.site == 'current':
        return SiteChoice(plan_push(current), ())
    return choose_site(obj, robot, measured.pose, goal, settings, current)


def stated_trajectory(plan: Plan, tolerances: GoalTolerances) -> PushTrajectory:
    """
    Give the trajectory of a single push its outlook.

    :param tolerances: ``GoalTolerances`` within which the object counts as at its goal.
    """
    outlook = push_outlook(plan.motion.duration, tolerances)
    return dataclasses.replace(plan.trajectory, outlook=outlook)


def problem_from_measurements(obj: PushedObject, robot: RoundRobot, measured: ObjectPose,
                              odometry: Odometry, goal: Pose,
                              settings: PlannerSettings) -> PushProblem:
    """
    Make the problem of pushing on.

    :param measured: ``ObjectPose``; while pushed it is predicted to the time of the odometry.
    :param goal: ``Pose`` of the object in the world at the end.
    :return: ``PushProblem``, with the present motion; from rest where the robot does not push.
    :raises PlanningFailed: where a pose is not finite or the robot is not at the object.
    """
    pose, age = measured.pose, max(0.0, odometry.time - measured.time)
    is_pushing = _is_pushing(robot, odometry)
    if is_pushing and age <= MAX_AGE:
        pose = _predicted(obj, robot, pose, odometry, age, settings.contact_tolerance)
    problem = problem_from_placement(obj, robot, pose, odometry.pose, goal, settings)
    velocity = contact_velocity(problem.heading, problem.normal, robot.radius, odometry.twist)
    angle = wrap_angle(math.atan2(velocity[1], velocity[0]) - problem.normal)
    if not is_pushing or math.cos(angle) <= 0.0:
        return problem
    return dataclasses.replace(problem, motion=InitialMotion(
        math.hypot(*velocity), _yaw_rate(obj, problem.contact, pose, velocity), angle))


def _is_pushing(robot: RoundRobot, odometry: Odometry) -> bool:
    return (all(math.isfinite(value) for value in odometry.twist)
            and math.isfinite(robot.radius)
            and math.hypot(*odometry.twist[:2]) > MIN_SPEED)


def _predicted(obj: PushedObject, robot: RoundRobot, pose: Pose, odometry: Odometry, age: float,
               contact_tolerance: float) -> Pose:
    """Predict an object's pose over its age, at the robot's present velocity."""
    x, y, phi = odometry.pose
    v_x, v_y = Pose(0.0, 0.0, phi).rotate(odometry.twist[:2])
    robot_then = Pose(x - age * v_x, y - age * v_y, phi - age * odometry.twist[2])
    if not (Pose(*pose).is_finite() and robot_then.is_finite()):
        return pose
    contact, normal, gap = find_contact(obj, pose, robot_then[:2], robot.radius)
    velocity = contact_velocity(robot_then.theta, normal, robot.radius, odometry.twist)
    into_object = velocity[0] * math.cos(normal) + velocity[1] * math.sin(normal)
    if abs(gap) > contact_tolerance or into_object <= 0.0:
        return pose
    rotation = age * _yaw_rate(obj, contact, pose, velocity)
    c_x, c_y = pose.transform(contact_point(obj, contact))
    arm_x, arm_y = Pose(0.0, 0.0, rotation).rotate((pose.x - c_x, pose.y - c_y))
    return Pose(c_x + age * velocity[0] + arm_x, c_y + age * velocity[1] + arm_y,
                pose.theta + rotation)


def _yaw_rate(obj: PushedObject, contact: Contact, pose: Pose,
              velocity: tuple[float, float]) -> float:
    """Quasi-static yaw rate of the object under a velocity imposed at a contact [rad/s]."""
    local = Pose(0.0, 0.0, -pose.theta).rotate(velocity)
    return quasi_static_yaw_rate(obj, contact_point(obj, contact), *local)


def _is_similar(previous: Optional[Plan], goal: Pose) -> bool:
    if previous is None:
        return False
    previous_goal = previous.problem.goal
    return (distance(previous_goal, goal) <= SIMILAR_DISTANCE
            and abs(wrap_angle(previous_goal.theta - goal.theta)) <= SIMILAR_ANGLE)
