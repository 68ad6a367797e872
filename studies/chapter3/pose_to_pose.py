"""Sketch 3.1 of an object moved from pose to pose by three constant pushing angles."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import Pose
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
from studies.chapter3.setup import (
    contact_on_face, input_table, path_table, POSE_COLUMNS, push_problem, SETUP, SPEED,
)
from studies.framework import plot_style, sketch
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# As many as the captions name.
SEGMENTS = 3
# Chosen: lengths in the sketch [m].
NORMAL_LENGTH = 0.3
ARROW_LENGTH = 0.3
ARC_RADIUS = 0.22
PARAMETERS = (*SETUP, SPEED, Parameter('robot_radius', 'm', 'radius of the robot'))


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan the push, and find the poses at its switches."""
    plan = plan_push(push_problem(values, values.speed, SEGMENTS, radius=values.robot_radius))
    inputs, path = input_table(plan), path_table(plan.trajectory)
    times = np.append(inputs['begin_s'], inputs['end_s'][-1])
    switches = {name: np.interp(times, path['time_s'], column) for name, column in path.items()}
    travel = contact_on_face(path)
    angles = {f'angle_{number}': Finding(float(rho), 'rad', f'pushing angle {number}')
              for number, rho in enumerate(inputs['rho_rad'], 1)}
    return Outcome({'path': path, 'inputs': inputs, 'switches': switches}, {
        **angles,
        'distance': Finding(float(inputs['end_m'][-1]), 'm', 'distance travelled by the contact'),
        'rotation': Finding(float(path['theta_rad'][-1]), 'rad', 'rotation of the box'),
        'travel': Finding(1e3 * float(travel[-1] - travel[0]), 'mm', 'travel of the contact along '
                          'the face, to the left'),
        'miss': Finding(verify(plan).position_error, 'm', 'distance from the goal, integrated '
                        'independently')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the object at the switches, and the pushes that begin there."""
    axes, obj = figure.subplots(), box(values)
    path, inputs, switches = (outcome.tables[name] for name in ('path', 'inputs', 'switches'))
    sketch.set_up(axes)
    axes.plot(path['x_m'], path['y_m'], zorder=3.0, **plot_style.series(0))
    poses = [Pose(*row) for row in zip(*(switches[name] for name in POSE_COLUMNS))]
    last = len(poses) - 1
    for index, pose in enumerate(poses):
        sketch.pushed_object(axes, obj, pose, ghost=index == last)
        sketch.point(axes, pose[:2], color=sketch.FORCE)
        if index < last:
            _draw_push(axes, switches, index, inputs['rho_rad'][index], values.robot_radius)
    for pose, text in ((poses[0], 'start'), (poses[last], 'goal')):
        sketch.label(axes, pose.transform((0.0, 0.5 * values.box_width)), text,
                     math.degrees(pose.theta) + 90.0, gap=12.0)


def _draw_push(axes: Axes, switches: Table, index: int, rho: float, radius: float) -> None:
    contact = switches['contact_x_m'][index], switches['contact_y_m'][index]
    normal = switches['normal_rad'][index]
    sketch.line(axes, sketch.polar(normal, -NORMAL_LENGTH, contact), contact)
    if radius > 0.0:
        sketch.robot(axes, sketch.polar(normal, -radius, contact), radius)
    tail = sketch.polar(normal + rho, -ARROW_LENGTH, contact)
    sketch.arrow(axes, tail, np.subtract(contact, tail), color=sketch.PUSH)
    # Between the normal and the push, seen from the contact backwards.
    backwards = normal + math.pi
    sketch.angle(axes, contact, ARC_RADIUS, (backwards, backwards + rho), '', color=sketch.PUSH)
    # The label is behind the arrow, a little off the arc [rad].
    offset = math.copysign(0.7, rho)
    sketch.label(axes, tail, f'$\\rho_{index + 1}$',
                 math.degrees(normal + rho + math.pi + offset), gap=9.0, color=sketch.PUSH)
    sketch.point(axes, contact, color=plot_style.INK)


STUDIES = (
    Study('3.1', 'Movement and pushing input from an initial to a final object position',
          PARAMETERS, compute, draw,
          'Three pushes over equal distances, at {angle_1:.1f}, {angle_2:.1f} and {angle_3:.1f} '
          'rad to the normal, move the box to its goal, rotated by {rotation:.2f} rad.',
          'Angles and distance, {distance:.2f} m, are those of the fastest push.', (6.4, 3.8)),
    Study('rolling-plan', 'From pose to pose by a round robot that does not rotate', PARAMETERS,
          compute, draw,
          'The pushing angles are {angle_1:.1f}, {angle_2:.1f} and {angle_3:.1f} rad; the contact '
          'rolls {travel:.0f} mm to the left along the face.',
          'The box rotates by {rotation:.2f} rad.',
          (6.4, 3.8)))
