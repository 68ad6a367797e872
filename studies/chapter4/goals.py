"""Open loop and feedback where friction is nominal."""

import numpy as np
from push_control.settings import ControlSettings
from push_model.geometry import FloatArray
from studies.chapter3.setup import GOAL
from studies.chapter4.goals_figure import draw_goals, draw_input, draw_path, GOAL_LAWS
from studies.chapter4.setup import (
    CONTROL, ExecutedPush, FEEDBACK, KEPT_PATH, LABELS, Law, MPC, OBJECT_FRAME, OPEN_LOOP,
    OWN_PATH, planned_input, push, REPLANNED, SETUP,
)
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: inputs are compared from this distance on, after the soft start [m], and at so many
# points.
SKIPPED_DISTANCE = 0.1
COMPARED_POINTS = 400
MILLIMETRES = 1000.0
PERCENT = 100.0
LAWS: tuple[Law, ...] = (
    OPEN_LOOP, OBJECT_FRAME, REPLANNED, FEEDBACK, OWN_PATH, KEPT_PATH, MPC)


def compute_goals(values: Values, _: RunJobs) -> Outcome:
    """Push to each goal under all laws."""
    tables: dict[str, Table] = {}
    rows: list[list[float]] = []
    new_paths = 0
    for number, goal in enumerate(values.goals, 1):
        pushes = [push(values, goal, law) for law in GOAL_LAWS]
        tables.update({f'{law}_{number}': executed.path
                       for law, executed in zip(GOAL_LAWS, pushes)})
        new_paths += pushes[GOAL_LAWS.index(FEEDBACK)].path['new_paths'][-1]
        rows.append([number, pushes[0].planned.duration])
        for executed in pushes:
            rows[-1] += [executed.position_error, executed.heading_error, executed.duration]
    names = [f'{law}_{column}' for law in GOAL_LAWS
             for column in ('position_error_m', 'heading_error_rad', 'duration_s')]
    tables['ends'] = table = dict(zip(['goal', 'planned_s', *names], np.array(rows).T))
    times = {law: table[f'{law}_duration_s'] / table['planned_s'] for law in GOAL_LAWS}
    return Outcome(tables, {
        'goals': Finding(len(values.goals), '', 'number of goals'),
        **{law: _largest_error(table, law) for law in GOAL_LAWS},
        'new_paths': Finding(float(new_paths), '', 'new paths that feedback has drawn in all'),
        'kept': Finding(PERCENT * float((times[FEEDBACK] / times[KEPT_PATH]).max() - 1.0), '%',
                        'largest duration with feedback above that with the threefold threshold'),
        'delay': Finding(PERCENT * float(np.max(list(times.values())) - 1.0), '%',
                         'largest duration above that of the plan'),
        'loss': Finding(PERCENT * float((times[OWN_PATH] / times[OPEN_LOOP]).max() - 1.0), '%',
                        'largest duration on a path of its own above that of the executed plan')})


def _largest_error(table: Table, law: Law) -> Finding:
    return Finding(MILLIMETRES * float(table[f'{law}_position_error_m'].max()), 'mm',
                   f'largest distance from the goal, {LABELS[law]}')


def compute(values: Values, _: RunJobs) -> Outcome:
    """Push to one goal under all laws."""
    pushes: dict[Law, ExecutedPush] = {law: push(values, values.goal, law) for law in LAWS}
    planned = planned_input(pushes[FEEDBACK].planned)
    span = float(np.ptp(planned['rho_rad']))
    tables: dict[str, Table] = {law: executed.path for law, executed in pushes.items()}
    loss = pushes[OWN_PATH].duration - pushes[OPEN_LOOP].duration
    findings = {
        'span': Finding(span, 'rad', 'range of the planned pushing angle'),
        'distance': Finding(float(tables[OWN_PATH]['distance_m'][-1]), 'm',
                            'distance travelled by the contact, feedback on a path of its own'),
        'planned_distance': Finding(float(planned['distance_m'][-1]), 'm', 'the same, planned'),
        'loss': Finding(loss, 's', 'time that feedback loses on a path of its own, over the '
                        'optimal plan as executed'),
        'relative_loss': Finding(PERCENT * loss / pushes[OPEN_LOOP].duration, '%', 'the same'),
        'delay': Finding(PERCENT * float(pushes[OPEN_LOOP].duration / planned['time_s'][-1] - 1.0),
                         '%', 'duration of the executed plan above that of the plan')}
    for law, executed in pushes.items():
        findings[law] = Finding(MILLIMETRES * executed.position_error, 'mm',
                                f'distance from the goal, {LABELS[law]}')
        findings[f'difference_{law}'] = Finding(
            input_difference(executed.path, planned), 'rad', 'root mean square difference of its '
            f'pushing angle from the planned one over the distance, from {SKIPPED_DISTANCE:g} m '
            'on')
        findings[f'new_paths_{law}'] = Finding(float(executed.path['new_paths'][-1]), '',
                                               'new paths drawn')
    findings['left'] = Finding(_plan_distance(tables[FEEDBACK]), 'm',
                               'distance up to the first new path of feedback')
    gain = pushes[FEEDBACK].duration - pushes[KEPT_PATH].duration
    findings['gain'] = Finding(gain, 's', 'time that feedback gains with the threefold threshold')
    return Outcome({**tables, 'planned': planned}, findings)


def _plan_distance(path: Table) -> float:
    """Compute how far the contact has travelled when feedback leaves its path; else to the end."""
    rows = np.flatnonzero(path['new_paths'])
    return float(path['distance_m'][rows[0] if len(rows) else -1])


def input_difference(path: Table, planned: Table) -> float:
    """
    Compute the root mean square difference of a pushing angle from the planned one.

    :param path: table of an ``ExecutedPush``.
    :param planned: table of ``planned_input``.
    :return: difference over the distance travelled by the contact [rad].
    """
    return float(np.sqrt(np.mean(_differences(path, planned) ** 2)))


def _differences(path: Table, planned: Table) -> FloatArray:
    """Subtract the planned from the executed pushing angle, at even distances [rad]."""
    touching = np.isfinite(path['rho_rad'])
    end = min(path['distance_m'][-1], planned['distance_m'][-1])
    distances = np.linspace(min(SKIPPED_DISTANCE, 0.5 * end), end, COMPARED_POINTS)
    return (np.interp(distances, path['distance_m'][touching], path['rho_rad'][touching])
            - np.interp(distances, planned['distance_m'], planned['rho_rad']))


def _threshold(settings: ControlSettings) -> str:
    return (f'{MILLIMETRES * settings.replan_lateral_error:.0f} mm or '
            f'{settings.replan_heading_error:g} rad')


PARAMETERS = (*SETUP, GOAL)
THREEFOLD = ('A threefold threshold draws new paths from '
             f'{_threshold(ControlSettings(**CONTROL[KEPT_PATH]))} on, in place of '
             f'{_threshold(ControlSettings())}. ')
STUDIES = (
    Study('4.1', 'Control action by optimiser and by feedback law: a box that rotates', PARAMETERS,
          compute, draw_input,
          'Feedback leaves the optimal plan after {left:.2f} m, for errors of the sensors alone. '
          f'{THREEFOLD}It draws {{new_paths_kept_path:.0f}} of them, and the push ends '
          '{gain:.1f} s earlier. Angles differ from the planned one by {difference_feedback:.2f} '
          'rad (root mean square; range {span:.1f} rad). With mpc it is {difference_mpc:.2f} rad, '
          'planned every 0.5 s {difference_replanned:.2f} rad.',
          'A path of its own from the start, of arcs and lines, costs {loss:.1f} s '
          '({relative_loss:.1f}%).',
          (7.0, 5.2)),
    Study('4.2', 'Control action by optimiser and by feedback law: a box that is moved aside',
          PARAMETERS, compute, draw_input,
          'Feedback leaves the plan after {left:.2f} m and draws {new_paths_feedback:.0f} new '
          'paths. With the threefold threshold of 4.1 it arrives {gain:.1f} s earlier. Angles '
          'differ from the planned one by {difference_feedback:.2f} rad (range {span:.1f} rad), '
          'with mpc by {difference_mpc:.2f} rad, planned every 0.5 s by '
          '{difference_replanned:.2f} rad.',
          'A path of its own costs {loss:.1f} s ({relative_loss:.1f}%): the optimal path has its '
          'tightest turn only for a moment.', (7.0, 5.2)),
    Study('4.3', 'Object trajectory by (a) optimiser and (b) feedback law: a box that rotates',
          PARAMETERS, compute, draw_path,
          'Arrows are pushes. Feedback on its own path ends {own_path:.0f} mm from the goal, the '
          'optimiser {replanned:.0f} mm where it plans every 0.5 s. Its first plan alone ends '
          "{open_loop:.0f} mm off in the world and {object_frame:.0f} mm in the object's frame.",
          'The open loop keeps the error of the first pose. The contact of feedback travels '
          '{distance:.2f} m in place of {planned_distance:.2f} m.', (7.0, 3.4)),
    Study('4.4', 'Object trajectory by (a) optimiser and (b) feedback law: a box that is moved '
          'aside', PARAMETERS, compute, draw_path,
          'The box takes two opposite bends, like a car. Feedback on its own path ends '
          '{own_path:.0f} mm from the goal, the optimiser {replanned:.0f} mm where it plans every '
          '0.5 s. Its first plan alone ends {open_loop:.0f} mm off in the world and '
          "{object_frame:.0f} mm in the object's frame.",
          'The contact of feedback travels {distance:.2f} m (planned: {planned_distance:.2f} m).',
          (6.4, 4.6)),
    Study('four-goals', 'Open loop and feedback: four goals',
          (*SETUP, Parameter('goals', 'm, m, rad', 'goal poses (x, y, theta)')),
          compute_goals, draw_goals,
          'With nominal friction feedback misses the {goals:.0f} goals by up to {feedback:.0f} '
          'mm, on its own paths by {own_path:.0f} mm, mpc by {mpc:.0f} mm. The optimiser misses '
          'them by {replanned:.0f} mm where it plans every 0.5 s, its first plan alone by '
          '{open_loop:.0f} mm.',
          'Own paths of feedback cost up to {loss:.0f}% of the time. It draws {new_paths:.0f} new '
          'paths; with the threefold threshold of 4.1 it is up to {kept:.0f}% faster.',
          (8.4, 4.8)))
