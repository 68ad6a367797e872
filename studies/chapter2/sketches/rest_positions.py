"""Sketches 2.2 and 2.3 of a push over time: initial state, then on to rest on a round robot."""

import math
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.contact import rolling_constants
from push_model.dynamics import State
from push_model.geometry import FloatArray
from push_model.parameters import Contact
from studies.analysis.pushing_location import pushing_location
from studies.analysis.time_integration import integrate, straight_push
from studies.chapter2.sketches.push_instant import instant_at_rotation, PushInstant
from studies.framework import sketch
from studies.framework.box import BOX, box, REAR_FACE
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: times at which the push is sampled, 12.5 ms apart.
SAMPLES = 400
POSITIONS = ('initial', 'intermediate', 'rest')
UNITS = {'theta': 'rad', 'gamma': 'rad', 'omega': 'rad_s'}
STATE_COLUMNS = tuple(f'{name}_{UNITS.get(name, "m")}' for name in State._fields)
# Chosen: a smaller alpha is not drawn, as its arc would be hidden by its head.
MIN_DRAWN_ALPHA = math.radians(5.0)
PARAMETERS = (
    *BOX,
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('speed', 'm/s', 'speed of the robot'),
    Parameter('initial_rotation', 'rad', 'rotation of the box from rest at the start'),
    Parameter('duration', 's', 'duration of the push'))


class Motion(NamedTuple):
    """
    An integrated push.

    :param times: [s], shape (n,).
    :param instants: the push at these times.
    """

    times: FloatArray
    instants: list[PushInstant]


def push(values: Values) -> Motion:
    """
    Integrate the push.

    :param values: with the parameters ``PARAMETERS``.
    :return: the motion.
    """
    start = _start(values)
    rolling = rolling_constants(values.robot_radius, math.inf)
    times, states = integrate(start.obj, rolling, straight_push(values.speed, 0.0), start.state,
                              np.linspace(0.0, values.duration, SAMPLES))
    return Motion(times, [start._replace(state=State(*state.tolist())) for state in states])


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the three positions: at first, when alpha is half as large, and at the end."""
    times, motion = push(values)
    alpha = np.array([now.alpha for now in motion])
    drawn = [0, int(np.argmin(np.abs(alpha - 0.5 * alpha[0]))), len(motion) - 1]
    path = np.array([now.friction_center for now in motion])
    positions = {'position': POSITIONS, 'time_s': times[drawn], 'alpha_rad': alpha[drawn],
                 'rho_rad': [motion[i].rho for i in drawn]}
    for name, column in zip(State._fields, STATE_COLUMNS):
        positions[column] = [getattr(motion[i].state, name) for i in drawn]
    findings = {f'alpha_{name}': Finding(float(value), 'deg', f'alpha in the {name} position')
                for name, value in zip(POSITIONS, np.degrees(alpha[drawn]))}
    findings['distance'] = Finding(values.speed * float(times[drawn[1]]), 'm',
                                   'distance after which alpha is half as large')
    return Outcome({'positions': positions, 'path': {
        'time_s': times, 'x_f_m': path[:, 0], 'y_f_m': path[:, 1], 'alpha_rad': alpha}}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the three positions, seen from the robot, with the path of F so far."""
    positions, path = outcome.tables['positions'], outcome.tables['path']
    start = _start(values)
    panels = figure.subplots(1, len(POSITIONS), sharex=True, sharey=True)
    for index, (axes, name) in enumerate(zip(panels, POSITIONS)):
        sketch.set_up(axes)
        state = State(*(positions[column][index] for column in STATE_COLUMNS))
        time = positions['time_s'][index]
        now = start._replace(state=state._replace(x=state.x - values.speed * time))
        _draw_position(axes, now)
        so_far = path['time_s'] <= time
        axes.plot((path['x_f_m'] - values.speed * path['time_s'])[so_far],
                  path['y_f_m'][so_far], color=sketch.FLOOR, linewidth=1.0,
                  linestyle=(0, (1, 1)))
        axes.set_title(f'({"abc"[index]}) {name}, $t$ = {time:.1f} s', loc='left')


def compute_initial(values: Values, _: RunJobs) -> Outcome:
    """Compute points and angles of the initial state."""
    now = _start(values)
    points = {'C': now.contact, 'F': now.friction_center, 'P': now.robot}
    yaw_acceleration = now.forces.yaw_acceleration
    table = {'point': list(points), 'x_m': [point[0] for point in points.values()],
             'y_m': [point[1] for point in points.values()],
             'alpha_rad': [now.alpha] * len(points), 'rho_rad': [now.rho] * len(points),
             'yaw_acceleration_rad_s2': [yaw_acceleration] * len(points)}
    return Outcome({'points': table}, {
        'alpha': Finding(math.degrees(now.alpha), 'deg', 'alpha'),
        'rho': Finding(math.degrees(now.rho), 'deg', 'pushing angle rho'),
        'yaw_acceleration': Finding(yaw_acceleration, 'rad/s^2', 'yaw acceleration of the box')})


def draw_initial(figure: Figure, _: Outcome, values: Values) -> None:
    """Draw the initial state."""
    axes, now = figure.subplots(), _start(values)
    sketch.set_up(axes)
    _draw_position(axes, now)
    gamma = now.state.gamma
    sketch.arrow(axes, now.contact, now.from_normal(0.0, 0.3), '$n$', at=0.95, side=270.0,
                 gap=9.0)
    sketch.angle(axes, now.contact, 0.19, (gamma, 0.0), '$\\rho$')
    sketch.angle(axes, now.mass_center, 0.12, (0.6, -0.6), "$\\omega'$")


def _start(values: Values) -> PushInstant:
    obj = box(values)
    location = pushing_location(obj, Contact('face', REAR_FACE), values.robot_radius)
    return instant_at_rotation(obj, location, values.initial_rotation, values.speed)


def _draw_position(axes: Axes, now: PushInstant) -> None:
    contact = now.contact
    sketch.pushed_object(axes, now.obj, now.pose)
    sketch.robot(axes, now.robot, now.robot_radius, (-0.55, 0.55))
    sketch.arrow(axes, contact, (0.31, 0.0), '$v$', sketch.PUSH)
    sketch.line(axes, contact, now.friction_center)
    if abs(now.alpha) > MIN_DRAWN_ALPHA:
        # The label is above the push, as the angle becomes narrow.
        sketch.angle(axes, contact, 0.14, (-now.alpha, 0.0), '$\\alpha$',
                     at=1.0 + math.radians(12.0) / now.alpha)
    sketch.point(axes, contact, '$C$', 140.0, 13.0, sketch.FORCE)
    sketch.point(axes, now.friction_center, '$F$', 270.0, 11.0, sketch.FLOOR)


STUDIES = (
    Study('2.2', 'A sliding object in its initial state', PARAMETERS, compute_initial,
          draw_initial,
          'The box moves with the robot and does not rotate yet: rho is {rho:.0f} degrees, '
          'alpha {alpha:.0f} degrees, the yaw acceleration {yaw_acceleration:.1f} rad/s^2.',
          'Friction at F rotates the box clockwise.', (6.4, 4.2)),
    Study('2.3', 'A pushing system: (a) initial, (b) intermediate and (c) rest position',
          PARAMETERS, compute, draw,
          'The box rotates until alpha has decreased from {alpha_initial:.0f} to {alpha_rest:.1f} '
          'degrees; half of that takes {distance:.2f} m.',
          'The contact C rolls along the face further than the centre of friction F '
          'swings.', (7.6, 3.4)))
