"""The input of one plan played at other speeds: where the object ends."""

import math

import numpy as np
from push_model.analysis.time_integration import push_at_angles
from push_model.geometry import Pose
from push_planner.single_push.planner import plan_push
from push_study.chapter3.scene import draw_outlines, input_table, push_problem, SCENE, SEGMENTS
from push_study.framework import paper
from push_study.framework.scenes import box
from push_study.framework.study import Finding, Outcome, Parameter, Study

PATH = ('x_m', 'y_m', 'theta_rad')


def compute(values, batch):
    """
    Plan once, and play the pushing angles over the same ways at each speed.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    found = plan_push(push_problem(values, values.planned_speed, values.segments))
    inputs, problem = input_table(found), found.problem
    tables, ends, steepest = {'inputs': inputs}, [], 0.0
    for speed in [*values.speeds, values.slow_speed]:
        run = push_at_angles(problem.obj, problem.contact, inputs['rho_rad'],
                             inputs['end_m'] - inputs['begin_m'], speed)
        tables[f'path_{speed:g}'] = {'time_s': run.times, **dict(zip(PATH, run.states[:, :3].T))}
        ends.append(run.end)
        steepest = max(steepest, float(np.abs(run.forces[:, 1] / run.forces[:, 0]).max()))
    misses = [math.hypot(end.x - problem.goal.x, end.y - problem.goal.y) for end in ends]
    turns = [end.theta - problem.goal.theta for end in ends]
    tables['ends'] = {'speed_m_s': [*values.speeds, values.slow_speed], 'position_error_m': misses,
                      'heading_error_rad': turns}
    faster = sorted((speed ** 2 - values.planned_speed ** 2, miss)
                    for speed, miss in zip(values.speeds, misses) if speed > values.planned_speed)
    return Outcome(tables, {
        'least': Finding(min(misses[:-1]), 'm', 'least distance from the goal'),
        'next': Finding(faster[0][1] if faster else 0.0, 'm', 'distance from the goal at the next '
                        'speed above the planned one'),
        'fastest': Finding(misses[-2], 'm', 'the same at the last speed'),
        'slow': Finding(misses[-1], 'm', 'the same at the very low speed'),
        'turn_fastest': Finding(turns[-2], 'rad', 'turn from the goal at the last speed'),
        'friction': Finding(steepest, '', 'contact friction that the forces take between jumps'),
        'growth': Finding(_power(faster), '', 'power of what the squared speed has more than the '
                          'planned one with which the distance grows, at the next two speeds')})


def _power(points):
    if len(points) < 2:
        return math.nan
    (x_0, y_0), (x_1, y_1) = points[:2]
    return math.log(y_1 / y_0) / math.log(x_1 / x_0)


def draw(figure, outcome, values):
    """
    Draw the ways of the middle and where the box ends, and the distance over the speed.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    ways, misses = figure.subplots(2, 1, height_ratios=(2.0, 1.0))
    obj = box(values)
    draw_outlines(ways, obj, [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
    for number, speed in enumerate(values.speeds):
        table, look = outcome.tables[f'path_{speed:g}'], paper.series(number)
        ways.plot(table['x_m'], table['y_m'], label=f'{speed:g} m/s', zorder=3.0, **look)
        end = Pose(*(table[name][-1] for name in PATH))
        ways.fill(*zip(*map(end.transform, obj.outline)), facecolor='none', zorder=2.0,
                  edgecolor=look['color'], linestyle=look['linestyle'], linewidth=1.2)
    ways.set_aspect('equal')
    ways.set_xlabel('x [m]')
    ways.set_ylabel('y [m]')
    ways.legend(loc='upper left')
    table = outcome.tables['ends']
    rows = sorted(zip(table['speed_m_s'], table['position_error_m']))
    misses.plot(*zip(*rows), 'o-', color=paper.INK, clip_on=False, zorder=3.0)
    misses.set_xlim(left=0.0)
    misses.set_ylim(bottom=0.0)
    misses.set_xlabel('speed [m/s]')
    misses.set_ylabel('miss of the goal [m]')


STUDIES = (Study(
    '3.11', 'The same input at several speeds',
    (*SCENE, SEGMENTS, Parameter('speeds', 'm/s', 'speeds at which it is played',
                                 [0.1, 0.25, 0.5, 1.0]),
     Parameter('planned_speed', 'm/s', 'speed that the input was planned for'),
     Parameter('slow_speed', 'm/s', 'a very low speed, for comparison')),
    compute, draw,
    'Played at the speed that it was planned for, the input ends at the goal; at higher speeds '
    'the box turns less and misses it by {next:.2f} m to {fastest:.2f} m, at a very low one by '
    'only {slow:.3f} m.',
    'Inertia brakes the turn about in proportion to the square of the speed (the distance grows '
    'with its power {growth:.1f}), so that it fades towards low speeds and pushes become '
    'quasi-static.', (6.4, 5.6)),)
