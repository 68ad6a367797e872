"""What can be refused before solving, each with its reason."""

import math

from push_model.friction import friction_center
from push_model.geometry import distance, Pose, wrap_angle
from push_planner.problem import PlanningFailed

STEERING = 0.02


def refuse_impossible(problem):
    """
    Refuse what cannot be planned.

    :param problem: the ``PushProblem``.
    :raises PlanningFailed: with the reason.
    """
    _refuse_values(problem)
    _refuse_robot(problem)
    _refuse_contact(problem)


def _refuse_values(problem):
    for name in ('start', 'goal'):
        if not Pose(*getattr(problem, name)).is_finite():
            raise PlanningFailed(f'the {name} is not finite: {tuple(getattr(problem, name))}')
    for name in ('normal', 'heading'):
        if not math.isfinite(getattr(problem, name)):
            raise PlanningFailed(f'the {name} is not finite: {getattr(problem, name)}')
    try:
        friction_center(problem.obj)
    except ValueError as error:
        raise PlanningFailed(str(error)) from error
    if problem.obj.contact_friction_coefficient == 0.0:
        raise PlanningFailed('the contact has no friction: a frictionless contact cannot steer')
    settings = problem.settings
    away = distance(problem.start, problem.goal)
    turned = abs(wrap_angle(problem.goal.theta - problem.start.theta))
    if away <= settings.position_tolerance and turned <= settings.heading_tolerance:
        raise PlanningFailed(f'the object is at the goal already: {1e3 * away:.1f} mm and '
                             f'{math.degrees(turned):.2f} deg off')


def _refuse_robot(problem):
    robot, speed = problem.robot, problem.settings.pushing_speed
    if speed > robot.max_speed:
        raise PlanningFailed(f'pushing at {speed:g} m/s is faster than the robot drives, '
                             f'{robot.max_speed:g} m/s')
    if robot.drive != 'differential':
        return
    if problem.contact.kind != 'vertex':
        raise PlanningFailed(f'a differential drive on a {problem.contact.kind} contact is not '
                             'supported yet: place the robot at a vertex')
    offset = problem.heading_offset
    if math.cos(offset) <= 0.0:
        raise PlanningFailed('the robot points away from the object: its heading is '
                             f'{math.degrees(abs(offset)):.0f} deg off the contact normal')
    if abs(offset) > problem.planning_angle - STEERING:
        raise PlanningFailed(
            f'the robot heads {math.degrees(abs(offset)):.1f} deg off the contact normal and so '
            f'can turn one way only: the planning cone has {_cone(problem)}')


def _refuse_contact(problem):
    offset, beta = problem.normal_offset, problem.planning_angle
    degrees = math.degrees(offset)
    if abs(offset) > math.pi / 2:
        raise PlanningFailed('the robot would push from the wrong side: the friction centre is '
                             f'{abs(degrees):.0f} deg off the contact normal')
    if problem.robot.drive == 'holonomic':
        if abs(offset) > beta - STEERING:
            raise PlanningFailed(
                f'the contact cannot steer both ways: its normal is {abs(degrees):.1f} deg off '
                f'the friction centre, and the planning cone has {_cone(problem)}')
        return
    low, high = recoverable(problem)
    if not low <= offset <= high:
        raise PlanningFailed(
            f'the contact would fold up: its normal is {degrees:.1f} deg off the direction to the '
            f'friction centre, and a differential drive recovers from {math.degrees(low):.1f} to '
            f'{math.degrees(high):.1f} deg')


def recoverable(problem):
    """
    Offsets of the normal from which a differential drive can straighten up.

    ``zeta' = -(zeta - D + (L + R_p) kappa) / R_p`` with the force angle ``-zeta - kappa c^2 / r``
    inside the planning cone; beyond, the contact folds up like a reversing trailer.

    :param problem: the ``PushProblem``.
    :return: (lowest, highest) zeta [rad].
    """
    vehicle, beta = problem.vehicle, problem.planning_angle
    # Solve (zeta -+ beta) r / c^2 = (zeta - D) / (L + R_p): holds with all the steering there is.
    authority = vehicle.arm / vehicle.mean_square
    drift = 1.0 / (vehicle.wheelbase + problem.robot.radius)
    pull = problem.heading_offset * drift
    span = authority - drift
    return (-beta * authority - pull) / span, (beta * authority - pull) / span


def _cone(problem):
    return f'{math.degrees(problem.planning_angle):.1f} deg to either side'
