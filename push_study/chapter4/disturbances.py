"""A temporary and a sustained disturbance of the friction: open loop against feedback."""

import functools
from typing import NamedTuple

import numpy as np
from push_scenario.evaluation.metrics import deviation
from push_sim_node.disturbance import FrictionChange
from push_study.chapter3.setup import contact_on_face, GOAL, POSE_COLUMNS
from push_study.chapter4.disturbances_figure import (
    draw_centers, draw_coefficients, draw_inputs, draw_objects, EndTime,
)
from push_study.chapter4.setup import FEEDBACK, LAWS, OPEN_LOOP, push, SETUP, TIME_LIMIT
from push_study.chapter4.support_friction import (
    angle_to_friction_center, friction_interval, friction_table,
)
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: means "at the goal" are taken over this last distance [m].
LAST_DISTANCE = 0.3
MILLIMETRES = 1000.0
CENTIMETRES = 100.0
SUSTAINED_PARAMETERS = (
    *SETUP, GOAL, Parameter('side', '', 'side whose support points change'),
    Parameter('factor', '', 'factor on the friction of these support points'),
    Parameter('start_time', 's', 'when the disturbance begins'))
TEMPORARY_PARAMETERS = (
    *SUSTAINED_PARAMETERS, Parameter('interval', 's', 'duration of the disturbance'))


def temporary_end(values: Values) -> float:
    """
    Find when a temporary disturbance ends.

    :param values: with the parameters ``TEMPORARY_PARAMETERS``.
    :return: time [s].
    """
    return values.start_time + values.interval


def sustained_end(values: Values) -> float:
    """
    Find when a sustained disturbance ends: after the push.

    :param values: with the parameters ``SUSTAINED_PARAMETERS``.
    :return: time [s].
    """
    return values.start_time + TIME_LIMIT


def disturbance(end_time: EndTime, values: Values) -> tuple[FrictionChange, ...]:
    """
    Make the disturbance of a study.

    :param end_time: function of the values that returns when it ends [s].
    :param values: with the parameters ``SUSTAINED_PARAMETERS``.
    :return: changes of the friction.
    """
    return friction_interval(values.side, values.factor, values.start_time, end_time(values))


def _compute(end_time: EndTime, values: Values, _: RunJobs) -> Outcome:
    """Push under both laws while friction changes."""
    changes = disturbance(end_time, values)
    pushes = {law: push(values, values.goal, law, changes) for law in LAWS}
    open_loop, feedback = pushes[OPEN_LOOP], pushes[FEEDBACK]
    friction = friction_table(values, changes,
                              max(executed.duration for executed in pushes.values()))
    poses = np.column_stack([feedback.path[name] for name in POSE_COLUMNS])
    shift = friction['center_y_m'][np.argmax(np.abs(friction['center_y_m']))]
    path = {**feedback.path, 'aim_rad': angle_to_friction_center(feedback.path, friction)}
    last = path['distance_m'] > path['distance_m'][-1] - LAST_DISTANCE
    return Outcome({OPEN_LOOP: open_loop.path, FEEDBACK: path, 'friction': friction}, {
        'shift': Finding(CENTIMETRES * float(shift), 'cm',
                         'largest shift of the centre of friction to the left'),
        'open_loop': Finding(open_loop.position_error, 'm', 'distance from the goal, open loop'),
        'heading_open_loop': Finding(open_loop.heading_error, 'rad', 'heading error, open loop'),
        'feedback': Finding(MILLIMETRES * feedback.position_error, 'mm',
                            'distance from the goal, feedback'),
        'feedback_cm': Finding(CENTIMETRES * feedback.position_error, 'cm',
                               'the same in centimetres'),
        'heading_feedback': Finding(abs(feedback.heading_error), 'rad',
                                    'magnitude of the heading error, feedback'),
        'ratio': Finding(open_loop.position_error / feedback.position_error, '',
                         'distance from the goal in open loop over that with feedback'),
        'deviation': Finding(
            CENTIMETRES * float(deviation(poses, feedback.planned)[0].max()), 'cm',
            'largest distance of the middle from its planned path, feedback'),
        'factor': Finding(values.factor, '',
                          'factor on the friction of the support points on one side'),
        'start_time': Finding(values.start_time, 's', 'when the disturbance begins'),
        'arm': Finding(0.5 * values.box_length, 'm', 'distance from the contact to the middle'),
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'aim': Finding(float(path['aim_rad'][last].mean()), 'rad', 'angle from the contact to '
                       f'the centre of friction, mean over the last {LAST_DISTANCE:g} m, '
                       'feedback'),
        'final_rho': Finding(float(np.nanmean(path['rho_rad'][last])), 'rad',
                             'mean pushing angle of feedback over the last '
                             f'{LAST_DISTANCE:g} m'),
        'rolled': Finding(CENTIMETRES * float(contact_on_face(path)[last].mean()), 'cm',
                          'contact to the left of the middle of its face, likewise'),
        'last': Finding(LAST_DISTANCE, 'm', 'that distance'),
        'peak': Finding(float(np.nanmax(np.abs(path['rho_rad']))), 'rad',
                        'largest magnitude of the pushing angle, feedback'),
        'peak_open_loop': Finding(float(np.nanmax(np.abs(open_loop.path['rho_rad']))), 'rad',
                                  'the same, open loop'),
        'delay': Finding(feedback.duration - open_loop.duration, 's',
                         'duration with feedback above that in open loop')})


class Caption(NamedTuple):
    """
    The two sentences below a figure.

    :param observation: what it shows.
    :param explanation: why that is so.
    """

    observation: str
    explanation: str


def _studies(first: int, kind: str, parameters: tuple[Parameter, ...], end_time: EndTime,
             captions: tuple[Caption, ...]) -> tuple[Study, ...]:
    """Make the four figures of one disturbance."""
    figures = (('coefficients over time', draw_coefficients, (6.4, 4.2)),
               ('trajectory of the centre', functools.partial(draw_centers, end_time),
                (6.4, 4.6)),
               ('object trajectory', draw_objects, (6.4, 4.6)),
               ('input', functools.partial(draw_inputs, end_time), (6.4, 3.8)))
    compute = functools.partial(_compute, end_time)
    return tuple(Study(f'4.{number}', f'A {kind} disturbance: {title}', parameters, compute, draw,
                       *caption, size)
                 for number, ((title, draw, size), caption) in enumerate(zip(figures, captions),
                                                                         first))


TEMPORARY = _studies(8, 'temporary', TEMPORARY_PARAMETERS, temporary_end, (
    Caption('From {start_time:.0f} s on, the support points on one side have {factor:.1f} times '
            'the friction for an interval, which moves the centre of friction by {shift:.1f} cm '
            'to the left; neither planner nor controller is informed.',
            'The centre of friction is the mean of the support points, weighted by their '
            'capacities: k times the friction at two of four moves it by (k - 1) / (k + 1) of the '
            'distance to their side.'),
    Caption('The plan executed in open loop ends {open_loop:.1f} m from the goal; with feedback '
            'the box is carried aside as well, but returns and ends {feedback_cm:.1f} cm from '
            'it.',
            'Friction is nominal again long before the goal, but in open loop the robot continues '
            'as planned and does not observe what has happened.'),
    Caption('In open loop the box continues to rotate to the left after the disturbance, by '
            '{heading_open_loop:.1f} rad in the end; with feedback it rotates back and moves '
            'straight.',
            'The centre of friction is {arm:.1f} m from the contact and the centre of the robot '
            'only {radius:.1f} m, so that the box resembles a pencil pushed at its end: a '
            'rotation that has begun grows unless the robot reacts.'),
    Caption('Feedback swings to {peak:.1f} rad against the rotation, then to the other side, and '
            'is back at {final_rho:.2f} rad at the goal; the pushing angle in open loop diverges '
            'to {peak_open_loop:.1f} rad.',
            'In open loop the robot moves straight on while the face rotates on it; feedback '
            'first pushes beyond the centre of friction, which rotates the box back.')))
SUSTAINED = _studies(12, 'sustained', SUSTAINED_PARAMETERS, sustained_end, (
    Caption('From {start_time:.0f} s on, the support points on one side have {factor:.1f} times '
            'the friction, which moves the centre of friction by {shift:.1f} cm to the left for '
            'the rest of the push.',
            'The planner still assumes a centre of friction in the middle, {arm:.1f} m ahead of '
            'the contact.'),
    Caption('The plan executed in open loop ends {open_loop:.1f} m from the goal, feedback '
            '{feedback_cm:.1f} cm from it, after a deviation of {deviation:.0f} cm.',
            'Feedback identifies the centre of friction from how the box rotates, and plans a new '
            'path for it.'),
    Caption('In open loop the box rotates by {heading_open_loop:.1f} rad and is left behind; with '
            'feedback it reaches the goal within {heading_feedback:.2f} rad, moving slightly '
            'sideways.',
            'Pushed straight towards its centre of friction, a box need not rotate, whatever its '
            'orientation.'),
    Caption('The pushing angle of feedback returns to {final_rho:.2f} rad over the last '
            '{last:.1f} m, as the robot has rolled its contact {rolled:.1f} cm to the left, '
            'behind the new centre of friction.',
            'For straight motion the force must pass through the centre of friction; along the '
            'normal it leaves the whole friction cone to either side. Feedback was not informed '
            'where that is.')))
STUDIES = TEMPORARY + SUSTAINED
