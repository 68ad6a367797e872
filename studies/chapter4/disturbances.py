"""A temporary and a sustained disturbance of the friction: open loop against feedback."""

import functools
from typing import NamedTuple

import numpy as np
from push_scenario.evaluation.metrics import deviation
from push_sim_node.disturbance import FrictionChange
from studies.chapter3.setup import contact_on_face, GOAL, POSE_COLUMNS
from studies.chapter4.disturbances_figure import (
    draw_centers, draw_inputs, draw_objects, EndTime, REPEATED,
)
from studies.chapter4.drawn_intervals import DRAWN, DrawnIntervals
from studies.chapter4.repeated_push import COLUMNS, median_findings, repeat, RepeatedPush
from studies.chapter4.setup import (
    ExecutedPush, FEEDBACK, KEPT_PATH, LABELS, Law, MPC, NO_JUMP_TEST, OBJECT_FRAME, OPEN_LOOP,
    push, PushSetup, REPLANNED, SETUP, TIME_LIMIT, total_variation,
)
from studies.chapter4.support_friction import (
    angle_to_friction_center, draw_coefficients, friction_interval, friction_table,
)
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: means "at the goal" are taken over this last distance [m].
LAST_DISTANCE = 0.3
MILLIMETRES = 1000.0
CENTIMETRES = 100.0
LAWS: tuple[Law, ...] = (OPEN_LOOP, OBJECT_FRAME, REPLANNED, FEEDBACK, MPC, NO_JUMP_TEST)
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
    """Push under all laws, and on drawn disturbances under those of ``REPEATED``."""
    outcome = _compute_paths(end_time, values, run_jobs)
    drawn = DrawnIntervals.of(values, is_sustained=end_time is sustained_end)
    repeated = RepeatedPush(PushSetup.of(values), tuple(values.goal), drawn)
    ends = repeat(repeated, REPEATED, int(values.seeds), run_jobs)
    findings = {**outcome.findings, 'pushes': Finding(float(values.seeds), '',
                                                      'number of pushes under each law')}
    for law in REPEATED:
        errors = CENTIMETRES * ends[f'{law}_{COLUMNS[0]}']
        findings.update(median_findings(f'median_{law}', errors, 'cm', 'median distance from the '
                                        f'goal on drawn disturbances, {LABELS[law]}'))
        findings[f'worst_{law}'] = Finding(float(errors.max()), 'cm', 'largest')
    return Outcome({**outcome.tables, 'ends': ends}, findings, _ends_table(ends, findings))


def _ends_table(ends: Table, findings: dict[str, Finding]) -> Table:
    """Tabulate the ends of all pushes by law."""
    medians = [findings[f'median_{law}'].value for law in REPEATED]
    lows, highs, worst = ([findings[name.format(law)].value for law in REPEATED] for name in (
        'median_{}_low', 'median_{}_high', 'worst_{}'))
    headings = [float(np.median(np.abs(ends[f'{law}_{COLUMNS[1]}']))) for law in REPEATED]
    return {'law': [LABELS[law] for law in REPEATED],
            'distance from the goal: median [cm]': [f'{median:.1f}' for median in medians],
            '95 % interval': [f'{low:.1f} to {high:.1f}' for low, high in zip(lows, highs)],
            'largest': [f'{value:.1f}' for value in worst],
            'median heading error [rad]': [f'{value:.2f}' for value in headings]}


def _compute_input(end_time: EndTime, values: Values, _: RunJobs) -> Outcome:
    """Push under all laws, and find out what the pushing angle does."""
    pushes = _pushes(end_time, values, (*LAWS, KEPT_PATH))
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
        ('object trajectory', (*parameters, *DRAWN), _compute_ends, draw_objects, (6.8, 6.4)),
        ('input', parameters, _compute_input, functools.partial(draw_inputs, end_time),
         (7.4, 5.4)))
    return tuple(Study(f'4.{number}', f'A {kind} disturbance: {title}', fields,
                       functools.partial(compute, end_time), draw, *caption, size)
                 for number, ((title, fields, compute, draw, size), caption)
                 in enumerate(zip(figures, captions), first))


TEMPORARY = _studies(8, 'temporary', TEMPORARY_PARAMETERS, temporary_end, (
    Caption('From {start_time:.0f} s on, one side has {factor:.1f} times the friction for an '
            'interval. The centre of friction moves by {shift:.1f} cm to the left; nobody is '
            'informed.',
            'Two of four points with k times the friction move it by (k - 1) / (k + 1) of their '
            'distance.'),
    Caption('The open loop ends {open_loop:.0f} cm from the goal in the world, {object_frame:.0f} '
            'cm in the frame of the object. Planned every 0.5 s the push ends at {replanned:.1f} '
            'cm. With feedback the box deviates by {deviation:.0f} cm and ends at {feedback:.1f} '
            'cm (mpc: {mpc:.1f} cm).',
            'Friction is nominal again long before the goal.'),
    Caption('In open loop the box rotates by {heading_open_loop:.1f} rad. The centre of friction '
            'is {arm:.1f} m from the contact, the centre of the robot only {radius:.1f} m. '
            '{pushes:.0f} more disturbances have a drawn side, factor, start and interval. Their '
            'median push ends {median_feedback:.1f} cm from the goal under feedback, '
            '{median_replanned:.1f} cm if planned every 0.5 s, {median_open_loop:.0f} cm in open '
            'loop.',
            'Force angle and dipole, laws of other authors, know true force and true poses and '
            'steer the position alone.'),
    Caption('Feedback swings to {peak_feedback:.1f} rad and back, to {final_rho:.2f} rad at the '
            'goal. Its angle varies by {variation_feedback:.1f} rad with {new_paths_feedback:.0f} '
            'new paths (triangles). With the threefold threshold of 4.1 there are '
            '{new_paths_kept_path:.0f} and {variation_kept_path:.1f} rad, with no test for jumps '
            '{new_paths_no_jump_test:.0f} and {variation_no_jump_test:.1f} rad.',
            'Each spike is the turn of a new path, at most every 0.5 s.')))
SUSTAINED = _studies(12, 'sustained', SUSTAINED_PARAMETERS, sustained_end, (
    Caption('From {start_time:.0f} s on, one side has {factor:.1f} times the friction. The centre '
            'of friction moves by {shift:.1f} cm to the left.',
            'The planner assumes it in the middle, {arm:.1f} m ahead of the contact.'),
    Caption('The open loop ends {open_loop:.0f} cm from the goal in the world, {object_frame:.0f} '
            'cm in the frame of the object, planned every 0.5 s {replanned:.0f} cm. Feedback '
            'deviates by {deviation:.0f} cm and ends at {feedback:.1f} cm (mpc: {mpc:.1f} cm), '
            'without a test for jumps at {no_jump_test:.1f} cm.',
            'That test notices within half a second that the box rotates otherwise; the planner '
            'goes on with the nominal friction.'),
    Caption('In open loop the box rotates by {heading_open_loop:.1f} rad in the world, '
            '{heading_object_frame:.1f} rad in its own frame. The {pushes:.0f} disturbances are '
            'those of 4.10, without an end. Their median push ends {median_feedback:.1f} cm from '
            'the goal under feedback, {median_replanned:.1f} cm if planned every 0.5 s, '
            '{median_open_loop:.0f} cm in open loop.',
            'Feedback learns the centre of friction.'),
    Caption('Feedback ends at {final_rho:.2f} rad over the last {last:.1f} m, where the centre of '
            'friction is at {aim:.2f} rad; its contact has rolled {rolled:.1f} cm. Its angle '
            'varies by {variation_feedback:.1f} rad with {new_paths_feedback:.0f} new paths. With '
            'the threefold threshold of 4.1 there are {new_paths_kept_path:.0f} and '
            '{variation_kept_path:.1f} rad, with no test for jumps {new_paths_no_jump_test:.0f} '
            'and {variation_no_jump_test:.1f} rad.',
            'The contact rolls until it is behind the centre of friction.')))
STUDIES = TEMPORARY + SUSTAINED
