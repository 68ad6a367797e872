"""A disturbance for a while, and one that stays: optimiser against feedback."""

import numpy as np
from push_scenario.evaluation.metrics import deviation
from push_study.chapter3.scene import GOAL, PATH
from push_study.chapter4.floor import center_in_sight, friction_table, spell
from push_study.chapter4.intervals_picture import (
    draw_centers, draw_coefficients, draw_inputs, draw_objects,
)
from push_study.chapter4.scene import FEEDBACK, LAWS, LONGEST, OPTIMISER, push, SCENE
from push_study.framework.study import Finding, Outcome, Parameter, Study

LAST = 0.3
MILLI, CENTI = 1000.0, 100.0
PARAMETERS = (*SCENE, GOAL, Parameter('side', '', 'side whose supports change'),
              Parameter('factor', '', 'on the friction of these supports'),
              Parameter('begin', 's', 'when that begins'))
TEMPORARY = (*PARAMETERS, Parameter('lasting', 's', 'how long it lasts'))


def disturbance(values):
    """
    Return the disturbance of a study; without ``lasting`` it stays.

    :param values: ``Values`` with ``PARAMETERS`` or ``TEMPORARY``.
    :return: tuple of ``FrictionChange``.
    """
    lasting = getattr(values, 'lasting', LONGEST)
    return spell(values.side, values.factor, values.begin, values.begin + lasting)


def compute(values, batch):
    """
    Push under both laws while friction changes.

    :param values: ``Values`` with ``PARAMETERS`` or ``TEMPORARY``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    changes = disturbance(values)
    pushes = {law: push(values, values.goal, law, changes) for law in LAWS}
    optimiser, feedback = (pushes[law] for law in LAWS)
    friction = friction_table(values, changes, max(one.duration for one in pushes.values()))
    poses = np.column_stack([feedback.path[name] for name in PATH[1:4]])
    most = friction['center_y_m'][np.argmax(np.abs(friction['center_y_m']))]
    path = {**feedback.path, 'aim_rad': center_in_sight(feedback.path, friction)}
    last = path['way_m'] > path['way_m'][-1] - LAST
    return Outcome({OPTIMISER: optimiser.path, FEEDBACK: path, 'friction': friction}, {
        'shift': Finding(CENTI * float(most), 'cm', 'friction centre to the left, at the most'),
        'optimiser': Finding(optimiser.position_error, 'm', 'distance from the goal, optimiser'),
        'turn': Finding(optimiser.heading_error, 'rad', 'turn from the goal, optimiser'),
        'feedback': Finding(MILLI * feedback.position_error, 'mm',
                            'distance from the goal, feedback'),
        'feedback_cm': Finding(CENTI * feedback.position_error, 'cm', 'the same in centimetres'),
        'turned': Finding(abs(feedback.heading_error), 'rad',
                          'turn from the goal, feedback, either way'),
        'times': Finding(optimiser.position_error / feedback.position_error, '',
                         'distance of the optimiser over that of feedback'),
        'aside': Finding(CENTI * float(deviation(poses, feedback.planned)[0].max()), 'cm',
                         'largest distance of the middle from its planned way, feedback'),
        'factor': Finding(values.factor, '', 'on the friction of the supports on one side'),
        'begin': Finding(values.begin, 's', 'when that begins'),
        'arm': Finding(0.5 * values.box_length, 'm', 'distance from the contact to the middle'),
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'aim': Finding(float(path['aim_rad'][last].mean()), 'rad', 'angle from the contact to '
                       f'the friction centre, mean over the last {LAST:g} m, feedback'),
        'held': Finding(float(np.nanmean(path['rho_rad'][last])), 'rad',
                        f'mean pushing angle of feedback over the last {LAST:g} m'),
        'rolled': Finding(CENTI * float(_aside(path)[last].mean()), 'cm',
                          'contact from the middle of its face to the left, likewise'),
        'last': Finding(LAST, 'm', 'that way'),
        'peak': Finding(float(np.nanmax(np.abs(path['rho_rad']))), 'rad',
                        'largest pushing angle of feedback, either way'),
        'steepest': Finding(float(np.nanmax(np.abs(optimiser.path['rho_rad']))), 'rad',
                            'the same of the optimiser'),
        'more': Finding(feedback.duration - optimiser.duration, 's',
                        'time that feedback takes more than the optimiser')})


def _aside(path):
    """Contact in the object frame, to the left [m], shape (n,)."""
    return (np.cos(path['theta_rad']) * (path['contact_y_m'] - path['y_m'])
            - np.sin(path['theta_rad']) * (path['contact_x_m'] - path['x_m']))


def _four(first, kind, parameters, texts):
    """Make the four figures of one disturbance, from their sentences."""
    pictures = (('coefficients over time', draw_coefficients, (6.4, 4.2)),
                ('trajectory of the centre', draw_centers, (6.4, 2.9)),
                ('object trajectory', draw_objects, (6.4, 4.6)),
                ('input', draw_inputs, (6.4, 3.8)))
    return tuple(Study(f'4.{first + number}', f'A {kind} disturbance: {title}', parameters,
                       compute, draw, *sentences, size)
                 for number, ((title, draw, size), sentences) in enumerate(zip(pictures, texts)))


STUDIES = (
    *_four(8, 'temporary', TEMPORARY, (
        ('From {begin:.0f} s on the supports on one side rub {factor:.1f} times as much for a '
         'while, which moves the friction centre by {shift:.1f} cm to the left; neither planner '
         'nor controller is told.',
         'The friction centre is the mean of the supports, weighted by what each can bear: k '
         'times as much under two of four moves it by (k - 1) / (k + 1) of the way to their '
         'side.'),
        ('The plan played without looking ends {optimiser:.1f} m from the goal; with feedback the '
         'box is carried aside as well, but comes back and ends {feedback_cm:.1f} cm from it.',
         'Friction is as believed again long before the goal, but the robot of the optimiser '
         'drives on as planned and does not see what has happened.'),
        ('Played without looking, the box goes on turning to the left after the disturbance, by '
         '{turn:.1f} rad in the end; with feedback it turns back and goes straight.',
         'The friction centre is {arm:.1f} m from the contact and the centre of the robot only '
         '{radius:.1f} m, so that the box is like a pencil pushed at its end: a turn that has '
         'begun grows unless the robot follows it.'),
        ('Feedback swings to {peak:.1f} rad against the turn, then to the other side, and is back '
         'at {held:.2f} rad at the goal; the pushing angle of the optimiser runs away to '
         '{steepest:.1f} rad.',
         'The robot of the optimiser drives straight on while the face turns on it; feedback '
         'first pushes beyond the friction centre, which turns the box back.'))),
    *_four(12, 'sustained', PARAMETERS, (
        ('From {begin:.0f} s on the supports on one side rub {factor:.1f} times as much, which '
         'moves the friction centre by {shift:.1f} cm to the left for the rest of the way.',
         'The planner still counts on a friction centre in the middle, {arm:.1f} m ahead of the '
         'contact.'),
        ('The plan played without looking ends {optimiser:.1f} m from the goal, feedback '
         '{feedback_cm:.1f} cm from it, after having been {aside:.0f} cm aside.',
         'Feedback finds from how the box turns where its friction centre is, and draws a new '
         'path for that.'),
        ('Played without looking the box turns by {turn:.1f} rad and is left behind; with '
         'feedback it gets to the goal within {turned:.2f} rad, moving a little sideways.',
         'Pushed straight towards its friction centre, a box need not turn, whatever way it '
         'faces.'),
        ('The pushing angle of feedback comes back to {held:.2f} rad over the last {last:.1f} m, '
         'as the robot has rolled its contact {rolled:.1f} cm to the left, behind the new '
         'friction centre.',
         'To go straight, the force has to lead through the friction centre; along the normal it '
         'leaves the whole friction cone to either side. Nobody has told feedback where that '
         'is.'))))
