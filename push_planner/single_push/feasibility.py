"""What can be refused before solving, each with its reason."""

import math

from push_model.friction import friction_center
from push_model.geometry import distance, Pose, wrap_angle
from push_model.plan_request import PlanFailure
from push_planner.collocation.formulation import rotation_range
from push_planner.problem import PlanningFailed

STEERING = 0.02


def check_feasibility(problem):
    """
    Refuse what cannot be planned.

    :param problem: the ``PushProblem``.
    :raises PlanningFailed: with the reason.
    """
    _refuse_values(problem)
    _refuse_robot(problem)
    _refuse_contact(problem)
    _refuse_turn(problem)


def _refuse_values(problem):
    for name in ('start', 'goal'):
        if not Pose(*getattr(problem, name)).is_finite():
            raise PlanningFailed(PlanFailure.INVALID_VALUE, f'the {name} is not finite: {tuple(getattr(problem, name))}')
    for name in ('normal', 'heading'):
        if not math.isfinite(getattr(problem, name)):
            raise PlanningFailed(PlanFailure.INVALID_VALUE, f'the {name} is not finite: {getattr(problem, name)}')
    try:
        friction_center(problem.obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_SUPPORT_FRICTION, str(error)) from error
    cone = problem.settings.angle_limit == 'cone'
    if cone and problem.obj.contact_friction_coefficient == 0.0:
        raise PlanningFailed(PlanFailure.NO_CONTACT_FRICTION, 'the contact has no friction: a frictionless contact cannot steer')
    check_not_at_goal(problem.start, problem.goal, problem.settings)


def check_not_at_goal(start, goal, settings):
    """
    Refuse where the object is at the goal already.

    :param start: ``Pose`` of the object.
    :param goal: ``Pose`` wanted for the object.
    :param settings: ``PlannerSettings``.
    :raises PlanningFailed: where both are the same within the tolerances.
    """
    away, turned = distance(start, goal), abs(wrap_angle(goal.theta - start.theta))
    if settings.heading_free:
        turned = 0.0
    if away <= settings.position_tolerance and turned <= settings.heading_tolerance:
        raise PlanningFailed(PlanFailure.AT_GOAL, f'the object is at the goal already: {1e3 * away:.1f} mm and '
                             f'{math.degrees(turned):.2f} deg off')


def _refuse_robot(problem):
    robot, speed = problem.robot, problem.settings.pushing_speed
    if speed > robot.max_speed:
        raise PlanningFailed(PlanFailure.ROBOT_TOO_SLOW, f'pushing at {speed:g} m/s is faster than the robot drives, '
                             f'{robot.max_speed:g} m/s')
    if robot.radius == 0.0 and (robot.drive == 'differential' or problem.contact.kind == 'vertex'):
        raise PlanningFailed(PlanFailure.UNSUPPORTED_CONTACT, 'a point robot needs a holonomic drive and a face or a round '
                             'outline: elsewhere nothing fixes the contact normal')
    if robot.drive != 'differential':
        return
    if problem.contact.kind != 'vertex':
        raise PlanningFailed(PlanFailure.UNSUPPORTED_CONTACT, f'a differential drive on a {problem.contact.kind} contact is not '
                             'supported yet: place the robot at a vertex')
    offset = problem.heading_offset
    if math.cos(offset) <= 0.0:
        raise PlanningFailed(PlanFailure.FACING_AWAY, 'the robot points away from the object: its heading is '
                             f'{math.degrees(abs(offset)):.0f} deg off the contact normal')
    if problem.settings.angle_limit == 'cone' and (
            abs(offset) > problem.planning_cone_angle - STEERING):
        raise PlanningFailed(PlanFailure.ONE_SIDED_STEERING,
            f'the robot heads {math.degrees(abs(offset)):.1f} deg off the contact normal and so '
            f'can turn one way only: the planning cone has {_cone(problem.planning_cone_angle)}')


def _refuse_contact(problem):
    offset = problem.normal_offset
    degrees = math.degrees(offset)
    if abs(offset) > math.pi / 2:
        raise PlanningFailed(PlanFailure.WRONG_SIDE, 'the robot would push from the wrong side: the friction centre is '
                             f'{abs(degrees):.0f} deg off the contact normal')
    if problem.settings.angle_limit == 'none':
        return
    if problem.robot.drive == 'holonomic':
        widest = problem.planning_cone_angle
        if problem.settings.angle_limit == 'angle':
            widest = problem.settings.max_pushing_angle
        if abs(offset) > widest - STEERING:
            raise PlanningFailed(PlanFailure.ONE_SIDED_STEERING,
                f'the contact cannot steer both ways: its normal is {abs(degrees):.1f} deg off '
                f'the friction centre, and the planning cone has {_cone(widest)}')
        return
    low, high = recoverable_offsets(problem)
    if problem.settings.angle_limit == 'cone' and not low <= offset <= high:
        raise PlanningFailed(PlanFailure.JACKKNIFED,
            f'the contact would fold up: its normal is {degrees:.1f} deg off the direction to the '
            f'friction centre, and a differential drive recovers from {math.degrees(low):.1f} to '
            f'{math.degrees(high):.1f} deg')


def _refuse_turn(problem):
    if problem.settings.heading_free:
        return
    low, high = rotation_range(problem)
    turn = problem.relative_goal.theta
    # Without loops there is one way to turn: a rolling contact that turned full circle is gone.
    if not any(low <= turn + 2.0 * math.pi * k <= high for k in (-1, 0, 1)):
        degrees = math.degrees(wrap_angle(turn))
        raise PlanningFailed(PlanFailure.LEAVES_CONTACT_FEATURE,
            f'the goal is turned by {degrees:.1f} deg, and the contact leaves its '
            f'{problem.contact.kind} beyond {math.degrees(low):.1f} to {math.degrees(high):.1f} '
            'deg as it rolls: choose a smaller robot, another contact, or let the robot turn with '
            'the object')


def recoverable_offsets(problem):
    """
    Offsets of the normal from which a differential drive can straighten up.

    ``zeta' = -(zeta - D + (L + R_p) kappa) / R_p`` with the force angle ``-zeta - kappa c^2 / r``
    inside the planning cone; beyond, the contact folds up like a reversing trailer.

    :param problem: the ``PushProblem``.
    :return: (lowest, highest) zeta [rad].
    """
    vehicle, beta = problem.vehicle, problem.planning_cone_angle
    # Solve (zeta -+ beta) r / c^2 = (zeta - D) / (L + R_p): holds with all the steering there is.
    authority = vehicle.arm / vehicle.c_squared
    drift = 1.0 / (vehicle.wheelbase + problem.robot.radius)
    pull = problem.heading_offset * drift
    span = authority - drift
    return (-beta * authority - pull) / span, (beta * authority - pull) / span


def _cone(angle):
    return f'{math.degrees(angle):.1f} deg to either side'
