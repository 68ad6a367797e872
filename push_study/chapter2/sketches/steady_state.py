"""Sketches of the steady state of a push, and of a disturbed one."""

import math

from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.stability import equilibria
from push_model.parameters import Contact
from push_study.chapter2.sketches.model import UNEVEN_BOX, uneven_box
from push_study.chapter2.sketches.push_instant import at_turn
from push_study.framework import sketch, sketch_body
from push_study.framework.study import Finding, Outcome, Parameter, Study

PARAMETERS = UNEVEN_BOX + (
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('speed', 'm/s', 'of the robot'))
DISTURBED = PARAMETERS + (
    Parameter('disturbance', 'rad', 'turn of the box from the steady state'),)
METRES_PER_NEWTON = 0.016


def steady(values, turned=0.0):
    """
    Place the box in its steady state, or turned from it.

    :param values: ``Values``.
    :param turned: from the steady state [rad].
    :return: ``PushInstant``, the robot at the origin, the push along x.
    :raises ValueError: where the face has no steady state.
    """
    obj = uneven_box(values)
    location = pushing_location(obj, Contact('face', 3), values.robot_radius)
    found = equilibria(location)
    if not found:
        raise ValueError(f'robot_radius: got {values.robot_radius:g} m, expected one at which '
                         'the face has a steady state')
    rest = min(found, key=lambda one: abs(one.rho))
    return at_turn(obj, location, rest.rotation + turned, values.speed)


def _compute(now):
    forces = now.forces
    friction = [sum(one[axis] for one in forces.friction) for axis in (0, 1)]
    rho = now.push_angle - now.state.gamma
    table = {'place': ['C', 'F', 'G', 'P']}
    for axis, name in enumerate('xy'):
        table[f'{name}_m'] = [place[axis] for place in (now.contact, now.friction_centre,
                                                        now.mass_centre, now.robot)]
        table[f'force_{name}_N'] = [forces.contact_force[axis], friction[axis], 0.0, 0.0]
    findings = {'alpha': Finding(math.degrees(now.alpha), 'deg', 'alpha'),
                'rho': Finding(math.degrees(rho), 'deg', 'pushing angle rho'),
                'friction': Finding(math.hypot(*friction), 'N', 'friction of all supports'),
                'contact_force': Finding(math.hypot(*forces.contact_force), 'N',
                                         'force of the robot'),
                'yaw_acceleration': Finding(forces.yaw_acceleration, 'rad/s^2',
                                            'yaw acceleration of the box')}
    return Outcome({'places': table}, findings)


def compute_steady(values, batch):
    """
    Compute forces in the steady state.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    return _compute(steady(values))


def compute_disturbed(values, batch):
    """
    Compute forces on the box that is turned from its steady state.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    return _compute(steady(values, values.disturbance))


def draw_steady(figure, outcome, values):
    """
    Draw the steady state.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes, now = figure.subplots(), steady(values)
    _draw(axes, now)
    sketch_body.mass_centre(axes, now.mass_centre)
    at, force = now.contact, METRES_PER_NEWTON * outcome.findings['contact_force'].value
    sketch.line(axes, at, (at[0] + 0.62, at[1]))
    sketch.arrow(axes, (at[0] - force, at[1]), (force, 0.0), '$F_C$', sketch.FORCE, 0.5)
    sketch.arrow(axes, now.friction_centre, (-METRES_PER_NEWTON
                                             * outcome.findings['friction'].value, 0.0),
                 '$\\sum f_i$', sketch.FLOOR, 0.7, 270.0, gap=11.0)
    sketch_body.point(axes, now.friction_centre, '$F$', 50.0, color=sketch.FLOOR)
    sketch.arrow(axes, (at[0] + 0.62, at[1]), (0.16, 0.0), '$v$', sketch.PUSH)


def draw_disturbed(figure, outcome, values):
    """
    Draw the disturbed state and the steady one behind it.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes, rest, now = figure.subplots(), steady(values), steady(values, values.disturbance)
    sketch_body.solid(axes, rest.obj, rest.pose, ghost=True)
    _draw(axes, now)
    sketch_body.mass_centre(axes, now.mass_centre, angle=-10.0, gap=12.0)
    at = now.contact
    sketch.line(axes, at, now.friction_centre)
    sketch.arrow(axes, at, (0.5, 0.0), '$v$', sketch.PUSH)
    sketch.angle(axes, at, 0.15, -now.alpha, 0.0, '$\\alpha$')
    sketch_body.point(axes, now.friction_centre, '$F$', 300.0, color=sketch.FLOOR)
    sense = math.copysign(0.6, outcome.findings['yaw_acceleration'].value)
    sketch.angle(axes, now.mass_centre, 0.12, -sense, sense, "$\\omega'$")


def _draw(axes, now):
    sketch.sheet(axes)
    at, gamma = now.contact, now.state.gamma
    sketch_body.solid(axes, now.obj, now.pose)
    sketch_body.disc(axes, now.robot, now.robot_radius, (gamma - 0.75, gamma + 0.75))
    normal = now.along(0.0, 0.3)
    sketch.arrow(axes, at, normal, '$n$')
    if abs(now.push_angle - gamma) > math.radians(3.0):
        sketch.angle(axes, at, 0.25, gamma, now.push_angle, '$\\rho$')
    sketch_body.point(axes, at, '$C$', 130.0, 13.0, sketch.FORCE)


STUDIES = (
    Study('2.3', 'Steady state', PARAMETERS, compute_steady, draw_steady,
          'The friction of all supports, {friction:.1f} N, acts at the friction centre F against '
          'the force of the robot, and both lie on the line of the push.',
          'Where alpha is 0 neither turns the box; with F beside the middle of the face the push '
          'then makes {rho:.0f} degrees with the normal.'),
    Study('2.4', 'Disturbed state', DISTURBED, compute_disturbed, draw_disturbed,
          'Turned from its steady state (dashed), the box is pushed {alpha:.0f} degrees off the '
          'line from C to F and accelerates by {yaw_acceleration:.1f} rad/s^2, back to it.',
          'The contact has rolled further along the face than F has swung, so that friction '
          'at F turns the box back.'))
