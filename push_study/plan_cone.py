"""Push and contact force of a plan against the friction cone."""

import math

import numpy as np
from push_model.constant_angles import push_at_angles
from push_planner.solver import plan
from push_study import paper
from push_study.plan_scene import (draw_inputs, draw_outlines, draw_push, GOAL, input_table,
                                   path_table, poses_at, push_problem, SEGMENTS, SPEED)
from push_study.scenes import BOX, box
from push_study.study import Finding, Outcome, Parameter, Study
from scipy.optimize import brentq

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
    found = plan(push_problem(values, values.speed, values.segments, angle_limit='angle',
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


def compute_speeds(values, batch):
    """
    Plan the push at each speed without any limit.

    :param values: ``Values``.
    :param batch: not used.
    :return: ``Outcome``.
    """
    cone, tables, rows = math.atan(values.contact_friction), {}, []
    for speed in values.speeds:
        found = _unlimited(values, speed)
        inputs, touch = input_table(found), found.switches[0]
        tables[f'inputs_{speed:g}'] = inputs
        rows.append((speed, _steepest(inputs['rho_rad']), cone * found.verify().friction_usage,
                     abs(math.atan2(touch.tangential_impulse, touch.normal_impulse))))
    names = ('speed_m_s', 'push_rad', 'force_rad', 'touch_rad')
    table = tables['steepest'] = dict(zip(names, map(np.array, zip(*rows))))
    return Outcome(tables, {
        'cone': Finding(cone, 'rad', 'half-angle of the friction cone'),
        'leaves': Finding(_leaving_speed(values, cone), 'm/s', 'speed above which the push leaves '
                          'the cone'),
        'slowest': Finding(float(table['push_rad'][0]), 'rad', 'greatest pushing angle at the '
                           'lowest speed'),
        'fastest': Finding(float(table['push_rad'][-1]), 'rad', 'the same at the highest'),
        'friction_slowest': Finding(math.tan(table['force_rad'][0]), '', 'contact friction that '
                                    'the force takes at the lowest speed'),
        'friction_fastest': Finding(math.tan(table['force_rad'][-1]), '', 'the same at the '
                                    'highest')})


def _unlimited(values, speed):
    return plan(push_problem(values, speed, values.segments, angle_limit='none',
                             cone_margin=1.0))


def _steepest(angles):
    return float(np.abs(angles).max())


def _leaving_speed(values, cone):
    """Speed at which the greatest pushing angle is that of the cone [m/s]; 0 where none is."""
    def beyond(speed):
        return _steepest(np.array(_unlimited(values, speed).pushing_angles)) - cone

    low, high = values.speeds[0], values.speeds[-1]
    if beyond(low) * beyond(high) > 0.0:
        return 0.0
    return float(brentq(beyond, low, high, xtol=1e-3))


def draw_speeds(figure, outcome, values):
    """
    Draw inputs, and the steepest angles over the speed.

    :param figure: matplotlib figure.
    :param outcome: the ``Outcome``.
    :param values: ``Values``.
    """
    inputs, steepest = figure.subplots(1, 2, width_ratios=(1.2, 1.0))
    cone = outcome.findings['cone'].value
    inputs.axhspan(-cone, cone, color=INSIDE, linewidth=0.0, zorder=0.5)
    for number, speed in enumerate(values.speeds[::2]):
        draw_inputs(inputs, outcome.tables[f'inputs_{speed:g}'], label=f'{speed:g} m/s',
                    **paper.series(number))
    inputs.legend(loc='lower right')
    table = outcome.tables['steepest']
    steepest.axhspan(0.0, cone, color=INSIDE, linewidth=0.0, zorder=0.5, label='friction cone')
    for number, (name, label) in enumerate((('push', 'push'), ('force', 'contact force'),
                                            ('touch', 'impulse of the touch'))):
        steepest.plot(table['speed_m_s'], table[f'{name}_rad'], label=label,
                      **paper.series(number))
    steepest.set_xlim(0.0, values.speeds[-1])
    steepest.set_ylim(0.0, 1.15 * max(table['push_rad']))
    steepest.set_xlabel('speed [m/s]')
    steepest.set_ylabel('greatest angle to the normal [rad]')
    steepest.legend(loc='upper left')


STUDIES = (
    Study('3.6', 'Push and contact force in the friction cone', (*MAKING, SPEED),
          compute, draw,
          'The push stays in the friction cone (sectors), of which it uses {push:.1f}, the '
          'contact force {force:.1f}; the impulses of {outside:.0f} of the {switches:.0f} '
          'switches lie outside, that of the first touch inside.',
          'The force has about the direction in which the friction centre moves, which leans less '
          'than the push at the contact; a jump of the push is a blow to the side that hardly '
          'presses on the box, and the contact bears it only spread, over up to {blend:.0f} cm.',
          (6.4, 6.0)),
    Study('3.7', 'Raising the velocity where the pushing angle is not limited',
          (*MAKING, Parameter('speeds', 'm/s', 'speeds of the contact')),
          compute_speeds, draw_speeds,
          'The greatest angle of the push grows from {slowest:.2f} rad to {fastest:.2f} rad and '
          'leaves the friction cone above {leaves:.2f} m/s; the force stays in it, but the '
          'friction that it takes grows from {friction_slowest:.2f} to {friction_fastest:.2f}.',
          'The faster the push, the more inertia holds against the turn, and the further it must '
          'aim beside the friction centre; the force leans less, as the friction centre does not '
          'move to the side as much as the contact.'))
