"""
Odometry as rows of numbers, and compiled comparisons of its poses with its twists.

A row holds a message, and what the messages before it add up to since some beginning: the poses
that the twists lead to, the path length of the poses, and the sum of the twists, each along the
heading of the pose at that time.
"""

import math
from typing import Any

import numpy as np
from push_dynamics.compiled import compiled, wrap_angles
from push_model.geometry import FloatArray
from push_model.signals import Odometry

# Columns of a row: time [s]; pose (x, y, theta) [m, m, rad]; twist in the robot's axes [m/s, m/s,
# rad/s]; sum of the twists as a pose; path length of the poses [m]; sum of the twists along the
# headings of the poses (x, y) [m].
TIME, X, Y, THETA, V_X, V_Y, OMEGA = range(7)
SUM_X, SUM_Y, SUM_THETA, TRAVELLED, EXPECTED_X, EXPECTED_Y = range(7, 13)
ROW_SIZE = 13


# Motion by poses and motion by twists, over the same time: distance between where they lead to
# [m], and the same of the headings [rad]; distance [m] and rotation [rad] by the poses; the same
# by the twists. Not a named tuple: compiled functions take three times as long to return one.
Motions = tuple[float, float, float, float, float, float]


def row_of(odometry: Odometry) -> FloatArray:
    """
    Make the row of a message, with sums that begin there.

    :param odometry: ``Odometry``.
    """
    sums = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return np.array((odometry.time, *odometry.pose, *odometry.twist, *sums), dtype=np.float64)


@compiled
def add_step(last: Any, row: Any) -> None:
    """
    Continue the sums by a step, along the chord of the arc that the mean of both twists makes.

    :param last: row before it.
    :param row: its own; its sums are written.
    """
    duration = row[TIME] - last[TIME]
    v_x, v_y = 0.5 * (last[V_X] + row[V_X]), 0.5 * (last[V_Y] + row[V_Y])
    rotation = 0.5 * (last[OMEGA] + row[OMEGA]) * duration
    heading = last[SUM_THETA] + 0.5 * rotation
    c, s = duration * math.cos(heading), duration * math.sin(heading)
    row[SUM_X] = last[SUM_X] + c * v_x - s * v_y
    row[SUM_Y] = last[SUM_Y] + s * v_x + c * v_y
    row[SUM_THETA] = last[SUM_THETA] + rotation
    d_x, d_y = row[X] - last[X], row[Y] - last[Y]
    row[TRAVELLED] = last[TRAVELLED] + math.sqrt(d_x * d_x + d_y * d_y)
    heading = last[THETA] + 0.5 * wrap_angles(row[THETA] - last[THETA])
    c, s = duration * math.cos(heading), duration * math.sin(heading)
    row[EXPECTED_X] = last[EXPECTED_X] + c * v_x - s * v_y
    row[EXPECTED_Y] = last[EXPECTED_Y] + s * v_x + c * v_y


@compiled
def compare_motions(first: Any, row: Any) -> Motions:
    """
    Compare what the robot has moved since a row by the poses and by the twists.

    :param first: row at the beginning.
    :param row: row at the end.
    :return: ``Motions``.
    """
    c, s = math.cos(first[THETA]), math.sin(first[THETA])
    d_x, d_y = row[X] - first[X], row[Y] - first[Y]
    x, y = c * d_x + s * d_y, c * d_y - s * d_x
    c, s = math.cos(first[SUM_THETA]), math.sin(first[SUM_THETA])
    d_x, d_y = row[SUM_X] - first[SUM_X], row[SUM_Y] - first[SUM_Y]
    e_x, e_y = c * d_x + s * d_y, c * d_y - s * d_x
    rotated, turned = row[THETA] - first[THETA], row[SUM_THETA] - first[SUM_THETA]
    return (math.sqrt((x - e_x) ** 2 + (y - e_y) ** 2), abs(wrap_angles(rotated - turned)),
            math.sqrt(x * x + y * y), abs(wrap_angles(rotated)),
            math.sqrt(e_x * e_x + e_y * e_y), abs(wrap_angles(turned)))


@compiled
def continue_row(last: Any, row: Any) -> Motions:
    """
    Continue the sums by a step, and compare its motions.

    :param last: row before it.
    :param row: its own; its sums are written.
    :return: ``Motions`` of the step.
    """
    add_step(last, row)
    return compare_motions(last, row)
