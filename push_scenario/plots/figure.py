"""The picture of a replay: what was planned, what happened, and why they differ."""

import math

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
import numpy as np
from push_model.friction import friction_center
from push_scenario.evaluation.metrics import deviation, distance_travelled, force_angle, measure
from push_scenario.evaluation.report import TITLES
from push_scenario.plots.drawing import (
    draw_object, draw_robot, GOAL, INK, LAW_STYLES, outline, PLAN_STYLE, set_view, style_axes,
)

SIZE, DPI = (14.0, 8.4), 110
MOMENTS = 5
BAND, TRUTH = '#DCE6DC', '#B3261E'


def draw_figure(results, path):
    """
    Draw runs of one scenario side by side and save the picture.

    :param results: the ``Result`` of each run that moved, one or more.
    :param path: of the PNG.
    """
    figure = Figure(figsize=SIZE, dpi=DPI, facecolor='white')
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(4, 3, width_ratios=(0.8, 1.75, 1.55), left=0.05, right=0.985,
                               top=0.92, bottom=0.075, wspace=0.23, hspace=0.34)
    figure.suptitle(_title(results), x=0.05, y=0.975, ha='left', fontsize=14, color=INK)
    _trajectories(figure.add_subplot(grid[:3, :2]), results)
    _hidden_truth(figure.add_subplot(grid[3, 0]), results[0].scenario)
    _legend(figure.add_subplot(grid[3, 1]), results)
    first = None
    for row, draw in enumerate((_pushing_angle, _force_angle, _position, _heading)):
        first = axes = figure.add_subplot(grid[row, 2], sharex=first)
        style_axes(axes)
        draw(axes, results)
        axes.tick_params(labelbottom=row == 3)
    axes.set_xlabel('way of the robot [m]')
    axes.set_xlim(left=0.0)
    figure.savefig(path, metadata={'Software': None})


def _title(results):
    scenario = results[0].scenario
    parts = []
    for result in results:
        metrics = measure(result)
        parts.append(f'{TITLES[result.control_law]} {_millimetres(metrics.position_error)} '
                     f'and {abs(math.degrees(metrics.heading_error)):.1f}°')
    return f'{scenario.name.replace("_", " ")}, ends off the goal: ' + ', '.join(parts)


def _millimetres(metres):
    return f'{1e3 * metres:.1f} mm' if metres < 0.0995 else f'{1e3 * metres:.0f} mm'


def _trajectories(axes, results):
    scenario = results[0].scenario
    plan = results[0].plan.object_poses
    draw_object(axes, scenario.object, plan[0], facecolor='#ECECEC', edgecolor=INK, linewidth=1.2,
                zorder=1)
    for result in results:
        _moments(axes, result, with_robot=result is results[-1])
    axes.plot(plan[:, 0], plan[:, 1], **PLAN_STYLE, zorder=6)
    for result in results:
        poses = result.tape.poses('object')
        axes.plot(poses[:, 0], poses[:, 1], **LAW_STYLES[result.control_law], zorder=7)
        axes.plot(*poses[-1, :2], 'o', color=LAW_STYLES[result.control_law]['color'], zorder=8)
    draw_object(axes, scenario.object, scenario.goal.pose, facecolor='none', edgecolor=GOAL,
                linewidth=3.0, linestyle=(0, (2, 1)), zorder=5)
    axes.plot(scenario.goal.x, scenario.goal.y, '+', color=GOAL, markersize=14,
              markeredgewidth=2.5, zorder=9)
    style_axes(axes)
    set_view(axes, results)


def _moments(axes, result, with_robot):
    scenario, tape = result.scenario, result.tape
    color = LAW_STYLES[result.control_law]['color']
    objects, robots = tape.poses('object'), tape.poses('robot')
    way = distance_travelled(tape)
    rows = np.searchsorted(way, np.linspace(0.0, way[-1], MOMENTS))
    rows[-1] = len(tape) - 1
    for row in rows:
        last = row == rows[-1]
        style = {'edgecolor': color, 'linewidth': 1.8 if last else 0.9, 'zorder': 4 if last else 3,
                 'linestyle': LAW_STYLES[result.control_law]['linestyle']}
        draw_object(axes, scenario.truth, objects[row], facecolor=color + ('30' if last else '0C'),
                    **style)
        if last or with_robot:
            draw_robot(axes, scenario.robot_truth.radius, robots[row],
                       facecolor=color + ('38' if last else '14'), **style)


def _hidden_truth(axes, scenario):
    believed, true = scenario.object, scenario.truth
    edge = outline(believed, (0.0, 0.0, 0.0))
    axes.fill(edge[:, 0], edge[:, 1], facecolor='#F6F6F6', edgecolor=INK, linewidth=1.0)
    scale = 420.0 / max(foot.friction_coefficient for foot in true.supports + believed.supports)
    for feet, style in ((true.supports, {'color': '#A6A6A6'}),
                        (believed.supports, {'facecolor': 'none', 'edgecolor': INK,
                                             'linestyle': '--'})):
        axes.scatter([foot.x for foot in feet], [foot.y for foot in feet],
                     s=[scale * foot.friction_coefficient for foot in feet], **style)
    for foot in true.supports:
        axes.annotate(f'{foot.friction_coefficient:.2f}', (foot.x, foot.y), fontsize=9,
                      xytext=(math.copysign(16.0, foot.x), 0.0), textcoords='offset points',
                      ha='left' if foot.x > 0.0 else 'right', va='center', color=INK,
                      bbox={'facecolor': 'white', 'edgecolor': 'none', 'pad': 0.8})
    axes.plot(*friction_center(believed), '+', color=INK, markersize=12, markeredgewidth=1.8,
              zorder=4)
    axes.plot(*friction_center(true), 'X', color=TRUTH, markersize=9)
    axes.set_aspect('equal', adjustable='datalim')
    axes.margins(0.05)
    axes.set_axis_off()
    changes = ', before it changes' if scenario.simulation.friction_changes else ''
    axes.set_title(f'friction under the feet{changes}', fontsize=10, color=INK)


def _legend(axes, results):
    axes.set_axis_off()
    handles = [Line2D([], [], **PLAN_STYLE, label='plan')]
    handles += [Line2D([], [], **LAW_STYLES[result.control_law],
                       label=f'{TITLES[result.control_law]}: path of the object, '
                       f'and the object at {MOMENTS} moments') for result in results]
    handles += [
        Line2D([], [], color=GOAL, linestyle=(0, (2, 1)), linewidth=3.0, label='goal'),
        Line2D([], [], color=TRUTH, marker='X', linestyle='none', markersize=9,
               label='true friction centre (grey, numbers: true friction)'),
        Line2D([], [], color=INK, marker='+', linestyle='none', markersize=11,
               markeredgewidth=1.8, label='believed friction centre (dashed: believed friction)'),
        Patch(facecolor=BAND, label='friction cone: inside it the contact sticks')]
    axes.legend(handles=handles, loc='center left', bbox_to_anchor=(-0.02, 0.45), frameon=False,
                fontsize=10, labelspacing=0.55, borderaxespad=0.0)


def _pushing_angle(axes, results):
    plan = results[0].plan
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(plan.robot_poses[:, :2],
                                                             axis=0).T))])
    speed = plan.contact_twists
    angle = np.arctan2(speed[:, 1], speed[:, 0]) - plan.contact_poses[:, 2]
    axes.plot(way, np.degrees(np.arctan2(np.sin(angle), np.cos(angle))), **PLAN_STYLE, zorder=4)
    for result in results:
        axes.plot(distance_travelled(result.tape), np.degrees(result.tape['pushing_angle']),
                  **_thin(result))
    axes.set_ylabel('pushing\nangle [°]')
    axes.set_ylim(-60.0, 60.0)


def _force_angle(axes, results):
    limit = math.degrees(math.atan(results[0].scenario.truth.contact_friction_coefficient))
    axes.axhspan(-limit, limit, color=BAND, linewidth=0.0)
    for result in results:
        axes.plot(distance_travelled(result.tape), np.degrees(force_angle(result.tape)), **_thin(result))
    axes.set_ylabel('contact force\nfrom normal [°]')
    axes.set_ylim(-1.6 * limit, 1.6 * limit)


def _position(axes, results):
    for result in results:
        away = deviation(result.tape.poses('object'), result.plan)[0]
        axes.plot(distance_travelled(result.tape), 1e3 * away, **_thin(result))
    axes.set_ylabel('distance from\nthe plan [mm]')
    axes.set_ylim(bottom=0.0)


def _heading(axes, results):
    for result in results:
        turn = deviation(result.tape.poses('object'), result.plan)[1]
        axes.plot(distance_travelled(result.tape), np.degrees(turn), **_thin(result))
    axes.set_ylabel('heading off\nthe plan [°]')


def _thin(result):
    return {**LAW_STYLES[result.control_law], 'linewidth': 1.4}
