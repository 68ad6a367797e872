"""Feasibility checks: what can be refused before anything is solved, each with its reason."""

import math

from push_model.friction import friction_center
from push_model.geometry import distance, Pose, wrap_angle
from push_model.plan_request import GoalTolerances, PlanFailure
from push_planner.problem import check_finite, check_object_stands, PlanningFailed, PushProblem
from push_planner.settings import PlannerSettings
from push_planner.steered.collocation.formulation import rotation_range

# Part of the cone that must be left for steering [rad]. Chosen: with less, a push turns with a
# radius of many metres.
MIN_STEERING_ANGLE = 0.02
# Square of the length by which supports resist a rotation below which they do not [m^2]; chosen: a
# tenth of a millimetre.
MIN_C_SQUARED = 1e-8


def check_feasibility(problem: PushProblem) -> None:
    """
    Refuse what cannot be planned.

    :raises PlanningFailed: with the reason.
    """
    _check_values(problem)
    _check_robot(problem)
    if problem.robot.drive == 'differential':
        _check_differential_drive(problem)
    _check_side(problem)
    _check_steering(problem)
    _check_rotation(problem)


def check_goal(problem: PushProblem) -> None:
    """
    Refuse a goal where a push to another one, alike in all else, is feasible.

    :raises PlanningFailed: with the reason.
    """
    check_finite({'goal': problem.goal})
    check_not_at_goal(problem.start, problem.goal, problem.settings)
    _check_rotation(problem)


def check_not_at_goal(start: Pose, goal: Pose, settings: PlannerSettings,
                      tolerances: GoalTolerances | None = None) -> None:
    """
    Refuse where the object is at the goal already.

    :param goal: ``Pose`` of the object at the end.
    :param settings: ``PlannerSettings``; plans are no more accurate than it says.
    :param tolerances: ``GoalTolerances`` of the goal, or None for the accuracy of plans.
    :raises PlanningFailed: where both are the same within the tolerances.
    """
    if settings.heading_free:
        start = start._replace(theta=goal.theta)
    accuracy = GoalTolerances(settings.position_tolerance, settings.heading_tolerance)
    if accuracy.contain(start, goal) or tolerances and tolerances.contain(start, goal):
        rotation = abs(wrap_angle(goal.theta - start.theta))
        raise PlanningFailed(PlanFailure.AT_GOAL, 'the object is at the goal already: '
                             f'{1e3 * distance(start, goal):.1f} mm and '
                             f'{math.degrees(rotation):.2f} deg off')


def recoverable_offsets(problem: PushProblem) -> tuple[float, float]:
    """
    Offsets of the normal from which a differential drive can straighten up.

    ``zeta' = -(zeta - D + (L + R_p) kappa) / R_p`` with the force angle ``-zeta - kappa c^2 / r``
    inside the planning cone; beyond, the contact jackknifes like a reversing trailer.

    :return: (lowest, highest) zeta [rad].
    """
    vehicle, beta = problem.vehicle, problem.planning_cone_angle
    if vehicle.c_squared < MIN_C_SQUARED:
        # The object swings freely about its one support: it straightens up from anywhere.
        return -math.inf, math.inf
    # Solve (zeta -+ beta) r / c^2 = (zeta - D) / (L + R_p): holds with all the steering there is.
    authority = vehicle.arm / vehicle.c_squared
    drift = 1.0 / (vehicle.wheelbase + problem.robot.radius)
    pull = problem.heading_offset * drift
    span = authority - drift
    return (-beta * authority - pull) / span, (beta * authority - pull) / span


def _check_values(problem: PushProblem) -> None:
    check_finite({'start': problem.start, 'goal': problem.goal})
    for name, angle in (('normal', problem.normal), ('heading', problem.heading)):
        if not math.isfinite(angle):
            raise PlanningFailed(PlanFailure.INVALID_VALUE, f'the {name} is not finite: {angle}')
    try:
        friction_center(problem.obj)
    except ValueError as error:
        raise PlanningFailed(PlanFailure.NO_SUPPORT_FRICTION, str(error)) from error
    check_object_stands(problem.obj)
    cone = problem.settings.angle_limit == 'cone'
    if cone and problem.obj.contact_friction_coefficient == 0.0:
        raise PlanningFailed(PlanFailure.NO_CONTACT_FRICTION, 'the contact has no friction: a '
                             'frictionless contact cannot steer')
    check_not_at_goal(problem.start, problem.goal, problem.settings)


def _check_robot(problem: PushProblem) -> None:
    robot, speed = problem.robot, problem.settings.pushing_speed
    if speed > robot.max_speed:
        raise PlanningFailed(PlanFailure.ROBOT_TOO_SLOW, f'pushing at {speed:g} m/s is faster '
                             f'than the robot drives, {robot.max_speed:g} m/s')
    if robot.radius == 0.0 and (robot.drive == 'differential' or problem.contact.kind == 'vertex'):
        raise PlanningFailed(PlanFailure.UNSUPPORTED_CONTACT, 'a point robot needs a holonomic '
                             'drive and a face or a round outline: elsewhere nothing fixes the '
                             'contact normal')


def _check_differential_drive(problem: PushProblem) -> None:
    if problem.contact.kind != 'vertex':
        raise PlanningFailed(
            PlanFailure.UNSUPPORTED_CONTACT, f'a differential drive on a {problem.contact.kind} '
            'contact is not supported yet: place the robot at a vertex')
    offset = problem.heading_offset
    if math.cos(offset) <= 0.0:
        raise PlanningFailed(PlanFailure.FACING_AWAY,
                             'the robot points away from the object: its heading is '
                             f'{math.degrees(abs(offset)):.0f} deg off the contact normal')
    if problem.settings.angle_limit == 'cone' and (
            abs(offset) > problem.planning_cone_angle - MIN_STEERING_ANGLE):
        raise PlanningFailed(
            PlanFailure.ONE_SIDED_STEERING,
            f'the robot heads {math.degrees(abs(offset)):.1f} deg off the contact normal and so '
            'can turn to one side only: the planning cone has '
            f'{_to_either_side(problem.planning_cone_angle)}')


def _check_side(problem: PushProblem) -> None:
    offset = problem.normal_offset
    if abs(offset) > math.pi / 2:
        raise PlanningFailed(PlanFailure.WRONG_SIDE, 'the robot would push from the wrong side: '
                             f'the centre of friction is {math.degrees(abs(offset)):.0f} deg off '
                             'the contact normal')


def _check_steering(problem: PushProblem) -> None:
    limit = problem.settings.angle_limit
    if limit == 'none':
        return
    offset = problem.normal_offset
    if problem.robot.drive == 'holonomic':
        largest = problem.planning_cone_angle
        if limit == 'angle':
            largest = problem.settings.max_pushing_angle
        if abs(offset) > largest - MIN_STEERING_ANGLE:
            raise PlanningFailed(
                PlanFailure.ONE_SIDED_STEERING,
                'the contact cannot steer to both sides: its normal is '
                f'{math.degrees(abs(offset)):.1f} deg off the centre of friction, and the '
                f'planning cone has {_to_either_side(largest)}')
        return
    low, high = recoverable_offsets(problem)
    if limit == 'cone' and not low <= offset <= high:
        raise PlanningFailed(
            PlanFailure.JACKKNIFED, 'the contact would jackknife: its normal is '
            f'{math.degrees(offset):.1f} deg off the direction to the centre of friction, and a '
            f'differential drive recovers from {math.degrees(low):.1f} to '
            f'{math.degrees(high):.1f} deg')


def _check_rotation(problem: PushProblem) -> None:
    if problem.settings.heading_free:
        return
    low, high = rotation_range(problem)
    rotation = problem.relative_goal.theta
    # Without loops there is one way to rotate: a rolling contact that turned full circle is gone.
    if not any(low <= rotation + 2.0 * math.pi * k <= high for k in (-1, 0, 1)):
        raise PlanningFailed(
            PlanFailure.LEAVES_CONTACT_FEATURE,
            f'the goal is rotated by {math.degrees(wrap_angle(rotation)):.1f} deg, and the '
            f'contact leaves its {problem.contact.kind} beyond {math.degrees(low):.1f} to '
            f'{math.degrees(high):.1f} deg as it rolls: choose a smaller robot, another contact, '
            'or let the robot rotate with the object')


def _to_either_side(angle: float) -> str:
    return f'{math.degrees(angle):.1f} deg to either side'
