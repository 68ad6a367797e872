"""How long it takes until an object is at its goal, by straight pushes alone."""

import dataclasses
import math
from typing import Any, Sequence

from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import DRIVES
from push_primitives.cost_to_go import CostToGo
from push_primitives.store import load_primitives
from studies.framework import plot_style
from studies.framework.parameters import Parameter, Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.primitives.setup import (
    draw_start, MILLIMETRES, named_object, named_primitives, named_robot, OBJECT, OBJECTS, ROBOT,
)

HEADINGS = Parameter('headings', 'rad', 'headings of the goals')
EXTENT = Parameter('extent', 'm', 'largest coordinate of the goals')
MISS = Parameter('miss', 'm', 'distance of a miss')
MISS_HEADING = Parameter('miss_heading', 'rad', 'heading error of a miss')
# Chosen: points of a map along either axis, of a curve, and bearings that curves average over.
MAP_POINTS = 61
CURVE_POINTS = 60
BEARINGS = 24
# Chosen: distance of the findings [m] and ends of the curves [m, rad].
FINDING_DISTANCE = 1.0
FAR, NEAR, SMALL_HEADING = 3.0, 0.06, math.radians(8.0)
# Chosen: spacing of the contours [s].
CONTOUR_STEP = 3.0
PERCENT = 100.0
# Light to dark; the scale ends short of the darkest, on which labels cannot be read.
COLORS = 'YlGnBu'
DARKEST = 1.5


def mean_time(cost_to_go: CostToGo, goal: Pose) -> float:
    """
    Average the cost-to-go over the faces where the robot may stand.

    :param cost_to_go: of the object.
    :param goal: in the object frame.
    :return: expected time [s].
    """
    faces = len(cost_to_go.values)
    return sum(cost_to_go.at(goal, face) for face in range(faces)) / faces


def time_at_distance(cost_to_go: CostToGo, distance: float, heading: float = 0.0) -> float:
    """
    Average the cost-to-go over faces and over bearings of the goal, from every side alike.

    :param cost_to_go: of the object.
    :param distance: of the goal [m].
    :param heading: of the goal, averaged over both signs [rad].
    :return: expected time [s].
    """
    goals = [Pose(distance * math.cos(bearing), distance * math.sin(bearing), sign * heading)
             for bearing in np.linspace(0.0, 2.0 * math.pi, BEARINGS, endpoint=False).tolist()
             for sign in ((1.0, -1.0) if heading else (1.0,))]
    return sum(mean_time(cost_to_go, goal) for goal in goals) / len(goals)


def compute_maps(values: Values, _: RunJobs) -> Outcome:
    """Evaluate the cost-to-go of both drives over the position of the goal."""
    coordinates = np.linspace(-values.extent, values.extent, MAP_POINTS)
    tables: dict[str, Table] = {}
    findings: dict[str, Finding] = {}
    obj, robot = named_object(values.object), named_robot(values.robot)
    for drive in DRIVES:
        cost_to_go = load_primitives(obj, dataclasses.replace(robot, drive=drive)).cost_to_go
        tables[drive] = _map(cost_to_go, coordinates, values.headings)
        for name, heading, words in (('ahead', 0.0, 'without rotation'),
                                     ('turned', 0.5 * math.pi, 'turned by 90 degrees'),
                                     ('reversed', math.pi, 'turned by 180 degrees')):
            findings[f'{drive}_{name}'] = Finding(
                time_at_distance(cost_to_go, FINDING_DISTANCE, heading), 's',
                f'{drive}: mean expected time to goals {FINDING_DISTANCE:g} m away, {words}')
    saved = [1.0 - findings[f'holonomic_{name}'].value / findings[f'differential_{name}'].value
             for name in ('ahead', 'turned', 'reversed')]
    findings['saved'] = Finding(PERCENT * float(np.mean(saved)), '%',
                                'mean time that a holonomic drive saves')
    return Outcome(tables, findings)


def _map(cost_to_go: CostToGo, coordinates: FloatArray, headings: Sequence[float]) -> Table:
    rows = [(x, y, heading, mean_time(cost_to_go, Pose(x, y, heading)))
            for heading in headings for y in coordinates.tolist() for x in coordinates.tolist()]
    return dict(zip(('x_m', 'y_m', 'heading_rad', 'time_s'), np.array(rows).T))


def draw_maps(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw a map for each drive and heading of the goal."""
    top = max(float(table['time_s'].max()) for table in outcome.tables.values())
    levels = np.arange(0.0, top + CONTOUR_STEP, CONTOUR_STEP)
    panels = figure.subplots(len(outcome.tables), len(values.headings), sharex=True, sharey=True,
                             squeeze=False)
    filled: Any = None
    for row, (drive, table) in zip(panels, outcome.tables.items()):
        for axes, heading in zip(row, values.headings):
            filled = _draw_map(axes, table, heading, levels)
            draw_start(axes, named_object(values.object), color=plot_style.INK, linewidth=1.0)
            axes.set_title(f'{drive}, {math.degrees(heading):.0f} deg', loc='left')
            axes.label_outer()
    bar = figure.colorbar(filled, ax=panels.ravel().tolist(), shrink=0.8, aspect=35)
    bar.set_label('expected time until the object is at the goal [s]')


def _draw_map(axes: Axes, table: Table, heading: float, levels: Any) -> Any:
    rows = np.isclose(table['heading_rad'], heading)
    shape = (MAP_POINTS, MAP_POINTS)
    x, y, times = (table[name][rows].reshape(shape) for name in ('x_m', 'y_m', 'time_s'))
    filled = axes.contourf(x, y, times, levels=levels, cmap=COLORS,
                           norm=Normalize(0.0, DARKEST * levels[-1]))
    lines = axes.contour(x, y, times, levels=levels[::2], colors=plot_style.INK, linewidths=0.5)
    axes.clabel(lines, fmt='%.0f', fontsize=6.5)
    axes.set_aspect('equal')
    axes.set_xlabel('x of the goal [m]')
    axes.set_ylabel('y of the goal [m]')
    return filled


def compute_curves(values: Values, _: RunJobs) -> Outcome:
    """Evaluate the cost-to-go of all objects over distance and heading, far and near."""
    tables: dict[str, Table] = {}
    corrections: dict[str, list[float]] = {'miss': [], 'miss_heading': [], 'both': []}
    slopes: list[float] = []
    for name in values.objects:
        cost_to_go = named_primitives(name, values.robot).cost_to_go
        tables[name] = _curves(cost_to_go)
        corrections['miss'].append(time_at_distance(cost_to_go, values.miss))
        corrections['miss_heading'].append(
            time_at_distance(cost_to_go, 0.0, values.miss_heading))
        corrections['both'].append(
            time_at_distance(cost_to_go, values.miss, values.miss_heading))
        slopes.append((time_at_distance(cost_to_go, 3.0) - time_at_distance(cost_to_go, 1.0))
                      / 2.0)
    findings = {
        'distance': Finding(MILLIMETRES * values.miss, 'mm', 'distance of a miss'),
        'heading': Finding(math.degrees(values.miss_heading), 'deg', 'heading error of a miss'),
        'slope': Finding(float(np.mean(slopes)), 's/m', 'rise of the time from 1 m to 3 m, mean '
                         'of all objects')}
    for kind, words in (('miss', 'that distance off'), ('miss_heading', 'that heading off'),
                        ('both', 'off by both')):
        findings[f'{kind}_least'] = Finding(min(corrections[kind]), 's',
                                            f'time to correct an object {words}, least')
        findings[f'{kind}_most'] = Finding(max(corrections[kind]), 's', 'the same, most')
    return Outcome(tables, findings)


def _curves(cost_to_go: CostToGo) -> Table:
    fractions = np.linspace(0.0, 1.0, CURVE_POINTS)
    return {
        'distance_m': FAR * fractions,
        'distance_time_s': [time_at_distance(cost_to_go, FAR * part) for part in fractions],
        'heading_rad': math.pi * fractions,
        'heading_time_s': [time_at_distance(cost_to_go, 0.0, math.pi * part)
                           for part in fractions],
        'miss_m': NEAR * fractions,
        'miss_time_s': [time_at_distance(cost_to_go, NEAR * part) for part in fractions],
        'miss_heading_rad': SMALL_HEADING * fractions,
        'miss_heading_time_s': [time_at_distance(cost_to_go, 0.0, SMALL_HEADING * part)
                                for part in fractions]}


def draw_curves(figure: Figure, outcome: Outcome, _: Values) -> None:
    """Draw the expected time over distance and heading, above far and below near."""
    panels = figure.subplots(2, 2)
    degrees = math.degrees(1.0)
    for axes, column, time, scale, label in (
            (panels[0, 0], 'distance_m', 'distance_time_s', 1.0,
             'distance of the goal, no rotation [m]'),
            (panels[0, 1], 'heading_rad', 'heading_time_s', degrees,
             'rotation to the goal, no distance [deg]'),
            (panels[1, 0], 'miss_m', 'miss_time_s', MILLIMETRES, 'distance of a miss [mm]'),
            (panels[1, 1], 'miss_heading_rad', 'miss_heading_time_s', degrees,
             'heading error of a miss [deg]')):
        for index, (name, table) in enumerate(outcome.tables.items()):
            axes.plot(scale * table[column], table[time], label=name.replace('_', ' '),
                      **plot_style.series(index))
        axes.set_xlabel(label)
        axes.set_ylabel('expected time [s]')
        axes.set_ylim(bottom=0.0)
    panels[0, 0].legend(loc='best')


STUDIES = (
    Study('P.6', 'Expected time to a goal, by straight pushes', (OBJECT, ROBOT, HEADINGS, EXTENT),
          compute_maps, draw_maps,
          'A goal 1 m away takes a differential drive {differential_ahead:.0f} s in the mean, '
          '{differential_turned:.0f} s with a rotation by 90 degrees, {differential_reversed:.0f} '
          's with a half turn. A holonomic one takes {holonomic_ahead:.0f}, '
          '{holonomic_turned:.0f} and {holonomic_reversed:.0f} s, {saved:.0f} % less.',
          'Both push alike; the holonomic one reaches the next contact sooner. Times include all '
          'expected pushes, corrections and contacts, averaged over the first faces.',
          (9.6, 6.8)),
    Study('P.7', 'What distance, rotation and a miss cost', (OBJECTS, ROBOT, MISS, MISS_HEADING),
          compute_curves, draw_curves,
          'Beyond a metre each further metre costs {slope:.0f} s. Correcting {distance:.0f} mm '
          'takes {miss_least:.0f} to {miss_most:.0f} s, {heading:.0f} degrees '
          '{miss_heading_least:.0f} to {miss_heading_most:.0f} s, both at once {both_least:.0f} '
          'to {both_most:.0f} s.',
          'At the edge of the tolerances the time jumps to that of a contact and a tap. A '
          'rotation alone costs most: the tap that turns the object also displaces it, beyond a '
          'few degrees by more than the tolerance, and another one must follow.', (8.6, 6.6)))
