"""Sketch of the model: a sliding object, how it moves and what acts on it."""

import math

from push_model.contact import contact_point, normal_range
from push_model.dynamics import Input, State
from push_model.parameters import Contact, Support
from push_study.chapter2.sketches.push_instant import PushInstant
from push_study.framework import paper, sketch, sketch_body
from push_study.framework.scenes import BOX, box, corners
from push_study.framework.study import Finding, Outcome, Parameter, Study

UNEVEN_BOX = BOX + (
    Parameter('friction_right', '', 'friction of the two supports on the right'),)
PARAMETERS = UNEVEN_BOX + (
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('heading', 'rad', 'orientation of the box'),
    Parameter('offset', 'm', 'contact left of the middle of the face'),
    Parameter('speed', 'm/s', 'of the contact'),
    Parameter('pushing_angle', 'rad', 'from the contact normal to the push'),
    Parameter('turning_rate', 'rad/s', 'of the box'))
METRES_PER_NEWTON = 0.022


def uneven_box(values):
    """
    Make the box of the parameters ``UNEVEN_BOX``: another friction under its right side.

    :param values: ``Values`` with those parameters.
    :return: ``PushedObject``.
    """
    outline = corners(values.box_length, values.box_width)
    feet = tuple(Support(x, y, values.friction_right if y < 0.0 else values.friction_coefficient)
                 for x, y in outline)
    return box(values, supports=feet)


def instant(values):
    """
    Place the object of the sketch.

    :param values: ``Values``.
    :return: ``PushInstant``.
    """
    obj, contact = uneven_box(values), Contact('face', 3, values.offset)
    gamma = values.heading + normal_range(obj, contact)[0]
    direction = gamma + values.pushing_angle
    inputs = Input(values.speed * math.cos(direction), values.speed * math.sin(direction),
                   0.0, 0.0, 0.0)
    state = State(0.0, 0.0, values.heading, values.turning_rate, gamma,
                  *contact_point(obj, contact))
    return PushInstant(obj, state, inputs, values.robot_radius, math.inf)


def compute(values, batch):
    """
    Compute forces at the supports and at the contact.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    now = instant(values)
    forces = now.forces
    places = now.supports + (now.contact,)
    table = {'place': [f's_{i + 1}' for i in range(len(now.supports))] + ['C'],
             'x_m': [p[0] for p in places], 'y_m': [p[1] for p in places],
             'force_x_N': [f[0] for f in forces.friction] + [forces.contact_force[0]],
             'force_y_N': [f[1] for f in forces.friction] + [forces.contact_force[1]]}
    lag = math.atan2(*forces.contact_force[::-1]) - now.state.gamma
    findings = {
        'contact_force': Finding(math.hypot(*forces.contact_force), 'N', 'force of the robot'),
        'force_angle': Finding(math.degrees(math.remainder(lag, 2.0 * math.pi)), 'deg',
                               'from the normal to the force of the robot'),
        'acceleration': Finding(math.hypot(*forces.acceleration), 'm/s^2',
                                'of the mass centre'),
        'alpha': Finding(math.degrees(now.alpha), 'deg', 'alpha')}
    return Outcome({'forces': table}, findings)


def draw(figure, outcome, values):
    """
    Draw motion on the left, forces on the right.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    now = instant(values)
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    for axes in (left, right):
        sketch.sheet(axes)
        sketch_body.solid(axes, now.obj, now.pose)
        sketch_body.point(axes, now.friction_centre, '$F$', -60.0, color=sketch.FLOOR)
        sketch_body.mass_centre(axes, now.mass_centre, angle=70.0)
    _draw_motion(left, now)
    _draw_forces(right, now)


def _draw_motion(axes, now):
    at, gamma, theta = now.contact, now.state.gamma, now.state.theta
    sketch_body.disc(axes, now.robot, now.robot_radius, (gamma - 1.1, gamma + 1.1))
    sketch_body.point(axes, now.robot, '$P$', 180.0)
    sketch.arrow(axes, now.robot, now.along(0.0, now.robot_radius), '$R_p$', paper.GREY, 0.5)
    sketch.arrow(axes, at, now.along(0.0, 0.34), '$n$')
    sketch.arrow(axes, at, now.along(0.5 * math.pi, 0.2), '$t$')
    sketch.arrow(axes, at, now.along(now.push_angle - gamma, 0.36), '$v_C$', sketch.PUSH)
    sketch.line(axes, at, now.friction_centre)
    sketch.angle(axes, at, 0.29, gamma, now.push_angle, '$\\rho$')
    sketch.angle(axes, at, 0.13, now.push_angle - now.alpha, now.push_angle, '$\\alpha$',
                 at=0.25)
    sketch_body.point(axes, at, '$C$', 318.0, 13.0, color=sketch.FORCE)
    turning = math.copysign(0.5 * math.pi, now.state.omega)
    sketch.angle(axes, now.mass_centre, 0.12, theta - 0.1 * turning, theta + 0.9 * turning,
                 '$\\omega$')
    sketch.line(axes, now.supports[0], (now.supports[0][0] + 0.25, now.supports[0][1]))
    sketch.angle(axes, now.supports[0], 0.2, 0.0, theta, '$\\theta$')
    axes.set_title('motion', loc='left')


def _draw_forces(axes, now):
    forces = now.forces
    for number, (place, force) in enumerate(zip(now.supports, forces.friction), 1):
        sketch.arrow(axes, place, _scaled(force), f'$f_{number}$', sketch.FLOOR)
    pushed = _scaled(forces.contact_force)
    tail = now.contact[0] - pushed[0], now.contact[1] - pushed[1]
    sketch.arrow(axes, tail, pushed, '$F_C$', sketch.FORCE, 0.3)
    sketch_body.point(axes, now.contact, '$C$', 30.0, color=sketch.FORCE)
    axes.set_title('forces', loc='left')


def _scaled(force):
    return METRES_PER_NEWTON * force[0], METRES_PER_NEWTON * force[1]


STUDIES = (Study(
    '2.1', 'A sliding object', PARAMETERS, compute, draw,
    'Friction $f_i$ acts against the sliding of each support and the robot with '
    '{contact_force:.1f} N at C, {force_angle:.0f} degrees off the normal.',
    'Together they accelerate the mass centre G, by {acceleration:.2f} m/s^2: alpha is '
    '{alpha:.0f} degrees, so that the push does not pass through the friction centre F.',
    (7.2, 4.2)),)
