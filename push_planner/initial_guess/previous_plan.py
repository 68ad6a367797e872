"""Warm start: the rest of a previous plan as a route to start from."""

import math
from typing import NamedTuple, Optional

import numpy as np
from push_model.geometry import FloatArray, Pose, wrap_angle
from push_planner.collocation.formulation import NodeGuess
from push_planner.plan import Plan
from push_planner.problem import PushProblem

# Distance that counts as much as a radian of heading where the present pose is looked for on the
# previous path [m]. Chosen: the size of a pushed object.
HEADING_WEIGHT = 0.3
# Least path length that is worth a warm start [m].
MIN_REST = 0.02
# Largest fraction of the rest that its final straight may be. Chosen: the main section of a push
# needs a length of its own.
MAX_STRAIGHT_FRACTION = 0.9


class PreviousRoute(NamedTuple):
    """
    The rest of a plan, as a route.

    :param nodes: ``push_planner.collocation.collocation.Node`` of its samples in the new start
        frame, shape (n, 6).
    :param s: path length of the contact from now to each sample, shape (n,) [m].
    :param final_straight: length of the straight push at its end [m].
    :param rotation: angle by which the object rotates [rad].
    """

    nodes: FloatArray
    s: FloatArray
    final_straight: float
    rotation: float

    @property
    def name(self) -> str:
        """Name in reports."""
        return 'previous plan'

    @property
    def path_length(self) -> float:
        """Path length of the contact [m]."""
        return float(self.s[-1])

    def guess(self, problem: PushProblem, lengths: FloatArray, points: FloatArray) -> NodeGuess:
        """
        Follow the route.

        :param problem: the ``PushProblem``; not used, the nodes are in its frame.
        :param lengths: of the steps, summing to the path length, shape (n,) [m].
        :param points: Radau points of a step, shape (K,).
        """
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        nodes = np.column_stack([np.interp(ends, self.s, column) for column in self.nodes.T])
        at_points = ends[:-1, None] + lengths[:, None] * points
        return NodeGuess(nodes, np.interp(at_points, self.s, self.nodes[:, 0]))


def previous_route(problem: PushProblem, previous: Plan) -> Optional[PreviousRoute]:
    """
    Cut off what has been pushed already.

    :param problem: the ``PushProblem``, from the present pose.
    :param previous: ``Plan`` at the same contact.
    :return: ``PreviousRoute``; None where next to nothing is left, or the contact is another one.
    """
    if _contact_of(previous.problem) != _contact_of(problem):
        return None
    trajectory = previous.trajectory
    now = _nearest_sample(trajectory.object_poses, problem.start)
    speed = np.hypot(*trajectory.contact_twists[:, :2].T)
    steps = 0.5 * np.diff(trajectory.times) * (speed[1:] + speed[:-1])
    s = np.concatenate([[0.0], np.cumsum(steps)])
    if s[-1] - s[now] < MIN_REST:
        return None
    gamma = trajectory.contact_poses[:, 2]
    rho = np.arctan2(trajectory.contact_twists[:, 1], trajectory.contact_twists[:, 0]) - gamma
    theta = trajectory.object_poses[:, 2] - problem.start.theta
    theta = theta - theta[now] + wrap_angle(theta[now])
    followed = (trajectory.robot_poses if problem.kind == 'rolling' else
                trajectory.contact_poses)
    q_x, q_y = _in_frame(problem.start, followed[:, :2])
    phi = trajectory.robot_poses[:, 2] - trajectory.robot_poses[now, 2]
    nodes = np.column_stack([trajectory.object_twists[:, 2] / speed, _wrapped(rho), theta, q_x,
                             q_y, phi])[now:]
    rest = s[now:] - s[now]
    final_straight = min(previous.report['final_straight'],
                         MAX_STRAIGHT_FRACTION * float(rest[-1]))
    return PreviousRoute(nodes, rest, final_straight, float(nodes[-1, 2]))


def _contact_of(problem: PushProblem) -> tuple[str, str, int]:
    return problem.kind, problem.contact.kind, problem.contact.index


def _nearest_sample(poses: FloatArray, start: Pose) -> int:
    """Index of the pose that is nearest to the start."""
    rotation = poses[:, 2] - start.theta
    distance = np.hypot(*(poses[:, :2] - np.array(start[:2])).T)
    return int(np.argmin(distance + HEADING_WEIGHT * np.abs(_wrapped(rotation))))


def _wrapped(angles: FloatArray) -> FloatArray:
    """Wrap angles into [-pi, pi) [rad]."""
    return (angles + math.pi) % (2.0 * math.pi) - math.pi


def _in_frame(frame: Pose, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Coordinates of points of shape (n, 2) in a frame."""
    x, y = (points - np.array(frame[:2])).T
    c, s = math.cos(frame.theta), math.sin(frame.theta)
    return c * x + s * y, c * y - s * x
