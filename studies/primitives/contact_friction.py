"""What the friction of the contact changes."""

import math
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_primitives.store import reference_object
from push_primitives.table import build_table, FrictionSamples, PrimitiveTable, sample_friction
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.primitives.setup import (
    effects_at, find_primitives, MILLIMETRES, named_object, named_robot, OBJECT, ROBOT,
)

PARAMETERS = (
    OBJECT, ROBOT,
    Parameter('frictions', '', 'coefficients of contact friction'),
    Parameter('guesses', '', 'number of guesses of the friction of the supports, for each'),
    Parameter('length', 'm', 'driven length'),
    Parameter('offset', 'm', 'distance of the pushes beside the middle from it'),
    Parameter('tilt', 'rad', 'tilt of the tilted pushes'))


class ShownPush(NamedTuple):
    """
    A push of the figure.

    :param name: of its table.
    :param label: for the legend.
    :param offset: of its place from the middle, over the parameter ``offset``.
    :param tilt: of its direction, over the parameter ``tilt``.
    """

    name: str
    label: str
    offset: float
    tilt: float


PUSHES = (ShownPush('middle', 'middle', 0.0, 0.0), ShownPush('beside', 'beside', 1.0, 0.0),
          ShownPush('outward', 'beside, tilted away from the middle', 1.0, -1.0),
          ShownPush('inward', 'beside, tilted to the middle', 1.0, 1.0))


def compute(values: Values, _: RunJobs) -> Outcome:
    """Simulate the pushes for every friction and sample."""
    obj = reference_object(named_object(values.object))
    table = build_table(obj, named_robot(values.robot).radius, lengths=(0.0, values.length),
                        friction_samples=_samples(sample_friction(obj), values))
    tables = {push.name: _rows(table, push, values) for push in PUSHES}
    return Outcome(tables, _findings(tables, values))


def _samples(samples: FrictionSamples, values: Values) -> FrictionSamples:
    """Combine every contact friction with the same samples of the supports."""
    count, frictions = int(values.guesses), len(values.frictions)
    return FrictionSamples(np.tile(samples.support_factors[:count], (frictions, 1)),
                           np.repeat(np.array(values.frictions, dtype=float), count),
                           np.tile(samples.centers[:count], (frictions, 1)))


def _rows(table: PrimitiveTable, push: ShownPush, values: Values) -> Table:
    indices = find_primitives(table, push.tilt * values.tilt)
    indices = indices[table.faces[indices] == 0]
    offsets = np.array([table.face_points[point].offset
                        for point in table.point_indices[indices].tolist()])
    index = indices[[int(np.argmin(np.abs(offsets - push.offset * values.offset)))]]
    shape = (len(values.frictions), int(values.guesses), 3)
    # Each friction apart, as if its guesses were all there are.
    parts = [effects_at(table, index, np.array([values.length]), part)
             for part in np.arange(shape[0] * shape[1]).reshape(shape[:2])]
    means = np.array([part.means[0, 0] for part in parts])
    deviations = np.array([part.deviations[0, 0] for part in parts])
    columns: Table = {'contact_friction': np.array(values.frictions, dtype=float)}
    for name, unit, axis in (('aside', 'm', 0), ('ahead', 'm', 1), ('turn', 'rad', 2)):
        columns[f'{name}_{unit}'] = means[:, axis]
        columns[f'{name}_deviation_{unit}'] = deviations[:, axis]
    return columns


def _findings(tables: dict[str, Table], values: Values) -> dict[str, Finding]:
    findings = {
        'length': Finding(values.length, 'm', 'driven length'),
        'least': Finding(min(values.frictions), '', 'least contact friction'),
        'most': Finding(max(values.frictions), '', 'largest contact friction')}
    for push in PUSHES:
        lateral = MILLIMETRES * tables[push.name]['aside_m']
        turns = np.degrees(tables[push.name]['turn_rad'])
        deviations = np.degrees(tables[push.name]['turn_deviation_rad'])
        low, high = int(np.argmin(values.frictions)), int(np.argmax(values.frictions))
        findings[f'{push.name}_low'] = Finding(
            float(turns[low]), 'deg', f'{push.label}: mean rotation at the least friction')
        findings[f'{push.name}_high'] = Finding(float(turns[high]), 'deg',
                                                'the same at the largest')
        findings[f'{push.name}_aside_low'] = Finding(
            float(lateral[low]), 'mm', 'displacement along the face at the least friction')
        findings[f'{push.name}_aside_high'] = Finding(float(lateral[high]), 'mm',
                                                      'the same at the largest')
        findings[f'{push.name}_spread'] = Finding(
            float(deviations.mean()), 'deg', 'standard deviation over the guesses of the '
            'supports, mean of all frictions')
    return findings


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw rotation and displacement over the contact friction."""
    panels = figure.subplots(1, 3)
    for axes, name, unit, scale, label in zip(
            panels, ('turn', 'aside', 'ahead'), ('rad', 'm', 'm'),
            (math.degrees(1.0), MILLIMETRES, MILLIMETRES),
            ('rotation [deg]', 'along the face [mm]', 'ahead [mm]')):
        _draw_panel(axes, outcome, f'{name}_{unit}', f'{name}_deviation_{unit}', scale)
        axes.set_title(label, loc='left')
        axes.set_xlabel('contact friction')
    figure.legend(*panels[0].get_legend_handles_labels(), loc='outside upper right', ncols=2)


def _draw_panel(axes: Axes, outcome: Outcome, mean: str, deviation: str, scale: float) -> None:
    for index, push in enumerate(PUSHES):
        table = outcome.tables[push.name]
        middle, std = scale * table[mean], scale * table[deviation]
        style = plot_style.series(index)
        axes.fill_between(table['contact_friction'], middle - std, middle + std,
                          color=style['color'], alpha=0.2, linewidth=0.0)
        axes.plot(table['contact_friction'], middle, label=push.label, **style)


STUDIES = (
    Study('P.10', 'What the friction of the contact changes', PARAMETERS, compute, draw,
          'Pushes of {length:g} m tilted to the middle and away from it move the box along the '
          'face by {inward_aside_low:.0f} and {outward_aside_low:.0f} mm at contact friction '
          '{least:g}, by {inward_aside_high:.0f} and {outward_aside_high:.0f} mm at {most:g}. The '
          'greatest rotation rises from {outward_low:.0f} to {outward_high:.0f} degrees.',
          'Without friction the contact slides, and the force is along the normal of the face. '
          'With friction it sticks, and the force follows the motion. In the middle contact '
          'friction changes nothing. There friction of the supports decides: the rotation has a '
          'standard deviation of {middle_spread:.1f} degrees, against {outward_spread:.1f} '
          'degrees in the push that turns most.', (9.2, 4.8)),)
