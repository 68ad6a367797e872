"""A temporary and a sustained disturbance of the friction: open loop against feedback."""

import functools
from typing import NamedTuple

import numpy as np
from push_scenario.evaluation.metrics import deviation
from push_sim_node.disturbance import FrictionChange
from push_study.chapter3.setup import contact_on_face, GOAL, POSE_COLUMNS
from push_study.chapter4.disturbances_figure import (
    draw_centers, draw_inputs, draw_objects, EndTime,
)
from push_study.chapter4.repeated_push import COLUMNS, median_findings, repeat, RepeatedPush
from push_study.chapter4.setup import (
    ExecutedPush, FEEDBACK, LABELS, Law, MOBILE_CENTER, MPC, OBJECT_FRAME, ONE_PATH, OPEN_LOOP,
    push, PushSetup, SETUP, TIME_LIMIT, total_variation,
)
from push_study.chapter4.support_friction import (
    angle_to_friction_center, draw_coefficients, friction_interval, friction_table,
)
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: means "at the goal" are taken over this last distance [m].
LAST_DISTANCE = 0.3
MILLIMETRES = 1000.0
CENTIMETRES = 100.0
LAWS: tuple[Law, ...] = (OPEN_LOOP, OBJECT_FRAME, FEEDBACK, MPC, MOBILE_CENTER)
# Laws whose pushes depend on the errors of the sensors, and are repeated with others.
REPEATED: tuple[Law, ...] = (FEEDBACK, MPC, MOBILE_CENTER)
SEEDS = Parameter('seeds', '', 'number of pushes under each law, with other sensor errors')
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


def _pushes(end_time: EndTime, values: Values,
            laws: tuple[Law, ...] = LAWS) -> dict[Law, ExecutedPush]:
    """Push under some laws while friction changes."""
    changes = disturbance(end_time, values)
    return {law: push(values, values.goal, law, changes) for law in laws}


def _friction(end_time: EndTime, values: Values, pushes: dict[Law, ExecutedPush]) -> Table:
    """Tabulate the friction until the end of the longest push."""
    return friction_table(values, disturbance(end_time, values),
                          max(executed.duration for executed in pushes.values()))


def _compute_friction(end_time: EndTime, values: Values, _: RunJobs) -> Outcome:
    """Tabulate the friction."""
    friction = _friction(end_time, values, _pushes(end_time, values, (FEEDBACK,)))
    shift = friction['center_y_m'][np.argmax(np.abs(friction['center_y_m']))]
    return Outcome({'friction': friction}, {
        'shift': Finding(CENTIMETRES * float(shift), 'cm',
                         'largest shift of the centre of friction to the left'),
        'factor': Finding(values.factor, '',
                          'factor on the friction of the support points on one side'),
        'start_time': Finding(values.start_time, 's', 'when the disturbance begins'),
        'arm': Finding(0.5 * values.box_length, 'm', 'distance from the contact to the middle')})


def _compute_paths(end_time: EndTime, values: Values, _: RunJobs) -> Outcome:
    """Push under all laws."""
    pushes = _pushes(end_time, values)
    feedback = pushes[FEEDBACK]
    poses = np.column_stack([feedback.path[name] for name in POSE_COLUMNS])
    findings = {
        'deviation': Finding(
            CENTIMETRES * float(deviation(poses, feedback.planned)[0].max()), 'cm',
            'largest distance of the middle from its planned path, feedback'),
        'arm': Finding(0.5 * values.box_length, 'm', 'distance from the contact to the middle'),
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot')}
    for law, executed in pushes.items():
        findings[law] = Finding(CENTIMETRES * executed.position_error, 'cm',
                                f'distance from the goal, {LABELS[law]}')
        findings[f'heading_{law}'] = Finding(executed.heading_error, 'rad', 'heading error')
    return Outcome({law: executed.path for law, executed in pushes.items()}, findings)


def _compute_ends(end_time: EndTime, values: Values, run_jobs: RunJobs) -> Outcome:
    """Push under all laws, under those that measure with other errors of the sensors as well."""
    outcome = _compute_paths(end_time, values, run_jobs)
    repeated = RepeatedPush(PushSetup.of(values), tuple(values.goal),
                            disturbance(end_time, values))
    ends = repeat(repeated, REPEATED, int(values.seeds), run_jobs)
    findings = {**outcome.findings, 'pushes': Finding(float(values.seeds), '',
                                                      'number of pushes under each law')}
    for law in REPEATED:
        findings.update(median_findings(
            f'median_{law}', CENTIMETRES * ends[f'{law}_{COLUMNS[0]}'], 'cm',
            f'median distance from the goal, {LABELS[law]}'))
    return Outcome({**outcome.tables, 'ends': ends}, findings)


def _compute_input(end_time: EndTime, values: Values, _: RunJobs) -> Outcome:
    """Push under all laws, and find out what the pushing angle does."""
    pushes = _pushes(end_time, values, (*LAWS, ONE_PATH))
    friction = _friction(end_time, values, pushes)
    tables: dict[str, Table] = {law: executed.path for law, executed in pushes.items()}
    path = tables[FEEDBACK]
    path = tables[FEEDBACK] = {**path, 'aim_rad': angle_to_friction_center(path, friction)}
    last = path['distance_m'] > path['distance_m'][-1] - LAST_DISTANCE
    findings = {
        'aim': Finding(float(path['aim_rad'][last].mean()), 'rad', 'angle from the contact to '
                       f'the centre of friction, mean over the last {LAST_DISTANCE:g} m, '
                       'feedback'),
        'final_rho': Finding(float(np.nanmean(path['rho_rad'][last])), 'rad',
                             'mean pushing angle of feedback over the last '
                             f'{LAST_DISTANCE:g} m'),
        'rolled': Finding(CENTIMETRES * float(contact_on_face(path)[last].mean()), 'cm',
                          'contact to the left of the middle of its face, likewise'),
        'last': Finding(LAST_DISTANCE, 'm', 'that distance'),
        'delay': Finding(pushes[FEEDBACK].duration - pushes[OPEN_LOOP].duration, 's',
                         'duration with feedback above that in open loop')}
    for law in pushes:
        table = tables[law]
        findings[f'peak_{law}'] = Finding(float(np.nanmax(np.abs(table['rho_rad']))), 'rad',
                                          f'largest pushing angle either way, {LABELS[law]}')
        findings[f'variation_{law}'] = Finding(
            total_variation(table, values.start_time), 'rad',
            'total variation of the pushing angle from the disturbance on')
        findings[f'new_paths_{law}'] = Finding(float(table['new_paths'][-1]), '',
                                               'new paths drawn')
    return Outcome({**tables, 'friction': friction}, findings)


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
    figures = (
        ('coefficients over time', parameters, _compute_friction, draw_coefficients, (6.4, 4.2)),
        ('trajectory of the centre', parameters, _compute_paths,
         functools.partial(draw_centers, end_time), (7.0, 4.0)),
        ('object trajectory', (*parameters, SEEDS), _compute_ends, draw_objects, (6.8, 6.4)),
        ('input', parameters, _compute_input, functools.partial(draw_inputs, end_time),
         (7.4, 5.4)))
    return tuple(Study(f'4.{number}', f'A {kind} disturbance: {title}', fields,
                       functools.partial(compute, end_time), draw, *caption, size)
                 for number, ((title, fields, compute, draw, size), caption)
                 in enumerate(zip(figures, captions), first))


TEMPORARY = _studies(8, 'temporary', TEMPORARY_PARAMETERS, temporary_end, (
    Caption('From {start_time:.0f} s on, the support points on one side have {factor:.1f} times '
            'the friction for an interval, which moves the centre of friction by {shift:.1f} cm '
            'to the left; neither planner nor controller is informed.',
            'The centre of friction is the mean of the support points, weighted by their '
            'capacities: k times the friction at two of four moves it by (k - 1) / (k + 1) of the '
            'distance to their side.'),
    Caption('The plan executed in open loop ends {open_loop:.0f} cm from the goal in the world '
            'and {object_frame:.0f} cm in the frame of the object; with feedback the box is '
            'carried '
            'aside as well, by {deviation:.0f} cm, but returns and ends {feedback:.1f} cm from '
            'it (mpc: {mpc:.1f} cm).',
            'Friction is nominal again long before the goal, but in open loop the robot continues '
            'as planned and does not observe what has happened.'),
    Caption('In the world the box continues to rotate to the left after the disturbance, by '
            '{heading_open_loop:.1f} rad in the end; in its own frame it keeps the '
            '{heading_object_frame:.1f} rad it has by then. The median of {pushes:.0f} pushes '
            'with other sensor errors is {median_feedback:.1f} cm (95% interval '
            '{median_feedback_low:.1f} to {median_feedback_high:.1f}) with feedback, '
            '{median_mpc:.1f} cm with mpc, {median_mobile_center:.1f} cm where the filter expects '
            'the centre of friction to move.',
            'The centre of friction is {arm:.1f} m from the contact and the centre of the robot '
            'only {radius:.1f} m, so that in the world the box resembles a pencil pushed at its '
            'end: a rotation that has begun grows unless the robot reacts.'),
    Caption('Feedback swings to {peak_feedback:.1f} rad against the rotation, then to the other '
            'side, and is at {final_rho:.2f} rad at the goal. From the disturbance on its angle '
            'varies by {variation_feedback:.1f} rad in all with {new_paths_feedback:.0f} new '
            'paths, by {variation_one_path:.1f} rad where it may draw but one, and by '
            '{variation_mobile_center:.1f} rad, with {new_paths_mobile_center:.0f} new paths, '
            'where its filter expects the centre of friction to move.',
            'Each spike is a turn, as tight as a share of the friction cone allows: the first of '
            'a new path (triangles), drawn at most every 0.5 s, or the last before its final '
            'straight. A filter that lets the '
            'centre of friction move ten times as easily takes every swing for a shift of it, '
            'draws the next path for that, and so oscillates with the period of new paths, about '
            '0.6 s; the default filter does so far less.')))
SUSTAINED = _studies(12, 'sustained', SUSTAINED_PARAMETERS, sustained_end, (
    Caption('From {start_time:.0f} s on, the support points on one side have {factor:.1f} times '
            'the friction, which moves the centre of friction by {shift:.1f} cm to the left for '
            'the rest of the push.',
            'The planner still assumes a centre of friction in the middle, {arm:.1f} m ahead of '
            'the contact.'),
    Caption('The plan executed in open loop ends {open_loop:.0f} cm from the goal in the world '
            'and {object_frame:.0f} cm in the frame of the object, feedback {feedback:.1f} cm '
            '(mpc: '
            '{mpc:.1f} cm) after a deviation of {deviation:.0f} cm, and {mobile_center:.1f} cm '
            'where its filter expects the centre of friction to move.',
            'The default filter takes the centre of friction for almost constant, so that one '
            'that jumps is found only slowly, and this push has no second approach to the goal.'),
    Caption('In open loop the box rotates by {heading_open_loop:.1f} rad in the world, '
            '{heading_object_frame:.1f} rad in its own frame. The median of {pushes:.0f} pushes '
            'with other sensor errors is {median_feedback:.1f} cm (95% interval '
            '{median_feedback_low:.1f} to {median_feedback_high:.1f}) with feedback, '
            '{median_mpc:.1f} cm with mpc, and {median_mobile_center:.1f} cm '
            '({median_mobile_center_low:.1f} to {median_mobile_center_high:.1f}) where the filter '
            'expects the centre of friction to move.',
            'Pushed straight towards its centre of friction, a box need not rotate, whatever its '
            'orientation; how near it ends depends on how soon feedback knows where that is.'),
    Caption('Feedback ends at {final_rho:.2f} rad over the last {last:.1f} m, where the centre of '
            'friction is at {aim:.2f} rad, and has rolled its contact {rolled:.1f} cm to the '
            'left, towards the new centre of friction. From the disturbance on its angle varies '
            'by {variation_feedback:.1f} rad with {new_paths_feedback:.0f} new paths, by '
            '{variation_one_path:.1f} rad with one, and by {variation_mobile_center:.1f} rad with '
            '{new_paths_mobile_center:.0f} where the filter expects the centre of friction to '
            'move.',
            'For straight motion the force must pass through the centre of friction. A filter '
            'that lets it move finds it sooner, at the price of more spikes: each is a turn of a '
            'new path.')))
STUDIES = TEMPORARY + SUSTAINED
