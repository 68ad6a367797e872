"""Tables and picture of the predicted recordings."""

import math
from pathlib import Path
from typing import Sequence

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray
from studies.framework import plot_style
from studies.recordings.prediction import (
    Errors, FITTED, PLANT, QUASI_STATIC, RecordingReport, UNFITTED,
)

MILLIMETRES = 1e3
# Median, and what 90 of 100 stay below.
QUANTILES = (0.5, 0.9)
KINDS = ((UNFITTED, QUASI_STATIC), (UNFITTED, PLANT), (FITTED, QUASI_STATIC), (FITTED, PLANT))


def select(reports: Sequence[RecordingReport], parameters: str, model: str) -> list[Errors]:
    """
    Select errors.

    :param reports: of all recordings.
    :param parameters: ``UNFITTED`` or ``FITTED``.
    :param model: ``QUASI_STATIC`` or ``PLANT``.
    :return: those of each recording.
    """
    return [errors for one in reports for errors in one.errors
            if (errors.parameters, errors.model) == (parameters, model)]


def page(reports: Sequence[RecordingReport], picture: str) -> str:
    """
    Write the tables as Markdown.

    :param reports: of all recordings.
    :param picture: link to the picture.
    :return: text.
    """
    names = [_short(one.recording.name) for one in reports] + ['all']
    lines = [_row('end of a push: median (90 of 100)', names), _row('---', ['---'] * len(names))]
    lines += [_end_row(reports, parameters, model) for parameters, model in KINDS]
    lines += [_force_row(reports, parameters) for parameters in (UNFITTED, FITTED)]
    lines += ['', '| identified from five pushes | centre of friction x, y [mm] | contact '
              'friction |', '| --- | --- | --- |']
    lines += map(_identification_row, reports)
    return '\n'.join([*lines, '', f'![Errors of the predicted ends]({picture})', ''])


def _row(head: str, cells: Sequence[str]) -> str:
    return f'| {head} | {" | ".join(cells)} |'


def _end_row(reports: Sequence[RecordingReport], parameters: str, model: str) -> str:
    """Write the errors of pose in which pushes end, recording by recording and all together."""
    rows = select(reports, parameters, model)
    rows = [*rows, _pooled(rows)]
    return _row(f'{model}, {parameters}',
                [f'{_pair(MILLIMETRES * errors.position)} mm, '
                 f'{_pair(np.degrees(errors.heading))}°' for errors in rows])


def _force_row(reports: Sequence[RecordingReport], parameters: str) -> str:
    """Write the errors of the contact force, recording by recording and all together."""
    rows = select(reports, parameters, QUASI_STATIC)
    rows = [*rows, _pooled(rows)]
    return _row(f'direction of the force, size over the recorded one, {parameters}',
                [f'{_pair(np.degrees(errors.force_direction))}°, '
                 f'{np.median(errors.force_ratio):.2f}' for errors in rows])


def _identification_row(report: RecordingReport) -> str:
    """Write what was identified, with its 95 % interval."""
    estimate, friction = report.identification, report.identification.contact_friction
    center = [f'{MILLIMETRES * interval.value:.1f} ({MILLIMETRES * interval.low:.1f} to '
              f'{MILLIMETRES * interval.high:.1f})'
              for interval in (estimate.friction_center_x, estimate.friction_center_y)]
    return _row(_short(report.recording.name), [
        ', '.join(center), f'{friction.value:.2f} ({friction.low:.2f} to {friction.high:.2f})'])


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
        for index, (parameters, model) in enumerate(KINDS):
            pooled = _pooled(select(reports, parameters, model))
            style = plot_style.series(index)
            fractions = np.arange(1, len(pooled.position) + 1) / len(pooled.position)
            left.plot(np.sort(MILLIMETRES * pooled.position), fractions,
                      label=f'{model}, {parameters}', **style)
            right.plot(np.sort(np.degrees(pooled.heading)), fractions, **style)
        for axes, label, limit in ((left, 'error of the end [mm]', 10.0),
                                   (right, 'error of the heading [deg]', 5.0)):
            axes.set_xlabel(label)
            axes.set_xlim(0.0, limit)
            axes.set_ylim(0.0, 1.0)
        left.set_ylabel('fraction of the pushes')
        left.legend(loc='lower right')
        figure.savefig(path, dpi=plot_style.DPI, metadata={'Software': None})


def _pooled(selected: Sequence[Errors]) -> Errors:
    return Errors('all', selected[0].model, selected[0].parameters,
                  *(np.concatenate([getattr(errors, name) for errors in selected])
                    for name in ('position', 'heading', 'force_direction', 'force_ratio')))


def _pair(values: FloatArray) -> str:
    median, high = (float(np.quantile(values, quantile)) for quantile in QUANTILES)
    digits = 1 if high >= 1.0 else max(0, 1 - math.floor(math.log10(max(high, 1e-9))))
    return f'{median:.{digits}f} ({high:.{digits}f})'


def _short(name: str) -> str:
    """Name floor and feet as a reader finds them."""
    floor, *coordinates = name.split('_')
    return f'{floor}, feet ' + ' '.join(
        f'({x}, {y})' for x, y in zip(coordinates[:3], coordinates[3:]))
