"""
Write the comparison of the plant with MuJoCo: tables and a picture in docs/validation.

Takes about a minute: ``python -m benchmarks.plant.validation``.
"""

import argparse
import dataclasses
import math
from pathlib import Path
import statistics

from benchmarks.plant.comparison import (
    apart, by_mujoco, by_plant, ENGINES, Push, PUSHES, sensitivity,
)
from benchmarks.plant.mujoco_scene import TUNED
from benchmarks.progress_bar import progress
import mujoco

OUT = Path(__file__).resolve().parents[2] / 'docs' / 'validation'
PICTURED = (5, 6, 14, 17, 19, 26)
STEPS = (1e-3, 5e-4, 2.5e-4)
SPEEDS = (0.8, 0.4, 0.2, 0.1, 0.05)
TEXT = Path(__file__).with_name('mujoco.md.in')


def table(head, rows):
    """Write a markdown table."""
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)


def compare(push):
    """Return modes, sensitivity, and (distance, turn) per engine for one push."""
    poses, modes = by_plant(push)
    ends = {name: apart(by_mujoco(push, engine)[-1], poses[-1])
            for name, engine in ENGINES.items()}
    return modes, sensitivity(push), ends


def row(number, push, result):
    """Write one push as a table row."""
    modes, growth, ends = result
    speed = ', '.join(f'{v:g}' for v in push.speed) + (f', {push.spin:g}' if push.spin else '')
    return [str(number), push.kind, f'{push.mass:g}', f'{push.friction:g}', f'{push.grip:g}',
            f'{push.radius:g}', f'{1e3 * push.offset:g}', speed, f'{push.distance:g}',
            ' '.join(sorted(mode.value for mode in modes)), f'{growth:.1f}',
            *(f'{1e3 * distance:.2f} / {math.degrees(turn):.2f}'
              for distance, turn in ends.values())]


def spread(results):
    """Write median and maximum over the pushes, per engine."""
    rows = []
    for name in ENGINES:
        distances = [1e3 * ends[name][0] for _, _, ends in results]
        turns = [math.degrees(ends[name][1]) for _, _, ends in results]
        rows.append([name, f'{statistics.median(distances):.2f}', f'{max(distances):.2f}',
                     f'{statistics.median(turns):.2f}', f'{max(turns):.2f}'])
    return table(['settings', 'median mm', 'max mm', 'median deg', 'max deg'], rows)


def step_table():
    """Write median and maximum over the pushes for finer steps of the tuned engine."""
    rows = []
    for step in progress(STEPS, 'steps'):
        engine = dataclasses.replace(TUNED, step=step)
        distances = [1e3 * apart(by_mujoco(push, engine)[-1], by_plant(push)[0][-1])[0]
                     for push in PUSHES]
        rows.append([f'{1e3 * step:g}', f'{statistics.median(distances):.2f}',
                     f'{max(distances):.2f}'])
    return table(['step ms', 'median mm', 'max mm'], rows)


def speed_trend():
    """
    Push an object on unevenly rubbing feet at several speeds.

    :return: rows (speed, distance [m], turn [rad]) with the tuned settings.
    """
    rows = []
    for speed in progress(SPEEDS, 'speeds'):
        push = Push('uneven box', 3.0, 0.3, 0.6, 0.02, (speed, 0.0), distance=0.4)
        engine = dataclasses.replace(TUNED, step=5e-4)
        rows.append((speed, *apart(by_mujoco(push, engine)[-1], by_plant(push)[0][-1])))
    return rows


def outline(obj, pose):
    """Return the closed outline of an object in the world, as (xs, ys)."""
    points = obj.outline or [(obj.radius * math.cos(0.1 * i), obj.radius * math.sin(0.1 * i))
                             for i in range(63)]
    return zip(*(pose.transform(point) for point in (*points, points[0])))


def picture(path):
    """Draw courses of the object's origin, and its outline at the end."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(12, 7.2), layout='constrained')
    axes = figure.subplots(2, 3).ravel()
    for axis, number in zip(axes, progress(PICTURED, 'picture')):
        push = PUSHES[number]
        poses, _ = by_plant(push)
        courses = [('plant', poses, '#0b6e4f', '-', 3.5)]
        courses += [(f'MuJoCo, {name}', by_mujoco(push, ENGINES[name]), color, style, 1.6)
                    for name, color, style in (('default', '#d1495b', ':'),
                                               ('tuned', '#111111', '--'))]
        for label, course, color, style, width in courses:
            axis.plot([0.0, *(p.x for p in course)], [0.0, *(p.y for p in course)], style,
                      color=color, lw=width, label=label)
            axis.plot(*outline(push.object, course[-1]), style, color=color, lw=0.5 * width)
        axis.set_title(f'{number + 1}: {push.kind}, {math.hypot(*push.speed):.2g} m/s, '
                       f'offset {1e3 * push.offset:g} mm', fontsize=10)
        axis.set_aspect('equal', 'datalim')
        axis.set(xlabel='x [m]', ylabel='y [m]')
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8, loc='lower left')
    figure.savefig(path, dpi=110)


def main():
    """Compare, write, draw."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--out', type=Path, default=OUT, help='directory to write to')
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    results = [compare(push) for push in progress(PUSHES, 'pushes')]
    head = ['', 'object', 'm kg', 'mu', 'mu_c', 'R_p m', 'offset mm', 'speed m/s', 'way m',
            'contact', 'sensitivity', *(f'{name}: mm / deg' for name in ENGINES)]
    pushes = table(head, [row(i, *pair) for i, pair in enumerate(zip(PUSHES, results), 1)])
    speeds = table(['speed m/s', 'difference mm', 'deg'],
                   [[f'{speed:g}', f'{1e3 * distance:.2f}', f'{math.degrees(turn):.3f}']
                    for speed, distance, turn in speed_trend()])
    text = TEXT.read_text(encoding='utf-8')
    for name, value in (('VERSION', mujoco.__version__), ('COUNT', str(len(PUSHES))),
                        ('SPREAD', spread(results)), ('PUSHES', pushes), ('SPEEDS', speeds),
                        ('STEPS', step_table())):
        text = text.replace(f'@{name}@', value)
    (out / 'mujoco.md').write_text(text, encoding='utf-8')
    picture(out / 'mujoco.png')
    print(f'{out / "mujoco.md"}\n{out / "mujoco.png"}')


if __name__ == '__main__':
    main()
