"""What a straight push does to each object, over place and tilt."""

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from push_primitives.table import PrimitiveTable
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.primitives.setup import (
    effects_at, find_primitives, LENGTHS, MILLIMETRES, named_primitives, OBJECT, ROBOT,
)

TILTS = Parameter('tilts', 'rad', 'directions of motion from the inward normal')
PARAMETERS = (OBJECT, ROBOT, LENGTHS, TILTS)
# Column of the tables, label, scale.
QUANTITIES = (('turn', 'rotation [deg]', math.degrees(1.0)),
              ('aside', 'along the outline [mm]', MILLIMETRES),
              ('ahead', 'ahead [mm]', MILLIMETRES))


def compute(values: Values, _: RunJobs) -> Outcome:
    """Look up the effects at the first face, or round a disc."""
    table = named_primitives(values.object, values.robot).table
    rows = [_rows(table, values, tilt) for tilt in values.tilts]
    effects: Table = {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}
    return Outcome({'effects': effects}, _findings(effects, values))


def _rows(table: PrimitiveTable, values: Values, angle: float) -> Table:
    indices = find_primitives(table, angle)
    is_round = len({point.normal for point in table.face_points}) == len(table.face_points)
    if not is_round:
        indices = indices[table.faces[indices] == 0]
    lengths = np.array(values.lengths)
    effects = effects_at(table, indices, lengths)
    offsets = [table.face_points[point].offset for point in table.point_indices[indices].tolist()]
    columns: Table = {
        'tilt_rad': np.full(len(indices) * len(lengths), angle),
        'length_m': np.tile(lengths, len(indices)), 'offset_m': np.repeat(offsets, len(lengths))}
    for name, unit, axis in (('aside', 'm', 0), ('ahead', 'm', 1), ('turn', 'rad', 2)):
        columns[f'{name}_{unit}'] = effects.means[..., axis].ravel()
        columns[f'{name}_deviation_{unit}'] = effects.deviations[..., axis].ravel()
    return columns


def _findings(effects: Table, values: Values) -> dict[str, Finding]:
    lengths, offsets, angles = (effects[name] for name in ('length_m', 'offset_m', 'tilt_rad'))
    middle = sorted(values.lengths)[len(values.lengths) // 2]
    turns, stds = np.degrees(effects['turn_rad']), np.degrees(effects['turn_deviation_rad'])
    at_length = np.isclose(lengths, middle)
    best = int(np.argmax(np.where(at_length, np.abs(turns), -1.0)))
    straight = np.isclose(angles, min(values.tilts, key=abs))
    # The place in front of the centre of friction, where a straight push turns the object least.
    balanced = straight & at_length
    balance = offsets[int(np.argmin(np.where(balanced, np.abs(turns), math.inf)))]
    central = straight & np.isclose(offsets, balance)
    # The direction leans away from the middle where tilt and offset differ in sign.
    outward = -math.degrees(float(angles[best])) * math.copysign(1.0, float(offsets[best]))
    longest = np.isclose(lengths, max(values.lengths))
    return {
        'length': Finding(middle, 'm', 'driven length of the findings'),
        'turn': Finding(float(np.abs(turns[best])), 'deg', 'largest mean rotation over it'),
        'turn_offset': Finding(MILLIMETRES * float(np.abs(offsets[best])), 'mm',
                               'distance of its place from the middle of the face'),
        'turn_tilt': Finding(outward, 'deg', 'tilt of its direction away from the middle'),
        'turn_ahead': Finding(MILLIMETRES * float(effects['ahead_m'][best]), 'mm',
                              'displacement ahead meanwhile'),
        'turn_aside': Finding(MILLIMETRES * float(np.abs(effects['aside_m'][best])), 'mm',
                              'displacement along it meanwhile'),
        'turn_spread': Finding(float(stds[best]), 'deg', 'standard deviation of that rotation'),
        'balance_offset': Finding(MILLIMETRES * float(balance), 'mm', 'place where a push along '
                                  'the normal turns the object least, from the middle'),
        'balance_spread': Finding(float(stds[central & at_length].mean()), 'deg', 'standard '
                                  'deviation of the rotation there'),
        'long_length': Finding(max(values.lengths), 'm', 'longest push'),
        'long_turn': Finding(float(np.abs(turns[longest & ~straight]).mean()), 'deg',
                             'mean rotation by tilted pushes of that length'),
        'long_spread': Finding(float(stds[central & longest].mean()), 'deg',
                               'the same after the longest push')}


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw rotation and displacement over the place, for every length and tilt."""
    effects = outcome.tables['effects']
    panels = figure.subplots(len(QUANTITIES), len(values.lengths), sharex=True, squeeze=False)
    for row, (name, label, scale) in zip(panels, QUANTITIES):
        for axes, length in zip(row, values.lengths):
            _draw_panel(axes, effects, values, length, (name, scale))
        row[0].set_ylabel(label)
    for axes, length in zip(panels[0], values.lengths):
        axes.set_title(f'after {length:g} m')
    for axes in panels[-1]:
        axes.set_xlabel('place along the outline [mm]')
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc='outside upper right',
                  ncols=len(values.tilts))


def _draw_panel(axes: Axes, effects: Table, values: Values, length: float,
                quantity: tuple[str, float]) -> None:
    name, scale = quantity
    unit = 'rad' if name == 'turn' else 'm'
    axes.axhline(0.0, color=plot_style.GREY, linewidth=0.6)
    for index, angle in enumerate(values.tilts):
        rows = np.isclose(effects['length_m'], length) & np.isclose(effects['tilt_rad'], angle)
        offsets = MILLIMETRES * effects['offset_m'][rows]
        means = scale * effects[f'{name}_{unit}'][rows]
        deviations = scale * effects[f'{name}_deviation_{unit}'][rows]
        style = plot_style.series(index)
        axes.fill_between(offsets, means - deviations, means + deviations, alpha=0.22,
                          color=style['color'], linewidth=0.0)
        axes.plot(offsets, means, label=f'tilt {math.degrees(angle):.0f} deg', linewidth=1.4,
                  **style)
    # Clearly visible differences between lengths matter more than a common scale.
    axes.margins(x=0.02)


def _polygon_study(figure: str, name: str) -> Study:
    return Study(
        figure, f'Straight pushes at a face: {name}', PARAMETERS, compute, draw,
        'A push of {length:g} m, {turn_offset:.0f} mm beside the middle of the face and tilted '
        'away from it by {turn_tilt:.0f} degrees, turns the object by {turn:.0f} degrees. It '
        'moves the object {turn_ahead:.0f} mm ahead and {turn_aside:.0f} mm along the face.',
        'Bands are one standard deviation over samples of friction: {turn_spread:.1f} degrees for '
        'that push, {balance_spread:.1f} degrees for the push along the normal that turns the '
        'object least, {long_spread:.0f} degrees over {long_length:g} m. Its line passes near the '
        'centre of friction, so friction decides to which side the object turns.', (8.4, 7.2))


STUDIES = (
    _polygon_study('P.1', 'box'), _polygon_study('P.2', 'carton'),
    _polygon_study('P.3', 'coffee table'),
    Study('P.4', 'Straight pushes at a round object: bin', PARAMETERS, compute, draw,
          'All contact points of the bin are much alike. Pushes along the normal move it straight '
          'ahead; tilted ones turn it, by {turn:.0f} degrees at most over {length:g} m and by '
          '{long_turn:.0f} degrees on average over {long_length:g} m.',
          'Pushed along the normal, a disc on a disc is in unstable equilibrium. The standard '
          'deviation of its rotation grows from {balance_spread:.1f} degrees after {length:g} m '
          'to {long_spread:.0f} degrees after {long_length:g} m.', (8.4, 7.2)))
