"""Pushes planned in constant pushing angles: the planning problem, tables and drawing."""

import math
from typing import Any, Sequence

from matplotlib.axes import Axes
import numpy as np
from push_model.geometry import FloatArray, Pose
from push_model.parameters import Contact, PushedObject, RoundRobot
from push_model.trajectory import PushTrajectory
from push_planner.problem import PlannerSettings, PushProblem
from push_planner.steered.plan import Plan
from studies.framework import plot_style
from studies.framework.box import BOX, box, REAR_FACE
from studies.framework.parameters import Parameter
from studies.framework.study import Table

# Whatever the plan demands, these robots do: the pushing angle is the input.
IDEAL_ROBOT: dict[str, Any] = {'drive': 'holonomic', 'max_speed': 10.0, 'max_yaw_rate': 50.0,
                               'max_acceleration': 100.0}
# Chosen: longer than any push of the studies, so that ``segments`` alone counts [m].
MAX_SEGMENT_LENGTH = 20.0
GOAL = Parameter('goal', 'm, m, rad', 'goal pose (x, y, theta), seen from the start pose')
CONE_MARGIN = Parameter('cone_margin', '',
                        'fraction of the friction angle that the contact force may use')
SEGMENTS = Parameter('segments', '', 'number of constant pushing angles')
SPEED = Parameter('speed', 'm/s', 'speed of the contact, from the first touch to the goal')
SETUP = (*BOX, GOAL, CONE_MARGIN)
POSE_COLUMNS = ('x_m', 'y_m', 'theta_rad')
CONTACT_COLUMNS = ('contact_x_m', 'contact_y_m', 'normal_rad')
PATH_COLUMNS = ('time_s', *POSE_COLUMNS, *CONTACT_COLUMNS)
# Chosen: rows of a path table.
SAMPLES = 121
# Chosen: length of the arrow of a push [m].
PUSH_ARROW = 0.16


def push_problem(values: Any, speed: float, segments: float, *, radius: float = 0.0,
                 goal: Sequence[float] | None = None, obj: PushedObject | None = None,
                 **settings: Any) -> PushProblem:
    """
    State the problem of pushing the box at the middle of its rear face, from the origin.

    :param values: with the parameters ``SETUP`` as attributes.
    :param speed: of the contact, from the first touch to the goal [m/s].
    :param segments: number of constant pushing angles.
    :param radius: of the robot [m]; 0 for a point, which stays where it is on the box; others do
        not rotate, so that the contact rolls.
    :param goal: pose (x, y, theta) [m, rad]; None for that of the values.
    :param obj: the object; None for the box of the values.
    :param settings: fields of ``PlannerSettings`` that differ.
    :return: the problem.
    """
    fields: dict[str, Any] = {
        'pushing_angles': 'constant', 'segments': int(segments),
        'segment_length': MAX_SEGMENT_LENGTH, 'pushing_speed': speed, 'deceleration': 0.0,
        'final_straight': 0.0, 'robot_yaw': 'fixed', 'friction_discount': 1.0}
    if 'cone_margin' not in settings:
        fields['cone_margin'] = values.cone_margin
    return PushProblem(obj or box(values), RoundRobot(radius, **IDEAL_ROBOT),
                       Contact('face', REAR_FACE), Pose(0.0, 0.0, 0.0), 0.0, 0.0,
                       Pose(*(goal or values.goal)), PlannerSettings(**{**fields, **settings}))


def path_table(trajectory: PushTrajectory, count: int = SAMPLES) -> Table:
    """
    Tabulate the poses of object and contact at even times.

    :param trajectory: of a plan.
    :param count: of the rows.
    :return: table with the columns ``PATH_COLUMNS``.
    """
    times = np.linspace(0.0, trajectory.duration, count)
    poses = np.hstack([trajectory.object_poses, trajectory.contact_poses])
    return dict(zip(PATH_COLUMNS, (times, *(np.interp(times, trajectory.times, column)
                                            for column in poses.T))))


def input_table(plan: Plan) -> Table:
    """
    Tabulate the constant pushing angles, each with where and when it begins and ends.

    :param plan: at constant speed.
    :return: table with the columns begin_m, end_m (distance travelled by the contact), begin_s,
        end_s and rho_rad.
    """
    angles = np.array(plan.pushing_angles)[:, 0]
    # Neighbouring segments of one angle count as one.
    starts = np.flatnonzero(np.concatenate([[True], np.diff(angles) != 0.0]))
    distances = np.concatenate([[0.0], plan.segment_ends])
    distances = np.append(distances[starts], distances[-1])
    times = distances / plan.speeds[0][0]
    return {'begin_m': distances[:-1], 'end_m': distances[1:], 'begin_s': times[:-1],
            'end_s': times[1:], 'rho_rad': angles[starts]}


def contact_on_face(path: Table) -> FloatArray:
    """
    Find where the contact is on the face.

    :param path: table with the columns ``PATH_COLUMNS``, n rows.
    :return: distance to the left of the middle of the face [m], shape (n,).
    """
    x, y = path['contact_x_m'] - path['x_m'], path['contact_y_m'] - path['y_m']
    return np.cos(path['theta_rad']) * y - np.sin(path['theta_rad']) * x


def poses_at(path: Table, times: Sequence[float] | FloatArray) -> list[Pose]:
    """
    Interpolate the poses of the object.

    :param path: table with the columns ``PATH_COLUMNS``.
    :param times: [s], shape (n,).
    :return: n poses.
    """
    columns = (np.interp(times, path['time_s'], path[name]) for name in POSE_COLUMNS)
    return [Pose(*row) for row in zip(*columns)]


def contact_at(path: Table, time: float) -> tuple[float, float, float]:
    """
    Interpolate the contact.

    :param path: table with the columns ``PATH_COLUMNS``.
    :param time: [s].
    :return: position (x, y) [m] and direction of the normal [rad].
    """
    x, y, normal = (np.interp(time, path['time_s'], path[name]) for name in CONTACT_COLUMNS)
    return x, y, normal


def draw_inputs(axes: Axes, table: Table, over: str = 'm', **style: Any) -> None:
    """
    Draw pushing angles over the distance or over time, jumps included.

    :param axes: to draw on.
    :param table: of ``input_table``.
    :param over: 'm' for the distance travelled by the contact, 's' for time.
    :param style: keywords of ``plot``.
    """
    edges = np.append(table[f'begin_{over}'], table[f'end_{over}'][-1])
    axes.plot(np.repeat(edges, 2)[1:-1], np.repeat(table['rho_rad'], 2), **style)
    axes.set_xlabel({'m': 'distance travelled by the contact [m]', 's': 'time [s]'}[over])
    axes.set_ylabel('pushing angle $\\rho$ [rad]')


def draw_outlines(axes: Axes, obj: PushedObject, poses: Sequence[Pose]) -> None:
    """
    Draw the object at some poses, at the last one, its goal, with a dashed outline.

    :param axes: to draw on.
    :param obj: the object.
    :param poses: from start to goal.
    """
    for index, pose in enumerate(poses):
        is_goal = index == len(poses) - 1
        style: dict[str, Any] = {'facecolor': 'none', 'linewidth': 0.6,
                                 'edgecolor': plot_style.GREY}
        if index == 0 or is_goal:
            style = {'facecolor': plot_style.OBJECT_FILL, 'linewidth': 1.2,
                     'edgecolor': plot_style.INK}
        axes.fill(*zip(*map(pose.transform, obj.outline)), zorder=1.0, alpha=0.8,
                  linestyle=plot_style.DASHED if is_goal else '-', **style)


def path_difference(path: Table, reference: Table) -> FloatArray:
    """
    Compute how far apart two paths of the middle are, at the same fraction of their time.

    :param path: of ``path_table``.
    :param reference: likewise, of as many samples n.
    :return: distances [m], shape (n,).
    """
    return np.hypot(path['x_m'] - reference['x_m'], path['y_m'] - reference['y_m'])


def draw_difference(axes: Axes, path: Table, reference: Table, **style: Any) -> None:
    """
    Draw ``path_difference`` over the course of the push.

    :param axes: to draw on.
    :param path: of ``path_table``.
    :param reference: likewise.
    :param style: keywords of ``plot``.
    """
    axes.plot(100.0 * path['time_s'] / path['time_s'][-1],
              1e3 * path_difference(path, reference), **style)
    axes.set_xlabel('part of the push [%]')
    axes.set_ylabel('difference of the path [mm]')


def draw_center(axes: Axes, path: Table, **style: Any) -> None:
    """
    Draw the path of the object's middle.

    :param axes: to draw on.
    :param path: table with the columns ``PATH_COLUMNS``.
    :param style: keywords of ``plot``.
    """
    axes.plot(path['x_m'], path['y_m'], zorder=3.0, **style)
    set_plane(axes)


def set_plane(axes: Axes) -> None:
    """
    Make axes the plane of motion, to scale.

    :param axes: to draw on.
    """
    axes.set_aspect('equal')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')


def draw_push(axes: Axes, path: Table, time: float, angle: float) -> None:
    """
    Draw the push at a time as an arrow that ends at the contact.

    :param axes: to draw on.
    :param path: table with the columns ``PATH_COLUMNS``.
    :param time: [s].
    :param angle: pushing angle [rad].
    """
    x, y, normal = contact_at(path, time)
    tail = (x - PUSH_ARROW * math.cos(normal + angle), y - PUSH_ARROW * math.sin(normal + angle))
    axes.annotate('', (x, y), tail, annotation_clip=False, zorder=4.0, arrowprops={
        'arrowstyle': '-|>', 'color': plot_style.INK, 'linewidth': 1.0, 'shrinkA': 0.0,
        'shrinkB': 0.0, 'mutation_scale': 8.0})
    axes.update_datalim([tail, (x, y)])
