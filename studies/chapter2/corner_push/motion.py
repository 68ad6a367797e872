"""The motion of the box pushed at a corner: quasi-static, and with its inertia."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import PushedObject
from push_model.quasi_static import quasi_static_yaw_rate
from studies.analysis.steady_turn import rotated_about, rotation_center
from studies.chapter2.corner_push.setup import (
    integrated_push, push_direction, pushed_box, SHAPE, steady_yaw_rates,
)
from studies.framework import plot_style
from studies.framework.box import FRICTION, MASS
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: smooth paths, with a multiple of the intervals between drawn outlines.
SAMPLES = 161
OUTLINE_INTERVALS = 8
# Chosen: length of the arrow that shows the push [m].
ARROW = 0.3
TITLES = {'quasi_static': 'quasi-static', 'dynamic': 'dynamic'}


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the poses of the box over time, without and with inertia."""
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    direction = push_direction(values)
    corner, times = obj.outline[0], np.linspace(0.0, values.duration, SAMPLES)
    quasi_static_rate = quasi_static_yaw_rate(obj, corner, values.speed * math.cos(direction),
                                              values.speed * math.sin(direction))
    center = rotation_center(corner, direction, values.speed, quasi_static_rate)
    quasi_static = np.array([rotated_about(center, quasi_static_rate * time) for time in times])
    # Columns x, y, theta, omega.
    dynamic = integrated_push(obj, direction, values.speed, times)[:, :4]
    steady_rate = steady_yaw_rates(obj, direction, [values.speed])[0]
    steady_center = rotation_center(corner, direction, values.speed, steady_rate)
    findings = {
        'rotation_quasi_static': Finding(float(quasi_static[-1, 2]), 'rad',
                                         'rotation without inertia'),
        'rotation_dynamic': Finding(float(dynamic[-1, 2]), 'rad', 'rotation with inertia'),
        'radius_quasi_static': Finding(math.hypot(*center), 'm', 'radius of the circle of the '
                                       'middle of the box, without inertia'),
        'radius_dynamic': Finding(math.hypot(*steady_center), 'm', 'the same in the steady turn '
                                  'with inertia'),
        'radius_integrated': Finding(_fitted_radius(dynamic[-SAMPLES // 3:, :2]), 'm', 'radius of '
                                     'the circle through the last third of the integrated path')}
    rates = np.full_like(times, quasi_static_rate)
    return Outcome({'quasi_static': _table(times, quasi_static, rates),
                    'dynamic': _table(times, dynamic, dynamic[:, 3])}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw outlines of the box and the paths of its middle and of the pushed corner."""
    obj = pushed_box(values, values.mass, values.friction_coefficient)
    direction = push_direction(values)
    points = (((0.0, 0.0), 'middle of the box'), (obj.outline[0], 'pushed corner'))
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (name, table) in zip(panels, outcome.tables.items()):
        poses = [Pose(*row) for row in zip(table['x_m'], table['y_m'], table['theta_rad'])]
        for pose in poses[::(SAMPLES - 1) // OUTLINE_INTERVALS]:
            _draw_box(axes, obj, pose, direction)
        for index, (point, label) in enumerate(points):
            axes.plot(*zip(*(pose.transform(point) for pose in poses)), label=label,
                      **plot_style.series(index))
        axes.set_title(TITLES[name], loc='left')
        axes.set_aspect('equal')
        axes.set_xlabel('x [m]')
    panels[0].set_ylabel('y [m]')
    panels[0].legend(loc='upper left')


def _draw_box(axes: Axes, obj: PushedObject, pose: Pose, direction: float) -> None:
    axes.fill(*zip(*map(pose.transform, obj.outline)), facecolor=plot_style.LIGHT, alpha=0.5,
              edgecolor=plot_style.GREY, linewidth=0.8)
    tip = pose.transform(obj.outline[0])
    push = pose.rotate((ARROW * math.cos(direction), ARROW * math.sin(direction)))
    axes.annotate('', tip, (tip[0] - push[0], tip[1] - push[1]),
                  arrowprops={'arrowstyle': '-|>', 'color': plot_style.INK, 'linewidth': 1.0,
                              'shrinkA': 0.0, 'shrinkB': 0.0, 'mutation_scale': 8.0})


def _fitted_radius(points: FloatArray) -> float:
    """Fit a circle with centre m and radius R: |p|^2 = 2 p . m + (R^2 - |m|^2); return R."""
    rows = np.column_stack([2.0 * points, np.ones(len(points))])
    x, y, constant = np.linalg.lstsq(rows, (points ** 2).sum(axis=1), rcond=None)[0]
    return math.sqrt(constant + x * x + y * y)


def _table(times: FloatArray, poses: FloatArray, rates: FloatArray) -> Table:
    return {'time_s': times, 'x_m': poses[:, 0], 'y_m': poses[:, 1], 'theta_rad': poses[:, 2],
            'omega_rad_s': rates}


STUDIES = (Study(
    '2.20', 'Box pushed at a corner: the motion',
    (*SHAPE, MASS, FRICTION, Parameter('speed', 'm/s', 'speed of the contact'),
     Parameter('duration', 's', 'time that is drawn')), compute, draw,
    'The box moves already and does not rotate at first. In the same time it rotates by '
    '{rotation_quasi_static:.2f} rad without inertia (left), by {rotation_dynamic:.2f} rad with '
    'it (right).',
    'The circles have radii of {radius_quasi_static:.2f} m and {radius_dynamic:.2f} m.'),)
