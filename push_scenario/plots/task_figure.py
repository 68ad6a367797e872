"""The picture of a task: ways of the robot, pushes of the object, and how it came nearer."""

import math

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np
from push_scenario.evaluation.metrics import measure_task
from push_scenario.evaluation.report import TITLES
from push_scenario.plots.drawing import (
    ALONE_STYLE, draw_goals, draw_map, draw_object, draw_push_number, draw_robot, draw_shoves,
    GOAL, INK, phases_of, set_task_view, style_axes, TROUBLE,
)

# Inches: a scene, a strip, and rims.
WIDTH, STRIP, GAP, LEFT, RIGHT, TOP, BOTTOM = 8.0, 1.1, 0.45, 0.85, 0.2, 0.75, 0.5
DPI = 110
LEAST = 1e-3


def draw_task_figure(results, path):
    """
    Draw runs of one task side by side and save the picture.

    :param results: the ``TaskResult`` of each run, one or more.
    :param path: of the PNG.
    """
    figure = Figure(dpi=DPI, facecolor='white')
    FigureCanvasAgg(figure)
    panels = [[figure.add_axes((0.0, 0.0, 1.0, 1.0), label=f'{row}{column}') for row in range(3)]
              for column in range(len(results))]
    for (scene, away, turned), result in zip(panels, results):
        size = _scene(scene, result, results)
        _nearer(away, turned, result)
    _lay_out(figure, panels, WIDTH * size[1] / size[0])
    figure.savefig(path, metadata={'Software': None})


def _lay_out(figure, panels, height):
    total = (len(panels) * (LEFT + WIDTH + RIGHT), TOP + height + 2 * (GAP + STRIP) + BOTTOM)
    figure.set_size_inches(*total)
    for column, axes in enumerate(panels):
        left, bottom = LEFT + column * (LEFT + WIDTH + RIGHT), total[1] - TOP
        for ax, tall in zip(axes, (height, STRIP, STRIP)):
            bottom -= tall
            ax.set_position((left / total[0], bottom / total[1], WIDTH / total[0],
                             tall / total[1]))
            bottom -= GAP


def _scene(axes, result, results):
    scenario, phases = result.scenario, phases_of(result)
    objects, robots = result.tape.poses('object'), result.tape.poses('robot')
    radius = scenario.robot_truth.radius
    draw_map(axes, scenario)
    draw_object(axes, scenario.object, objects[0], facecolor='#ECECEC', edgecolor=INK,
                linewidth=1.2, zorder=2)
    draw_robot(axes, radius, robots[0], facecolor='#F4F4F4', edgecolor=INK, linewidth=1.0,
               zorder=2)
    for phase in phases:
        _way(axes, scenario, objects[phase.rows], robots[phase.rows], phase)
    draw_shoves(axes, result)
    draw_object(axes, scenario.truth, objects[-1], facecolor=GOAL + '30', edgecolor=INK,
                linewidth=1.6, zorder=4)
    draw_robot(axes, radius, robots[-1], facecolor='#8A8A8A', edgecolor=INK, linewidth=1.2,
               zorder=8)
    draw_goals(axes, scenario)
    style_axes(axes)
    axes.set_ylabel('y [m]')
    metrics = measure_task(result)
    axes.set_title(
        f'{scenario.name.replace("_", " ")}, {TITLES[result.control_law]}: {result.outcome} after '
        f'{metrics.time:.0f} s, {1e3 * metrics.position_error:.1f} mm and '
        f'{abs(math.degrees(metrics.heading_error)):.1f}° off the mark\n'
        f'pushes in their colours, the robot on its way dotted, the mark dashed', loc='left',
        fontsize=11, color=INK)
    return set_task_view(axes, results)


def _way(axes, scenario, objects, robots, phase):
    if phase.number is None:
        axes.plot(robots[:, 0], robots[:, 1], **ALONE_STYLE, zorder=6)
        return
    style = {'facecolor': phase.color + '0C', 'edgecolor': phase.color, 'linewidth': 0.9}
    axes.plot(robots[:, 0], robots[:, 1], color=phase.color, linewidth=1.0, zorder=6)
    axes.plot(objects[:, 0], objects[:, 1], color=phase.color, linewidth=3.0, zorder=7)
    draw_object(axes, scenario.truth, objects[-1], **style, zorder=3)
    for row in (0, -1):
        draw_robot(axes, scenario.robot_truth.radius, robots[row], **style, zorder=3)
    draw_push_number(axes, phase.number, robots[0, :2])


def _nearer(away, turned, result):
    time, objects, scenario = result.tape['time'], result.tape.poses('object'), result.scenario
    goals = np.array([scenario.goal.pose] + [later.goal.pose for later in scenario.task.goals])
    given = [later.time for later in scenario.task.goals]
    error = objects - goals[np.searchsorted(given, time, side='right')]
    lines = ((away, 1e3 * np.maximum(np.hypot(*error[:, :2].T), 0.5 * LEAST),
              1e3 * scenario.bounds.position_error, 'from the\nmark [mm]'),
             (turned, np.degrees(np.maximum(np.abs(np.remainder(
                 error[:, 2] + np.pi, 2.0 * np.pi) - np.pi), LEAST)),
              math.degrees(scenario.bounds.heading_error), 'turned\n[°]'))
    for axes, values, bound, label in lines:
        style_axes(axes)
        axes.set_yscale('log')
        axes.axhline(bound, color=GOAL, linewidth=1.2, linestyle=(0, (2, 1)))
        axes.plot(time, values, color=INK, linewidth=1.4)
        for phase in phases_of(result):
            start, end = time[phase.rows][[0, -1]]
            if phase.number is not None:
                axes.axvspan(start, end, color=phase.color, alpha=0.25, linewidth=0.0)
            if phase.trouble:
                axes.axvline(start, color=TROUBLE, linewidth=1.4)
        axes.set_ylabel(label)
        axes.set_xlim(0.0, time[-1])
    away.tick_params(labelbottom=False)
    turned.set_xlabel('time [s]; red: something went wrong, or a new goal was given')
