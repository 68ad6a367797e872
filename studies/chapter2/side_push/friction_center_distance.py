"""Case study 3: how far from the contact may the centre of friction of a pushed box be."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from studies.chapter2.side_push.setup import (
    EXACT_START, integrate_rolling, predicted_growth_rate, sample_times, SETUP, simulate,
    simulated_growth_rate, stability_limit, Start,
)
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

PARAMETERS = (Parameter('distances', 'm', 'centre of friction ahead of the contact',
                        [0.05, 0.1, 0.15, 0.2]),
              Parameter('lateral_offset', 'm', 'both starts: robot to the left of the '
                        'centre line of the box'),
              Parameter('initial_rotation', 'rad', 'disturbed start: rotation of the box, rolled '
                        'on the robot'),
              *SETUP)
MILLIMETRES = 1e3
UNDISTURBED = 'undisturbed'
DISTURBED = 'disturbed'


def starts(values: Values) -> dict[str, Start]:
    """
    List how the pushes begin.

    :param values: with the parameters ``PARAMETERS``.
    :return: starts by name.
    """
    return {UNDISTURBED: Start(0.0, values.lateral_offset),
            DISTURBED: Start(values.initial_rotation, values.lateral_offset)}


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the rotation of the box over time, growth rates, and where they change sign."""
    times = sample_times(values)
    tables: dict[str, Table] = {}
    difference = 0.0
    for name, start in starts(values).items():
        tables[name] = {'time_s': times}
        for distance in values.distances:
            simulated = simulate(values, distance, start)
            rotations, holds = simulated.rotations, simulated.holds
            integrated = integrate_rolling(values, distance, start, times[holds])
            difference = max(difference, float(np.abs(integrated - rotations[holds]).max()))
            tables[name][_rotation_column(distance)] = rotations
            tables[name][_holds_column(distance)] = holds.astype(int)
    rates: Table = {
        'distance_m': list(values.distances),
        'predicted_rate_per_s': [predicted_growth_rate(values, distance)
                                 for distance in values.distances],
        'simulated_rate_per_s': [simulated_growth_rate(values, distance)
                                 for distance in values.distances]}
    for name in (UNDISTURBED, DISTURBED):
        rates[f'final_rotation_{name}_rad'] = [tables[name][_rotation_column(distance)][-1]
                                               for distance in values.distances]
    tables['rates'] = rates
    exact = [simulate(values, distance, EXACT_START).rotations for distance in values.distances]
    return Outcome(tables, {
        'limit': Finding(stability_limit(values), 'm',
                         'distance at which a rotation begins to grow'),
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'last': Finding(values.distances[-1], 'm', 'last of the distances'),
        'last_rate': Finding(tables['rates']['simulated_rate_per_s'][-1], '1/s',
                             'growth rate of a rotation at the last distance'),
        'exact': Finding(float(np.abs(exact).max()), 'rad', 'largest rotation from an exact '
                         'start'),
        'difference': Finding(difference, 'rad', 'contact simulation against equations of '
                              'motion')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the rotation over time from both starts, a panel for each distance."""
    panels = figure.subplots(2, (len(values.distances) + 1) // 2, sharex=True, squeeze=False)
    for letter, axes, distance in zip('abcdefgh', panels.flat, values.distances):
        axes.axhline(0.0, color=plot_style.GREY, linewidth=0.8)
        for index, name in enumerate((DISTURBED, UNDISTURBED)):
            _draw_rotation(axes, outcome.tables[name], distance, name,
                           plot_style.series(index))
        axes.set_title(f'({letter}) centre of friction at {MILLIMETRES * distance:.0f} mm',
                       loc='left')
        axes.set_xlim(0.0, values.duration)
    panels[0, 0].legend(title='start', loc='upper right')
    for axes in panels[-1]:
        axes.set_xlabel('time [s]')
    figure.supylabel('rotation of the box from straight ahead [rad]', fontsize=9.0)


def _draw_rotation(axes: Axes, table: Table, distance: float, name: str,
                   style: dict[str, Any]) -> None:
    times, rotations = table['time_s'], table[_rotation_column(distance)]
    held = sum(table[_holds_column(distance)])
    axes.plot(times, rotations, label=name, **style)
    if held < len(rotations):
        axes.plot(times[held], rotations[held], 'o', color=style['color'])
        axes.annotate('contact slips', (times[held], rotations[held]), (-8, 4),
                      textcoords='offset points', ha='right')


def _rotation_column(distance: float) -> str:
    return f'rotation_{MILLIMETRES * distance:.0f}_mm_rad'


def _holds_column(distance: float) -> str:
    return f'holds_{MILLIMETRES * distance:.0f}_mm'


STUDIES = (Study(
    '2.32', 'A robot pushes a box: rotation from an undisturbed and a disturbed start', PARAMETERS,
    compute, draw,
    'Rotated boxes swing back, slower with a centre of friction further away; at {last:.2f} m the '
    'rotation grows, at {last_rate:.2f} 1/s.',
    'Rolling moves the contact by {radius:.3f} m per radian, which suffices for a centre of '
    'friction nearer than {limit:.3f} m.', (7.2, 5.2)),)
