"""The pushing angle over time after a disturbance, at three speeds, from the full dynamics."""

import math

import numpy as np
from push_model.analysis.pushing_location import pushing_location
from push_model.analysis.stability import free_response, linear_motion
from push_model.analysis.time_integration import integrate, straight_push
from push_model.contact import contact_point
from push_model.dynamics import equation_of_motion, State
from push_model.parameters import Contact, Support
from push_study.chapter2.rolling import alpha_plot
from push_study.framework import paper
from push_study.framework.scenes import BOX, box, corners
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES = 601
FACE = Contact('face', 3)
SWINGS = ('Rho swings past 0 by {overshoot:.2f} of where it started and dies out, as in the '
          'linear motion about the equilibrium (dashed).')


def compute(values, batch):
    """
    Pushing angle over time, by the full dynamics and by the linear motion.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    :raises ValueError: where the contact would be off the face, or would slide.
    """
    obj = pushed_box(values)
    location = pushing_location(obj, FACE, values.robot_radius)
    linear = linear_motion(obj, location, alpha_plot.middle(location), values.speed)
    push = straight_push(values.speed, 0.0)
    low, high = location.rotation_range
    times, states = integrate(obj, location.rolling, push,
                              release(obj, location, values.start_rho),
                              np.linspace(0.0, values.duration, SAMPLES),
                              lambda state: min(state.theta - low, high - state.theta))
    rho = location.rho(states[:, 2])
    return Outcome({'rho': {'time_s': times, 'rho_rad': rho,
                            'linear_rho_rad': values.start_rho * free_response(linear, times)}},
                   {**_swing(times, rho, values.start_rho),
                    'ratio': Finding(linear.damping_ratio, '', 'damping ratio'),
                    'linear_frequency': Finding(abs(linear.poles[0].imag), 'rad/s',
                                                'frequency of the linear motion'),
                    'grip': Finding(_grip(obj, location, states, push(0.0, None)), '',
                                    'contact friction that rolling needs')})


def pushed_box(values):
    """
    Make the box, on feet nearer to its middle than its corners.

    :param values: ``Values``.
    :return: ``PushedObject``.
    """
    feet = corners(values.spread * values.box_length, values.spread * values.box_width)
    return box(values, supports=tuple(Support(x, y, values.friction_coefficient)
                                      for x, y in feet))


def release(obj, location, start_rho):
    """
    Place the object in a push along world x, turned but not turning, its contact rolled along.

    :param obj: the ``PushedObject``.
    :param location: ``PushingLocation`` at the middle of ``FACE``.
    :param start_rho: pushing angle [rad].
    :return: ``State``.
    :raises ValueError: where the contact would be off the face.
    """
    turn = float(location.rotation_at(start_rho))
    if not location.rotation_range[0] < turn < location.rotation_range[1]:
        raise ValueError(f'start_rho: got {start_rho:g}, where the contact is off the face, '
                         f'expected less than {location.rotation_range[1]:.3g} [rad]')
    x, y = contact_point(obj, FACE)
    return State(0.0, 0.0, turn, 0.0, turn, x, y + location.rolling[1] * turn)


def _grip(obj, location, states, inputs):
    motion = equation_of_motion(obj, location.rolling)
    normal, tangential = np.array(motion.map(len(states))(states.T, inputs)[1])
    grip = float(np.max(np.abs(tangential) / normal))
    if normal.min() <= 0.0 or grip > obj.contact_friction_coefficient:
        raise ValueError(f'contact_friction: got {obj.contact_friction_coefficient:g}, with which '
                         f'the contact slides, expected at least {grip:.3g}')
    return grip


def draw(figure, outcome, values):
    """
    Draw the pushing angle over time.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes, table = figure.subplots(), outcome.tables['rho']
    axes.axhline(0.0, color=paper.GREY, linewidth=0.8)
    axes.plot(table['time_s'], table['rho_rad'], label='full dynamics', **paper.series(0))
    axes.plot(table['time_s'], table['linear_rho_rad'], label='linear motion', **paper.series(1))
    axes.set_xlabel('time [s]')
    axes.set_ylabel('pushing angle $\\rho$ [rad]')
    axes.set_xlim(0.0, values.duration)
    axes.set_ylim(-0.65 * values.start_rho, 1.1 * values.start_rho)
    axes.legend(loc='upper right')


def _swing(times, rho, start):
    """Overshoot, and the frequency by the time between the first two zeros, 0 where not two."""
    before = np.flatnonzero(rho[:-1] * rho[1:] < 0.0)[:2]
    zeros = times[before] - rho[before] * np.diff(times)[before] / np.diff(rho)[before]
    frequency = math.pi / (zeros[1] - zeros[0]) if len(zeros) == 2 else 0.0
    return {'overshoot': Finding(max(0.0, float(np.max(-rho / start))), '',
                                 'swing past 0 as a share of the start'),
            'frequency': Finding(float(frequency), 'rad/s', 'frequency by the first two zeros, '
                                 '0 where there are none')}


def _study(figure, speed, seen, why):
    return Study(figure, f'Pushing angle over time at {speed:g} m/s', (
        Parameter('speed', 'm/s', 'speed of the push, v_c', speed), *BOX,
        Parameter('spread', '', 'distance of the supports from the middle: 1 is at the corners'),
        Parameter('robot_radius', 'm', 'radius of the robot'),
        Parameter('start_rho', 'rad', 'pushing angle from which the object is let go'),
        Parameter('duration', 's', 'time that is drawn')),
        compute, draw, seen, why)


STUDIES = (
    _study('2.15', 0.5, 'Rho creeps back to 0 and does not pass it (overshoot '
           '{overshoot:.2f}).',
           'When slow, the friction of the floor damps a turn more than inertia can carry it on: '
           'damping ratio {ratio:.2f}.'),
    _study('2.16', 1.5, SWINGS, 'Three times as fast, friction opposes the same turn with a '
           'third of the damping, as its direction follows the sliding: damping ratio '
           '{ratio:.2f}.'),
    _study('2.17', 2.5, SWINGS, 'Damping falls as one over the speed, while what brings rho back '
           'stays: damping ratio {ratio:.2f}, {frequency:.2f} rad/s.'))
