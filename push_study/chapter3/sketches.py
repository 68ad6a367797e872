"""Sketches: an object moved from pose to pose by a few constant pushing angles."""

import math

import numpy as np
from push_model.geometry import Pose
from push_planner.single_push.planner import plan_push
from push_planner.verification.verification import verify
from push_study.chapter3.rolling import along_face
from push_study.chapter3.scene import input_table, path_table, push_problem, SCENE, SPEED
from push_study.framework import paper
from push_study.framework.scenes import box
from push_study.framework.sketch import angle, arrow, label, line, PUSH, sheet
from push_study.framework.sketch_body import disc, point, solid
from push_study.framework.study import Finding, Outcome, Parameter, Study

SEGMENTS, NORMAL, ARROW, ARC = 3, 0.3, 0.3, 0.22


def compute(values, batch):
    """
    Plan the push, and take the poses at its switches.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    found = plan_push(push_problem(values, values.speed, SEGMENTS, values.robot_radius))
    inputs, path = input_table(found), path_table(found.trajectory)
    times = np.append(inputs['begin_s'], inputs['end_s'][-1])
    ends = {name: np.interp(times, path['time_s'], column) for name, column in path.items()}
    travel = along_face(path)
    return Outcome({'path': path, 'inputs': inputs, 'ends': ends}, {
        **{f'angle_{number}': Finding(float(rho), 'rad', f'pushing angle {number}')
           for number, rho in enumerate(inputs['rho_rad'], 1)},
        'way': Finding(float(inputs['end_m'][-1]), 'm', 'way of the contact'),
        'turn': Finding(float(path['theta_rad'][-1]), 'rad', 'turn of the box'),
        'travel': Finding(1e3 * float(travel[-1] - travel[0]), 'mm', 'way of the contact along '
                          'the face, to the left'),
        'miss': Finding(verify(found).position_error, 'm', 'distance from the goal, integrated '
                        'anew')})


def draw(figure, outcome, values):
    """
    Draw the object at the switches, and the pushes that begin there.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes, obj = figure.subplots(), box(values)
    path, inputs, ends = outcome.tables.values()
    sheet(axes)
    axes.plot(path['x_m'], path['y_m'], zorder=3.0, **paper.series(0))
    last = len(ends['x_m']) - 1
    for number, (x, y, theta) in enumerate(zip(ends['x_m'], ends['y_m'], ends['theta_rad'])):
        solid(axes, obj, Pose(x, y, theta), number == last)
        point(axes, (x, y), color='#0B2A6B')
        if number < last:
            _push(axes, ends, number, inputs['rho_rad'][number], values.robot_radius)
    for number, text in ((0, 'start'), (last, 'goal')):
        pose = Pose(*(ends[name][number] for name in ('x_m', 'y_m', 'theta_rad')))
        label(axes, pose.transform((0.0, 0.5 * values.box_width)), text,
              math.degrees(pose.theta) + 90.0, 12.0)


def _push(axes, ends, number, rho, radius):
    place = ends['contact_x_m'][number], ends['contact_y_m'][number]
    normal = ends['normal_rad'][number]
    tail = _from(place, normal, -NORMAL)
    line(axes, tail, place)
    if radius > 0.0:
        disc(axes, _from(place, normal, -radius), radius)
    arrow(axes, _from(place, normal + rho, -ARROW), np.subtract(place, _from(
        place, normal + rho, -ARROW)), color=PUSH)
    # Between the normal and the push, seen from the contact backwards.
    angle(axes, place, ARC, normal + math.pi, normal + math.pi + rho,
          '', PUSH)
    aside = math.copysign(0.7, rho)
    label(axes, _from(place, normal + rho, -ARROW), f'$\\rho_{number + 1}$',
          math.degrees(normal + rho + math.pi + aside), 9.0, PUSH)
    point(axes, place, color=paper.INK)


def _from(place, direction, length):
    return place[0] + length * math.cos(direction), place[1] + length * math.sin(direction)


PARAMETERS = (*SCENE, SPEED, Parameter('robot_radius', 'm', 'radius of the robot'))
STUDIES = (
    Study('3.1', 'A box moved from pose to pose by three constant pushing angles', PARAMETERS,
          compute, draw,
          'Three pushes over equal ways, at {angle_1:.1f}, {angle_2:.1f} and {angle_3:.1f} rad to '
          'the normal of the face, take the box to its goal, turned by {turn:.2f} rad.',
          'A push to the right of the friction centre turns the box to the left; the angles and '
          'the length of the way, {way:.2f} m, are chosen so that it arrives with place and turn '
          'right, as soon as possible.', (6.4, 3.8)),
    Study('3.2', 'The same by a round robot that does not turn', PARAMETERS, compute, draw,
          'The pushes are at {angle_1:.1f}, {angle_2:.1f} and {angle_3:.1f} rad now, and on the '
          'way the contact rolls {travel:.0f} mm to the left along the face.',
          'While the box turns by {turn:.2f} rad, the face rolls on the robot by its radius for '
          'each radian, and the plan reckons with where the contact gets to.', (6.4, 3.8)))
