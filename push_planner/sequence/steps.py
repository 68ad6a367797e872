"""From a chain to its pushes: where each begins and ends."""

import dataclasses
import itertools
import math
from typing import NamedTuple

from push_model.dubins import advance_along_arc
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


class SequenceStep(NamedTuple):
    """
    One push of a chain as it is asked for.

    :param problem: the ``PushProblem``.
    :param push: the ``PlannedPush``, about.
    :param segments: (length, signed curvature) of each piece of the way of the flat point
        [m, 1/m].
    """

    problem: PushProblem
    push: PlannedPush
    segments: tuple

    def route(self, aside):
        """
        Make a route of the pieces.

        :param aside: how far from it along either axis a plan may be [m].
        :return: ``push_planner.initial_guess.dubins_routes.Route``.
        """
        return route_along(self.problem, self.segments, aside)

    def object_poses(self, spacing):
        """
        Sample the way of the object.

        :param spacing: largest distance between samples [m].
        :return: list of ``Pose`` in the world.
        """
        view = self.problem.vehicle
        flat = Pose(*view.flat_output, view.angle)
        back, here = flat.inverse(), self.push.start @ flat
        poses = [self.push.start]
        for length, curvature in self.segments:
            count = max(1, math.ceil(length * (1.0 + abs(curvature)) / spacing))
            poses += [advance_along_arc(here, length * i / count, curvature) @ back
                      for i in range(1, count + 1)]
            here = advance_along_arc(here, length, curvature)
        return poses


def sequence_poses(trajectory, later_steps, spacing):
    """
    Sample the way of the object through a chain.

    :param trajectory: ``PushTrajectory`` of the first push.
    :param later_steps: ``SequenceStep`` of each of the others.
    :param spacing: largest distance between samples of these [m].
    :return: list of (x, y, theta) in the world.
    """
    poses = trajectory.object_poses.tolist()
    for step in later_steps:
        poses += step.object_poses(spacing)
    return poses


def build_steps(chain, table, start, goal, settings):
    """
    Lay out a chain.

    :param chain: the ``push_planner.sequence.search.PushSequence``.
    :param table: the ``push_planner.sequence.primitives.PrimitiveTable``.
    :param start: ``Pose`` of the object in the world.
    :param goal: ``Pose`` of the object in the world; the last push is asked to end there.
    :param settings: ``PlannerSettings``.
    :return: list of ``SequenceStep``.
    """
    moves = list(zip(*chain[:4]))
    groups = [list(group) for _, group in itertools.groupby(
        moves, key=lambda move: table.numbers[move[0]])]
    steps, pose = [], start
    for group in groups:
        primitive = table.primitives[group[0][0]]
        view = primitive.problem.vehicle
        segments, way = _pieces(group, table)
        flat = Pose(*view.flat_output, view.angle)
        here = pose @ flat
        for length, curvature in segments:
            here = advance_along_arc(here, length, curvature)
        end = goal if group is groups[-1] else here @ flat.inverse()
        problem = primitive.moved(pose, end, _asked(settings, primitive, way, segments[-1][0]))
        steps.append(SequenceStep(problem, PlannedPush(
            problem.contact, pose, end, pose @ primitive.robot_pose, end @ primitive.robot_pose,
            push_time(settings, way), way), segments))
        pose = end
    return steps


def _pieces(moves, table):
    """Pieces of the flat point's way in one push, and the way of the contact."""
    segments, way = [], 0.0
    for site, turn, before, after in moves:
        primitive = table.primitives[site]
        arc = abs(turn) * primitive.radius
        segments += [(before, 0.0), (arc, primitive.side / primitive.radius), (after, 0.0)]
        way += before + primitive.stretch * arc + after
    return tuple(segments), way


def _asked(settings, primitive, way, straight):
    """Leave room to settle before the run-in, and refuse ways that are much longer than meant."""
    room = max(straight - SETTLING * primitive.problem.robot.radius, SHARE * straight)
    return dataclasses.replace(
        settings, final_straight=min(settings.final_straight, room), heading_free=False,
        max_path_length=min(settings.max_path_length, LONGER * way))
