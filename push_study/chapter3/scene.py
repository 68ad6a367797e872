"""Pushes planned in constant pushing angles: how they are asked for, tabled and drawn."""

import math

import numpy as np
from push_model.geometry import Pose
from push_model.parameters import Contact, RoundRobot
from push_planner.problem import PlannerSettings, PushProblem
from push_study.framework import paper
from push_study.framework.scenes import BOX, box
from push_study.framework.study import Parameter

# Whatever the plan asks for, these robots do: the pushing angle is the input.
IDEAL = {'drive': 'holonomic', 'max_speed': 10.0, 'max_yaw_rate': 50.0, 'max_acceleration': 100.0}
FACE, LONGEST = 3, 20.0
GOAL = Parameter('goal', 'm, m, rad', 'goal pose (x, y, theta), seen from the start pose')
MARGIN = Parameter('cone_margin', '', 'share of the friction angle that the contact force may use')
SEGMENTS = Parameter('segments', '', 'number of constant pushing angles')
SPEED = Parameter('speed', 'm/s', 'speed of the contact, from the touch to the goal')
SCENE = (*BOX, GOAL, MARGIN)
PATH = ('time_s', 'x_m', 'y_m', 'theta_rad', 'contact_x_m', 'contact_y_m', 'normal_rad')
SAMPLES = 121


def push_problem(values, speed, segments, radius=0.0, goal=None, obj=None, **settings):
    """
    Ask for a push of the box at the middle of the face behind, from the origin.

    :param values: ``Values`` with the parameters ``SCENE``.
    :param speed: of the contact, from the touch to the goal [m/s].
    :param segments: number of constant pushing angles.
    :param radius: of the robot [m]; 0 for a point, which stays where it is on the box; others do
        not turn, so that the contact rolls.
    :param goal: ``Pose``; None for that of the values.
    :param obj: ``PushedObject``; None for the box of the values.
    :param settings: fields of ``PlannerSettings`` that differ.
    :return: ``PushProblem``.
    """
    fields = {'pushing_angles': 'constant', 'segments': int(segments), 'segment_length': LONGEST,
              'pushing_speed': speed, 'deceleration': 0.0, 'final_straight': 0.0, 'robot_yaw': 'fixed',
              'friction_discount': 1.0}
    if 'cone_margin' not in settings:
        fields['cone_margin'] = values.cone_margin
    return PushProblem(obj or box(values), RoundRobot(radius, **IDEAL), Contact('face', FACE),
                       Pose(0.0, 0.0, 0.0), 0.0, 0.0, Pose(*(goal or values.goal)),
                       PlannerSettings(**{**fields, **settings}))


def path_table(trajectory, count=SAMPLES):
    """
    Table the poses of object and contact at even times.

    :param trajectory: ``PushTrajectory``.
    :param count: of the rows.
    :return: table with the columns ``PATH``.
    """
    times = np.linspace(0.0, trajectory.duration, count)
    poses = np.hstack([trajectory.object_poses, trajectory.contact_poses])
    return dict(zip(PATH, (times, *(np.interp(times, trajectory.times, column)
                                    for column in poses.T))))


def input_table(plan):
    """
    Table the constant pushing angles, each with where and when it begins and ends.

    :param plan: ``Plan`` at constant speed.
    :return: table with the columns begin_m, end_m, begin_s, end_s, rho_rad.
    """
    angles = np.array(plan.pushing_angles)[:, 0]
    begins = np.flatnonzero(np.concatenate([[True], np.diff(angles) != 0.0]))
    ways = np.concatenate([[0.0], plan.segment_ends])
    ways = np.append(ways[begins], ways[-1])
    times = ways / plan.speeds[0][0]
    return {'begin_m': ways[:-1], 'end_m': ways[1:], 'begin_s': times[:-1], 'end_s': times[1:],
            'rho_rad': angles[begins]}


def draw_inputs(axes, table, over='m', **style):
    """
    Draw pushing angles over the way of the contact or over time, jumps included.

    :param axes: matplotlib axes.
    :param table: of ``input_table``.
    :param over: 'm' for the way, 's' for time.
    :param style: keywords of ``plot``.
    """
    edges = np.append(table[f'begin_{over}'], table[f'end_{over}'][-1])
    axes.plot(np.repeat(edges, 2)[1:-1], np.repeat(table['rho_rad'], 2), **style)
    axes.set_xlabel({'m': 'way of the contact [m]', 's': 'time [s]'}[over])
    axes.set_ylabel('pushing angle $\\rho$ [rad]')


def poses_at(path, times):
    """
    Interpolate the poses of the object.

    :param path: table of ``path_table``.
    :param times: [s], shape (n,).
    :return: list of ``Pose``.
    """
    columns = (np.interp(times, path['time_s'], path[name]) for name in PATH[1:4])
    return [Pose(*row) for row in zip(*columns)]


def draw_outlines(axes, obj, poses):
    """
    Draw the object at some poses, the last one, where it is to get to, with a dashed outline.

    :param axes: matplotlib axes.
    :param obj: the ``PushedObject``.
    :param poses: list of ``Pose``, from start to goal.
    """
    for number, pose in enumerate(poses):
        goal = number == len(poses) - 1
        end = number == 0 or goal
        axes.fill(*zip(*map(pose.transform, obj.outline)), zorder=1.0, alpha=0.8,
                  facecolor='#F1F1F1' if end else 'none', linewidth=1.2 if end else 0.6,
                  edgecolor=paper.INK if end else paper.GREY, linestyle=(0, (4, 2)) if goal else
                  '-')


def draw_center(axes, path, **style):
    """
    Draw the way of the object's middle.

    :param axes: matplotlib axes.
    :param path: table of ``path_table``.
    :param style: keywords of ``plot``.
    """
    axes.plot(path['x_m'], path['y_m'], **{'zorder': 3.0, **style})
    axes.set_aspect('equal')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')


def draw_push(axes, path, time, angle, length=0.14):
    """
    Draw the push at a time as an arrow that ends at the contact.

    :param axes: matplotlib axes.
    :param path: table of ``path_table``.
    :param time: [s].
    :param angle: pushing angle [rad].
    :param length: of the arrow [m].
    """
    x, y, normal = (np.interp(time, path['time_s'], path[name]) for name in PATH[4:])
    tail = x - length * math.cos(normal + angle), y - length * math.sin(normal + angle)
    axes.annotate('', (x, y), tail, annotation_clip=False, zorder=4.0, arrowprops={
        'arrowstyle': '-|>', 'color': paper.INK, 'linewidth': 1.0, 'shrinkA': 0.0,
        'shrinkB': 0.0, 'mutation_scale': 8.0})
    axes.update_datalim([tail, (x, y)])
