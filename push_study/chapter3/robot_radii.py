"""Round robots of several radii that do not rotate, and push to the same goal."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_model.friction import friction_center
from push_study.chapter3.rolling_contact import MILLIMETRES, plan_rolling
from push_study.chapter3.setup import draw_inputs, SEGMENTS, SETUP, SPEED
from push_study.framework import plot_style
from push_study.framework.box import box
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table

PERCENT = 100.0
COLUMNS = ('radius_m', 'duration_s', 'most_left_rad', 'most_right_rad', 'travel_m', 'first_rad')


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan the push of every robot."""
    tables: dict[str, Table] = {}
    rows: list[tuple[float, ...]] = []
    for radius, name in zip(values.radii, _names(values)):
        found, path, inputs = plan_rolling(values, radius)
        tables[f'path_{name}'], tables[f'inputs_{name}'] = path, inputs
        rotations = path['theta_rad']
        rows.append((radius, found.trajectory.duration, float(rotations.max()),
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
        'large_left': Finding(float(table['most_left_rad'][-1]), 'rad', 'the same on the largest'),
        'worst_radius': Finding(float(table['radius_m'][worst]), 'm', 'radius of the robot that '
                                'takes longest'),
        'travel': Finding(float(table['travel_m'].max()), 'm', 'greatest distance of a contact '
                          'from the middle of the face'),
        'slower': Finding(PERCENT * slower, '%', 'its duration above that of the fastest')})


def draw_paths(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the paths of the middle and the rotations."""
    panels = figure.subplots(2, 1, sharex=True)
    for number, name in enumerate(_names(values)):
        path = outcome.tables[f'path_{name}']
        for axes, column in zip(panels, ('y_m', 'theta_rad')):
            axes.plot(path['x_m'], path[column], label=f'{name} mm', **plot_style.series(number))
    panels[0].set_ylabel('y of the middle [m], not to scale')
    panels[1].set_ylabel('rotation $\\theta$ [rad]')
    panels[1].set_xlabel('x of the middle [m]')
    _legend(panels[0])


def draw_angles(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the inputs, and where they move the contact."""
    above, below = figure.subplots(2, 1, sharex=True)
    for number, name in enumerate(_names(values)):
        path, style = outcome.tables[f'path_{name}'], plot_style.series(number)
        draw_inputs(above, outcome.tables[f'inputs_{name}'], label=f'{name} mm', **style)
        below.plot(path['time_s'] * values.speed, MILLIMETRES * path['along_face_m'], **style)
    above.set_xlabel('')
    below.set_xlabel('distance travelled by the contact [m]')
    below.set_ylabel('contact, to the left [mm]')
    _legend(above)


def _names(values: Values) -> list[int]:
    """Return the radii in whole millimetres, which name the tables."""
    return [round(MILLIMETRES * radius) for radius in values.radii]


def _legend(axes: Axes) -> None:
    axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0), title='$R_p$', handlelength=3.2)


PARAMETERS = (*SETUP, SPEED, SEGMENTS, Parameter('radii', 'm', 'radii of the robots, R_p',
                                                 [0.05, 0.1, 0.2, 0.3, 0.4, 0.5]))
STUDIES = (
    Study('3.9', 'Curved pusher: trajectories for several radii of the robot', PARAMETERS,
          compute, draw_paths,
          'To reach the same pose, to the left of the start, robots with a radius below '
          '{arm:.2f} m rotate the box to the left (the smallest by up to {small_left:.2f} rad), '
          'larger ones not at all ({large_left:.2f} rad): they only rotate it to the right.',
          'As a box rotates to the left, its centre of friction swings to the left of the '
          'contact, but the contact rolls to the left too: beyond a radius of {arm:.2f} m, the '
          'distance of the centre of friction from the face, the contact moves further, a push '
          'through the centre of friction leads to the right, and the box must be rotated to the '
          'right to move to the left.', (6.4, 5.0)),
    Study('3.10', 'Curved pusher: inputs for several radii of the robot', PARAMETERS,
          compute, draw_angles,
          'Inputs of the two smallest robots and of the two largest begin with small angles of '
          'opposite signs; those in between need large ones, roll up to {travel:.2f} m from the '
          'middle of the face and take up to {slower:.1f}% longer.',
          'A robot whose radius is the distance of the centre of friction, {arm:.2f} m, sees it '
          'in the same direction from its contact however the box rotates: a lateral shift gained '
          'by a rotation is lost again as the box rotates back.', (6.4, 5.0)))
