"""
Feasibility checks: what can be refused before anything is solved, each with its reason.

A refusal names the least change that would do: in its sentence, rounded up, and as a number of its
report.
``turn`` is that of the robot's heading [rad], ``normal`` that of contact normal and heading as
the robot moves round a vertex [rad], ``shift`` that of the contact along its face [m],
``contact_friction`` and ``pushing_speed`` are the values needed, and ``rotation`` is what the goal
needs beside its own [rad].
"""

import math

from push_model.contact import normal_range
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
        is_differential = problem.robot.drive == 'differential'
        change, report = _with_more_friction(
            problem, problem.heading_offset if is_differential else problem.normal_offset)
        raise PlanningFailed(PlanFailure.NO_CONTACT_FRICTION, 'the contact has no friction: a '
                             f'frictionless contact cannot steer{change}', report)
    check_not_at_goal(problem.start, problem.goal, problem.settings)


def _check_robot(problem: PushProblem) -> None:
    robot, speed = problem.robot, problem.settings.pushing_speed
    if speed > robot.max_speed:
        raise PlanningFailed(PlanFailure.ROBOT_TOO_SLOW, f'pushing at {speed:g} m/s is faster '
                             f'than the robot drives, {robot.max_speed:g} m/s',
                             {'pushing_speed': robot.max_speed})
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
        change, report = _nearer_the_normal(problem)
        raise PlanningFailed(PlanFailure.FACING_AWAY,
                             'the robot points away from the object: its heading is '
                             f'{math.degrees(abs(offset)):.0f} deg off the contact normal{change}',
                             report)
    if problem.settings.angle_limit == 'cone' and (
            abs(offset) > problem.planning_cone_angle - MIN_STEERING_ANGLE):
        change, report = _nearer_the_normal(problem)
        raise PlanningFailed(
            PlanFailure.ONE_SIDED_STEERING,
            f'the robot heads {math.degrees(abs(offset)):.1f} deg off the contact normal and so '
            'can turn to one side only: the planning cone has '
            f'{_to_either_side(problem.planning_cone_angle)}{change}', report)


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
            change, report = _nearer_the_center(problem, largest - MIN_STEERING_ANGLE)
            raise PlanningFailed(
                PlanFailure.ONE_SIDED_STEERING,
                'the contact cannot steer to both sides: its normal is '
                f'{math.degrees(abs(offset)):.1f} deg off the centre of friction, and the '
                f'planning cone has {_to_either_side(largest)}{change}', report)
        return
    low, high = recoverable_offsets(problem)
    if limit == 'cone' and not low <= offset <= high:
        change, report = _turned_about_the_vertex(
            problem, max(low - offset, min(0.0, high - offset)))
        raise PlanningFailed(
            PlanFailure.JACKKNIFED, 'the contact would jackknife: its normal is '
            f'{math.degrees(offset):.1f} deg off the direction to the centre of friction, and a '
            f'differential drive recovers from {math.degrees(low):.1f} to '
            f'{math.degrees(high):.1f} deg{change}', report)


def _check_rotation(problem: PushProblem) -> None:
    if problem.settings.heading_free:
        return
    low, high = rotation_range(problem)
    # Without loops there is one way to rotate: a rolling contact that turned full circle is gone.
    rotations = [problem.relative_goal.theta + 2.0 * math.pi * k for k in (-1, 0, 1)]
    if not any(low <= rotation <= high for rotation in rotations):
        change = min((max(low - rotation, min(0.0, high - rotation)) for rotation in rotations),
                     key=abs)
        sign = '+' if change > 0.0 else '-'
        raise PlanningFailed(
            PlanFailure.LEAVES_CONTACT_FEATURE,
            f'the goal is rotated by {math.degrees(wrap_angle(rotations[1])):.1f} deg, and the '
            f'contact leaves its {problem.contact.kind} beyond {math.degrees(low):.1f} to '
            f'{math.degrees(high):.1f} deg as it rolls: choose a smaller robot, another contact, '
            f'a goal rotated by {sign}{_degrees(change)} deg beside this one, or let the robot '
            'rotate with the object', {'rotation': change})


def _with_more_friction(problem: PushProblem, angle: float) -> tuple[str, dict[str, float]]:
    """
    Tell with which contact friction the planning cone leaves enough to steer beyond an angle.

    :param angle: to either side [rad].
    :return: end of the sentence, and numbers by name; nothing where no friction does.
    """
    settings = problem.settings
    cone = (abs(angle) + MIN_STEERING_ANGLE) / settings.cone_margin
    if cone >= math.pi / 2:
        return '', {}
    friction = math.tan(cone) / settings.friction_discount
    return (f'; with a contact friction of {_rounded_up(friction, 2)} it could',
            {'contact_friction': friction})


def _nearer_the_center(problem: PushProblem, largest: float) -> tuple[str, dict[str, float]]:
    """
    Tell how a contact of a holonomic base could steer to both sides.

    :param largest: angle of its normal off the centre of friction that does [rad].
    :return: end of the sentence, and numbers by name.
    """
    angle, arm = abs(problem.normal_offset), problem.vehicle.arm
    text, report = '', dict[str, float]()
    if problem.contact.kind == 'face' and largest > 0.0:
        report['shift'] = arm * (math.sin(angle) - math.cos(angle) * math.tan(largest))
        text = (f'; {_rounded_up(1e3 * report["shift"], 0)} mm nearer to the centre of friction '
                'it could')
    if problem.settings.angle_limit == 'cone':
        grip, friction = _with_more_friction(problem, angle)
        text, report = text + grip, {**report, **friction}
    return text, report


def _nearer_the_normal(problem: PushProblem) -> tuple[str, dict[str, float]]:
    """
    Tell how a differential drive could steer to both sides.

    :return: end of the sentence, and numbers by name.
    """
    offset, largest = problem.heading_offset, math.pi / 2
    if problem.settings.angle_limit == 'cone':
        largest = problem.planning_cone_angle - MIN_STEERING_ANGLE
    if largest <= 0.0:
        return _with_more_friction(problem, offset)
    turn = math.copysign(abs(offset) - largest, offset)
    return f'; turned by {_degrees(turn)} deg to the {_side(turn)} it could', {'turn': turn}


def _turned_about_the_vertex(problem: PushProblem, turn: float) -> tuple[str, dict[str, float]]:
    """
    Tell how a contact at a vertex would not jackknife.

    :param turn: of normal and heading that does [rad].
    :return: end of the sentence, and numbers by name; nothing where it would leave the vertex.
    """
    low, high = normal_range(problem.obj, problem.contact)
    if (problem.start_normal + turn - low) % (2.0 * math.pi) > high - low:
        return '', {}
    return (f'; turned by {_degrees(turn)} deg to the {_side(turn)} about the vertex it could',
            {'normal': turn})


def _to_either_side(angle: float) -> str:
    return f'{math.degrees(angle):.1f} deg to either side'


def _side(turn: float) -> str:
    return 'left' if turn > 0.0 else 'right'


def _degrees(angle: float) -> str:
    """Write the size of an angle that is needed."""
    return _rounded_up(math.degrees(abs(angle)), 1)


def _rounded_up(value: float, digits: int) -> str:
    """Write a value that is needed, no less of it."""
    return f'{math.ceil(value * 10**digits) / 10**digits:.{digits}f}'
