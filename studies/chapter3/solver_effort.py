"""What more pushing angles cost the solver, and what they gain."""

from typing import NamedTuple

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_planner.steered.collocation.dimensions import Dimensions
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from studies.chapter3.setup import input_table, push_problem, SETUP, SPEED
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

GOALS = ('symmetrical', 'asymmetrical')
# As many segments as the thesis uses; work is stated relative to them.
REFERENCE_SEGMENTS = 6
PERCENT = 100.0


def solver_work(plan: Plan) -> int:
    """
    Estimate the work of the solver: iterations times unknowns, as an iteration is linear in them.

    :param plan: ``Plan`` in constant pushing angles.
    :return: number of unknowns in all iterations.
    """
    problem, steps = plan.problem, plan.report['segments']
    dimensions = Dimensions(problem.kind, len(problem.obj.supports), steps, True, False,
                            problem.settings.heading_free)
    return plan.report['iterations'] * dimensions.variable_count


def asymmetry(plan: Plan) -> float:
    """
    Compute the distance of the pushing angles from their own reversed and mirrored course.

    :param plan: ``Plan`` in constant pushing angles.
    :return: greatest distance over the greatest angle; 0 for a symmetrical course.
    """
    angles = input_table(plan)['rho_rad']
    return float(np.abs(angles + angles[::-1]).max() / np.abs(angles).max())


class Effort(NamedTuple):
    """
    Work and gain over the number of segments, for one goal.

    :param iterations: of the solver, shape (n,).
    :param relative_work: work over that with ``REFERENCE_SEGMENTS``, shape (n,).
    :param durations: of the push [s], shape (n,).
    :param extra_durations: durations above the last one, relative, shape (n,).
    """

    iterations: list[int]
    relative_work: FloatArray
    durations: FloatArray
    extra_durations: FloatArray

    @classmethod
    def of(cls, plans: list[Plan], reference: int) -> 'Effort':
        """
        Measure plans to one goal.

        :param plans: one per number of segments, ascending.
        :param reference: index of the plan with ``REFERENCE_SEGMENTS``.
        :return: the effort.
        """
        work = np.array([solver_work(plan) for plan in plans], dtype=float)
        durations = np.array([plan.trajectory.duration for plan in plans])
        return cls([plan.report['iterations'] for plan in plans], work / work[reference],
                   durations, durations / durations[-1] - 1.0)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan to both goals with every number of constant pushing angles."""
    counts = sorted({REFERENCE_SEGMENTS, *map(int, values.segment_counts)})
    reference = counts.index(REFERENCE_SEGMENTS)
    plans = {name: [plan_push(push_problem(values, values.speed, count, goal=goal))
                    for count in counts]
             for name, goal in zip(GOALS, (values.goal, values.asymmetrical_goal))}
    table: Table = {'segments': counts}
    findings: dict[str, Finding] = {}
    for name, plans_of_goal in plans.items():
        effort = Effort.of(plans_of_goal, reference)
        table[f'{name}_iterations'] = effort.iterations
        table[f'{name}_relative_work'] = effort.relative_work
        table[f'{name}_duration_s'] = effort.durations
        table[f'{name}_extra_duration'] = effort.extra_durations
        few, six = (float(PERCENT * effort.extra_durations[index]) for index in (0, reference))
        findings[f'{name}_few'] = Finding(
            few, '%', f'duration with {counts[0]} segments above that with the most, {name}')
        findings[f'{name}_six'] = Finding(
            six, '%', f'the same with {REFERENCE_SEGMENTS} segments, {name}')
        findings[f'{name}_asymmetry'] = Finding(
            asymmetry(plans_of_goal[reference]), '',
            f'distance of the pushing angles from symmetry over the largest, {name}')
    # One integration for the motion, one for its length, and one for each angle.
    table['integrations_relative'] = (np.array(counts) + 2.0) / (REFERENCE_SEGMENTS + 2.0)
    steps = plans[GOALS[0]][reference].report['segments']
    findings.update(
        steps=Finding(steps, '', f'steps of the NLP with {REFERENCE_SEGMENTS} segments'),
        few=Finding(counts[0], '', 'least number of segments'))
    return Outcome({'effort': table}, findings)


def draw(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw work and duration over the number of segments."""
    table = outcome.tables['effort']
    counts = np.array(table['segments'])
    left, right = figure.subplots(1, 2)
    for index, (name, marker) in enumerate(zip(GOALS, 'os')):
        style = {'marker': marker, 'markersize': 6.5 - 2.0 * index, 'label': name,
                 **plot_style.series(index)}
        left.plot(counts, table[f'{name}_relative_work'], **style)
        right.plot(counts[:-1], PERCENT * table[f'{name}_extra_duration'][:-1], **style)
    left.plot(counts, table['integrations_relative'], color=plot_style.GREY, linewidth=1.0,
              label='one integration per angle')
    left.set_ylabel(f'work relative to {REFERENCE_SEGMENTS} segments')
    right.set_ylabel(f'duration above that with {counts[-1]} segments [%]')
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
          (*SETUP, Parameter('asymmetrical_goal', 'm, m, rad', 'goal of the asymmetrical push'),
           SPEED, Parameter('segment_counts', '', 'numbers of segments')), compute, draw,
          'Up to {steps:.0f} segments the effort hardly grows, unlike that of a search over the '
          'angles (grey). With {few:.0f} segments the symmetrical push takes '
          '{symmetrical_few:.1f} % longer, the asymmetrical one {asymmetrical_few:.1f} %.',
          'The NLP has {steps:.0f} steps of its own.', (7.6, 3.8)),)
