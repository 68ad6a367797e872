"""The motion of the box pushed at a corner: as friction alone has it, and with its inertia."""

import math

import numpy as np
from push_model.analysis.steady_turn import rotated_about, rotation_center
from push_model.geometry import Pose
from push_model.quasi_static import quasi_static_yaw_rate
from push_study.chapter2.corner_push.scene import (
    FRICTION, MASS, motion, push_direction, pushed_box, SHAPE, steady_rates,
)
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study

SAMPLES, OUTLINES = 161, 8
TITLES = {'quasi_static': 'quasi-static', 'dynamic': 'dynamic'}


def compute(values, batch):
    """
    Poses of the box over time, without and with inertia.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    obj, direction = (pushed_box(values, values.mass, values.friction_coefficient),
                      push_direction(values))
    corner, times = obj.outline[0], np.linspace(0.0, values.duration, SAMPLES)
    slow = quasi_static_yaw_rate(obj, corner, values.speed * math.cos(direction),
                                 values.speed * math.sin(direction))
    center = rotation_center(corner, direction, values.speed, slow)
    without = np.array([rotated_about(center, slow * time) for time in times])
    run = motion(obj, direction, values.speed, times)[:, :4]
    steady = steady_rates(obj, direction, [values.speed])[0]
    own = rotation_center(corner, direction, values.speed, steady)
    findings = {
        'turn_quasi_static': Finding(float(without[-1, 2]), 'rad', 'turn without inertia'),
        'turn_dynamic': Finding(float(run[-1, 2]), 'rad', 'turn with inertia'),
        'radius_quasi_static': Finding(math.hypot(*center), 'm', 'circle of the middle of the '
                                       'box, without inertia'),
        'radius_dynamic': Finding(math.hypot(*own), 'm', 'the same of the steady turn with '
                                  'inertia'),
        'radius_travelled': Finding(_radius(run[-SAMPLES // 3:, :2]), 'm', 'circle through the '
                                    'last third of the integrated path')}
    return Outcome({'quasi_static': _table(times, without, np.full_like(times, slow)),
                    'dynamic': _table(times, run, run[:, 3])}, findings)


def draw(figure, outcome, values):
    """
    Draw outlines of the box and the paths of its middle and of the pushed corner.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    direction = push_direction(values)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (name, table) in zip(panels, outcome.tables.items()):
        poses = [Pose(*row) for row in zip(table['x_m'], table['y_m'], table['theta_rad'])]
        for pose in poses[::(SAMPLES - 1) // OUTLINES]:
            _draw_box(axes, obj, pose, direction)
        for number, (point, label) in enumerate((((0.0, 0.0), 'middle of the box'),
                                                 (obj.outline[0], 'pushed corner'))):
            axes.plot(*zip(*(pose.transform(point) for pose in poses)), label=label,
                      **paper.series(number))
        axes.set_title(TITLES[name], loc='left')
        axes.set_aspect('equal')
        axes.set_xlabel('x [m]')
    panels[0].set_ylabel('y [m]')
    panels[0].legend(loc='upper left')


def _draw_box(axes, obj, pose, direction):
    axes.fill(*zip(*map(pose.transform, obj.outline)), facecolor=paper.LIGHT, alpha=0.5,
              edgecolor=paper.GREY, linewidth=0.8)
    tip = pose.transform(obj.outline[0])
    back = pose.rotate((0.3 * math.cos(direction), 0.3 * math.sin(direction)))
    axes.annotate('', tip, (tip[0] - back[0], tip[1] - back[1]),
                  arrowprops={'arrowstyle': '-|>', 'color': paper.INK, 'linewidth': 1.0,
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 8.0})


def _radius(points):
    """Radius of the circle that fits points best: |p|^2 = 2 p . m + (R^2 - |m|^2)."""
    rows = np.column_stack([2.0 * points, np.ones(len(points))])
    x, y, rest = np.linalg.lstsq(rows, (points ** 2).sum(axis=1), rcond=None)[0]
    return math.sqrt(rest + x * x + y * y)


def _table(times, poses, rates):
    return {'time_s': times, 'x_m': poses[:, 0], 'y_m': poses[:, 1], 'theta_rad': poses[:, 2],
            'omega_rad_s': rates}


STUDIES = (Study(
    '2.20', 'Box pushed at a corner: the motion',
    (*SHAPE, MASS, FRICTION, Parameter('speed', 'm/s', 'speed of the contact'),
     Parameter('duration', 's', 'time that is drawn')), compute, draw,
    'In the same time the box turns by {turn_quasi_static:.2f} rad as quasi-static pushing has it '
    '(left) and by {turn_dynamic:.2f} rad with its inertia (right); its middle goes round circles '
    'of {radius_quasi_static:.2f} m and {radius_dynamic:.2f} m.',
    'Direction and speed of the push stay the same on the box, so that it settles at a constant '
    'turning rate, which is a circle; the inertia of its going round makes that rate smaller.'),)
