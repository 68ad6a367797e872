"""Push and contact force of a plan against the friction cone."""

import math

import numpy as np
from push_model.analysis.time_integration import push_at_angles
from push_planner.single_push.planner import plan_push
from push_study.chapter3.scene import (
    draw_inputs, draw_outlines, draw_push, GOAL, input_table, path_table, poses_at, push_problem,
    SEGMENTS, SPEED,
)
from push_study.framework import paper
from push_study.framework.scenes import BOX, box
from push_study.framework.study import Finding, Outcome, Study

PUSH, CONE, INSIDE = 0.16, 0.2, '#E3EAF4'
MAKING = (*BOX, GOAL, SEGMENTS)


def forces(found, speed):
    """
    Integrate a plan of a point robot anew, with its contact forces.

    :param found: ``Plan``.
    :param speed: of the contact [m/s].
    :return: (table of the inputs, table of the force angles, table of the impulses).
    """
    inputs, problem = input_table(found), found.problem
    run = push_at_angles(problem.obj, problem.contact, inputs['rho_rad'],
                         inputs['end_m'] - inputs['begin_m'], speed)
    times, normal, tangential = run.impulses.T
    return inputs, {'time_s': run.times, 'normal_N': run.forces[:, 0],
                    'tangential_N': run.forces[:, 1],
                    'angle_rad': np.arctan2(run.forces[:, 1], run.forces[:, 0])}, {
        'time_s': times, 'normal_N_s': normal, 'tangential_N_s': tangential,
        'angle_rad': np.arctan2(tangential, normal)}


def compute(values, batch):
    """
    Plan one push that keeps its pushing angles in the friction cone.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    cone = math.atan(values.contact_friction)
    found = plan_push(push_problem(values, values.speed, values.segments, angle_limit='angle',
                              max_pushing_angle=cone, cone_margin=1.0))
    inputs, force, impulses = forces(found, values.speed)
    outside = np.abs(impulses['angle_rad']) > cone
    return Outcome({'path': path_table(found.trajectory), 'inputs': inputs, 'force': force,
                    'impulses': impulses}, {
        'cone': Finding(cone, 'rad', 'half-angle of the friction cone'),
        'push': Finding(float(np.abs(inputs['rho_rad']).max() / cone), '', 'greatest pushing '
                        'angle, as a share of the cone'),
        'force': Finding(float(np.abs(force['angle_rad']).max() / cone), '', 'greatest angle of '
                         'the contact force, as a share of the cone'),
        'touch': Finding(float(abs(impulses['angle_rad'][0]) / cone), '', 'angle of the impulse '
                         'of the first touch, as a share of the cone'),
        'outside': Finding(float(outside[1:].sum()), '', 'switches whose impulse lies outside '
                           'the cone'),
        'switches': Finding(float(len(outside) - 1), '', 'switches of the pushing angle'),
        'blend': Finding(100.0 * found.report['longest_blend'], 'cm', 'longest way over which a '
                         'switch has to be spread for the contact to hold')})


def draw(figure, outcome, values):
    """
    Draw the box with its cone at every switch, and the angles over time.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    above, below = figure.subplots(2, 1, height_ratios=(1.4, 1.0))
    path, inputs, force, impulses = outcome.tables.values()
    cone = outcome.findings['cone'].value
    begins = inputs['begin_s']
    draw_outlines(above, box(values), poses_at(path, [*begins, path['time_s'][-1]]))
    for time, angle in zip(begins, inputs['rho_rad']):
        _cone(above, path, time, cone)
        draw_push(above, path, time, angle, PUSH)
    above.set_aspect('equal')
    above.set_xlabel('x [m]')
    above.set_ylabel('y [m]')
    below.axhspan(-cone, cone, color=INSIDE, linewidth=0.0, zorder=0.5, label='friction cone')
    draw_inputs(below, inputs, 's', label='push', **paper.series(1))
    below.plot(force['time_s'], force['angle_rad'], label='contact force', **paper.series(0))
    below.plot(impulses['time_s'], impulses['angle_rad'], 'D', color=paper.INK, markersize=4.5,
               label='impulse of a switch', clip_on=False, zorder=4.0)
    below.set_xlim(0.0, path['time_s'][-1])
    below.set_ylabel('angle to the normal [rad]')
    below.legend(loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=4, borderaxespad=0.2)


def _cone(axes, path, time, cone):
    x, y, normal = (np.interp(time, path['time_s'], path[name])
                    for name in ('contact_x_m', 'contact_y_m', 'normal_rad'))
    turns = normal + math.pi + np.linspace(-cone, cone, 20)
    axes.fill([x, *(x + CONE * np.cos(turns))], [y, *(y + CONE * np.sin(turns))],
              facecolor=INSIDE, edgecolor=paper.GREY, linewidth=0.5, zorder=2.0, alpha=0.8)


STUDIES = (
    Study('3.6', 'Push and contact force in the friction cone', (*MAKING, SPEED),
          compute, draw,
          'The push stays in the friction cone (sectors), of which it uses {push:.1f}, the '
          'contact force {force:.1f}; the impulses of {outside:.0f} of the {switches:.0f} '
          'switches lie outside, that of the first touch inside.',
          'The force has about the direction in which the friction centre moves, which leans less '
          'than the push at the contact; a jump of the push is a blow to the side that hardly '
          'presses on the box, and the contact bears it only spread, over up to {blend:.0f} cm.',
          (6.4, 6.0)),)
