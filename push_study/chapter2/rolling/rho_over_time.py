"""The pushing angle over time after a disturbance, at three speeds, from the full dynamics."""

import math
from typing import NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_model.analysis.pushing_location import pushing_location, PushingLocation
from push_model.analysis.stability import free_response, linear_motion
from push_model.analysis.time_integration import integrate, straight_push
from push_model.contact import contact_point
from push_model.dynamics import equation_of_motion, Input, State
from push_model.geometry import FloatArray
from push_model.parameters import Contact, PushedObject, Support
from push_study.chapter2.rolling import alpha_curve
from push_study.framework import plot_style
from push_study.framework.box import BOX, box, REAR_FACE, rectangle
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: smooth curves.
SAMPLES = 601
FACE = Contact('face', REAR_FACE)
SWINGS = ('Rho overshoots 0 by {overshoot:.2f} of its initial value and dies out, as in the '
          'linearized motion about the equilibrium (dashed).')


def compute(values: Values, _: RunJobs) -> Outcome:
    """
    Compute the pushing angle over time, by the full dynamics and linearized.

    :raises ValueError: where the contact would be off the face, or would slide.
    """
    obj = pushed_box(values)
    location = pushing_location(obj, FACE, values.robot_radius)
    linear = linear_motion(obj, location, alpha_curve.middle_equilibrium(location), values.speed)
    push = straight_push(values.speed, 0.0)
    low, high = location.rotation_range
    start = released_state(obj, location, values.initial_rho)
    times, states = integrate(obj, location.rolling, push, start,
                              np.linspace(0.0, values.duration, SAMPLES),
                              lambda state: min(state.theta - low, high - state.theta))
    rho = location.rho(states[:, 2])
    linear_rho = values.initial_rho * free_response(linear, times)
    swing = _swing(times, rho, values.initial_rho)
    needed = _needed_friction(obj, location, states, push(0.0, start))
    return Outcome({'rho': {'time_s': times, 'rho_rad': rho, 'linear_rho_rad': linear_rho}}, {
        'overshoot': Finding(swing.overshoot, '', 'overshoot as a fraction of the initial value'),
        'frequency': Finding(swing.frequency, 'rad/s', 'frequency by the first two zeros, 0 where '
                             'there are none'),
        'ratio': Finding(linear.damping_ratio, '', 'damping ratio'),
        'linear_frequency': Finding(abs(linear.poles[0].imag), 'rad/s',
                                    'frequency of the linearized motion'),
        'needed_friction': Finding(needed, '', 'contact friction that rolling needs')})


def pushed_box(values: Values) -> PushedObject:
    """
    Make the box, on support points nearer to its middle than its corners.

    :param values: with the parameters ``BOX`` and ``support_spread``.
    :return: the box.
    """
    points = rectangle(values.support_spread * values.box_length,
                       values.support_spread * values.box_width)
    return box(values, supports=tuple(Support(x, y, values.friction_coefficient)
                                      for x, y in points))


def released_state(obj: PushedObject, location: PushingLocation, initial_rho: float) -> State:
    """
    Place the object in a push along world x, rotated with yaw rate 0, its contact rolled along.

    :param obj: the object.
    :param location: at the middle of ``FACE``.
    :param initial_rho: pushing angle [rad].
    :return: state.
    :raises ValueError: where the contact would be off the face.
    """
    rotation = float(location.rotation_at(initial_rho))
    if not location.rotation_range[0] < rotation < location.rotation_range[1]:
        raise ValueError(f'initial_rho: got {initial_rho:g}, where the contact is off the face, '
                         f'expected less than {location.rotation_range[1]:.3g} [rad]')
    x, y = contact_point(obj, FACE)
    return State(0.0, 0.0, rotation, 0.0, rotation, x, y + location.rolling[1] * rotation)


def _needed_friction(obj: PushedObject, location: PushingLocation, states: FloatArray,
                     inputs: Input) -> float:
    """Find the contact friction that rolling needs along a motion, states of shape (n, 7)."""
    motion = equation_of_motion(obj, location.rolling)
    normal, tangential = np.array(motion.map(len(states))(states.T, inputs)[1])
    needed = float(np.max(np.abs(tangential) / normal))
    if normal.min() <= 0.0 or needed > obj.contact_friction_coefficient:
        raise ValueError(f'contact_friction: got {obj.contact_friction_coefficient:g}, with which '
                         f'the contact slides, expected at least {needed:.3g}')
    return needed


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the pushing angle over time."""
    axes, table = figure.subplots(), outcome.tables['rho']
    axes.axhline(0.0, color=plot_style.GREY, linewidth=0.8)
    axes.plot(table['time_s'], table['rho_rad'], label='full dynamics', **plot_style.series(0))
    axes.plot(table['time_s'], table['linear_rho_rad'], label='linearized motion',
              **plot_style.series(1))
    axes.set_xlabel('time [s]')
    axes.set_ylabel('pushing angle $\\rho$ [rad]')
    axes.set_xlim(0.0, values.duration)
    axes.set_ylim(-0.65 * values.initial_rho, 1.1 * values.initial_rho)
    axes.legend(loc='upper right')


class Swing(NamedTuple):
    """
    How a disturbance oscillates.

    :param overshoot: fraction of the initial value, 0 where there is none.
    :param frequency: from the time between the first two zeros; 0 where there are not two
        [rad/s].
    """

    overshoot: float
    frequency: float


def _swing(times: FloatArray, rho: FloatArray, initial_rho: float) -> Swing:
    before = np.flatnonzero(rho[:-1] * rho[1:] < 0.0)[:2]
    zeros = times[before] - rho[before] * np.diff(times)[before] / np.diff(rho)[before]
    frequency = math.pi / (zeros[1] - zeros[0]) if len(zeros) == 2 else 0.0
    return Swing(max(0.0, float(np.max(-rho / initial_rho))), float(frequency))


def _study(figure: str, speed: float, observation: str, explanation: str) -> Study:
    return Study(figure, f'Pushing angle over time at {speed:g} m/s', (
        Parameter('speed', 'm/s', 'speed of the push, v_c', speed), *BOX,
        Parameter('support_spread', '', 'distance of the support points from the middle, over '
                  'that of the corners'),
        Parameter('robot_radius', 'm', 'radius of the robot'),
        Parameter('initial_rho', 'rad', 'pushing angle at which the object is released'),
        Parameter('duration', 's', 'time that is drawn')),
        compute, draw, observation, explanation)


STUDIES = (
    _study('2.15', 0.5, 'Rho decays to 0 without overshoot ({overshoot:.2f}).',
           'In a slow push the friction of the floor damps a rotation more than inertia can carry '
           'it on: damping ratio {ratio:.2f}.'),
    _study('2.16', 1.5, SWINGS, 'Three times as fast, friction opposes the same rotation with a '
           'third of the damping, as its direction follows the sliding: damping ratio '
           '{ratio:.2f}.'),
    _study('2.17', 2.5, SWINGS, 'Damping is inversely proportional to the speed, while the '
           'restoring moment stays the same: damping ratio {ratio:.2f}, {frequency:.2f} rad/s.'))
