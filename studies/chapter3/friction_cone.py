"""Push and contact force of a plan against the friction cone."""

import math
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from studies.analysis.time_integration import push_at_angles
from studies.chapter3.setup import (
    contact_at, draw_inputs, draw_outlines, draw_push, GOAL, input_table, path_table, poses_at,
    push_problem, SEGMENTS, set_plane, SPEED,
)
from studies.framework import plot_style
from studies.framework.box import BOX, box
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: radius of a drawn cone [m].
CONE_RADIUS = 0.2
CENTIMETRES = 100.0
PARAMETERS = (*BOX, GOAL, SEGMENTS)


class Forces(NamedTuple):
    """
    Angles of push and contact force over time, as tables.

    :param inputs: of ``input_table``.
    :param force: of the contact force, between the switches.
    :param impulses: of the first touch and of each switch.
    """

    inputs: Table
    force: Table
    impulses: Table


def contact_forces(plan: Plan, speed: float) -> Forces:
    """
    Integrate a plan of a point robot independently, with its contact forces.

    :param plan: ``Plan`` in constant pushing angles.
    :param speed: of the contact [m/s].
    :return: angles over time.
    """
    inputs, problem = input_table(plan), plan.problem
    run = push_at_angles(problem.obj, problem.contact, inputs['rho_rad'],
                         inputs['end_m'] - inputs['begin_m'], speed)
    times, normal, tangential = run.impulses.T
    force = {'time_s': run.times, 'normal_N': run.forces[:, 0], 'tangential_N': run.forces[:, 1],
             'angle_rad': np.arctan2(run.forces[:, 1], run.forces[:, 0])}
    impulses = {'time_s': times, 'normal_N_s': normal, 'tangential_N_s': tangential,
                'angle_rad': np.arctan2(tangential, normal)}
    return Forces(inputs, force, impulses)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan one push that keeps its pushing angles in the friction cone."""
    cone = math.atan(values.contact_friction)
    plan = plan_push(push_problem(values, values.speed, values.segments, angle_limit='angle',
                                  max_pushing_angle=cone, cone_margin=1.0))
    inputs, force, impulses = contact_forces(plan, values.speed)
    is_outside = np.abs(impulses['angle_rad']) > cone
    return Outcome({'path': path_table(plan.trajectory), 'inputs': inputs, 'force': force,
                    'impulses': impulses}, {
        'cone': Finding(cone, 'rad', 'half-angle of the friction cone'),
        'push': Finding(float(np.abs(inputs['rho_rad']).max() / cone), '', 'greatest pushing '
                        'angle, as a fraction of the cone'),
        'force': Finding(float(np.abs(force['angle_rad']).max() / cone), '', 'greatest angle of '
                         'the contact force, as a fraction of the cone'),
        'first_touch': Finding(float(abs(impulses['angle_rad'][0]) / cone), '', 'angle of the '
                               'impulse of the first touch, as a fraction of the cone'),
        'outside': Finding(float(is_outside[1:].sum()), '', 'switches whose impulse lies outside '
                           'the cone'),
        'switches': Finding(float(len(is_outside) - 1), '', 'switches of the pushing angle'),
        'blend': Finding(CENTIMETRES * plan.report['longest_blend'], 'cm', 'longest distance '
                         'over which a switch must be spread for the contact to hold')})


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw the box with its cone at every switch, and the angles over time."""
    above, below = figure.subplots(2, 1, height_ratios=(1.4, 1.0))
    path, inputs, force, impulses = (outcome.tables[name]
                                     for name in ('path', 'inputs', 'force', 'impulses'))
    cone, starts = outcome.findings['cone'].value, inputs['begin_s']
    draw_outlines(above, box(values), poses_at(path, [*starts, path['time_s'][-1]]))
    for time, angle in zip(starts, inputs['rho_rad']):
        _draw_cone(above, path, time, cone)
        draw_push(above, path, time, angle)
    set_plane(above)
    below.axhspan(-cone, cone, color=plot_style.REGION, linewidth=0.0, zorder=0.5,
                  label='friction cone')
    draw_inputs(below, inputs, 's', label='push', **plot_style.series(1))
    below.plot(force['time_s'], force['angle_rad'], label='contact force', **plot_style.series(0))
    below.plot(impulses['time_s'], impulses['angle_rad'], 'D', color=plot_style.INK,
               markersize=4.5, label='impulse of a switch', clip_on=False, zorder=4.0)
    below.set_xlim(0.0, path['time_s'][-1])
    below.set_ylabel('angle to the normal [rad]')
    below.legend(loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=4, borderaxespad=0.2)


def _draw_cone(axes: Axes, path: Table, time: float, cone: float) -> None:
    x, y, normal = contact_at(path, time)
    angles = normal + math.pi + np.linspace(-cone, cone, 20)
    axes.fill([x, *(x + CONE_RADIUS * np.cos(angles))], [y, *(y + CONE_RADIUS * np.sin(angles))],
              facecolor=plot_style.REGION, edgecolor=plot_style.GREY, linewidth=0.5, zorder=2.0,
              alpha=0.8)


STUDIES = (
    Study('3.7', 'Push and contact force in the friction cone', (*PARAMETERS, SPEED),
          compute, draw,
          'Between switches the contact sticks: the push uses up to {push:.1f} of the friction '
          'cone (sectors), the contact force {force:.1f}. A switch in an instant needs an impulse '
          '(diamonds); at {outside:.0f} of {switches:.0f} it lies outside of the cone.',
          'A robot therefore spreads each switch over up to {blend:.0f} cm of its way, and the '
          'force stays inside.', (6.4, 6.0)),)
