"""Where one push can bring each object, and how surely."""

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from push_primitives.selection import interpolate_displacements
from push_primitives.store import PushPrimitives
from studies.framework import plot_style
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.primitives.setup import (
    COMMON, draw_start, LENGTHS, MILLIMETRES, named_object, named_primitives, OBJECTS, ROBOT,
)

# Diverging, and dark at both ends, so that large rotations survive grey print.
COLORS = 'RdYlBu'
# Less counts as no rotation [rad]; chosen.
NOTICEABLE_TURN = math.radians(1.0)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Look up the effects of all primitives."""
    tables: dict[str, Table] = {}
    turns: dict[str, float] = {}
    radii: dict[str, float] = {}
    for name in values.objects:
        primitives = named_primitives(name, values.robot)
        tables[name] = table = _effects(primitives, np.array(values.lengths))
        turns[name], radii[name] = _largest_turn(table, values), _tightest_radius(table)
    sharpest, widest = min(radii, key=lambda name: radii[name]), max(radii.values())
    findings = {
        'primitives': Finding(sum(map(len, (table['x_m'] for table in tables.values())))
                              / len(values.lengths), '', 'number of primitives of all objects'),
        'objects': Finding(len(tables), '', 'number of objects'),
        'least_turn': Finding(min(turns.values()), 'deg', 'largest mean rotation by the longest '
                              'push, least of all objects'),
        'largest_turn': Finding(max(turns.values()), 'deg', 'the same, most of all objects'),
        'tightest_radius': Finding(radii[sharpest], 'm', 'least displacement over rotation [rad], '
                                   f'least of all objects ({sharpest})'),
        'widest_radius': Finding(widest, 'm', 'the same, most of all objects')}
    for label, length in (('short', min(values.lengths)), ('long', max(values.lengths))):
        findings.update(_deviations(list(tables.values()), label, length))
    return Outcome(tables, findings)


def _deviations(tables: list[Table], label: str, length: float) -> dict[str, Finding]:
    """Find the median deviations of all pushes of a length."""
    def median(column: str) -> float:
        values = [table[column][np.isclose(table['length_m'], length)] for table in tables]
        return float(np.median(np.concatenate(values)))

    return {
        f'{label}_length': Finding(length, 'm', f'{label}est length'),
        f'{label}_spread': Finding(
            MILLIMETRES * median('spread_m'), 'mm', 'median over all pushes of that length of the '
            'standard deviation of the position'),
        f'{label}_turn_spread': Finding(
            math.degrees(median('theta_deviation_rad')), 'deg', 'the same of the rotation')}


def _effects(primitives: PushPrimitives, lengths: FloatArray) -> Table:
    table = primitives.table
    effects = interpolate_displacements(table.lengths, table.displacements[:, COMMON], lengths)
    count = len(effects)
    # (primitives and lengths, guesses, 3)
    effects = effects.transpose(0, 2, 1, 3).reshape(count * len(lengths), -1, 3)
    means = effects.mean(axis=1)
    away = effects - means[:, None]
    covariances = np.einsum('nki,nkj->nij', away[..., :2], away[..., :2]) / effects.shape[1]
    variances, axes = np.linalg.eigh(covariances)
    deviations = np.sqrt(np.maximum(variances, 0.0))
    return {
        'length_m': np.tile(lengths, count),
        'tilt_rad': np.repeat(table.approach_angles, len(lengths)),
        'curvature_per_m': np.repeat(table.curvatures, len(lengths)),
        'face': np.repeat(table.faces, len(lengths)),
        'x_m': means[:, 0], 'y_m': means[:, 1], 'theta_rad': means[:, 2],
        'major_deviation_m': deviations[:, 1], 'minor_deviation_m': deviations[:, 0],
        'major_direction_rad': np.arctan2(axes[:, 1, 1], axes[:, 0, 1]),
        'spread_m': np.sqrt(variances.sum(axis=1)),
        'theta_deviation_rad': away[..., 2].std(axis=1)}


def _largest_turn(table: Table, values: Values) -> float:
    """Find the largest mean rotation by the longest push [deg]."""
    longest = np.isclose(table['length_m'], max(values.lengths))
    return math.degrees(float(np.abs(table['theta_rad'][longest]).max()))


def _tightest_radius(table: Table) -> float:
    """Find the least displacement over rotation, of pushes that rotate noticeably [m]."""
    turns = np.abs(table['theta_rad'])
    moved = np.hypot(table['x_m'], table['y_m'])
    turning = turns > NOTICEABLE_TURN
    return float((moved[turning] / turns[turning]).min())


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw for each object the mean displacements, coloured by rotation, with their spread."""
    largest = max(float(np.abs(table['theta_rad']).max()) for table in outcome.tables.values())
    norm = Normalize(-math.degrees(largest), math.degrees(largest))
    columns = 2 if len(values.objects) > 1 else 1
    rows = math.ceil(len(values.objects) / columns)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes, name in zip(panels.flat, values.objects):
        _draw_panel(axes, outcome.tables[name], name, norm)
        axes.label_outer()
    for axes in panels.flat[len(values.objects):]:
        axes.set_visible(False)
    bar = figure.colorbar(ScalarMappable(norm, COLORS), ax=panels.ravel().tolist(), shrink=0.7,
                          aspect=35)
    bar.set_label('mean rotation [deg]; ellipses: one standard deviation over friction')


def _draw_panel(axes: Axes, table: Table, name: str, norm: Normalize) -> None:
    centers = np.stack([table['x_m'], table['y_m']], axis=-1)
    ellipses: Any = EllipseCollection(
        2.0 * table['major_deviation_m'], 2.0 * table['minor_deviation_m'],
        np.degrees(table['major_direction_rad']), units='xy', offsets=centers,
        offset_transform=axes.transData, facecolors='none', edgecolors=plot_style.GREY,
        linewidths=0.4, alpha=0.45)
    axes.add_collection(ellipses)
    axes.scatter(table['x_m'], table['y_m'], s=9.0, c=np.degrees(table['theta_rad']), cmap=COLORS,
                 norm=norm, edgecolors=plot_style.INK, linewidths=0.25, zorder=3.0)
    draw_start(axes, named_object(name), color=plot_style.GREY, linewidth=1.0,
               linestyle=plot_style.DASHED, zorder=2.0)
    axes.set_aspect('equal')
    axes.set_title(name.replace('_', ' '), loc='left')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')


STUDIES = (
    Study('P.5', 'Where one straight push brings an object', (OBJECTS, ROBOT, LENGTHS), compute,
          draw,
          '{primitives:.0f} pushes on lines and arcs, of several lengths, move {objects:.0f} '
          'objects to all sides. The longest turn them by up to {least_turn:.0f} to '
          '{largest_turn:.0f} degrees; the tightest turns have radii of {tightest_radius:.2f} to '
          '{widest_radius:.2f} m.',
          'Unknown friction adds up along a push. The median deviation is {short_spread:.1f} mm '
          'and {short_turn_spread:.1f} degrees after {short_length:g} m, {long_spread:.0f} mm and '
          '{long_turn_spread:.0f} degrees after {long_length:g} m. So the last pushes of a task '
          'must be short.', (8.6, 8.2)),)
