"""What a higher speed does to the push and the contact force where nothing limits them."""

import math
from typing import Any

from matplotlib.figure import Figure
import numpy as np
from push_planner.steered.plan import Plan
from push_planner.steered.planner import plan_push
from push_planner.steered.verification.verification import verify
from scipy.optimize import brentq
from studies.chapter3.friction_cone import PARAMETERS
from studies.chapter3.setup import (
    draw_center, draw_inputs, draw_outlines, input_table, path_table, poses_at, push_problem,
)
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

# Chosen: resolution of the speed at which the push leaves the cone [m/s].
SPEED_RESOLUTION = 1e-3
COLUMNS = ('speed_m_s', 'push_rad', 'force_rad', 'first_touch_rad')


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan the push at each speed without any limit on its angle."""
    cone = math.atan(values.contact_friction)
    tables: dict[str, Table] = {}
    rows: list[tuple[float, ...]] = []
    for speed in values.speeds:
        plan = _unlimited_plan(values, speed)
        inputs, first_touch = input_table(plan), plan.switches[0]
        tables[f'inputs_{speed:g}'] = inputs
        tables[f'path_{speed:g}'] = path_table(plan.trajectory)
        impulse_angle = math.atan2(first_touch.tangential_impulse, first_touch.normal_impulse)
        rows.append((speed, float(np.abs(inputs['rho_rad']).max()),
                     cone * verify(plan).friction_usage, abs(impulse_angle)))
    table = tables['steepest'] = dict(zip(COLUMNS, map(np.array, zip(*rows))))
    return Outcome(tables, {
        'cone': Finding(cone, 'rad', 'half-angle of the friction cone'),
        'leaves': Finding(_leaving_speed(values, cone), 'm/s', 'speed above which the push leaves '
                          'the cone'),
        'slowest': Finding(float(table['push_rad'][0]), 'rad', 'greatest pushing angle at the '
                           'lowest speed'),
        'fastest': Finding(float(table['push_rad'][-1]), 'rad', 'the same at the highest speed'),
        'friction_slowest': Finding(math.tan(table['force_rad'][0]), '', 'contact friction that '
                                    'the force needs at the lowest speed'),
        'friction_fastest': Finding(math.tan(table['force_rad'][-1]), '', 'the same at the '
                                    'highest speed')})


def _unlimited_plan(values: Values, speed: float) -> Plan:
    return plan_push(push_problem(values, speed, values.segments, angle_limit='none',
                                  cone_margin=1.0))


def _leaving_speed(values: Values, cone: float) -> float:
    """Find the speed at which the greatest angle is that of the cone [m/s]; 0 where none is."""
    def excess(speed: float) -> float:
        angles = np.array(_unlimited_plan(values, speed).pushing_angles)
        return float(np.abs(angles).max()) - cone

    low, high = values.speeds[0], values.speeds[-1]
    if excess(low) * excess(high) > 0.0:
        return 0.0
    speed: Any = brentq(excess, low, high, xtol=SPEED_RESOLUTION)
    return float(speed)


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw paths, inputs, and the steepest angles over the speed."""
    panels = figure.subplot_mosaic('AA;BC', height_ratios=(1.0, 1.3), width_ratios=(1.2, 1.0))
    above, left, right = panels['A'], panels['B'], panels['C']
    first = outcome.tables[f'path_{values.speeds[0]:g}']
    draw_outlines(above, box(values), poses_at(first, first['time_s'][[0, -1]]))
    cone = outcome.findings['cone'].value
    left.axhspan(-cone, cone, color=plot_style.REGION, linewidth=0.0, zorder=0.5)
    # Every second one, as neighbours hide one another.
    for index, speed in enumerate(values.speeds[::2]):
        style = plot_style.series(index)
        draw_center(above, outcome.tables[f'path_{speed:g}'], label=f'{speed:g} m/s', **style)
        draw_inputs(left, outcome.tables[f'inputs_{speed:g}'], **style)
    above.legend(loc='upper left', bbox_to_anchor=(1.0, 1.0))
    table = outcome.tables['steepest']
    right.axhspan(0.0, cone, color=plot_style.REGION, linewidth=0.0, zorder=0.5,
                  label='friction cone')
    for index, (name, label) in enumerate((('push', 'push'), ('force', 'contact force'),
                                           ('first_touch', 'impulse of first touch'))):
        right.plot(table['speed_m_s'], table[f'{name}_rad'], label=label,
                   **plot_style.series(index))
    right.set_xlim(0.0, values.speeds[-1])
    right.set_ylim(0.0, 1.15 * max(table['push_rad']))
    right.set_xlabel('speed [m/s]')
    right.set_ylabel('greatest angle to the normal [rad]')
    right.legend(loc='upper left', fontsize=7.5)


STUDIES = (
    Study('3.8', 'Trajectories and inputs at growing velocity, without limit on the pushing angle',
          (*PARAMETERS, Parameter('speeds', 'm/s', 'speeds of the contact')),
          compute, draw,
          'The greatest pushing angle grows from {slowest:.2f} to {fastest:.2f} rad and leaves '
          'the friction cone above {leaves:.2f} m/s. The force stays inside; its friction grows '
          'from {friction_slowest:.2f} to {friction_fastest:.2f}.',
          'Against more inertia the push aims further from the centre of friction.', (6.8, 5.6)),)
