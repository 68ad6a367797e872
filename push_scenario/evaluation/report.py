"""The table that a replay prints: one column per run."""

import math

from push_scenario.evaluation.metrics import measure

TITLES = {'open_loop': 'open loop', 'feedback': 'feedback', 'mpc': 'mpc'}
ROWS = (
    ('final position error', 'mm', lambda m: f'{1e3 * m.position_error:.1f}'),
    ('final heading error', 'deg', lambda m: f'{math.degrees(m.heading_error):+.2f}'),
    ('time', 's', lambda m: f'{m.time:.2f}'),
    ('time in contact', 's', lambda m: f'{m.contact_time:.2f}'),
    ('path length', 'm', lambda m: f'{m.path_length:.3f}'),
    ('path length against the plan', '%', lambda m: f'{1e2 * m.path_ratio:.1f}'),
    ('largest distance from the plan', 'mm', lambda m: f'{1e3 * m.max_deviation:.1f}'),
    ('sliding at the contact', 'mm', lambda m: f'{1e3 * m.slip:.1f}'),
    ('within bounds', '', lambda m: 'yes' if m.within_bounds else 'no'),
)
WALL_ROWS = (
    ('pose to command, median', 'ms', lambda r: f'{1e3 * r.latency_median:.2f}'),
    ('pose to command, 99 of 100', 'ms', lambda r: f'{1e3 * r.latency_p99:.2f}'),
    ('simulated over wall time', '', lambda r: f'{r.speed_up:.1f}'),
)


def table(results):
    """
    Compare runs of one scenario, as aligned plain text.

    Runs over DDS also tell how fast they went.

    :param results: the ``Result`` of each run, one or more.
    :return: lines without a newline at the end.
    """
    scenario = results[0].scenario
    metrics = [measure(result) for result in results]
    lines = [['', ''] + [TITLES.get(r.control_law, r.control_law) for r in results] + ['bound']]
    limits = {'final position error': f'{1e3 * scenario.bounds.position_error:.1f}',
              'final heading error': f'{math.degrees(scenario.bounds.heading_error):.2f}'}
    for title, unit, text in ROWS:
        lines.append([title, f'[{unit}]' if unit else '']
                     + [text(m) if m else '-' for m in metrics] + [limits.get(title, '')])
    lines += [[title, f'[{unit}]' if unit else '']
              + [text(r) if r.tape else '-' for r in results] + ['']
              for title, unit, text in WALL_ROWS if all(hasattr(r, 'speed_up') for r in results)]
    lines.append(['outcome', ''] + [result.outcome for result in results] + [''])
    notes = [f'{TITLES.get(r.control_law, r.control_law)}: {r.reason}'
             for r in results if r.reason and r.outcome != 'done']
    return '\n'.join([scenario.name, *aligned(lines), *notes])


def aligned(lines):
    """
    Pad cells: the first two columns to the left, the others to the right.

    :param lines: lists of texts, one per line, the first of them titles.
    :return: lines of text, and a rule below the first.
    """
    """
    Pad cells: the first two columns to the left, the others to the right.

    :param lines: lists of texts, one per line, the first of them titles.
    :return: lines of text, and a rule below the first.
    """
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    for number, line in enumerate(lines):
        cells = [cell.ljust(width) if column < 2 else cell.rjust(width)
                 for column, (cell, width) in enumerate(zip(line, widths))]
        yield '  '.join(cells).rstrip()
        if number == 0:
            yield '-' * (sum(widths) + 2 * len(widths) - 2)
