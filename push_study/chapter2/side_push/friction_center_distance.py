"""Case study 3: how far from the contact may the friction centre of a pushed box be."""

import numpy as np
from push_study.chapter2.side_push.scene import (
    equations, measured_rate, predicted_rate, SCENE, simulate, switch,
)
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study

PARAMETERS = (Parameter('distances', 'm', 'friction centre ahead of the contact',
                        [0.05, 0.1, 0.15, 0.2]),
              Parameter('turned', 'rad', 'turn of the box at the start, rolled on the robot'),
              Parameter('aside', 'm', 'robot to the left of the centre line of the box')) + SCENE


def compute(values, batch):
    """
    Turn of the box over time for each distance, growth rates, and where they change their sign.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    turns, rates, off, findings = {}, [], 0.0, {}
    for distance in values.distances:
        times, found, holds = simulate(values, distance, values.turned, values.aside)
        model = equations(values, distance, values.turned, values.aside, times[holds])
        off = max(off, float(np.abs(model - found[holds]).max()))
        name = f'{1e3 * distance:.0f}_mm'
        turns[f'turn_{name}_rad'] = found
        rates.append((distance, predicted_rate(values, distance),
                      measured_rate(values, distance), found[-1]))
        turns[f'held_{name}'] = holds.astype(int)
        findings[f'final_{name}'] = Finding(float(found[-1]), 'rad', 'turn at the end, friction '
                                            f'centre at {1e3 * distance:.0f} mm')
    exact = [simulate(values, distance, 0.0, 0.0)[1] for distance in values.distances]
    last, rate = values.distances[-1], rates[-1][2]
    findings |= {
        'switch': Finding(switch(values), 'm', 'distance at which a turn begins to grow'),
        'radius': Finding(values.robot_radius, 'm', 'radius of the robot'),
        'last': Finding(last, 'm', 'last of the distances'),
        'last_rate': Finding(rate, '1/s', 'rate at which a turn grows at the last distance'),
        'exact': Finding(float(np.abs(exact).max()), 'rad', 'largest turn from an exact start'),
        'difference': Finding(off, 'rad', 'contact simulation against equations of motion')}
    columns = ('distance_m', 'predicted_rate_per_s', 'measured_rate_per_s', 'final_turn_rad')
    return Outcome({'turn': {'time_s': times, **turns},
                    'rates': dict(zip(columns, map(list, zip(*rates))))}, findings)


def draw(figure, outcome, values):
    """
    Draw the turn over time.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    axes = figure.subplots()
    table = outcome.tables['turn']
    for number, distance in enumerate(values.distances):
        name, style = f'{1e3 * distance:.0f}_mm', paper.series(number)
        turns, held = table[f'turn_{name}_rad'], sum(table[f'held_{name}'])
        axes.plot(table['time_s'], turns, label=f'{1e3 * distance:.0f} mm', **style)
        if held < len(turns):
            axes.plot(table['time_s'][held], turns[held], 'o', color=style['color'])
            axes.annotate('contact slips', (table['time_s'][held], turns[held]),
                          (-8, 4), textcoords='offset points', ha='right')
    axes.set_xlim(0.0, values.duration)
    axes.set_xlabel('time [s]')
    axes.set_ylabel('turn of the box from straight ahead [rad]')
    axes.legend(title='friction centre at', loc='best')


def _study(figure, title, seen, why):
    return Study(figure, title, PARAMETERS, compute, draw, seen, why)


STUDIES = (
    _study('2.32', 'A robot pushes a box: turn from an undisturbed start',
           'With the robot placed as well as a robot can be, boxes settle at a small turn, '
           'except the one with its friction centre at {last:.2f} m: its turn grows at '
           '{last_rate:.2f} 1/s. Placed exactly on the line, even that one goes straight.',
           'Rolling moves the contact by the radius of the robot for each radian of turn, so that '
           'a friction centre nearer than {switch:.3f} m is brought back before the contact '
           '(radius of the robot: {radius:.3f} m).'),
    _study('2.33', 'A robot pushes a box: turn from a disturbed start',
           'A box that starts turned swings back, the slower the further away its friction centre '
           'is; at {last:.2f} m the turn grows until the box has slipped off.',
           'The switch lies at {switch:.3f} m, the radius of the robot ({radius:.3f} m), whatever '
           'the mass: beyond it the friction centre swings out further than the contact rolls.'))
