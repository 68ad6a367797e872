"""Round robots of several radii that do not rotate, and push to the same goal."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.friction import friction_center
from studies.chapter3.rolling_contact import MILLIMETRES, plan_rolling
from studies.chapter3.setup import (
    contact_at, draw_center, draw_inputs, draw_outlines, poses_at, SEGMENTS, SETUP, SPEED,
)
from studies.framework import plot_style, sketch
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

PERCENT = 100.0
# Chosen: poses at which the box is drawn.
OUTLINES = 4
COLUMNS = ('radius_m', 'duration_s', 'most_left_rad', 'most_right_rad', 'travel_m', 'first_rad')


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan the push of every robot."""
    tables: dict[str, Table] = {}
    rows: list[tuple[float, ...]] = []
    for radius, name in zip(values.radii, _names(values)):
        plan, path, inputs = plan_rolling(values, radius)
        tables[f'path_{name}'], tables[f'inputs_{name}'] = path, inputs
        rotations = path['theta_rad']
        rows.append((radius, plan.trajectory.duration, float(rotations.max()),
                     float(rotations.min()), float(np.abs(path['along_face_m']).max()),
                     float(inputs['rho_rad'][0])))
    table = tables['robots'] = dict(zip(COLUMNS, map(np.array, zip(*rows))))
    rotations = np.maximum(table['most_left_rad'], -table['most_right_rad'])
    # Rolling: the contact travels by R_p per radian.
    deviation = np.abs(table['travel_m'] / rotations / table['radius_m'] - 1.0).max()
    arm = friction_center(box(values))[0] + 0.5 * values.box_length
    worst = int(np.argmax(table['duration_s']))
    slower = float(table['duration_s'][worst] / table['duration_s'].min() - 1.0)
    return Outcome(tables, {
        'rolling': Finding(float(deviation), '',
                           'greatest deviation of travel over rotation from the radius'),
        'arm': Finding(arm, 'm', 'distance of the centre of friction from the face'),
        'small_left': Finding(float(table['most_left_rad'][0]), 'rad', 'greatest rotation to the '
                              'left on the smallest robot'),
        'most_left': Finding(float(table['most_left_rad'][table['radius_m'] < arm].max()), 'rad',
                             'the same on any robot below the distance of the centre'),
        'large_left': Finding(float(table['most_left_rad'][-1]), 'rad', 'the same on the largest'),
        'worst_radius': Finding(float(table['radius_m'][worst]), 'm', 'radius of the robot that '
                                'takes longest'),
        'travel': Finding(float(table['travel_m'].max()), 'm', 'greatest distance of a contact '
                          'from the middle of the face'),
        'slower': Finding(PERCENT * slower, '%', 'its duration above that of the fastest')})


def draw_paths(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box on its path, a panel for each robot, and its rotation below."""
    panels = _panels(figure, values)
    for axes, name in zip(panels, _names(values)):
        path, radius = outcome.tables[f'path_{name}'], name / MILLIMETRES
        duration = path['time_s'][-1]
        draw_outlines(axes, box(values), poses_at(path, np.linspace(0.0, duration, OUTLINES)))
        draw_center(axes, path, label='middle of the box', **plot_style.series(0))
        axes.plot(path['contact_x_m'], path['contact_y_m'], zorder=3.0, label='contact',
                  **plot_style.series(1))
        x, y, normal = contact_at(path, 0.0)
        sketch.robot(axes, sketch.polar(normal, -radius, (x, y)), radius)
        rotations = np.degrees((path['theta_rad'].min(), path['theta_rad'].max()))
        axes.annotate('$\\theta$ {:.1f} to {:.1f}°'.format(*rotations), (0.98, 0.04),
                      xycoords='axes fraction', ha='right', fontsize=8.0)
        axes.set_xlim(-1.35, 2.4)
        axes.set_ylim(-0.65, 0.75)
        axes.label_outer()
    figure.legend(*panels[0].get_legend_handles_labels(), loc='outside upper right', ncols=2)


def draw_angles(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the inputs, a panel for each robot."""
    for axes, name in zip(_panels(figure, values), _names(values)):
        axes.axhline(0.0, color=plot_style.GREY, linewidth=0.8)
        draw_inputs(axes, outcome.tables[f'inputs_{name}'], **plot_style.series(0))
        axes.set_xlabel('distance of the contact [m]')
        axes.label_outer()


def _panels(figure: Figure, values: Values) -> list[Axes]:
    """Make a panel for each robot, lettered, with its radius as title."""
    rows = (len(values.radii) + 1) // 2
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False).ravel().tolist()
    for letter, axes, name in zip('abcdefghij', panels, _names(values)):
        axes.set_title(f'({letter}) $R_p$ = {name} mm', loc='left')
    return panels


def _names(values: Values) -> list[int]:
    """Return the radii in whole millimetres, which name the tables."""
    return [round(MILLIMETRES * radius) for radius in values.radii]


PARAMETERS = (*SETUP, SPEED, SEGMENTS, Parameter('radii', 'm', 'radii of the robots, R_p',
                                                 [0.05, 0.1, 0.2, 0.3, 0.4, 0.5]))
STUDIES = (
    Study('3.10', 'Curved pusher: trajectories for several radii of the robot', PARAMETERS,
          compute, draw_paths,
          'To a goal on the left, robots below {arm:.2f} m rotate the box to the left (by '
          '{small_left:.2f} rad the smallest, by up to {most_left:.2f} rad), larger ones only to '
          'the right.',
          'Beyond that radius the contact rolls further than the centre of friction '
          'swings.', (7.6, 6.0)),
    Study('3.11', 'Curved pusher: inputs for several radii of the robot', PARAMETERS,
          compute, draw_angles,
          'Inputs of the smallest and the largest robots start with small angles of opposite '
          'signs; those in between roll up to {travel:.2f} m and take up to {slower:.1f}% longer.',
          'At a radius of {arm:.2f} m a lateral shift is lost as the box rotates '
          'back.', (7.2, 6.4)))
