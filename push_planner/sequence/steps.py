"""From a chain to its pushes: where each begins and ends."""

import dataclasses
import itertools
import math
from typing import NamedTuple

from push_model.dubins import advance
from push_model.geometry import Pose
from push_model.parameters import Contact
from push_planner.collocation.speed_profile import push_time
from push_planner.initial_guess.dubins_routes import route_along
from push_planner.problem import PushProblem

# With these, nearly all pushes of random chains are solved, and at the first go.
SETTLING = 1.5
SHARE = 0.1
LONGER = 1.3


class PlannedPush(NamedTuple):
    """
    One push of a chain.

    :param contact: the ``Contact``.
    :param start: ``Pose`` of the object before it.
    :param end: ``Pose`` of the object after it.
    :param robot_start: ``Pose`` of the robot at the contact before it.
    :param robot_end: ``Pose`` of the robot at the contact after it.
    :param duration: of the push alone [s].
    :param path_length: way of the contact [m].
    """

    contact: Contact
    start: Pose
    end: Pose
    robot_start: Pose
    robot_end: Pose
    duration: float
    path_length: float


class Step(NamedTuple):
    """
    One push of a chain as it is asked for.

    :param problem: the ``PushProblem``.
    :param push: the ``PlannedPush``, about.
    :param pieces: (length, signed curvature) of each piece of the way of the flat point
        [m, 1/m].
    """

    problem: PushProblem
    push: PlannedPush
    pieces: tuple

    def route(self, aside):
        """
        Make a route of the pieces.

        :param aside: how far from it along either axis a plan may be [m].
        :return: ``push_planner.initial_guess.dubins_routes.Route``.
        """
        return route_along(self.problem, self.pieces, aside)

    def object_poses(self, spacing):
        """
        Sample the way of the object.

        :param spacing: largest distance between samples [m].
        :return: list of ``Pose`` in the world.
        """
        view = self.problem.vehicle
        flat = Pose(*view.flat_point, view.angle)
        back, here = flat.inverse(), self.push.start @ flat
        poses = [self.push.start]
        for length, curvature in self.pieces:
            count = max(1, math.ceil(length * (1.0 + abs(curvature)) / spacing))
            poses += [advance(here, length * i / count, curvature) @ back
                      for i in range(1, count + 1)]
            here = advance(here, length, curvature)
        return poses


def chain_poses(trajectory, later, spacing):
    """
    Sample the way of the object through a chain.

    :param trajectory: ``PushTrajectory`` of the first push.
    :param later: ``Step`` of each of the others.
    :param spacing: largest distance between samples of these [m].
    :return: list of (x, y, theta) in the world.
    """
    poses = trajectory.object_poses.tolist()
    for step in later:
        poses += step.object_poses(spacing)
    return poses


def steps_of(chain, table, start, goal, settings):
    """
    Lay out a chain.

    :param chain: the ``push_planner.sequence.search.Chain``.
    :param table: the ``push_planner.sequence.primitives.Table``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object in the world; the last push is asked to end there.
    :param settings: ``PlannerSettings``.
    :return: list of ``Step``.
    """
    moves = list(zip(*chain[:4]))
    groups = [list(group) for _, group in itertools.groupby(
        moves, key=lambda move: table.numbers[move[0]])]
    steps, pose = [], start
    for group in groups:
        element = table.elements[group[0][0]]
        view = element.problem.vehicle
        pieces, way = _pieces(group, table)
        flat = Pose(*view.flat_point, view.angle)
        here = pose @ flat
        for length, curvature in pieces:
            here = advance(here, length, curvature)
        end = goal if group is groups[-1] else here @ flat.inverse()
        problem = element.moved(pose, end, _asked(settings, element, way, pieces[-1][0]))
        steps.append(Step(problem, PlannedPush(
            problem.contact, pose, end, pose @ element.robot_pose, end @ element.robot_pose,
            push_time(settings, way), way), pieces))
        pose = end
    return steps


def _pieces(moves, table):
    """Pieces of the flat point's way in one push, and the way of the contact."""
    pieces, way = [], 0.0
    for site, turn, before, after in moves:
        element = table.elements[site]
        arc = abs(turn) * element.radius
        pieces += [(before, 0.0), (arc, element.side / element.radius), (after, 0.0)]
        way += before + element.stretch * arc + after
    return tuple(pieces), way


def _asked(settings, element, way, straight):
    """Leave room to settle before the run-in, and refuse ways that are much longer than meant."""
    room = max(straight - SETTLING * element.problem.robot.radius, SHARE * straight)
    return dataclasses.replace(
        settings, run_in=min(settings.run_in, room), heading_free=False,
        max_path_length=min(settings.max_path_length, LONGER * way))
