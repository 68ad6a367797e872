"""The input of one plan executed at other speeds: where the object ends."""

import math
from typing import Sequence

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from push_planner.steered.planner import plan_push
from studies.analysis.time_integration import push_at_angles
from studies.chapter3.setup import (
    draw_outlines, input_table, POSE_COLUMNS, push_problem, SEGMENTS, set_plane, SETUP,
)
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan once, and execute the pushing angles over the same distances at each speed."""
    plan = plan_push(push_problem(values, values.planned_speed, values.segments))
    inputs, problem = input_table(plan), plan.problem
    tables: dict[str, Table] = {'inputs': inputs}
    speeds = [*values.speeds, values.slow_speed]
    ends: list[Pose] = []
    needed_friction = 0.0
    for speed in speeds:
        run = push_at_angles(problem.obj, problem.contact, inputs['rho_rad'],
                             inputs['end_m'] - inputs['begin_m'], speed)
        tables[f'path_{speed:g}'] = {'time_s': run.times,
                                     **dict(zip(POSE_COLUMNS, run.states[:, :3].T))}
        ends.append(run.end)
        needed_friction = max(needed_friction,
                              float(np.abs(run.forces[:, 1] / run.forces[:, 0]).max()))
    goal = problem.goal
    misses = [math.hypot(end.x - goal.x, end.y - goal.y) for end in ends]
    heading_errors = [end.theta - goal.theta for end in ends]
    tables['ends'] = {'speed_m_s': speeds, 'position_error_m': misses,
                      'heading_error_rad': heading_errors}
    # What the squared speed exceeds that of the plan by, and the miss.
    faster = sorted((speed ** 2 - values.planned_speed ** 2, miss)
                    for speed, miss in zip(values.speeds, misses) if speed > values.planned_speed)
    return Outcome(tables, {
        'planned': Finding(values.planned_speed, 'm/s', 'speed that the input was planned for'),
        'slowest': Finding(values.slow_speed, 'm/s', 'the very low speed'),
        'least': Finding(min(misses[:-1]), 'm', 'least distance from the goal'),
        'next': Finding(faster[0][1] if faster else 0.0, 'm', 'distance from the goal at the next '
                        'speed above the planned one'),
        'fastest': Finding(misses[-2], 'm', 'the same at the last speed'),
        'slow': Finding(misses[-1], 'm', 'the same at the very low speed'),
        'heading_fastest': Finding(heading_errors[-2], 'rad', 'heading error at the last speed'),
        'friction': Finding(needed_friction, '', 'contact friction that the forces need between '
                            'jumps'),
        'power': Finding(_power(faster), '', 'power of the increase of the squared speed with '
                         'which the distance grows, at the next two speeds'),
        'last_power': Finding(_power(faster[-2:]), '', 'the same, at the last two speeds')})


def _power(points: Sequence[tuple[float, float]]) -> float:
    """Find p of y = a x^p through the first two points; nan where there are not two."""
    if len(points) < 2:
        return math.nan
    (x_0, y_0), (x_1, y_1) = points[:2]
    return math.log(y_1 / y_0) / math.log(x_1 / x_0)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the paths of the middle and the final box, and the distance over the speed."""
    above, below = figure.subplots(2, 1, height_ratios=(2.0, 1.0))
    obj = box(values)
    draw_outlines(above, obj, [Pose(0.0, 0.0, 0.0), Pose(*values.goal)])
    for index, speed in enumerate(values.speeds):
        table, style = outcome.tables[f'path_{speed:g}'], plot_style.series(index)
        above.plot(table['x_m'], table['y_m'], label=f'{speed:g} m/s', zorder=3.0, **style)
        end = Pose(*(table[name][-1] for name in POSE_COLUMNS))
        above.fill(*zip(*map(end.transform, obj.outline)), facecolor='none', zorder=2.0,
                   edgecolor=style['color'], linestyle=style['linestyle'], linewidth=1.2)
    set_plane(above)
    above.legend(loc='upper left')
    table = outcome.tables['ends']
    rows = sorted(zip(table['speed_m_s'], table['position_error_m']))
    below.plot(*zip(*rows), 'o-', color=plot_style.INK, clip_on=False, zorder=3.0)
    below.set_xlim(left=0.0)
    below.set_ylim(bottom=0.0)
    below.set_xlabel('speed [m/s]')
    below.set_ylabel('distance from the goal [m]')


STUDIES = (Study(
    '3.12', 'The same input at several speeds',
    (*SETUP, SEGMENTS, Parameter('speeds', 'm/s', 'speeds at which it is executed',
                                 [0.1, 0.25, 0.5, 1.0]),
     Parameter('planned_speed', 'm/s', 'speed that the input was planned for'),
     Parameter('slow_speed', 'm/s', 'a very low speed, for comparison')),
    compute, draw,
    'The input is planned for {planned:g} m/s and meets the goal there. Faster pushes rotate the '
    'box less: they miss by {next:.2f} to {fastest:.2f} m. A slower one, at {slowest:g} m/s, '
    'misses by {slow:.3f} m.',
    'At first the miss grows with the power {power:.1f} of what the squared speed exceeds that of '
    'the plan by, at the end with {last_power:.1f}.',
    (6.4, 5.6)),)
