"""Case study 3: how far from the contact may the centre of friction of a pushed box be."""

from matplotlib.figure import Figure
import numpy as np
from push_study.chapter2.side_push.setup import (
    EXACT_START, integrate_rolling, predicted_growth_rate, sample_times, SETUP, simulate,
    simulated_growth_rate, stability_limit, Start,
)
from push_study.framework import plot_style
from push_study.framework.parameters import Parameter, Values
from push_study.framework.study import Finding, Outcome, RunJobs, Study, Table

PARAMETERS = (Parameter('distances', 'm', 'centre of friction ahead of the contact',
                        [0.05, 0.1, 0.15, 0.2]),
              Parameter('initial_rotation', 'rad',
                        'rotation of the box at the start, rolled on the robot'),
              Parameter('lateral_offset', 'm', 'robot to the left of the centre line of the box'),
              *SETUP)
MILLIMETRES = 1e3
RATE_COLUMNS = ('distance_m', 'predicted_rate_per_s', 'simulated_rate_per_s',
                'final_rotation_rad')


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compute the rotation of the box over time, growth rates, and where they change sign."""
    start = Start(values.initial_rotation, values.lateral_offset)
    curves: Table = {}
    rates: list[tuple[float, ...]] = []
    findings: dict[str, Finding] = {}
    difference = 0.0
    times = sample_times(values)
    for distance in values.distances:
        simulated = simulate(values, distance, start)
        rotations, holds = simulated.rotations, simulated.holds
        integrated = integrate_rolling(values, distance, start, times[holds])
        difference = max(difference, float(np.abs(integrated - rotations[holds]).max()))
        name = _column(distance)
        curves[f'rotation_{name}_rad'] = rotations
        rates.append((distance, predicted_growth_rate(values, distance),
                      simulated_growth_rate(values, distance), rotations[-1]))
        curves[f'holds_{name}'] = holds.astype(int)
        findings[f'final_{name}'] = Finding(
            float(rotations[-1]), 'rad',
            f'rotation at the end, centre of friction at {MILLIMETRES * distance:.0f} mm')
    exact = [simulate(values, distance, EXACT_START).rotations for distance in values.distances]
    last, last_rate = values.distances[-1], rates[-1][2]
    findings |= {
        'limit': Finding(stability_limit(values), 'm',
                         'distance at which a rotation begins to grow'),
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'last': Finding(last, 'm', 'last of the distances'),
        'last_rate': Finding(last_rate, '1/s', 'growth rate of a rotation at the last distance'),
        'exact': Finding(float(np.abs(exact).max()), 'rad', 'largest rotation from an exact '
                         'start'),
        'difference': Finding(difference, 'rad', 'contact simulation against equations of '
                              'motion')}
    return Outcome({'rotation': {'time_s': times, **curves},
                    'rates': dict(zip(RATE_COLUMNS, map(list, zip(*rates))))}, findings)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the rotation over time."""
    axes = figure.subplots()
    table = outcome.tables['rotation']
    for number, distance in enumerate(values.distances):
        name, style = _column(distance), plot_style.series(number)
        times, rotations = table['time_s'], table[f'rotation_{name}_rad']
        held = sum(table[f'holds_{name}'])
        axes.plot(times, rotations, label=f'{MILLIMETRES * distance:.0f} mm', **style)
        if held < len(rotations):
            axes.plot(times[held], rotations[held], 'o', color=style['color'])
            axes.annotate('contact slips', (times[held], rotations[held]), (-8, 4),
                          textcoords='offset points', ha='right')
    axes.set_xlim(0.0, values.duration)
    axes.set_xlabel('time [s]')
    axes.set_ylabel('rotation of the box from straight ahead [rad]')
    axes.legend(title='centre of friction at', loc='best')


def _column(distance: float) -> str:
    return f'{MILLIMETRES * distance:.0f}_mm'


STUDIES = (
    Study('2.32', 'A robot pushes a box: rotation from an undisturbed start', PARAMETERS, compute,
          draw,
          'With the robot placed as accurately as a robot can be, boxes settle at a small '
          'rotation, except the one with its centre of friction at {last:.2f} m, whose rotation '
          'grows at {last_rate:.2f} 1/s; placed exactly on the line, even that one moves '
          'straight.',
          'Rolling moves the contact by the radius of the robot for each radian of rotation, so '
          'that a centre of friction nearer than {limit:.3f} m is brought back in front of the '
          'contact (radius of the robot: {radius:.3f} m).'),
    Study('2.33', 'A robot pushes a box: rotation from a disturbed start', PARAMETERS, compute,
          draw,
          'A box that starts rotated swings back, the more slowly the further away its centre of '
          'friction is; at {last:.2f} m the rotation grows until the box has slipped off.',
          'The stability limit is at {limit:.3f} m, the radius of the robot ({radius:.3f} m), '
          'whatever the mass: beyond it the centre of friction swings out further than the '
          'contact rolls.'))
