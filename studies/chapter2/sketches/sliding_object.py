"""Sketch 2.1 of the model: the motion of a sliding object, and the forces on it."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from push_model.contact import contact_point, normal_range
from push_model.dynamics import State
from push_model.parameters import Contact, PushedObject
from studies.chapter2.sketches.push_instant import Point, PushInstant, straight_inputs
from studies.framework import plot_style, sketch
from studies.framework.box import BOX, box, REAR_FACE, supports_of_two_frictions
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

UNEVEN_BOX = (
    *BOX, Parameter('friction_right', '', 'friction of the two support points on the right'))
PARAMETERS = (
    *UNEVEN_BOX,
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('heading', 'rad', 'orientation of the box'),
    Parameter('offset', 'm', 'contact to the left of the middle of the face'),
    Parameter('speed', 'm/s', 'speed of the contact'),
    Parameter('pushing_angle', 'rad', 'from the contact normal to the push'),
    Parameter('yaw_rate', 'rad/s', 'yaw rate of the box'))
# Chosen: scale of the force arrows, for arrows about as long as the box.
METRES_PER_NEWTON = 0.022


def uneven_box(values: Values) -> PushedObject:
    """
    Make a box whose support points on the right have another friction.

    :param values: with the parameters ``UNEVEN_BOX``.
    :return: the box.
    """
    return box(values, supports=supports_of_two_frictions(values))


def sketched_instant(values: Values) -> PushInstant:
    """
    Place the box of the sketch.

    :param values: with the parameters ``PARAMETERS``.
    :return: the instant that is drawn.
    """
    obj, contact = uneven_box(values), Contact('face', REAR_FACE, values.offset)
    gamma = values.heading + normal_range(obj, contact)[0]
    state = State(0.0, 0.0, values.heading, values.yaw_rate, gamma, *contact_point(obj, contact))
    inputs = straight_inputs(values.speed, gamma + values.pushing_angle)
    return PushInstant(obj, state, inputs, values.robot_radius, math.inf)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the forces at the support points and at the contact."""
    now = sketched_instant(values)
    forces = now.forces
    points = (*now.supports, now.contact)
    table = {'point': [f's_{i + 1}' for i in range(len(now.supports))] + ['C'],
             'x_m': [point[0] for point in points], 'y_m': [point[1] for point in points],
             'force_x_N': [force[0] for force in forces.friction] + [forces.contact_force[0]],
             'force_y_N': [force[1] for force in forces.friction] + [forces.contact_force[1]]}
    force_x, force_y = forces.contact_force
    from_normal = math.atan2(force_y, force_x) - now.state.gamma
    findings = {
        'contact_force': Finding(math.hypot(*forces.contact_force), 'N', 'force of the robot'),
        'force_angle': Finding(math.degrees(math.remainder(from_normal, 2.0 * math.pi)), 'deg',
                               'from the normal to the force of the robot'),
        'acceleration': Finding(math.hypot(*forces.acceleration), 'm/s^2',
                                'acceleration of the centre of mass'),
        'alpha': Finding(math.degrees(now.alpha), 'deg', 'alpha')}
    return Outcome({'forces': table}, findings)


def draw(figure: Figure, _: Outcome, values: Values) -> None:
    """Draw the motion on the left, the forces on the right."""
    now = sketched_instant(values)
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    for axes in (left, right):
        sketch.set_up(axes)
        sketch.pushed_object(axes, now.obj, now.pose)
        sketch.point(axes, now.friction_center, '$F$', -60.0, color=sketch.FLOOR)
        sketch.mass_center(axes, now.mass_center, angle=70.0)
    _draw_motion(left, now)
    _draw_forces(right, now)
    sketch.same_scale((left, right))


def _draw_motion(axes: Axes, now: PushInstant) -> None:
    contact, gamma, theta = now.contact, now.state.gamma, now.state.theta
    sketch.robot(axes, now.robot, now.robot_radius, (gamma - 1.1, gamma + 1.1))
    sketch.point(axes, now.robot, '$P$', 180.0)
    sketch.arrow(axes, now.robot, now.from_normal(0.0, now.robot_radius), '$R_p$',
                 plot_style.GREY, at=0.5)
    sketch.arrow(axes, contact, now.from_normal(0.0, 0.34), '$n$')
    sketch.arrow(axes, contact, now.from_normal(0.5 * math.pi, 0.2), '$t$')
    sketch.arrow(axes, contact, now.from_normal(now.rho, 0.36), '$v_C$', sketch.PUSH)
    sketch.line(axes, contact, now.friction_center)
    sketch.angle(axes, contact, 0.29, (gamma, now.push_angle), '$\\rho$')
    sketch.angle(axes, contact, 0.13, (now.push_angle - now.alpha, now.push_angle), '$\\alpha$',
                 at=0.25)
    sketch.point(axes, contact, '$C$', 318.0, 13.0, sketch.FORCE)
    quarter = math.copysign(0.5 * math.pi, now.state.omega)
    sketch.angle(axes, now.mass_center, 0.12, (theta - 0.1 * quarter, theta + 0.9 * quarter),
                 '$\\omega$')
    sketch.line(axes, now.supports[0], (now.supports[0][0] + 0.25, now.supports[0][1]))
    sketch.angle(axes, now.supports[0], 0.2, (0.0, theta), '$\\theta$')
    axes.set_title('motion', loc='left')


def _draw_forces(axes: Axes, now: PushInstant) -> None:
    forces = now.forces
    for number, (support, force) in enumerate(zip(now.supports, forces.friction), 1):
        sketch.arrow(axes, support, _scaled(force), f'$f_{number}$', sketch.FLOOR)
    contact_force = _scaled(forces.contact_force)
    tail = now.contact[0] - contact_force[0], now.contact[1] - contact_force[1]
    sketch.arrow(axes, tail, contact_force, '$F_C$', sketch.FORCE, at=0.3)
    sketch.point(axes, now.contact, '$C$', 30.0, color=sketch.FORCE)
    axes.set_title('forces', loc='left')


def _scaled(force: Point) -> Point:
    return METRES_PER_NEWTON * force[0], METRES_PER_NEWTON * force[1]


STUDIES = (Study(
    '2.1', 'A sliding object', PARAMETERS, compute, draw,
    'Friction $f_i$ opposes the sliding of each support point; the robot pushes at C with '
    '{contact_force:.1f} N, {force_angle:.0f} degrees off the normal.',
    'The centre of mass G accelerates by {acceleration:.2f} m/s^2; the push misses the centre of '
    'friction F by {alpha:.0f} degrees.',
    (7.2, 4.2)),)
