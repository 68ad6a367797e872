"""Point robot: the push to the same goal at several speeds."""

from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_planner.steered.planner import plan_push
from studies.chapter3.setup import (
    draw_center, draw_difference, draw_inputs, draw_outlines, input_table, path_difference,
    path_table, poses_at, push_problem, SEGMENTS, SETUP,
)
from studies.framework import plot_style
from studies.framework.box import box
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table

PERCENT = 100.0
CENTIMETRES = 100.0


def compute(values: Values, _: RunJobs) -> Outcome:
    """Plan the push at each speed."""
    tables: dict[str, Table] = {}
    plans = [plan_push(push_problem(values, speed, values.segments)) for speed in values.speeds]
    for speed, plan in zip(values.speeds, plans):
        tables[f'path_{speed:g}'] = path_table(plan.trajectory)
        tables[f'inputs_{speed:g}'] = input_table(plan)
    distances = np.array([plan.segment_ends[-1] for plan in plans])
    angles = [tables[f'inputs_{speed:g}']['rho_rad'] for speed in values.speeds]
    slowest = tables[f'path_{values.speeds[0]:g}']
    deviations = [float(path_difference(tables[f'path_{speed:g}'], slowest).max())
                  for speed in values.speeds]
    tables['distances'] = {'speed_m_s': values.speeds, 'distance_m': distances,
                           'duration_s': distances / np.array(values.speeds),
                           'path_from_slowest_m': deviations}
    return Outcome(tables, {
        'slowest': Finding(float(distances[0] / values.speeds[0]), 's',
                           'duration at the lowest speed'),
        'fastest': Finding(float(distances[-1] / values.speeds[-1]), 's',
                           'duration at the highest speed'),
        'growth': Finding(PERCENT * float(distances[-1] / distances[0] - 1.0), '%',
                          'longer distance of the contact at the highest speed than at the '
                          'lowest'),
        'deviation': Finding(CENTIMETRES * deviations[-1], 'cm', 'greatest distance between the '
                             'paths of the middle at the highest and the lowest speed'),
        'angle_middle': Finding(_largest_difference(angles[len(angles) // 2], angles[0]), 'rad',
                                'greatest difference of the input at the middle speed from that '
                                'at the lowest'),
        'angle_fastest': Finding(_largest_difference(angles[-1], angles[0]), 'rad',
                                 'the same at the highest speed')})


def _largest_difference(angles: FloatArray, others: FloatArray) -> float:
    return float(np.abs(angles - others).max())


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw paths and inputs."""
    panels = figure.subplot_mosaic('AD;BB', height_ratios=(1.4, 1.0), width_ratios=(1.5, 1.0))
    slowest = outcome.tables[f'path_{values.speeds[0]:g}']
    draw_outlines(panels['A'], box(values), poses_at(slowest, slowest['time_s'][[0, -1]]))
    for index, speed in enumerate(values.speeds):
        path, inputs = outcome.tables[f'path_{speed:g}'], outcome.tables[f'inputs_{speed:g}']
        style = plot_style.series(index)
        draw_center(panels['A'], path, **style)
        if index:
            draw_difference(panels['D'], path, slowest, **style)
        draw_inputs(panels['B'], inputs, label=f'{speed:g} m/s, {inputs["end_s"][-1]:.1f} s',
                    **style)
    panels['D'].set_ylim(bottom=0.0)
    panels['D'].set_title(f'against {values.speeds[0]:g} m/s', loc='left')
    panels['B'].legend(loc='lower right')


STUDIES = (Study(
    '3.6', 'Point robot: the same goal at several speeds',
    (*SETUP, SEGMENTS, Parameter('speeds', 'm/s', 'speeds of the contact', [0.05, 0.25, 0.5])),
    compute, draw,
    'From the lowest to the highest speed the distance grows by {growth:.1f}%; the duration falls '
    'from {slowest:.1f} to {fastest:.1f} s. Inputs differ by {angle_middle:.2f} rad, at the '
    'highest speed by {angle_fastest:.2f} rad.',
    'Inertia demands larger angles for the same path, to within {deviation:.0f} cm.', (7.6, 5.0)),)
