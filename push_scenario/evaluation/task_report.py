"""The table that the replay of a task prints: one column per run."""

import math

from push_scenario.evaluation.metrics import measure_task
from push_scenario.evaluation.report import aligned, TITLES, WALL_ROWS

ROWS = (
    ('final position error', 'mm', lambda m: f'{1e3 * m.position_error:.1f}'),
    ('final heading error', 'deg', lambda m: f'{math.degrees(m.heading_error):+.2f}'),
    ('pushes', '', lambda m: f'{m.pushes}'),
    ('recoveries', '', lambda m: f'{m.recoveries}'),
    ('time', 's', lambda m: f'{m.time:.1f}'),
    ('time in contact', 's', lambda m: f'{m.contact_time:.1f}'),
    ('time of the best single push', 's', lambda m: _or_none(m.single_time)),
    ('way of the robot', 'm', lambda m: f'{m.distance_travelled:.2f}'),
    ('way of the object', 'm', lambda m: f'{m.object_way:.2f}'),
    ('robot clear of the object', 'mm', lambda m: f'{1e3 * m.gap:.0f}'),
    ('clear of the map', '', lambda m: 'yes' if m.within_map else 'no'),
    ('within bounds', '', lambda m: 'yes' if m.within_bounds else 'no'),
)


def task_table(results):
    """
    Compare runs of one task, as aligned plain text.

    :param results: the ``TaskResult`` of each run, one or more.
    :return: lines without a newline at the end.
    """
    scenario = results[0].scenario
    metrics = [measure_task(result) for result in results]
    limits = {'final position error': f'{1e3 * scenario.bounds.position_error:.1f}',
              'final heading error': f'{math.degrees(scenario.bounds.heading_error):.2f}',
              'robot clear of the object': f'{1e3 * scenario.task.drive.clearance:.0f}'}
    lines = [['', ''] + [TITLES[result.control_law] for result in results] + ['bound']]
    for title, unit, text in ROWS:
        if title == 'clear of the map' and scenario.task.map is None:
            continue
        lines.append([title, f'[{unit}]' if unit else ''] + [text(m) for m in metrics]
                     + [limits.get(title, '')])
    lines += [[title, f'[{unit}]' if unit else ''] + [text(r) for r in results] + ['']
              for title, unit, text in WALL_ROWS if all(hasattr(r, 'speed_up') for r in results)]
    lines.append(['outcome', ''] + [result.outcome for result in results] + [''])
    notes = [f'{TITLES[r.control_law]}, {change.time:.1f} s, {change.state.value}: {change.reason}'
             for r in results for change in r.history[1:] if change.reason]
    notes += [f'{TITLES[r.control_law]}: {r.reason}' for r in results if r.reason]
    return '\n'.join([scenario.name, *aligned(lines), *notes])


def _or_none(seconds):
    if math.isnan(seconds):
        return '-'
    return f'{seconds:.1f}' if math.isfinite(seconds) else 'none'
