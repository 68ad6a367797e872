"""The pushing angle over time after a disturbance, at three speeds: a round object."""

import math
from typing import Mapping, NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_model.dynamics import Input, State
from push_model.equation_of_motion import equation_of_motion
from push_model.geometry import FloatArray
from push_model.parameters import Contact, PushedObject, Support
from studies.analysis.pushing_location import pushing_location, PushingLocation
from studies.analysis.stability import free_response, linear_motion
from studies.analysis.time_integration import integrate, straight_push
from studies.chapter2.rolling import alpha_curve
from studies.chapter2.rolling.round_object import DISTANCE_ORIGIN, friction_center_from_contact
from studies.chapter2.rolling.sliding import CONTACT_FRICTION, SUPPORT_SPREAD
from studies.chapter2.sketches.push_instant import instant_at_rotation
from studies.framework import plot_style
from studies.framework.box import FRICTION, MASS
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: smooth curves.
SAMPLES = 601
# The contact at the reference, behind the middle of the object.
BEHIND = Contact('round', 0, math.pi)
# Chosen: a smaller overshoot is not seen.
MIN_OVERSHOOT = 0.005


def compute(values: Values, _: RunJobs) -> Outcome:
    """
    Compute the pushing angle over time, by the full dynamics and linearized.

    :raises ValueError: where the contact would slide.
    """
    obj = pushed_object(values)
    location = pushing_location(obj, BEHIND, values.robot_radius)
    middle = alpha_curve.middle_equilibrium(location)
    linear = linear_motion(obj, location, middle, values.speed)
    push = straight_push(values.speed, 0.0)
    start = released_state(obj, location, middle.rho + values.initial_deviation, values.speed)
    times, states = integrate(obj, location.rolling, push, start,
                              np.linspace(0.0, values.duration, SAMPLES))
    rho = -states[:, STATE_GAMMA]
    linear_rho = middle.rho + values.initial_deviation * free_response(linear, times)
    swing, linear_swing = (_swing(times, angles - middle.rho, values.initial_deviation)
                           for angles in (rho, linear_rho))
    needed = _needed_friction(obj, location, states, push(0.0, start))
    return Outcome({'rho': {'time_s': times, 'rho_rad': rho, 'linear_rho_rad': linear_rho}}, {
        'rest': Finding(middle.rho, 'rad', 'pushing angle at the equilibrium'),
        'overshoot': Finding(swing.overshoot, '', 'overshoot as a fraction of the initial '
                             'deviation'),
        'linear_overshoot': Finding(linear_swing.overshoot, '', 'the same, linearized'),
        'frequency': Finding(swing.frequency, 'rad/s', 'frequency by the first two passages '
                             'through the equilibrium, 0 where there are none'),
        'speed': Finding(values.speed, 'm/s', 'speed of the push'),
        'ratio': Finding(linear.damping_ratio, '', 'damping ratio'),
        'linear_frequency': Finding(abs(linear.poles[0].imag), 'rad/s',
                                    'frequency of the linearized motion'),
        'needed_friction': Finding(needed, '', 'contact friction that rolling needs')})


# Column of gamma in a state; the push is along world x, so that rho = -gamma.
STATE_GAMMA = State._fields.index('gamma')


def pushed_object(values: Values) -> PushedObject:
    """
    Make the round object of figure 2.14, its mass centre in the centre of friction.

    :param values: with the parameters of the study.
    :return: the object, its middle at the origin.
    """
    ahead, lateral = friction_center_from_contact(values)
    x, y, distance = ahead - values.object_radius, lateral, values.support_spread
    points = ((x + distance, y), (x, y + distance), (x - distance, y), (x, y - distance))
    supports = tuple(Support(*point, values.friction_coefficient) for point in points)
    return PushedObject(values.mass, 0.0, supports, radius=values.object_radius,
                        center_of_mass=(x, y),
                        contact_friction_coefficient=values.contact_friction)


def released_state(obj: PushedObject, location: PushingLocation, rho: float,
                   speed: float) -> State:
    """
    Place the object in a push along world x, rotated with yaw rate 0, its contact rolled along.

    :param obj: the object.
    :param location: at ``BEHIND``.
    :param rho: pushing angle [rad].
    :param speed: of the push [m/s].
    :return: state.
    """
    return instant_at_rotation(obj, location, float(location.rotation_at(rho)), speed).state


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
    equilibrium = outcome.findings['rest'].value
    axes.axhline(equilibrium, color=plot_style.GREY, linewidth=0.8, label='equilibrium')
    axes.plot(table['time_s'], table['rho_rad'], label='full dynamics', **plot_style.series(0))
    axes.plot(table['time_s'], table['linear_rho_rad'], label='linearized motion',
              **plot_style.series(1))
    axes.set_xlabel('time [s]')
    axes.set_ylabel('pushing angle $\\rho$ [rad]')
    axes.set_xlim(0.0, values.duration)
    axes.set_ylim(equilibrium - 0.85 * values.initial_deviation,
                  equilibrium + 1.1 * values.initial_deviation)
    axes.legend(loc='upper right')


class Swing(NamedTuple):
    """
    Oscillation of a disturbance.

    :param overshoot: fraction of the initial deviation, 0 where there is none.
    :param frequency: from the time between the first two zeros; 0 where there are not two
        [rad/s].
    """

    overshoot: float
    frequency: float


def _swing(times: FloatArray, deviation: FloatArray, initial: float) -> Swing:
    before = np.flatnonzero(deviation[:-1] * deviation[1:] < 0.0)[:2]
    zeros = (times[before]
             - deviation[before] * np.diff(times)[before] / np.diff(deviation)[before])
    frequency = math.pi / (zeros[1] - zeros[0]) if len(zeros) == 2 else 0.0
    return Swing(max(0.0, float(np.max(-deviation / initial))), float(frequency))


def _observation(findings: Mapping[str, float]) -> str:
    if findings['overshoot'] < MIN_OVERSHOOT:
        return 'Rho decays to its equilibrium, {rest:.2f} rad, without overshoot.'
    return ('Rho overshoots its equilibrium ({rest:.2f} rad) by {overshoot:.2f} of the initial '
            'deviation; linearized (dashed) by {linear_overshoot:.2f} only.')


def _explanation(findings: Mapping[str, float]) -> str:
    if findings['ratio'] >= 1.0:
        return 'At {speed:g} m/s the damping ratio is {ratio:.2f}.'
    return ('Damping is inversely proportional to the speed: at {speed:g} m/s its ratio is '
            '{ratio:.2f}.')


def _study(figure: str, speed: float) -> Study:
    title = 'Pushing angle over time at {speed:g} m/s: a round object on a round robot'
    return Study(figure, title, (
        Parameter('speed', 'm/s', 'speed of the push, v_c', speed),
        Parameter('robot_radius', 'm', 'radius of the robot, as in 2.14'),
        Parameter('object_radius', 'm', 'radius of the object, as in 2.14'),
        Parameter('center_distance', 'm', 'distance of the centre of friction, as in 2.14'),
        Parameter('beta', 'rad', 'direction of the centre of friction, as in 2.14'),
        DISTANCE_ORIGIN, SUPPORT_SPREAD, MASS, FRICTION, CONTACT_FRICTION,
        Parameter('initial_deviation', 'rad', 'pushing angle at which the object is released, '
                  'from its equilibrium'),
        Parameter('duration', 's', 'time that is drawn')),
        compute, draw, _observation, _explanation)


STUDIES = (_study('2.15', 0.5), _study('2.16', 1.5), _study('2.17', 2.5))
