"""Sketch C.1 of an object subject to an input velocity between two curved faces."""

import math

from matplotlib.figure import Figure
from studies.chapter2.sketches.wheel_analogy import instant, PARAMETERS
from studies.framework import plot_style, sketch
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, RunJobs, Study

# Chosen: direction of the drawn input velocity from the normal [rad], and its length [m].
INPUT_ANGLE = 0.55
INPUT_LENGTH = 0.12


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute points of the sketch and the rolling constants."""
    now = instant(values, values.initial_rotation)
    points = {'P': now.robot, 'C': now.contact, 'O': now.pose[:2], 'F': now.friction_center}
    total = now.robot_radius + now.object_radius
    return Outcome({'points': {
        'point': list(points), 'x_m': [point[0] for point in points.values()],
        'y_m': [point[1] for point in points.values()],
        'turns_of_normal_rad': [now.state.gamma - 0.5 * math.pi] * len(points),
        'rotation_rad': [values.initial_rotation] * len(points)}}, {
        'ratio': Finding(now.object_radius / total, '', 'lam, share of the rotation of the object '
                         'by which the normal turns'),
        'effective': Finding(now.object_radius * now.robot_radius / total, 'm',
                             'R_e, travel of the contact per radian')})


def draw(figure: Figure, _: Outcome, values: Values) -> None:
    """Draw both faces, their centres, and the input velocity at the contact."""
    axes, now = figure.subplots(), instant(values, values.initial_rotation)
    sketch.set_up(axes)
    gamma, contact, middle = now.state.gamma, now.contact, now.pose[:2]
    sketch.pushed_object(axes, now.obj, now.pose)
    sketch.robot(axes, now.robot, now.robot_radius, (gamma - 0.75, gamma + 0.75))
    sketch.line(axes, now.robot, contact)
    sketch.line(axes, contact, middle, color=plot_style.GREY, linewidth=0.8)
    sketch.arrow(axes, now.robot, now.from_normal(0.0, 0.55 * now.robot_radius), '$R_p$',
                 plot_style.GREY, at=0.6)
    sketch.label(axes, sketch.polar(gamma, 0.45 * now.object_radius, contact), '$R_s$',
                 math.degrees(gamma) - 90.0, gap=12.0, color=plot_style.GREY)
    sketch.arrow(axes, contact, now.from_normal(0.5 * math.pi, 0.15), '$t$')
    sketch.arrow(axes, middle, now.from_normal(0.0, 0.15), '$n$')
    sketch.arrow(axes, contact, now.from_normal(INPUT_ANGLE, INPUT_LENGTH), '$v_C$', sketch.PUSH)
    sketch.angle(axes, middle, 0.09, (2.6, 4.2), '$\\omega$')
    sketch.angle(axes, now.robot, 0.08, (0.2, 1.2), '$\\omega_p$', gap=11.0)
    sketch.point(axes, now.robot, '$P$', 180.0)
    sketch.point(axes, middle, '$O$', 20.0)
    sketch.point(axes, contact, '$C$', 265.0, 14.0, sketch.FORCE)
    sketch.point(axes, now.friction_center, '$F$', 20.0, 11.0, sketch.FLOOR)


STUDIES = (Study(
    'C.1', 'An object subject to an input velocity between two curved faces', PARAMETERS, compute,
    draw,
    'The robot with centre P imposes the velocity v_C on the object at C, the common point of '
    'faces with radii R_p and R_s.',
    "Both roll off equal arcs: the normal turns by {ratio:.2f} of the object's rotation, the "
    'contact travels {effective:.3f} m per radian.',
    (6.4, 5.4)),)
