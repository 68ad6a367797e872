"""Report of the calibration: how many of drawn bases and touches are measured right."""

import argparse
from collections.abc import Sequence
from pathlib import Path
import tempfile
from typing import NamedTuple

from benchmarks.calibration.bases import calibrate, draw_base, errors_of, TOLERANCES
from benchmarks.calibration.touches import (
    draw_touch, errors_of_touch, TOLERANCE, touch_object,
)
from benchmarks.report_template import fill_template
import numpy as np
from push_scenario.plots.calibration import draw_calibration

DESCRIPTION = 'How many of drawn bases are calibrated right, and how many touches.'
TEMPLATE = Path(__file__).with_name('calibrate.md.in')
PAGE, PICTURE = 'calibrate.md', 'calibrate.png'
# The base in the picture, chosen: late, with a dead band, and with a wheel that is slow.
PICTURED = 6
BASES = 40


class Quantity(NamedTuple):
    """
    How errors are written.

    :param title: what is measured.
    :param limit: text of what counts as right.
    :param factor: by which errors are multiplied.
    :param unit: of the product.
    :param digits: of the product.
    """

    title: str
    limit: str
    factor: float
    unit: str
    digits: int


QUANTITIES = {
    'dead_time': Quantity('dead time', '20 ms', 1000.0, 'ms', 0),
    'time_constant': Quantity('lag', '20 %', 100.0, '%', 0),
    'least_speed': Quantity('least speed', '0.01 m/s', 1.0, 'm/s', 3),
    'scale': Quantity('scale of odometry', '0.5 %', 100.0, '%', 2),
    'yaw_scale': Quantity('scale of its rotations', '', 100.0, '%', 2),
    'heading_drift': Quantity('drift of its heading', '', 1000.0, 'mrad/m', 1),
    'size': Quantity('radius, by a touch from two sides', '3 mm', 1000.0, 'mm', 1),
    'offset': Quantity('offset of object poses, likewise', '3 mm', 1000.0, 'mm', 1)}
LIMITS = {**TOLERANCES, 'size': TOLERANCE, 'offset': TOLERANCE}


class Errors(NamedTuple):
    """
    Errors of a quantity.

    :param values: of each base; nan where nothing was measured.
    :param covered: how many intervals cover the truth; None where they were not compared.
    """

    values: list[float]
    covered: int | None = None


def row(name: str, errors: Errors) -> str:
    """
    Write a row of the table.

    :param name: of ``QUANTITIES``.
    :param errors: ``Errors``.
    """
    quantity, count = QUANTITIES[name], len(errors.values)
    sizes = np.abs(errors.values)
    right = ''
    if name in LIMITS:
        right = f'{int(np.sum(sizes <= LIMITS[name]))} of {count} within {quantity.limit}'
    median, largest = (f'{quantity.factor * size:.{quantity.digits}f}'
                       for size in (np.nanmedian(sizes), np.nanmax(sizes)))
    covered = '' if errors.covered is None else str(errors.covered)
    return f'| {quantity.title} | {right} | {median}, {largest} {quantity.unit} | {covered} |'


def measure_bases(count: int) -> dict[str, Errors]:
    """
    Calibrate bases.

    :param count: of bases.
    :return: ``Errors`` by name.
    """
    results: list[dict[str, tuple[float, bool]]] = []
    for seed in range(count):
        base = draw_base(seed)
        results.append(errors_of(base, calibrate(base, seed)))
        print(seed, base.robot.drive, ' '.join(
            f'{name} {error:+.4f}{"" if is_covered else "!"}'
            for name, (error, is_covered) in results[-1].items()), flush=True)
    return {name: Errors([result[name][0] for result in results],
                         sum(result[name][1] for result in results)) for name in results[0]}


def measure_touches(count: int) -> dict[str, Errors]:
    """
    Touch objects.

    :param count: of touches.
    :return: ``Errors`` by name.
    """
    results: list[dict[str, float]] = []
    for seed in range(count):
        touch = draw_touch(seed)
        results.append(errors_of_touch(touch, touch_object(touch, seed)[0]))
    return {name: Errors([result[name] for result in results]) for name in results[0]}


def measure_over_dds(count: int) -> str:
    """
    Calibrate bases by the command, and do a task with each file.

    :param count: of bases.
    :return: the table.
    """
    # Needs ROS.
    from benchmarks.calibration.over_dds import calibrate_over_dds, Calibrated
    from push_scenario.simulation.result import Outcome
    results: list[Calibrated] = []
    for seed in range(count):
        with tempfile.TemporaryDirectory() as folder:
            result = calibrate_over_dds(draw_base(seed), seed, Path(folder))
        results.append(result)
        print(seed, ' '.join(f'{name} {error:+.4f}' for name, error in result.errors.items()),
              f'{result.outcome.value} after {result.duration:.0f} s', result.reason, flush=True)
    rows = [row(name, Errors([result.errors[name] for result in results])).removesuffix('  |')
            for name in results[0].errors]
    times = [result.duration for result in results if result.outcome is Outcome.DONE]
    spent = f'{np.median(times):.0f}, {max(times):.0f} s' if times else '-'
    return '\n'.join(['| what | right | median, largest |', '| --- | --- | --- |', *rows,
                      f'| task with the file | {len(times)} of {count} done | {spent} |'])


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Calibrate, print the table, and write the page.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status.
    """
    parser = argparse.ArgumentParser(prog='python -m benchmarks.calibration',
                                     description=DESCRIPTION)
    parser.add_argument('--bases', type=int, default=BASES, help=f'how many (default: {BASES})')
    parser.add_argument('--out', type=Path, metavar='DIR', help='folder of the page, such as '
                        'docs/robots; without it nothing is written')
    parser.add_argument('--over-dds', type=int, default=0, metavar='COUNT', help='instead run the '
                        'command against so many of the bases over DDS, and a task with each file')
    options = parser.parse_args(arguments)
    if options.over_dds:
        print(measure_over_dds(options.over_dds))
        return 0
    errors = {**measure_bases(options.bases), **measure_touches(options.bases)}
    table = '\n'.join(['| what | right | median, largest error | covered by its interval |',
                       '| --- | --- | --- | --- |',
                       *(row(name, errors[name]) for name in QUANTITIES)])
    print(table)
    if options.out is not None:
        text = fill_template(TEMPLATE, BASES=options.bases, TABLE=table)
        (options.out / PAGE).write_text(text, encoding='utf-8')
        draw_calibration(calibrate(draw_base(PICTURED), PICTURED), options.out / PICTURE)
    return 0
