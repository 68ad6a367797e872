"""
Write the comparison of the plant with MuJoCo: tables and a figure in docs/reports.

Takes about a minute: ``python -m benchmarks.plant.validation``.
"""

import argparse
import dataclasses
import math
from pathlib import Path
import statistics
from typing import Iterator, Sequence

from benchmarks.plant.comparison import (
    by_mujoco, by_plant, ENGINES, ORIGIN, pose_difference, PoseDifference, Push, PUSHES, RAISED,
)
from benchmarks.report_template import fill_template
import mujoco
from push_model.contact import contact_point, find_contact
from push_model.geometry import Pose
from push_model.parameters import PushedObject
from push_model.quasi_static import quasi_static_yaw_rate
from push_mujoco.scene import Engine, TUNED
from tqdm import tqdm

DESCRIPTION = 'Write the comparison of the plant with MuJoCo: tables and a figure.'
OUT = Path(__file__).resolve().parents[2] / 'docs' / 'validation'
# Indices into PUSHES of those in the figure; chosen: every kind of object.
PICTURED = (5, 6, 14, 17, 19, 26)
# Steps of MuJoCo [s], and speeds of the robot [m/s], by factors of 2.
STEPS = (1e-3, 5e-4, 2.5e-4)
SPEEDS = (0.8, 0.4, 0.2, 0.1, 0.05)
TEXT = Path(__file__).with_name('mujoco.md.in')


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Write a Markdown table."""
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)


def compare(push: Push) -> dict[str, PoseDifference]:
    """Compare the end of a push in the plant with that in MuJoCo, by its settings."""
    poses, _ = by_plant(push)
    return {name: pose_difference(by_mujoco(push, engine)[-1], poses[-1])
            for name, engine in ENGINES.items()}


def quantiles(results: Sequence[dict[str, PoseDifference]]) -> str:
    """Write median and maximum over the pushes, for each engine."""
    rows: list[list[str]] = []
    for name in ENGINES:
        distances = [1e3 * result[name].distance for result in results]
        angles = [math.degrees(result[name].angle) for result in results]
        rows.append([name, f'{statistics.median(distances):.2f}', f'{max(distances):.2f}',
                     f'{statistics.median(angles):.2f}', f'{max(angles):.2f}'])
    return table(['settings', 'median mm', 'max mm', 'median deg', 'max deg'], rows)


def step_table() -> str:
    """Write median and maximum over the pushes for finer steps of the tuned engine."""
    rows: list[list[str]] = []
    for step in tqdm(STEPS, desc='steps'):
        engine = dataclasses.replace(TUNED, step=step)
        distances = [1e3 * pose_difference(by_mujoco(push, engine)[-1],
                                           by_plant(push)[0][-1]).distance for push in PUSHES]
        rows.append([f'{1e3 * step:g}', f'{statistics.median(distances):.2f}',
                     f'{max(distances):.2f}'])
    return table(['step ms', 'median mm', 'max mm'], rows)


def speed_trend() -> list[tuple[float, PoseDifference]]:
    """
    Push an object on feet of different friction at several speeds.

    :return: (speed [m/s], difference with the tuned settings) of each push.
    """
    rows: list[tuple[float, PoseDifference]] = []
    for speed in tqdm(SPEEDS, desc='speeds'):
        push = Push('uneven box', 3.0, 0.3, 0.6, 0.02, (speed, 0.0), distance=0.4)
        engine = dataclasses.replace(TUNED, step=5e-4)
        rows.append((speed, pose_difference(by_mujoco(push, engine)[-1],
                                            by_plant(push)[0][-1])))
    return rows


def raised_table(pushes: Sequence[Push] = RAISED, engine: Engine = TUNED) -> str:
    """
    Write how much less an object turns that is pushed above the floor.

    :param pushes: with heights.
    :param engine: settings of MuJoCo.
    """
    rows: list[list[str]] = []
    for push in tqdm(pushes, desc='above the floor'):
        flat = dataclasses.replace(push, contact_height=0.0, center_of_mass_height=0.0)
        plant, mujoco_ = ([run(one) for one in (flat, push)] for run in (
            lambda one: by_plant(one)[0][-1], lambda one: by_mujoco(one, engine)[-1]))
        touched = find_contact(push.object, ORIGIN, push.robot_pose()[:2], push.radius).contact
        point = contact_point(push.object, touched)
        rates = [quasi_static_yaw_rate(one.object, point, *push.speed) for one in (flat, push)]
        distance, angle = pose_difference(plant[1], mujoco_[1])
        rows.append([push.kind, f'{push.contact_height:g}', f'{push.center_of_mass_height:g}',
                     f'{rates[1] / rates[0]:.3f}', f'{plant[1].theta / plant[0].theta:.3f}',
                     f'{mujoco_[1].theta / mujoco_[0].theta:.3f}',
                     f'{1e3 * distance:.2f} / {math.degrees(angle):.2f}'])
    return table(['object', 'z_C m', 'z_G m', 'quasi-static', 'plant', 'MuJoCo',
                  'difference mm / deg'], rows)


def outline(obj: PushedObject, pose: Pose) -> Iterator[tuple[float, ...]]:
    """Return the closed outline of an object in the world, as (xs, ys)."""
    points = obj.outline or [(obj.radius * math.cos(0.1 * i), obj.radius * math.sin(0.1 * i))
                             for i in range(63)]
    return zip(*(pose.transform(point) for point in (*points, points[0])))


def picture(path: Path) -> None:
    """Draw the paths of the object's origin, and its outline at the end."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(12, 7.2), layout='constrained')
    axes = figure.subplots(2, 3).ravel()
    for axis, index in zip(axes, tqdm(PICTURED, desc='picture')):
        push = PUSHES[index]
        poses, _ = by_plant(push)
        courses = [('plant', poses, '#0b6e4f', '-', 3.5)]
        courses += [(f'MuJoCo, {name}', by_mujoco(push, ENGINES[name]), color, style, 1.6)
                    for name, color, style in (('default', '#d1495b', ':'),
                                               ('tuned', '#111111', '--'))]
        for label, course, color, style, width in courses:
            axis.plot([0.0, *(p.x for p in course)], [0.0, *(p.y for p in course)], style,
                      color=color, lw=width, label=label)
            axis.plot(*outline(push.object, course[-1]), style, color=color, lw=0.5 * width)
        axis.set_title(f'{index + 1}: {push.kind}, {math.hypot(*push.speed):.2g} m/s, '
                       f'offset {1e3 * push.offset:g} mm', fontsize=10)
        axis.set_aspect('equal', 'datalim')
        axis.set(xlabel='x [m]', ylabel='y [m]')
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8, loc='lower left')
    figure.savefig(path, dpi=110)


def main() -> None:
    """Compare, write, draw."""
    parser = argparse.ArgumentParser(description=DESCRIPTION)
    parser.add_argument('--out', type=Path, default=OUT, help='directory to write to')
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    results = [compare(push) for push in tqdm(PUSHES, desc='pushes')]
    speeds = table(['speed m/s', 'difference mm', 'deg'],
                   [[f'{speed:g}', f'{1e3 * distance:.2f}', f'{math.degrees(angle):.3f}']
                    for speed, (distance, angle) in speed_trend()])
    text = fill_template(TEXT, VERSION=mujoco.__version__, COUNT=len(PUSHES),
                         SPREAD=quantiles(results), SPEEDS=speeds,
                         STEPS=step_table(), RAISED=raised_table())
    (out / 'mujoco.md').write_text(text, encoding='utf-8')
    picture(out / 'mujoco.png')
    print(f'{out / "mujoco.md"}\n{out / "mujoco.png"}')


if __name__ == '__main__':
    main()
