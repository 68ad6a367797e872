"""Sketch of a push over time: initial, intermediate and rest position on a round robot."""

import math

import numpy as np
from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.time_integration import integrate, straight_push
from push_model.contact import rolling_constants
from push_model.dynamics import State
from push_model.parameters import Contact
from push_study.chapter2.sketches.push_instant import at_turn
from push_study.framework import sketch, sketch_body
from push_study.framework.scenes import BOX, box
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES = 400
NAMES = ('initial', 'intermediate', 'rest')
PARAMETERS = BOX + (
    Parameter('robot_radius', 'm', 'radius of the robot'),
    Parameter('speed', 'm/s', 'of the robot'),
    Parameter('start_turn', 'rad', 'turn of the box from rest at the start'),
    Parameter('duration', 's', 'of the push'))


def push(values):
    """
    Integrate the push.

    :param values: ``Values``.
    :return: (times [s], list of ``PushInstant``).
    """
    obj = box(values)
    start = at_turn(obj, pushing_location(obj, Contact('face', 3), values.robot_radius),
                    values.start_turn, values.speed)
    rolling = rolling_constants(values.robot_radius, math.inf)
    times, states = integrate(obj, rolling, straight_push(values.speed, 0.0), start.state,
                              np.linspace(0.0, values.duration, SAMPLES))
    return times, [start._replace(state=State(*state.tolist())) for state in states]


def compute(values, batch):
    """
    Compute the three positions: at first, turned back by half, and at the end.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    times, motion = push(values)
    alpha = np.array([now.alpha for now in motion])
    drawn = [0, int(np.argmin(np.abs(alpha - 0.5 * alpha[0]))), len(motion) - 1]
    path = np.array([now.friction_centre for now in motion])
    places = {'position': NAMES, 'time_s': times[drawn], 'alpha_rad': alpha[drawn],
              'rho_rad': [motion[i].push_angle - motion[i].state.gamma for i in drawn]}
    for name in State._fields:
        unit = {'theta': 'rad', 'gamma': 'rad', 'omega': 'rad_s'}.get(name, 'm')
        places[f'{name}_{unit}'] = [getattr(motion[i].state, name) for i in drawn]
    angles = np.degrees(alpha[drawn])
    findings = {f'alpha_{name}': Finding(float(value), 'deg', f'alpha, {name} position')
                for name, value in zip(NAMES, angles)}
    findings['way'] = Finding(values.speed * float(times[drawn[1]]), 'm',
                              'way after which alpha is half')
    return Outcome({'positions': places, 'path': {
        'time_s': times, 'x_f_m': path[:, 0], 'y_f_m': path[:, 1], 'alpha_rad': alpha}}, findings)


def draw(figure, outcome, values):
    """
    Draw the three positions along the way.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    obj, places = box(values), outcome.tables['positions']
    location = pushing_location(obj, Contact('face', 3), values.robot_radius)
    start = at_turn(obj, location, values.start_turn, values.speed)
    path = outcome.tables['path']
    for index, axes in enumerate(figure.subplots(1, len(NAMES), sharex=True, sharey=True)):
        sketch.sheet(axes)
        state = State(*(places[column][index] for column in list(places)[4:]))
        time = places['time_s'][index]
        # Seen from the robot: its way is taken off.
        now = start._replace(state=state._replace(x=state.x - values.speed * time))
        _draw_position(axes, now)
        until = path['time_s'] <= time
        axes.plot((path['x_f_m'] - values.speed * path['time_s'])[until], path['y_f_m'][until],
                  color=sketch.FLOOR, linewidth=1.0, linestyle=(0, (1, 1)))
        axes.set_title(f'{NAMES[index]}, $t$ = {time:.1f} s', loc='left')


def _draw_position(axes, now):
    at = now.contact
    sketch_body.solid(axes, now.obj, now.pose)
    sketch_body.disc(axes, now.robot, now.robot_radius, (-0.55, 0.55))
    sketch.arrow(axes, at, (0.31, 0.0), '$v$', sketch.PUSH)
    sketch.line(axes, at, now.friction_centre)
    if abs(now.alpha) > math.radians(5.0):
        # The label stands above the push, as the angle gets narrow.
        sketch.angle(axes, at, 0.14, -now.alpha, 0.0, '$\\alpha$',
                     at=1.0 + math.radians(12.0) / now.alpha)
    sketch_body.point(axes, at, '$C$', 140.0, 13.0, sketch.FORCE)
    sketch_body.point(axes, now.friction_centre, '$F$', 270.0, 11.0, sketch.FLOOR)


STUDIES = (Study(
    '2.2', 'Initial, intermediate and rest position', PARAMETERS, compute, draw,
    'Pushed by a round robot, the box turns until alpha has gone from {alpha_initial:.0f} to '
    '{alpha_rest:.1f} degrees; half of that takes {way:.2f} m.',
    'As the box turns, the contact C rolls along the face by R_e per radian, further than the '
    'friction centre F swings, until F lies on the line of the push.', (7.6, 3.4)),)
