"""Round robots that do not turn: the contact rolls along the face while they push."""

import numpy as np
from push_planner.single_push.planner import plan_push
from push_planner.verification.verification import verify
from push_study.chapter3.scene import (
    draw_center, draw_inputs, draw_outlines, draw_push, input_table, path_table, poses_at,
    push_problem, SCENE, SEGMENTS, SPEED,
)
from push_study.framework import paper
from push_study.framework.scenes import box
from push_study.framework.sketch_body import disc
from push_study.framework.study import Finding, Outcome, Parameter, Study

OUTLINES, PUSH, MILLIMETRES = 7, 0.16, 1e3


def rolling_tables(values, radius):
    """
    Plan the push of a robot, and see how far its contact travels.

    :param values: ``Values`` with ``SCENE``, ``SPEED`` and ``SEGMENTS``.
    :param radius: of the robot [m].
    :return: (``Plan``, table of the path with the place of the contact on the face added, table
        of the inputs).
    """
    found = plan_push(push_problem(values, values.speed, values.segments, radius))
    path = path_table(found.trajectory)
    path['along_face_m'] = along_face(path)
    return found, path, input_table(found)


def along_face(path):
    """
    Tell where the contact is, to the left of the middle of the face [m].

    :param path: table of ``path_table``.
    :return: array.
    """
    x, y = path['contact_x_m'] - path['x_m'], path['contact_y_m'] - path['y_m']
    return np.cos(path['theta_rad']) * y - np.sin(path['theta_rad']) * x


def compute(values, batch):
    """
    Plan the push of one robot.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    found, path, inputs = rolling_tables(values, values.robot_radius)
    point = plan_push(push_problem(values, values.speed, values.segments))
    travel = path['along_face_m']
    return Outcome({'path': path, 'inputs': inputs}, {
        'duration': Finding(found.trajectory.duration, 's', 'time that the push takes'),
        'turn': Finding(float(path['theta_rad'][-1]), 'rad', 'turn of the box'),
        'travel': Finding(MILLIMETRES * float(travel[-1]), 'mm', 'way of the contact along the '
                          'face, to the left'),
        'usage': Finding(found.report['cone_usage'], '', 'greatest angle of the contact force, '
                         'as a share of what the plan may use'),
        'first': Finding(float(inputs['rho_rad'][0]), 'rad', 'first pushing angle'),
        'point': Finding(point.pushing_angles[0][0], 'rad', 'the same of a point robot'),
        'miss': Finding(verify(found).position_error, 'm', 'distance from the goal, integrated '
                        'anew')})


def draw(figure, outcome, values):
    """
    Draw the way of the box with the robot, and the input.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    above, below = figure.subplots(2, 1, height_ratios=(2.0, 1.0))
    path, inputs = outcome.tables['path'], outcome.tables['inputs']
    draw_outlines(above, box(values), poses_at(path, np.linspace(0.0, path['time_s'][-1],
                                                                 OUTLINES)))
    draw_center(above, path, label='middle of the box', **paper.series(0))
    above.plot(path['contact_x_m'], path['contact_y_m'], label='contact', **paper.series(1))
    above.legend(loc='upper left')
    for time, angle in zip(inputs['begin_s'], inputs['rho_rad']):
        row = [np.interp(time, path['time_s'], path[name])
               for name in ('contact_x_m', 'contact_y_m', 'normal_rad')]
        normal = np.array((np.cos(row[2]), np.sin(row[2])))
        disc(above, row[:2] - values.robot_radius * normal, values.robot_radius)
        draw_push(above, path, time, angle, PUSH)
    draw_inputs(below, inputs, 's', **paper.series(0))
    below.set_xlim(0.0, path['time_s'][-1])


STUDIES = (
    Study('3.8', 'Curved fence: a robot of 50 mm radius', (
        *SCENE, SPEED, SEGMENTS, Parameter('robot_radius', 'm', 'radius of the robot, R_p', 0.05)),
        compute, draw,
        'While the box turns by {turn:.2f} rad, the contact rolls {travel:.0f} mm to the left '
        'along the face; the input begins at {first:.2f} rad, that of a point robot at '
        '{point:.2f} rad.',
        'A robot that does not turn itself rolls its radius along the face for each radian; '
        'there, on the left, a push along the normal would turn the box back, so that it has to '
        'lean further to the right to turn it on.', (6.4, 5.6)),)
