"""Straight pushes against a steered push at a vertex, by both drives."""

import dataclasses
import math
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
import numpy as np
from push_model.dubins import dubins_paths
from push_model.geometry import Pose
from push_model.parameters import Contact, Drive, DRIVES, PushedObject, RoundRobot
from push_model.quasi_static import vehicle
from push_primitives.store import load_primitives, PushPrimitives
from push_primitives.value_iteration import face_change_times
from studies.analysis.steering import steering_range
from studies.framework import plot_style
from studies.framework.parameters import Values
from studies.framework.study import Finding, Outcome, RunJobs, Study, Table
from studies.primitives.expected_time import (
    EXTENT, HEADINGS, mean_time, MISS, MISS_HEADING, time_at_distance,
)
from studies.primitives.setup import (
    draw_start, MILLIMETRES, named_object, named_robot, OBJECT, ROBOT,
)

PARAMETERS = (OBJECT, ROBOT, HEADINGS, EXTENT, MISS, MISS_HEADING)
# Chosen: points of a map along either axis, and the end of its scale [s].
MAP_POINTS = 41
SCALE = 15.0
PERCENT = 100.0
# Chosen: width of the rings of goals in which shares are counted [m].
RING = 0.25
# Chosen: goals up to here are near [m].
NEAR = 1.0
COLORS = 'PuOr'


class SteeredVertex(NamedTuple):
    """
    A vertex at which an object is steered like a vehicle.

    :param start: pose of the flat output point z in the object frame, its direction from C to F.
    :param radius_left: of the sharpest turn to the left [m].
    :param radius_right: of the sharpest turn to the right [m].
    """

    start: Pose
    radius_left: float
    radius_right: float


def steered_vertices(obj: PushedObject, robot: RoundRobot, speed: float) -> list[SteeredVertex]:
    """
    List the vertices at which a drive can steer to both sides.

    :param obj: the object, a polygon.
    :param robot: the robot.
    :param speed: of the contact [m/s].
    :return: one for each such vertex.
    """
    vertices: list[SteeredVertex] = []
    for index, corner in enumerate(obj.outline):
        limits = steering_range(obj, Contact('vertex', index), robot, speed)
        if limits is None or not limits[0].curvature < 0.0 < limits[1].curvature:
            continue
        turning = vehicle(obj, corner)
        x, y = turning.flat_output
        vertices.append(SteeredVertex(Pose(x, y, turning.angle), 1.0 / limits[1].curvature,
                                      -1.0 / limits[0].curvature))
    return vertices


def path_length(vertex: SteeredVertex, goal: Pose) -> float:
    """
    Find the length of the shortest path of the flat output point to where a goal has it.

    :param vertex: where the object is pushed.
    :param goal: of the object, in its frame at the start.
    :return: length of the shortest Dubins path [m]: no steered push at the vertex is shorter.
    """
    end = goal @ vertex.start
    return dubins_paths(vertex.start, end, vertex.radius_left, vertex.radius_right)[0].length


def steered_time(vertices: list[SteeredVertex], goal: Pose, primitives: PushPrimitives,
                 correction_time: float) -> float:
    """
    Bound the expected time of one steered push and the corrections after it from below.

    :param vertices: to choose from.
    :param goal: in the object frame.
    :param primitives: whose contacts and corrections count.
    :param correction_time: expected time to correct its miss [s].
    :return: time [s], contact, push and corrections.
    """
    settings = primitives.settings
    contact_time = float(face_change_times(primitives.table, settings).mean())
    shortest = min(path_length(vertex, goal) for vertex in vertices)
    return (contact_time + settings.push_time + shortest / settings.pushing_speed
            + correction_time)


def compute(values: Values, _: RunJobs) -> Outcome:
    """Compare both ends of the choice over the goals."""
    obj, robot = named_object(values.object), named_robot(values.robot)
    tables: dict[str, Table] = {}
    findings: dict[str, Finding] = {}
    for drive in DRIVES:
        tables[drive], compared = _compare(obj, dataclasses.replace(robot, drive=drive), values)
        findings.update(compared)
    return Outcome(tables, findings)


def _compare(obj: PushedObject, robot: RoundRobot,
             values: Values) -> tuple[Table, dict[str, Finding]]:
    """
    Compare straight pushes with a steered one for one drive.

    :raises ValueError: where the object has no vertex that can be steered at.
    """
    primitives = load_primitives(obj, robot)
    vertices = steered_vertices(obj, robot, primitives.settings.pushing_speed)
    if not vertices:
        raise ValueError(f'object: got {values.object}, expected a polygon with a vertex at which '
                         f'a {robot.drive} drive can steer')
    correction_time = time_at_distance(primitives.cost_to_go, values.miss, values.miss_heading)
    coordinates = np.linspace(-values.extent, values.extent, MAP_POINTS).tolist()
    goals = [Pose(x, y, heading) for heading in values.headings for y in coordinates
             for x in coordinates]
    straight = np.array([mean_time(primitives.cost_to_go, goal) for goal in goals])
    steered = np.array([steered_time(vertices, goal, primitives, correction_time)
                        for goal in goals])
    x, y, headings = np.array(goals).T
    table: Table = {'x_m': x, 'y_m': y, 'heading_rad': headings, 'straight_s': straight,
                    'steered_s': steered}
    findings = _findings(robot.drive, table, vertices, correction_time)
    findings['miss'] = Finding(MILLIMETRES * values.miss, 'mm', 'miss of a steered push')
    findings['miss_heading'] = Finding(math.degrees(values.miss_heading), 'deg',
                                       'its heading error')
    return table, findings


def _findings(drive: Drive, table: Table, vertices: list[SteeredVertex],
              correction_time: float) -> dict[str, Finding]:
    saved = table['straight_s'] - table['steered_s']
    radius = min(min(vertex.radius_left, vertex.radius_right) for vertex in vertices)
    distance = np.hypot(table['x_m'], table['y_m'])
    rings = np.arange(RING, float(table['x_m'].max()) + RING, RING)
    shares = [float(np.mean(saved[(distance > ring - RING) & (distance <= ring)] > 0.0))
              for ring in rings]
    short = [ring for ring, share in zip(rings, shares) if share <= 0.5]
    return {
        f'{drive}_radius': Finding(radius, 'm', f'{drive}: tightest turn at a vertex'),
        f'{drive}_correction': Finding(correction_time, 's', 'time to correct its miss'),
        f'{drive}_steered': Finding(PERCENT * float(np.mean(saved > 0.0)), '%',
                                    'share of goals to which a steered push might be quicker'),
        f'{drive}_distance': Finding(float(max(short, default=0.0)), 'm', 'distance from which '
                                     'on it might be quicker for most goals'),
        f'{drive}_near': Finding(PERCENT * float(np.mean(saved[distance <= NEAR] <= 0.0)), '%',
                                 f'share of goals within {NEAR:g} m to which straight pushes are '
                                 'quicker'),
        f'{drive}_saved': Finding(float(np.maximum(saved, 0.0).mean()), 's',
                                  'time that the choice of both saves at most, mean of all goals')}


def draw(figure: Figure, outcome: Outcome, values: Values) -> None:
    """Draw for each drive and heading the time that a steered push saves at most."""
    panels = figure.subplots(len(outcome.tables), len(values.headings), sharex=True, sharey=True,
                             squeeze=False)
    norm = TwoSlopeNorm(0.0, -SCALE, SCALE)
    mesh: Any = None
    for row, (drive, table) in zip(panels, outcome.tables.items()):
        for axes, heading in zip(row, values.headings):
            mesh = _draw_map(axes, table, heading, norm)
            draw_start(axes, named_object(values.object), color=plot_style.INK, linewidth=1.0)
            axes.set_title(f'{drive}, {math.degrees(heading):.0f} deg', loc='left')
            axes.label_outer()
    bar = figure.colorbar(mesh, ax=panels.ravel().tolist(), shrink=0.8, aspect=35, extend='both')
    bar.set_label('orange: straight pushes are quicker; violet: a steered push at a vertex might '
                  'be [s]')


def _draw_map(axes: Axes, table: Table, heading: float, norm: TwoSlopeNorm) -> Any:
    rows = np.isclose(table['heading_rad'], heading)
    shape = (MAP_POINTS, MAP_POINTS)
    x, y, straight, steered = (table[name][rows].reshape(shape) for name in (
        'x_m', 'y_m', 'straight_s', 'steered_s'))
    mesh = axes.pcolormesh(x, y, straight - steered, cmap=COLORS, norm=norm, shading='nearest',
                           rasterized=True)
    axes.contour(x, y, straight - steered, levels=[0.0], colors=plot_style.INK, linewidths=0.9)
    axes.set_aspect('equal')
    axes.set_xlabel('x of the goal [m]')
    axes.set_ylabel('y of the goal [m]')
    return mesh


STUDIES = (
    Study('P.9', 'Straight pushes against a steered push at a vertex', PARAMETERS, compute, draw,
          'At a vertex a differential drive turns the box with a radius of '
          '{differential_radius:.2f} m at best, a holonomic drive with {holonomic_radius:.2f} m. '
          'A steered push might be quicker to most goals from {differential_distance:.2f} and '
          '{holonomic_distance:.2f} m on.',
          'The steered push is counted at its best: the shortest path of its vehicle, and a miss '
          'of {miss:.0f} mm and {miss_heading:.0f} degrees, corrected in '
          '{differential_correction:.0f} and {holonomic_correction:.0f} s. Straight pushes are '
          'counted with all expected errors, and end after a metre. They are quicker to '
          '{differential_near:.0f} and {holonomic_near:.0f} % of the goals within a metre.',
          (9.6, 6.8)),)
