"""Sketch 2.4 of the steady state of a push, and of a disturbed one."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from push_model.parameters import Contact
from studies.analysis.pushing_location import pushing_location
from studies.analysis.stability import equilibria
from studies.chapter2.sketches.push_instant import instant_at_rotation, PushInstant
from studies.chapter2.sketches.sliding_object import UNEVEN_BOX, uneven_box
from studies.framework import sketch
from studies.framework.box import REAR_FACE
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

PARAMETERS = (
    *UNEVEN_BOX,
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('speed', 'm/s', 'speed of the robot'),
    Parameter('disturbance', 'rad', 'rotation of the box from the steady state'))
# Chosen: scale of the force arrows, for arrows about as long as half the box.
METRES_PER_NEWTON = 0.016
# Chosen: a smaller pushing angle is not drawn, as its arc would be hidden by its head.
MIN_DRAWN_RHO = math.radians(3.0)


def steady_instant(values: Values, disturbance: float = 0.0) -> PushInstant:
    """
    Place the box in its steady state, or rotated from it.

    :param values: with the parameters ``PARAMETERS``.
    :param disturbance: rotation from the steady state [rad].
    :return: the instant, the robot at the origin, the push along x.
    :raises ValueError: where the face has no steady state.
    """
    obj = uneven_box(values)
    location = pushing_location(obj, Contact('face', REAR_FACE), values.robot_radius)
    candidates = equilibria(location)
    if not candidates:
        raise ValueError(f'robot_radius: got {values.robot_radius:g} m, expected one at which '
                         'the face has a steady state')
    steady = min(candidates, key=lambda equilibrium: abs(equilibrium.rho))
    return instant_at_rotation(obj, location, steady.rotation + disturbance, values.speed)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the forces in the steady state, and on the box that is rotated from it."""
    steady, now = steady_instant(values), steady_instant(values, values.disturbance)
    forces = steady.forces
    return Outcome({'steady': _points(steady), 'disturbed': _points(now)}, {
        'rho': Finding(math.degrees(steady.rho), 'deg', 'pushing angle rho, steady'),
        'steady_alpha': Finding(math.degrees(steady.alpha), 'deg', 'alpha, steady'),
        'friction': Finding(math.hypot(*_total_friction(steady)), 'N',
                            'friction of all support points, steady'),
        'contact_force': Finding(math.hypot(*forces.contact_force), 'N', 'force of the robot, '
                                 'steady'),
        'steady_acceleration': Finding(forces.yaw_acceleration, 'rad/s^2', 'yaw acceleration of '
                                       'the box, steady'),
        'alpha': Finding(math.degrees(now.alpha), 'deg', 'alpha, disturbed'),
        'yaw_acceleration': Finding(now.forces.yaw_acceleration, 'rad/s^2',
                                    'yaw acceleration of the box, disturbed')})


def _total_friction(now: PushInstant) -> tuple[float, float]:
    """Sum the friction of all support points (x, y) [N]."""
    x, y = zip(*now.forces.friction)
    return sum(x), sum(y)


def _points(now: PushInstant) -> Table:
    forces, friction = now.forces, _total_friction(now)
    table: Table = {'point': ['C', 'F', 'G', 'P']}
    points = (now.contact, now.friction_center, now.mass_center, now.robot)
    for axis, name in enumerate('xy'):
        table[f'{name}_m'] = [point[axis] for point in points]
        table[f'force_{name}_N'] = [forces.contact_force[axis], friction[axis], 0.0, 0.0]
    return table


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the steady state on the left, the disturbed one on the right."""
    left, right = figure.subplots(1, 2)
    _draw_steady(left, outcome, steady_instant(values))
    _draw_disturbed(right, outcome, values)
    left.set_title('(a) steady', loc='left')
    right.set_title('(b) disturbed', loc='left')
    sketch.same_scale((left, right))


def _draw_steady(axes: Axes, outcome: Outcome, now: PushInstant) -> None:
    _draw_instant(axes, now)
    sketch.mass_center(axes, now.mass_center)
    x, y = now.contact
    push_length = METRES_PER_NEWTON * outcome.findings['contact_force'].value
    friction_length = METRES_PER_NEWTON * outcome.findings['friction'].value
    sketch.line(axes, (x, y), (x + 0.62, y))
    sketch.arrow(axes, (x - push_length, y), (push_length, 0.0), '$F_C$', sketch.FORCE, at=0.5)
    sketch.arrow(axes, now.friction_center, (-friction_length, 0.0), '$\\sum f_i$',
                 sketch.FLOOR, at=0.7, side=270.0, gap=11.0)
    sketch.point(axes, now.friction_center, '$F$', 290.0, 11.0, color=sketch.FLOOR)
    sketch.arrow(axes, (x + 0.62, y), (0.16, 0.0), '$v$', sketch.PUSH)


def _draw_disturbed(axes: Axes, outcome: Outcome, values: Values) -> None:
    steady, now = steady_instant(values), steady_instant(values, values.disturbance)
    sketch.pushed_object(axes, steady.obj, steady.pose, ghost=True)
    _draw_instant(axes, now)
    sketch.mass_center(axes, now.mass_center, angle=-10.0, gap=12.0)
    sketch.line(axes, now.contact, now.friction_center)
    sketch.arrow(axes, now.contact, (0.5, 0.0), '$v$', sketch.PUSH)
    sketch.angle(axes, now.contact, 0.15, (-now.alpha, 0.0), '$\\alpha$')
    sketch.point(axes, now.friction_center, '$F$', 300.0, color=sketch.FLOOR)
    end = math.copysign(0.6, outcome.findings['yaw_acceleration'].value)
    sketch.angle(axes, now.mass_center, 0.12, (-end, end), "$\\omega'$")


def _draw_instant(axes: Axes, now: PushInstant) -> None:
    sketch.set_up(axes)
    gamma = now.state.gamma
    sketch.pushed_object(axes, now.obj, now.pose)
    sketch.robot(axes, now.robot, now.robot_radius, (gamma - 0.75, gamma + 0.75))
    sketch.arrow(axes, now.contact, now.from_normal(0.0, 0.3), '$n$')
    if abs(now.rho) > MIN_DRAWN_RHO:
        sketch.angle(axes, now.contact, 0.25, (gamma, now.push_angle), '$\\rho$')
    sketch.point(axes, now.contact, '$C$', 130.0, 13.0, sketch.FORCE)


STUDIES = (Study(
    '2.4', 'A sliding object in (a) a steady and (b) a disturbed state', PARAMETERS, compute, draw,
    'In the steady state friction, {friction:.1f} N, acts at F against the robot, {rho:.0f} '
    'degrees off the normal. With alpha {alpha:.0f} degrees the box accelerates back by '
    '{yaw_acceleration:.1f} rad/s^2.',
    'The contact has rolled further along the face than F has swung.',
    (8.4, 4.2)),)
