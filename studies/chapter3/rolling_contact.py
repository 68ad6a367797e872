"""Round robots that do not rotate: the contact rolls along the face while they push."""

import functools
from typing import NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
from studies.chapter3.setup import (
    contact_at, contact_on_face, draw_center, draw_inputs, draw_outlines, draw_push, input_table,
    path_table, poses_at, push_problem, SEGMENTS, SETUP, SPEED,
)
from studies.framework import plot_style, sketch
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: poses at which the box is drawn.
OUTLINES = 7
MILLIMETRES = 1e3


# Figures of one set of robots share their plans. Chosen: more than the robots of a study.
_plan = functools.lru_cache(maxsize=32)(plan_push)


class RollingPush(NamedTuple):
    """
    A planned push of a robot that does not rotate.

    :param plan: the plan.
    :param path: of ``path_table``, with the column along_face_m of the contact added.
    :param inputs: of ``input_table``.
    """

    plan: Plan
    path: Table
    inputs: Table


def plan_rolling(values: Values, radius: float) -> RollingPush:
    """
    Plan the push of a robot.

    :param values: with the parameters ``SETUP``, ``SPEED`` and ``SEGMENTS``.
    :param radius: of the robot [m].
    :return: plan and tables.
    """
    plan = _plan(push_problem(values, values.speed, values.segments, radius=radius))
    path = path_table(plan.trajectory)
    path['along_face_m'] = contact_on_face(path)
    return RollingPush(plan, path, input_table(plan))


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan the push of one robot, and that of a point for comparison."""
    plan, path, inputs = plan_rolling(values, values.robot_radius)
    point = plan_push(push_problem(values, values.speed, values.segments))
    return Outcome({'path': path, 'inputs': inputs}, {
        'duration': Finding(plan.trajectory.duration, 's', 'duration of the push'),
        'rotation': Finding(float(path['theta_rad'][-1]), 'rad', 'rotation of the box'),
        'travel': Finding(MILLIMETRES * float(path['along_face_m'][-1]), 'mm', 'travel of the '
                          'contact along the face, to the left'),
        'usage': Finding(plan.report['cone_usage'], '', 'greatest angle of the contact force, '
                         'as a fraction of what the plan may use'),
        'first': Finding(float(inputs['rho_rad'][0]), 'rad', 'first pushing angle'),
        'first_of_point': Finding(point.pushing_angles[0][0], 'rad', 'the same of a point robot'),
        'miss': Finding(verify(plan).position_error, 'm', 'distance from the goal, integrated '
                        'independently')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the path of the box with the robot, and the input."""
    above, below = figure.subplots(2, 1, height_ratios=(2.0, 1.0))
    path, inputs = outcome.tables['path'], outcome.tables['inputs']
    duration = path['time_s'][-1]
    draw_outlines(above, box(values), poses_at(path, np.linspace(0.0, duration, OUTLINES)))
    draw_center(above, path, label='middle of the box', **plot_style.series(0))
    above.plot(path['contact_x_m'], path['contact_y_m'], label='contact', **plot_style.series(1))
    above.legend(loc='upper left')
    for time, angle in zip(inputs['begin_s'], inputs['rho_rad']):
        x, y, normal = contact_at(path, time)
        sketch.robot(above, sketch.polar(normal, -values.robot_radius, (x, y)),
                     values.robot_radius)
        draw_push(above, path, time, angle)
    draw_inputs(below, inputs, 's', **plot_style.series(0))
    below.set_xlim(0.0, duration)
    above.set_title('(a) trajectory of the object', loc='left')
    below.set_title('(b) input', loc='left')


STUDIES = (
    Study('3.9', 'Curved pusher: a robot of {robot_radius:g} m radius', (
        *SETUP, SPEED, SEGMENTS, Parameter('robot_radius', 'm', 'radius of the robot, R_p', 0.05)),
        compute, draw,
        'While the box rotates by {rotation:.2f} rad, the contact rolls {travel:.0f} mm to the '
        'left. The input starts at {first:.2f} rad, that of a point robot at {first_of_point:.2f} '
        'rad.',
        'A contact on the left needs a push further to the right.', (6.4, 5.6)),)
