"""What more pushing angles cost the solver, and what they gain."""

import numpy as np
from push_planner.collocation.dimensions import Dimensions
from push_planner.single_push.planner import plan_push
from push_study.chapter3.scene import input_table, push_problem, SCENE, SPEED
from push_study.framework import paper
from push_study.framework.study import Finding, Outcome, Parameter, Study

GOALS = ('symmetrical', 'asymmetrical')
REFERENCE = 6


def effort(answer):
    """
    Work of the solver: iterations times unknowns, which a step of its sweeps grows with.

    :param answer: the ``Plan``, in constant pushing angles.
    """
    problem = answer.problem
    dimensions = Dimensions(problem.kind, len(problem.obj.supports), answer.report['segments'],
                            True, False, problem.settings.heading_free)
    return answer.report['iterations'] * dimensions.variable_count


def unevenness(answer):
    """
    Distance of the pushing angles from their own reversed and mirrored course, over the largest.

    :param answer: the ``Plan``.
    """
    angles = input_table(answer)['rho_rad']
    return float(np.abs(angles + angles[::-1]).max() / np.abs(angles).max())


def compute(values, batch):
    """
    Plan to both goals with every number of constant pushing angles.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    counts = sorted({REFERENCE, *map(int, values.counts)})
    plans = {name: [plan_push(push_problem(values, values.speed, count, goal=goal))
                    for count in counts]
             for name, goal in zip(GOALS, (values.goal, values.asymmetrical_goal))}
    table, findings, middle = {'segments': counts}, {}, counts.index(REFERENCE)
    for name, answers in plans.items():
        work = np.array([effort(answer) for answer in answers], dtype=float)
        lasted = np.array([answer.trajectory.duration for answer in answers])
        table[f'{name}_iterations'] = [answer.report['iterations'] for answer in answers]
        table[f'{name}_relative_work'] = work / work[middle]
        table[f'{name}_duration_s'] = lasted
        table[f'{name}_longer'] = lasted / lasted[-1] - 1.0
        findings.update({
            f'{name}_few': Finding(float(100.0 * table[f'{name}_longer'][0]), '%', 'duration with '
                                   f'{counts[0]} segments beyond that with most, {name}'),
            f'{name}_six': Finding(float(100.0 * table[f'{name}_longer'][middle]), '%',
                                   f'the same with {REFERENCE} segments, {name}'),
            f'{name}_uneven': Finding(unevenness(answers[middle]), '', 'distance of the pushing '
                                      f'angles from symmetry over the largest, {name}')})
    # One integration for the motion, one for its length, and one for each angle.
    per_angle = (np.array(counts) + 2.0) / (REFERENCE + 2.0)
    table['integrations_relative'] = per_angle
    steps = plans[GOALS[0]][middle].report['segments']
    findings.update(
        steps=Finding(steps, '', f'steps of the programme with {REFERENCE} segments'),
        few=Finding(counts[0], '', 'least number of segments'))
    return Outcome({'effort': table}, findings)


def draw(figure, outcome, values):
    """
    Draw work and duration over the number of segments.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    table = outcome.tables['effort']
    counts = np.array(table['segments'])
    left, right = figure.subplots(1, 2)
    for number, name in enumerate(GOALS):
        look = {'marker': 'os'[number], 'markersize': 6.5 - 2.0 * number, 'label': name,
                **paper.series(number)}
        left.plot(counts, table[f'{name}_relative_work'], **look)
        right.plot(counts[:-1], 100.0 * table[f'{name}_longer'][:-1], **look)
    left.plot(counts, table['integrations_relative'], color=paper.GREY, linewidth=1.0,
              label='one integration per angle')
    left.set_ylabel(f'work relative to {REFERENCE} segments')
    right.set_ylabel(f'duration beyond that with {counts[-1]} segments [%]')
    right.set_yscale('log')
    for axes in (left, right):
        axes.set_xscale('log', base=2)
        axes.set_xticks(counts, [str(count) for count in counts])
        axes.minorticks_off()
        axes.set_xlabel('segments of constant pushing angle')
    left.set_ylim(bottom=0.0)
    left.legend(loc='upper left')
    right.legend(loc='upper right')


STUDIES = (
    Study('T3.1', 'Effort of planning over the number of segments',
          (*SCENE, Parameter('asymmetrical_goal', 'm, m, rad', 'goal of the asymmetrical push'),
           SPEED, Parameter('counts', '', 'numbers of segments')), compute, draw,
          'Up to {steps:.0f} segments the work of the solver hardly grows, where a search over '
          'the angles alone takes more with every angle (grey); with {few:.0f} segments the '
          'symmetrical push takes {symmetrical_few:.1f} % longer than with most and the '
          'asymmetrical one {asymmetrical_few:.1f} %, and every segment more shortens both.',
          'The programme carries the motion along in steps of its own, {steps:.0f} for fewer '
          'pushing angles too, and one sweep through them gives all derivatives; the other way '
          'needs one more integration for every angle in each of its iterations.', (7.6, 3.8)),)
