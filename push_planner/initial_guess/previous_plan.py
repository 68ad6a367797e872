"""What is left of a former plan, to start from when planning anew."""

import math
from typing import NamedTuple

import numpy as np
from push_model.geometry import wrap_angle
from push_planner.initial_guess.first_guess import Guess

TURN_REACH = 0.3
SHORTEST = 0.02


class PreviousRoute(NamedTuple):
    """
    The rest of a plan, as a route.

    :param nodes: ``push_planner.collocation.collocation.Node`` of its samples in the new start frame, shape (n, 6).
    :param ways: of the contact from now to each sample, shape (n,) [m].
    :param final_straight: straight way at its end [m].
    :param rotation: angle by which the object turns [rad].
    """

    nodes: np.ndarray
    ways: np.ndarray
    final_straight: float
    rotation: float

    name = 'previous plan'
    max_deviation = math.inf

    @property
    def path_length(self):
        """Way of the contact [m]."""
        return float(self.ways[-1])

    def guess(self, problem, lengths, points):
        """
        Follow it.

        :param problem: the ``PushProblem``; not used, the nodes are in its frame.
        :param lengths: of the steps, summing to the cost, shape (n,) [m].
        :param points: places of the Radau points in a step, shape (K,).
        :return: ``Guess``.
        """
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        nodes = np.column_stack([np.interp(ends, self.ways, column) for column in self.nodes.T])
        places = ends[:-1, None] + lengths[:, None] * points
        return Guess(nodes, np.interp(places, self.ways, self.nodes[:, 0]))


def previous_route(problem, previous):
    """
    Cut off what has been pushed already.

    :param problem: the ``PushProblem``, from the present pose.
    :param previous: ``Plan`` of the same contact.
    :return: ``PreviousRoute``; None where next to nothing is left, or another contact is meant.
    """
    former = previous.problem
    if (former.kind, former.contact.kind, former.contact.index) != (
            problem.kind, problem.contact.kind, problem.contact.index):
        return None
    motion, start = previous.trajectory, problem.start
    turns = motion.object_poses[:, 2] - start.theta
    off = np.hypot(*(motion.object_poses[:, :2] - np.array(start[:2])).T)
    now = int(np.argmin(off + TURN_REACH * np.abs((turns + math.pi) % (2.0 * math.pi) - math.pi)))
    speed = np.hypot(*motion.contact_twists[:, :2].T)
    steps = 0.5 * np.diff(motion.times) * (speed[1:] + speed[:-1])
    ways = np.concatenate([[0.0], np.cumsum(steps)])
    if ways[-1] - ways[now] < SHORTEST:
        return None
    gamma = motion.contact_poses[:, 2]
    rho = np.arctan2(motion.contact_twists[:, 1], motion.contact_twists[:, 0]) - gamma
    turns = turns - turns[now] + wrap_angle(turns[now])
    followed = motion.robot_poses if problem.kind == 'rolling' else motion.contact_poses
    x, y = (followed[:, :2] - np.array(start[:2])).T
    c, s = math.cos(start.theta), math.sin(start.theta)
    phi = motion.robot_poses[:, 2] - motion.robot_poses[now, 2]
    nodes = np.column_stack([motion.object_twists[:, 2] / speed,
                             (rho + math.pi) % (2.0 * math.pi) - math.pi, turns,
                             c * x + s * y, c * y - s * x, phi])[now:]
    left = ways[now:] - ways[now]
    return PreviousRoute(nodes, left, min(previous.report['final_straight'], 0.9 * float(left[-1])),
                         float(nodes[-1, 2]))
