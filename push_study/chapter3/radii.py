"""Round robots of several radii that do not turn, and push to the same goal."""

import numpy as np
from push_model.friction import friction_center
from push_study.chapter3.rolling import MILLIMETRES, rolling_tables
from push_study.chapter3.scene import draw_inputs, SCENE, SEGMENTS, SPEED
from push_study.framework import paper
from push_study.framework.scenes import box
from push_study.framework.study import Finding, Outcome, Parameter, Study


def compute(values, batch):
    """
    Plan the push of every robot.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    tables, rows = {}, []
    for radius in values.radii:
        found, path, inputs = rolling_tables(values, radius)
        name = round(MILLIMETRES * radius)
        tables[f'path_{name}'], tables[f'inputs_{name}'] = path, inputs
        turns = path['theta_rad']
        rows.append((radius, found.trajectory.duration, float(turns.max()), float(turns.min()),
                     float(np.abs(path['along_face_m']).max()), float(inputs['rho_rad'][0])))
    names = ('radius_m', 'duration_s', 'most_left_rad', 'most_right_rad', 'travel_m', 'first_rad')
    table = tables['robots'] = dict(zip(names, map(np.array, zip(*rows))))
    turns = np.maximum(table['most_left_rad'], -table['most_right_rad'])
    arm = friction_center(box(values))[0] + 0.5 * values.box_length
    worst = int(np.argmax(table['duration_s']))
    return Outcome(tables, {
        'rolls': Finding(float(np.abs(table['travel_m'] / turns / table['radius_m'] - 1.0).max()),
                         '', 'greatest deviation of travel over turn from the radius'),
        'arm': Finding(arm, 'm', 'distance of the friction centre from the face'),
        'small_left': Finding(float(table['most_left_rad'][0]), 'rad', 'greatest turn to the left '
                              'on the smallest robot'),
        'large_left': Finding(float(table['most_left_rad'][-1]), 'rad', 'the same on the largest'),
        'worst_radius': Finding(float(table['radius_m'][worst]), 'm', 'radius of the robot that '
                                'takes longest'),
        'travel': Finding(float(table['travel_m'].max()), 'm', 'farthest that a '
                          'contact gets from the middle of the face'),
        'slower': Finding(100.0 * float(table['duration_s'][worst] / table['duration_s'].min()
                                        - 1.0), '%', 'time it takes above that of the fastest')})


def draw_ways(figure, outcome, values):
    """
    Draw the ways of the middle and the turns.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    panels = figure.subplots(2, 1, sharex=True)
    for number, name in enumerate(_names(values)):
        path = outcome.tables[f'path_{name}']
        for axes, column in zip(panels, ('y_m', 'theta_rad')):
            axes.plot(path['x_m'], path[column], label=f'{name} mm', **paper.series(number))
    panels[0].set_ylabel('y of the middle [m], stretched')
    panels[1].set_ylabel('turn $\\theta$ [rad]')
    panels[1].set_xlabel('x of the middle [m]')
    _legend(panels[0])


def draw_angles(figure, outcome, values):
    """
    Draw the inputs, and where they take the contact.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    angles, places = figure.subplots(2, 1, sharex=True)
    for number, name in enumerate(_names(values)):
        path, look = outcome.tables[f'path_{name}'], paper.series(number)
        draw_inputs(angles, outcome.tables[f'inputs_{name}'], label=f'{name} mm', **look)
        places.plot(path['time_s'] * values.speed, MILLIMETRES * path['along_face_m'], **look)
    angles.set_xlabel('')
    places.set_xlabel('way of the contact [m]')
    places.set_ylabel('contact, to the left [mm]')
    _legend(angles)


def _names(values):
    return [round(MILLIMETRES * radius) for radius in values.radii]


def _legend(axes):
    axes.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0), title='$R_p$', handlelength=3.2)


RADII = (*SCENE, SPEED, SEGMENTS, Parameter('radii', 'm', 'radii of the robots, R_p',
                                            [0.05, 0.1, 0.2, 0.3, 0.4, 0.5]))
STUDIES = (
    Study('3.9', 'Curved fence: trajectories for several radii of the robot', RADII,
          compute, draw_ways,
          'To get to the same pose, to the left of the start, robots with a radius below '
          '{arm:.2f} m turn the box to the left (the smallest by up to {small_left:.2f} rad), '
          'larger ones not at all ({large_left:.2f} rad): they only turn it to the right.',
          'As a box turns left, its friction centre swings to the left of the contact, but the '
          'contact rolls that way too: beyond a radius of {arm:.2f} m, the distance of the '
          'friction centre from the face, the contact is ahead, a push through the friction '
          'centre leads to the right, and the box has to be turned right to get to the left.',
          (6.4, 5.0)),
    Study('3.10', 'Curved fence: inputs for several radii of the robot', RADII,
          compute, draw_angles,
          'Inputs of the two smallest robots and of the two largest begin with small angles of '
          'opposite signs; those between need large ones, roll up to {travel:.2f} m from the '
          'middle of the face and take up to {slower:.1f}% longer.',
          'A robot as large as the distance of the friction centre, {arm:.2f} m, has it in the '
          'same direction from its contact however the box turns: what a turn shifts it to the '
          'side is lost again as the box turns back.', (6.4, 5.0)))
