"""Tables and picture of the predicted recordings."""

import math
from pathlib import Path
from typing import Callable, Sequence

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from studies.framework import plot_style
from studies.recordings.block import PATCH
from studies.recordings.prediction import Errors, Method, RecordingReport
from studies.recordings.repeats import Repeats

MILLIMETRES = 1e3
# Median, and what 90 of 100 stay below.
QUANTILES = (0.5, 0.9)
Write = Callable[[Sequence[RecordingReport]], str]


def page(reports: Sequence[RecordingReport], picture: str) -> str:
    """
    Write the tables as Markdown.

    :param reports: of all recordings.
    :param picture: link to the picture.
    :return: text.
    """
    columns: list[tuple[str, Write]] = [
        (method.value, lambda chosen, method=method: _ends(chosen, method)) for method in Method]
    lines = _table('end of a push: median (90 of 100)', reports, columns)
    forces: list[tuple[str, Write]] = [
        (method.value, lambda chosen, method=method: _forces(chosen, method))
        for method in (Method.UNFITTED, Method.IDENTIFIED)]
    lines += ['', *_table('direction of the force, size over the recorded one', reports, forces)]
    lines += ['', *_identifications(reports)]
    return '\n'.join([*lines, '', f'![Errors of the predicted ends]({picture})', ''])


def repeats_text(repeats: Repeats) -> str:
    """Write how well pushes repeat."""
    return (f'{len(repeats.position)} repeats of {repeats.cases} pushes, of '
            f'{MILLIMETRES * repeats.travel:.0f} mm in the median, end '
            f'{_pair(MILLIMETRES * repeats.position)} mm and '
            f'{_pair(np.degrees(repeats.heading))}° from the mean of their case: median (90 of '
            '100).')


def _is_patch(report: RecordingReport) -> bool:
    return report.recording.name.endswith(PATCH)


def _row(cells: Sequence[str]) -> str:
    return f'| {" | ".join(cells)} |'


def _table(head: str, reports: Sequence[RecordingReport],
           columns: Sequence[tuple[str, Write]]) -> list[str]:
    """Write a row for each recording, and one for each group of them."""
    identified = [one for one in reports if one.identification]
    held_back = [one for one in reports if not one.identification]
    on_feet = [one for one in held_back if not _is_patch(one)]
    rows = [(_short(one.recording.name), [one]) for one in reports]
    rows += [(name, chosen) for name, chosen in (
        ('**sets that identify**', identified), ('**held back, on feet**', on_feet),
        ('**held back, without feet**', [one for one in held_back if _is_patch(one)]),
        ('**all on feet**', [*identified, *on_feet])) if chosen]
    return [_row([head, *(name for name, _ in columns)]), _row(['---'] * (1 + len(columns))),
            *(_row([name, *(write(chosen) for _, write in columns)]) for name, chosen in rows)]


def _ends(reports: Sequence[RecordingReport], method: Method) -> str:
    errors = pooled(reports, method)
    return (f'{_pair(MILLIMETRES * errors.position)} mm, '
            f'{_pair(np.degrees(errors.heading))}°')


def _forces(reports: Sequence[RecordingReport], method: Method) -> str:
    directions, ratios = (np.concatenate(column) for column in zip(
        *(one.forces[method] for one in reports)))
    return f'{_pair(np.degrees(directions))}°, {np.median(ratios):.2f}'


def _identifications(reports: Sequence[RecordingReport]) -> list[str]:
    """Write what was identified, with 95 % intervals."""
    estimates = [(one.recording.name, one.identification) for one in reports
                 if one.identification]
    friction = estimates[0][1].contact_friction
    lines = [f'Identified contact friction of rod and block: {friction.value:.2f} '
             f'({friction.low:.2f} to {friction.high:.2f}).', '',
             _row(['identified from five pushes', 'centre of friction x, y [mm]', 'c^2 over that '
                   'of statics', 'friction as statics has it']), _row(['---'] * 4)]
    for name, estimate in estimates:
        center = [f'{MILLIMETRES * interval.value:.1f} ({MILLIMETRES * interval.low:.1f} to '
                  f'{MILLIMETRES * interval.high:.1f})'
                  for interval in (estimate.friction_center_x, estimate.friction_center_y)]
        ratio = estimate.c_squared_ratio
        lines.append(_row([_short(name), ', '.join(center), f'{ratio.value:.2f} ({ratio.low:.2f} '
                           f'to {ratio.high:.2f})', 'no' if estimate.is_free else 'yes']))
    return lines


def save_picture(reports: Sequence[RecordingReport], path: Path) -> None:
    """
    Draw how many pushes end within an error.

    :param reports: of all recordings.
    :param path: of the PNG file.
    """
    with plot_style.applied():
        figure = Figure(figsize=(7.6, 3.6), layout='constrained')
        FigureCanvasAgg(figure)
        left, right = figure.subplots(1, 2, sharey=True)
        for index, method in enumerate(Method):
            errors = pooled(reports, method)
            style = plot_style.series(index)
            fractions = np.arange(1, len(errors.position) + 1) / len(errors.position)
            left.plot(np.sort(MILLIMETRES * errors.position), fractions, label=method.value,
                      **style)
            right.plot(np.sort(np.degrees(errors.heading)), fractions, **style)
        for axes, label, limit in ((left, 'error of the end [mm]', 10.0),
                                   (right, 'error of the heading [deg]', 5.0)):
            axes.set_xlabel(label)
            axes.set_xlim(0.0, limit)
            axes.set_ylim(0.0, 1.0)
        left.set_ylabel('fraction of the pushes')
        left.legend(loc='lower right')
        figure.savefig(path, dpi=plot_style.DPI, metadata={'Software': None})


def pooled(reports: Sequence[RecordingReport], method: Method) -> Errors:
    """
    Join the errors of recordings.

    :param reports: of the recordings.
    :param method: that predicts.
    """
    return Errors(*(np.concatenate(column) for column in zip(
        *(one.errors[method] for one in reports))))


def _pair(values: FloatArray) -> str:
    median, high = (float(np.quantile(values, quantile)) for quantile in QUANTILES)
    digits = 1 if high >= 1.0 else max(0, 1 - math.floor(math.log10(max(high, 1e-9))))
    return f'{median:.{digits}f} ({high:.{digits}f})'


def _short(name: str) -> str:
    """Name floor and feet as a reader finds them."""
    floor, *coordinates = name.split('_')
    if coordinates == [PATCH]:
        return f'{floor}, without feet'
    return f'{floor}, feet ' + ' '.join(
        f'({x}, {y})' for x, y in zip(coordinates[:3], coordinates[3:]))
